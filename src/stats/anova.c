/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/anova.h"

#include <math.h>
#include <stdlib.h>

#include "core/extended.h"
#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/distribution.h"

/* Sums of one group while they grow. */
typedef struct group_sum {
  fg_extended mean, squares;
  size_t count;
} group_sum;

static void sum_groups(const fg_levels *levels, const fg_extended *y, group_sum *sums) {
  for (size_t i = 0; i < levels->rows; i++) {
    group_sum *g = &sums[levels->index[i]];
    g->mean = fg_extended_add(g->mean, y[i]);
    g->count++;
  }
  for (size_t k = 0; k < levels->count; k++)
    sums[k].mean = fg_extended_divide(sums[k].mean, fg_extended_of((double)sums[k].count));
  for (size_t i = 0; i < levels->rows; i++) {
    group_sum *g = &sums[levels->index[i]];
    fg_extended deviation = fg_extended_subtract(y[i], g->mean);
    g->squares = fg_extended_add(g->squares, fg_extended_square(deviation));
  }
}

static void sum_between(const group_sum *sums, size_t rows, fg_anova_oneway *anova) {
  fg_extended mean = {0, 0}, between = {0, 0}, within = {0, 0};
  for (size_t k = 0; k < anova->groups; k++)
    mean = fg_extended_add(
        mean, fg_extended_multiply(fg_extended_of((double)sums[k].count), sums[k].mean));
  mean = fg_extended_divide(mean, fg_extended_of((double)rows));
  for (size_t k = 0; k < anova->groups; k++) {
    fg_extended square = fg_extended_square(fg_extended_subtract(sums[k].mean, mean));
    between = fg_extended_add(between,
                              fg_extended_multiply(fg_extended_of((double)sums[k].count), square));
    within = fg_extended_add(within, sums[k].squares);
  }
  anova->between_ss = between.value;
  anova->within_ss = within.value;
}

static void finish_oneway(fg_anova_oneway *a) {
  a->between_dof = a->groups - 1;
  a->within_dof = a->rows - a->groups;
  a->between_ms = a->between_ss / (double)a->between_dof;
  a->within_ms = a->within_dof ? a->within_ss / (double)a->within_dof : NAN;
  a->f = a->between_ms / a->within_ms;
  a->p_value = fg_distribution_f_upper(a->f, (double)a->between_dof, (double)a->within_dof);
  a->r2 = a->between_ss / (a->between_ss + a->within_ss);
  a->residual_sd = sqrt(a->within_ms);
}

static fg_status describe_groups(fg_context *ctx, const fg_levels *levels, const group_sum *sums,
                                 fg_anova_oneway *anova) {
  FG_TRY(fg_memory_allocate(ctx, levels->count, sizeof *anova->group, (void **)&anova->group));
  for (size_t k = 0; k < levels->count; k++) {
    fg_anova_group *g = &anova->group[k];
    FG_TRY(fg_text_print(ctx, &g->name, "%s", levels->name[k]));
    g->count = sums[k].count;
    g->mean = sums[k].mean.value;
    g->sd = g->count > 1 ? sqrt(sums[k].squares.value / (double)(g->count - 1)) : NAN;
  }
  return FG_OK;
}

fg_status fg_anova_oneway_compute(fg_context *ctx, const fg_table *table, const char *response,
                                  const char *factor, fg_anova_oneway *anova) {
  fg_status status = FG_OK;
  fg_levels levels = {0};
  group_sum *sums = NULL;
  const fg_extended *y = NULL;
  *anova = (fg_anova_oneway){0};
  FG_TRY_EXIT(fg_table_numbers(ctx, table, response, &y));
  FG_TRY_EXIT(fg_table_levels(ctx, table, factor, true, &levels));
  if (levels.count < 2)
    FG_TRY_EXIT(fg_fail(ctx, FG_ERR_DATA, "%s: column '%s' holds one group only",
                        table->source ? table->source : "table", factor));
  FG_TRY_EXIT(fg_memory_allocate(ctx, levels.count, sizeof *sums, (void **)&sums));
  anova->groups = levels.count;
  anova->rows = levels.rows;
  sum_groups(&levels, y, sums);
  sum_between(sums, levels.rows, anova);
  finish_oneway(anova);
  FG_TRY_EXIT(describe_groups(ctx, &levels, sums, anova));
exit:
  free(sums);
  fg_levels_free(&levels);
  if (status != FG_OK) fg_anova_oneway_free(anova);
  return status;
}

void fg_anova_oneway_free(fg_anova_oneway *anova) {
  if (!anova) return;
  for (size_t i = 0; anova->group && i < anova->groups; i++)
    free(anova->group[i].name);
  free(anova->group);
  *anova = (fg_anova_oneway){0};
}
