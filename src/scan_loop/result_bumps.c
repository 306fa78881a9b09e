/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Level `bumps` of the result, in the units that people read. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/text.h"
#include "scan_loop/result.h"
#include "scan_loop/state.h"

_Static_assert((int)FG_SCAN_RESULT_RESPONSES == (int)FG_SCAN_LOOP_BUMP_RESPONSES,
               "every response has its place");

typedef struct source {
  const fg_scan_loop_bumps *bumps;
  const fg_scan_loop_bump_level *level;
  size_t response;
  double scale; /* from the engine's unit to the one that people read */
} source;

/* ---- claims ---- */

static void put_ties(const fg_loop_claim *claim, fg_scan_result_bump_claim *out) {
  for (size_t i = 0; i < claim->aliases; i++) {
    /* The id follows the name with its coordinate; a sum has no id. */
    const fg_loop_alias *alias = &claim->alias[i];
    fg_text_clip(out->tied[i].name, sizeof out->tied[i].name, "%s", alias->name);
    fg_text_clip(out->tied[i].id, sizeof out->tied[i].id, "%s",
                 alias->sum ? alias->name : alias->candidate.effect->id);
  }
  out->ties = claim->aliases;
}

static void fill_bump_claim(const source *from, const fg_loop_claim *claim,
                            fg_scan_result_bump_claim *out) {
  *out = (fg_scan_result_bump_claim){
      .id = claim->candidate.effect->id,
      .words = claim->candidate.effect->bump_words,
      .verdict = claim->verdict,
      .amplitude = from->scale * claim->amplitude,
      .u_amplitude = from->scale * claim->amplitude_u,
      .p_value = claim->p_value,
      .retained_share = claim->retained_share,
  };
  while (out->parameters < sizeof out->parameter / sizeof *out->parameter &&
         fg_scan_loop_bumps_parameter(from->bumps, from->response, claim, out->parameters,
                                      &out->parameter_name[out->parameters],
                                      &out->parameter[out->parameters],
                                      &out->parameter_u[out->parameters]))
    out->parameters++;
  put_ties(claim, out);
}

/* ---- effects that are not claimed ---- */

typedef struct unclaimed_list {
  fg_scan_result *result;
  bool counts; /* only how many */
} unclaimed_list;

static void visit_unclaimed(size_t r, const fg_loop_rejected *one, void *user) {
  unclaimed_list *list = user;
  fg_scan_result_response *response = &list->result->bumps.response[r];
  if (!list->counts)
    response->unclaimed[response->unclaimeds] = (fg_scan_result_bump_unclaimed){
        .id = one->candidate.effect->id,
        .words = one->candidate.effect->bump_words,
        .verdict = one->verdict,
        .would_explain = one->would_explain,
        .p_value = one->p_value,
        .retained_share = one->retained_share,
        .smallest = fg_scan_loop_bump_responses[r].scale * one->smallest_detectable};
  response->unclaimeds++;
}

static fg_status fill_bump_unclaimed(fg_context *ctx, const fg_scan_loop_bumps *bumps,
                                     fg_scan_result *result) {
  unclaimed_list list = {result, true};
  fg_scan_loop_bumps_rejected(bumps, visit_unclaimed, &list);
  for (size_t r = 0; r < FG_SCAN_RESULT_RESPONSES; r++) {
    fg_scan_result_response *response = &result->bumps.response[r];
    FG_TRY(fg_memory_allocate(ctx, response->unclaimeds, sizeof *response->unclaimed,
                              (void **)&response->unclaimed));
    response->unclaimeds = 0;
  }
  list.counts = false;
  fg_scan_loop_bumps_rejected(bumps, visit_unclaimed, &list);
  return FG_OK;
}

/* ---- the bumps themselves ---- */

static const fg_scan_loop_bump *bump_of(const source *from, size_t i) {
  return &from->bumps->bump[from->level->problem.row[i]];
}

/* Returns the level of a foil where the model has one for each: mean of its residuals beside the
 * effects. */
static double level_of(const source *from, size_t part) {
  double sum = 0, n = 0;
  const fg_loop_problem *problem = &from->level->problem.problem;
  bool own = from->response == FG_SCAN_LOOP_BUMP_RADIUS;
  for (size_t i = 0; own && i < problem->rows; i++) {
    if (bump_of(from, i)->part != part) continue;
    sum += problem->residual[i] - from->level->result.effect_fit[i];
    n++;
  }
  return n > 0 ? sum / n : 0;
}

