/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/measure/scan_model_words.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/text.h"
#include "foilgauge/scan_loop.h"
#include "page/page.h"
#include "quantity/quantity_rows.h"
#include "report/correction_words.h"
#include "report/value_words.h"

/* ---- the effects ---- */

static fg_status append_effect(fg_context *ctx, const fg_scanner_model_effect *effect,
                               char **text) {
  char value[64];
  FG_TRY(fg_text_append(ctx, text, "%s (", effect->words));
  for (size_t k = 0; k < effect->parameters; k++) {
    const fg_scan_result_parameter *p = &effect->parameter[k];
    fg_scan_loop_value_words(p->told, p->u_told, value, sizeof value);
    FG_TRY(fg_text_append(ctx, text, "%s = %s%s%s, ", p->symbol, value,
                          strcmp(p->unit, "°") ? " " : "", p->unit));
  }
  fg_scan_loop_length_words(effect->half_range_um, value, sizeof value);
  return fg_text_append(ctx, text, "up to ±%s)", value);
}

static fg_status append_map(fg_context *ctx, const fg_scanner_model_facts *facts, char **text) {
  char value[64];
  fg_scan_loop_length_words(facts->map_half_range_um, value, sizeof value);
  return fg_text_append(ctx, text,
                        "%sa smooth displacement of the picture without a name (up to ±%s)",
                        facts->effects ? "; " : "", value);
}

/* Lists what the model corrects: "a wrong scale along the carriage's way (q = 2000 ± 1 ppm); ...".
 * The caller frees. */
static fg_status effects_of(fg_context *ctx, const fg_scanner_model *model, char **text) {
  fg_scanner_model_facts facts;
  fg_scanner_model_describe(model, &facts);
  *text = NULL;
  bool has_map = isfinite(facts.map_half_range_um);
  if (!facts.effects && !has_map)
    return fg_text_print(ctx, text, "nothing: no error of the scanner was found");
  for (size_t i = 0; i < facts.effects; i++) {
    if (i) FG_TRY(fg_text_append(ctx, text, "; "));
    FG_TRY(append_effect(ctx, &facts.effect[i], text));
  }
  return has_map ? append_map(ctx, &facts, text) : FG_OK;
}

static bool find_parameter(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_scanner_model_effect *effect = list->object;
  element->object = &effect->parameter[i];
  return i < effect->parameters;
}

static const char *name_parameter(const fg_subject *element) {
  return ((const fg_scan_result_parameter *)element->object)->name;
}

static const fg_member value_rows[] = {{FG_NUMBER(NULL, fg_scan_result_parameter, value)}};
static const fg_members value_members = FG_MEMBERS(value_rows);
static const fg_member uncertainty_rows[] = {
    {FG_NUMBER(NULL, fg_scan_result_parameter, u), .options = FG_MEMBER_NOT_NEGATIVE}};
static const fg_members uncertainty_members = FG_MEMBERS(uncertainty_rows);

static const fg_member effect_rows[] = {
    {FG_STRING("id", fg_scanner_model_effect, id), .options = FG_MEMBER_NEVER_NULL},
    {FG_STRING("words", fg_scanner_model_effect, words), .options = FG_MEMBER_NEVER_NULL},
    {FG_MAP_BY("parameters", find_parameter, name_parameter, &value_members),
     .words = "its parameters by name"},
    {FG_MAP_BY("uncertainty", find_parameter, name_parameter, &uncertainty_members),
     .words = "their standard uncertainties"},
    {FG_NUMBER("half_range_um", fg_scanner_model_effect, half_range_um),
     .words = "how far it moves anything in the region"},
};
static const fg_members effect_members = FG_MEMBERS(effect_rows);

static const double *list_region(const fg_subject *subject, double *values, size_t *count) {
  const fg_scanner_model_facts *facts = subject->object;
  memcpy(values,
         (double[]){facts->low_mm[0], facts->low_mm[1], facts->high_mm[0], facts->high_mm[1]},
         4 * sizeof *values);
  *count = 4;
  return values;
}

