/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "foilgauge/loop/1", domain "scan". */
#include <stdio.h>
#include <stdlib.h>

#include "foilgauge/scan_loop.h"
#include "report/design/calibration_json.h"
#include "report/measure/json.h"
#include "report/scan_loop/bumps.h"
#include "report/scan_loop/parts.h"

/* Parameters by their names; with `u`, their standard uncertainties. */
static void write_parameters(fg_json *json, const fg_scan_result_claim *claim, bool u) {
  fg_json_object(json, u ? "uncertainty" : "parameters");
  for (size_t i = 0; i < claim->parameters; i++)
    fg_json_number(json, claim->parameter[i].name,
                   u ? claim->parameter[i].u : claim->parameter[i].value);
  fg_json_object_end(json);
}

/* Writes the explanations; empty when every explanation includes the effect. */
static void write_explanations(fg_json *json, const fg_scan_result *result, bool sure) {
  fg_json_array(json, "alias_class");
  for (size_t k = 0; k < result->explanations && !sure; k++)
    fg_json_string(json, NULL, result->explanation[k].name);
  fg_json_array_end(json);
}

static void write_shape(fg_json *json, const fg_scan_result_claim *claim) {
  fg_json_array(json, "shape");
  for (size_t i = 0; i < claim->shape_points; i++)
    fg_json_numbers(json, NULL, claim->shape[i], 2);
  fg_json_array_end(json);
}

static void write_channel_check(fg_json *json, const fg_channel_check *channel_check) {
  static const char *const lines[] = {"red", "green", "blue"};
  if (channel_check->verdict == FG_CHANNEL_CHECK_NONE) return;
  fg_json_object(json, "witness");
  fg_json_string(json, "verdict", fg_channel_check_word(channel_check->verdict));
  fg_json_string(json, "reason", channel_check->reason);
  fg_json_number(json, "p_value", channel_check->p_value);
  fg_json_number(json, "p_against", channel_check->p_against);
  fg_json_number(json, "factor", channel_check->factor);
  fg_json_number(json, "u_factor", channel_check->u_factor);
  fg_json_number(json, "expected_um", channel_check->expected_um);
  fg_json_bool(json, "gap_stated", channel_check->gap_stated);
  fg_json_object(json, "gap_px");
  for (int k = 0; k < 3; k++)
    fg_json_number(json, lines[k], channel_check->gap_px[k]);
  fg_json_object_end(json);
  fg_json_object_end(json);
}

static void write_scan_claim(fg_json *json, const fg_scan_result *result,
                             const fg_scan_result_claim *claim) {
  fg_json_object(json, NULL);
  fg_json_string(json, "id", claim->id);
  if (claim->direction) fg_json_string(json, "form", claim->direction);
  fg_json_string(json, "level", "points");
  fg_json_string(json, "verdict", fg_loop_verdict_word(claim->verdict));
  write_parameters(json, claim, false);
  write_parameters(json, claim, true);
  fg_json_number(json, "amplitude", claim->amplitude_um);
  fg_json_number(json, "p_value", claim->p_value);
  fg_json_number(json, "retained_share", claim->retained_share);
  if (claim->basis) {
    fg_json_string(json, "basis", claim->basis);
    write_shape(json, claim);
  }
  write_explanations(json, result, claim->sure);
  write_channel_check(json, &claim->channel_check);
  fg_json_object_end(json);
}

static void write_claims(fg_json *json, const fg_scan_result *result) {
  fg_json_array(json, "claims");
  for (size_t i = 0; i < result->claims; i++)
    if (!result->claim[i].free) write_scan_claim(json, result, &result->claim[i]);
  fg_json_bump_claims(json, &result->bumps);
  fg_json_array_end(json);
}

static void write_curve(fg_json *json, const fg_scan_result_claim *curve) {
  fg_json_string(json, "coordinate", curve->coordinate_name);
  fg_json_string(json, "moves", curve->moves);
  write_shape(json, curve);
}

