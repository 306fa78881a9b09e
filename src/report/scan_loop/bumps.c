/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/scan_loop/bumps.h"

#include <math.h>

static void write_ties(fg_json *json, const fg_scan_result_bump_claim *claim) {
  fg_json_array(json, "alias_class");
  if (claim->verdict == FG_LOOP_TIED) fg_json_string(json, NULL, claim->id);
  for (size_t i = 0; claim->verdict == FG_LOOP_TIED && i < claim->ties; i++)
    fg_json_string(json, NULL, claim->tied[i].id);
  fg_json_array_end(json);
}

static void write_parameters(fg_json *json, const fg_scan_result_bump_claim *claim, bool u) {
  fg_json_object(json, u ? "uncertainty" : "parameters");
  for (size_t i = 0; i < claim->parameters; i++)
    fg_json_number(json, claim->parameter_name[i], u ? claim->parameter_u[i] : claim->parameter[i]);
  fg_json_object_end(json);
}

static void write_bump_claim(fg_json *json, const fg_scan_result_response *response,
                             const fg_scan_result_bump_claim *claim) {
  fg_json_object(json, NULL);
  fg_json_string(json, "id", claim->id);
  fg_json_string(json, "level", "bumps");
  fg_json_string(json, "verdict", fg_loop_verdict_word(claim->verdict));
  fg_json_string(json, "response", response->name);
  fg_json_string(json, "unit", response->unit);
  write_parameters(json, claim, false);
  write_parameters(json, claim, true);
  fg_json_number(json, "amplitude", claim->amplitude);
  fg_json_number(json, "u_amplitude", claim->u_amplitude);
  fg_json_number(json, "p_value", claim->p_value);
  fg_json_number(json, "retained_share", claim->retained_share);
  write_ties(json, claim);
  fg_json_object_end(json);
}

void fg_json_bump_claims(fg_json *json, const fg_scan_result_bumps *bumps) {
  for (size_t r = 0; r < FG_SCAN_RESULT_RESPONSES; r++)
    for (size_t m = 0; m < bumps->response[r].claims; m++)
      write_bump_claim(json, &bumps->response[r], &bumps->response[r].claim[m]);
}

static void write_bump_rejected(fg_json *json, const fg_scan_result_response *response,
                                const fg_scan_result_bump_unclaimed *one) {
  fg_json_object(json, NULL);
  fg_json_string(json, "id", one->id);
  fg_json_string(json, "level", "bumps");
  fg_json_string(json, "verdict", fg_loop_verdict_word(one->verdict));
  fg_json_string(json, "response", response->name);
  fg_json_string(json, "unit", response->unit);
  fg_json_number(json, "would_explain", one->would_explain);
  fg_json_number(json, "p_value", one->p_value);
  fg_json_number(json, "smallest_amplitude", one->smallest);
  fg_json_number(json, "retained_share", one->retained_share);
  fg_json_object_end(json);
}

void fg_json_bump_rejected(fg_json *json, const fg_scan_result_bumps *bumps) {
  for (size_t r = 0; r < FG_SCAN_RESULT_RESPONSES; r++)
    for (size_t k = 0; k < bumps->response[r].unclaimeds; k++)
      write_bump_rejected(json, &bumps->response[r], &bumps->response[r].unclaimed[k]);
}

bool fg_json_bump_curve(fg_json *json, const fg_scan_result_bumps *bumps) {
  const fg_scan_result_response *of = bumps->curve;
  if (!of) return false;
  fg_json_object(json, "unattributed");
  fg_json_string(json, "coordinate", bumps->coordinate_name);
  fg_json_string(json, "moves", of->name);
  fg_json_array(json, "shape");
  for (size_t i = 0; i < of->curve_points; i++)
    fg_json_numbers(json, NULL, of->curve[i], 2);
  fg_json_array_end(json);
  fg_json_number(json, "rms", of->curve_rms);
  fg_json_number(json, "p_value", of->curve_p);
  fg_json_array(json, "nearest");
  for (size_t k = 0; k < of->nearests; k++)
    fg_json_string(json, NULL, of->nearest[k]);
  fg_json_array_end(json);
  fg_json_object_end(json);
  return true;
}

