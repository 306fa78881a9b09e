/* The search for effects and the fit of the geometry in turns. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "effect/columns.h"
#include "explain/settle.h"

/* Rows this far off are left out, if they are fewer than this share. */
#define OUTLIER_SIGMAS 5.0
#define OUTLIER_SHARE  0.02
/* Largest change of an overall radius, and largest coefficient, that an effect may have. */
#define SANE_SHARE 0.03
#define SANE_UM    2000.0
/* Half the height of the rows that a step in the picture blurs. */
#define STEP_HALF_MM 0.08
/* A set that takes no more than this share off what is left has come to rest. */
#define REST_SHARE   0.05
#define THERE_SIGMAS 4.0
#define END_SIGMAS   8.0
enum { END_ROWS = 3 };

void fg_explain_take(const fg_explanations *explanations, size_t explanation, fg_effect_set *set) {
  memset(set, 0, sizeof *set);
  for (size_t e = 0; e < explanations->candidate_count; e++) {
    if (!(explanations->each[explanation].mask >> e & 1) || set->count == FG_EFFECT_SET_MAX)
      continue;
    const fg_candidate *from = &explanations->candidates[e];
    fg_effect_found *to = &set->effects[set->count++];
    *to = (fg_effect_found){.kind = from->kind, .columns = from->columns, .shapes = from->shapes};
    memcpy(to->shape, from->shape, sizeof to->shape);
    if (from->polynomial > FG_EFFECT_LINEAR)
      to->shape[0] = explanations->each[explanation].middle_mm[e];
  }
}

/* Its shape is the middle, which every search finds anew; the fit's is the better one. */
static bool has_middle(const fg_effect_found *effect) {
  return effect->kind->polynomial > FG_EFFECT_LINEAR;
}

/* Numbers of the effects that both sets hold. */
static void keep_numbers(const fg_effect_set *from, fg_effect_set *to) {
  for (size_t e = 0; e < to->count; e++)
    for (size_t k = 0; k < from->count; k++)
      if (to->effects[e].kind == from->effects[k].kind &&
          (to->effects[e].shape[0] == from->effects[k].shape[0] || has_middle(&to->effects[e])))
        to->effects[e] = from->effects[k];
}

bool fg_settle_same_effects(const fg_effect_set *a, const fg_effect_set *b) {
  if (a->count != b->count) return false;
  for (size_t e = 0; e < a->count; e++)
    if (a->effects[e].kind != b->effects[e].kind) return false;
  return true;
}

fg_status fg_settle_put_back(fg_context *ctx, fg_points *points, const fg_effect_set *set,
                             double *residual_um, double *jacobian) {
  size_t rows = points->row_count;
  fg_field_list fields;
  double *shift = NULL, *columns = NULL;
  fg_status status = FG_OK;
  fg_effect_set_fields(points, set, &fields);
  FG_TRY_EXIT(fg_effect_set_shift(ctx, points, set, &shift));
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, rows, FG_EFFECT_COLUMNS_MAX * sizeof *columns, (void **)&columns));
  fg_points_correction correction = {&fields, shift};
  fg_points_residual(points, &correction, residual_um, jacobian);
  for (size_t i = 0; i < rows; i++)
    residual_um[i] *= 1000;
  for (size_t e = 0; e < set->count; e++) {
    const fg_effect_found *effect = &set->effects[e];
    size_t count = fg_effect_columns(points, effect->kind, effect->shape, columns);
    for (size_t c = 0; c < count; c++)
      for (size_t i = 0; i < rows; i++)
        residual_um[i] += effect->coefficient_um[c] * columns[c * rows + i];
  }
exit:
  free(shift);
  free(columns);
  return status;
}

/* Rows far outside what the set leaves elsewhere are no effect of the scanner or the part: an arc
 * that reached into its fillet, a burr. They lose their weight; should there be many, they are no
 * outliers. */
static fg_status drop_outliers(fg_context *ctx, fg_points *points, const double *residual_um) {
  double *absolute = NULL;
  size_t n = 0, out = 0, rows = points->row_count;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *absolute, (void **)&absolute));
  for (size_t i = 0; i < rows; i++)
    if (points->rows[i].weight > 0) absolute[n++] = fabs(residual_um[i]);
  double limit = n ? OUTLIER_SIGMAS * 1.4826 * fg_select(absolute, n, n / 2) : INFINITY;
  free(absolute);
  for (size_t i = 0; i < rows; i++)
    out += fabs(residual_um[i]) > limit;
  if ((double)out > OUTLIER_SHARE * (double)rows) return FG_OK;
  for (size_t i = 0; i < rows; i++)
    if (fabs(residual_um[i]) > limit) points->rows[i].weight = 0;
  return FG_OK;
}

