/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/stiffness/table.h"

#include <string.h>

#include "page/page.h"
#include "page/table.h"

fg_stiffness_case fg_stiffness_case_of(const char *title, const fg_design *design,
                                       const fg_arch *arch, const fg_arch_material *material) {
  fg_stiffness_case bump;
  fg_stiffness_line lines[FG_STIFFNESS_MODELS];
  fg_stiffness_compare(arch, material, lines);
  for (int i = 0; i < FG_STIFFNESS_MODELS; i++) {
    const fg_stiffness_model *model = &fg_stiffness_models()[i];
    double stiffness = lines[i].stiffness_n_mm2;
    bump.by_model[i] =
        (fg_stiffness_result){.sensitivity = lines[i].sensitivity,
                              .stiffness_n_mm2 = stiffness,
                              .per_area_n_mm3 = stiffness / fg_design_pitch_mm(design),
                              .over_arch = stiffness / lines[0].stiffness_n_mm2,
                              .model = model,
                              .title = model->title,
                              .bump = title};
    strcpy(bump.by_model[i].reserve, lines[i].words);
  }
  return bump;
}

fg_stiffness_of_design fg_stiffness_find_of_design(const fg_design *design,
                                                   const fg_arch_material *material) {
  const fg_arch arch = fg_design_arch(design, design->thickness_mm, design->bumps.radius_mm,
                                      design->bumps.angle_deg);
  return (fg_stiffness_of_design){.material = material,
                                  .pitch_mm = fg_design_pitch_mm(design),
                                  .note = fg_stiffness_kind_note(design->kind),
                                  .bump =
                                      fg_stiffness_case_of("as designed", design, &arch, material),
                                  .map = fg_stiffness_map_around(design, material)};
}

/* A column of percent of stiffness per percent of a parameter. */
#define SENSITIVITY(name, heading_, symbol)                                                        \
  FG_NUMBER(#name, fg_arch_sensitivity, name),                                                     \
      .page = {.rank = 3, .heading = "% per %\nof " heading_, .decimals = 2, .plus = true},        \
      .terminal = {.rank = 3, .heading = (symbol), .decimals = 2, .plus = true}

static const fg_member sensitivity_rows[] = {
    {SENSITIVITY(radius, "radius\nalone", "R"),
     .words = "percent of stiffness per percent of the radius alone"},
    {SENSITIVITY(angle, "angle\nalone", "alpha"), .words = "per percent of the angle alone"},
    {SENSITIVITY(radius_at_arc_length, "radius, arc\nlength kept", "R, arc"),
     .words = "per percent of the radius at constant arc length"},
    {SENSITIVITY(thickness, "thickness", "t"), .words = "per percent of the thickness"},
};
const fg_members fg_sensitivity_members =
    FG_MEMBERS_OF_FILE(sensitivity_rows, "sensitivity", "nominal");

static const fg_member result_rows[] = {
    {FG_STRING("model", fg_stiffness_result, title), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .heading = "model", .words = true},
     .terminal = {.rank = 1, .words = true}},
    {FG_STRING("bump", fg_stiffness_result, bump), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .heading = "bump", .words = true}},
    {FG_NUMBER("stiffness_n_mm2", fg_stiffness_result, stiffness_n_mm2),
     .words = "per bump and mm of width",
     .page = {.rank = 2, .heading = "K per mm\nof width,\nN/mm²", .digits = 4},
     .terminal = {.rank = 2, .heading = "N/mm2", .digits = 4}},
    {FG_NUMBER("per_area_n_mm3", fg_stiffness_result, per_area_n_mm3), .words = "over the pitch",
     .page = {.rank = 2, .heading = "per area,\nN/mm³", .digits = 3},
     .terminal = {.rank = 2, .heading = "N/mm3", .digits = 4}},
    {FG_NUMBER("over_arch", fg_stiffness_result, over_arch), .words = "over the arch's",
     .page = {.rank = 2, .heading = "over\nthe arch", .digits = 3}},
    {FG_OBJECT("sensitivity", fg_stiffness_result, sensitivity, &fg_sensitivity_members),
     .options = FG_MEMBER_ON_LINE},
    {FG_SAME(&fg_sensitivity_members), .options = FG_MEMBER_NOT_IN_JSON},
    {FG_TEXT("reserve", fg_stiffness_result, reserve), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "what the model leaves out that counts for this bump, or why it gives no stiffness"},
};
const fg_members fg_stiffness_result_members = FG_MEMBERS_OF_FILE(result_rows, "case", "nominal");

static const char *model_choice(size_t i) {
  return i < FG_STIFFNESS_MODELS ? fg_stiffness_models()[i].id : NULL;
}

