/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A direction's record cut where its displacement turns. */
#ifndef FG_LOAD_TEST_STROKES_H
#define FG_LOAD_TEST_STROKES_H

#include "load_test/records.h"

/* Samples of one stroke by ascending displacement. */
typedef struct fg_load_stroke {
  double *x, *f;    /* count each */
  double *variance; /* of f about its course, by the noise of both columns */
  double *scatter;  /* squared, of f about the line between its neighbours */
  bool
      *after_hole; /* before this sample lies an unsampled stretch, see fg_load_stroke_find_holes */
  size_t count;
  double resolution_mm;   /* displacement's noise or step: places that are nearer are one */
  size_t first, last;     /* of the direction's samples, the turning points */
  size_t begin, end;      /* of their record */
  double low_mm, high_mm; /* where it turns, without the displacement's noise */
  int sense;              /* +1: displacement grows, -1: shrinks */
  size_t record;          /* strokes of one record follow each other */
  double shift_mm;        /* what has drifted until its middle */
  double drift_mm;        /* and from its begin to its end */
} fg_load_stroke;

typedef struct fg_load_strokes {
  fg_load_stroke *stroke;
  size_t count, capacity;
  double noise_n, noise_mm; /* sd of the columns; the displacement's with its step */
} fg_load_strokes;

/* Strokes of the samples first ... first + count - 1; what is too short for one is left out. */
fg_status fg_load_strokes_cut(fg_context *ctx, const fg_load_test *test,
                              const fg_load_direction *direction, const fg_load_records *records,
                              fg_load_strokes *strokes);
void fg_load_strokes_free(fg_load_strokes *strokes);

/* Samples of the strokes chosen, as one that has not drifted. */
fg_status fg_load_strokes_merge(fg_context *ctx, const fg_load_stroke *const *chosen, size_t count,
                                fg_load_stroke *merged);

/* The same of all strokes of one sense; none: no samples. */
fg_status fg_load_strokes_merge_sense(fg_context *ctx, const fg_load_strokes *strokes, int sense,
                                      fg_load_stroke *merged);

/* Drift up to this share of the stroke's way. */
double fg_load_stroke_drifted(const fg_load_stroke *stroke, double share);

/* Place of its turn, free of drift. */
double fg_load_stroke_turn(const fg_load_stroke *stroke, bool high);

/* Index of the first sample at x or beyond; the count where there is none. */
size_t fg_load_stroke_from(const fg_load_stroke *stroke, double x);

/* Marks the stretches that the record did not sample: much wider than the distances of the places
 * around them. What is regressed on one side of such a stretch says nothing of the other. */
void fg_load_stroke_find_holes(fg_load_stroke *stroke);

/* Samples nearer to each other than this are of one place. */
double fg_load_stroke_place(const fg_load_stroke *stroke);

/* First and last sample about x without an unsampled stretch between; false: x lies in one. */
bool fg_load_stroke_part(const fg_load_stroke *stroke, double x, size_t *first, size_t *last);

/* Every second sample of a stroke, from `from` (0 or 1). */
fg_status fg_load_stroke_half(fg_context *ctx, const fg_load_stroke *stroke, size_t from,
                              fg_load_stroke *half);
void fg_load_stroke_free(fg_load_stroke *stroke);

#endif
