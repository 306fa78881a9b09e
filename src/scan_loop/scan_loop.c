/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan_loop/state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/spread.h"
#include "evidence/problem.h"
#include "scan_loop/result.h"
#include "scan_loop/verdict.h"

/* Rows fewer than this cannot carry a search for effects. */
enum { ROWS_MIN = 60 };

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
  fg_measure_options options = {.dpi = loop->options.dpi,
                                .allow_lossy = loop->options.allow_lossy,
                                .threads = loop->options.threads};
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
  fg_edge_fit_view *views = NULL;
  FG_TRY(fg_memory_allocate(ctx, total, sizeof *views, (void **)&views));
  for (size_t i = 0; i < loop->scan_count; i++) {
    const fg_measurement *m = &loop->before[i];
    for (size_t f = 0; f < m->foil_count; f++, n++)
      views[n] = (fg_edge_fit_view){&m->foils[f],     NULL, m, i, loop->options.same_foil ? f : n,
                                    loop->hold_out[i]};
    for (size_t d = 0; d < m->disc_count; d++, n++)
      views[n] = (fg_edge_fit_view){NULL, &m->discs[d], m, i, n, loop->hold_out[i]};
  }
  fg_status status = fg_edge_fit_build(ctx, views, n, &loop->edge_fit);
  free(views);
  if (status != FG_OK) return status;
  loop->edge_fit.coarse = loop->options.coarse;
  loop->edge_fit.threads = loop->options.threads;
  loop->edge_fit.proposes = !loop->options.coarse && fg_evidence_fits(&loop->edge_fit);
  if (loop->edge_fit.proposes) fg_edge_fit_hold_radii(&loop->edge_fit, false);
  loop->edge_fit.left_out = loop->options.without;
  if (loop->options.coarse) fg_edge_fit_find_frame(&loop->edge_fit);
  size_t rows = 0;
  for (size_t i = 0; i < loop->edge_fit.row_count; i++)
    rows += !loop->edge_fit.views[loop->edge_fit.rows[i].view].held_out;
  if (rows < ROWS_MIN)
    return fg_fail(
        ctx, FG_ERR_DATA,
        "%zu edge rows are too few to look for effects; scan more bumps, or at a higher resolution",
        rows);
  return FG_OK;
}

