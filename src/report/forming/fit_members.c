/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "foilgauge/form-fit/1". */
#include <math.h>

#include "core/file.h"
#include "forming/material_members.h"
#include "report/design/members.h"
#include "report/forming/members.h"

static const fg_forming_fit *fit_of(const fg_subject *subject) {
  return subject->whole;
}

static fg_subject find_runs_file(const fg_subject *s) {
  return fg_forming_file_subject(&fit_of(s)->file);
}

static fg_subject find_material_file_of_fit(const fg_subject *s) {
  return fg_forming_file_subject(&fit_of(s)->material.file);
}

static const fg_member input_rows[] = {
    {FG_PART("runs", find_runs_file, &fg_forming_file_members), .options = FG_MEMBER_LEFT_OUT},
    {FG_PART("material", find_material_file_of_fit, &fg_forming_file_members),
     .options = FG_MEMBER_LEFT_OUT},
};
static const fg_members input_members = FG_MEMBERS(input_rows);

/* A constant that was found. */
static const fg_forming_constant_row *constant_of(const fg_subject *s) {
  return fg_forming_constant_of(((const fg_forming_found *)s->object)->constant);
}

static const char *find_constant_name(const fg_subject *s, char *buffer) {
  (void)buffer;
  return constant_of(s)->name;
}

static const char *constant_at(size_t c) {
  return c < FG_FORMING_CONSTANTS ? fg_forming_constant_of((fg_forming_constant)c)->name : NULL;
}

static const char *find_constant_unit(const fg_subject *s, char *buffer) {
  (void)buffer;
  return constant_of(s)->unit;
}

static bool is_by_factors(const fg_subject *s) {
  return constant_of(s)->by_factors;
}

static bool is_by_differences(const fg_subject *s) {
  return !constant_of(s)->by_factors;
}

static double is_identified(const fg_subject *s) {
  return fg_forming_identified(s->object);
}

static const double *list_correlations(const fg_subject *s, double *buffer, size_t *count) {
  (void)buffer;
  *count = fit_of(s)->free;
  return fit_of(s)->correlation[s->index];
}

/* For page and terminal. */
static const char *find_constant_title(const fg_subject *s, char *buffer) {
  snprintf(buffer, 200, "%s, %s", constant_of(s)->words, constant_of(s)->symbol);
  return buffer;
}

static const char *find_value_words(const fg_subject *s, char *buffer) {
  const fg_forming_found *found = s->object;
  snprintf(buffer, 100, "%.5g %s", found->value, constant_of(s)->unit);
  return buffer;
}

static const char *find_interval_words(const fg_subject *s, char *buffer) {
  fg_forming_found_words(s->object, buffer, 80);
  return buffer;
}

static const fg_member found_rows[] = {
    {FG_TEXT_BY("constant", find_constant_title), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .heading = "constant"}},
    {FG_TEXT_BY("constant", find_constant_name), .options = FG_MEMBER_NEVER_NULL,
     .choice_at = constant_at, .words = "its name in the material"},
    {FG_TEXT_BY("unit", find_constant_unit), .options = FG_MEMBER_NEVER_NULL},
    {FG_NUMBER("value", fg_forming_found, value), .words = "that fits the runs best"},
    {FG_TEXT_BY("value", find_value_words), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .heading = "value"}},
    {FG_NUMBER("u_of_logarithm", fg_forming_found, u), .present = is_by_factors,
     .words = "standard uncertainty of its logarithm"},
    {FG_NUMBER("u", fg_forming_found, u), .present = is_by_differences,
     .words = "standard uncertainty"},
    {FG_RANGE("interval_95", fg_forming_found, interval[0], interval[1]),
     .words = "by profile likelihood; null: an end that the runs do not close"},
    {FG_TEXT_BY("interval_95", find_interval_words), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .heading = "95 % interval, profile"}},
    {FG_FLAG("at_bound", fg_forming_found, at_bound),
     .words = "the fit ran to the end of the constant's range: its value is meaningless"},
    {FG_FLAG_BY("identified", is_identified),
     .words = "not at its bound, and both ends of the interval are closed"},
    {FG_NUMBERS_BY("correlation", list_correlations), .words = "with each constant found"},
};
const fg_members fg_forming_found_members = FG_MEMBERS(found_rows);

bool fg_forming_found_at(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_forming_fit *fit = list->object;
  element->object = &fit->found[i];
  return i < fit->free;
}