/* The largest curve; others beside it. */
static void write_unattributed(fg_json *json, const fg_scan_result *result) {
  if (!result->curve) {
    if (!fg_json_bump_curve(json, &result->bumps)) fg_json_string(json, "unattributed", NULL);
    return;
  }
  fg_json_object(json, "unattributed");
  write_curve(json, result->curve);
  fg_json_array(json, "others");
  for (size_t i = 0; i < result->claims; i++) {
    const fg_scan_result_claim *other = &result->claim[i];
    if (!other->free || other == result->curve) continue;
    fg_json_object(json, NULL);
    write_curve(json, other);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
  write_explanations(json, result, result->curve->sure);
  fg_json_number(json, "rms", result->before.rms);
  fg_json_number(json, "p_value", result->p_value);
  fg_json_array(json, "nearest");
  for (size_t i = 0; i < result->nearests; i++)
    fg_json_string(json, NULL, result->nearest[i]);
  fg_json_array_end(json);
  fg_json_object_end(json);
}

static fg_status write_foils(fg_context *ctx, fg_json *json, const fg_measurement *m) {
  for (size_t f = 0; f < m->foil_count; f++)
    FG_TRY(fg_json_foil(ctx, json, &m->design, &m->foils[f]));
  return FG_OK;
}

static fg_status write_discs(fg_context *ctx, fg_json *json, const fg_measurement *m) {
  for (size_t d = 0; d < m->disc_count; d++)
    FG_TRY(fg_json_disc(ctx, json, &m->design, &m->discs[d]));
  return FG_OK;
}

static fg_status write_side(fg_context *ctx, fg_json *json, const char *name,
                            const fg_scan_result *result, bool after) {
  const fg_scan_loop_error *error = after ? &result->after : &result->before;
  fg_json_object(json, name);
  fg_json_number(json, "rms", error->rms);
  fg_json_number(json, "held_out_rms", error->held_out_rms);
  fg_json_number(json, "robust_sd", error->robust_sd);
  fg_json_number(json, "p95", error->p95);
  fg_json_number(json, "maximum", error->maximum);
  if (result->of_width) {
    fg_json_object(json, "half_width");
    fg_json_number(json, "rms", after ? result->width_after_um : result->width_before_um);
    fg_json_object_end(json);
  }
  fg_json_array(json, "foils");
  for (size_t i = 0; i < result->scans; i++)
    FG_TRY(write_foils(ctx, json, after ? result->scan[i].after : result->scan[i].before));
  fg_json_array_end(json);
  if (result->discs) fg_json_array(json, "discs");
  for (size_t i = 0; i < result->scans; i++)
    FG_TRY(write_discs(ctx, json, after ? result->scan[i].after : result->scan[i].before));
  if (result->discs) fg_json_array_end(json);
  fg_json_object_end(json);
  return FG_OK;
}

/* Writes the rejected effects; tied ones are in `alias_class`. */
static void write_scan_rejected(fg_json *json, const fg_scan_result *result) {
  fg_json_array(json, "rejected");
  for (size_t i = 0; i < result->unclaimeds; i++) {
    const fg_scan_result_unclaimed *one = &result->unclaimed[i];
    if (one->verdict == FG_LOOP_TIED) continue;
    fg_json_object(json, NULL);
    fg_json_string(json, "id", one->id);
    fg_json_string(json, "level", "points");
    fg_json_string(json, "verdict", fg_loop_verdict_word(one->verdict));
    if (one->barred) fg_json_bool(json, "not_confirmed", true);
    fg_json_number(json, "would_explain", one->would_explain);
    fg_json_number(json, "smallest_amplitude", one->smallest_um);
    fg_json_number(json, "retained_share", one->retained_share);
    fg_json_object_end(json);
  }
  fg_json_bump_rejected(json, &result->bumps);
  fg_json_array_end(json);
}

static void write_scan_inputs(fg_json *json, const fg_scan_result *result) {
  fg_json_array(json, "inputs");
  for (size_t i = 0; i < result->scans; i++) {
    fg_json_object(json, NULL);
    fg_json_string(json, "path", result->scan[i].before->scan);
    fg_json_string(json, "sha256", result->scan[i].before->sha256);
    fg_json_bool(json, "hold_out", result->scan[i].hold_out);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
}

static void write_noise(fg_json *json, const fg_scan_noise *noise) {
  fg_json_object(json, "noise");
  fg_json_string(json, "form", noise->model);
  fg_json_number(json, "sd", noise->sd_um);
  fg_json_number(json, "white_sd", noise->white_um);
  fg_json_number(json, "correlated_sd", noise->correlated_um);
  fg_json_number(json, "correlation", noise->correlation);
  fg_json_number(json, "range_mm", noise->range_mm);
  fg_json_number(json, "long_waves", noise->long_waves);
  if (noise->discs) fg_json_numbers(json, "sd_of_discs", noise->disc_um, noise->discs);
  fg_json_object_end(json);
}

static void write_edges(fg_json *json, const fg_scan_result *result) {
  fg_json_number(json, "noise_floor", result->noise_floor_um);
  write_noise(json, &result->noise);
  fg_json_number(json, "edge_model_error", result->edge_model_error_um);
  fg_json_object(json, "half_width");
  fg_json_number(json, "rms", result->half_width_rms_um);
  fg_json_number(json, "smooth", result->half_width_smooth_um);
  fg_json_object_end(json);
}

fg_status fg_scan_loop_write_json(fg_context *ctx, const fg_scan_loop *loop, FILE *out) {
  const fg_scan_result *result = fg_scan_loop_result(loop);
  char *sentence = NULL;
  fg_json json;
  FG_TRY(fg_scan_loop_sentence(ctx, result, &sentence));
  fg_json_begin(&json, out);
  fg_json_object(&json, NULL);
  fg_json_head(&json, "foilgauge/loop/1");
  fg_json_string(&json, "domain", "scan");
  fg_json_string(&json, "verdict", fg_loop_outcome_word(result->verdict));
  fg_json_string(&json, "summary", sentence);
  free(sentence);
  write_scan_inputs(&json, result);
  fg_json_calibration_used(&json, "calibration", &result->scan[0].before->design.calibration);
  fg_json_bool(&json, "same_foil", result->same_foil);
  fg_json_number(&json, "p_value", result->p_value);
  write_edges(&json, result);
  fg_json_string(&json, "unit", "um");
  FG_TRY(write_side(ctx, &json, "before", result, false));
  write_claims(&json, result);
  write_unattributed(&json, result);
  FG_TRY(write_side(ctx, &json, "after", result, true));
  fg_json_object(&json, "error_ratio");
  fg_json_number(&json, "rms", result->after.rms / result->before.rms);
  fg_json_number(&json, "held_out", result->after.held_out_rms / result->before.held_out_rms);
  fg_json_integer(&json, "folds", (int64_t)result->folds);
  fg_json_string(&json, "fold_of", result->fold_of);
  fg_json_object_end(&json);
  write_scan_rejected(&json, result);
  fg_json_strings(&json, "separating_measurement", result->advice, result->advices);
  fg_json_bumps(&json, &result->bumps);
  fg_json_strings(&json, "notes", result->note, result->notes);
  fg_json_object_end(&json);
  fg_json_end(&json);
  return FG_OK;
}
