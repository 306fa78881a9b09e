/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lot/input/recipe_members.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "foilgauge/control.h"
#include "foilgauge/stiffness.h"
#include "lot/input/recipe_dies.h"
#include "lot/input/reference_curve.h"
#include "report/design/members.h"

/* Largest whole number that a double holds exactly. */
#define SEED_MAX 9007199254740992.0

static const fg_recipe_text *text_of(const fg_subject *subject) {
  return subject->whole;
}

/* A recipe is silent about a model, dies and loss that its lot does not have. */
static bool is_with_jobs(const fg_subject *subject) {
  return text_of(subject)->with_jobs;
}

static bool has_model(const fg_subject *subject) {
  return is_with_jobs(subject) || text_of(subject)->settings.model[0];
}

static bool has_model_sum(const fg_subject *subject) {
  return is_with_jobs(subject) || text_of(subject)->settings.model_sha256[0];
}

static bool has_loss(const fg_subject *subject) {
  return is_with_jobs(subject) || text_of(subject)->settings.allow_lossy;
}

static bool has_dies(const fg_subject *subject) {
  return is_with_jobs(subject) || text_of(subject)->settings.die_count;
}

static bool has_curve(const fg_subject *subject) {
  return text_of(subject)->settings.curve.count > 0;
}

static bool is_elsewhere(const fg_subject *subject) {
  (void)subject;
  return false;
}

/* A calibration of the recipe; else the design's says the same. */
static fg_subject find_calibration(const fg_subject *subject) {
  const fg_calibration *calibration = &text_of(subject)->settings.calibration;
  return (fg_subject){.object =
                          calibration->stated || calibration->not_needed[0] ? calibration : NULL};
}

static void write_recipe_calibration(fg_json *json, const char *name, const fg_subject *subject) {
  const fg_calibration *calibration = find_calibration(subject).object;
  if (calibration)
    fg_calibration_write(json, name, calibration);
  else
    fg_json_string(json, name, NULL);
}

static const char *bandwidth_choice(size_t i) {
  return i <= FG_BANDWIDTH_SHEATHER_JONES ? fg_bandwidth_word((fg_bandwidth_rule)i) : NULL;
}

static void write_run_rules(fg_json *json, const char *name, const fg_subject *subject) {
  fg_json_array(json, name);
  fg_json_line(json);
  for (unsigned rule = 1; rule <= FG_RUN_RULES; rule++)
    if (text_of(subject)->settings.run_rules & (1u << (rule - 1)))
      fg_json_integer(json, NULL, rule);
  fg_json_array_end(json);
  fg_json_line_end(json);
}

static fg_status read_run_rules(const fg_reading *reading, const fg_member *member,
                                const cJSON *value, void *object) {
  fg_lot_settings *settings = object;
  const cJSON *number;
  settings->run_rules = 0;
  if (!cJSON_IsArray(value))
    return fg_reading_fail(reading, member->name, "must be a list of numbers, as in [1, 2, 3, 4]");
  cJSON_ArrayForEach(number, value) {
    double rule = cJSON_IsNumber(number) ? number->valuedouble : NAN;
    if (!(rule >= 1 && rule <= FG_RUN_RULES && rule == floor(rule)))
      return fg_reading_fail(reading, member->name, "is %g; it must be a whole number from 1 to %d",
                             rule, FG_RUN_RULES);
    settings->run_rules |= 1u << ((unsigned)rule - 1);
  }
  return FG_OK;
}

/* Reads "design": an object, or the path of a file beside the recipe. */
static fg_status read_recipe_design(const fg_reading *reading, const fg_member *member,
                                    const cJSON *value, void *object) {
  fg_design *design = &((fg_lot_settings *)object)->design;
  if (cJSON_IsString(value)) {
    char file[4096];
    fg_file_find_beside(reading->user, value->valuestring, file, sizeof file);
    return fg_design_load(reading->ctx, file, design);
  }
  if (!cJSON_IsObject(value))
    return fg_reading_fail(reading, member->name, "must be an object or the path of a design file");
  char *text = cJSON_Print(value);
  if (!text) return fg_fail(reading->ctx, FG_ERR_MEMORY, "out of memory: the design of a recipe");
  fg_status status = fg_design_parse(reading->ctx, member->name, text, design);
  free(text);
  return status;
}

