/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/strip.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/spread.h"

enum { STRETCHES = 8 };

void fg_strip_free(fg_strip *strip) {
  if (!strip) return;
  free(strip->stations);
  memset(strip, 0, sizeof *strip);
}

static double width_at(const fg_station *s) {
  return hypot(s->right.x - s->left.x, s->right.y - s->left.y);
}

/* sd of the medians of consecutive stretches over the root of their number. Reorders the widths. */
static double error_of_mean(double *widths, size_t count) {
  double medians[STRETCHES], mean = 0, squares = 0;
  for (size_t i = 0; i < STRETCHES; i++) {
    size_t first = i * count / STRETCHES, last = (i + 1) * count / STRETCHES;
    medians[i] = fg_upper_median(widths + first, last - first);
    mean += medians[i] / STRETCHES;
  }
  for (size_t i = 0; i < STRETCHES; i++)
    squares += (medians[i] - mean) * (medians[i] - mean);
  return sqrt(squares / (STRETCHES - 1) / STRETCHES);
}

fg_status fg_strip_measure_thickness(fg_context *ctx, fg_strip *strip) {
  double *widths = NULL;
  size_t n = 0;
  FG_TRY(fg_memory_allocate(ctx, strip->count, sizeof *widths, (void **)&widths));
  for (size_t i = 0; i < strip->count; i++)
    if (strip->stations[i].weight > 0) widths[n++] = width_at(&strip->stations[i]);
  strip->u_thickness_mm = n >= 2 * STRETCHES ? error_of_mean(widths, n) : NAN;
  strip->thickness_mm = fg_upper_median(widths, n);
  free(widths);
  return FG_OK;
}
