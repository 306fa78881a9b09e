/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "foilgauge/form/1" and its CSV files. */
#include <math.h>

#include "core/file.h"
#include "core/json_writer.h"
#include "foilgauge/quantity.h"
#include "foilgauge/words.h"
#include "report/design/json.h"
#include "report/forming/words.h"

static void write_material(fg_json *json, const fg_forming_material *material) {
  fg_json_object(json, "material");
  fg_json_string(json, "name", material->name);
  for (int c = 0; c < FG_FORMING_CONSTANTS; c++) {
    const fg_forming_constant_row *row = fg_forming_constant_of((fg_forming_constant)c);
    fg_json_object(json, row->name);
    fg_json_number(json, "value", material->value[c]);
    fg_json_string(json, "unit", row->unit);
    fg_json_string(json, "source", material->source[c]);
    fg_json_object_end(json);
  }
  fg_json_object(json, "yield_curve");
  fg_json_numbers(json, "temperature_C", material->curve_temperature_C, material->curve_count);
  fg_json_numbers(json, "share", material->curve_share, material->curve_count);
  fg_json_string(json, "source", material->curve_source);
  fg_json_object_end(json);
  fg_json_object_end(json);
}

/* Writes an input file under the name of its role. */
static void write_input(fg_json *json, const char *name, const fg_forming_file *file) {
  if (file->path[0]) fg_json_file(json, name, file->path, file->sha256);
}

static void write_treatment(fg_json *json, const fg_forming *forming) {
  fg_json_object(json, "die");
  fg_json_string(json, "shape", fg_forming_shape_word(forming->options.shape));
  fg_json_string(json, "sha256", forming->options.die ? forming->die.file.sha256 : NULL);
  fg_json_object_end(json);
  fg_json_object(json, "schedule");
  fg_json_numbers(json, "time_h", forming->schedule.time_h, forming->schedule.count);
  fg_json_numbers(json, "temperature_C", forming->schedule.temperature_C, forming->schedule.count);
  fg_json_object_end(json);
  fg_json_integer(json, "layers", (int64_t)forming->options.layers);
  fg_json_integer(json, "steps", (int64_t)forming->options.steps);
}

static void write_overall(fg_json *json, const fg_forming *forming) {
  const fg_overall *fitted = &forming->foil.overall;
  bool has = forming->fitted;
  fg_json_object(json, "overall");
  fg_json_number(json, "radius_mm", forming->overall_radius_mm);
  fg_json_number(json, "springback_error_pct", forming->springback_error_pct);
  fg_json_number(json, "fitted_radius_mm", has ? fitted->radius_mm : NAN);
  fg_json_number(json, "fitted_springback_error_pct", has ? fitted->springback_error_pct : NAN);
  fg_json_number(json, "turn_die_deg", forming->turn_die_deg);
  fg_json_number(json, "turn_deg", forming->turn_deg);
  fg_json_object_end(json);
  fg_json_object(json, "plain_strip");
  fg_json_number(json, "radius_mm", forming->strip_radius_mm);
  fg_json_number(json, "springback_error_pct", forming->strip_springback_error_pct);
  fg_json_object_end(json);
}

static void write_stress(fg_json *json, const fg_forming *forming) {
  fg_json_object(json, "face_stress");
  for (int s = 0; s < FG_FORMING_STATES; s++) {
    fg_json_object(json, fg_forming_state_word((fg_forming_state)s));
    fg_json_number(json, "mean_mpa", forming->mean_stress_mpa[s]);
    fg_json_number(json, "largest_mpa", forming->largest_stress_mpa[s]);
    fg_json_object_end(json);
  }
  fg_json_object_end(json);
  fg_json_number(json, "moment_share", forming->mean_share);
}

static void write_bump(fg_json *json, const fg_forming_bump *bump) {
  size_t count;
  const fg_quantity *rows = fg_quantities(FG_QUANTITY_OF_BUMP, &count);
  fg_json_object(json, NULL);
  fg_json_integer(json, "number", bump->number);
  fg_json_number(json, "die_radius_mm", bump->die_radius_mm);
  fg_json_number(json, "die_bump_angle_deg", bump->die_angle_deg);
  fg_json_number(json, "curvature_radius_mm", bump->curvature_radius_mm);
  for (size_t i = 0; i < count; i++)
    if (rows[i].kind == FG_QUANTITY_NUMBER && rows[i].u_offset != FG_NO_UNCERTAINTY)
      fg_json_number(json, rows[i].name, fg_quantity_value(&rows[i], &bump->fitted));
  fg_json_object_end(json);
}

