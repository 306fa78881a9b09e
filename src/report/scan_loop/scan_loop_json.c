/* "foilgauge/loop/1", domain "scan". */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "report/measure/measure_json.h"
#include "report/scan_loop/scan_loop_bumps.h"
#include "report/scan_loop/scan_loop_parts.h"
#include "report/scan_loop/scan_loop_shapes.h"
#include "scan_loop/state.h"

/* Parameters by their names; with `u`, their standard uncertainties. */
static void write_parameters(fg_json *json, const fg_effect_found *effect, bool u) {
  const char *name;
  double value, sd;
  fg_json_object(json, u ? "uncertainty" : "parameters");
  for (size_t i = 0; fg_effect_found_number(effect, i, &name, &value, &sd); i++)
    fg_json_number(json, name, u ? sd : value);
  fg_json_object_end(json);
}

static size_t find_effect(const fg_explanations *explanations, const fg_effect *kind) {
  size_t e = 0;
  while (e < explanations->candidate_count && explanations->candidates[e].kind != kind)
    e++;
  return e;
}

/* The explanations that the data allow; of those that differ in an effect's form only, one. */
static void write_class(fg_json *json, const fg_scan_loop *loop) {
  char text[FG_SCAN_LOOP_CLASS_WORDS];
  fg_json_array(json, "alias_class");
  for (size_t k = 0; k < loop->decided.shown_count; k++) {
    fg_scan_loop_explanation_name(&loop->explanations, loop->decided.shown[k], text, sizeof text);
    fg_json_string(json, NULL, text);
  }
  fg_json_array_end(json);
}

static fg_status write_claims(fg_context *ctx, fg_json *json, const fg_scan_loop *loop) {
  fg_json_array(json, "claims");
  for (size_t i = 0; i < loop->set.count; i++) {
    const fg_effect_found *effect = &loop->set.effects[i];
    if (fg_effect_is_free(effect->kind)) continue;
    bool sure = loop->decided.sure[i];
    size_t e = find_effect(&loop->explanations, effect->kind);
    fg_json_object(json, NULL);
    fg_json_string(json, "id", effect->kind->id);
    if (effect->kind->form) fg_json_string(json, "form", effect->kind->form);
    fg_json_string(json, "level", "points");
    fg_json_string(json, "verdict", sure ? "found" : "tied");
    write_parameters(json, effect, false);
    write_parameters(json, effect, true);
    fg_json_number(json, "amplitude", fg_effect_found_amplitude(effect));
    fg_json_number(json, "p_value", loop->explanations.p_value);
    fg_json_number(json, "retained_share",
                   e < loop->explanations.candidate_count ? loop->explanations.share[e] : NAN);
    if (effect->kind->bends) {
      fg_json_string(json, "basis", "deviation of every bump from its best-fit circle");
      FG_TRY(fg_json_scan_shape(ctx, json, loop, effect));
    }
    if (!sure) write_class(json, loop);
    fg_json_object_end(json);
  }
  fg_json_bump_claims(json, &loop->bumps);
  fg_json_array_end(json);
  return FG_OK;
}

static fg_status write_curve(fg_context *ctx, fg_json *json, const fg_scan_loop *loop,
                             const fg_effect_found *curve) {
  fg_json_string(json, "coordinate", fg_effect_coordinate_name(curve->kind->coordinate));
  fg_json_string(json, "moves", curve->kind->moves);
  return fg_json_scan_shape(ctx, json, loop, curve);
}

