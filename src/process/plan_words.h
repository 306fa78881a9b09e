/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Products of two-level factors as bit masks with a sign: A:A = I, so multiplying is xor. */
#ifndef FG_PROCESS_PLAN_WORDS_H
#define FG_PROCESS_PLAN_WORDS_H

#include "foilgauge/plan.h"

typedef struct fg_word {
  uint32_t mask;
  int sign;
} fg_word;

/* "A:B" or "-A:B" over the plan's factor names. */
fg_status fg_word_parse(fg_context *ctx, const fg_plan *plan, const char *text, fg_word *word);

/* Returns the index of the factor of that name, or plan->factors. */
size_t fg_plan_find_factor(const fg_plan *plan, const char *name, size_t length);

/* Fills word, word_sign and resolution with all products of the generating words. */
fg_status fg_plan_close_words(fg_context *ctx, const fg_word *generating, size_t count,
                              fg_plan *plan);

/* +1 or -1 at coded corners. */
int fg_word_value(const fg_word *word, const double *coded);

#endif
