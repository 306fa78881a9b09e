/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "foilgauge/loop-model/1": the declared model and the effects found, for the next analysis. */
#include "core/file.h"
#include "foilgauge/loop_model.h"
#include "report/table_loop/claim_members.h"
#include "report/table_loop/members.h"

/* Columns of an effect. */
static const fg_loop_candidate *candidate_of_claim(const fg_subject *claim) {
  return &((const fg_loop_claim *)claim->object)->candidate;
}

static bool find_claim_column(const fg_subject *claim, size_t i, fg_subject *element) {
  const fg_loop_candidate *candidate = candidate_of_claim(claim);
  const fg_loop_report *report = claim->whole;
  element->object = &report->problem->problem.coordinate[i ? candidate->b : candidate->a];
  return candidate->effect->accepts && i <= candidate->effect->pair;
}

static bool has_levels(const fg_subject *coordinate) {
  return ((const fg_loop_coordinate *)coordinate->object)->levels > 0;
}

static const char *level_at(const fg_subject *subject, size_t i) {
  const fg_loop_coordinate *at = subject->object;
  return i < at->levels ? at->level_name[i] : NULL;
}

static bool has_few_values(const fg_subject *coordinate) {
  const fg_loop_coordinate *at = coordinate->object;
  return !at->levels && at->distinct <= FG_LOOP_COLUMNS + 1;
}

static const double *list_values(const fg_subject *subject, double *buffer, size_t *count) {
  const fg_loop_coordinate *at = subject->object;
  (void)buffer;
  *count = at->distinct;
  return at->few;
}

static const fg_member column_rows[] = {
    {FG_TEXT("name", fg_loop_coordinate, name), .words = "column of the table"},
    {FG_NUMBER("low", fg_loop_coordinate, low), .options = FG_MEMBER_NEVER_NULL,
     .words = "lowest value, which scales the basis"},
    {FG_NUMBER("high", fg_loop_coordinate, high), .options = FG_MEMBER_NEVER_NULL,
     .words = "highest value"},
    {FG_NUMBER("kelvin_offset", fg_loop_coordinate, kelvin_offset), .options = FG_MEMBER_NEVER_NULL,
     .words = "from the column's temperature to kelvin; 0: no temperature"},
    {FG_COUNT("distinct", fg_loop_coordinate, distinct), .words = "different values"},
    {FG_TEXTS_BY("levels", level_at), .present = has_levels, .words = "of a column of words"},
    {FG_NUMBERS_BY("values", list_values), .options = FG_MEMBER_NEVER_NULL,
     .present = has_few_values, .words = "of a column of few different numbers"},
};
static const fg_members column_members = FG_MEMBERS(column_rows);

/* Effects. */
static const char *find_effect_id(const fg_subject *claim, char *buffer) {
  (void)buffer;
  return candidate_of_claim(claim)->effect->id;
}

static const double *list_coefficients(const fg_subject *subject, double *buffer, size_t *count) {
  const fg_loop_claim *claim = subject->object;
  (void)buffer;
  *count = claim->columns;
  return claim->coefficient;
}

static const double *list_shape(const fg_subject *subject, double *buffer, size_t *count) {
  const fg_loop_claim *claim = subject->object;
  (void)buffer;
  *count = claim->candidate.effect->shapes;
  return claim->shape;
}

static bool is_cycle(const fg_subject *subject) {
  return candidate_of_claim(subject)->effect->cycle;
}

static const double *list_orders(const fg_subject *subject, double *buffer, size_t *count) {
  const fg_loop_claim *claim = subject->object;
  for (size_t k = 0; k < claim->orders; k++)
    buffer[k] = (double)claim->order[k].order;
  *count = claim->orders;
  return buffer;
}

