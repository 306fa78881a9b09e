/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The picture's grid, and where its points really lie. */
#include <math.h>

#include "report/scan_loop/parts.h"

enum { WIDTH = 520, MARGIN = 34, SAMPLES = FG_SCAN_RESULT_GRID_SAMPLES - 1 };

typedef struct deformation {
  FILE *out;
  const fg_scan_result_grid *grid;
  double scale;     /* units of the drawing per mm */
  double magnified; /* magnification of the displacements */
} deformation;

/* Returns the largest displacement that may be drawn: within a cell, and without crossing of a
 * ripple's lines. */
static double reach(const fg_scan_result_grid *grid) {
  return fmin(0.6 * grid->cell_mm, 0.13 * grid->period_mm);
}

static void put_grid_line(const deformation *d, const fg_scan_result_grid_line *line, bool moved) {
  const fg_scan_result_grid *grid = d->grid;
  int step = moved ? 1 : SAMPLES; /* a line without displacement is straight */
  double magnified = moved ? d->magnified : 0;
  fprintf(d->out, "<path class=\"%s\" d=\"", moved ? "moved" : "still");
  for (int i = 0; i <= SAMPLES; i += step) {
    fg_point at = line->at_mm[i], move = line->move_mm[i];
    fprintf(d->out, "%c%.1f %.1f", i ? 'L' : 'M',
            MARGIN + d->scale * (at.x - grid->low_mm[0] + magnified * move.x),
            MARGIN + d->scale * (at.y - grid->low_mm[1] + magnified * move.y));
  }
  fputs("\"/>\n", d->out);
}

static void put_edges(const deformation *d, const fg_scan_result *result) {
  fputs("<path class=\"dots\" d=\"", d->out);
  for (size_t i = 0; i < result->rows; i += 1 + result->rows / 800)
    fprintf(d->out, "M%.0f %.0fh0",
            MARGIN + d->scale * (result->row[i].at_mm.x - d->grid->low_mm[0]),
            MARGIN + d->scale * (result->row[i].at_mm.y - d->grid->low_mm[1]));
  fputs("\"/>\n", d->out);
}

static void put_bar(const deformation *d, int tall) {
  double bar = fg_scan_loop_nice_below(1.5 * d->grid->cell_mm * 1000 / d->magnified);
  char words[32];
  fg_scan_loop_length_words(bar, words, sizeof words);
  fprintf(d->out,
          "<path class=\"bar\" d=\"M%d %dh%.1f\"/><text class=\"start\" x=\"%.1f\" "
          "y=\"%d\">%s of displacement, drawn %.4g times as large</text></svg>",
          MARGIN, tall - 16, d->scale * d->magnified * bar / 1000,
          MARGIN + d->scale * d->magnified * bar / 1000 + 10, tall - 11, words, d->magnified);
}

void fg_scan_loop_page_grid(FILE *out, const fg_scan_result *result) {
  const fg_scan_result_grid *grid = &result->grid;
  if (!grid->lines) return;
  double width = grid->high_mm[0] - grid->low_mm[0], height = grid->high_mm[1] - grid->low_mm[1];
  deformation d = {out, grid, (WIDTH - 2.0 * MARGIN) / fmax(width, height), 0};
  d.magnified = fg_scan_loop_nice_below(reach(grid) / grid->largest_mm);
  int tall = (int)(2 * MARGIN + d.scale * height + 34);
  fprintf(out,
          "<figure><svg class=\"plot\" viewBox=\"0 0 %d %d\" role=\"img\" aria-label=\"The grid of "
          "the picture, and where its points really lie\">\n",
          WIDTH, tall);
  for (int moved = 0; moved < 2; moved++)
    for (size_t i = 0; i < grid->lines; i++)
      put_grid_line(&d, &grid->line[i], moved);
  put_edges(&d, result);
  put_bar(&d, tall);
  fprintf(out,
          "<figcaption>Grey: a grid on the picture, %.3g by %.3g mm. Orange: where its points "
          "really lie. Dots: the edges that were measured.</figcaption></figure>\n",
          width, height);
}
