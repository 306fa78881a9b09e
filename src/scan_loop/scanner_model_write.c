/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writer of a scanner's model file, "foilgauge/scan-model/1" (reports/schema); the reader is
 * scanner_model_file.c. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/date.h"
#include "core/file.h"
#include "core/memory.h"
#include "core/text.h"
#include "scan_loop/scanner_model.h"
#include "scan_loop/state.h"

/* ---- the model of a loop ---- */

/* Returns the number of known diameters that determined the absolute scale; 0 where they could not
 * have detected an error of it. */
static size_t known_diameters(const fg_scan_loop *loop) {
  if (fg_effect_set_scales(&loop->set) || loop->u_scale > 0) return loop->edge_fit.known_count;
  for (size_t i = 0; i < loop->result.unclaimeds; i++)
    if (fg_effect_find(loop->result.unclaimed[i].id)->scales &&
        loop->result.unclaimed[i].verdict == FG_LOOP_ABSENT)
      return loop->edge_fit.known_count;
  return 0;
}

static const fg_effect *find_common_scale(void) {
  const fg_effect *effect = fg_effect_first();
  while (effect && !effect->scales)
    effect = fg_effect_next(effect);
  return effect;
}

/* A scale that known diameters do not show is 0, and as uncertain as they leave it. */
static void add_uncertain_scale(double u_scale, fg_field_list *fields) {
  const fg_effect *scale = find_common_scale();
  if (!(u_scale > 0) || !scale || fields->count == FG_FIELDS_MAX) return;
  fg_field field = fg_effect_field(scale);
  field.u_amplitude_mm[0] = u_scale * FG_FIELD_HALF_MM;
  fields->fields[fields->count++] = field;
}

void fg_scanner_model_set_temperature(const fg_calibration *calibration, fg_scanner_model *model) {
  bool known = calibration->stated && calibration->has_temperature;
  model->temperature_c = known ? calibration->temperature_c : NAN;
  model->u_temperature_k = known ? calibration->u_temperature_k : NAN;
}

static bool holds_all_of_part(const fg_effect_set *set, const fg_effect_set *of) {
  for (size_t i = 0; i < of->count; i++) {
    bool held = !of->effects[i].kind->midline;
    for (size_t k = 0; !held && k < set->count; k++)
      held = set->effects[k].kind == of->effects[i].kind;
    if (!held) return false;
  }
  return true;
}

/* Returns true where tied explanations share their effects of the part. Probabilities cannot tell
 * the scanner from a foil: such a tie keeps its whole range. */
static bool has_probabilities(const fg_scan_loop *loop) {
  bool shared = loop->by_evidence;
  for (size_t k = 0; !loop->edge_fit.discs && k < loop->tie_count; k++)
    shared = shared && holds_all_of_part(&loop->set, &loop->tie[k]) &&
             holds_all_of_part(&loop->tie[k], &loop->set);
  return shared;
}

/* Takes the explanations tied with that of the model, with their probabilities where evidence gives
 * them. */
static void take_ties(const fg_scan_loop *loop, fg_scanner_model *made) {
  double sum = made->weight[0] = exp(-0.5 * fg_scan_loop_excess_over_best(&loop->explanations, 0));
  for (size_t k = 0; k < loop->tie_count; k++) {
    if (loop->tie_excess[k] > FG_UNLIKELY_CHI2) continue;
    fg_effect_set_fields(&loop->edge_fit, &loop->tie[k], &made->other[made->others++]);
    made->weight[made->others] = exp(-0.5 * loop->tie_excess[k]);
    sum += made->weight[made->others];
  }
  made->tied = made->others > 0;
  if (!has_probabilities(loop)) return;
  made->weights = made->others + 1;
  for (size_t k = 0; k < made->weights; k++)
    made->weight[k] /= sum;
}

static fg_status copy_numbers(fg_context *ctx, const double *from, size_t count, double **to) {
  FG_TRY(fg_memory_allocate(ctx, count, sizeof **to, (void **)to));
  memcpy(*to, from, count * sizeof **to);
  return FG_OK;
}

static fg_status copy_map(fg_context *ctx, const fg_field_map *from, fg_field_map *to) {
  size_t numbers = 2 * fg_map_splines(&from->frame);
  to->frame = from->frame;
  FG_TRY(copy_numbers(ctx, from->mm, numbers, &to->mm));
  for (; to->mode_count < from->mode_count; to->mode_count++)
    FG_TRY(copy_numbers(ctx, from->modes[to->mode_count], numbers, &to->modes[to->mode_count]));
  return FG_OK;
}

