/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linked into tests and into foilgauge_kept: copies each JSON document that the program writes.
 *
 * FOILGAUGE_KEEP_JSON=FOLDER: a whole document goes there, as a file named by its checksum, whether
 * it was written to a file, a pipe or memory. Without it nothing changes. The linker's --wrap leads
 * the calls of the JSON writer here. A document that ends early is not kept, and neither is one
 * that another program wrote: a test's bad input.
 */
#include <errno.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "core/json_writer.h"

/* The linker's names of the functions of core/json_writer.c, and of those that replace them. */
void __real_fg_json_begin(fg_json *json, FILE *out);
void __real_fg_json_object_end(fg_json *json);
void __wrap_fg_json_begin(fg_json *json, FILE *out);
void __wrap_fg_json_object_end(fg_json *json);

/* A document that is being written: `tee` hands on to `out`, and to `copy` in memory. */
typedef struct fg_kept {
  struct fg_kept *next;
  FILE *out, *tee, *copy;
  char *text;
  size_t size;
  bool broken; /* memory has failed: the copy is not the document */
} fg_kept;

static pthread_mutex_t guard = PTHREAD_MUTEX_INITIALIZER;
static fg_kept *first;

static ssize_t write_both(void *cookie, const char *bytes, size_t size) {
  fg_kept *kept = cookie;
  if (fwrite(bytes, 1, size, kept->copy) != size) kept->broken = true;
  return (ssize_t)fwrite(bytes, 1, size, kept->out);
}

/* The tee has no buffer: what a caller writes past the JSON writer keeps its place. */
static fg_kept *open_kept(FILE *out) {
  fg_kept *kept = calloc(1, sizeof *kept);
  if (!kept) return NULL;
  kept->out = out;
  kept->copy = open_memstream(&kept->text, &kept->size);
  kept->tee = fopencookie(kept, "w", (cookie_io_functions_t){.write = write_both});
  if (kept->copy && kept->tee) {
    setvbuf(kept->tee, NULL, _IONBF, 0);
    return kept;
  }
  if (kept->copy) fclose(kept->copy);
  if (kept->tee) fclose(kept->tee);
  free(kept->text);
  free(kept);
  return NULL;
}

void __wrap_fg_json_begin(fg_json *json, FILE *out) {
  fg_kept *kept = getenv("FOILGAUGE_KEEP_JSON") ? open_kept(out) : NULL;
  __real_fg_json_begin(json, kept ? kept->tee : out);
  if (!kept) return;
  pthread_mutex_lock(&guard);
  kept->next = first;
  first = kept;
  pthread_mutex_unlock(&guard);
}

static fg_kept *take_kept(const FILE *tee) {
  pthread_mutex_lock(&guard);
  fg_kept **at = &first;
  while (*at && (*at)->tee != tee)
    at = &(*at)->next;
  fg_kept *kept = *at;
  if (kept) *at = kept->next;
  pthread_mutex_unlock(&guard);
  return kept;
}

/* FNV-1a. */
static uint64_t hash_text(const char *text, size_t size) {
  uint64_t hash = 14695981039346656037u;
  for (size_t i = 0; i < size; i++)
    hash = (hash ^ (unsigned char)text[i]) * 1099511628211u;
  return hash;
}

/* Files appear whole under their name, which the same document has again. */
static void store_text(const char *folder, const char *text, size_t size) {
  char *name = NULL, *partial = NULL;
  uint64_t hash = hash_text(text, size);
  FILE *file = NULL;
  if (asprintf(&name, "%s/%016" PRIx64 ".json", folder, hash) < 0 || access(name, F_OK) == 0 ||
      asprintf(&partial, "%s.%ld-%lx", name, (long)getpid(), (unsigned long)pthread_self()) < 0)
    goto exit;
  file = fopen(partial, "we");
  if (!file) goto exit;
  bool whole = fwrite(text, 1, size, file) == size;
  whole &= fclose(file) == 0;
  if (!whole || rename(partial, name) != 0) unlink(partial);

exit:
  free(name);
  free(partial);
}

void __wrap_fg_json_object_end(fg_json *json) {
  __real_fg_json_object_end(json);
  fg_kept *kept = json->depth == 0 ? take_kept(json->out) : NULL;
  if (!kept) return;
  int error = errno; /* of the caller's stream: it may be told */
  json->out = kept->out;
  fclose(kept->tee);
  const char *folder = getenv("FOILGAUGE_KEEP_JSON");
  if (fclose(kept->copy) == 0 && folder && !kept->broken)
    store_text(folder, kept->text, kept->size);
  free(kept->text);
  free(kept);
  errno = error;
}
