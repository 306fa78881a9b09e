#include "scan_loop/state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/spread.h"

/* Rows fewer than this cannot carry a search for effects. */
enum { ROWS_LEAST = 60 };
/* Residual over the noise that says that something is there. */
#define MUCH 1.5

/* A copy confirms nothing, and counts its noise twice. */
static fg_status check_different(fg_context *ctx, const char *const *paths,
                                 const fg_scan_loop *loop) {
  for (size_t i = 1; i < loop->scan_count; i++)
    for (size_t k = 0; k < i; k++)
      if (!strcmp(loop->before[i].sha256, loop->before[k].sha256))
        return fg_fail(ctx, FG_ERR_DATA, "%s and %s are the same scan: give each once", paths[k],
                       paths[i]);
  return FG_OK;
}

static fg_status measure_all(fg_context *ctx, const char *const *paths, const fg_design *design,
                             fg_scan_loop *loop) {
  fg_measure_options options = {.dpi = loop->options.dpi, .threads = loop->options.threads};
  for (size_t i = 0; i < loop->scan_count; i++)
    FG_TRY(fg_measure_scan(ctx, paths[i], design, &options, &loop->before[i]));
  FG_TRY(check_different(ctx, paths, loop));
  const fg_measurement *first = &loop->before[0];
  for (size_t i = 1; i < loop->scan_count; i++)
    for (int axis = 0; axis < 2; axis++)
      if (fabs(loop->before[i].dpi[axis] / first->dpi[axis] - 1) > 1e-4)
        return fg_fail(
            ctx, FG_ERR_DATA,
            "%s has %g dpi and %s has %g dpi: scans of one loop must have one resolution", paths[0],
            first->dpi[axis], paths[i], loop->before[i].dpi[axis]);
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
  for (size_t i = 0; i < loop->scan_count; i++)
    total += loop->before[i].foil_count + loop->before[i].disc_count;
  fg_points_view *views = NULL;
  FG_TRY(fg_memory_allocate(ctx, total, sizeof *views, (void **)&views));
  for (size_t i = 0; i < loop->scan_count; i++) {
    const fg_measurement *m = &loop->before[i];
    for (size_t f = 0; f < m->foil_count; f++, n++)
      views[n] = (fg_points_view){&m->foils[f],     NULL, m, i, loop->options.same_foil ? f : n,
                                  loop->hold_out[i]};
    for (size_t d = 0; d < m->disc_count; d++, n++)
      views[n] = (fg_points_view){NULL, &m->discs[d], m, i, n, loop->hold_out[i]};
  }
  fg_status status = fg_points_build(ctx, views, n, &loop->points);
  free(views);
  if (status != FG_OK) return status;
  loop->points.coarse = loop->options.coarse;
  if (loop->options.coarse) fg_points_find_frame(&loop->points);
  size_t rows = 0;
  for (size_t i = 0; i < loop->points.row_count; i++)
    rows += !loop->points.views[loop->points.rows[i].view].aside;
  if (rows < ROWS_LEAST)
    return fg_fail(ctx, FG_ERR_DATA, "%zu edge rows are too few to look for effects", rows);
  return FG_OK;
}

static fg_scan_loop_error summarise(fg_context *ctx, const fg_points *points,
                                    const double *residual) {
  fg_scan_loop_error e = {NAN, NAN, NAN, NAN, NAN};
  double sum = 0, n = 0, held = 0, held_n = 0, *absolute = NULL; /* n: weights */
  size_t count = 0;
  if (fg_memory_allocate(ctx, points->row_count, sizeof *absolute, (void **)&absolute) != FG_OK)
    return e;
  for (size_t i = 0; i < points->row_count; i++) {
    if (!(points->rows[i].weight > 0)) continue;
    double weight = points->rows[i].weight, square = weight * residual[i] * residual[i];
    if (points->views[points->rows[i].view].aside) {
      held += square;
      held_n += weight;
      continue;
    }
    sum += square;
    n += weight;
    absolute[count++] = fabs(residual[i]);
  }
  fg_spread spread = fg_spread_of(absolute, count);
  if (n > 0) e.rms = sqrt(sum / n);
  e.robust_sd = spread.robust_sd;
  e.p95 = spread.p95;
  e.maximum = spread.maximum;
  if (held_n > 0) e.held_out_rms = sqrt(held / held_n);
  free(absolute);
  return e;
}