static const fg_member model_rows[] = {
    {FG_STRING("id", fg_stiffness_model, id), .choice_at = model_choice,
     .options = FG_MEMBER_NEVER_NULL},
    {FG_STRING("formula", fg_stiffness_model, formula), .options = FG_MEMBER_NEVER_NULL},
    {FG_STRING("source", fg_stiffness_model, source), .options = FG_MEMBER_NEVER_NULL},
};
const fg_members fg_stiffness_model_members = FG_MEMBERS(model_rows);

static const fg_member design_model_rows[] = {
    {FG_SAME(&fg_stiffness_model_members), .pointed = true,
     .offset = offsetof(fg_stiffness_result, model)},
    {FG_GROUP("design", &fg_stiffness_result_members)},
};
static const fg_members design_model_members = FG_MEMBERS(design_model_rows);

static bool find_model_of_design(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_stiffness_of_design *of = list->object;
  element->object = &of->bump.by_model[i];
  return i < FG_STIFFNESS_MODELS;
}

static const fg_member material_rows[] = {
    {FG_NUMBER("youngs_modulus_gpa", fg_arch_material, youngs_modulus_gpa),
     .options = FG_MEMBER_NEVER_NULL},
    {FG_NUMBER("poisson_ratio", fg_arch_material, poisson_ratio), .options = FG_MEMBER_NEVER_NULL},
    {FG_NUMBER("friction", fg_arch_material, friction), .options = FG_MEMBER_NEVER_NULL,
     .words = "Coulomb's, of the feet"},
};
static const fg_members material_members = FG_MEMBERS(material_rows);

static const fg_member design_rows[] = {
    {FG_POINTED("material", fg_stiffness_of_design, material, &material_members),
     .options = FG_MEMBER_ON_LINE | FG_MEMBER_NEVER_NULL},
    {FG_NUMBER("pitch_mm", fg_stiffness_of_design, pitch_mm), .options = FG_MEMBER_NEVER_NULL,
     .words = "from bump to bump along the sleeve"},
    {FG_STRING("note", fg_stiffness_of_design, note),
     .words = "what the models leave out of this form"},
    {FG_LIST_BY("models", find_model_of_design, &design_model_members),
     .lowest = FG_STIFFNESS_MODELS, .highest = FG_STIFFNESS_MODELS},
    {FG_OBJECT("map", fg_stiffness_of_design, map, &fg_stiffness_map_members)},
};
const fg_members fg_stiffness_design_members = FG_MEMBERS(design_rows);

static void put_sources(FILE *out, const fg_stiffness_case *bump) {
  fputs("<dl class=\"facts\" style=\"margin-top:14px\">\n", out);
  for (int i = 0; i < FG_STIFFNESS_MODELS; i++) {
    const fg_stiffness_model *model = bump->by_model[i].model;
    fprintf(out, "<dt>%s</dt><dd>%s<br>%s.", model->title, model->formula, model->source);
    if (*bump->by_model[i].reserve) {
      fputs("<br><b>", out);
      fg_html_text(out, bump->by_model[i].reserve);
      fputs("</b>", out);
    }
    fputs("</dd>\n", out);
  }
  fputs("<dt>Iordanoff</dt><dd>", out);
  fg_html_text(out, fg_stiffness_absent_note());
  fputs("</dd>\n</dl>\n", out);
}

/* Cases of a table. */
typedef struct stiffness_cases {
  const fg_stiffness_case *cases;
  size_t count;
} stiffness_cases;

static bool find_result(const fg_subject *list, size_t i, fg_subject *element) {
  const stiffness_cases *of = list->object;
  element->object = &of->cases[i % of->count].by_model[i / of->count];
  return i / of->count < FG_STIFFNESS_MODELS;
}

void fg_html_stiffness_table(FILE *out, const fg_stiffness_case *cases, size_t count) {
  const stiffness_cases all = {cases, count};
  fg_html_table(out, &fg_stiffness_result_members, &(fg_subject){.object = &all}, find_result);
  put_sources(out, &cases[count - 1]);
}

void fg_text_stiffness_table(FILE *out, const fg_stiffness_case *bump) {
  const stiffness_cases all = {bump, 1};
  fputs("\nstiffness of a bump, per mm of width; % per % of radius, angle, radius at constant arc "
        "length, thickness\n",
        out);
  fg_members_terminal(out, "  ", &fg_stiffness_result_members, &(fg_subject){.object = &all},
                      find_result);
  for (int i = 0; i < FG_STIFFNESS_MODELS; i++)
    if (*bump->by_model[i].reserve)
      fprintf(out, "    %s: %s\n", bump->by_model[i].title, bump->by_model[i].reserve);
}
