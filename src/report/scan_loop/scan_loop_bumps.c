#include "report/scan_loop/scan_loop_bumps.h"

#include <math.h>
#include <string.h>

static void write_aliases(fg_json *json, const fg_loop_claim *claim) {
  char name[2 * FG_LOOP_NAME];
  fg_json_array(json, "alias_class");
  fg_json_string(json, NULL, claim->candidate.effect->id);
  for (size_t i = 0; i < claim->aliases; i++) {
    /* "part.lip_decay(bump)": only the id; a sum keeps its words. */
    const fg_loop_alias *alias = &claim->alias[i];
    snprintf(name, sizeof name, "%s", alias->sum ? alias->name : alias->candidate.effect->id);
    fg_json_string(json, NULL, name);
  }
  fg_json_array_end(json);
}

static void write_parameters(fg_json *json, const fg_scan_loop_bumps *bumps, size_t response,
                             const fg_loop_claim *claim, bool u) {
  const char *name;
  double value, sd;
  fg_json_object(json, u ? "uncertainty" : "parameters");
  for (size_t i = 0; fg_scan_loop_bumps_parameter(bumps, response, claim, i, &name, &value, &sd);
       i++)
    fg_json_number(json, name, u ? sd : value);
  fg_json_object_end(json);
}

static void write_claim(fg_json *json, const fg_scan_loop_bumps *bumps, size_t response,
                        const fg_loop_claim *claim) {
  const fg_scan_loop_bump_response *what = &fg_scan_loop_bump_responses[response];
  fg_json_object(json, NULL);
  fg_json_string(json, "id", claim->candidate.effect->id);
  fg_json_string(json, "level", "bumps");
  fg_json_string(json, "verdict", fg_loop_verdict_word(claim->verdict));
  fg_json_string(json, "response", what->name);
  fg_json_string(json, "unit", what->unit);
  write_parameters(json, bumps, response, claim, false);
  write_parameters(json, bumps, response, claim, true);
  fg_json_number(json, "amplitude", what->scale * claim->amplitude);
  fg_json_number(json, "u_amplitude", what->scale * claim->amplitude_u);
  fg_json_number(json, "p_value", claim->p_value);
  fg_json_number(json, "retained_share", claim->retained_share);
  if (claim->verdict == FG_LOOP_TIED) write_aliases(json, claim);
  fg_json_object_end(json);
}

void fg_json_bump_claims(fg_json *json, const fg_scan_loop_bumps *bumps) {
  for (size_t r = 0; r < FG_SCAN_LOOP_BUMP_RESPONSES; r++)
    for (size_t m = 0; m < bumps->level[r].result.claims; m++)
      write_claim(json, bumps, r, &bumps->level[r].result.claim[m]);
}

static void write_rejected(size_t response, const fg_loop_rejected *one, void *user) {
  const fg_scan_loop_bump_response *what = &fg_scan_loop_bump_responses[response];
  fg_json *json = user;
  fg_json_object(json, NULL);
  fg_json_string(json, "id", one->candidate.effect->id);
  fg_json_string(json, "level", "bumps");
  fg_json_string(json, "verdict", fg_loop_verdict_word(one->verdict));
  fg_json_string(json, "response", what->name);
  fg_json_string(json, "unit", what->unit);
  fg_json_number(json, "would_explain", one->would_explain);
  fg_json_number(json, "p_value", one->p_value);
  fg_json_number(json, "smallest_amplitude", what->scale * one->smallest_detectable);
  fg_json_number(json, "retained_share", one->retained_share);
  fg_json_object_end(json);
}

void fg_json_bump_rejected(fg_json *json, const fg_scan_loop_bumps *bumps) {
  fg_scan_loop_bumps_rejected(bumps, write_rejected, json);
}

bool fg_json_bump_curve(fg_json *json, const fg_scan_loop_bumps *bumps) {
  size_t r;
  const fg_loop_curve *curve = fg_scan_loop_bumps_curve(bumps, &r);
  if (!curve) return false;
  const fg_scan_loop_bump_response *what = &fg_scan_loop_bump_responses[r];
  fg_json_object(json, "unattributed");
  fg_json_string(json, "coordinate", "bump.index");
  fg_json_string(json, "moves", what->name);
  fg_json_array(json, "shape");
  for (size_t i = 0; i < curve->count; i++) {
    double pair[2] = {curve->shape[i][0], what->scale * curve->shape[i][1]};
    fg_json_numbers(json, NULL, pair, 2);
  }
  fg_json_array_end(json);
  fg_json_number(json, "rms", what->scale * curve->rms);
  fg_json_number(json, "p_value", curve->p_value);
  fg_json_array(json, "nearest");
  const fg_loop_result *result = &bumps->level[r].result;
  for (size_t k = 0; k < result->rejects; k++)
    if (result->rejected[k].would_explain > 0.3)
      fg_json_string(json, NULL, result->rejected[k].candidate.effect->id);
  fg_json_array_end(json);
  fg_json_object_end(json);
  return true;
}

