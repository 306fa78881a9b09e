/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "foilgauge/form/1" and its CSV files. */
#include "report/forming/members.h"

#include <math.h>

#include "core/file.h"
#include "foilgauge/quantity.h"
#include "foilgauge/words.h"
#include "forming/material_members.h"
#include "report/design/members.h"
#include "report/forming/words.h"

static const fg_forming *forming_of(const fg_subject *subject) {
  return subject->whole;
}

/* Files that were read beside the design, by their role. */
static const fg_member file_rows[] = {
    {FG_TEXT("path", fg_forming_file, path)},
    {FG_SHA256("sha256", fg_forming_file, sha256)},
};
const fg_members fg_forming_file_members = FG_MEMBERS(file_rows);

fg_subject fg_forming_file_subject(const fg_forming_file *file) {
  return (fg_subject){.object = file->path[0] ? file : NULL};
}

static fg_subject find_material_file(const fg_subject *s) {
  return fg_forming_file_subject(&forming_of(s)->material.file);
}

static fg_subject find_schedule_file(const fg_subject *s) {
  return fg_forming_file_subject(&forming_of(s)->schedule.file);
}

static fg_subject find_die_file(const fg_subject *s) {
  return fg_forming_file_subject(&forming_of(s)->die.file);
}

static const fg_member input_rows[] = {
    {FG_PART("material", find_material_file, &fg_forming_file_members),
     .options = FG_MEMBER_LEFT_OUT},
    {FG_PART("schedule", find_schedule_file, &fg_forming_file_members),
     .options = FG_MEMBER_LEFT_OUT},
    {FG_PART("die", find_die_file, &fg_forming_file_members), .options = FG_MEMBER_LEFT_OUT},
};
static const fg_members input_members = FG_MEMBERS(input_rows);

/* Die and schedule. */
static const char *const shape_words[] = {
    [FG_FORMING_ARCS] = "arcs", [FG_FORMING_SINE] = "sine", NULL};

static const char *find_die_sha256(const fg_subject *s, char *buffer) {
  (void)buffer;
  return forming_of(s)->options.die ? forming_of(s)->die.file.sha256 : NULL;
}

static const fg_member die_rows[] = {
    {FG_WORD("shape", fg_forming, options.shape, shape_words), .words = "of the die's waves"},
    {FG_TEXT_BY("sha256", find_die_sha256), .words = "of the die's report; null: as designed"},
};
static const fg_members die_members = FG_MEMBERS(die_rows);

static const double *list_times(const fg_subject *s, double *buffer, size_t *count) {
  (void)buffer;
  *count = forming_of(s)->schedule.count;
  return forming_of(s)->schedule.time_h;
}

static const double *list_temperatures(const fg_subject *s, double *buffer, size_t *count) {
  (void)buffer;
  *count = forming_of(s)->schedule.count;
  return forming_of(s)->schedule.temperature_C;
}

static const fg_member schedule_rows[] = {
    {FG_NUMBERS_BY("time_h", list_times)},
    {FG_NUMBERS_BY("temperature_C", list_temperatures), .words = "linear between the times"},
};
static const fg_members schedule_members = FG_MEMBERS(schedule_rows);

/* Radii and stresses. */
static double find_fitted_radius(const fg_subject *s) {
  return forming_of(s)->fitted ? forming_of(s)->foil.overall.radius_mm : NAN;
}

static double find_fitted_springback(const fg_subject *s) {
  return forming_of(s)->fitted ? forming_of(s)->foil.overall.springback_error_pct : NAN;
}

