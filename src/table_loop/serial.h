/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decision between serial correlation and effects that resemble it. */
#ifndef FG_TABLE_LOOP_SERIAL_H
#define FG_TABLE_LOOP_SERIAL_H

#include "table_loop/step.h"

/* Gain above which correlation is needed beside a set: 2 ln of a likelihood ratio that chance
 * reaches once in a hundred times (chi² with 1 dof). */
#define FG_ENGINE_SERIAL_NEEDED 6.63
/* Level at which an effect of the mean, significant by itself, ties with correlation. */
#define FG_ENGINE_ALIAS_P 0.05

/* Returns the run's candidate of serial correlation, or run->candidates when there is none. */
size_t fg_engine_serial_candidate(const fg_engine_run *run);

/* Computes the gain of correlation beside a set, 2 ln of the residual likelihood's ratio. */
fg_status fg_engine_serial_gain(fg_context *ctx, const fg_engine_run *run, const fg_engine_set *set,
                                double *gain);

/* Computes the root of 2 ln of the likelihood ratio of a spread beside a set. */
fg_status fg_engine_spread_beside(fg_context *ctx, const fg_engine_run *run,
                                  const fg_engine_set *set, const fg_loop_candidate *spread,
                                  double *z);

typedef enum fg_engine_serial_word {
  FG_ENGINE_EFFECT,      /* the effect is significant beside correlation */
  FG_ENGINE_CORRELATION, /* correlation is needed, and the effect is not significant beside it */
  FG_ENGINE_EITHER,      /* undecided by the data */
} fg_engine_serial_word;

/* Weighs an effect of the mean (a stand of the step) against correlation, beside which it is
 * significant at that level or not. */
fg_status fg_engine_weigh_serial(fg_context *ctx, fg_engine_run *run, const fg_engine_stand *effect,
                                 size_t candidate, double level, fg_engine_serial_word *word);

/* Tests whether the effect alone is likelier than correlation alone, with a penalty per parameter.
 */
fg_status fg_engine_likelier(fg_context *ctx, const fg_engine_run *run,
                             const fg_engine_stand *effect, bool *likelier);

#endif
