/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan_loop/bumps.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/foil_kind.h"

const fg_scan_loop_bump_response fg_scan_loop_bump_responses[FG_SCAN_LOOP_BUMP_RESPONSES] = {
    {"bump_radius_mm", "bump radius", "um", "uniform springback", "what form predicts of it", 1000},
    {"bump_angle_deg", "bump angle", "deg", "constant arc length", "the arc length of form", 1},
};

enum { RADIUS = FG_SCAN_LOOP_BUMP_RADIUS, ANGLE = FG_SCAN_LOOP_BUMP_ANGLE };

/* Minimum numbers of bumps for permutations and for sign flips: five bumps have 120 orders, nine
 * have 256 pairs of signs; beside their mirror images p can be below 0.005 from six and nine bumps
 * on. */
enum { ORDERS = 6, SIGNS = 9 };

/* Minimum ratio of a claim to the uncertainty common to all bumps. */
static const double is_certain = 3;
static const double accept_p = FG_LOOP_ACCEPT_P; /* over both responses */

fg_status fg_scan_loop_bumps_note(fg_context *ctx, fg_scan_loop_bumps *bumps, const char *format,
                                  ...) {
  char text[400];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  FG_TRY(fg_memory_reserve(ctx, bumps->notes + 1, sizeof *bumps->note, &bumps->note_capacity,
                           (void **)&bumps->note));
  bumps->note[bumps->notes] = NULL;
  FG_TRY(fg_text_print(ctx, &bumps->note[bumps->notes], "%s", text));
  bumps->notes++;
  return FG_OK;
}

/* ---- the problem ---- */

static const char *const offset_column[FG_SCAN_LOOP_BUMP_RESPONSES] = {"declared radius",
                                                                       "declared angle"};

static fg_status build_table(fg_context *ctx, const fg_scan_loop_bumps *bumps,
                             const fg_design *design, fg_table *table) {
  fg_status status = FG_OK;
  double *column = NULL;
  size_t n = bumps->count;
  *table = (fg_table){0};
  FG_TRY(fg_memory_allocate(ctx, n, 6 * sizeof *column, (void **)&column));
  for (size_t i = 0; i < n; i++) {
    const fg_scan_loop_bump *bump = &bumps->bump[i];
    column[i] = (double)bump->part + 1;
    column[n + i] = bump->number;
    for (size_t r = 0; r < FG_SCAN_LOOP_BUMP_RESPONSES; r++) {
      column[(2 + r) * n + i] = bump->value[r];
      column[(4 + r) * n + i] = fg_scan_loop_bumps_offset(design, bump, r);
    }
  }
  FG_TRY_EXIT(fg_table_add_numbers(ctx, table, "foil", column, n));
  FG_TRY_EXIT(fg_table_add_numbers(ctx, table, "bump", column + n, n));
  for (size_t r = 0; r < FG_SCAN_LOOP_BUMP_RESPONSES; r++)
    FG_TRY_EXIT(fg_table_add_numbers(ctx, table, fg_scan_loop_bump_responses[r].name,
                                     column + (2 + r) * n, n));
  for (size_t r = 0; bumps->forming && r < FG_SCAN_LOOP_BUMP_RESPONSES; r++)
    FG_TRY_EXIT(fg_table_add_numbers(ctx, table, offset_column[r], column + (4 + r) * n, n));
exit:
  free(column);
  return status;
}

static void drop_coordinate(fg_loop_problem *problem, const char *name) {
  for (size_t c = 0; c < problem->coordinates; c++) {
    if (strcmp(problem->coordinate[c].name, name) != 0) continue;
    free(problem->coordinate[c].value); /* numbers: no level names */
    problem->coordinates--;
    memmove(&problem->coordinate[c], &problem->coordinate[c + 1],
            (problem->coordinates - c) * sizeof *problem->coordinate);
    return;
  }
}