static double third_difference(const double *r, size_t at, int step) {
  size_t k[4];
  for (int i = 0; i < 4; i++)
    k[i] = (size_t)((ptrdiff_t)at + i * step);
  return r[k[0]] - 3 * r[k[1]] + 3 * r[k[2]] - r[k[3]];
}

static bool same_run(const fg_points *points, size_t a, size_t b) {
  const fg_points_row *p = &points->rows[a], *q = &points->rows[b];
  return b < points->row_count && p->view == q->view && p->group == q->group;
}

/* A run's last rows may reach into a fillet; they leave the line of those before them as no others
 * do. Third differences: what is smooth stays out of them. */
static fg_status drop_bad_ends(fg_context *ctx, fg_points *points, const double *residual_um) {
  size_t rows = points->row_count, n = 0;
  double *size = NULL;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *size, (void **)&size));
  for (size_t i = 0; i + 3 < rows; i++)
    if (same_run(points, i, i + 3)) size[n++] = fabs(third_difference(residual_um, i, 1));
  double limit = n ? END_SIGMAS * 1.4826 * fg_select(size, n, n / 2) : INFINITY;
  free(size);
  for (size_t from = 0, to; from < rows; from = to) {
    for (to = from + 1; to < rows && same_run(points, from, to);)
      to++;
    for (size_t k = 0; k < END_ROWS && from + 2 * END_ROWS + 4 < to; k++) {
      size_t low = from + END_ROWS - 1 - k, high = to - END_ROWS + k;
      if (fabs(third_difference(residual_um, low, 1)) > limit)
        for (size_t i = from; i <= low; i++)
          points->rows[i].weight = 0;
      if (fabs(third_difference(residual_um, high, -1)) > limit)
        for (size_t i = high; i < to; i++)
          points->rows[i].weight = 0;
    }
  }
  return FG_OK;
}

void fg_settle_leave_steps_out(fg_points *points, const fg_effect_set *set, double half_mm) {
  for (size_t e = 0; e < set->count; e++)
    for (size_t i = 0; i < points->row_count; i++)
      if (set->effects[e].kind->jumps &&
          fabs((set->effects[e].kind->axis ? points->rows[i].at.y : points->rows[i].at.x) -
               set->effects[e].shape[0]) < half_mm)
        points->rows[i].weight = 0;
}

/* Whether an effect's numbers are more than its uncertainty. */
static bool is_there(const fg_effect_found *effect) {
  for (size_t c = 0; c < effect->columns; c++)
    if (!(fabs(effect->coefficient_um[c]) < THERE_SIGMAS * effect->u_coefficient_um[c]))
      return true;
  return false;
}

/* What the fit has made nothing of is dropped: a second ripple that stood for the curvature of a
 * first one, a smooth effect beside one that has found its shape since. */
static void drop_nothings(fg_effect_set *set) {
  size_t kept = 0, there = 0;
  for (size_t e = 0; e < set->count; e++)
    there += is_there(&set->effects[e]);
  if (!there) return; /* each could go, but not all: they stand for each other */
  for (size_t e = 0; e < set->count; e++)
    if (is_there(&set->effects[e])) set->effects[kept++] = set->effects[e];
  set->count = kept;
}

/* A search under way. */
typedef struct settling {
  fg_effect_set set;
  fg_explanations explanations;
  double *residual_um, *jacobian, *geometry; /* per row; parameters × rows; to come back to */
} settling;

double fg_settle_square(const fg_points *points, const double *residual_um) {
  double sum = 0;
  for (size_t i = 0; i < points->row_count; i++)
    if (!points->views[points->rows[i].view].aside)
      sum += points->rows[i].weight * residual_um[i] * residual_um[i];
  return sum;
}

/* An effect that bends the geometry so far is none. */
static bool is_sane(const fg_points *points, const double *geometry, const fg_effect_set *set) {
  size_t at = 0;
  for (size_t p = 0; p < points->part_count; p++) {
    double was = geometry[at];
    if (!(fabs(points->parts[p].overall_radius_mm / was - 1) < SANE_SHARE)) return false;
    at += 1 + 3 * points->parts[p].bump_count;
  }
  for (size_t e = 0; e < set->count; e++)
    for (size_t c = 0; c < set->effects[e].columns; c++)
      if (!(fabs(set->effects[e].coefficient_um[c]) < SANE_UM)) return false;
  return true;
}

fg_status fg_settle_fit(fg_context *ctx, fg_points *points, fg_effect_set *set, double none,
                        double *geometry, double *residual_um) {
  fg_points_geometry_save(points, geometry);
  fg_status status = fg_joint_fit(ctx, points, set, residual_um);
  if (status != FG_OK && status != FG_ERR_NUMERIC) return status;
  if (status == FG_OK && is_sane(points, geometry, set) &&
      fg_settle_square(points, residual_um) <= none)
    return FG_OK;
  fg_points_geometry_load(points, geometry);
  memset(set, 0, sizeof *set);
  ctx->message[0] = 0;
  return fg_joint_fit(ctx, points, set, residual_um);
}

