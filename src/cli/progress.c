#include "cli/progress.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { BAR_WIDTH = 40 };
/* A scan that is done at once shows no bar, and a bar is not drawn more often than it is seen. */
#define SECONDS_BETWEEN 0.2

void fg_progress_begin(fg_progress *progress, const char *name) {
  *progress = (fg_progress){.name = name, .wanted = isatty(STDERR_FILENO) == 1};
  clock_gettime(CLOCK_MONOTONIC, &progress->last);
}

void fg_progress_show(void *user, int64_t done, int64_t all) {
  static const char bar[BAR_WIDTH + 1] = "########################################";
  fg_progress *progress = user;
  struct timespec now;
  if (!progress->wanted || all <= 0) return;
  clock_gettime(CLOCK_MONOTONIC, &now);
  double passed = (double)(now.tv_sec - progress->last.tv_sec) +
                  1e-9 * (double)(now.tv_nsec - progress->last.tv_nsec);
  if (passed < SECONDS_BETWEEN) return;
  double share = (double)done / (double)all;
  int filled = (int)(share * BAR_WIDTH);
  fprintf(stderr, "\r\033[K%.30s [%.*s%*s] %3.0f %%", progress->name, filled, bar,
          BAR_WIDTH - filled, "", 100 * share);
  fflush(stderr);
  progress->last = now;
  progress->shown = true;
}

void fg_progress_end(fg_progress *progress) {
  if (progress->shown) fputs("\r\033[K", stderr);
  progress->shown = false;
}
