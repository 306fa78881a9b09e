#include "loop/scan_loop.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"

/* Rows fewer than this cannot carry a search for effects. */
enum { ROWS_LEAST = 60, TIED_MOST = 6 };

static fg_status measure_all(fg_context *ctx, const char *const *paths, const fg_design *design,
                             fg_scan_loop *loop) {
  fg_measure_options options = {.dpi = loop->options.dpi, .threads = loop->options.threads};
  for (size_t i = 0; i < loop->scan_count; i++)
    FG_TRY(fg_measure_scan(ctx, paths[i], design, &options, &loop->before[i]));
  const fg_measurement *first = &loop->before[0];
  for (size_t i = 1; i < loop->scan_count; i++)
    for (int axis = 0; axis < 2; axis++)
      if (fabs(loop->before[i].dpi[axis] / first->dpi[axis] - 1) > 1e-4)
        return fg_fail(ctx, FG_ERR_DATA,
                       "%s has %g dpi and %s has %g dpi: scans of one loop must have one resolution",
                       paths[0], first->dpi[axis], paths[i], loop->before[i].dpi[axis]);
  return FG_OK;
}

static fg_status check_same_foils(fg_context *ctx, const fg_scan_loop *loop) {
  for (size_t i = 1; i < loop->scan_count; i++)
    if (loop->before[i].foil_count != loop->before[0].foil_count)
      return fg_fail(ctx, FG_ERR_DATA,
                     "%s shows %zu foils and %s %zu: not the same foils (--same-foil)",
                     loop->before[0].scan, loop->before[0].foil_count, loop->before[i].scan,
                     loop->before[i].foil_count);
  return FG_OK;
}

/* Every foil of every scan as a view; with --same-foil, foil k of each scan is one part. */
static fg_status build_points(fg_context *ctx, fg_scan_loop *loop) {
  size_t total = 0, n = 0;
  for (size_t i = 0; i < loop->scan_count; i++) total += loop->before[i].foil_count;
  fg_points_view *views = NULL;
  FG_TRY(fg_memory_allocate(ctx, total, sizeof *views, (void **)&views));
  for (size_t i = 0; i < loop->scan_count; i++)
    for (size_t f = 0; f < loop->before[i].foil_count; f++, n++)
      views[n] = (fg_points_view){&loop->before[i].foils[f], &loop->before[i], i,
                                  loop->options.same_foil ? f : n, loop->hold_out[i]};
  fg_status status = fg_points_build(ctx, views, n, &loop->points);
  free(views);
  if (status == FG_OK && loop->points.row_count < ROWS_LEAST)
    status = fg_fail(ctx, FG_ERR_DATA, "%zu edge rows are too few to look for effects",
                     loop->points.row_count);
  return status;
}

/* Columns of the set's effects at the present geometry, um per um. */
static fg_status set_columns(fg_context *ctx, const fg_points *points, const fg_scan_set *set,
                             double **columns, size_t *count) {
  *count = 0;
  FG_TRY(fg_memory_allocate(ctx, points->row_count,
                            (set->count * FG_LOOP_COLUMNS + 1) * sizeof **columns,
                            (void **)columns));
  for (size_t e = 0; e < set->count; e++)
    *count += fg_points_effect_columns(points, set->effects[e].id, set->effects[e].shape,
                                       *columns + *count * points->row_count);
  return FG_OK;
}

/* Runs the engine on what the set leaves. */
static fg_status run_engine(fg_context *ctx, fg_scan_loop *loop, const fg_loop_effect *effects,
                            fg_loop_result *result) {
  fg_points *points = &loop->points;
  double *residual = NULL, *jacobian = NULL, *extra = NULL, *shift = NULL;
  size_t extra_count = 0;
  fg_points_problem problem = {0};
  fg_field_list fields;
  fg_status status = FG_OK;
  fg_loop_options options = {.effects = effects, .seed = loop->options.seed, .simulations = 299};
  FG_TRY_EXIT(fg_memory_allocate(ctx, points->row_count, sizeof *residual, (void **)&residual));
  FG_TRY_EXIT(fg_memory_allocate(ctx, points->row_count * points->parameters, sizeof *jacobian,
                                 (void **)&jacobian));
  fg_scan_fields(points, &loop->set, &fields);
  FG_TRY_EXIT(fg_scan_shift(ctx, points, &loop->set, &shift));
  fg_points_correction correction = {&fields, shift};
  fg_points_residual(points, &correction, residual, jacobian);
  FG_TRY_EXIT(set_columns(ctx, points, &loop->set, &extra, &extra_count));
  FG_TRY_EXIT(fg_points_problem_build(ctx, points, residual, jacobian, extra, extra_count,
                                      &problem));
  FG_TRY_EXIT(fg_loop_run(ctx, &problem.problem, &options, result));
exit:
  free(residual);
  free(jacobian);
  free(extra);
  free(shift);
  fg_points_problem_free(&problem);
  return status;
}