static void write_pieces(fg_json *json, const fg_forming *forming) {
  fg_json_array(json, "strip");
  for (size_t i = 0; i < forming->count; i++) {
    const fg_forming_piece *p = &forming->pieces[i];
    fg_json_object(json, NULL);
    fg_json_line(json);
    fg_json_string(json, "kind", fg_arc_kind_word(p->kind));
    fg_json_integer(json, "number", p->number);
    fg_json_number(json, "start_mm", p->start_mm);
    fg_json_number(json, "length_mm", p->length_mm);
    fg_json_number(json, "curvature_die_per_mm", p->curvature_die);
    fg_json_number(json, "curvature_per_mm", p->curvature);
    fg_json_number(json, "moment_n", p->moment_n);
    fg_json_number(json, "moment_share", p->share);
    fg_json_numbers(json, "face_stress_mpa", p->stress_mpa, FG_FORMING_STATES);
    fg_json_object_end(json);
    fg_json_line_end(json);
  }
  fg_json_array_end(json);
}

static void write_notes(fg_json *json, char notes[FG_FORMING_NOTES][FG_FORMING_NOTE],
                        size_t count) {
  fg_json_array(json, "notes");
  for (size_t i = 0; i < count; i++)
    fg_json_string(json, NULL, notes[i]);
  fg_json_array_end(json);
}

fg_status fg_forming_write_json(fg_context *ctx, const fg_forming *forming, FILE *out) {
  char notes[FG_FORMING_NOTES][FG_FORMING_NOTE], treatment[200];
  fg_json json;
  fg_json_begin(&json, out);
  fg_json_object(&json, NULL);
  fg_json_head(&json, "foilgauge/form/1");
  fg_json_object(&json, "inputs");
  write_input(&json, "material", &forming->material.file);
  write_input(&json, "schedule", &forming->schedule.file);
  write_input(&json, "die", &forming->die.file);
  fg_json_object_end(&json);
  fg_json_design(&json, "design", &forming->design);
  write_material(&json, &forming->material);
  fg_forming_treatment(forming, treatment, sizeof treatment);
  fg_json_string(&json, "treatment", treatment);
  write_treatment(&json, forming);
  write_overall(&json, forming);
  write_stress(&json, forming);
  fg_json_bool(&json, "fitted", forming->fitted);
  fg_json_array(&json, "bumps");
  for (size_t i = 0; i < forming->bump_count; i++)
    write_bump(&json, &forming->bumps[i]);
  fg_json_array_end(&json);
  write_pieces(&json, forming);
  write_notes(&json, notes, fg_forming_notes(forming, notes));
  fg_json_object_end(&json);
  fg_json_end(&json);
  return fg_stream_finish(ctx, out, "the report");
}

static void put_forming_number(FILE *out, double value) {
  if (isfinite(value))
    fprintf(out, ",%.6f", value);
  else
    fputc(',', out);
}

/* Named as a lot's reference curve and its bumps.csv have them. */
fg_status fg_forming_write_bumps(fg_context *ctx, const fg_forming *forming, FILE *out) {
  fputs("bump,radius_mm,radius_error_pct,bump_angle_deg,bump_angle_error_pct,"
        "intersection_angle_deg,intersection_angle_error_pct,height_mm,die_radius_mm,"
        "die_bump_angle_deg,curvature_radius_mm\n",
        out);
  for (size_t i = 0; i < forming->bump_count; i++) {
    const fg_forming_bump *b = &forming->bumps[i];
    const fg_bump *f = &b->fitted;
    const double values[] = {f->radius_mm,
                             f->radius_error_pct,
                             f->bump_angle_deg,
                             f->bump_angle_error_pct,
                             f->intersection_angle_deg,
                             f->intersection_angle_error_pct,
                             f->height_mm,
                             b->die_radius_mm,
                             b->die_angle_deg,
                             b->curvature_radius_mm};
    fprintf(out, "%d", b->number);
    for (size_t k = 0; k < sizeof values / sizeof *values; k++)
      put_forming_number(out, values[k]);
    fputc('\n', out);
  }
  return fg_stream_finish(ctx, out, "the bumps");
}

