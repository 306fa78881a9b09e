/* SPDX-License-Identifier: GPL-3.0-or-later */
/* File stability: how long files have not changed, by this machine's steady clock. A file's own
 * time is its file system's, on the network another machine's: it only has to stay the same. */
#ifndef FG_STATION_FILE_STABILITY_H
#define FG_STATION_FILE_STABILITY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "foilgauge/status.h"

/* A whole file that was not seen to be closed is read after this time without a change. */
#define FG_STABLE_NS INT64_C(2000000000)

/* A file's state when it was first seen unchanged. */
typedef struct fg_stable_file {
  char *name;
  int64_t bytes, modified_ns, since_ns;
  bool seen;  /* in this round */
  bool tried; /* as it is; the caller's */
} fg_stable_file;

typedef struct fg_file_stability {
  fg_stable_file *files;
  size_t count, capacity;
  size_t *slots, slot_count; /* a hash table: 1 + a file's index, by its name; 0: nothing */
} fg_file_stability;

/* Notes the file's state and finds the time since when it has been the same; `now_ns` is of a
 * clock that nobody sets. *file is valid until the next call. */
fg_status fg_file_stability_note(fg_context *ctx, fg_file_stability *stability, const char *name,
                                 int64_t bytes, int64_t modified_ns, int64_t now_ns,
                                 fg_stable_file **file);

/* Ends a round: forgets files that were not noted in it. */
void fg_file_stability_end_round(fg_file_stability *stability);
void fg_file_stability_free(fg_file_stability *stability);

#endif