static void add_effect(fg_scan_set *set, const char *id, const double *shape, size_t shapes,
                       const double *coefficient, size_t columns, size_t claim) {
  if (set->count == FG_SCAN_EFFECTS) return;
  fg_scan_effect *e = &set->effects[set->count++];
  *e = (fg_scan_effect){.id = id, .columns = columns, .shapes = shapes, .claim = claim};
  for (size_t c = 0; c < columns && coefficient; c++) e->coefficient_um[c] = coefficient[c];
  for (size_t s = 0; s < shapes; s++) e->shape[s] = shape[s];
}

static void take_claims(fg_scan_loop *loop, const fg_loop_result *result, size_t first_claim) {
  for (size_t i = 0; i < result->claims; i++) {
    const fg_loop_claim *claim = &result->claim[i];
    const fg_loop_effect *effect = claim->candidate.effect;
    if (!effect || strncmp(effect->level, "points", 6)) continue;
    add_effect(&loop->set, effect->id, claim->shape, effect->shapes, claim->coefficient,
               claim->columns, first_claim + i);
    loop->tied |= claim->verdict == FG_LOOP_TIED && first_claim == 0;
  }
}

static fg_scan_error summarise(fg_context *ctx, const fg_points *points, const double *residual) {
  fg_scan_error e = {NAN, NAN, NAN, NAN, NAN};
  double sum = 0, n = 0, held = 0, held_n = 0, *absolute = NULL;
  size_t count = 0;
  if (fg_memory_allocate(ctx, points->row_count, sizeof *absolute, (void **)&absolute) != FG_OK)
    return e;
  for (size_t i = 0; i < points->row_count; i++) {
    double square = residual[i] * residual[i];
    if (points->views[points->rows[i].view].aside) {
      held += square;
      held_n++;
      continue;
    }
    sum += square;
    n++;
    absolute[count++] = fabs(residual[i]);
  }
  if (n > 0) {
    e.rms = sqrt(sum / n);
    e.robust_sd = 1.4826 * fg_select(absolute, count, count / 2);
    e.p95 = fg_select(absolute, count, count * 95 / 100);
    e.maximum = fg_select(absolute, count, count - 1);
  }
  if (held_n > 0) e.held_out_rms = sqrt(held / held_n);
  free(absolute);
  return e;
}

static fg_status correct_all(fg_context *ctx, const fg_scan_loop *loop, const fg_scan_set *set,
                             fg_measurement *after) {
  fg_field_list fields;
  double *shift = NULL;
  fg_scan_fields(&loop->points, set, &fields);
  fg_status status = fg_scan_shift(ctx, &loop->points, set, &shift);
  for (size_t i = 0; i < loop->scan_count && status == FG_OK; i++)
    status = fg_scan_correct(ctx, &loop->before[i], &fields, &loop->points, i, shift,
                             loop->options.threads, &after[i]);
  free(shift);
  return status;
}

/* ---- ties ---- */

static void widen(double range[2], double value) {
  if (!isfinite(value)) return;
  if (!(value >= range[0])) range[0] = value;
  if (!(value <= range[1])) range[1] = value;
}

