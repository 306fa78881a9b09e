/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lot/input/recipe_members.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/text.h"
#include "foilgauge/control.h"
#include "foilgauge/stiffness.h"
#include "foilgauge/words.h"

#define AT(place) offsetof(fg_lot_settings, place)
#define TEXT(name, place, meaning)                                                                 \
  {                                                                                                \
    name, FG_RECIPE_WORDS, AT(place), sizeof(((fg_lot_settings *)0)->place), 0, 0, false, false,   \
        meaning                                                                                    \
  }

static const fg_recipe_member members[] = {
    TEXT("name", name, "Of the lot, as its reports show it; empty: its folder's name."),
    TEXT("model", model,
         "The scanner's model that corrects every scan (what `foilgauge loop --model-out` wrote): "
         "a path, beside the recipe."),
    TEXT("model_sha256", model_sha256,
         "Its SHA-256, written into the recipe of a finished lot; a model that has changed since "
         "is refused."),
    {"dpi", FG_RECIPE_REAL, AT(dpi), 0, 0, 1e6, false, false,
     "Resolution of the scans; 0: as the files say."},
    {"allow_lossy", FG_RECIPE_SWITCH, AT(allow_lossy), 0, 0, 0, false, false,
     "true: take scans that JPEG has compressed with loss, with the wider uncertainties that "
     "belong "
     "to them; false: they are not measured."},
    {"jobs", FG_RECIPE_UNSIGNED, AT(jobs), 0, 0, 1024, true, false,
     "Scans at a time; 0: one per core. Changes no result."},
    {"trim_pct", FG_RECIPE_REAL, AT(trim_pct), 0, 0, 49, false, false,
     "Cut off each tail before the errors of radius and angle are correlated."},
    {"confidence", FG_RECIPE_REAL, AT(confidence), 0, 0.5, 0.9999, false, false,
     "Of every interval."},
    {"bandwidth", FG_RECIPE_RULE, AT(bandwidth), 0, 0, 0, false, false,
     "Of the kernel density: \"silverman\", \"scott\" or \"sheather_jones\"."},
    {"resamples", FG_RECIPE_COUNT, AT(resamples), 0, 0, 1e7, false, false,
     "Values drawn from the kernel density."},
    {"seed", FG_RECIPE_SEED, AT(seed), 0, 0, 9007199254740992.0, false, false,
     "Of what is drawn at random."},
    {"run_rules", FG_RECIPE_RUN_RULES, AT(run_rules), 0, 1, FG_RUN_RULES, false, false,
     "Which run rules of the control charts are looked at, as in [1, 2, 3, 4]."},
    TEXT("group_column", group_column,
         "Groups of this column of the manifest are compared (die, coil ...)."),
    TEXT("part_column", part_column,
         "Of a gauge study: the column that says which part was scanned again."),
    TEXT("operator_column", operator_column, "Of a gauge study: who or what measured it."),
    TEXT("bearing_column", bearing_column,
         "Which bearing a foil goes into; without the column, foils in a row make one."),
    TEXT("pad_column", pad_column, "Which of its pads a foil is, from 1."),
    TEXT("die_column", die_column, "Which of the `dies` a foil was pressed in."),
    {"pads", FG_RECIPE_COUNT, AT(layout.pads), 0, 1, FG_BEARING_BUMPS_MAX, false, true,
     "Pads of a bearing; null: as many as fit around."},
    {"bumps_per_pad", FG_RECIPE_COUNT, AT(layout.bumps_per_pad), 0, 1, FG_BEARING_BUMPS_MAX, false,
     true, "null: the design's number of bumps."},
    {"first_bump", FG_RECIPE_COUNT, AT(layout.first_bump), 0, 1, 1000, false, false,
     "Number of a pad's first bump that counts."},
    {"bump_pitch_deg", FG_RECIPE_REAL, AT(layout.pitch_deg), 0, 0.1, 360, false, true,
     "From bump to bump about the bearing's axis; null: the design's, or equally spaced where "
     "`pads` and `bumps_per_pad` are stated."},
    {"youngs_modulus_gpa", FG_RECIPE_REAL, AT(material.youngs_modulus_gpa), 0, 1e-3, 1e4, false,
     false, "Of the strip, for the stiffness of bumps."},
    {"poisson_ratio", FG_RECIPE_REAL, AT(material.poisson_ratio), 0, 0, 0.499, false, false,
     "Likewise."},
    {"friction", FG_RECIPE_REAL, AT(material.friction), 0, 0, 10, false, false,
     "Coulomb's, of the bumps' feet."},
};

