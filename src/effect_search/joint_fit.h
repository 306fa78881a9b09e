/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Geometry and effects fitted together. */
#ifndef FG_EFFECT_SEARCH_JOINT_FIT_H
#define FG_EFFECT_SEARCH_JOINT_FIT_H

#include "effect/set.h"

/* From the effects' present numbers and the geometry that stands. `residual_um` (rows, or NULL)
 * gets what is left. */
fg_status fg_joint_fit(fg_context *ctx, fg_edge_fit *edge_fit, fg_effect_set *set,
                       double *residual_um);

/* The geometry alone, beside effects whose numbers stand. */
fg_status fg_joint_fit_geometry(fg_context *ctx, fg_edge_fit *edge_fit, const fg_effect_set *set,
                                double *residual_um);

/* What the effects of a fit add to the covariance of its geometry's noise, mm². */
typedef struct fg_joint_fit_part {
  double overall;        /* variance of R0 */
  double (*bumps)[3][3]; /* owned; of (X, R, R0) of every bump */
} fg_joint_fit_part;

/* A fit that stays what it is whatever is fitted next to the same points: the set with its numbers,
 * and what it does at the geometry that was fitted beside it. */
typedef struct fg_joint_fit_result {
  const fg_edge_fit *edge_fit; /* their rows and views; the geometry is not read */
  fg_effect_set set;
  fg_field_list fields;     /* of the scanner */
  fg_point *shift_mm;       /* owned; per row: where the part's own effects moved it */
  fg_joint_fit_part *parts; /* owned */
} fg_joint_fit_result;

/* Fits from the set's present numbers. The points must outlive the result. */
fg_status fg_joint_fit_open(fg_context *ctx, fg_edge_fit *edge_fit, const fg_effect_set *set,
                            fg_joint_fit_result *result);
void fg_joint_fit_close(fg_joint_fit_result *result);

#endif
