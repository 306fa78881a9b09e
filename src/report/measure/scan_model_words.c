#include "report/measure/scan_model_words.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/text.h"
#include "quantity/quantity.h"
#include "report/quantity_json.h"
#include "report/scan_loop/scan_loop_parts.h"
#include "scan_loop/scanner_model.h"

/* ---- the effects ---- */

/* How far an effect moves anything in the region, um: the half range of its larger component. */
static double half_range_um(const fg_field_list *list, size_t index) {
  enum { GRID = 33 };
  const fg_field_frame *f = &list->frame;
  fg_field_list one = {.frame = *f, .fields = {list->fields[index]}, .count = 1};
  fg_point low = {INFINITY, INFINITY}, high = {-INFINITY, -INFINITY};
  for (int i = 0; i < GRID; i++) { /* every field varies along one axis, or alike along both */
    double t = i / (GRID - 1.0);
    fg_point d = fg_field_at(&one, (fg_point){f->low_mm[0] + t * (f->high_mm[0] - f->low_mm[0]),
                                              f->low_mm[1] + t * (f->high_mm[1] - f->low_mm[1])});
    low = (fg_point){fmin(low.x, d.x), fmin(low.y, d.y)};
    high = (fg_point){fmax(high.x, d.x), fmax(high.y, d.y)};
  }
  return 500 * fmax(high.x - low.x, high.y - low.y);
}

static fg_effect_found effect_of(const fg_field *field) {
  fg_effect_found effect = {
      .kind = fg_effect_find(field->id), .columns = field->columns, .shapes = field->shapes};
  for (size_t c = 0; c < field->columns; c++) {
    effect.coefficient_um[c] = 1000 * field->amplitude_mm[c];
    effect.u_coefficient_um[c] = 1000 * field->u_amplitude_mm[c];
  }
  memcpy(effect.shape, field->shape, sizeof effect.shape);
  memcpy(effect.u_shape, field->u_shape, sizeof effect.u_shape);
  return effect;
}

fg_status fg_scanner_model_effects(fg_context *ctx, const fg_scanner_model *model, char **text) {
  const fg_field_list *list = &model->fields;
  *text = NULL;
  if (!list->count) return fg_text_print(ctx, text, "nothing: no error of the scanner was found");
  for (size_t i = 0; i < list->count; i++) {
    const fg_effect_found effect = effect_of(&list->fields[i]);
    char value[64];
    fg_scan_loop_parameter p;
    FG_TRY(fg_text_append(ctx, text, "%s%s (", i ? "; " : "", effect.kind->words));
    for (size_t k = 0; fg_effect_found_parameter(&effect, k, &p); k++) {
      fg_scan_loop_value_words(p.value, p.u, value, sizeof value);
      FG_TRY(fg_text_append(ctx, text, "%s = %s%s%s, ", p.name, value,
                            strcmp(p.unit, "°") ? " " : "", p.unit));
    }
    fg_scan_loop_length_words(half_range_um(list, i), value, sizeof value);
    FG_TRY(fg_text_append(ctx, text, "up to ±%s)", value));
  }
  return FG_OK;
}

static void write_effect(fg_json *json, const fg_field_list *list, size_t index) {
  const fg_effect_found effect = effect_of(&list->fields[index]);
  const char *name;
  double value, u;
  fg_json_object(json, NULL);
  fg_json_string(json, "id", effect.kind->id);
  fg_json_string(json, "words", effect.kind->words);
  for (int side = 0; side < 2; side++) {
    fg_json_object(json, side ? "uncertainty" : "parameters");
    for (size_t k = 0; fg_effect_found_number(&effect, k, &name, &value, &u); k++)
      fg_json_number(json, name, side ? u : value);
    fg_json_object_end(json);
  }
  fg_json_number(json, "half_range_um", half_range_um(list, index));
  fg_json_object_end(json);
}

void fg_json_scan_model(fg_json *json, const char *name, const fg_scanner_model *model) {
  if (!model) {
    fg_json_string(json, name, NULL);
    return;
  }
  const fg_field_frame *frame = &model->fields.frame;
  fg_json_object(json, name);
  fg_json_string(json, "path", model->path);
  fg_json_string(json, "sha256", model->sha256);
  fg_json_string(json, "scanner", model->scanner[0] ? model->scanner : NULL);
  fg_json_string(json, "date", model->date[0] ? model->date : NULL);
  fg_json_integer(json, "scans", (int64_t)model->scans);
  fg_json_numbers(
      json, "region_mm",
      (double[]){frame->low_mm[0], frame->low_mm[1], frame->high_mm[0], frame->high_mm[1]}, 4);
  fg_json_integer(json, "known_diameters", (int64_t)model->known_diameters);
  fg_json_bool(json, "tied", model->tied);
  fg_json_array(json, "effects");
  for (size_t i = 0; i < model->fields.count; i++)
    write_effect(json, &model->fields, i);
  fg_json_array_end(json);
  fg_json_object_end(json);
}

/* ---- words ---- */