/* Members of "assembly". A hundred thousand draws take seconds and give shares to 0.3 %. */
static const fg_recipe_member assembly_members[] = {
    {"bearings", FG_RECIPE_COUNT, AT(assembly.bearings), 0, 0, 100000, false, false,
     "Drawn from the foils, to see how many would assemble; 0 draws none."},
    {"seed", FG_RECIPE_SEED, AT(assembly.seed), 0, 0, 9007199254740992.0, false, false,
     "Of the draws."},
    {"design_deviation_pct", FG_RECIPE_REAL, AT(assembly.design_deviation_pct), 0, 0, 100, false,
     false,
     "Clearances within this of the design: of the bearings of the design that are shown beside "
     "them."},
};

const fg_recipe_table fg_recipe_values = {members, sizeof members / sizeof *members};
const fg_recipe_table fg_recipe_assembly = {assembly_members,
                                            sizeof assembly_members / sizeof *assembly_members};

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
  };
  fg_design_default(&settings->design);
}

void *fg_recipe_place(const fg_recipe_member *row, const fg_lot_settings *settings) {
  return (char *)(uintptr_t)settings + row->offset;
}

double fg_recipe_number(const fg_recipe_member *row, const fg_lot_settings *settings) {
  const void *place = fg_recipe_place(row, settings);
  switch (row->kind) {
  case FG_RECIPE_REAL:
    return *(const double *)place;
  case FG_RECIPE_COUNT:
    return (double)*(const size_t *)place;
  case FG_RECIPE_SEED:
    return (double)*(const uint64_t *)place;
  case FG_RECIPE_UNSIGNED:
    return *(const unsigned *)place;
  default:
    return NAN;
  }
}

bool fg_recipe_is_open(const fg_recipe_member *row, double value) {
  return row->open && value == 0;
}

void fg_recipe_write(fg_json *json, const fg_recipe_member *row, const fg_lot_settings *settings) {
  const void *place = fg_recipe_place(row, settings);
  if (row->kind == FG_RECIPE_WORDS) {
    fg_json_string(json, row->name, place);
  } else if (row->kind == FG_RECIPE_SWITCH) {
    fg_json_bool(json, row->name, *(const bool *)place);
  } else if (row->kind == FG_RECIPE_RULE) {
    fg_json_string(json, row->name, fg_bandwidth_word(*(const fg_bandwidth_rule *)place));
  } else if (row->kind == FG_RECIPE_RUN_RULES) {
    fg_json_array(json, row->name);
    fg_json_line(json);
    for (unsigned rule = 1; rule <= FG_RUN_RULES; rule++)
      if (*(const unsigned *)place & (1u << (rule - 1))) fg_json_integer(json, NULL, rule);
    fg_json_array_end(json);
    fg_json_line_end(json);
  } else if (row->kind == FG_RECIPE_REAL ||
             fg_recipe_is_open(row, fg_recipe_number(row, settings))) {
    double value = fg_recipe_number(row, settings);
    fg_json_number(json, row->name, fg_recipe_is_open(row, value) ? NAN : value);
  } else {
    fg_json_integer(json, row->name, (int64_t)fg_recipe_number(row, settings));
  }
}

/* Prints the default as --print-recipe does. */
static void print_default(const fg_recipe_member *row, const fg_lot_settings *usual, char *text,
                          size_t size) {
  char *json = NULL;
  size_t length;
  fg_json writer;
  FILE *out = open_memstream(&json, &length);
  if (!out) return;
  fg_json_begin(&writer, out);
  fg_json_object(&writer, NULL);
  fg_json_line(&writer);
  fg_recipe_write(&writer, row, usual);
  fg_json_object_end(&writer);
  fg_json_end(&writer);
  if (fclose(out) != 0) return;
  const char *value = strchr(json, ':');
  if (value) fg_text_clip(text, size, "%.*s", (int)strcspn(value + 2, "}"), value + 2);
  free(json);
}

void fg_recipe_describe(const char *object, const fg_recipe_member *row, fg_member_words *words) {
  fg_lot_settings usual;
  fg_lot_settings_default(&usual);
  *words = (fg_member_words){.meaning = row->meaning};
  fg_text_clip(words->name, sizeof words->name, "%s%s", object, row->name);
  if (row->highest > 0)
    fg_text_clip(words->limits, sizeof words->limits, "%.16g to %.16g", row->lowest, row->highest);
  print_default(row, &usual, words->usual, sizeof words->usual);
}

void fg_recipe_find_file(const char *path, const char *name, char *file, size_t size) {
  const char *slash = strrchr(path, '/');
  bool beside = slash && name[0] != '/';
  fg_text_clip(file, size, "%.*s%s", beside ? (int)(slash - path) + 1 : 0, path, name);
}