/* What was corrected is not known exactly: the uncertainties of the foils take what the fit of the
 * set adds to its geometry's. */
static void widen_by_effects(const fg_points *points, const fg_measurement *before,
                             fg_measurement *after) {
  for (size_t v = 0; v < points->view_count; v++) {
    const fg_points_part *part = &points->parts[points->views[v].part];
    if (points->views[v].measurement != before || points->views[v].disc) continue;
    fg_foil *foil = &after->foils[points->views[v].foil - before->foils];
    double share = foil->overall.u_springback_error_pct / foil->overall.u_radius_mm;
    for (size_t b = 0; b < foil->bump_count; b++)
      for (size_t k = 0; k < part->bump_count; k++) {
        fg_points_bump bump = part->bumps[k];
        if (bump.number == foil->bumps[b].number)
          fg_bump_widen(&after->design, &after->nominal, &foil->overall, bump.effects_mm2,
                        &foil->bumps[b]);
      }
    foil->overall.u_radius_mm = hypot(foil->overall.u_radius_mm, sqrt(part->effects_mm2));
    foil->overall.u_springback_error_pct = share * foil->overall.u_radius_mm;
  }
}

/* The set must be the one that the points were fitted with last. */
static fg_status correct_all(fg_context *ctx, const fg_scan_loop *loop, const fg_effect_set *set,
                             fg_measurement *after) {
  fg_field_list fields;
  double *shift = NULL;
  fg_effect_set_fields(&loop->points, set, &fields);
  fg_status status = fg_effect_set_shift(ctx, &loop->points, set, &shift);
  for (size_t i = 0; i < loop->scan_count && status == FG_OK; i++)
    status = fg_scan_loop_correct(ctx, &loop->before[i], &fields, &loop->points, i, shift,
                                  loop->options.threads, &after[i]);
  for (size_t i = 0; i < loop->scan_count && status == FG_OK && set->count; i++)
    widen_by_effects(&loop->points, &loop->before[i], &after[i]);
  free(shift);
  return status;
}

/* ---- ties ---- */

static void widen(double range[2], double value) {
  if (!isfinite(value)) return;
  if (!(value >= range[0])) range[0] = value;
  if (!(value <= range[1])) range[1] = value;
}

static void widen_ranges(const fg_measurement *m, fg_scan_loop_range *ranges, size_t foil) {
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
  for (size_t i = 0; i < loop->scan_count; i++)
    foils += loop->before[i].foil_count;
  FG_TRY(fg_memory_allocate(ctx, foils, sizeof *loop->ranges, (void **)&loop->ranges));
  for (size_t i = 0, k = 0; i < loop->scan_count; i++)
    for (size_t f = 0; f < loop->before[i].foil_count; f++, k++) {
      size_t count = loop->before[i].foils[f].bump_count + 1;
      FG_TRY(fg_memory_allocate(ctx, count, sizeof **loop->ranges, (void **)&loop->ranges[k]));
      for (size_t b = 0; b < count; b++)
        loop->ranges[k][b] = (fg_scan_loop_range){{NAN, NAN}, {NAN, NAN}};
    }
  return FG_OK;
}

/* The corrected discs carry their ranges at once. */
static void widen_discs(fg_measurement *after, const fg_measurement *m) {
  for (size_t d = 0; d < after->disc_count && d < m->disc_count; d++) {
    double *range = after->discs[d].radius_range_mm;
    if (range[0] == 0 && range[1] == 0) range[0] = range[1] = NAN;
    widen(range, m->discs[d].radius_mm - 2 * m->discs[d].u_radius_mm);
    widen(range, m->discs[d].radius_mm + 2 * m->discs[d].u_radius_mm);
  }
}