static const fg_member model_rows[] = {
    {FG_STRING("path", fg_scanner_model_facts, path), .options = FG_MEMBER_NEVER_NULL},
    {FG_STRING("sha256", fg_scanner_model_facts, sha256), .options = FG_MEMBER_NEVER_NULL,
     .pattern = FG_SHA256_PATTERN},
    {FG_STRING("scanner", fg_scanner_model_facts, scanner), .words = "its name; null: not said"},
    {FG_STRING("date", fg_scanner_model_facts, date),
     .words = "of the newest scan that it was found on; null: not said"},
    {FG_COUNT("scans", fg_scanner_model_facts, scans), .words = "that it was found on"},
    {FG_NUMBERS_BY("region_mm", list_region), .lowest = 4, .highest = 4,
     .options = FG_MEMBER_NEVER_NULL,
     .words = "of the glass, that it was found in: x, y of one corner and of the opposite one"},
    {FG_COUNT("known_diameters", fg_scanner_model_facts, known_diameters),
     .words = "gauges of known diameter that hold its absolute scale; 0: an error of scale equal "
              "in x and y is not in any u_"},
    {FG_COUNT("known_grids", fg_scanner_model_facts, known_grids),
     .words = "scans of grids of known pitch that hold its absolute scale"},
    {FG_NUMBER("temperature_C", fg_scanner_model_facts, temperature_c),
     .words = "of the scanner when it was found; null: not said"},
    {FG_FLAG("tied", fg_scanner_model_facts, tied),
     .words = "other explanations did as well; every u_ holds them"},
    {FG_ARRAY("effects", fg_scanner_model_facts, effect, effects, &effect_members),
     .words = "what it corrects"},
    {FG_NUMBER("map_half_range_um", fg_scanner_model_facts, map_half_range_um),
     .words = "how far its map, a displacement without a name, moves anything in the region; null: "
              "it has none"},
};
const fg_members fg_scan_model_members = {.rows = model_rows,
                                          .count = sizeof model_rows / sizeof *model_rows,
                                          .definition = "model",
                                          .nullable = true,
                                          .file = "measure"};

/* A model's facts live as long as they are written. */
void fg_json_scan_model(fg_json *json, const char *name, const fg_scanner_model *model) {
  fg_scanner_model_facts facts;
  const fg_scanner_model_facts *place = model ? &facts : NULL;
  const fg_member row = {
      .name = name, .kind = FG_MEMBER_OBJECT, .pointed = true, .members = &fg_scan_model_members};
  if (model) fg_scanner_model_describe(model, &facts);
  fg_member_json(json, &row, &(fg_subject){.object = &place});
}

/* ---- words ---- */

const fg_scanner_model *fg_report_model(const fg_report *report) {
  for (size_t i = 0; i < report->scan_count; i++)
    if (report->scans[i].measurement && report->scans[i].measurement->model)
      return report->scans[i].measurement->model;
  return NULL;
}

/* Writes the words on scale of a scanner's model. */
static void model_scale_words(const fg_scanner_model *model, char *words, size_t size) {
  fg_scanner_model_facts facts;
  fg_scanner_model_describe(model, &facts);
  if (facts.known_diameters)
    fg_text_clip(
        words, size,
        "The scanner's scale is that of %zu gauge%s of known diameter, which the model was "
        "found with; what these diameters are uncertain by is not in it.",
        facts.known_diameters, facts.known_diameters > 1 ? "s" : "");
  else if (facts.known_grids)
    fg_text_clip(words, size,
                 "The scanner's scale is that of a grid of known pitch, which the model was found "
                 "with.");
  else
    fg_text_clip(words, size,
                 "What the scanner's model corrects is in it. An error of scale that is equal in x "
                 "and y is not: the model was found without a known diameter.");
}

