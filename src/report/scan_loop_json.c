/* "foilgauge/loop/1", domain "scan". */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "loop/scan_loop.h"
#include "report/measure_json.h"
#include "report/scan_loop_bumps.h"
#include "report/scan_loop_shapes.h"

static bool is_free(const char *id) {
  return !strncmp(id, "free.", 5);
}

/* Coordinate of a free curve: what stands between "free." and the direction it moves. */
static void coordinate_of(const char *id, char *out, size_t size) {
  snprintf(out, size, "%s", fg_effect_name(id) + 5);
  char *tail = strrchr(out, '.');
  if (tail && (!strcmp(tail, ".dx") || !strcmp(tail, ".dy"))) *tail = 0;
}

/* Size of an effect, um: of its sine and cosine, or of what leads it. */
static double amplitude_of(const fg_scan_effect *effect) {
  bool led = !strncmp(effect->id, "part.bump_", 10);
  double square = 0;
  for (size_t c = 0; c < (led ? 1 : effect->columns); c++)
    square += effect->coefficient_um[c] * effect->coefficient_um[c];
  return effect->columns == 1 ? effect->coefficient_um[0] : sqrt(square);
}

static double amplitude_u(const fg_scan_effect *effect) {
  double a = fabs(amplitude_of(effect)), sum = 0;
  bool led = !strncmp(effect->id, "part.bump_", 10);
  for (size_t c = 0; c < (led ? 1 : effect->columns) && a > 0; c++) {
    double part = effect->coefficient_um[c] / a * effect->u_coefficient_um[c];
    sum += part * part;
  }
  return sqrt(sum);
}

/* Of a cosine and a sine of twice the angle. */
static double phase_deg(const fg_scan_effect *effect) {
  return 0.5 * atan2(effect->coefficient_um[1], effect->coefficient_um[0]) * 180 / M_PI;
}

static double phase_u_deg(const fg_scan_effect *effect) {
  const double *c = effect->coefficient_um, *u = effect->u_coefficient_um;
  return 0.5 * hypot(c[1] * u[0], c[0] * u[1]) / (c[0] * c[0] + c[1] * c[1]) * 180 / M_PI;
}

/* Parameters by their names; with `u`, their standard uncertainties. */
static void write_parameters(fg_json *json, const fg_scan_effect *effect, bool u) {
  const fg_field_row *row = fg_field_find(effect->id);
  fg_json_object(json, u ? "uncertainty" : "parameters");
  if (row) {
    fg_field field = fg_scan_field(effect, row);
    const char *name;
    double value, sd;
    for (size_t i = 0; fg_field_parameter(&field, i, &name, &value, &sd); i++)
      fg_json_number(json, name, u ? sd : value);
  } else {
    fg_json_number(json, "amplitude_um", u ? amplitude_u(effect) : amplitude_of(effect));
    if (fg_effect_same(effect->id, "part.ovality"))
      fg_json_number(json, "phase_deg", u ? phase_u_deg(effect) : phase_deg(effect));
  }
  fg_json_object_end(json);
}

static size_t find_effect(const fg_subset *subset, const char *id) {
  size_t e = 0;
  while (e < subset->effect_count && strcmp(subset->effects[e].id, id))
    e++;
  return e;
}

/* The effects of a member of the class as a sum. */
static void name_member(const fg_subset *subset, size_t member, char *text, size_t size) {
  size_t used = 0;
  text[0] = 0;
  for (size_t e = 0; e < subset->effect_count && used < size; e++)
    if (subset->members[member].mask >> e & 1)
      used += (size_t)snprintf(text + used, size - used, "%s%s", used ? " + " : "",
                               fg_effect_name(subset->effects[e].id));
}

/* What stands in an effect's place in the other members of the class; the effects that both hold
 * are left out. */
static void write_class(fg_json *json, const fg_scan_loop *loop) {
  const fg_subset *subset = &loop->subset;
  fg_json_array(json, "alias_class");
  for (size_t m = 0; m < subset->member_count && subset->member_count > 1; m++) {
    char text[256], before[256];
    bool known = false;
    name_member(subset, m, text, sizeof text);
    for (size_t k = 0; k < m && !known; k++) {
      name_member(subset, k, before, sizeof before);
      known = !strcmp(text, before);
    }
    if (!known) fg_json_string(json, NULL, text);
  }
  fg_json_array_end(json);
}

/* Whether every member of the class holds the effect, in whatever form. */
static bool in_every_member(const fg_subset *subset, const char *id) {
  for (size_t m = 0; m < subset->member_count; m++) {
    bool held = false;
    for (size_t e = 0; e < subset->effect_count && !held; e++)
      held = (subset->members[m].mask >> e & 1) && fg_effect_same(subset->effects[e].id, id);
    if (!held) return false;
  }
  return true;
}