/* Errors of a model. */
static const fg_member error_rows[] = {
    {FG_COUNT("parameters", fg_forming_errors, parameters)},
    {FG_NUMBER("residual_sd", fg_forming_errors, residual_sd)},
    {FG_NUMBER("left_out_rms", fg_forming_errors, left_out_rms),
     .words = "of each run as the other runs alone predict it"},
};
static const fg_members error_members = FG_MEMBERS(error_rows);

static const fg_member run_rows[] = {
    {FG_NUMBER("temperature_C", fg_forming_run_fit, temperature_C), .heading = "temperature,\n°C",
     .page = {.rank = 1, .digits = 6}, .terminal = {.rank = 1, .digits = 6}},
    {FG_NUMBER("duration_h", fg_forming_run_fit, duration_h), .heading = "duration,\nh",
     .page = {.rank = 1, .digits = 6}, .terminal = {.rank = 1, .digits = 6}},
    {FG_NUMBER("measured", fg_forming_run_fit, measured), .heading = "measured,\n%",
     .page = {.rank = 1, .decimals = 2}, .terminal = {.rank = 1, .decimals = 2}},
    {FG_NUMBER("fitted", fg_forming_run_fit, fitted), .heading = "fitted,\n%",
     .page = {.rank = 1, .decimals = 2}, .terminal = {.rank = 1, .decimals = 2}},
    {FG_NUMBER("left_out", fg_forming_run_fit, left_out),
     .words = "as the other runs alone predict it", .heading = "by the other\nruns alone, %",
     .page = {.rank = 1, .decimals = 2}, .terminal = {.rank = 1, .decimals = 2}},
};
const fg_members fg_forming_run_members = FG_MEMBERS(run_rows);

bool fg_forming_run_at(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_forming_fit *fit = list->object;
  element->object = &fit->run[i];
  return i < fit->runs;
}

/* The report. */
static const char *const response_words[] = {
    [FG_FORMING_OF_STRIP] = "strip", [FG_FORMING_OF_FOIL] = "foil", NULL};

static void write_fit_notes(fg_json *json, const char *name, const fg_subject *s) {
  char notes[FG_FORMING_NOTES][FG_FORMING_NOTE];
  fg_forming_write_notes(json, name, notes, fg_forming_fit_notes(fit_of(s), notes));
}

static const fg_member fit_rows[] = {
    {FG_HEAD("foilgauge/form-fit/1")},
    {FG_GROUP("inputs", &input_members),
     .words = "files that were read beside the design, by their role"},
    {FG_OBJECT("design", fg_forming_fit, design, &fg_design_members),
     .schema = FG_REF("design.schema.json")},
    {FG_TEXT("response", fg_forming_fit, response_name), .words = "column of the runs"},
    {FG_WORD("of", fg_forming_fit, response, response_words), .words = "the response's subject"},
    {FG_LIST_BY("found", fg_forming_found_at, &fg_forming_found_members),
     .words = "constants that were fitted"},
    {FG_OBJECT("beam_model", fg_forming_fit, model, &error_members)},
    {FG_OBJECT("quadratic_surface", fg_forming_fit, surface, &error_members),
     .words = "1 + T + D + T:D + T^2 + D^2"},
    {FG_NUMBER("repeat_sd", fg_forming_fit, repeat_sd),
     .words = "of runs at the same setting; null: none repeats"},
    {FG_LIST("runs", fg_forming_fit, run, runs, &fg_forming_run_members),
     .options = FG_MEMBER_ON_LINE},
    {FG_OBJECT("material", fg_forming_fit, material, &fg_forming_material_members),
     .words = "with the fitted constants"},
    {FG_WRITTEN("notes", write_fit_notes, FG_FORMING_NOTES_SCHEMA)},
};
static const fg_members fit_members = FG_MEMBERS(fit_rows);

const fg_document fg_forming_fit_document = {
    .file = "form_fit",
    .title = "foilgauge report of constants fitted to runs",
    .description =
        "Constants of the beam model of forming from a designed experiment. An end of an "
        "interval that the runs do not close is null. left_out: each run as the other "
        "runs alone predict it.",
    .made_by = "`foilgauge forming --fit -o`",
    .members = &fit_members,
};

fg_status fg_forming_fit_write_json(fg_context *ctx, const fg_forming_fit *fit, FILE *out) {
  fg_document_json(out, &fit_members, fit);
  return fg_stream_finish(ctx, out, "the report");
}