static void widen_all(fg_scan_loop *loop, const fg_measurement *measurements) {
  for (size_t i = 0; i < loop->scan_count; i++)
    widen_discs(&loop->after[i], &measurements[i]);
  for (size_t i = 0, k = 0; i < loop->scan_count; i++)
    for (size_t f = 0; f < loop->before[i].foil_count; f++, k++)
      if (f < measurements[i].foil_count &&
          measurements[i].foils[f].bump_count == loop->before[i].foils[f].bump_count)
        widen_ranges(&measurements[i], loop->ranges[k], f);
}

/* The corrected foils carry their ranges. */
static void put_ranges(fg_scan_loop *loop) {
  for (size_t i = 0, k = 0; i < loop->scan_count; i++)
    for (size_t f = 0; f < loop->before[i].foil_count; f++, k++) {
      if (f >= loop->after[i].foil_count) continue;
      fg_foil *foil = &loop->after[i].foils[f];
      size_t count = loop->before[i].foils[f].bump_count;
      for (size_t b = 0; b < foil->bump_count && foil->bump_count == count; b++) {
        memcpy(foil->bumps[b].radius_range_mm, loop->ranges[k][b].radius_mm, 2 * sizeof(double));
        memcpy(foil->bumps[b].height_range_mm, loop->ranges[k][b].height_mm, 2 * sizeof(double));
      }
      memcpy(foil->overall.radius_range_mm, loop->ranges[k][count].radius_mm, 2 * sizeof(double));
    }
}

/* A step that may lie elsewhere: its place is known to the interval's uniform distribution. */
static void widen_step_place(fg_effect_set *set, const fg_effect_set *other) {
  for (size_t e = 0; e < set->count; e++)
    for (size_t k = 0; k < other->count; k++) {
      fg_effect_found *step = &set->effects[e];
      if (!step->kind->jumps || other->effects[k].kind != step->kind) continue;
      double apart = fabs(other->effects[k].shape[0] - step->shape[0]);
      step->u_shape[0] = fmax(step->u_shape[0], apart / sqrt(3));
    }
}

/* What the dimensions are under every explanation. */
static fg_status find_ranges(fg_context *ctx, fg_scan_loop *loop) {
  fg_status status = FG_OK;
  fg_measurement *tried = NULL;
  FG_TRY(allocate_ranges(ctx, loop));
  FG_TRY(fg_memory_allocate(ctx, loop->scan_count, sizeof *tried, (void **)&tried));
  widen_all(loop, loop->after);
  for (size_t m = 1; m < loop->explanations.count && status == FG_OK; m++) {
    fg_effect_set set;
    fg_explain_take(&loop->explanations, m, &set);
    status = fg_joint_fit(ctx, &loop->points, &set, NULL);
    if (status == FG_ERR_NUMERIC) {
      status = FG_OK;
      continue;
    }
    if (status == FG_OK) loop->tie[loop->tie_count++] = set;
    if (status == FG_OK) status = correct_all(ctx, loop, &set, tried);
    if (status == FG_OK) widen_all(loop, tried);
    for (size_t i = 0; i < loop->scan_count; i++)
      fg_measurement_free(&tried[i]);
  }
  free(tried);
  put_ranges(loop);
  /* The geometry in force is the winner's again. */
  if (status == FG_OK) status = fg_joint_fit(ctx, &loop->points, &loop->set, NULL);
  for (size_t k = 0; k < loop->tie_count; k++)
    widen_step_place(&loop->set, &loop->tie[k]);
  return status;
}

/* ---- the loop ---- */

static bool has_free(const fg_effect_set *set, bool wanted) {
  for (size_t e = 0; e < set->count; e++)
    if (fg_effect_is_free(set->effects[e].kind) == wanted) return true;
  return false;
}

/* A residual that all effects and curves together would take is not clean, even when no set of
 * them was found that holds. */
static bool leaves_much(const fg_scan_loop *loop) {
  return !loop->points.discs && !loop->explanations.right &&
         loop->error_after.rms > MUCH * loop->noise_floor_um;
}