static fg_status build_problem(fg_context *ctx, const fg_scan_loop_bumps *bumps,
                               const fg_table *table, const fg_design *design, size_t response,
                               fg_loop_table_problem *out) {
  bool few = bumps->parts < FG_SCAN_LOOP_BUMP_FOILS;
  const fg_loop_table_spec spec = {
      .response = fg_scan_loop_bump_responses[response].name,
      .model = response == ANGLE         ? "arc_length"
               : few && bumps->parts > 1 ? "1 + factor(foil)"
                                         : "1",
      .group = "foil",
      .hold_out = "0",
      .offset = bumps->forming ? offset_column[response] : NULL,
      .design = design,
  };
  FG_TRY(fg_loop_table_problem_build(ctx, table, &spec, out));
  fg_loop_problem *problem = &out->problem;
  for (size_t i = 0; i < problem->rows; i++)
    problem->held_out[i] = bumps->bump[out->row[i]].held_out;
  drop_coordinate(problem, "foil");
  for (size_t r = 0; r < FG_SCAN_LOOP_BUMP_RESPONSES; r++)
    drop_coordinate(problem, offset_column[r]);
  if (!bumps->lip) drop_coordinate(problem, "bump");
  if (!few) return FG_OK;
  problem->few = true;
  for (size_t i = 0; i < problem->rows; i++)
    problem->group[i] = i;
  problem->groups = problem->rows;
  problem->group_level = problem->correlated = false;
  return FG_OK;
}

/* ---- judging ---- */

static bool over_bumps(const fg_loop_problem *problem, size_t a, size_t b) {
  const fg_loop_coordinate *at = &problem->coordinate[a];
  (void)b;
  return at->roles & FG_LOOP_BUMP && at->distinct >= 4;
}

static void choose_effects(fg_scan_loop_bumps *bumps) {
  size_t count = 0;
  for (int kind = FG_LOOP_NOT_OVER_BUMPS + 1; kind < FG_LOOP_BUMP_KINDS; kind++)
    for (const fg_loop_effect *e = fg_loop_table_effects(); e->id; e++) {
      if ((int)e->over_bumps != kind) continue;
      bumps->effect[count] = *e;
      if (kind != FG_LOOP_BUMP_STRETCH) bumps->effect[count].accepts = over_bumps;
      count++;
    }
}

static double part_mean(const fg_scan_loop_bump_level *level, const fg_scan_loop_bumps *bumps,
                        size_t part, bool with_effects) {
  double sum = 0, n = 0;
  const fg_loop_problem *problem = &level->problem.problem;
  for (size_t i = 0; i < problem->rows; i++) {
    if (bumps->bump[level->problem.row[i]].part != part) continue;
    sum += problem->residual[i] - (with_effects ? level->result.effect_fit[i] : 0);
    n++;
  }
  return sum / n;
}

/* About the foil's own mean where the model has one, as the radius has. */
static void find_errors(fg_scan_loop_bump_level *level, const fg_scan_loop_bumps *bumps,
                        bool own_mean) {
  const fg_loop_problem *problem = &level->problem.problem;
  double sum[2][2] = {{0}}, n[2] = {0}, base = 0;
  for (size_t i = 0; i < problem->rows; i++) {
    const fg_scan_loop_bump *bump = &bumps->bump[level->problem.row[i]];
    for (int after = 0; after < 2; after++) {
      double value = problem->residual[i] - (after ? level->result.effect_fit[i] : 0);
      if (own_mean) value -= part_mean(level, bumps, bump->part, after);
      sum[bump->held_out][after] += value * value;
    }
    n[bump->held_out]++;
    if (!bump->held_out) base += problem->response[i] - level->result.effect_fit[i];
  }
  for (int after = 0; after < 2; after++) {
    level->error.rms[after] = sqrt(sum[0][after] / n[0]);
    level->error.held_out_rms[after] = n[1] > 0 ? sqrt(sum[1][after] / n[1]) : NAN;
  }
  level->base = base / n[0];
}

/* Uses the engine's cross-fitted error, without held-out bumps, when its claims are accepted
 * unchanged. */
static void use_cross_fitted(fg_scan_loop_bump_level *level, const fg_loop_result *found) {
  fg_loop_result *result = &level->result;
  double *held_out = level->error.held_out_rms;
  if (isfinite(held_out[0])) return;
  if (!result->claims && !result->has_curve) {
    held_out[0] = held_out[1] = level->error.rms[0];
  } else if (result->claims == found->claims && result->has_curve == found->has_curve) {
    held_out[0] = result->before.held_out_rms;
    held_out[1] = result->after.held_out_rms;
  }
}