/* The largest curve; others beside it. */
static fg_status write_unattributed(fg_context *ctx, fg_json *json, const fg_scan_loop *loop) {
  const fg_effect_found *curve = NULL;
  for (size_t i = 0; i < loop->set.count; i++) {
    const fg_effect_found *effect = &loop->set.effects[i];
    if (!fg_effect_is_free(effect->kind)) continue;
    if (!curve || fg_effect_found_amplitude(effect) > fg_effect_found_amplitude(curve))
      curve = effect;
  }
  if (!curve) {
    if (!fg_json_bump_curve(json, &loop->bumps)) fg_json_string(json, "unattributed", NULL);
    return FG_OK;
  }
  fg_json_object(json, "unattributed");
  FG_TRY(write_curve(ctx, json, loop, curve));
  fg_json_array(json, "others");
  for (size_t i = 0; i < loop->set.count; i++) {
    const fg_effect_found *other = &loop->set.effects[i];
    if (!fg_effect_is_free(other->kind) || other == curve) continue;
    fg_json_object(json, NULL);
    FG_TRY(write_curve(ctx, json, loop, other));
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
  fg_json_number(json, "rms", loop->error_before.rms);
  fg_json_number(json, "p_value", loop->explanations.p_value);
  fg_json_array(json, "nearest");
  for (size_t e = 0; e < loop->explanations.candidate_count; e++)
    if (!fg_effect_is_free(loop->explanations.candidates[e].kind) &&
        loop->explanations.alone[e] > 0.3 && !loop->explanations.candidates[e].kind->second)
      fg_json_string(json, NULL, loop->explanations.candidates[e].kind->id);
  fg_json_array_end(json);
  fg_json_object_end(json);
  return FG_OK;
}

static fg_status write_side(fg_context *ctx, fg_json *json, const char *name,
                            const fg_scan_loop *loop, const fg_measurement *measurements,
                            const fg_scan_loop_error *error) {
  fg_json_object(json, name);
  fg_json_number(json, "rms", error->rms);
  fg_json_number(json, "held_out_rms", error->held_out_rms);
  fg_json_number(json, "robust_sd", error->robust_sd);
  fg_json_number(json, "p95", error->p95);
  fg_json_number(json, "maximum", error->maximum);
  fg_json_array(json, "foils");
  for (size_t i = 0; i < loop->scan_count; i++)
    for (size_t f = 0; f < measurements[i].foil_count; f++)
      FG_TRY(fg_json_foil(ctx, json, &measurements[i].design, &measurements[i].foils[f]));
  fg_json_array_end(json);
  if (loop->points.discs) fg_json_array(json, "discs");
  for (size_t i = 0; i < loop->scan_count; i++)
    for (size_t d = 0; d < measurements[i].disc_count; d++)
      FG_TRY(fg_json_disc(ctx, json, &measurements[i].design, &measurements[i].discs[d]));
  if (loop->points.discs) fg_json_array_end(json);
  fg_json_object_end(json);
  return FG_OK;
}

/* Members of the class stand in `alias_class`. */
static void write_rejected(fg_json *json, const fg_scan_loop *loop) {
  fg_json_array(json, "rejected");
  for (size_t i = 0; i < loop->decided.candidates; i++) {
    const fg_scan_loop_unclaimed *candidate = &loop->decided.candidate[i];
    if (candidate->verdict == FG_LOOP_TIED) continue;
    fg_json_object(json, NULL);
    fg_json_string(json, "id", candidate->kind->id);
    fg_json_string(json, "level", "points");
    fg_json_string(json, "verdict", fg_loop_verdict_word(candidate->verdict));
    if (candidate->barred) fg_json_bool(json, "not_confirmed", true);
    fg_json_number(json, "would_explain", candidate->would_explain);
    fg_json_number(json, "smallest_amplitude", candidate->smallest_um);
    fg_json_number(json, "retained_share", candidate->share);
    fg_json_object_end(json);
  }
  fg_json_bump_rejected(json, &loop->bumps);
  fg_json_array_end(json);
}

static void write_advice(fg_json *json, const fg_scan_loop *loop) {
  fg_json_array(json, "separating_measurement");
  for (size_t i = 0; i < loop->decided.advices; i++)
    fg_json_string(json, NULL, loop->decided.advice[i]);
  fg_json_array_end(json);
}

fg_status fg_scan_loop_write_json(fg_context *ctx, const fg_scan_loop *loop, FILE *out) {
  fg_json json;
  fg_json_begin(&json, out);
  fg_json_object(&json, NULL);
  fg_json_head(&json, "foilgauge/loop/1");
  fg_json_string(&json, "domain", "scan");
  fg_json_string(&json, "verdict", fg_loop_outcome_word(loop->verdict));
  fg_json_array(&json, "inputs");
  for (size_t i = 0; i < loop->scan_count; i++) {
    fg_json_object(&json, NULL);
    fg_json_string(&json, "path", loop->before[i].scan);
    fg_json_string(&json, "sha256", loop->before[i].sha256);
    fg_json_bool(&json, "hold_out", loop->hold_out[i]);
    fg_json_object_end(&json);
  }
  fg_json_array_end(&json);
  fg_json_bool(&json, "same_foil", loop->options.same_foil);
  fg_json_number(&json, "noise_floor", loop->noise_floor_um);
  fg_json_number(&json, "edge_model_error", loop->explanations.edge_error_um);
  fg_json_object(&json, "half_width");
  fg_json_number(&json, "rms", loop->explanations.width_rms_um);
  fg_json_number(&json, "smooth", loop->explanations.width_smooth_um);
  fg_json_object_end(&json);
  fg_json_string(&json, "unit", "um");
  FG_TRY(write_side(ctx, &json, "before", loop, loop->before, &loop->error_before));
  FG_TRY(write_claims(ctx, &json, loop));
  FG_TRY(write_unattributed(ctx, &json, loop));
  FG_TRY(write_side(ctx, &json, "after", loop, loop->after, &loop->error_after));
  fg_json_object(&json, "error_ratio");
  fg_json_number(&json, "rms", loop->error_after.rms / loop->error_before.rms);
  fg_json_number(&json, "held_out",
                 loop->error_after.held_out_rms / loop->error_before.held_out_rms);
  fg_json_object_end(&json);
  write_rejected(&json, loop);
  write_advice(&json, loop);
  fg_json_bumps(&json, &loop->bumps);
  fg_json_object_end(&json);
  fg_json_end(&json);
  return FG_OK;
}