fg_status fg_forming_write_strip(fg_context *ctx, const fg_forming *forming, FILE *out) {
  fputs("kind,number,start_mm,length_mm,curvature_die_per_mm,curvature_per_mm,moment_n,"
        "moment_share,face_stress_bent_mpa,face_stress_heated_mpa,face_stress_free_mpa\n",
        out);
  for (size_t i = 0; i < forming->count; i++) {
    const fg_forming_piece *p = &forming->pieces[i];
    const double values[] = {p->start_mm,      p->length_mm,     p->curvature_die,
                             p->curvature,     p->moment_n,      p->share,
                             p->stress_mpa[0], p->stress_mpa[1], p->stress_mpa[2]};
    fprintf(out, "%s,%d", fg_arc_kind_word(p->kind), p->number);
    for (size_t k = 0; k < sizeof values / sizeof *values; k++)
      put_forming_number(out, values[k]);
    fputc('\n', out);
  }
  return fg_stream_finish(ctx, out, "the strip");
}

/* ---- a fit ---- */

static void write_errors(fg_json *json, const char *name, const fg_forming_errors *errors) {
  fg_json_object(json, name);
  fg_json_integer(json, "parameters", (int64_t)errors->parameters);
  fg_json_number(json, "residual_sd", errors->residual_sd);
  fg_json_number(json, "left_out_rms", errors->left_out_rms);
  fg_json_object_end(json);
}

static void write_found(fg_json *json, const fg_forming_fit *fit, size_t k) {
  const fg_forming_found *found = &fit->found[k];
  const fg_forming_constant_row *row = fg_forming_constant_of(found->constant);
  fg_json_object(json, NULL);
  fg_json_string(json, "constant", row->name);
  fg_json_string(json, "unit", row->unit);
  fg_json_number(json, "value", found->value);
  fg_json_number(json, row->by_factors ? "u_of_logarithm" : "u", found->u);
  fg_json_numbers(json, "interval_95", found->interval, 2);
  fg_json_bool(json, "at_bound", found->at_bound);
  fg_json_bool(json, "identified", fg_forming_identified(found));
  fg_json_numbers(json, "correlation", fit->correlation[k], fit->free);
  fg_json_object_end(json);
}

static void write_run(fg_json *json, const fg_forming_run_fit *run) {
  fg_json_object(json, NULL);
  fg_json_line(json);
  fg_json_number(json, "temperature_C", run->temperature_C);
  fg_json_number(json, "duration_h", run->duration_h);
  fg_json_number(json, "measured", run->measured);
  fg_json_number(json, "fitted", run->fitted);
  fg_json_number(json, "left_out", run->left_out);
  fg_json_object_end(json);
  fg_json_line_end(json);
}

fg_status fg_forming_fit_write_json(fg_context *ctx, const fg_forming_fit *fit, FILE *out) {
  char notes[FG_FORMING_NOTES][FG_FORMING_NOTE];
  fg_json json;
  fg_json_begin(&json, out);
  fg_json_object(&json, NULL);
  fg_json_head(&json, "foilgauge/form-fit/1");
  fg_json_object(&json, "inputs");
  write_input(&json, "runs", &fit->file);
  write_input(&json, "material", &fit->material.file);
  fg_json_object_end(&json);
  fg_json_design(&json, "design", &fit->design);
  fg_json_string(&json, "response", fit->response_name);
  fg_json_string(&json, "of", fit->response == FG_FORMING_OF_FOIL ? "foil" : "strip");
  fg_json_array(&json, "found");
  for (size_t k = 0; k < fit->free; k++)
    write_found(&json, fit, k);
  fg_json_array_end(&json);
  write_errors(&json, "beam_model", &fit->model);
  write_errors(&json, "quadratic_surface", &fit->surface);
  fg_json_number(&json, "repeat_sd", fit->repeat_sd);
  fg_json_array(&json, "runs");
  for (size_t i = 0; i < fit->runs; i++)
    write_run(&json, &fit->run[i]);
  fg_json_array_end(&json);
  write_material(&json, &fit->material);
  write_notes(&json, notes, fg_forming_fit_notes(fit, notes));
  fg_json_object_end(&json);
  fg_json_end(&json);
  return fg_stream_finish(ctx, out, "the report");
}