static void widen_ranges(const fg_measurement *m, fg_scan_range *ranges, size_t foil) {
  const fg_foil *f = &m->foils[foil];
  for (size_t b = 0; b < f->bump_count; b++) {
    /* A range holds its value's own uncertainty too: the truth lies in it, not between fits. */
    double ur = 2 * f->bumps[b].u_radius_mm, uh = 2 * f->bumps[b].u_height_mm;
    widen(ranges[b].radius_mm, f->bumps[b].radius_mm - ur);
    widen(ranges[b].radius_mm, f->bumps[b].radius_mm + ur);
    widen(ranges[b].height_mm, f->bumps[b].height_mm - uh);
    widen(ranges[b].height_mm, f->bumps[b].height_mm + uh);
  }
  widen(ranges[f->bump_count].radius_mm, f->overall.radius_mm - 2 * f->overall.u_radius_mm);
  widen(ranges[f->bump_count].radius_mm, f->overall.radius_mm + 2 * f->overall.u_radius_mm);
}

static fg_status allocate_ranges(fg_context *ctx, fg_scan_loop *loop) {
  size_t foils = 0;
  for (size_t i = 0; i < loop->scan_count; i++) foils += loop->before[i].foil_count;
  FG_TRY(fg_memory_allocate(ctx, foils, sizeof *loop->ranges, (void **)&loop->ranges));
  for (size_t i = 0, k = 0; i < loop->scan_count; i++)
    for (size_t f = 0; f < loop->before[i].foil_count; f++, k++) {
      size_t count = loop->before[i].foils[f].bump_count + 1;
      FG_TRY(fg_memory_allocate(ctx, count, sizeof **loop->ranges, (void **)&loop->ranges[k]));
      for (size_t b = 0; b < count; b++)
        loop->ranges[k][b] = (fg_scan_range){{NAN, NAN}, {NAN, NAN}};
    }
  return FG_OK;
}

static void widen_all(fg_scan_loop *loop, const fg_measurement *measurements) {
  for (size_t i = 0, k = 0; i < loop->scan_count; i++)
    for (size_t f = 0; f < loop->before[i].foil_count; f++, k++)
      if (f < measurements[i].foil_count &&
          measurements[i].foils[f].bump_count == loop->before[i].foils[f].bump_count)
        widen_ranges(&measurements[i], loop->ranges[k], f);
}

static void put_candidate(fg_scan_set *set, const fg_loop_candidate *candidate, size_t claim) {
  const fg_loop_effect *effect = candidate->effect;
  double shape[FG_LOOP_SHAPES] = {0};
  if (!effect || !effect->columns) return;
  const fg_field_row *field = fg_field_find(effect->id);
  size_t columns = field ? field->columns : strstr(effect->id, "ovality") ? 2 : 1;
  add_effect(set, effect->id, shape, effect->shapes, NULL, columns, claim);
}

/* The set with one member of a claim's class in the winner's place. */
static void replace_winner(const fg_scan_loop *loop, size_t claim, const fg_loop_alias *alias,
                           fg_scan_set *set) {
  set->count = 0;
  for (size_t e = 0; e < loop->set.count; e++)
    if (loop->set.effects[e].claim != claim) set->effects[set->count++] = loop->set.effects[e];
  put_candidate(set, &alias->candidate, claim);
  if (alias->sum) put_candidate(set, &alias->second, claim);
}

/* What the dimensions are under every tied explanation. A member that cannot be fitted (its shape
 * is not known) is passed over. */
static fg_status find_ranges(fg_context *ctx, fg_scan_loop *loop) {
  fg_status status = FG_OK;
  fg_measurement *tried = NULL;
  FG_TRY(allocate_ranges(ctx, loop));
  FG_TRY(fg_memory_allocate(ctx, loop->scan_count, sizeof *tried, (void **)&tried));
  widen_all(loop, loop->after);
  for (size_t c = 0; c < loop->engine.claims && status == FG_OK; c++) {
    const fg_loop_claim *claim = &loop->engine.claim[c];
    for (size_t a = 0; a < claim->aliases && a < TIED_MOST && status == FG_OK; a++) {
      fg_scan_set set;
      if (claim->alias[a].candidate.effect->shapes) continue;
      replace_winner(loop, c, &claim->alias[a], &set);
      status = fg_scan_refit(ctx, &loop->points, &set, NULL);
      if (status == FG_ERR_NUMERIC) {
        status = FG_OK;
        continue;
      }
      if (status == FG_OK) status = correct_all(ctx, loop, &set, tried);
      if (status == FG_OK) widen_all(loop, tried);
      for (size_t i = 0; i < loop->scan_count; i++) fg_measurement_free(&tried[i]);
    }
  }
  free(tried);
  /* The geometry in force is the winner's again. */
  if (status == FG_OK) status = fg_scan_refit(ctx, &loop->points, &loop->set, NULL);
  return status;
}