static const fg_member effect_rows[] = {
    {FG_TEXT_BY("id", find_effect_id), .options = FG_MEMBER_NEVER_NULL, .words = "effect"},
    {FG_TEXT("name", fg_loop_claim, name), .words = "effect with its columns"},
    {FG_LIST_BY("coordinates", find_claim_column, &column_members),
     .words = "columns that it acts on; none for an effect of single rows"},
    {FG_NUMBERS_BY("coefficients", list_coefficients), .options = FG_MEMBER_NEVER_NULL,
     .words = "of its basis"},
    {FG_NUMBERS_BY("shape", list_shape), .options = FG_MEMBER_NEVER_NULL,
     .words = "a period, a place, a length"},
    {FG_NUMBERS_BY("orders", list_orders), .present = is_cycle, .options = FG_MEMBER_NEVER_NULL,
     .words = "of a cycle: sine and cosine of each are its coefficients"},
    {FG_TEXT_BY("sentence", fg_loop_find_sentence), .options = FG_MEMBER_NEVER_NULL,
     .words = "effect on the response, with U (95 %)"},
    {FG_NUMBER_U("amplitude", fg_loop_claim, amplitude, amplitude_u),
     .words = "half its range over the rows"},
};
static const fg_members effect_members = FG_MEMBERS(effect_rows);

static fg_subject find_curve(const fg_subject *subject) {
  const fg_loop_report *report = subject->whole;
  const fg_loop_result *result = report->result;
  return (fg_subject){.object = result->has_curve ? &result->curve : NULL};
}

static const fg_member curve_rows[] = {
    {FG_TEXT("coordinate", fg_loop_curve, name), .words = "column"},
    {FG_NUMBER("freedom", fg_loop_curve, dof), .words = "effective degrees of freedom"},
    {FG_LIST("shape", fg_loop_curve, shape, count, &fg_loop_point_members),
     .words = "coordinate and value, straight between them"},
};
static const fg_members curve_members = FG_MEMBERS(curve_rows);

/* The file. */
static const fg_member found_rows[] = {
    {FG_STRING("path", fg_loop_report, path), .options = FG_MEMBER_NEVER_NULL},
    {FG_STRING("sha256", fg_loop_report, sha256), .options = FG_MEMBER_NEVER_NULL},
};
static const fg_members found_members = FG_MEMBERS(found_rows);

static const fg_member model_spec_rows[] = {
    {FG_STRING("response", fg_loop_table_spec, response), .options = FG_MEMBER_NEVER_NULL,
     .words = "column that the effects are subtracted from"},
    {FG_STRING("model", fg_loop_table_spec, model), .options = FG_MEMBER_NEVER_NULL,
     .words = "formula, or arc_length"},
    {FG_STRING("group", fg_loop_table_spec, group), .words = "column; null: each row is its own"},
};
static const fg_members model_spec_members = FG_MEMBERS(model_spec_rows);

static const fg_member model_result_rows[] = {
    {FG_NUMBER("noise_sd", fg_loop_result, noise.sd), .words = "of one row"},
    {FG_ARRAY("claims", fg_loop_result, claim, claims, &effect_members), .lowest = 0,
     .highest = FG_LOOP_CLAIMS, .words = "effects to subtract"},
};
static const fg_members model_result_members = FG_MEMBERS(model_result_rows);

static const fg_member model_rows[] = {
    {FG_HEAD("foilgauge/loop-model/1")},
    {FG_GROUP("found_in", &found_members), .words = "the table"},
    {FG_POINTED("declared", fg_loop_report, spec, &model_spec_members),
     .options = FG_MEMBER_NEVER_NULL, .words = "the declared model"},
    {FG_LIST_BY("parameters", fg_loop_find_parameter, &fg_loop_parameter_members),
     .words = "of the declared model"},
    {FG_SAME(&model_result_members), .offset = offsetof(fg_loop_report, result), .pointed = true},
    {FG_PART("unattributed", find_curve, &curve_members),
     .words = "curve that no listed effect explains, subtracted as well; null: none"},
};
static const fg_members model_members = FG_MEMBERS(model_rows);

const fg_document fg_loop_model_document = {
    .file = "loop_model",
    .title = "foilgauge model of a loop on tables",
    .description = "null is a value that is not known.",
    .made_by = "`foilgauge loop --model-out`",
    .members = &model_members,
};

fg_status fg_loop_write_model(fg_context *ctx, const fg_loop_report *report, FILE *out) {
  fg_document_json(out, &model_members, report);
  return fg_stream_finish(ctx, out, "the model");
}