static fg_scan_loop_error summarise_residual(fg_context *ctx, const fg_edge_fit *edge_fit,
                                             const double *residual) {
  fg_scan_loop_error e = {NAN, NAN, NAN, NAN, NAN};
  double sum = 0, n = 0, held = 0, held_n = 0, *absolute = NULL; /* n: weights */
  size_t count = 0;
  if (fg_memory_allocate(ctx, edge_fit->row_count, sizeof *absolute, (void **)&absolute) != FG_OK)
    return e;
  for (size_t i = 0; i < edge_fit->row_count; i++) {
    if (!(edge_fit->rows[i].weight > 0)) continue;
    double weight = edge_fit->rows[i].weight, square = weight * residual[i] * residual[i];
    if (edge_fit->views[edge_fit->rows[i].view].held_out) {
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

/* Notes when most effects of the relevant size could not have been detected: `absent` effects must
 * not look like a clean scanner. */
static fg_status note_reach(fg_context *ctx, fg_scan_loop *loop) {
  size_t listed = 0, hidden = 0;
  for (size_t e = 0; e < loop->explanations.candidate_count; e++) {
    bool is_listed = !fg_effect_is_free(loop->explanations.candidates[e].kind);
    listed += is_listed;
    hidden += is_listed && !fg_scan_loop_would_show(loop->explanations.smallest_um[e]);
  }
  if (2 * hidden <= listed) return FG_OK;
  return fg_scan_loop_bumps_note(
      ctx, &loop->bumps,
      "points: %zu of %zu effects of %g um could not have been seen: too "
      "little of the foil is measured; scan more bumps, or several foils",
      hidden, listed, FG_SCAN_LOOP_MATTERS_UM);
}

/* Notes form errors of single discs: they are no effect of the scanner, but significant. */
static fg_status note_forming(fg_context *ctx, fg_scan_loop *loop) {
  const fg_explanations *explanations = &loop->explanations;
  if (!fg_scan_loop_has_uneven_discs(loop)) return FG_OK;
  return fg_scan_loop_bumps_note(
      ctx, &loop->bumps,
      "points: the discs deviate from circles by %.2g um rms, more than noise (p = %.1g), and no "
      "effect of the scanner that some of them show holds on the others: that is each disc's own "
      "form, or what one disc alone shows, as a lost row; scan them again, moved by some mm: what "
      "stays in the picture is the scanner",
      loop->error_before.rms, explanations->p_value);
}

static fg_status say_without(fg_context *ctx, fg_scan_loop *loop) {
  if (!loop->options.without) return FG_OK;
  return fg_scan_loop_bumps_note(ctx, &loop->bumps, "not looked for: %.600s (--without)",
                                 loop->options.without);
}

static fg_status say_lossy(fg_context *ctx, fg_scan_loop *loop) {
  for (size_t i = 0; i < loop->scan_count; i++)
    if (loop->before[i].file.jpeg_quality)
      FG_TRY(fg_scan_loop_bumps_note(ctx, &loop->bumps,
                                     "%.120s was compressed with loss (JPEG, quality %d), which "
                                     "moves edges: scan to PNG or TIFF",
                                     loop->before[i].scan, loop->before[i].file.jpeg_quality));
  return FG_OK;
}

static fg_status say_picture(fg_context *ctx, fg_scan_loop *loop) {
  for (size_t i = 0; i < loop->scan_count; i++)
    for (const fg_picture_words *words = fg_picture_finding_words(); words->name; words++)
      if (loop->before[i].picture.findings & words->finding)
        FG_TRY(fg_scan_loop_bumps_note(ctx, &loop->bumps, "%.80s: %s: %s %s", loop->before[i].scan,
                                       words->name, words->meaning, words->cure));
  return FG_OK;
}

static bool bends_bumps(const fg_effect_set *set) {
  for (size_t e = 0; e < set->count; e++)
    if (set->effects[e].kind->bends) return true;
  return false;
}

static fg_status search_bumps(fg_context *ctx, fg_scan_loop *loop) {
  const fg_loop_outcome edge_fit = fg_scan_loop_points_outcome(loop);
  const fg_scan_loop_bumps_request request = {
      .before = loop->before,
      .after = loop->after,
      .hold_out = loop->hold_out,
      .scan_count = loop->scan_count,
      .same_foil = loop->options.same_foil,
      .bent = bends_bumps(&loop->set),
      .forming = loop->options.forming,
      .open = loop->tied || edge_fit == FG_LOOP_PARTLY || edge_fit == FG_LOOP_UNATTRIBUTED,
      .seed = loop->options.seed,
  };
  FG_TRY(fg_scan_loop_bumps_run(ctx, &request, &loop->bumps));
  FG_TRY(loop->edge_fit.discs ? note_forming(ctx, loop) : note_reach(ctx, loop));
  FG_TRY(fg_scan_loop_note_held_out(ctx, loop));
  FG_TRY(fg_scan_loop_note_left_out(ctx, loop));
  FG_TRY(say_without(ctx, loop));
  FG_TRY(say_lossy(ctx, loop));
  FG_TRY(say_picture(ctx, loop));
  return fg_scan_loop_scale_uncertainty(ctx, loop);
}

/* The winner fitted once more, and every scan corrected by it. */
static fg_status correct_by_winner(fg_context *ctx, fg_scan_loop *loop) {
  fg_joint_fit_result fit;
  FG_TRY(fg_joint_fit_open(ctx, &loop->edge_fit, &loop->set, &fit));
  loop->set = fit.set;
  if (loop->by_evidence) fg_scan_loop_set_uncertainties(loop, &fit);
  bool by_mean = loop->by_evidence && loop->scanner_is_suspect;
  fg_status status = by_mean ? fg_scan_loop_correct_by_evidence(ctx, loop, &fit, loop->after)
                             : fg_scan_loop_correct_all(ctx, loop, &fit, loop->after);
  if (status == FG_OK && fit.set.count && (by_mean || !loop->by_evidence))
    status = fg_scan_loop_record_moves(ctx, loop, 0, &fit, loop->after);
  fg_joint_fit_close(&fit);
  return status;
}

static void widen_scale(double u_scale, fg_effect_set *set) {
  for (size_t e = 0; e < set->count; e++) {
    double *u = &set->effects[e].u_coefficient_um[0];
    if (set->effects[e].kind->scales) *u = hypot(*u, 1000 * FG_FIELD_HALF_MM * u_scale);
  }
}

/* Widens the uncertainty of scales by that of the known diameters and of the edges' level: the
 * first is common to all rows of a disc, the second to all discs. */
static void widen_scales(fg_scan_loop *loop) {
  widen_scale(loop->tone.u_scale, &loop->set);
  for (size_t k = 0; k < loop->tie_count; k++)
    widen_scale(loop->tone.u_scale, &loop->tie[k]);
}

static fg_status search_effects(fg_context *ctx, fg_scan_loop *loop) {
  size_t rows = loop->edge_fit.row_count;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof(double), (void **)&loop->residual_before));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof(double), (void **)&loop->residual_after));
  FG_TRY(fg_joint_fit(ctx, &loop->edge_fit, &loop->set, loop->residual_before));
  FG_TRY(
      fg_search_run(ctx, &loop->edge_fit, &loop->set, &loop->explanations, loop->residual_after));
  FG_TRY(fg_scan_loop_weigh_evidence(ctx, loop));
  FG_TRY(fg_scan_loop_find_single_bumps(ctx, loop));
  FG_TRY(fg_scan_loop_check_one_foil(ctx, loop));
  loop->error_before = summarise_residual(ctx, &loop->edge_fit, loop->residual_before);
  loop->error_after = summarise_residual(ctx, &loop->edge_fit, loop->residual_after);
  FG_TRY(fg_scan_loop_find_held_out(ctx, loop));
  loop->noise_floor_um = loop->explanations.noise_um;
  loop->tied = loop->explanations.count > 1;
  FG_TRY(correct_by_winner(ctx, loop));
  if (loop->tied) FG_TRY(fg_scan_loop_find_ranges(ctx, loop));
  FG_TRY(fg_scan_loop_keep_beneficial(ctx, loop));
  fg_scan_loop_widen_by_unseen(loop);
  if (loop->tied) fg_scan_loop_put_ranges(loop);
  FG_TRY(search_bumps(ctx, loop));
  FG_TRY(fg_scan_loop_put_form_errors(ctx, loop));
  FG_TRY(fg_scan_loop_find_width(ctx, loop));
  loop->tone = fg_scan_loop_find_tone(loop, true);
  FG_TRY(fg_scan_loop_note_known_sizes(ctx, loop));
  widen_scales(loop);
  loop->verdict = fg_scan_loop_outcome(loop);
  return fg_scan_loop_decide(ctx, loop);
}

