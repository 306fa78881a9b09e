/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The names that files have before they are whole.
 *
 * A signal can come at any time, and is the process's: so is the list of these names, the only
 * state that the library keeps beyond a call. Whoever ends the process calls fg_temporaries_remove
 * (foilgauge/file.h). */
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

/* A new file beside `path`. Its name follows from that of `path`, so that the next run that writes
 * there finds, and removes, what a killed one has left. Returns an errno, 0 when it is there. */
int fg_temporary_create(const char *path, mode_t mode, fg_temporary **made);

/* Gives it its final name, and takes it off the list; an errno, and nothing has changed, or 0. The
 * file stays open until fg_temporary_close. */
int fg_temporary_rename(fg_temporary *temporary, const char *path);

/* Removes it unless it was renamed, closes and frees it; NULL is fine. */
void fg_temporary_close(fg_temporary *temporary);

#ifdef __cplusplus
}
#endif
#endif