static const fg_member overall_rows[] = {
    {FG_NUMBER("radius_mm", fg_forming, overall_radius_mm), .words = "of the integrated strip"},
    {FG_NUMBER("springback_error_pct", fg_forming, springback_error_pct),
     .words = "100 (R0 - R) / R0: below 0 the foil opens"},
    {FG_NUMBER_BY("fitted_radius_mm", find_fitted_radius),
     .words = "of the circle, fitted as a measurement does"},
    {FG_NUMBER_BY("fitted_springback_error_pct", find_fitted_springback),
     .words = "of that circle"},
    {FG_NUMBER("turn_die_deg", fg_forming, turn_die_deg), .words = "of the die per pitch"},
    {FG_NUMBER("turn_deg", fg_forming, turn_deg), .words = "of the free strip per pitch"},
};
static const fg_members overall_members = FG_MEMBERS(overall_rows);

static const fg_member plain_strip_rows[] = {
    {FG_NUMBER("radius_mm", fg_forming, strip_radius_mm)},
    {FG_NUMBER("springback_error_pct", fg_forming, strip_springback_error_pct)},
};
static const fg_members plain_strip_members = FG_MEMBERS(plain_strip_rows);

/* A state of the strip: the subject's index says which. */
static const char *const state_words[] = {
    [FG_FORMING_BENT] = "bent", [FG_FORMING_HEATED] = "heated", [FG_FORMING_FREE] = "free", NULL};

static bool find_state(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = list->object;
  return i < FG_FORMING_STATES;
}

static const char *find_state_word(const fg_subject *state) {
  return state_words[state->index];
}

static double find_mean_stress(const fg_subject *state) {
  return forming_of(state)->mean_stress_mpa[state->index];
}

static double find_largest_stress(const fg_subject *state) {
  return forming_of(state)->largest_stress_mpa[state->index];
}

static const fg_member stress_rows[] = {
    {FG_NUMBER_BY("mean_mpa", find_mean_stress), .words = "over the strip's length"},
    {FG_NUMBER_BY("largest_mpa", find_largest_stress)},
};
static const fg_members stress_members = FG_MEMBERS(stress_rows);

/* A bump: those of its fitted quantities that have an uncertainty when measured. */
static bool make_fitted_row(size_t i, fg_member *row) {
  size_t count;
  const fg_quantity *of = fg_quantities(FG_QUANTITY_OF_BUMP, &count);
  if (i >= count) return false;
  *row = (fg_member){.name = of[i].name,
                     .kind = FG_MEMBER_NUMBER,
                     .offset = offsetof(fg_forming_bump, fitted) + of[i].offset,
                     .words = of[i].words};
  if (of[i].kind != FG_QUANTITY_NUMBER || of[i].u_offset == FG_NO_UNCERTAINTY)
    row->options = FG_MEMBER_NOT_IN_JSON;
  return true;
}

/* A column of page, terminal and CSV for a fitted quantity. */
#define FITTED(name, field, csv_rank, heading_, places)                                            \
  {                                                                                                \
    FG_NUMBER(name, fg_forming_bump, fitted.field),                                                \
        .options = FG_MEMBER_NOT_IN_JSON, .heading = (heading_),                                   \
        .csv = {.rank = (csv_rank), .decimals = 6}, .page = {.rank = 2, .decimals = (places)},     \
        .terminal = {                                                                              \
          2,                                                                                       \
          .decimals = (places)                                                                     \
        }                                                                                          \
  }

