/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One option beside a model: its likeliest shape, length and size. `evidence` is that of the model
 * with it, `part->log_prior` has what the choice among all of them costs. */
#ifndef FG_EVIDENCE_FIT_H
#define FG_EVIDENCE_FIT_H

#include "evidence/options.h"

/* A model with one option more. */
typedef struct fg_evidence_extension {
  const fg_evidence_option *option;
  fg_evidence_part *part;
  double evidence;
  bool moved; /* its shapes are none of the starts: the problem has no columns of them */
} fg_evidence_extension;

/* Of an effect with shapes: the likeliest of its starts. */
fg_status fg_evidence_fit_effect(fg_context *ctx, fg_evidence_search *search,
                                 const fg_evidence_factor *factor, const fg_evidence_option *option,
                                 fg_evidence_part *part, double *evidence);
/* From there to the likeliest of all; what lacks more of `gain_max`, ln, than finer points can
 * bring is left as it is. Several threads may refine extensions of one model. */
fg_status fg_evidence_refine_effect(fg_context *ctx, const fg_evidence_search *search,
                                    const fg_evidence_factor *factor, double gain_max,
                                    fg_evidence_extension *extension);
fg_status fg_evidence_fit_rival(fg_context *ctx, fg_evidence_search *search,
                                const fg_evidence_factor *factor, const fg_evidence_option *option,
                                fg_evidence_part *part, double *evidence);
/* Finds the size of an effect anew beside the factor's model, which does not hold it, and, where it
 * starts from a grid of one number, its place; `evidence` is that of both together. */
fg_status fg_evidence_refit_effect(fg_context *ctx, fg_evidence_search *search,
                                   const fg_evidence_factor *factor, fg_evidence_part *part,
                                   double *evidence);

/* Amplitudes that are tried of a rival: number i, um. */
enum { FG_EVIDENCE_AMPLITUDES = 11 };
double fg_evidence_amplitude_um(const fg_evidence_prior *prior, int i);

#endif