/* Corrects p for two responses. For few bumps the engine tests no curves but counts them, which
 * already covers the second response. */
static double over_responses(const fg_loop_problem *problem, double p_value) {
  return fmin(1, (problem->few ? 1 : FG_SCAN_LOOP_BUMP_RESPONSES) * p_value);
}

static bool is_exchange(const fg_loop_candidate *candidate) {
  return candidate->effect && candidate->effect->outlier == FG_LOOP_EXCHANGED_ROWS;
}

/* Bumps do not change places. */
static void strip_aliases(fg_loop_claim *claim) {
  size_t kept = 0;
  for (size_t i = 0; i < claim->aliases; i++)
    if (!is_exchange(&claim->alias[i].candidate) &&
        !(claim->alias[i].sum && is_exchange(&claim->alias[i].second)))
      claim->alias[kept++] = claim->alias[i];
  claim->aliases = kept;
  if (!kept) claim->verdict = FG_LOOP_FOUND;
}

/* Accepts or rejects a claim. An outlier is a note, no claim; an effect no larger than the
 * uncertainty that the edges leave is no claim, however constant. */
static fg_status test_claim(fg_context *ctx, fg_scan_loop_bumps *bumps, size_t response,
                            uint64_t seed, fg_loop_claim *claim, bool *kept) {
  const fg_scan_loop_bump_level *level = &bumps->level[response];
  const fg_loop_problem *problem = &level->problem.problem;
  const fg_scan_loop_bump_response *what = &fg_scan_loop_bump_responses[response];
  double min = level->min, p_value;
  claim->p_value = over_responses(problem, claim->p_value);
  const char *id = claim->candidate.effect->id;
  *kept = false;
  strip_aliases(claim);
  if (is_exchange(&claim->candidate)) return FG_OK;
  if (claim->candidate.effect->outlier == FG_LOOP_WRONG_ROW) {
    const fg_scan_loop_bump *bump = &bumps->bump[level->problem.row[claim->candidate.row[0]]];
    return fg_scan_loop_bumps_note(ctx, bumps,
                                   "bumps: %s of bump %d of foil %zu stands out from the others",
                                   what->name, bump->number, bump->part + 1);
  }
  if (!(claim->amplitude > min))
    return fg_scan_loop_bumps_note(
        ctx, bumps,
        "bumps: %s of %s is %.3g %s, which is within what the edges leave in doubt "
        "(%.3g %s): no claim",
        id, what->name, what->scale * claim->amplitude, what->unit, what->scale * min, what->unit);
  if (problem->few) {
    FG_TRY(fg_scan_loop_bumps_null_p(ctx, problem, claim, seed, &p_value));
    p_value *= FG_SCAN_LOOP_BUMP_RESPONSES;
    claim->p_value = fmin(1, fmax(claim->p_value, p_value));
  }
  *kept = claim->p_value < accept_p;
  return FG_OK;
}

/* The effects of the claims that stay, and of the curve. */
static fg_status find_effects(fg_context *ctx, fg_scan_loop_bump_level *level) {
  const fg_loop_problem *problem = &level->problem.problem;
  fg_loop_result *result = &level->result;
  double *one = NULL;
  FG_TRY(fg_memory_allocate(ctx, problem->rows, sizeof *one, (void **)&one));
  memset(result->effect_fit, 0, problem->rows * sizeof *one);
  for (size_t m = 0; m < result->claims; m++) {
    FG_TRY(fg_loop_claim_evaluate(ctx, problem, &result->claim[m], one));
    for (size_t i = 0; i < problem->rows; i++)
      result->effect_fit[i] += one[i];
  }
  for (size_t i = 0; result->has_curve && i < problem->rows; i++)
    result->effect_fit[i] +=
        fg_loop_curve_at(&result->curve, problem->coordinate[result->curve.coordinate].value[i]);
  free(one);
  return FG_OK;
}