static fg_status read_recipe_calibration(const fg_reading *reading, const fg_member *member,
                                         const cJSON *value, void *object) {
  return fg_calibration_read(reading, member, value, &((fg_lot_settings *)object)->calibration);
}

/* The station reads its settings itself. */
static fg_status skip_member(const fg_reading *reading, const fg_member *member, const cJSON *value,
                             void *object) {
  (void)reading, (void)member, (void)value, (void)object;
  return FG_OK;
}

/* A hundred thousand draws take seconds and give shares to 0.3 %. */
static const fg_member assembly_rows[] = {
    {FG_COUNT("bearings", fg_lot_settings, assembly.bearings), .lowest = 0, .highest = 100000,
     .words = "Drawn from the foils, to see how many would assemble; 0 draws none."},
    {FG_SEED("seed", fg_lot_settings, assembly.seed), .lowest = 0, .highest = SEED_MAX,
     .words = "Of the draws."},
    {FG_NUMBER("design_deviation_pct", fg_lot_settings, assembly.design_deviation_pct), .lowest = 0,
     .highest = 100,
     .words = "Clearances within this of the design: of the bearings of the design that are shown "
              "beside them."},
};
static const fg_members assembly_members = FG_MEMBERS(assembly_rows);

static bool has_film(const fg_subject *subject) {
  return is_with_jobs(subject) || text_of(subject)->settings.film.load_n > 0;
}

static const fg_member film_rows[] = {
    {FG_NUMBER("load_n", fg_lot_settings, film.load_n), .lowest = 0, .highest = 1e7,
     .words = "Force on the rotor, on one bearing; 0: no film is asked for."},
    {FG_NUMBER("load_deg", fg_lot_settings, film.load_deg), .lowest = -720, .highest = 720,
     .words = "Its direction, from the first bump of pad 1 in the sense of rotation."},
    {FG_NUMBER("speed_rpm", fg_lot_settings, film.speed_rpm), .lowest = 0, .highest = 1e8,
     .words = "Of the rotor; needed with a load."},
    {FG_NUMBER("rotor_mass_kg", fg_lot_settings, film.rotor_mass_kg), .lowest = 0, .highest = 1e6,
     .words = "On this bearing; 0: the load's, by gravity."},
    {FG_NUMBER("loss_factor", fg_lot_settings, film.loss_factor), .lowest = 0, .highest = 10,
     .words = "Of the bumps, as `foilgauge stiffness` measures it."},
    {FG_NUMBER("within_pct", fg_lot_settings, film.within_pct), .lowest = 0.1, .highest = 100,
     .words = "Change of the threshold speed that a tolerance on the clearance is told for."},
    {FG_COUNT("bearings", fg_lot_settings, film.bearings), .lowest = 1, .highest = 100000,
     .words = "Drawn from the lot's foils, as `assembly` draws them."},
    {FG_SEED("seed", fg_lot_settings, film.seed), .lowest = 0, .highest = SEED_MAX,
     .words = "Of the draws."},
    {FG_COUNT("cells_per_bump", fg_lot_settings, film.cells_per_bump), .lowest = 2, .highest = 64,
     .words = "Of the film's mesh, an even number."},
    {FG_COUNT("cells_axial", fg_lot_settings, film.cells_axial), .lowest = 2, .highest = 64,
     .words = "Of the mesh, over half the length."},
};
static const fg_members film_members = FG_MEMBERS(film_rows);

