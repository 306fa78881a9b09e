/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/progress.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "foilgauge/text.h"

enum { BAR_WIDTH = 40 };
/* A scan that is done at once shows no bar, and a bar is not drawn more often than it is seen. */
#define SECONDS_BETWEEN 0.2

/* Clips the name to the space there is, in whole characters. */
static void clip_visible(const char *name, char *clipped, size_t size) {
  char visible[4 * FG_PROGRESS_NAME];
  size_t length, kept = 0;
  fg_utf8_make_visible(name, strnlen(name, size), true, visible, &length);
  visible[length] = '\0';
  for (size_t next; kept < length && (next = fg_utf8_length(visible + kept)) + kept < size;)
    kept += next;
  memcpy(clipped, visible, kept);
  clipped[kept] = '\0';
}

void fg_progress_begin(fg_progress *progress, const char *name) {
  *progress = (fg_progress){.wanted = isatty(STDERR_FILENO) == 1};
  clip_visible(name, progress->name, sizeof progress->name);
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
  dprintf(STDERR_FILENO, "\r\033[K%s [%.*s%*s] %3.0f %%", progress->name, filled, bar,
          BAR_WIDTH - filled, "", 100 * share);
  progress->last = now;
  progress->shown = true;
}

void fg_progress_end(fg_progress *progress) {
  if (progress->shown) dprintf(STDERR_FILENO, "\r\033[K");
  progress->shown = false;
}
