/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "forming/material_members.h"

#include "core/file.h"

/* A constant of the material: the subject's index says which. */
static const fg_forming_constant_row *constant_of(const fg_subject *constant) {
  return fg_forming_constant_of((fg_forming_constant)constant->index);
}

static bool find_constant(const fg_subject *list, size_t c, fg_subject *element) {
  element->object = list->object;
  return c < FG_FORMING_CONSTANTS;
}

static const char *find_constant_name(const fg_subject *constant) {
  return constant_of(constant)->name;
}

static const char *constant_name_at(size_t c) {
  return c < FG_FORMING_CONSTANTS ? fg_forming_constant_of((fg_forming_constant)c)->name : NULL;
}

static double find_constant_value(const fg_subject *constant) {
  return ((const fg_forming_material *)constant->object)->value[constant->index];
}

static const char *find_constant_unit(const fg_subject *constant, char *buffer) {
  (void)buffer;
  return constant_of(constant)->unit;
}

static const char *find_constant_source(const fg_subject *constant, char *buffer) {
  (void)buffer;
  return ((const fg_forming_material *)constant->object)->source[constant->index];
}

static const fg_member constant_rows[] = {
    {FG_NUMBER_BY("value", find_constant_value), .options = FG_MEMBER_NEVER_NULL},
    {FG_TEXT_BY("unit", find_constant_unit), .options = FG_MEMBER_NEVER_NULL},
    {FG_TEXT_BY("source", find_constant_source), .options = FG_MEMBER_NEVER_NULL,
     .words = "where the value is from"},
};
static const fg_members constant_members = FG_MEMBERS_DEFINED(constant_rows, "constant");

static const double *list_temperatures(const fg_subject *s, double *buffer, size_t *count) {
  const fg_forming_material *material = s->object;
  (void)buffer;
  *count = material->curve_count;
  return material->curve_temperature_C;
}

static const double *list_shares(const fg_subject *s, double *buffer, size_t *count) {
  const fg_forming_material *material = s->object;
  (void)buffer;
  *count = material->curve_count;
  return material->curve_share;
}

static const fg_member curve_rows[] = {
    {FG_NUMBERS_BY("temperature_C", list_temperatures), .options = FG_MEMBER_NEVER_NULL},
    {FG_NUMBERS_BY("share", list_shares), .options = FG_MEMBER_NEVER_NULL,
     .words = "of that at 20 °C"},
    {FG_TEXT("source", fg_forming_material, curve_source)},
};
static const fg_members curve_members = FG_MEMBERS(curve_rows);

static const fg_member material_rows[] = {
    {FG_TEXT("name", fg_forming_material, name), .words = "of the material"},
    {FG_MAP_BY(NULL, find_constant, find_constant_name, &constant_members),
     .choice_at = constant_name_at, .words = "constants of foilgauge-forming(1)"},
    {FG_GROUP("yield_curve", &curve_members), .words = "of yield and hardening over temperature"},
};
const fg_members fg_forming_material_members = FG_MEMBERS(material_rows);

static const fg_member file_rows[] = {
    {FG_HEAD(FG_FORMING_MATERIAL_SCHEMA)},
    {FG_SAME(&fg_forming_material_members), .options = FG_MEMBER_EXACT},
};
static const fg_members file_members = FG_MEMBERS(file_rows);

fg_status fg_forming_write_material(fg_context *ctx, const fg_forming_material *material,
                                    FILE *out) {
  fg_document_json(out, &file_members, material);
  return fg_stream_finish(ctx, out, "the material");
}
