/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strokes: a direction's record cut at the turns of its displacement. */
#ifndef FG_LOAD_TEST_STROKES_H
#define FG_LOAD_TEST_STROKES_H

#include "load_test/records.h"

/* Samples of one stroke, sorted by displacement. */
typedef struct fg_load_stroke {
  double *x, *f;    /* count each */
  double *variance; /* of f, by the noise of both columns */
  double *scatter;  /* squared deviation of f from the line between its neighbours */
  bool
      *after_hole; /* an unsampled stretch lies before this sample, see fg_load_stroke_find_holes */
  size_t count;
  double resolution_mm; /* displacement's noise or step: places nearer to each other count as one */
  size_t first, last;   /* indices into the direction's samples: the turning points */
  size_t begin, end;    /* of their record */
  double low_mm, high_mm; /* turns, without the displacement's noise */
  int sense;              /* +1: displacement grows, -1: shrinks */
  size_t record;          /* index of the record; strokes of one record follow each other */
  double shift_mm;        /* drift until its middle */
  double drift_mm;        /* drift from begin to end */
} fg_load_stroke;

typedef struct fg_load_strokes {
  fg_load_stroke *stroke;
  size_t count, capacity;
  bool *left_out;           /* of the direction's samples: they take no part */
  double noise_n, noise_mm; /* sd of the columns; the displacement's with its step */
} fg_load_strokes;

/* Cuts the samples first ... first + count - 1 into strokes; pieces too short for one are left out,
 * and so are samples that load_test/usable.h marks. Needs the travel and the step. */
fg_status fg_load_strokes_cut(fg_context *ctx, const fg_load_test *test,
                              fg_load_direction *direction, const fg_load_records *records,
                              fg_load_strokes *strokes);
void fg_load_strokes_free(fg_load_strokes *strokes);

/* Merges the samples of chosen strokes into one, corrected for drift. */
fg_status fg_load_strokes_merge(fg_context *ctx, const fg_load_stroke *const *chosen, size_t count,
                                fg_load_stroke *merged);

/* Merges all strokes of one sense; none: no samples. */
fg_status fg_load_strokes_merge_sense(fg_context *ctx, const fg_load_strokes *strokes, int sense,
                                      fg_load_stroke *merged);

/* Returns the drift up to this share of the stroke's travel. */
double fg_load_stroke_drifted(const fg_load_stroke *stroke, double share);

/* Returns the place of its turn, corrected for drift. */
double fg_load_stroke_turn(const fg_load_stroke *stroke, bool high);

/* Returns the index of the first sample at x or beyond; the count when there is none. */
size_t fg_load_stroke_from(const fg_load_stroke *stroke, double x);

/* Marks unsampled stretches: much wider than the distances of the places around them. A regression
 * on one side of such a stretch is not valid on the other. */
void fg_load_stroke_find_holes(fg_load_stroke *stroke);

/* Returns the distance below which samples count as one place. */
double fg_load_stroke_place(const fg_load_stroke *stroke);

/* Finds the first and last sample about x without an unsampled stretch between; false: x lies in
 * one. */
bool fg_load_stroke_part(const fg_load_stroke *stroke, double x, size_t *first, size_t *last);

/* Copies every second sample of a stroke, from `from` (0 or 1). */
fg_status fg_load_stroke_half(fg_context *ctx, const fg_load_stroke *stroke, size_t from,
                              fg_load_stroke *half);
void fg_load_stroke_free(fg_load_stroke *stroke);

#endif