static fg_status create_loop(fg_context *ctx, const bool *hold_out, size_t count,
                             const fg_scan_loop_options *options, fg_scan_loop **out) {
  fg_scan_loop *loop = NULL;
  fg_status status = FG_OK;
  FG_TRY(fg_effect_check_list(ctx, options->without));
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *loop, (void **)&loop));
  loop->options = *options;
  loop->level_half = 0.5;
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

/* Last step. Effects and benefits are decided by statistics alone, because the residual is not
 * sensitive to a common scale; the reported dimensions have its uncertainty in their u_. */
static fg_status calibrate(fg_context *ctx, fg_scan_loop *loop) {
  for (size_t i = 0; i < loop->scan_count; i++) {
    FG_TRY(fg_measurement_calibrate(ctx, loop->options.threads, &loop->before[i]));
    FG_TRY(fg_measurement_calibrate(ctx, loop->options.threads, &loop->after[i]));
  }
  return FG_OK;
}

enum { LEVELLED_MAX = 3 };
static fg_status close_loop(fg_context *ctx, fg_scan_loop *loop, fg_scan_loop **result);

/* Moves the edges from where they are; `picture` keeps the whole way. */
static fg_status move_to_level(fg_context *ctx, const fg_level *level, unsigned threads,
                               fg_measurement *m) {
  double *moved = NULL;
  FG_TRY(fg_memory_allocate(ctx, m->disc_count, sizeof *moved, (void **)&moved));
  for (size_t d = 0; d < m->disc_count; d++)
    moved[d] = m->discs[d].picture.level_known ? m->discs[d].picture.level : 0;
  fg_status status = fg_level_apply(ctx, level, threads, m);
  for (size_t d = 0; status == FG_OK && d < m->disc_count; d++)
    if (m->discs[d].picture.level_known) m->discs[d].picture.level += moved[d];
  free(moved);
  return status;
}

/* Repeats the loop with the edges moved to the level that the known diameters show: a level common
 * to all discs looks like a scale that falls with their size. Where an effect moves them, too, it
 * is that of the corrected ones. */
