/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Facts of a scanner's model, for reports. */
#include <math.h>
#include <string.h>

#include "scan_loop/result.h"
#include "scan_loop/scanner_model.h"

_Static_assert((int)FG_SCANNER_MODEL_EFFECTS >= (int)FG_FIELDS_MAX, "every field has its place");

/* Returns the half range, um, of the larger component of a displacement in its region. */
static double half_range_um(const fg_field_list *list) {
  enum { PLACES = 65 };
  fg_point span = fg_scanner_model_span(list, PLACES);
  return 500 * fmax(span.x, span.y);
}

static double effect_half_range_um(const fg_scanner_model *model, size_t index) {
  const fg_field_list *all = &model->fields;
  return half_range_um(
      &(fg_field_list){.frame = all->frame, .fields = {all->fields[index]}, .count = 1});
}

/* Returns NaN where there is no map. */
static double map_half_range_um(const fg_scanner_model *model) {
  const fg_field_list *all = &model->fields;
  if (!all->map) return NAN;
  return half_range_um(
      &(fg_field_list){.frame = all->frame, .map = all->map, .map_mm = all->map_mm});
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

void fg_scanner_model_trace(const fg_scanner_model *model, fg_design *design) {
  design->model_scale.known = model->known_diameters > 0 || model->known_grids > 0;
  design->model_scale.artefact = (fg_artefact){{0}, {0}, {0}, {0}};
  if (design->model_scale.known) design->model_scale.artefact = model->artefact;
  fg_calibration *c = &design->calibration;
  bool both = c->stated && c->has_temperature && isfinite(model->temperature_c);
  c->u_bed = both ? fg_calibration_bed(c->temperature_c - model->temperature_c,
                                       hypot(c->u_temperature_k, model->u_temperature_k))
                  : 0;
}

void fg_scanner_model_describe(const fg_scanner_model *model, fg_scanner_model_facts *facts) {
  const fg_field_frame *frame = &model->fields.frame;
  *facts = (fg_scanner_model_facts){.path = model->path,
                                    .sha256 = model->sha256,
                                    .scanner = model->scanner[0] ? model->scanner : NULL,
                                    .date = model->date[0] ? model->date : NULL,
                                    .scans = model->scans,
                                    .known_diameters = model->known_diameters,
                                    .known_grids = model->known_grids,
                                    .tied = model->tied,
                                    .map_half_range_um = map_half_range_um(model),
                                    .temperature_c = model->temperature_c,
                                    .low_mm = {frame->low_mm[0], frame->low_mm[1]},
                                    .high_mm = {frame->high_mm[0], frame->high_mm[1]}};
  for (size_t i = 0; i < model->fields.count; i++) {
    const fg_effect_found effect = effect_of(&model->fields.fields[i]);
    fg_scanner_model_effect *one = &facts->effect[facts->effects++];
    one->id = effect.kind->id;
    one->words = effect.kind->words;
    one->parameters = fg_scan_result_put_parameters(&effect, one->parameter);
    one->half_range_um = effect_half_range_um(model, i);
  }
}
