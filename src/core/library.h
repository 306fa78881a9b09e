/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared libraries that most runs can do without: with the libraries that they need themselves they
 * take longer to load than a table takes to fit, so they are loaded when they are first used. */
#ifndef FG_CORE_LIBRARY_H
#define FG_CORE_LIBRARY_H

#include <pthread.h>
#include <stdbool.h>

#include "foilgauge/status.h"

/* A library's functions are one list, of which its struct of pointers and their names are made:
 *
 *   #define CURL_FUNCTIONS(F) F(curl_, easy_init) F(curl_, easy_perform)
 *   static struct curl { CURL_FUNCTIONS(FG_LIBRARY_POINTER) } curl;
 *   static const char *const names[] = {CURL_FUNCTIONS(FG_LIBRARY_NAME)};
 *
 * A member is called as its function, less the prefix. */
#define FG_LIBRARY_POINTER(prefix, name) __typeof__(prefix##name) *name;
#define FG_LIBRARY_NAME(prefix, name)    #prefix #name,

typedef struct fg_library {
  const char *file;    /* its name to the loader (SONAME) */
  const char *package; /* of Debian */
  const char *const *names;
  size_t count;
  void *functions;     /* array or struct of `count` pointers, in the order of `names` */
  void (*start)(void); /* called once, when they are found; NULL: nothing to do */
  pthread_mutex_t mutex;
  bool loaded;
} fg_library;

/* Makes an fg_library whose `function_names` and `pointers` are of one list; `first`: its start. */
#define FG_LIBRARY(soname, debian, function_names, pointers, first)                                \
  {                                                                                                \
    .file = (soname), .package = (debian), .names = (function_names),                              \
    .count = sizeof(function_names) / sizeof *(function_names), .functions = (pointers),           \
    .start = (first), .mutex = PTHREAD_MUTEX_INITIALIZER                                           \
  }

/* Loads a library and finds its functions, once; by any thread. FG_ERR_IO: it is not installed, or
 * too old. */
fg_status fg_library_load(fg_context *ctx, fg_library *library);

#endif