static fg_status level_again(fg_context *ctx, fg_scan_loop *loop, fg_scan_loop **result) {
  fg_scan_loop *next = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(create_loop(ctx, loop->hold_out, loop->scan_count, &loop->options, &next));
  memcpy(next->before, loop->before, loop->scan_count * sizeof *loop->before);
  memset(loop->before, 0, loop->scan_count * sizeof *loop->before);
  next->levelled = loop->levelled + 1;
  next->level_half = loop->tone.level.half;
  for (size_t i = 0; i < next->scan_count; i++)
    FG_TRY_EXIT(move_to_level(ctx, &loop->tone.level, next->options.threads, &next->before[i]));
exit:
  fg_scan_loop_free(loop);
  if (status == FG_OK) return close_loop(ctx, next, result);
  fg_scan_loop_free(next);
  return status;
}

/* A level that was taken before the effects were known may hold a part of them. */
static bool is_away(const fg_scan_loop *loop) {
  return fg_model_tone_is_away(&loop->tone, loop->level_half);
}

/* From measured scans to the result; frees the loop when it fails. */
static fg_status close_loop(fg_context *ctx, fg_scan_loop *loop, fg_scan_loop **result) {
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_scan_loop_leave_out(ctx, loop));
  if (loop->options.same_foil) FG_TRY_EXIT(check_same_foils(ctx, loop));
  FG_TRY_EXIT(
      fg_scan_loop_bumps_check_forming(ctx, loop->options.forming, loop->before, loop->scan_count));
  FG_TRY_EXIT(build_points(ctx, loop));
  loop->tone = fg_scan_loop_find_tone(loop, false);
  if (!loop->levelled && !loop->tone.contradicted && is_away(loop))
    return level_again(ctx, loop, result);
  FG_TRY_EXIT(search_effects(ctx, loop));
  if (loop->levelled < LEVELLED_MAX && is_away(loop)) return level_again(ctx, loop, result);
  FG_TRY_EXIT(calibrate(ctx, loop));
  *result = loop;
exit:
  if (status != FG_OK) fg_scan_loop_free(loop);
  return status;
}

fg_status fg_scan_loop_run(fg_context *ctx, const fg_scan_loop_scans *scans,
                           const fg_design *design, const fg_scan_loop_options *options,
                           fg_scan_loop **result) {
  fg_scan_loop *loop;
  *result = NULL;
  FG_TRY(create_loop(ctx, scans->hold_out, scans->count, options, &loop));
  fg_status status = measure_all(ctx, scans->paths, design, loop);
  if (status == FG_OK) return close_loop(ctx, loop, result);
  fg_scan_loop_free(loop);
  return status;
}

fg_status fg_scan_loop_run_measured(fg_context *ctx, fg_measurement *measurements,
                                    const bool *hold_out, size_t count,
                                    const fg_scan_loop_options *options, fg_scan_loop **result) {
  fg_scan_loop *loop;
  *result = NULL;
  FG_TRY(create_loop(ctx, hold_out, count, options, &loop));
  memcpy(loop->before, measurements, count * sizeof *measurements);
  memset(measurements, 0, count * sizeof *measurements);
  return close_loop(ctx, loop, result);
}

const fg_scan_result *fg_scan_loop_result(const fg_scan_loop *loop) {
  return &loop->result;
}

static void free_parts(const fg_scan_loop *loop, fg_displacement_part *parts) {
  for (size_t p = 0; parts && p < loop->edge_fit.part_count; p++)
    free(parts[p].bumps);
  free(parts);
}

void fg_scan_loop_free(fg_scan_loop *loop) {
  if (!loop) return;
  size_t foils = 0;
  for (size_t i = 0; i < loop->scan_count; i++)
    foils += loop->before ? loop->before[i].foil_count : 0;
  for (size_t k = 0; loop->ranges && k < foils; k++)
    free(loop->ranges[k]);
  free(loop->ranges);
  for (size_t i = 0; loop->benefits && i < loop->scan_count; i++)
    fg_benefits_close(&loop->benefits[i]);
  free(loop->benefits);
  for (size_t i = 0; i < loop->scan_count; i++) {
    if (loop->before) fg_measurement_free(&loop->before[i]);
    if (loop->after) fg_measurement_free(&loop->after[i]);
  }
  fg_scan_result_free(&loop->result);
  free_parts(loop, loop->displacement_parts);
  free_parts(loop, loop->unseen_parts);
  fg_field_map_free(&loop->map);
  free(loop->form_errors);
  fg_edge_fit_free(&loop->edge_fit);
  fg_scan_loop_bumps_free(&loop->bumps);
  free(loop->before);
  free(loop->after);
  free(loop->hold_out);
  free(loop->residual_before);
  free(loop->residual_after);
  free(loop);
}
