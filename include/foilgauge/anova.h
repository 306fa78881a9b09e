/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One-way analysis of variance: test of equal means of groups.
 *
 * Sums in extended precision from the decimal text, so that 13 constant leading digits cost none
 * of the answer (Simon and Lesage 1989). Several factors: regression.h.
 */
#ifndef FOILGAUGE_ANOVA_H
#define FOILGAUGE_ANOVA_H

#include <stddef.h>

#include "foilgauge/status.h"
#include "foilgauge/table.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_anova_group {
  char *name;
  size_t count;
  double mean, sd; /* sd is NaN for one number */
} fg_anova_group;

typedef struct fg_anova_oneway {
  size_t groups, rows;
  fg_anova_group *group;
  size_t between_dof, within_dof;
  double between_ss, within_ss, between_ms, within_ms;
  double f, p_value; /* NaN without dof within the groups */
  double r2, residual_sd;
} fg_anova_oneway;

/* `factor` is read as names, also when it holds numbers. FG_ERR_DATA: a column or a cell is
 * missing, one group only. Free with fg_anova_oneway_free. */
fg_status fg_anova_oneway_compute(fg_context *ctx, const fg_table *table, const char *response,
                                  const char *factor, fg_anova_oneway *anova);
void fg_anova_oneway_free(fg_anova_oneway *anova);

#ifdef __cplusplus
}
#endif
#endif