void fg_scale_words(const fg_scanner_model *model, const fg_calibration *calibration, char *words,
                    size_t size) {
  char scale[FG_SCALE_WORDS] = "The scanner's own error of scale is not in it.";
  if (fg_calibration_has_scale(calibration)) {
    fg_calibration_budget terms = fg_calibration_terms(calibration);
    double max = fmax(terms.length[0], terms.length[1]);
    fg_text_clip(words, size,
                 "It includes the uncertainty of the stated calibration: %.2g %% of a length, the "
                 "same in every foil of this scanner%s.",
                 100 * FG_COVERAGE_FACTOR * max,
                 model ? "; what the scanner's model corrects is in it too" : "");
    return;
  }
  if (model) model_scale_words(model, scale, sizeof scale);
  if (calibration->stated)
    fg_text_clip(words, size,
                 "It includes the uncertainty of the temperature: %.2g %% of a length. %s",
                 100 * FG_COVERAGE_FACTOR * fg_calibration_terms(calibration).length[0], scale);
  else
    fg_text_clip(words, size, "No calibration is stated: U holds statistics only. %s", scale);
}

/* "left.json, of the scanner 'left desk', 2026-03-14, found on 2 scans". The caller frees. */
static fg_status title_of(fg_context *ctx, const fg_scanner_model *model, char **text) {
  fg_scanner_model_facts facts;
  fg_scanner_model_describe(model, &facts);
  const char *slash = strrchr(facts.path, '/');
  *text = NULL;
  FG_TRY(fg_text_append(ctx, text, "%s", slash ? slash + 1 : facts.path));
  if (facts.scanner) FG_TRY(fg_text_append(ctx, text, ", of the scanner '%s'", facts.scanner));
  if (facts.date) FG_TRY(fg_text_append(ctx, text, ", of %.10s", facts.date));
  if (isfinite(facts.temperature_c))
    FG_TRY(fg_text_append(ctx, text, ", at %g °C", facts.temperature_c));
  if (facts.scans)
    FG_TRY(fg_text_append(ctx, text, ", found on %zu scan%s", facts.scans,
                          facts.scans > 1 ? "s" : ""));
  return FG_OK;
}

/* Dimensions left as measured are not named. */
void fg_correction_moved(const fg_correction *c, char *words, size_t size) {
  const struct {
    const char *name;
    double mm;
  } moves[] = {
      {"R0 by", c->overall_radius_mm}, {"R by up to", c->radius_mm}, {"h by up to", c->height_mm}};
  size_t used = 0;
  words[0] = 0;
  if (!isfinite(c->overall_radius_mm)) return;
  for (size_t i = 0; i < sizeof moves / sizeof *moves && used + 1 < size; i++) {
    if (!isfinite(moves[i].mm) || moves[i].mm == 0) continue;
    fg_text_clip(words + used, size - used, "%s%s %+.3g µm", used ? ", " : "", moves[i].name,
                 1000 * moves[i].mm);
    used = strlen(words);
  }
  if (!used) fg_text_clip(words, size, "nothing");
}

void fg_correction_added(const fg_correction *c, char *words, size_t size) {
  words[0] = 0;
  if (isfinite(c->overall_radius_mm) && isfinite(c->radius_mm))
    fg_text_clip(words, size,
                 "%.2g µm to u of R0, up to %.2g µm to that of R, up to %.2g µm to that of h",
                 1000 * c->u_overall_radius_mm, 1000 * c->u_radius_mm, 1000 * c->u_height_mm);
  else if (isfinite(c->overall_radius_mm))
    fg_text_clip(words, size, "%.2g µm to u of R0", 1000 * c->u_overall_radius_mm);
}