/* ---- the loop ---- */

static fg_status fit_and_record(fg_context *ctx, fg_scan_loop *loop, double **residual,
                                fg_scan_error *error) {
  if (!*residual)
    FG_TRY(fg_memory_allocate(ctx, loop->points.row_count, sizeof **residual, (void **)residual));
  FG_TRY(fg_scan_refit(ctx, &loop->points, &loop->set, *residual));
  *error = summarise(ctx, &loop->points, *residual);
  return FG_OK;
}

static void find_verdict(fg_scan_loop *loop) {
  bool listed = loop->engine.claims > 0, rest = loop->has_free && loop->free_engine.claims > 0;
  loop->verdict = listed && rest ? FG_LOOP_PARTLY
                  : listed       ? FG_LOOP_EXPLAINED
                  : rest         ? FG_LOOP_UNATTRIBUTED
                                 : FG_LOOP_CLEAN;
}

static fg_status search(fg_context *ctx, fg_scan_loop *loop) {
  FG_TRY(fit_and_record(ctx, loop, &loop->residual_before, &loop->error_before));
  FG_TRY(run_engine(ctx, loop, fg_points_effects(), &loop->engine));
  take_claims(loop, &loop->engine, 0);
  FG_TRY(fit_and_record(ctx, loop, &loop->residual_after, &loop->error_after));
  FG_TRY(run_engine(ctx, loop, fg_points_free_effects(), &loop->free_engine));
  loop->has_free = true;
  take_claims(loop, &loop->free_engine, FG_LOOP_CLAIMS);
  if (loop->free_engine.claims)
    FG_TRY(fit_and_record(ctx, loop, &loop->residual_after, &loop->error_after));
  loop->noise_floor_um = loop->free_engine.noise_floor;
  FG_TRY(correct_all(ctx, loop, &loop->set, loop->after));
  if (loop->tied) FG_TRY(find_ranges(ctx, loop));
  find_verdict(loop);
  return FG_OK;
}

fg_status fg_scan_loop_run(fg_context *ctx, const char *const *paths, const bool *hold_out,
                           size_t count, const fg_design *design,
                           const fg_scan_loop_options *options, fg_scan_loop **result) {
  fg_scan_loop *loop = NULL;
  fg_status status = FG_OK;
  *result = NULL;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *loop, (void **)&loop));
  loop->options = *options;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *loop->before, (void **)&loop->before));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *loop->after, (void **)&loop->after));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *loop->hold_out, (void **)&loop->hold_out));
  memcpy(loop->hold_out, hold_out, count * sizeof *hold_out);
  loop->scan_count = count;
  FG_TRY_EXIT(measure_all(ctx, paths, design, loop));
  if (options->same_foil) FG_TRY_EXIT(check_same_foils(ctx, loop));
  FG_TRY_EXIT(build_points(ctx, loop));
  FG_TRY_EXIT(search(ctx, loop));
  *result = loop;
exit:
  if (status != FG_OK) fg_scan_loop_free(loop);
  return status;
}

void fg_scan_loop_free(fg_scan_loop *loop) {
  if (!loop) return;
  size_t foils = 0;
  for (size_t i = 0; i < loop->scan_count; i++)
    foils += loop->before ? loop->before[i].foil_count : 0;
  for (size_t k = 0; loop->ranges && k < foils; k++) free(loop->ranges[k]);
  free(loop->ranges);
  for (size_t i = 0; i < loop->scan_count; i++) {
    if (loop->before) fg_measurement_free(&loop->before[i]);
    if (loop->after) fg_measurement_free(&loop->after[i]);
  }
  fg_points_free(&loop->points);
  fg_loop_result_free(&loop->engine);
  fg_loop_result_free(&loop->free_engine);
  free(loop->before);
  free(loop->after);
  free(loop->hold_out);
  free(loop->residual_before);
  free(loop->residual_after);
  free(loop->effect_um);
  free(loop);
}