/* A map stands for all fields of the set, and for the explanations tied with it. */
static fg_status take_map(fg_context *ctx, const fg_scan_loop *loop, fg_scanner_model *made) {
  fg_effect_set none = {.count = 0};
  FG_TRY(copy_map(ctx, &loop->map, &made->map));
  fg_effect_set_fields(&loop->edge_fit, &none, &made->fields);
  made->fields.map = &made->map.frame;
  made->fields.map_mm = made->map.mm;
  return FG_OK;
}

/* Returns true where the scanner does something without a name. What the edges do by their
 * direction moves no place of the glass. */
static bool is_nameless(const fg_scan_loop *loop) {
  bool nameless = false;
  for (size_t e = 0; e < loop->set.count; e++) {
    const fg_effect *kind = loop->set.effects[e].kind;
    nameless = nameless || (fg_effect_is_free(kind) && kind->glass);
  }
  return nameless && loop->map.mm;
}

static void take_fields(const fg_scan_loop *loop, fg_scanner_model *made) {
  fg_effect_set_fields(&loop->edge_fit, &loop->set, &made->fields);
  take_ties(loop, made);
}

fg_status fg_scanner_model_of(fg_context *ctx, const fg_scan_loop *loop, fg_scanner_model **model) {
  fg_scanner_model *made = NULL;
  fg_status status = FG_OK;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *made, (void **)&made));
  if (loop->options.scanner)
    fg_text_clip(made->scanner, sizeof made->scanner, "%s", loop->options.scanner);
  fg_date_format_utc(loop->options.date, made->date);
  const fg_measurement *first = &loop->before[0];
  for (int axis = 0; axis < 2; axis++) /* resolution stated by the scan */
    made->dpi[axis] = first->dpi[axis] * fg_calibration_factor(&first->design.calibration);
  made->scans = loop->scan_count;
  made->known_diameters = known_diameters(loop);
  made->artefact = first->design.artefact;
  fg_scanner_model_set_temperature(&first->design.calibration, made);
  made->tone = loop->tone;
  if (is_nameless(loop))
    status = take_map(ctx, loop, made);
  else
    take_fields(loop, made);
  add_uncertain_scale(loop->u_scale, &made->fields);
  *model = made;
  return status;
}

/* ---- the file ---- */

/* Whole of every subject: a model, and the scans that it is of. */
typedef struct made_model {
  const fg_scanner_model *model;
  const fg_scanner_model_input *inputs;
  size_t input_count;
} made_model;

/* A file of people may lack the member. */
static bool is_in_every_model(const fg_subject *s) {
  (void)s;
  return true;
}

static const fg_member field_rows[] = {
    {FG_STRING("id", fg_field, id), .options = FG_MEMBER_NEVER_NULL, .words = "of the effect"},
    {FG_NUMBERS_OF("amplitude_mm", fg_field, amplitude_mm, columns),
     .schema = "{\"type\": \"array\", \"items\": {\"type\": \"number\", \"minimum\": -1, "
               "\"maximum\": 1}}",
     .words = "displacement 18 mm from the middle of the scan"},
    {FG_NUMBERS_OF("u_amplitude_mm", fg_field, u_amplitude_mm, columns),
     .schema = "{\"type\": \"array\", \"items\": {\"type\": \"number\", \"minimum\": 0, "
               "\"maximum\": 1}}",
     .words = "its standard uncertainty"},
    {FG_NUMBERS_OF("shape", fg_field, shape, shapes), .options = FG_MEMBER_NEVER_NULL,
     .words = "numbers that enter without being an amplitude: a period, a place"},
    {FG_NUMBERS_OF("u_shape", fg_field, u_shape, shapes),
     .schema = "{\"type\": \"array\", \"items\": {\"type\": [\"number\", \"null\"], \"minimum\": "
               "0}}",
     .words = "their standard uncertainties; null: the place was not refined"},
};
static const fg_members field_members = FG_MEMBERS_DEFINED(field_rows, "field");

static const fg_member other_rows[] = {
    {FG_ARRAY(NULL, fg_field_list, fields, count, &field_members), .highest = FG_FIELDS_MAX}};
