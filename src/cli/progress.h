/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Progress of reading a scan: a bar on standard error, where that is a terminal. */
#ifndef FG_CLI_PROGRESS_H
#define FG_CLI_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>
#include <time.h>

enum { FG_PROGRESS_NAME = 31 };

typedef struct fg_progress {
  char name[FG_PROGRESS_NAME]; /* of the scan, without control characters */
  bool wanted;                 /* standard error is a terminal */
  bool shown;
  struct timespec last;
} fg_progress;

void fg_progress_begin(fg_progress *progress, const char *name);
void fg_progress_show(void *progress, int64_t done, int64_t all); /* fg_measure_progress */
void fg_progress_end(fg_progress *progress);                      /* wipes the bar */

#endif
