/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "foilgauge/loop-model/1": the declared model and the effects found, for the next analysis. */
#include "core/file.h"
#include "core/json_writer.h"
#include "foilgauge/loop.h"
#include "foilgauge/words.h"
#include "report/table_loop/reading.h"

static void write_coordinate(fg_json *json, const fg_loop_coordinate *at) {
  fg_json_object(json, NULL);
  fg_json_string(json, "name", at->name);
  fg_json_number(json, "low", at->low);
  fg_json_number(json, "high", at->high);
  fg_json_number(json, "kelvin_offset", at->kelvin_offset);
  fg_json_integer(json, "distinct", (int64_t)at->distinct);
  if (at->levels) {
    fg_json_array(json, "levels");
    for (size_t k = 0; k < at->levels; k++)
      fg_json_string(json, NULL, at->level_name[k]);
    fg_json_array_end(json);
  } else if (at->distinct <= FG_LOOP_COLUMNS + 1) {
    fg_json_numbers(json, "values", at->few, at->distinct);
  }
  fg_json_object_end(json);
}

static void write_model_claim(fg_json *json, const fg_loop_report *report,
                              const fg_loop_claim *claim) {
  const fg_loop_coordinate *at = report->problem->problem.coordinate;
  const fg_loop_effect *effect = claim->candidate.effect;
  fg_json_object(json, NULL);
  fg_json_string(json, "id", effect->id);
  fg_json_string(json, "name", claim->name);
  fg_json_array(json, "coordinates");
  if (effect->accepts) write_coordinate(json, &at[claim->candidate.a]);
  if (effect->accepts && effect->pair) write_coordinate(json, &at[claim->candidate.b]);
  fg_json_array_end(json);
  fg_json_numbers(json, "coefficients", claim->coefficient, claim->columns);
  fg_json_numbers(json, "shape", claim->shape, effect->shapes);
  char sentence[2 * FG_LOOP_WORDS];
  fg_loop_claim_sentence(report, claim, sentence);
  fg_json_string(json, "sentence", sentence);
  fg_json_number(json, "amplitude", claim->amplitude);
  fg_json_number(json, "u_amplitude", claim->amplitude_u);
  fg_json_object_end(json);
}

fg_status fg_loop_write_model(fg_context *ctx, const fg_loop_report *report, FILE *out) {
  const fg_loop_result *result = report->result;
  const fg_loop_problem *problem = &report->problem->problem;
  fg_json json;
  fg_json_begin(&json, out);
  fg_json_object(&json, NULL);
  fg_json_string(&json, "schema", "foilgauge/loop-model/1");
  fg_json_string(&json, "version", FOILGAUGE_VERSION);
  fg_json_object(&json, "found_in");
  fg_json_string(&json, "path", report->path);
  fg_json_string(&json, "sha256", report->sha256);
  fg_json_object_end(&json);
  fg_json_object(&json, "declared");
  fg_json_string(&json, "response", report->spec->response);
  fg_json_string(&json, "model", report->spec->model);
  fg_json_string(&json, "group", report->spec->group);
  fg_json_object_end(&json);
  fg_json_array(&json, "parameters");
  for (size_t k = 0; k < problem->parameters; k++) {
    fg_json_object(&json, NULL);
    fg_json_string(&json, "name", problem->parameter_name[k]);
    fg_json_number(&json, "value", result->parameter[k]);
    fg_json_number(&json, "u_value", result->parameter_u[k]);
    fg_json_object_end(&json);
  }
  fg_json_array_end(&json);
  fg_json_number(&json, "noise_sd", result->noise.sd);
  fg_json_array(&json, "claims");
  for (size_t i = 0; i < result->claims; i++)
    write_model_claim(&json, report, &result->claim[i]);
  fg_json_array_end(&json);
  if (result->has_curve) {
    fg_json_object(&json, "unattributed");
    fg_json_string(&json, "coordinate", result->curve.name);
    fg_json_number(&json, "freedom", result->curve.dof);
    fg_json_array(&json, "shape");
    for (size_t i = 0; i < result->curve.count; i++)
      fg_json_numbers(&json, NULL, result->curve.shape[i], 2);
    fg_json_array_end(&json);
    fg_json_object_end(&json);
  } else {
    fg_json_string(&json, "unattributed", NULL);
  }
  fg_json_object_end(&json);
  fg_json_end(&json);
  return fg_stream_finish(ctx, out, "the model");
}