static fg_status put_rows(fg_context *ctx, const source *from, fg_scan_result_response *out) {
  const fg_loop_problem *problem = &from->level->problem.problem;
  FG_TRY(fg_memory_allocate(ctx, problem->rows, sizeof *out->bump, (void **)&out->bump));
  for (size_t i = 0; i < problem->rows; i++) {
    const fg_scan_loop_bump *bump = bump_of(from, i);
    double d = problem->residual[i] - level_of(from, bump->part);
    double effect = from->level->result.effect_fit[i];
    out->bump[i] = (fg_scan_result_bump){.part = bump->part,
                                         .number = bump->number,
                                         .held_out = bump->held_out,
                                         .before = from->scale * d,
                                         .after = from->scale * (d - effect),
                                         .effect = from->scale * effect};
  }
  out->bumps = problem->rows;
  return FG_OK;
}

static fg_status fill_bump_curve(fg_context *ctx, const source *from,
                                 fg_scan_result_response *out) {
  const fg_loop_result *result = &from->level->result;
  const fg_loop_curve *curve = &result->curve;
  out->has_curve = result->has_curve;
  if (!out->has_curve) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, curve->count, sizeof *out->curve, (void **)&out->curve));
  for (size_t i = 0; i < curve->count; i++) {
    out->curve[i][0] = curve->shape[i][0];
    out->curve[i][1] = from->scale * curve->shape[i][1];
  }
  out->curve_points = curve->count;
  out->curve_rms = from->scale * curve->rms;
  out->curve_p = curve->p_value;
  FG_TRY(fg_memory_allocate(ctx, result->rejects, sizeof *out->nearest, (void **)&out->nearest));
  for (size_t k = 0; k < result->rejects; k++)
    if (result->rejected[k].would_explain > FG_SCAN_LOOP_NEAR_SHARE)
      out->nearest[out->nearests++] = result->rejected[k].candidate.effect->id;
  return FG_OK;
}

static fg_scan_result_bump_error scaled(const fg_scan_loop_bump_error *error, double scale) {
  return (fg_scan_result_bump_error){
      {scale * error->rms[0], scale * error->rms[1]},
      {scale * error->held_out_rms[0], scale * error->held_out_rms[1]}};
}

static fg_status put_response(fg_context *ctx, const fg_scan_loop_bumps *bumps, size_t r,
                              fg_scan_result_response *out) {
  const fg_scan_loop_bump_response *what = &fg_scan_loop_bump_responses[r];
  const source from = {bumps, &bumps->level[r], r, what->scale};
  out->name = what->name;
  out->words = what->words;
  out->unit = what->unit;
  out->model = bumps->forming ? what->forming_model : what->model;
  out->judged = from.level->judged;
  out->level = out->judged ? what->scale * from.level->level : NAN;
  out->u_level = out->judged ? what->scale * from.level->u_level : NAN;
  out->error = scaled(&from.level->error, what->scale);
  for (size_t m = 0; m < from.level->result.claims; m++)
    fill_bump_claim(&from, &from.level->result.claim[m], &out->claim[out->claims++]);
  if (!out->judged) return FG_OK;
  FG_TRY(put_rows(ctx, &from, out));
  return fill_bump_curve(ctx, &from, out);
}

fg_status fg_scan_result_put_bumps(fg_context *ctx, const fg_scan_loop *loop,
                                   fg_scan_result *result) {
  const fg_scan_loop_bumps *bumps = &loop->bumps;
  fg_scan_result_bumps *out = &result->bumps;
  for (size_t i = 0; i < bumps->count; i++)
    out->held_out += bumps->bump[i].held_out;
  out->count = bumps->count - out->held_out;
  out->parts = bumps->parts;
  out->lip = bumps->lip;
  out->coordinate_name = fg_effect_coordinate_name(FG_EFFECT_INDEX);
  if (bumps->forming) {
    out->declared_path = bumps->forming->path;
    out->declared_sha256 = bumps->forming->sha256;
  }
  out->height_um = scaled(&bumps->height, 1000);
  FG_TRY(fill_bump_unclaimed(ctx, bumps, result));
  for (size_t r = 0; r < FG_SCAN_RESULT_RESPONSES; r++) {
    FG_TRY(put_response(ctx, bumps, r, &out->response[r]));
    if (out->response[r].has_curve && !out->curve) out->curve = &out->response[r];
  }
  return FG_OK;
}