static void write_error(fg_json *json, const fg_scan_loop_bump_error *error, double scale) {
  fg_json_number(json, "rms_before", scale * error->rms[0]);
  fg_json_number(json, "rms_after", scale * error->rms[1]);
  fg_json_number(json, "held_out_rms_before", scale * error->held_out_rms[0]);
  fg_json_number(json, "held_out_rms_after", scale * error->held_out_rms[1]);
}

void fg_json_bumps(fg_json *json, const fg_scan_loop_bumps *bumps) {
  size_t aside = 0;
  for (size_t i = 0; i < bumps->count; i++)
    aside += bumps->bump[i].aside;
  fg_json_object(json, "bumps");
  fg_json_integer(json, "count", (int64_t)(bumps->count - aside));
  fg_json_integer(json, "kept_aside", (int64_t)aside);
  fg_json_integer(json, "foils", (int64_t)bumps->parts);
  fg_json_array(json, "responses");
  for (size_t r = 0; r < FG_SCAN_LOOP_BUMP_RESPONSES; r++) {
    const fg_scan_loop_bump_response *what = &fg_scan_loop_bump_responses[r];
    fg_json_object(json, NULL);
    fg_json_string(json, "response", what->name);
    fg_json_string(json, "unit", what->unit);
    fg_json_string(json, "model", what->model);
    write_error(json, &bumps->level[r].error, what->scale);
    fg_json_object_end(json);
  }
  fg_json_object(json, NULL);
  fg_json_string(json, "response", "height_mm");
  fg_json_string(json, "unit", "um");
  fg_json_string(json, "model", "follows from radius and angle");
  write_error(json, &bumps->height, 1000);
  fg_json_object_end(json);
  fg_json_array_end(json);
  fg_json_object_end(json);
  fg_json_array(json, "notes");
  for (size_t i = 0; i < bumps->notes; i++)
    fg_json_string(json, NULL, bumps->note[i]);
  fg_json_array_end(json);
}

static void text_claim(const fg_scan_loop_bumps *bumps, size_t response, const fg_loop_claim *claim,
                       FILE *out) {
  const char *name;
  double value, u;
  fprintf(out, "  %s %s of %s over the bumps:", claim->verdict == FG_LOOP_TIED ? "tied " : "found",
          claim->candidate.effect->id, fg_scan_loop_bump_responses[response].name);
  for (size_t i = 0; fg_scan_loop_bumps_parameter(bumps, response, claim, i, &name, &value, &u);
       i++)
    fprintf(out, " %s %.4g +- %.2g", name, value, 2 * u);
  for (size_t i = 0; i < claim->aliases; i++)
    fprintf(out, "%s %s", i ? "," : " (or", claim->alias[i].name);
  fputs(claim->aliases ? ")\n" : "\n", out);
}

void fg_text_bumps(const fg_scan_loop_bumps *bumps, FILE *out) {
  size_t response;
  for (size_t r = 0; r < FG_SCAN_LOOP_BUMP_RESPONSES; r++) {
    const fg_scan_loop_bump_level *level = &bumps->level[r];
    const fg_scan_loop_bump_response *what = &fg_scan_loop_bump_responses[r];
    for (size_t m = 0; m < level->result.claims; m++)
      text_claim(bumps, r, &level->result.claim[m], out);
    if (level->judged)
      fprintf(out, "  bumps: %s about %s: %.3g %s before, %.3g %s after\n", what->name, what->model,
              what->scale * level->error.rms[0], what->unit, what->scale * level->error.rms[1],
              what->unit);
  }
  if (fg_scan_loop_bumps_curve(bumps, &response))
    fprintf(out, "  unattributed, over the bump's number: %s\n",
            fg_scan_loop_bump_responses[response].name);
  for (size_t i = 0; i < bumps->notes; i++)
    fprintf(out, "  %s\n", bumps->note[i]);
}

static void text_rejected(size_t response, const fg_loop_rejected *one, void *user) {
  const fg_scan_loop_bump_response *what = &fg_scan_loop_bump_responses[response];
  FILE *out = user;
  fprintf(out, "  %s: %s of %s over the bumps", fg_loop_verdict_word(one->verdict),
          one->candidate.effect->id, what->name);
  if (isfinite(one->smallest_detectable))
    fprintf(out, ", would have shown from %.3g %s", what->scale * one->smallest_detectable,
            what->unit);
  fputc('\n', out);
}

void fg_text_bumps_rejected(const fg_scan_loop_bumps *bumps, FILE *out) {
  fg_scan_loop_bumps_rejected(bumps, text_rejected, out);
}