/* P-values over both responses; amplitudes that would have been claimed. */
static void judge_rejected(fg_scan_loop_bump_level *level) {
  const fg_loop_problem *problem = &level->problem.problem;
  size_t rows = 0;
  for (size_t i = 0; i < problem->rows; i++)
    rows += !problem->held_out[i];
  for (size_t k = 0; k < level->result.rejects; k++) {
    fg_loop_rejected *one = &level->result.rejected[k];
    size_t needed = one->candidate.effect->over_bumps == FG_LOOP_BUMP_STRETCH ? SIGNS : ORDERS;
    one->p_value = over_responses(problem, one->p_value);
    if (problem->few && rows < needed) one->smallest_detectable = NAN;
    if (one->smallest_detectable < level->min) one->smallest_detectable = level->min;
    if (isnan(one->smallest_detectable) && one->verdict == FG_LOOP_ABSENT)
      one->verdict = FG_LOOP_INCONCLUSIVE;
  }
  level->result.curve.p_value = over_responses(problem, level->result.curve.p_value);
}

static fg_status judge_claims(fg_context *ctx, fg_scan_loop_bumps *bumps, size_t response,
                              uint64_t seed) {
  fg_scan_loop_bump_level *level = &bumps->level[response];
  fg_loop_result *result = &level->result;
  size_t count = 0;
  for (size_t m = 0; m < result->claims; m++) {
    bool kept;
    FG_TRY(test_claim(ctx, bumps, response, seed, &result->claim[m], &kept));
    if (kept)
      result->claim[count++] = result->claim[m];
    else
      level->dropped[level->drops++] = result->claim[m];
  }
  result->claims = count;
  judge_rejected(level);
  if (result->has_curve && !(result->curve.rms > level->min)) result->has_curve = false;
  FG_TRY(find_effects(ctx, level));
  FG_TRY(fg_scan_loop_bumps_find_single(ctx, bumps, response, seed));
  return find_effects(ctx, level);
}

static fg_status test_response(fg_context *ctx, const fg_design *design, uint64_t seed,
                               size_t response, const fg_table *table, fg_scan_loop_bumps *bumps) {
  fg_scan_loop_bump_level *level = &bumps->level[response];
  double sum = 0, n = 0;
  FG_TRY(build_problem(ctx, bumps, table, design, response, &level->problem));
  const fg_loop_problem *problem = &level->problem.problem;
  const fg_loop_options options = {
      .effects = bumps->effect,
      .seed = seed,
      .accept_p = problem->few ? accept_p : accept_p / FG_SCAN_LOOP_BUMP_RESPONSES};
  fg_status status = fg_loop_run(ctx, problem, &options, &level->result);
  if (status != FG_OK) {
    fg_loop_table_problem_free(&level->problem);
    return status;
  }
  level->judged = true;
  for (size_t i = 0; i < bumps->count; i++)
    if (!bumps->bump[i].held_out) {
      sum += bumps->bump[i].uncertainty[response];
      n++;
    }
  level->min = is_certain * sum / n;
  fg_scan_loop_bumps_find_level(bumps, response);
  const fg_loop_result found = level->result; /* only counted */
  FG_TRY(judge_claims(ctx, bumps, response, seed));
  find_errors(level, bumps, response == RADIUS);
  use_cross_fitted(level, &found);
  return FG_OK;
}

/* h from the two circles: X = R cos(alpha/2) + sqrt(R0² - R² sin²(alpha/2)), h = R0 - X + R. */
static double height_of(double overall_mm, double radius_mm, double angle_deg) {
  double half = angle_deg * M_PI / 360, s = radius_mm * sin(half);
  return overall_mm - radius_mm * cos(half) - sqrt(overall_mm * overall_mm - s * s) + radius_mm;
}

/* Predicted from the declared model alone, and with the effects found. */
static void find_height_errors(fg_scan_loop_bumps *bumps) {
  const fg_scan_loop_bump_level *radius = &bumps->level[RADIUS], *angle = &bumps->level[ANGLE];
  double sum[2][2] = {{0}}, n[2] = {0};
  for (size_t i = 0; i < bumps->count; i++) {
    /* Both problems have the same rows in the same order. */
    const fg_scan_loop_bump *bump = &bumps->bump[radius->problem.row[i]];
    for (int after = 0; after < 2; after++) {
      double effect_mm = after ? radius->result.effect_fit[i] : 0;
      double effect_deg = after ? angle->result.effect_fit[i] : 0;
      double level_mm =
          radius->problem.problem.origin + part_mean(radius, bumps, bump->part, after);
      double r = level_mm + bump->declared_mm + effect_mm;
      double alpha = bump->declared_arc / r + effect_deg;
      double error = bump->height_mm - height_of(bump->overall_mm, r, alpha);
      sum[bump->held_out][after] += error * error;
    }
    n[bump->held_out]++;
  }
  for (int after = 0; after < 2; after++) {
    bumps->height.rms[after] = sqrt(sum[0][after] / n[0]);
    bumps->height.held_out_rms[after] = n[1] > 0 ? sqrt(sum[1][after] / n[1]) : NAN;
  }
}