#define OPEN .options = FG_MEMBER_EMPTY_IS_NULL /* null, kept as 0: the design decides */
static const fg_member recipe_rows[] = {
    {FG_HEAD("foilgauge/recipe/1")},
    {FG_TEXT("name", fg_lot_settings, name),
     .words = "Of the lot, as its reports show it; empty: its folder's name."},
    {FG_TEXT("model", fg_lot_settings, model), .options = FG_MEMBER_ANY_TEXT, .present = has_model,
     .words = "The scanner's model that corrects every scan (what `foilgauge loop --model-out` "
              "wrote): a path, beside the recipe."},
    {FG_TEXT("model_sha256", fg_lot_settings, model_sha256), .present = has_model_sum,
     .words = "Its SHA-256, written into the recipe of a finished lot; a model that has changed "
              "since is refused."},
    {FG_NUMBER("dpi", fg_lot_settings, dpi), .lowest = 0, .highest = 1e6,
     .words = "Resolution of the scans; 0: as the files say."},
    {FG_FLAG("allow_lossy", fg_lot_settings, allow_lossy), .present = has_loss,
     .words = "true: take scans that JPEG has compressed with loss, with the wider uncertainties "
              "that belong to them; false: they are not measured."},
    {FG_UNSIGNED("jobs", fg_lot_settings, jobs), .lowest = 0, .highest = 1024,
     .present = is_with_jobs, .words = "Scans at a time; 0: one per core. Changes no result."},
    {FG_NUMBER("trim_pct", fg_lot_settings, trim_pct), .lowest = 0, .highest = 49,
     .words = "Cut off each tail before the errors of radius and angle are correlated."},
    {FG_NUMBER("confidence", fg_lot_settings, confidence), .lowest = 0.5, .highest = 0.9999,
     .words = "Of every interval."},
    {FG_WORD("bandwidth", fg_lot_settings, bandwidth, NULL), .choice_at = bandwidth_choice,
     .words = "Of the kernel density: \"silverman\", \"scott\" or \"sheather_jones\"."},
    {FG_COUNT("resamples", fg_lot_settings, resamples), .lowest = 0, .highest = 1e7,
     .words = "Values drawn from the kernel density."},
    {FG_SEED("seed", fg_lot_settings, seed), .lowest = 0, .highest = SEED_MAX,
     .words = "Of all that is drawn at random."},
    {FG_WRITTEN("run_rules", write_run_rules,
                "{\"type\": \"array\", \"items\": {\"type\": \"integer\", \"minimum\": 1, "
                "\"maximum\": 8}}"),
     .read = read_run_rules,
     .words = "Which run rules of the control charts are looked at, as in [1, 2, 3, 4]; below. "
              "Default: [1, 2, 3, 4]."},
    {FG_TEXT("group_column", fg_lot_settings, group_column),
     .words = "Groups of this column of the manifest are compared (die, coil ...)."},
    {FG_TEXT("part_column", fg_lot_settings, part_column),
     .words = "Of a gauge study: the column that says which part was scanned again."},
    {FG_TEXT("operator_column", fg_lot_settings, operator_column),
     .words = "Of a gauge study: who or what measured it."},
    {FG_TEXT("bearing_column", fg_lot_settings, bearing_column),
     .words = "Which bearing a foil goes into; without the column, foils in a row make one."},
    {FG_TEXT("pad_column", fg_lot_settings, pad_column),
     .words = "Which of its pads a foil is, from 1."},
    {FG_TEXT("die_column", fg_lot_settings, die_column), .present = has_dies,
     .words = "Which of the `dies` a foil was pressed in."},
    {FG_COUNT("pads", fg_lot_settings, layout.pads), OPEN, .lowest = 1,
     .highest = FG_BEARING_BUMPS_MAX, .words = "Pads of a bearing; null: as many as fit around."},
    {FG_COUNT("bumps_per_pad", fg_lot_settings, layout.bumps_per_pad), OPEN, .lowest = 1,
     .highest = FG_BEARING_BUMPS_MAX, .words = "null: the design's number of bumps."},
    {FG_COUNT("first_bump", fg_lot_settings, layout.first_bump), .lowest = 1, .highest = 1000,
     .words = "Number of a pad's first bump that counts."},
    {FG_NUMBER("bump_pitch_deg", fg_lot_settings, layout.pitch_deg), OPEN, .lowest = 0.1,
     .highest = 360,
     .words = "From bump to bump about the bearing's axis; null: the design's, or equally spaced "
              "where `pads` and `bumps_per_pad` are stated."},
    {FG_NUMBER("youngs_modulus_gpa", fg_lot_settings, material.youngs_modulus_gpa), .lowest = 1e-3,
     .highest = 1e4, .words = "Of the strip, for the stiffness of bumps."},
    {FG_NUMBER("poisson_ratio", fg_lot_settings, material.poisson_ratio), .lowest = 0,
     .highest = 0.499, .words = "Likewise."},
    {FG_NUMBER("friction", fg_lot_settings, material.friction), .lowest = 0, .highest = 10,
     .words = "Coulomb's, of the bumps' feet."},
    {FG_MAP("dies", fg_lot_settings, dies, die_count, name, &fg_lot_die_members),
     .options = FG_MEMBER_EXACT | FG_MEMBER_LEFT_OUT, .read = fg_lot_dies_read,
     .schema = "{\"type\": \"object\", \"additionalProperties\": {\"type\": [\"string\", "
               "\"object\"]}}",
     .words = "An object of names and paths of the files that `foilgauge die -o` wrote, as in "
              "{\"A\": \"die_a.json\"}: the reference of springback of foils whose `die_column` "
              "names the die. A lot keeps their numbers."},
    {FG_OBJECT("reference_curve", fg_lot_settings, curve, &fg_reference_curve_members),
     .options = FG_MEMBER_EXACT, .present = has_curve, .read = fg_reference_curve_read,
     .schema = "{\"type\": [\"string\", \"object\"]}",
     .words = "The path of a CSV file beside the recipe, with the columns bump, radius_error_pct "
              "and intersection_angle_error_pct: drawn over the errors per bump. A lot keeps its "
              "points."},
    {FG_GROUP("assembly", &assembly_members), .options = FG_MEMBER_ON_LINE,
     .words = "Bearings drawn from the lot's foils."},
    {FG_GROUP("film", &film_members), .options = FG_MEMBER_ON_LINE, .present = has_film,
     .words = "The gas film of bearings drawn from the lot's foils, and the rotor's threshold "
              "speed, as `foilgauge film` finds them."},
    {FG_PART("calibration", find_calibration, &fg_calibration_members),
     .read = read_recipe_calibration, .write = write_recipe_calibration, .present = is_with_jobs,
     .schema =
         "{\"anyOf\": [" FG_REF("design.schema.json#/$defs/calibration") ", " FG_CALIBRATION_WORDS
                                                                         ", {\"type\": \"null\"}]}",
     .words = "As in `foilgauge-design`(5), over that of the recipe's design."},
    {FG_OBJECT("design", fg_lot_settings, design, &fg_design_members), .read = read_recipe_design,
     .schema = "{\"anyOf\": [" FG_REF("design.schema.json") ", {\"type\": \"string\"}]}",
     .words = "An object as in `foilgauge-design`(5), or the path of such a file beside the "
              "recipe."},
    {FG_WRITTEN("station", NULL, FG_REF("station_settings.schema.json")), .read = skip_member,
     .present = is_elsewhere,
     .words = "An object with the settings of `foilgauge-station`(1), below; a lot does not read "
              "it."},
};
const fg_members fg_recipe_members = FG_MEMBERS(recipe_rows);