void fg_correction_largest(fg_correction *max, const fg_correction *one) {
  size_t count;
  const fg_quantity *rows = fg_quantities(FG_QUANTITY_OF_FOIL, &count);
  fg_foil to = {.correction = *max};
  const fg_foil from = {.correction = *one};
  for (size_t i = 0; i < count; i++) {
    double old[FG_QUANTITY_NUMBERS_MAX], new[FG_QUANTITY_NUMBERS_MAX];
    if (strncmp(rows[i].name, "correction.", strlen("correction.")) != 0) continue;
    size_t width = fg_quantity_numbers(&rows[i], &to, old);
    fg_quantity_numbers(&rows[i], &from, new);
    for (size_t k = 0; k < width; k++)
      if (isfinite(new[k]) && !(fabs(new[k]) <= fabs(old[k]))) old[k] = new[k];
    fg_quantity_restore(&rows[i], &to, old);
  }
  *max = to.correction;
}

void fg_json_correction(fg_json *json, const fg_correction *c) {
  const fg_member row = {
      .name = "correction", .kind = FG_MEMBER_OBJECT, .members = &fg_correction_members};
  if (isfinite(c->overall_radius_mm)) fg_member_json(json, &row, &(fg_subject){.object = c});
}

static fg_status put_model_text(FILE *out, fg_status status, char *text) {
  if (status == FG_OK) fg_html_text(out, text);
  free(text);
  return status;
}

fg_status fg_html_corrected(fg_context *ctx, FILE *out, const fg_scanner_model *model,
                            const char *moved, const char *added) {
  char *text;
  if (!model) return FG_OK;
  fputs("<p class=\"corrected\"><b>Corrected by the scanner&#39;s model</b> <span>", out);
  fg_status status = title_of(ctx, model, &text);
  FG_TRY(put_model_text(out, status, text));
  fputs("</span>. <span>It corrects ", out);
  status = effects_of(ctx, model, &text);
  FG_TRY(put_model_text(out, status, text));
  fputs("</span>", out);
  if (moved[0]) fprintf(out, ". <span>It moved %s, and added %s</span>", moved, added);
  fputs(fg_scanner_model_is_tied(model)
            ? ". Other explanations did as well when it was found; u holds how far from "
              "it each of them would have put a value.</p>\n"
            : ".</p>\n",
        out);
  return FG_OK;
}

fg_status fg_html_model_facts(fg_context *ctx, FILE *out, const fg_scanner_model *model) {
  char *text;
  fputs("<dt>Scanner&#39;s model</dt><dd>", out);
  if (!model) {
    fputs("none: the scan is taken as it is</dd>\n", out);
    return FG_OK;
  }
  fg_scanner_model_facts facts;
  fg_scanner_model_describe(model, &facts);
  fg_status status = title_of(ctx, model, &text);
  FG_TRY(put_model_text(out, status, text));
  fprintf(out,
          "</dd>\n<dt>Its SHA-256</dt><dd translate=\"no\">%s</dd>\n<dt>Its region</dt><dd>x %.4g "
          "to %.4g, y %.4g "
          "to %.4g mm of the glass</dd>\n",
          facts.sha256, facts.low_mm[0], facts.high_mm[0], facts.low_mm[1], facts.high_mm[1]);
  return FG_OK;
}

fg_status fg_text_scan_model(fg_context *ctx, FILE *out, const fg_scanner_model *model) {
  char *title = NULL, *effects = NULL;
  if (!model) return FG_OK;
  fg_scanner_model_facts facts;
  fg_scanner_model_describe(model, &facts);
  fg_status status = title_of(ctx, model, &title);
  if (status == FG_OK) status = effects_of(ctx, model, &effects);
  if (status == FG_OK)
    fprintf(out,
            "CORRECTED by the scanner's model %s\n  SHA-256 %s\n  region x %.4g to %.4g, y %.4g to "
            "%.4g mm of the glass\n  for %s\n",
            title, facts.sha256, facts.low_mm[0], facts.high_mm[0], facts.low_mm[1],
            facts.high_mm[1], effects);
  free(title);
  free(effects);
  return status;
}
