/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Options of a model: every named effect that these rows can show, over its starting shapes, and
 * every rival, each with its columns in the problem. */
#ifndef FG_EVIDENCE_OPTIONS_H
#define FG_EVIDENCE_OPTIONS_H

#include "effect/set.h"
#include "evidence/model.h"

/* Prior probability of each cause, named or not: about one of them is expected in a scan. */
#define FG_EVIDENCE_PRIOR 0.03

enum { FG_EVIDENCE_OPTIONS = 200 };

/* Lists the options and adds their columns, those of the bumps' scatter first. */
fg_status fg_evidence_list_options(fg_context *ctx, const double *jacobian,
                                   fg_evidence_search *search);

/* Adds the columns of an effect with this shape; returns the index of the first. */
fg_status fg_evidence_add_effect(fg_context *ctx, fg_evidence_problem *problem,
                                 const fg_effect *effect, const double *shape, size_t *first,
                                 size_t *count);

/* Fills start i of an effect's shapes and, of an effect with a grid, how far from it the best may
 * lie. */
void fg_evidence_find_start(const fg_edge_fit *edge_fit, const fg_effect *effect, size_t i,
                            double shape[FG_FIELD_SHAPES], double reach[FG_FIELD_SHAPES]);

/* Fills the prior variances of an effect's columns, um². */
void fg_evidence_effect_variances(const fg_evidence_prior *prior, const fg_effect *effect,
                                  size_t count, double *variance);

#endif