static const fg_member bump_rows[] = {
    {FG_INTEGER("number", fg_forming_bump, number), .words = "of the design, from 1",
     .heading = "bump", .csv = {.rank = 1, .heading = "bump"}, .page = {.rank = 1},
     .terminal = {.rank = 1}},
    {FG_NUMBER("die_radius_mm", fg_forming_bump, die_radius_mm),
     .words = "of the die's bump; of a sine, of the circle fitted to it", .heading = "die R,\nmm",
     .csv = {.rank = 3, .decimals = 6}, .page = {.rank = 1, .decimals = 4},
     .terminal = {.rank = 1, .decimals = 4}},
    {FG_NUMBER("die_bump_angle_deg", fg_forming_bump, die_angle_deg),
     .words = "of the die's bump; of a sine, of the circle fitted to it",
     .csv = {.rank = 3, .decimals = 6}},
    {FG_NUMBER("curvature_radius_mm", fg_forming_bump, curvature_radius_mm),
     .words = "1 over the free strip's curvature at its crown", .csv = {.rank = 3, .decimals = 6}},
    {FG_SAME_BY(make_fitted_row)},
    FITTED("radius_mm", radius_mm, 2, "free R,\nmm", 4),
    FITTED("radius_error_pct", radius_error_pct, 2, "e_R,\n%", 2),
    FITTED("bump_angle_deg", bump_angle_deg, 2, "alpha,\n°", 3),
    FITTED("bump_angle_error_pct", bump_angle_error_pct, 2, "e_alpha,\n%", 2),
    {FG_NUMBER("intersection_angle_deg", fg_forming_bump, fitted.intersection_angle_deg),
     .options = FG_MEMBER_NOT_IN_JSON, .csv = {.rank = 2, .decimals = 6}},
    FITTED("intersection_angle_error_pct", intersection_angle_error_pct, 2, "e_theta,\n%", 2),
    FITTED("height_mm", height_mm, 2, "h,\nmm", 4),
};
const fg_members fg_forming_bump_members = FG_MEMBERS(bump_rows);

bool fg_forming_bump_at(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_forming *forming = list->object;
  element->object = &forming->bumps[i];
  return i < forming->bump_count;
}

/* A piece of the strip. */
static const char *const piece_words[] = {"land", "fillet", "bump", NULL};

static const char *find_piece_word(const fg_subject *s, char *buffer) {
  (void)buffer;
  return fg_arc_kind_word(((const fg_forming_piece *)s->object)->kind);
}

static const double *list_stresses(const fg_subject *s, double *buffer, size_t *count) {
  (void)buffer;
  *count = FG_FORMING_STATES;
  return ((const fg_forming_piece *)s->object)->stress_mpa;
}

#define PIECE_NUMBER(name, field)                                                                  \
  FG_NUMBER(name, fg_forming_piece, field), .csv = {.rank = 1, .decimals = 6}
static const fg_member piece_rows[] = {
    {FG_TEXT_BY("kind", find_piece_word), .choices = piece_words, .options = FG_MEMBER_NEVER_NULL,
     .csv = {.rank = 1}},
    {FG_INTEGER("number", fg_forming_piece, number), .words = "of its bump or land",
     .csv = {.rank = 1}},
    {PIECE_NUMBER("start_mm", start_mm), .words = "along the midline"},
    {PIECE_NUMBER("length_mm", length_mm), .words = "along the midline"},
    {PIECE_NUMBER("curvature_die_per_mm", curvature_die),
     .words = "positive round the shaft's axis, as the lands bend"},
    {PIECE_NUMBER("curvature_per_mm", curvature), .words = "of the free strip"},
    {PIECE_NUMBER("moment_n", moment_n), .words = "per mm of width, when bent"},
    {PIECE_NUMBER("moment_share", share), .words = "left at the end of the schedule (rho)"},
    {FG_NUMBERS_BY("face_stress_mpa", list_stresses), .words = "bent, heated, free"},
    {FG_NUMBER("face_stress_bent_mpa", fg_forming_piece, stress_mpa[FG_FORMING_BENT]),
     .options = FG_MEMBER_NOT_IN_JSON, .csv = {.rank = 1, .decimals = 6}},
    {FG_NUMBER("face_stress_heated_mpa", fg_forming_piece, stress_mpa[FG_FORMING_HEATED]),
     .options = FG_MEMBER_NOT_IN_JSON, .csv = {.rank = 1, .decimals = 6}},
    {FG_NUMBER("face_stress_free_mpa", fg_forming_piece, stress_mpa[FG_FORMING_FREE]),
     .options = FG_MEMBER_NOT_IN_JSON, .csv = {.rank = 1, .decimals = 6}},
};
static const fg_members piece_members = FG_MEMBERS(piece_rows);

static bool find_piece(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_forming *forming = list->object;
  element->object = &forming->pieces[i];
  return i < forming->count;
}

