/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Least-squares fit of geometry and effects together. */
#ifndef FG_EFFECT_SEARCH_JOINT_FIT_H
#define FG_EFFECT_SEARCH_JOINT_FIT_H

#include "effect/set.h"

/* Fits from the effects' present numbers and the present geometry. `residual_um` (rows, or NULL)
 * gets the residual. */
fg_status fg_joint_fit(fg_context *ctx, fg_edge_fit *edge_fit, fg_effect_set *set,
                       double *residual_um);

/* Fits the geometry alone, with the effects' numbers held. */
fg_status fg_joint_fit_geometry(fg_context *ctx, fg_edge_fit *edge_fit, const fg_effect_set *set,
                                double *residual_um);

/* Variance, mm², of a part's geometry by the correction of the scanner's effects. The geometry is
 * that of the least-squares circles, so effects of the part add nothing of their own: they count as
 * far as they make the scanner's effects uncertain. */
typedef struct fg_joint_fit_part {
  double overall;        /* variance of R0 */
  double (*bumps)[3][3]; /* owned; of (X, R, R0) of every bump */
} fg_joint_fit_part;

/* Result of a joint fit, independent of later fits to the same edge fit: the set with its numbers,
 * and its displacements at the geometry fitted beside it. */
typedef struct fg_joint_fit_result {
  const fg_edge_fit *edge_fit; /* source of rows and scans; its geometry is not read */
  fg_effect_set set;
  fg_field_list fields;     /* of the scanner */
  fg_joint_fit_part *parts; /* owned */
} fg_joint_fit_result;

/* Fits from the set's present numbers. `edge_fit` must outlive the result. */
fg_status fg_joint_fit_open(fg_context *ctx, fg_edge_fit *edge_fit, const fg_effect_set *set,
                            fg_joint_fit_result *result);
void fg_joint_fit_close(fg_joint_fit_result *result);

#endif
