/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of a synthetic foil with their geometry fitted, and effects put into them. */
#ifndef FG_TEST_FOIL_ROWS_H
#define FG_TEST_FOIL_ROWS_H

#include <stdlib.h>

#include "effect/columns.h"
#include "random.h"
#include "rows/edge_fit.h"
#include "support/test.h"
#include "synthetic_foil.h"

typedef struct foil_rows {
  fg_measurement m;
  fg_edge_fit edge_fit;
  double *residual_um, *jacobian, *columns;
} foil_rows;

static inline void foil_rows_open(foil_rows *f) {
  fg_context ctx = {0};
  f->m = (fg_measurement){.design = synthetic_design(), .dpi = {4800, 4800}, .foil_count = 1};
  f->m.nominal = synthetic_nominal(&f->m.design);
  f->m.file.width_px = f->m.file.height_px = 9000;
  f->m.foils = calloc(1, sizeof *f->m.foils);
  f->m.foils[0] = synthetic_foil(&f->m.design, &f->m.nominal);
  fg_edge_fit_view view = {.foil = &f->m.foils[0], .measurement = &f->m};
  assert_ok(&ctx, fg_edge_fit_build(&ctx, &view, 1, &f->edge_fit));
  assert_ok(&ctx, fg_edge_fit_fit(&ctx, &f->edge_fit, NULL));
  size_t rows = f->edge_fit.row_count;
  f->residual_um = calloc(rows, sizeof(double));
  f->jacobian = calloc(rows * f->edge_fit.parameters, sizeof(double));
  f->columns = calloc(rows * FG_FIELD_COLUMNS, sizeof(double));
  fg_edge_fit_residual(&f->edge_fit, NULL, f->residual_um, f->jacobian);
}

static inline void foil_rows_close(foil_rows *f) {
  free(f->residual_um);
  free(f->jacobian);
  free(f->columns);
  fg_edge_fit_free(&f->edge_fit);
  synthetic_free(&f->m);
}

/* Noise in every row's place. */
static inline void foil_rows_put_noise(foil_rows *f, double noise_um) {
  uint64_t seed = 7;
  for (size_t i = 0; i < f->edge_fit.row_count; i++)
    f->residual_um[i] = noise_um * random_gaussian(&seed);
}

/* An effect's columns with these amplitudes on top; returns how many columns it has. */
static inline size_t foil_rows_add_effect(foil_rows *f, const fg_effect *effect,
                                          const double *shape, const double *amplitude_um,
                                          size_t amplitudes) {
  size_t count = fg_effect_columns(&f->edge_fit, effect, shape, f->columns);
  for (size_t c = 0; c < amplitudes && c < count; c++)
    for (size_t i = 0; i < f->edge_fit.row_count; i++)
      f->residual_um[i] += amplitude_um[c] * f->columns[c * f->edge_fit.row_count + i];
  return count;
}

#endif