/* The report. */
static const char *find_treatment(const fg_subject *s, char *buffer) {
  fg_forming_treatment(forming_of(s), buffer, 200);
  return buffer;
}

void fg_forming_write_notes(fg_json *json, const char *name,
                            char notes[FG_FORMING_NOTES][FG_FORMING_NOTE], size_t count) {
  fg_json_array(json, name);
  for (size_t i = 0; i < count; i++)
    fg_json_string(json, NULL, notes[i]);
  fg_json_array_end(json);
}

static void write_forming_notes(fg_json *json, const char *name, const fg_subject *s) {
  char notes[FG_FORMING_NOTES][FG_FORMING_NOTE];
  fg_forming_write_notes(json, name, notes, fg_forming_notes(forming_of(s), notes));
}

static const fg_member forming_rows[] = {
    {FG_HEAD("foilgauge/form/1")},
    {FG_GROUP("inputs", &input_members),
     .words = "files that were read beside the design, by their role"},
    {FG_OBJECT("design", fg_forming, design, &fg_design_members),
     .schema = FG_REF("design.schema.json")},
    {FG_OBJECT("material", fg_forming, material, &fg_forming_material_members)},
    {FG_TEXT_BY("treatment", find_treatment), .options = FG_MEMBER_NEVER_NULL,
     .words = "the schedule in words"},
    {FG_GROUP("die", &die_members)},
    {FG_GROUP("schedule", &schedule_members)},
    {FG_COUNT("layers", fg_forming, options.layers), .words = "over half the thickness"},
    {FG_COUNT("steps", fg_forming, options.steps), .words = "per stretch of the schedule"},
    {FG_GROUP("overall", &overall_members), .words = "the circle of the whole foil"},
    {FG_GROUP("plain_strip", &plain_strip_members),
     .words = "the lands alone: a plain strip bent to the overall radius"},
    {FG_MAP_BY("face_stress", find_state, find_state_word, &stress_members), .choices = state_words,
     .words = "along the strip, at its face"},
    {FG_NUMBER("moment_share", fg_forming, mean_share), .words = "left over the strip (rho)"},
    {FG_FLAG("fitted", fg_forming, fitted), .words = "the free strip's circles were found"},
    {FG_LIST("bumps", fg_forming, bumps, bump_count, &fg_forming_bump_members)},
    {FG_LIST("strip", fg_forming, pieces, count, &piece_members), .options = FG_MEMBER_ON_LINE,
     .words = "pieces of constant curvature"},
    {FG_WRITTEN("notes", write_forming_notes, FG_FORMING_NOTES_SCHEMA)},
};
static const fg_members forming_members = FG_MEMBERS(forming_rows);

const fg_document fg_forming_document = {
    .file = "form",
    .title = "foilgauge forming report",
    .description =
        "A strip bent, heat treated in the die and released, by a beam model. Units are in "
        "the names. Curvatures are above 0 where the strip bends as its lands do; "
        "stresses are of the fibre that this stretches, bent, heated and free. null is a "
        "value that is not known.",
    .made_by = "`foilgauge forming -o`",
    .members = &forming_members,
};

fg_status fg_forming_write_json(fg_context *ctx, const fg_forming *forming, FILE *out) {
  fg_document_json(out, &forming_members, forming);
  return fg_stream_finish(ctx, out, "the report");
}

/* Named as a lot's reference curve and its bumps.csv have them. */
fg_status fg_forming_write_bumps(fg_context *ctx, const fg_forming *forming, FILE *out) {
  fg_members_csv(out, &fg_forming_bump_members, &(fg_subject){.object = forming, .whole = forming},
                 fg_forming_bump_at);
  return fg_stream_finish(ctx, out, "the bumps");
}

fg_status fg_forming_write_strip(fg_context *ctx, const fg_forming *forming, FILE *out) {
  fg_members_csv(out, &piece_members, &(fg_subject){.object = forming, .whole = forming},
                 find_piece);
  return fg_stream_finish(ctx, out, "the strip");
}
