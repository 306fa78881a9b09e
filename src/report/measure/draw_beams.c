/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/measure/draw_beams.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"

/* Residuals are drawn no longer than this: a longer one would cover its neighbours. */
static const double whisker_max_mm = 1.0;

/* Draws residuals of a long edge's stations against the line between two corners, one of several
 * stations. */
static fg_status draw_whiskers(fg_context *ctx, fg_canvas *canvas, const fg_beam_edge *edge,
                               fg_point from, fg_point to, double magnification) {
  double length = hypot(to.x - from.x, to.y - from.y);
  fg_point out = {(to.y - from.y) / length, -(to.x - from.x) / length};
  double step_px = length / (double)edge->count * canvas->px_per_mm[0];
  size_t every = 1 + (size_t)(1.2 * canvas->unit_px / step_px), used = 0;
  void *block;
  FG_TRY(fg_memory_allocate(ctx, edge->count / every + 1, sizeof(fg_point[2]), &block));
  fg_point(*whiskers)[2] = block;
  for (size_t i = 0; i < edge->count; i += every) {
    const fg_disc_point *s = &edge->stations[i];
    double off = (s->at.x - from.x) * out.x + (s->at.y - from.y) * out.y;
    double drawn = fmin(fmax(off * magnification, -whisker_max_mm), whisker_max_mm);
    if (!s->used) continue;
    whiskers[used][0] = s->at;
    whiskers[used][1] = (fg_point){s->at.x + drawn * out.x, s->at.y + drawn * out.y};
    used++;
  }
  fg_status status = fg_canvas_segments(ctx, canvas, (const fg_point(*)[2])whiskers, used,
                                        (fg_pen){FG_COLOUR_RESIDUAL, 0.7, 0});
  free(block);
  return status;
}

static fg_status draw_lines(fg_context *ctx, fg_canvas *canvas, const fg_beam *beam) {
  const fg_point *c = beam->corners_mm;
  const fg_point sides[3][2] = {{c[0], c[1]}, {c[1], c[2]}, {c[2], c[3]}};
  const fg_point thin[2][2] = {{c[3], c[0]}, {beam->root_mm, beam->tip_mm}};
  bool sized = isfinite(beam->length_mm);
  FG_TRY(fg_canvas_segments(ctx, canvas, thin, 2, (fg_pen){FG_COLOUR_OVERALL, 0.9, 6}));
  FG_TRY(fg_canvas_segments(ctx, canvas, sides, 1, (fg_pen){FG_COLOUR_BUMP, 1.6, 0}));
  if (sized)
    FG_TRY(fg_canvas_segments(ctx, canvas, sides + 1, 1, (fg_pen){FG_COLOUR_BUMP, 1.6, 0}));
  return fg_canvas_segments(ctx, canvas, sides + 2, 1, (fg_pen){FG_COLOUR_BUMP, 1.6, 0});
}

static fg_status draw_beam(fg_context *ctx, fg_canvas *canvas, const fg_beam *beam,
                           double magnification) {
  fg_point middle = {0.5 * (beam->root_mm.x + beam->tip_mm.x),
                     0.5 * (beam->root_mm.y + beam->tip_mm.y)};
  char number[16];
  const fg_point *c = beam->corners_mm;
  if (!(beam->flags & FG_BEAM_NOT_FITTED)) {
    FG_TRY(draw_whiskers(ctx, canvas, &beam->edges[FG_BEAM_LEFT], c[0], c[1], magnification));
    FG_TRY(draw_whiskers(ctx, canvas, &beam->edges[FG_BEAM_RIGHT], c[2], c[3], magnification));
    FG_TRY(draw_lines(ctx, canvas, beam));
  }
  snprintf(number, sizeof number, "%d", beam->number);
  return fg_canvas_text(ctx, canvas, middle, 12, 0.5, FG_COLOUR_TEXT, number);
}

fg_status fg_draw_beams(fg_context *ctx, fg_canvas *canvas, const fg_foil *foil,
                        double magnification) {
  for (size_t i = 0; i < foil->beam_count; i++)
    FG_TRY(draw_beam(ctx, canvas, &foil->beams[i], magnification));
  return FG_OK;
}
