/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shift of the part's circles by the scanner, in mean and second moment over models: how the
 * geometry follows the scanner's columns. */
#ifndef FG_EVIDENCE_SHIFT_H
#define FG_EVIDENCE_SHIFT_H

#include "evidence/posterior.h"

/* Covariance that the scanner's amplitudes add to the geometry, mm²: of part p, (X, R, R0) of every
 * bump, and R0 alone. */
typedef struct fg_displacement_part {
  double (*bumps)[3][3]; /* owned */
  double overall;
} fg_displacement_part;

/* Numbers of the geometry in um: of each part R0, then X and R of every bump. */
typedef struct fg_evidence_shift {
  size_t count;
  double *flat;          /* owned; count × rank */
  double *scatter;       /* owned; lower factor of the bumps' own sizes, scatter's count squared */
  double *mean, *second; /* owned; count, count × count: sums over the models, with their weights */
} fg_evidence_shift;

fg_status fg_evidence_shift_open(fg_context *ctx, fg_evidence_search *search,
                                 fg_evidence_shift *shift);
void fg_evidence_shift_close(fg_evidence_shift *shift);

/* Adds the moments under one model. */
fg_status fg_evidence_shift_add(fg_context *ctx, fg_evidence_search *search,
                                const fg_evidence_model *model, double weight,
                                fg_evidence_shift *shift);
fg_status fg_evidence_shift_add_posterior(fg_context *ctx, fg_evidence_search *search,
                                          const fg_evidence_model *model,
                                          const fg_evidence_posterior *posterior, double weight,
                                          fg_evidence_shift *shift);

/* Fills the covariance of the parts, mm². The weights add up to 1. Beside a known shift (else NULL)
 * it is the second moment about the known mean, beyond the known covariance. */
void fg_evidence_shift_spread(const fg_edge_fit *edge_fit, const fg_evidence_shift *shift,
                              const fg_evidence_shift *known, fg_displacement_part *parts);

bool fg_evidence_is_of_scanner(const fg_evidence_part *part);

/* Lists the scanner's columns of a model by their index in its posterior; returns their number. */
size_t fg_evidence_list_scanner_columns(const fg_evidence_search *search,
                                        const fg_evidence_model *model,
                                        size_t list[FG_EVIDENCE_MODEL_COLUMNS]);

#endif
