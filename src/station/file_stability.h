/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files that stay as they are, and for how long, as this machine's steady clock tells.
 *
 * The time of a file is its file system's, on the network another machine's: it only has to stay
 * the same. */
#ifndef FG_STATION_FILE_STABILITY_H
#define FG_STATION_FILE_STABILITY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "foilgauge/status.h"

/* A whole file is taken when nothing has come for so long and nobody has said that it is closed. */
#define FG_STABLE_NS INT64_C(2000000000)

/* A file as it was first seen so. */
typedef struct fg_resting {
  char *name;
  int64_t bytes, modified_ns, since_ns;
  bool seen;  /* in this round */
  bool tried; /* as it is; the caller's */
} fg_resting;

typedef struct fg_file_stability {
  fg_resting *files;
  size_t count, capacity;
  size_t *slots, slot_count; /* a hash table: 1 + a file's index, by its name; 0: nothing */
} fg_file_stability;

/* Since when the file has been as it is: `now_ns` is of a clock that nobody sets, and it is
 * remembered from its first look on. *file is valid until the next call. */
fg_status fg_file_stability_look(fg_context *ctx, fg_file_stability *stability, const char *name,
                                 int64_t bytes, int64_t modified_ns, int64_t now_ns,
                                 fg_resting **file);

/* The end of a round: files that were not looked at in it are forgotten. */
void fg_file_stability_end_round(fg_file_stability *stability);
void fg_file_stability_free(fg_file_stability *stability);

#endif