static const fg_members other_members = FG_MEMBERS(other_rows);

static const fg_member input_rows[] = {
    {FG_STRING("path", fg_scanner_model_input, path), .options = FG_MEMBER_NEVER_NULL},
    {FG_STRING("sha256", fg_scanner_model_input, sha256), .options = FG_MEMBER_NEVER_NULL,
     .pattern = "^[0-9a-f]{64}$"},
    {FG_FLAG("hold_out", fg_scanner_model_input, hold_out), .words = "the scan only confirms"},
};
static const fg_members input_members = FG_MEMBERS(input_rows);

static bool find_model_input(const fg_subject *list, size_t i, fg_subject *element) {
  const made_model *made = list->whole;
  element->object = &made->inputs[i];
  return i < made->input_count;
}

static const double *list_map_numbers(const fg_subject *s, double *numbers, size_t *count) {
  const fg_scanner_model *model = ((const made_model *)s->whole)->model;
  (void)numbers;
  *count = 2 * fg_map_splines(&model->map.frame);
  return s->index ? model->map.modes[s->index - 1] : model->map.mm;
}

static const fg_member mode_rows[] = {
    {FG_NUMBERS_BY("d_mm", list_map_numbers), .options = FG_MEMBER_NEVER_NULL,
     .schema = "{\"type\": \"array\", \"items\": {\"type\": \"number\"}}",
     .words = "as the map's"}};
static const fg_members mode_members = FG_MEMBERS(mode_rows);

/* Index 0 is the map itself. */
static bool find_map_mode(const fg_subject *list, size_t i, fg_subject *element) {
  const made_model *made = list->whole;
  *element = (fg_subject){made->model, made, i + 1};
  return i < made->model->map.mode_count;
}

static const fg_member map_rows[] = {
    {FG_COUNT("columns", fg_scanner_model, map.frame.side[0]), .lowest = FG_MAP_SIDE_MIN,
     .highest = FG_MAP_SIDE_MAX, .words = "cubic B-splines along x, evenly over region_mm"},
    {FG_COUNT("rows", fg_scanner_model, map.frame.side[1]), .lowest = FG_MAP_SIDE_MIN,
     .highest = FG_MAP_SIDE_MAX, .words = "along y"},
    {FG_NUMBERS_BY("d_mm", list_map_numbers), .options = FG_MEMBER_NEVER_NULL,
     .schema = "{\"type\": \"array\", \"items\": {\"type\": \"number\"}}",
     .words = "displacement along x of every spline, row by row, then along y"},
    {FG_LIST_BY("modes", find_map_mode, &mode_members), .options = FG_MEMBER_LIST_ON_LINE,
     .highest = FG_MAP_MODES_MAX,
     .words = "displacements that are independent of each other, each of one standard "
              "uncertainty: those of the map and of the effects without u_amplitude_mm"},
};
static const fg_members map_members = FG_MEMBERS(map_rows);

static fg_subject find_map_of_model(const fg_subject *s) {
  const fg_scanner_model *model = s->object;
  return (fg_subject){model->fields.map ? model : NULL, s->whole, 0};
}

static const double *list_corners(const double first[2], const double opposite[2], double *numbers,
                                  size_t *count) {
  memcpy(numbers, first, 2 * sizeof *numbers);
  memcpy(numbers + 2, opposite, 2 * sizeof *numbers);
  *count = 4;
  return numbers;
}

static const double *list_region(const fg_subject *s, double *numbers, size_t *count) {
  const fg_field_frame *frame = &((const fg_scanner_model *)s->object)->fields.frame;
  return list_corners(frame->low_mm, frame->high_mm, numbers, count);
}

static const double *list_curve_region(const fg_subject *s, double *numbers, size_t *count) {
  const fg_field_frame *frame = &((const fg_scanner_model *)s->object)->fields.frame;
  return list_corners(frame->first_mm, frame->last_mm, numbers, count);
}

static bool has_weights(const fg_subject *s) {
  return ((const fg_scanner_model *)s->object)->weights > 0;
}

static bool has_artefact(const fg_subject *s) {
  return ((const fg_scanner_model *)s->object)->artefact.name[0];
}

