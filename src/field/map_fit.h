/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fit of a map's splines to displacements over its region, and the modes of their covariance. */
#ifndef FG_FIELD_MAP_FIT_H
#define FG_FIELD_MAP_FIT_H

#include <gsl/gsl_matrix.h>

#include "field/map.h"
#include "foilgauge/status.h"

/* Places over the region of a map, at which displacements are given: x and y by turns, mm. */
typedef struct fg_map_fit {
  fg_map_frame frame;
  fg_point *at; /* owned */
  size_t places;
  gsl_matrix *splines; /* owned; factored normal matrix */
} fg_map_fit;

fg_status fg_map_fit_open(fg_context *ctx, const fg_map_frame *frame, fg_map_fit *fit);
void fg_map_fit_close(fg_map_fit *fit);

/* Fills a map's numbers: least squares. */
void fg_map_fit_splines(const fg_map_fit *fit, const double *moves, double *mm);

/* Appends a mode. */
fg_status fg_map_fit_add_mode(fg_context *ctx, const fg_map_fit *fit, const double *moves,
                              fg_field_map *map);

/* Appends the principal modes of columns of moves, 2 places × count, which are independent of each
 * other and of one standard uncertainty each. At most FG_MAP_PRINCIPAL_MODES. */
enum { FG_MAP_MODES_KEPT = 30, FG_MAP_MODES_MIXED = 16 };
enum { FG_MAP_PRINCIPAL_MODES = FG_MAP_MODES_KEPT + FG_MAP_MODES_MIXED };
fg_status fg_map_fit_add_principal_modes(fg_context *ctx, const fg_map_fit *fit,
                                         const gsl_matrix *moves, fg_field_map *map);

#endif