static fg_status write_claims(fg_context *ctx, fg_json *json, const fg_scan_loop *loop) {
  fg_json_array(json, "claims");
  for (size_t i = 0; i < loop->set.count; i++) {
    const fg_scan_effect *effect = &loop->set.effects[i];
    if (is_free(effect->id)) continue;
    bool sure = in_every_member(&loop->subset, effect->id);
    size_t e = find_effect(&loop->subset, effect->id);
    fg_json_object(json, NULL);
    fg_json_string(json, "id", fg_effect_name(effect->id));
    if (fg_effect_form(effect->id)) fg_json_string(json, "form", fg_effect_form(effect->id));
    fg_json_string(json, "level", "points");
    fg_json_string(json, "verdict", sure ? "found" : "tied");
    write_parameters(json, effect, false);
    write_parameters(json, effect, true);
    fg_json_number(json, "amplitude", amplitude_of(effect));
    fg_json_number(json, "p_value", loop->subset.p_value);
    fg_json_number(json, "retained_share",
                   e < loop->subset.effect_count ? loop->subset.share[e] : NAN);
    if (!strncmp(effect->id, "part.bump_", 10)) {
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
                             const fg_scan_effect *curve) {
  char coordinate[48];
  coordinate_of(curve->id, coordinate, sizeof coordinate);
  const char *direction = strrchr(curve->id, '.');
  fg_json_string(json, "coordinate", coordinate);
  fg_json_string(json, "moves",
                 !strcmp(direction, ".dx")   ? "x"
                 : !strcmp(direction, ".dy") ? "y"
                 : strchr(direction, ':')    ? "along the radius"
                                             : "along the normal");
  return fg_json_scan_shape(ctx, json, loop, curve);
}

/* The largest curve; others beside it. */
static fg_status write_unattributed(fg_context *ctx, fg_json *json, const fg_scan_loop *loop) {
  const fg_scan_effect *curve = NULL;
  for (size_t i = 0; i < loop->set.count; i++) {
    const fg_scan_effect *effect = &loop->set.effects[i];
    if (!is_free(effect->id)) continue;
    if (!curve || amplitude_of(effect) > amplitude_of(curve)) curve = effect;
  }
  if (!curve) {
    if (!fg_json_bump_curve(json, &loop->bumps)) fg_json_string(json, "unattributed", NULL);
    return FG_OK;
  }
  fg_json_object(json, "unattributed");
  FG_TRY(write_curve(ctx, json, loop, curve));
  fg_json_array(json, "others");
  for (size_t i = 0; i < loop->set.count; i++) {
    const fg_scan_effect *other = &loop->set.effects[i];
    if (!is_free(other->id) || other == curve) continue;
    fg_json_object(json, NULL);
    FG_TRY(write_curve(ctx, json, loop, other));
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
  fg_json_number(json, "rms", loop->error_before.rms);
  fg_json_number(json, "p_value", loop->subset.p_value);
  fg_json_array(json, "nearest");
  for (size_t e = 0; e < loop->subset.effect_count; e++)
    if (!loop->subset.effects[e].free && loop->subset.alone[e] > 0.3 &&
        !strchr(loop->subset.effects[e].id, ':'))
      fg_json_string(json, NULL, fg_effect_name(loop->subset.effects[e].id));
  fg_json_array_end(json);
  fg_json_object_end(json);
  return FG_OK;
}

static fg_status write_side(fg_context *ctx, fg_json *json, const char *name,
                            const fg_scan_loop *loop, const fg_measurement *measurements,
                            const fg_scan_error *error) {
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

/* Whether an effect is claimed, or a member of the class of what is. */
static bool is_claimed(const fg_scan_loop *loop, const char *id) {
  for (size_t i = 0; i < loop->set.count; i++)
    if (fg_effect_same(loop->set.effects[i].id, id)) return true;
  for (size_t m = 0; m < loop->subset.member_count; m++)
    for (size_t e = 0; e < loop->subset.effect_count; e++)
      if ((loop->subset.members[m].mask >> e & 1) && fg_effect_same(loop->subset.effects[e].id, id))
        return true;
  return false;
}

/* What the data could not have shown at 3 um is inconclusive, or absorbed by the geometry. */
static void write_rejected(fg_json *json, const fg_scan_loop *loop) {
  static const double matters_um = 3;
  fg_json_array(json, "rejected");
  for (size_t e = 0; e < loop->subset.effect_count; e++) {
    const fg_subset_effect *effect = &loop->subset.effects[e];
    /* Of two forms of one effect the first speaks for both. */
    if (effect->free || is_claimed(loop, effect->id) || strchr(effect->id, ':')) continue;
    double smallest = loop->subset.smallest_um[e];
    bool shown = smallest <= matters_um;
    fg_json_object(json, NULL);
    fg_json_string(json, "id", effect->id);
    fg_json_string(json, "level", "points");
    fg_json_string(json, "verdict",
                   shown                          ? "absent"
                   : loop->subset.share[e] < 1e-4 ? "absorbed by geometry"
                                                  : "inconclusive");
    fg_json_number(json, "would_explain", loop->subset.alone[e]);
    fg_json_number(json, "smallest_amplitude", smallest);
    fg_json_number(json, "retained_share", loop->subset.share[e]);
    fg_json_object_end(json);
  }
  for (size_t b = 0; b < loop->points.barred_count; b++) {
    const fg_points_barred *barred = &loop->points.barred[b];
    if (is_free(barred->id)) continue;
    fg_json_object(json, NULL);
    fg_json_string(json, "id", barred->id);
    fg_json_string(json, "level", "points");
    fg_json_string(json, "verdict", "inconclusive");
    fg_json_number(json, "would_explain", barred->would_explain);
    fg_json_number(json, "smallest_amplitude", barred->smallest_um);
    fg_json_number(json, "retained_share", barred->share);
    fg_json_object_end(json);
  }
  fg_json_bump_rejected(json, &loop->bumps);
  fg_json_array_end(json);
}

static void write_advice(fg_json *json, const fg_scan_loop *loop) {
  fg_json_array(json, "separating_measurement");
  if (loop->tied && loop->points.discs)
    fg_json_string(json, NULL,
                   "scan a plate of several gauges on the same scanner: what all of them show is "
                   "the scanner, and an oval is each one's own");
  else if (loop->tied && !loop->options.same_foil)
    fg_json_string(json, NULL,
                   "scan the same foil again, turned by about 90 degrees, and run the loop on both "
                   "scans with --same-foil: what stays with the glass is the scanner, what turns "
                   "is the part");
  else if (loop->tied)
    fg_json_string(json, NULL,
                   "scan another foil on the same scanner: what repeats is the scanner");
  if (loop->scale_tied)
    fg_json_string(json, NULL,
                   "scan a gauge of known diameter on the same scanner (--form discs): it tells "
                   "the scale, which no foil of unknown size can");
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
  fg_json_number(&json, "edge_model_error", loop->subset.edge_error_um);
  fg_json_object(&json, "half_width");
  fg_json_number(&json, "rms", loop->subset.width_rms_um);
  fg_json_number(&json, "smooth", loop->subset.width_smooth_um);
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

fg_status fg_scan_loop_write_text(fg_context *ctx, const fg_scan_loop *loop, FILE *out) {
  (void)ctx;
  fprintf(out, "%s: edge residual %.3f um before, %.3f um after; noise %.3f um\n",
          fg_loop_outcome_word(loop->verdict), loop->error_before.rms, loop->error_after.rms,
          loop->noise_floor_um);
  for (size_t i = 0; i < loop->set.count; i++) {
    const fg_scan_effect *effect = &loop->set.effects[i];
    if (is_free(effect->id)) {
      char coordinate[48];
      coordinate_of(effect->id, coordinate, sizeof coordinate);
      fprintf(out, "  unattributed, over %s: %.2f um\n", coordinate, amplitude_of(effect));
      continue;
    }
    bool sure = in_every_member(&loop->subset, effect->id);
    fprintf(out, "  %s %s:", sure ? "found" : "tied ", fg_effect_name(effect->id));
    const fg_field_row *row = fg_field_find(effect->id);
    fg_field field = {.row = row};
    const char *name;
    double value, u;
    if (row) field = fg_scan_field(effect, row);
    for (size_t p = 0; row && fg_field_parameter(&field, p, &name, &value, &u); p++)
      fprintf(out, " %s %.6g +- %.2g", name, value, 2 * u);
    if (!row)
      fprintf(out, " amplitude_um %.4g +- %.2g", amplitude_of(effect), 2 * amplitude_u(effect));
    fputc('\n', out);
  }
  fg_text_bumps(&loop->bumps, out);
  for (size_t i = 0; i < loop->scan_count; i++)
    for (size_t f = 0; f < loop->before[i].foil_count && f < loop->after[i].foil_count; f++) {
      const fg_foil *b = &loop->before[i].foils[f], *a = &loop->after[i].foils[f];
      fprintf(out, "%s foil %d: R0 %.5f -> %.5f mm\n", loop->before[i].scan, b->number,
              b->overall.radius_mm, a->overall.radius_mm);
      for (size_t k = 0; k < b->bump_count && k < a->bump_count; k++)
        fprintf(out, "  bump %d: R %.5f -> %.5f mm, h %.5f -> %.5f mm\n", b->bumps[k].number,
                b->bumps[k].radius_mm, a->bumps[k].radius_mm, b->bumps[k].height_mm,
                a->bumps[k].height_mm);
    }
  for (size_t i = 0; i < loop->scan_count; i++)
    for (size_t d = 0; d < loop->before[i].disc_count && d < loop->after[i].disc_count; d++) {
      const fg_disc *b = &loop->before[i].discs[d], *a = &loop->after[i].discs[d];
      fprintf(out, "%s disc %d: D %.5f -> %.5f mm, rms %.2f -> %.2f um\n", loop->before[i].scan,
              b->number, b->diameter_mm, a->diameter_mm, b->rms_um, a->rms_um);
    }
  for (size_t b = 0; b < loop->points.barred_count; b++)
    fprintf(out, "  not confirmed from disc to disc: %s\n", loop->points.barred[b].id);
  if (loop->tied || loop->scale_tied)
    fputs(
        "Several explanations do equally well: -o lists them, and the range of every dimension.\n",
        out);
  fputs("+- is U = 2 u.\n", out);
  return FG_OK;
}
