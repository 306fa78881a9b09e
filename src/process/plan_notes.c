/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Notes on settings that differ from the plan's levels. */
#include <math.h>
#include <stdlib.h>

#include "core/text.h"
#include "foilgauge/plan.h"

/* The setting of the first run at a coded place; false: there is none. */
static bool find_setting(const fg_plan *plan, size_t k, double coded, double *setting) {
  for (size_t i = 0; i < plan->runs; i++) {
    if (fabs(plan->run[i].coded[k] - coded) > 1e-9) continue;
    *setting = fg_plan_setting(plan, i, k);
    return true;
  }
  return false;
}

/* "temperature_C: multiples of 7: 504 for 500, 553 for 550, 595 for 600" */
static fg_status note_rounded(fg_context *ctx, const fg_plan *plan, size_t k, char **text) {
  double asked[3] = {plan->low[k], (plan->low[k] + plan->high[k]) / 2, plan->high[k]}, setting;
  bool begun = false;
  for (int i = 0; i < 3; i++) {
    if (!find_setting(plan, k, i - 1, &setting)) continue;
    if (fabs(setting - asked[i]) <= 1e-9 * plan->step[k]) continue;
    if (!begun)
      FG_TRY(fg_text_append(ctx, text, "%s: multiples of %g, so ", plan->name[k], plan->step[k]));
    FG_TRY(fg_text_append(ctx, text, "%s%.6g for %.6g", begun ? ", " : "", setting, asked[i]));
    begun = true;
  }
  return begun ? fg_text_append(ctx, text, "\n") : FG_OK;
}

static fg_status note_below_zero(fg_context *ctx, const fg_plan *plan, size_t k, char **text) {
  double min = INFINITY;
  if (!(plan->low[k] > 0 && plan->high[k] > 0)) return FG_OK;
  for (size_t i = 0; i < plan->runs; i++)
    min = fmin(min, fg_plan_setting(plan, i, k));
  if (min >= 0) return FG_OK;
  double low = fmin(plan->low[k], plan->high[k]), high = fmax(plan->low[k], plan->high[k]);
  return fg_text_append(
      ctx, text,
      "%s: an axial run is at %.6g, below 0: if that cannot be set, take --axial below %.3g, or "
      "levels closer together\n",
      plan->name[k], min, floor(200 * low / (high - low) + 100) / 100);
}

fg_status fg_plan_notes(fg_context *ctx, const fg_plan *plan, char **text) {
  fg_status status = fg_text_print(ctx, text, "%s", "");
  for (size_t k = 0; k < plan->factors && status == FG_OK; k++) {
    if (plan->step[k] > 0) status = note_rounded(ctx, plan, k, text);
    if (status == FG_OK) status = note_below_zero(ctx, plan, k, text);
  }
  if (status == FG_OK) return FG_OK;
  free(*text);
  *text = NULL;
  return status;
}
