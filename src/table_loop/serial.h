/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Correlation of neighbours against effects that a series could be mistaken for. */
#ifndef FG_TABLE_LOOP_SERIAL_H
#define FG_TABLE_LOOP_SERIAL_H

#include "table_loop/step.h"

/* Correlation is needed beside a set from this gain on: twice the logarithm of a likelihood ratio
 * that chance reaches once in a hundred times (chi² with one degree of freedom). */
#define FG_ENGINE_SERIAL_NEEDED 6.63
/* An effect of the mean ties with correlation when it shows by itself at this level. */
#define FG_ENGINE_ALIAS_P 0.05

/* The run's candidate of serial correlation, or run->candidates where there is none. */
size_t fg_engine_serial_candidate(const fg_engine_run *run);

/* What correlation gains beside a set, in twice the logarithm of the residual likelihood. */
fg_status fg_engine_serial_gain(fg_context *ctx, const fg_engine_run *run, const fg_engine_set *set,
                                double *gain);

/* Root of twice the logarithm of the likelihood ratio of a spread beside a set. */
fg_status fg_engine_spread_beside(fg_context *ctx, const fg_engine_run *run,
                                  const fg_engine_set *set, const fg_loop_candidate *spread,
                                  double *z);

typedef enum fg_engine_serial_word {
  FG_ENGINE_EFFECT,      /* the effect shows beside correlation */
  FG_ENGINE_CORRELATION, /* correlation is needed, and the effect then no more */
  FG_ENGINE_EITHER,      /* the data cannot tell */
} fg_engine_serial_word;

/* An effect of the mean (a stand of the step) against correlation. */
fg_status fg_engine_weigh_serial(fg_context *ctx, fg_engine_run *run, const fg_engine_stand *effect,
                                 size_t candidate, fg_engine_serial_word *word);

/* Would the effect alone be likelier than correlation alone, parameters counted? */
fg_status fg_engine_likelier(fg_context *ctx, const fg_engine_run *run,
                             const fg_engine_stand *effect, bool *likelier);

#endif