static void find_verdict(fg_scan_loop *loop) {
  bool listed = has_free(&loop->set, false), rest = has_free(&loop->set, true);
  loop->verdict = listed && (rest || !loop->explanations.right) ? FG_LOOP_PARTLY
                  : listed                                      ? FG_LOOP_EXPLAINED
                  : rest || leaves_much(loop)                   ? FG_LOOP_UNATTRIBUTED
                                                                : FG_LOOP_CLEAN;
}

/* Where most effects of the size that matters could not have been seen, `absent` effects must not
 * look like a clean scanner. */
static fg_status say_reach(fg_context *ctx, fg_scan_loop *loop) {
  size_t listed = 0, hidden = 0;
  for (size_t e = 0; e < loop->explanations.candidate_count; e++) {
    bool is_listed = !fg_effect_is_free(loop->explanations.candidates[e].kind);
    listed += is_listed;
    hidden += is_listed && !(loop->explanations.smallest_um[e] <= FG_SCAN_LOOP_MATTERS_UM);
  }
  if (2 * hidden <= listed) return FG_OK;
  return fg_scan_loop_bumps_note(
      ctx, &loop->bumps,
      "points: %zu of %zu effects of %g um could not have been seen: too "
      "little of the foil is measured; scan more bumps, or several foils",
      hidden, listed, FG_SCAN_LOOP_MATTERS_UM);
}

static bool bends_bumps(const fg_effect_set *set) {
  for (size_t e = 0; e < set->count; e++)
    if (set->effects[e].kind->bends) return true;
  return false;
}

/* Points come first; only where they are clean the bumps decide. */
static fg_status search_bumps(fg_context *ctx, fg_scan_loop *loop) {
  size_t response;
  const fg_scan_loop_bumps_request request = {
      .before = loop->before,
      .after = loop->after,
      .hold_out = loop->hold_out,
      .scan_count = loop->scan_count,
      .same_foil = loop->options.same_foil,
      .bent = bends_bumps(&loop->set),
      .open =
          loop->tied || loop->verdict == FG_LOOP_PARTLY || loop->verdict == FG_LOOP_UNATTRIBUTED,
      .seed = loop->options.seed,
  };
  FG_TRY(fg_scan_loop_bumps_run(ctx, &request, &loop->bumps));
  if (!loop->points.discs) FG_TRY(say_reach(ctx, loop));
  FG_TRY(fg_scan_loop_say_left_out(ctx, loop));
  FG_TRY(fg_scan_loop_scale_doubt(ctx, loop));
  if (loop->verdict != FG_LOOP_CLEAN) return FG_OK;
  bool listed = fg_scan_loop_bumps_claimed(&loop->bumps);
  bool rest = fg_scan_loop_bumps_curve(&loop->bumps, &response) != NULL;
  if (listed || rest)
    loop->verdict = !listed ? FG_LOOP_UNATTRIBUTED : rest ? FG_LOOP_PARTLY : FG_LOOP_EXPLAINED;
  return FG_OK;
}

/* The midline says nothing of its strip's thickness, and the bumps do not either. */
static fg_status search_width(fg_context *ctx, fg_scan_loop *loop) {
  FG_TRY(fg_explain_width(ctx, &loop->points, &loop->set, &loop->width));
  if (!loop->width.found) return FG_OK;
  if (loop->verdict == FG_LOOP_CLEAN) loop->verdict = FG_LOOP_EXPLAINED;
  if (loop->verdict == FG_LOOP_UNATTRIBUTED) loop->verdict = FG_LOOP_PARTLY;
  return FG_OK;
}