static fg_status say_power(fg_context *ctx, fg_scan_loop_bumps *bumps, size_t rows) {
  if (!bumps->lip)
    FG_TRY(fg_scan_loop_bumps_note(
        ctx, bumps,
        "bumps: without a lip their numbers have no order: decay from the lip and trends "
        "over the number are not judged"));
  if (bumps->parts >= FG_SCAN_LOOP_BUMP_FOILS || rows >= SIGNS) return FG_OK;
  return fg_scan_loop_bumps_note(
      ctx, bumps,
      "bumps: %zu measured: %s can be told from chance, whatever its size; it takes %d%s, "
      "on one foil or several",
      rows, rows < ORDERS ? "no effect over them" : "no arc length unlike the declared one", SIGNS,
      rows < ORDERS ? " (6 for a trend over their number)" : "");
}

static fg_status run_bumps(fg_context *ctx, const fg_scan_loop_bumps_request *request,
                           fg_scan_loop_bumps *bumps) {
  const fg_design *design = &request->before[0].design;
  fg_status status = FG_OK;
  fg_table table = {0};
  size_t rows = 0;
  for (size_t i = 0; i < bumps->count; i++)
    rows += !bumps->bump[i].held_out;
  FG_TRY(say_power(ctx, bumps, rows));
  if (rows < FG_SCAN_LOOP_BUMP_ROWS + bumps->parts - 1) return FG_OK;
  FG_TRY_EXIT(build_table(ctx, bumps, design, &table));
  for (size_t r = 0; r < FG_SCAN_LOOP_BUMP_RESPONSES; r++)
    FG_TRY_EXIT(test_response(ctx, design, request->seed, r, &table, bumps));
  find_height_errors(bumps);
exit:
  fg_table_free(&table);
  return status;
}

fg_status fg_scan_loop_bumps_run(fg_context *ctx, const fg_scan_loop_bumps_request *request,
                                 fg_scan_loop_bumps *bumps) {
  *bumps = (fg_scan_loop_bumps){
      .forming = request->forming,
      .height = {{NAN, NAN}, {NAN, NAN}},
      .level = {{.error = {{NAN, NAN}, {NAN, NAN}}}, {.error = {{NAN, NAN}, {NAN, NAN}}}}};
  if (!fg_foil_traits_of(request->before[0].design.kind)->is_foil)
    return FG_OK; /* discs have no bumps */
  if (request->bent)
    return fg_scan_loop_bumps_note(
        ctx, bumps,
        "the bumps deviate from circles: which circle is a bump's is a matter "
        "of basis, and the bumps are not held against the springback model");
  choose_effects(bumps);
  fg_status status = fg_scan_loop_bumps_collect(ctx, request, bumps);
  if (status == FG_OK) status = fg_scan_loop_bumps_declare(ctx, &request->before[0].design, bumps);
  if (status == FG_OK) status = run_bumps(ctx, request, bumps);
  if (status != FG_OK) fg_scan_loop_bumps_free(bumps);
  return status;
}

void fg_scan_loop_bumps_free(fg_scan_loop_bumps *bumps) {
  for (size_t r = 0; r < FG_SCAN_LOOP_BUMP_RESPONSES; r++) {
    fg_loop_result_free(&bumps->level[r].result);
    fg_loop_table_problem_free(&bumps->level[r].problem);
  }
  for (size_t i = 0; i < bumps->notes; i++)
    free(bumps->note[i]);
  free(bumps->note);
  free(bumps->bump);
  *bumps = (fg_scan_loop_bumps){0};
}
