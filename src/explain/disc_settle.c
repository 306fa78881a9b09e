/* The search for effects of discs and the fit of their geometry in turns. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "explain/settle.h"

/* Rows this far off are left out, if they are fewer than this share. */
#define OUTLIER_SIGMAS 5.0
#define OUTLIER_SHARE  0.02
/* Half the height of the rows that a step in the picture blurs. */
#define STEP_HALF_MM 0.03

/* Numbers of the effects that both sets hold. */
static void keep_numbers(const fg_effect_set *from, fg_effect_set *to) {
  for (size_t e = 0; e < to->count; e++)
    for (size_t k = 0; k < from->count; k++)
      if (to->effects[e].kind == from->effects[k].kind &&
          to->effects[e].shape[0] == from->effects[k].shape[0])
        to->effects[e] = from->effects[k];
}

/* Residual in units of its row's noise, but for one factor. */
static double in_noise(const fg_points_row *row, double residual) {
  return fabs(residual) * sqrt(row->weight / FG_POINTS_BLOCK);
}

/* Rows far outside what the set leaves elsewhere are no effect of the scanner or the part: an arc
 * that reached into its fillet, a burr. They lose their weight; should there be many, they are no
 * outliers. */
static fg_status drop_outliers(fg_context *ctx, fg_points *points, const double *residual_um) {
  double *absolute = NULL;
  size_t n = 0, out = 0, rows = points->row_count;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *absolute, (void **)&absolute));
  for (size_t i = 0; i < rows; i++)
    if (points->rows[i].weight > 0) absolute[n++] = in_noise(&points->rows[i], residual_um[i]);
  double limit = n ? OUTLIER_SIGMAS * 1.4826 * fg_select(absolute, n, n / 2) : INFINITY;
  free(absolute);
  for (size_t i = 0; i < rows; i++)
    out += in_noise(&points->rows[i], residual_um[i]) > limit;
  if ((double)out > OUTLIER_SHARE * (double)rows) return FG_OK;
  for (size_t i = 0; i < rows; i++)
    if (in_noise(&points->rows[i], residual_um[i]) > limit) points->rows[i].weight = 0;
  return FG_OK;
}

fg_status fg_explain_discs_settle(fg_context *ctx, fg_points *points, fg_effect_set *set,
                                  fg_explanations *explanations, double *residual_um) {
  enum { ROUNDS = 8 };
  double *jacobian = NULL, *geometry = NULL;
  fg_status status = FG_OK;
  memset(set, 0, sizeof *set);
  FG_TRY(fg_joint_fit(ctx, points, set, residual_um));
  double none = fg_settle_square(points, residual_um);
  FG_TRY(fg_memory_allocate(ctx, points->row_count, points->parameters * sizeof *jacobian,
                            (void **)&jacobian));
  FG_TRY_EXIT(fg_memory_allocate(ctx, fg_points_geometry_size(points), sizeof *geometry,
                                 (void **)&geometry));
  for (int round = 0; round < (points->coarse ? 2 : ROUNDS); round++) {
    fg_effect_set next;
    FG_TRY_EXIT(fg_settle_put_back(ctx, points, set, residual_um, jacobian));
    FG_TRY_EXIT(fg_explain_discs_find(ctx, points, residual_um, jacobian, set, explanations));
    fg_explain_take(explanations, 0, &next);
    bool settled = fg_settle_same_effects(set, &next);
    keep_numbers(set, &next);
    *set = next;
    fg_settle_leave_steps_out(points, set, STEP_HALF_MM);
    FG_TRY_EXIT(fg_settle_fit(ctx, points, set, none, geometry, residual_um));
    if (next.count && !set->count) explanations->right = false; /* given up */
    FG_TRY_EXIT(drop_outliers(ctx, points, residual_um));
    if (settled && round > 0) break;
  }
exit:
  free(jacobian);
  free(geometry);
  return status;
}