static fg_status search(fg_context *ctx, fg_scan_loop *loop) {
  size_t rows = loop->points.row_count;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof(double), (void **)&loop->residual_before));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof(double), (void **)&loop->residual_after));
  FG_TRY(fg_joint_fit(ctx, &loop->points, &loop->set, loop->residual_before));
  FG_TRY(fg_explain_run(ctx, &loop->points, &loop->set, &loop->explanations, loop->residual_after));
  FG_TRY(fg_scan_loop_check_one_foil(ctx, loop));
  loop->error_before = summarise(ctx, &loop->points, loop->residual_before);
  loop->error_after = summarise(ctx, &loop->points, loop->residual_after);
  loop->noise_floor_um = loop->explanations.noise_um;
  loop->tied = loop->explanations.count > 1;
  FG_TRY(fg_joint_fit(ctx, &loop->points, &loop->set, NULL));
  FG_TRY(correct_all(ctx, loop, &loop->set, loop->after));
  if (loop->tied) FG_TRY(find_ranges(ctx, loop));
  find_verdict(loop);
  FG_TRY(search_bumps(ctx, loop));
  FG_TRY(search_width(ctx, loop));
  fg_scan_loop_decide(loop, &loop->decided);
  return FG_OK;
}

static fg_status create(fg_context *ctx, const bool *hold_out, size_t count,
                        const fg_scan_loop_options *options, fg_scan_loop **out) {
  fg_scan_loop *loop = NULL;
  fg_status status = FG_OK;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *loop, (void **)&loop));
  loop->options = *options;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *loop->before, (void **)&loop->before));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *loop->after, (void **)&loop->after));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *loop->hold_out, (void **)&loop->hold_out));
  memcpy(loop->hold_out, hold_out, count * sizeof *hold_out);
  loop->scan_count = count;
  *out = loop;
exit:
  if (status != FG_OK) fg_scan_loop_free(loop);
  return status;
}

/* From measured scans to the result; frees the loop when it fails. */
static fg_status close_loop(fg_context *ctx, fg_scan_loop *loop, fg_scan_loop **result) {
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_scan_loop_leave_out(ctx, loop));
  if (loop->options.same_foil) FG_TRY_EXIT(check_same_foils(ctx, loop));
  FG_TRY_EXIT(build_points(ctx, loop));
  FG_TRY_EXIT(search(ctx, loop));
  *result = loop;
exit:
  if (status != FG_OK) fg_scan_loop_free(loop);
  return status;
}

fg_status fg_scan_loop_run(fg_context *ctx, const char *const *paths, const bool *hold_out,
                           size_t count, const fg_design *design,
                           const fg_scan_loop_options *options, fg_scan_loop **result) {
  fg_scan_loop *loop;
  *result = NULL;
  FG_TRY(create(ctx, hold_out, count, options, &loop));
  fg_status status = measure_all(ctx, paths, design, loop);
  if (status == FG_OK) return close_loop(ctx, loop, result);
  fg_scan_loop_free(loop);
  return status;
}

fg_status fg_scan_loop_run_measured(fg_context *ctx, fg_measurement *measurements,
                                    const bool *hold_out, size_t count,
                                    const fg_scan_loop_options *options, fg_scan_loop **result) {
  fg_scan_loop *loop;
  *result = NULL;
  FG_TRY(create(ctx, hold_out, count, options, &loop));
  memcpy(loop->before, measurements, count * sizeof *measurements);
  memset(measurements, 0, count * sizeof *measurements);
  return close_loop(ctx, loop, result);
}

size_t fg_scan_loop_left_out(const fg_scan_loop *loop) {
  return loop->left_out;
}

void fg_scan_loop_free(fg_scan_loop *loop) {
  if (!loop) return;
  size_t foils = 0;
  for (size_t i = 0; i < loop->scan_count; i++)
    foils += loop->before ? loop->before[i].foil_count : 0;
  for (size_t k = 0; loop->ranges && k < foils; k++)
    free(loop->ranges[k]);
  free(loop->ranges);
  for (size_t i = 0; i < loop->scan_count; i++) {
    if (loop->before) fg_measurement_free(&loop->before[i]);
    if (loop->after) fg_measurement_free(&loop->after[i]);
  }
  fg_points_free(&loop->points);
  fg_scan_loop_bumps_free(&loop->bumps);
  free(loop->before);
  free(loop->after);
  free(loop->hold_out);
  free(loop->residual_before);
  free(loop->residual_after);
  free(loop);
}