/* How a search goes about it. With `eager`, ripples and steps are looked for at once: right for
 * them, while a large smooth effect leaves traces in the first round that look like them. Two
 * curves can be made of nearly anything, so they come last. */
typedef struct manner {
  bool eager, two_curves;
} manner;

/* Search and fit in turns from a start without effects. */
static fg_status settle_from(fg_context *ctx, fg_points *points, manner how, settling *at) {
  enum { ROUNDS = 8 };
  fg_effect_set tried = {.count = 0}, last = {.count = 0};
  double left = INFINITY;
  memset(&at->set, 0, sizeof at->set);
  FG_TRY(fg_joint_fit(ctx, points, &at->set, at->residual_um));
  double none = fg_settle_square(points, at->residual_um);
  for (int round = 0; round < (points->coarse ? 2 : ROUNDS); round++) {
    fg_effect_set next;
    fg_explain_request request = {at->residual_um, at->jacobian,           &at->set,
                                  &tried,          how.eager || round > 0, how.two_curves};
    FG_TRY(fg_settle_put_back(ctx, points, &at->set, at->residual_um, at->jacobian));
    FG_TRY(fg_explain_find(ctx, points, &request, &at->explanations));
    fg_explain_take(&at->explanations, 0, &next);
    bool same = fg_settle_same_effects(&last, &next);
    last = next;
    keep_numbers(&at->set, &next);
    at->set = next;
    fg_settle_leave_steps_out(points, &at->set, STEP_HALF_MM);
    FG_TRY(fg_settle_fit(ctx, points, &at->set, none, at->geometry, at->residual_um));
    /* Given up: what was right to first order is not. */
    if (next.count && !at->set.count) at->explanations.right = false;
    if (!at->explanations.right) tried = next;
    FG_TRY(drop_outliers(ctx, points, at->residual_um));
    double before = left;
    left = fg_settle_square(points, at->residual_um);
    bool rests = at->explanations.right || left > (1 - REST_SHARE) * before;
    if (same && rests && round > 0) break;
    drop_nothings(&at->set);
  }
  return FG_OK;
}

/* The eager start, and where it does not come to rest at an explanation that is right, the other,
 * and last two curves; the best one stays. */
static fg_status settle_best(fg_context *ctx, fg_points *points, settling *at) {
  static const manner manners[] = {{true, false}, {false, false}, {true, true}};
  size_t numbers = fg_points_geometry_size(points);
  double best = INFINITY, *geometry = NULL;
  settling kept = *at;
  FG_TRY(
      fg_memory_allocate(ctx, numbers + points->row_count, sizeof *geometry, (void **)&geometry));
  double *residual_um = geometry + numbers;
  fg_status status = FG_OK;
  for (size_t i = 0; i < sizeof manners / sizeof manners[0]; i++) {
    if (i > 0 && points->coarse) break;
    if (manners[i].two_curves && points->view_count < 2) continue;
    FG_TRY_EXIT(settle_from(ctx, points, manners[i], at));
    double left = fg_settle_square(points, at->residual_um);
    if (at->explanations.right) goto exit;
    if (i && !(left <= (1 - REST_SHARE) * best)) continue;
    best = left;
    kept = *at;
    fg_points_geometry_save(points, geometry);
    memcpy(residual_um, at->residual_um, points->row_count * sizeof *residual_um);
  }
  at->set = kept.set;
  at->explanations = kept.explanations;
  fg_points_geometry_load(points, geometry);
  memcpy(at->residual_um, residual_um, points->row_count * sizeof *residual_um);
exit:
  free(geometry);
  return status;
}

fg_status fg_explain_settle(fg_context *ctx, fg_points *points, fg_effect_set *set,
                            fg_explanations *explanations, double *residual_um) {
  settling at = {.residual_um = residual_um};
  fg_status status = FG_OK;
  memset(set, 0, sizeof *set);
  FG_TRY(fg_joint_fit(ctx, points, set, residual_um));
  FG_TRY(drop_bad_ends(ctx, points, residual_um));
  FG_TRY(fg_memory_allocate(ctx, points->row_count, points->parameters * sizeof *at.jacobian,
                            (void **)&at.jacobian));
  FG_TRY_EXIT(fg_memory_allocate(ctx, fg_points_geometry_size(points), sizeof *at.geometry,
                                 (void **)&at.geometry));
  FG_TRY_EXIT(settle_best(ctx, points, &at));
  *set = at.set;
  *explanations = at.explanations;
exit:
  free(at.jacobian);
  free(at.geometry);
  return status;
}