const fg_scanner_model *fg_report_model(const fg_report *report) {
  for (size_t i = 0; i < report->scan_count; i++)
    if (report->scans[i].measurement && report->scans[i].measurement->model)
      return report->scans[i].measurement->model;
  return NULL;
}

void fg_scale_words(const fg_scanner_model *model, char *words, size_t size) {
  if (!model)
    fg_text_clip(words, size, "The scanner's own error of scale is not in it.");
  else if (model->known_diameters)
    fg_text_clip(
        words, size,
        "The scanner's scale is that of %zu gauge%s of known diameter, which the model was "
        "found with; what these diameters are uncertain by is not in it.",
        model->known_diameters, model->known_diameters > 1 ? "s" : "");
  else
    fg_text_clip(words, size,
                 "What the scanner's model corrects is in it. An error of scale that is equal in x "
                 "and y is not: the model was found without a known diameter.");
}

fg_status fg_scanner_model_title(fg_context *ctx, const fg_scanner_model *model, char **text) {
  const char *slash = strrchr(model->path, '/');
  *text = NULL;
  FG_TRY(fg_text_append(ctx, text, "%s", slash ? slash + 1 : model->path));
  if (model->scanner[0]) FG_TRY(fg_text_append(ctx, text, ", of the scanner '%s'", model->scanner));
  if (model->date[0]) FG_TRY(fg_text_append(ctx, text, ", of %.10s", model->date));
  if (model->scans)
    FG_TRY(fg_text_append(ctx, text, ", found on %zu scan%s", model->scans,
                          model->scans > 1 ? "s" : ""));
  return FG_OK;
}

void fg_correction_moved(const fg_correction *c, char *words, size_t size) {
  words[0] = 0;
  if (isfinite(c->overall_radius_mm) && isfinite(c->radius_mm))
    fg_text_clip(words, size, "R0 by %+.3g µm, R by up to %+.3g µm, h by up to %+.3g µm",
                 1000 * c->overall_radius_mm, 1000 * c->radius_mm, 1000 * c->height_mm);
  else if (isfinite(c->overall_radius_mm))
    fg_text_clip(words, size, "R0 by %+.3g µm", 1000 * c->overall_radius_mm);
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

void fg_correction_largest(fg_correction *most, const fg_correction *one) {
  size_t count;
  const fg_quantity *rows = fg_quantities(FG_QUANTITY_OF_FOIL, &count);
  fg_foil to = {.correction = *most};
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
  *most = to.correction;
}

void fg_json_correction(fg_json *json, const fg_correction *c) {
  if (!isfinite(c->overall_radius_mm)) return;
  fg_json_object(json, "correction");
  fg_json_quantities(json, FG_QUANTITY_OF_FOIL, "correction.", &(fg_foil){.correction = *c}, true);
  fg_json_object_end(json);
}

static fg_status put_text(FILE *out, fg_status status, char *text) {
  if (status == FG_OK) fg_html_text(out, text);
  free(text);
  return status;
}

fg_status fg_html_corrected(fg_context *ctx, FILE *out, const fg_scanner_model *model,
                            const char *moved, const char *added) {
  char *text;
  if (!model) return FG_OK;
  fputs("<p class=\"corrected\"><b>Corrected by the scanner&#39;s model</b> ", out);
  fg_status status = fg_scanner_model_title(ctx, model, &text);
  FG_TRY(put_text(out, status, text));
  fputs(". It corrects ", out);
  status = fg_scanner_model_effects(ctx, model, &text);
  FG_TRY(put_text(out, status, text));
  if (moved[0]) fprintf(out, ". It moved %s, and added %s", moved, added);
  fputs(model->tied ? ". Other explanations did as well when it was found; u holds how far they "
                      "would have moved each value.</p>\n"
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
  fg_status status = fg_scanner_model_title(ctx, model, &text);
  FG_TRY(put_text(out, status, text));
  const fg_field_frame *f = &model->fields.frame;
  fprintf(out,
          "</dd>\n<dt>Its SHA-256</dt><dd>%s</dd>\n<dt>Its region</dt><dd>x %.4g to %.4g, y %.4g "
          "to %.4g mm of the glass</dd>\n",
          model->sha256, f->low_mm[0], f->high_mm[0], f->low_mm[1], f->high_mm[1]);
  return FG_OK;
}

fg_status fg_text_scan_model(fg_context *ctx, FILE *out, const fg_scanner_model *model) {
  char *title = NULL, *effects = NULL;
  if (!model) return FG_OK;
  const fg_field_frame *f = &model->fields.frame;
  fg_status status = fg_scanner_model_title(ctx, model, &title);
  if (status == FG_OK) status = fg_scanner_model_effects(ctx, model, &effects);
  if (status == FG_OK)
    fprintf(out,
            "CORRECTED by the scanner's model %s\n  SHA-256 %s\n  region x %.4g to %.4g, y %.4g to "
            "%.4g mm of the glass\n  for %s\n",
            title, model->sha256, f->low_mm[0], f->high_mm[0], f->low_mm[1], f->high_mm[1],
            effects);
  free(title);
  free(effects);
  return status;
}