#define UNLESS_EMPTY .options = FG_MEMBER_LEFT_OUT | FG_MEMBER_EMPTY_IS_NULL
static const fg_member artefact_rows[] = {
    {FG_TEXT("name", fg_artefact, name), .options = FG_MEMBER_NEVER_NULL, .words = "as marked"},
    {FG_TEXT("certificate", fg_artefact, certificate), UNLESS_EMPTY, .words = "its number"},
    {FG_TEXT("date", fg_artefact, date), UNLESS_EMPTY, .words = "of the certificate"},
    {FG_TEXT("due", fg_artefact, due), UNLESS_EMPTY,
     .words = "the last day that it holds: younger scans are refused"},
};
#undef UNLESS_EMPTY
static const fg_members artefact_members = FG_MEMBERS(artefact_rows);

static const char *const model_level_words[] = {"points", NULL};

static int find_model_level(const fg_subject *s) {
  (void)s;
  return 0;
}

static fg_subject find_model_tone(const fg_subject *s) {
  const fg_model_tone *tone = &((const fg_scanner_model *)s->object)->tone;
  return (fg_subject){tone->gauges ? tone : NULL, s->whole, 0};
}

static const fg_member model_rows[] = {
    {FG_HEAD("foilgauge/scan-model/1")},
    {FG_TEXT("scanner", fg_scanner_model, scanner), .options = FG_MEMBER_EMPTY_IS_NULL,
     .schema = "{\"type\": [\"string\", \"null\"], \"maxLength\": 127}",
     .words = "as given with --scanner"},
    {FG_TEXT("date", fg_scanner_model, date), .options = FG_MEMBER_EMPTY_IS_NULL,
     .schema = "{\"type\": [\"string\", \"null\"], \"maxLength\": 31}",
     .present = is_in_every_model,
     .words = "of the newest scan that it was found on, UTC (SOURCE_DATE_EPOCH, where it is set); "
              "null: not known"},
    {FG_WORD_BY("level", find_model_level, model_level_words), .options = FG_MEMBER_NEVER_NULL,
     .words = "of the effects: rows of the edges"},
    {FG_NUMBERS("dpi", fg_scanner_model, dpi),
     .schema = "{\"type\": \"array\", \"items\": {\"type\": \"number\", \"minimum\": 1, "
               "\"maximum\": 1000000}, \"minItems\": 2, \"maxItems\": 2}",
     .words = "x, y; scans of another resolution are refused"},
    {FG_NUMBERS_BY("region_mm", list_region), .lowest = 4, .highest = 4,
     .options = FG_MEMBER_NEVER_NULL, .words = "x, y of one corner and of the opposite one"},
    {FG_NUMBERS_BY("curve_mm", list_curve_region), .lowest = 4, .highest = 4,
     .options = FG_MEMBER_NEVER_NULL, .present = is_in_every_model,
     .words = "likewise, where edges were measured: the knots of free curves lie there; absent: "
              "region_mm"},
    {FG_COUNT("curve_knots", fg_scanner_model, fields.frame.knots), .lowest = 4,
     .highest = FG_FIELD_COLUMNS, .present = is_in_every_model,
     .words = "of free curves; absent: 24"},
    {FG_LIST_BY("inputs", find_model_input, &input_members), .lowest = 1,
     .words = "scans that it was found on"},
    {FG_COUNT("known_grids", fg_scanner_model, known_grids), .highest = 1000000,
     .present = is_in_every_model,
     .words = "scans of grids of known pitch that hold its absolute scale; absent: 0"},
    {FG_COUNT("known_diameters", fg_scanner_model, known_diameters), .highest = 1000000,
     .present = is_in_every_model,
     .words = "gauges of known diameter that hold its absolute scale; absent or 0: an error of "
              "scale equal in x and y is not corrected"},
    {FG_OBJECT("artefact", fg_scanner_model, artefact, &artefact_members), .present = has_artefact,
     .words = "the plate that these gauges are of, by the design's `artefact`; absent: not stated"},
    {FG_NUMBER("temperature_C", fg_scanner_model, temperature_c), .options = FG_MEMBER_LEFT_OUT,
     .words = "of the plate while it was scanned, by the design's calibration, and so of the "
              "scanner; absent: not stated"},
    {FG_NUMBER("u_temperature_K", fg_scanner_model, u_temperature_k), .options = FG_MEMBER_LEFT_OUT,
     .words = "its standard uncertainty"},
    {FG_PART("tone", find_model_tone, &fg_model_tone_members), .present = is_in_every_model,
     .words = "level of the scanner's edges, from discs of known diameter; null or absent: not "
              "known"},
    {FG_PART("map", find_map_of_model, &map_members), .present = is_in_every_model,
     .words =
         "smooth displacement beside the effects, from scans of grids, or of discs whose cause has "
         "no name; null or "
         "absent: none"},
    {FG_FLAG("tied", fg_scanner_model, tied), .words = "other explanations did as well"},
    {FG_ARRAY("fields", fg_scanner_model, fields.fields, fields.count, &field_members),
     .highest = FG_FIELDS_MAX,
     .words = "displacements by the scanner; an effect may stand there more than once; together "
              "they bend the region by a tenth at most"},
    {FG_ARRAY("alternatives", fg_scanner_model, other, others, &other_members),
     .highest = FG_EXPLANATIONS_MAX, .words = "corrections by the other explanations"},
    {FG_NUMBERS_OF("weights", fg_scanner_model, weight, weights),
     .schema = "{\"type\": \"array\", \"items\": {\"type\": \"number\", \"minimum\": 0, "
               "\"maximum\": 1}}",
     .present = has_weights,
     .words = "probabilities of `fields` and of every alternative, by evidence, sum 1; absent: not "
              "known, and taken as equal"},
};
static const fg_members model_members = FG_MEMBERS(model_rows);