static void write_error(fg_json *json, const fg_scan_result_bump_error *error) {
  fg_json_number(json, "rms_before", error->rms[0]);
  fg_json_number(json, "rms_after", error->rms[1]);
  fg_json_number(json, "held_out_rms_before", error->held_out_rms[0]);
  fg_json_number(json, "held_out_rms_after", error->held_out_rms[1]);
}

static void write_response(fg_json *json, const fg_scan_result_response *response) {
  fg_json_object(json, NULL);
  fg_json_string(json, "response", response->name);
  fg_json_string(json, "unit", response->unit);
  fg_json_string(json, "model", response->model);
  fg_json_number(json, "level", response->level);
  fg_json_number(json, "u_level", response->u_level);
  write_error(json, &response->error);
  fg_json_object_end(json);
}

void fg_json_bumps(fg_json *json, const fg_scan_result_bumps *bumps) {
  fg_json_object(json, "bumps");
  fg_json_integer(json, "count", (int64_t)bumps->count);
  fg_json_integer(json, "kept_aside", (int64_t)bumps->held_out);
  fg_json_integer(json, "foils", (int64_t)bumps->parts);
  fg_json_file(json, "declared", bumps->declared_path, bumps->declared_sha256);
  fg_json_array(json, "responses");
  for (size_t r = 0; r < FG_SCAN_RESULT_RESPONSES; r++)
    write_response(json, &bumps->response[r]);
  const fg_scan_result_response height = {.name = "height_mm",
                                          .unit = "um",
                                          .model = "follows from radius and angle",
                                          .level = NAN,
                                          .u_level = NAN,
                                          .error = bumps->height_um};
  write_response(json, &height);
  fg_json_array_end(json);
  fg_json_object_end(json);
}

/* ---- for a terminal ---- */

static void text_claim(const fg_scan_result_response *response,
                       const fg_scan_result_bump_claim *claim, FILE *out) {
  fprintf(out, "  %s %s of %s over the bumps:", claim->verdict == FG_LOOP_TIED ? "tied " : "found",
          claim->id, response->name);
  for (size_t i = 0; i < claim->parameters; i++)
    fprintf(out, " %s %.4g +- %.2g", claim->parameter_name[i], claim->parameter[i],
            2 * claim->parameter_u[i]);
  for (size_t i = 0; i < claim->ties; i++)
    fprintf(out, "%s %s", i ? "," : " (or", claim->tied[i].name);
  fputs(claim->ties ? ")\n" : "\n", out);
}

void fg_text_bumps(const fg_scan_result_bumps *bumps, FILE *out) {
  if (bumps->declared_path)
    fprintf(out,
            "  bumps: declared is what %s (foilgauge forming) predicts of each by its number\n",
            bumps->declared_path);
  for (size_t r = 0; r < FG_SCAN_RESULT_RESPONSES; r++) {
    const fg_scan_result_response *one = &bumps->response[r];
    for (size_t m = 0; m < one->claims; m++)
      text_claim(one, &one->claim[m], out);
    if (one->judged)
      fprintf(out, "  bumps: %s about %s: %.3g %s before, %.3g %s after\n", one->name, one->model,
              one->error.rms[0], one->unit, one->error.rms[1], one->unit);
    if (isfinite(one->level))
      fprintf(out, "  bumps: %s measured minus declared is %+.3g +- %.2g %s on average\n",
              one->name, one->level, 2 * one->u_level, one->unit);
  }
  if (bumps->curve)
    fprintf(out, "  unattributed, over the bump's number: %s\n", bumps->curve->name);
}

static void text_rejected(const fg_scan_result_response *response,
                          const fg_scan_result_bump_unclaimed *one, FILE *out) {
  fprintf(out, "  %s: %s of %s over the bumps", fg_loop_verdict_word(one->verdict), one->id,
          response->name);
  if (isfinite(one->smallest))
    fprintf(out, ", would have shown from %.3g %s", one->smallest, response->unit);
  fputc('\n', out);
}

void fg_text_bumps_rejected(const fg_scan_result_bumps *bumps, FILE *out) {
  for (size_t r = 0; r < FG_SCAN_RESULT_RESPONSES; r++)
    for (size_t k = 0; k < bumps->response[r].unclaimeds; k++)
      text_rejected(&bumps->response[r], &bumps->response[r].unclaimed[k], out);
}
