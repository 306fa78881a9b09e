/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Temporary names of files that are not yet complete.
 *
 * A signal can come at any time, and belongs to the process. So does the list of these names: it is
 * the only state that the library keeps beyond a call. The code that ends the process calls
 * fg_temporaries_remove (foilgauge/file.h). */
#ifndef FG_CORE_TEMPORARY_H
#define FG_CORE_TEMPORARY_H

#include <sys/types.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_temporary {
  char *path;
  int descriptor; /* for writing; locked (flock) as long as its process lives */
  struct fg_temporary *next;
} fg_temporary;

/* Creates a new file beside `path`. Its name follows from that of `path`, so that the next run that
 * writes there finds and removes the file of a killed one. Returns an errno, 0 on success. */
int fg_temporary_create(const char *path, mode_t mode, fg_temporary **made);

/* Gives the file its final name, and takes it off the list. Returns 0, or an errno with nothing
 * changed. The file stays open until fg_temporary_close. */
int fg_temporary_rename(fg_temporary *temporary, const char *path);

/* Removes the file unless it was renamed, closes and frees it; NULL is fine. */
void fg_temporary_close(fg_temporary *temporary);

#ifdef __cplusplus
}
#endif
#endif