/* A model that is read corrects as the loop did: its numbers lose no digit. */
static const fg_member file_rows[] = {{FG_SAME(&model_members), .options = FG_MEMBER_EXACT,
                                       .offset = offsetof(made_model, model), .pointed = true}};
static const fg_members file_members = FG_MEMBERS(file_rows);

const fg_document fg_scanner_model_document = {
    .file = "scan_model",
    .title = "a scanner's model (\"schema\": \"foilgauge/scan-model/1\")",
    .description =
        "Written by `foilgauge loop SCAN --model-out F`, applied by `measure --model F` and "
        "`lot --model F`.",
    .made_by = "`foilgauge loop SCAN --model-out`",
    .members = &file_members,
};

/* Refuses a model that the reader would refuse. */
static fg_status check_readable(fg_context *ctx, const fg_scanner_model *model) {
  fg_context inner = {.message = ""};
  fg_status status = fg_scanner_model_check_place(&inner, model->dpi, &model->fields.frame);
  if (status == FG_OK) status = fg_scanner_model_check_fields(&inner, "fields", &model->fields);
  for (size_t k = 0; k < model->others && status == FG_OK; k++)
    status = fg_scanner_model_check_fields(&inner, "alternatives", &model->other[k]);
  if (status == FG_OK) return FG_OK;
  return fg_fail(ctx, status, "what was found is no model of a scanner, and is not written: %.600s",
                 inner.message);
}

fg_status fg_scanner_model_check_picture(fg_context *ctx, const fg_measurement *m) {
  const fg_picture_words *words = fg_picture_spoils_model(m->picture.findings);
  if (!words) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "no model is written: %.120s: %s: %s A model of it would carry that to every "
                 "scan. %s",
                 m->scan, words->name, words->meaning, words->cure);
}

fg_status fg_scanner_model_write(fg_context *ctx, const fg_scanner_model *model,
                                 const fg_scanner_model_input *inputs, size_t count, FILE *out) {
  const made_model made = {model, inputs, count};
  FG_TRY(check_readable(ctx, model));
  fg_document_json(out, &file_members, &made);
  return fg_stream_finish(ctx, out, "the model");
}

fg_status fg_scan_loop_write_model(fg_context *ctx, const fg_scan_loop *loop, FILE *out) {
  fg_scanner_model_input *inputs;
  FG_TRY(fg_memory_allocate(ctx, loop->scan_count, sizeof *inputs, (void **)&inputs));
  fg_status status = FG_OK;
  for (size_t i = 0; i < loop->scan_count; i++) {
    inputs[i] =
        (fg_scanner_model_input){loop->before[i].scan, loop->before[i].sha256, loop->hold_out[i]};
    FG_TRY_EXIT(fg_scanner_model_check_picture(ctx, &loop->before[i]));
  }
  status = fg_scanner_model_write(ctx, loop->result.model, inputs, loop->scan_count, out);
exit:
  free(inputs);
  return status;
}