static const void *find_usual_recipe(void) {
  static fg_recipe_text usual = {.with_jobs = true};
  fg_lot_settings_default(&usual.settings);
  return &usual;
}

const fg_document fg_recipe_document = {
    .file = "recipe",
    .title = "foilgauge recipe",
    .description = "Settings of a lot and of the inspection station. Members that are absent have "
                   "their defaults, which `foilgauge lot --print-recipe` writes.",
    .made_by = "`foilgauge lot --print-recipe`",
    .members = &fg_recipe_members,
    .is_read = true,
    .find_usual = find_usual_recipe,
};

void fg_lot_settings_default(fg_lot_settings *settings) {
  *settings = (fg_lot_settings){
      .trim_pct = 5,
      .confidence = 0.95,
      .bandwidth = FG_BANDWIDTH_SILVERMAN,
      .resamples = 100000,
      .seed = 1,
      .run_rules = 0xF,
      .part_column = "foil",
      .operator_column = "operator",
      .bearing_column = "bearing",
      .pad_column = "pad",
      .die_column = "die",
      .layout = {.first_bump = 1},
      .material = fg_arch_material_default(),
      /* Thesis chapter 5: ± 7 % of the clearance, 4.6 of 65.5 um. */
      .assembly = {.bearings = 1000, .seed = 1, .design_deviation_pct = 7},
      .film = {.load_deg = 270,
               .loss_factor = 0.14, /* thesis table 5.6 */
               .within_pct = 10,
               .bearings = 200,
               .seed = 1,
               .cells_per_bump = 6,
               .cells_axial = 8},
  };
  fg_design_default(&settings->design);
}
