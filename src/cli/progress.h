/* How far a scan is read: a bar on standard error, where that is a terminal. */
#ifndef FG_CLI_PROGRESS_H
#define FG_CLI_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>
#include <time.h>

typedef struct fg_progress {
  const char *name; /* of the scan */
  bool wanted;      /* standard error is a terminal */
  bool shown;
  struct timespec last;
} fg_progress;

void fg_progress_begin(fg_progress *progress, const char *name);
void fg_progress_show(void *progress, int64_t done, int64_t all); /* fg_measure_progress */
void fg_progress_end(fg_progress *progress);                      /* wipes the bar */

#endif
