/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The constants of a strip's material: one row each. */
#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/json_read.h"
#include "core/sha256.h"
#include "core/text.h"
#include "forming/material_members.h"

enum { BYTES_MAX = 1 << 20 };

static const fg_forming_constant_row rows[FG_FORMING_CONSTANTS] = {
    [FG_FORMING_MODULUS] = {"youngs_modulus_gpa", "E", "GPa", "Young's modulus at 20 °C", 1, 1000,
                            true, 193,
                            "AISI 301 annealed, 28e6 psi (AMS 5519 data sheets); EN 10151 gives "
                            "1.4310 strip 179 GPa as rolled to 1300 MPa: scatter 8 %"},
    [FG_FORMING_MODULUS_SLOPE] = {"modulus_slope_per_K", "s", "1/K",
                                  "E falls by this share of itself per kelvin", 0, 1e-3, false,
                                  3.65e-4,
                                  "EN 10088-1, austenitic steels: 200 GPa at 20 °C, 165 GPa at "
                                  "500 °C; a straight line beyond: scatter 5 % of E"},
    [FG_FORMING_POISSON] = {"poisson_ratio", "nu", "", "Poisson's ratio", 0, 0.49, false, 0.3,
                            "austenitic steels, 0.28 to 0.30"},
    [FG_FORMING_YIELD] = {"yield_mpa", "Y", "MPa", "yield stress at 20 °C", 1, 5000, true, 250,
                          "EN 10088-2, 1.4310 annealed: at least 250 MPa. The thesis does not "
                          "print the temper; EN 10151 rolls the same steel to 1150 ... 1900 MPa "
                          "(scatter: a factor of 5)"},
    [FG_FORMING_HARDENING] = {"hardening_mpa", "H", "MPa", "hardening per plastic strain", 0, 1e5,
                              false, 2500,
                              "chord from 250 MPa to the true stress at uniform elongation by "
                              "EN 10088-2 (Rm 600 ... 950 MPa, A 40 %): 1750 ... 3200 MPa"},
    [FG_FORMING_CREEP_RATE] = {"creep_rate_per_h", "A", "1/h", "Norton creep at 100 MPa and 550 °C",
                               1e-20, 1e12, true, 6.65e-9,
                               "Frost and Ashby 1982, Deformation-Mechanism Maps, table 8.1: "
                               "AISI 304, steady state. Primary creep and recovery of a worked "
                               "strip are faster by factors of 10 to 1e5: fit it"},
    [FG_FORMING_CREEP_EXPONENT] = {"creep_exponent", "n", "", "Norton's exponent", 1, 20, false,
                                   7.5,
                                   "Frost and Ashby 1982, table 8.1: 304 7.5, 316 7.9; "
                                   "relaxation tests of such steels give 4 to 8"},
    [FG_FORMING_CREEP_ENERGY] = {"creep_energy_kj_per_mol", "Q", "kJ/mol", "activation energy", 0,
                                 1000, false, 280,
                                 "Frost and Ashby 1982, table 8.1: lattice diffusion of 304 and "
                                 "316; measured values reach 400"},
};

/* A trend only: up to 540 °C from annealed 301 and 304 in the Aerospace and Nickel Institute
 * tables, beyond by extrapolation by eye. */
static const double curve_t[] = {20, 200, 400, 540, 650, 760, 900};
static const double curve_share[] = {1, 0.73, 0.62, 0.57, 0.5, 0.4, 0.2};
static const char curve_words[] =
    "trend of annealed 18-8 steels (304: 0.2 % stress 57 % of that at 20 °C at 540 °C), rounded; "
    "scatter 15 %, extrapolated above 760 °C";

const fg_forming_constant_row *fg_forming_constant_of(fg_forming_constant constant) {
  return &rows[constant];
}

void fg_forming_material_default(fg_forming_material *material) {
  *material = (fg_forming_material){.name = "1.4310 strip, annealed (literature)"};
  for (int c = 0; c < FG_FORMING_CONSTANTS; c++) {
    material->value[c] = rows[c].value;
    fg_text_clip(material->source[c], FG_FORMING_SOURCE, "%s", rows[c].source);
  }
  material->curve_count = sizeof curve_t / sizeof *curve_t;
  memcpy(material->curve_temperature_C, curve_t, sizeof curve_t);
  memcpy(material->curve_share, curve_share, sizeof curve_share);
  fg_text_clip(material->curve_source, FG_FORMING_SOURCE, "%s", curve_words);
}

static fg_status check_curve(fg_context *ctx, const fg_forming_material *m) {
  for (size_t i = 0; i < m->curve_count; i++) {
    double t = m->curve_temperature_C[i], share = m->curve_share[i];
    double stiff = 1 - m->value[FG_FORMING_MODULUS_SLOPE] * (t - FG_FORMING_COLD_C);
    if (!(isfinite(t) && t > -273) || (i && !(t > m->curve_temperature_C[i - 1])))
      return fg_fail(ctx, FG_ERR_DATA,
                     "yield_curve: temperature_C[%zu] is %g; temperatures must rise", i, t);
    if (!(share > 0 && share <= 2))
      return fg_fail(ctx, FG_ERR_DATA,
                     "yield_curve: share[%zu] is %g; it must be above 0, at most 2", i, share);
    if (!(stiff > 0.05))
      return fg_fail(ctx, FG_ERR_DATA,
                     "modulus_slope_per_K is %g: nothing is left of E at %g degrees C, where "
                     "yield_curve still goes",
                     m->value[FG_FORMING_MODULUS_SLOPE], t);
  }
  if (m->curve_count) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA, "yield_curve has no points");
}

fg_status fg_forming_material_check(fg_context *ctx, const fg_forming_material *material) {
  for (int c = 0; c < FG_FORMING_CONSTANTS; c++) {
    double value = material->value[c];
    if (!(value >= rows[c].low && value <= rows[c].high))
      return fg_fail(ctx, FG_ERR_DATA, "%s is %g; it must be from %g to %g%s%s", rows[c].name,
                     value, rows[c].low, rows[c].high, *rows[c].unit ? " " : "", rows[c].unit);
  }
  return check_curve(ctx, material);
}

/* ---- the file ---- */

static fg_status read_constant_value(fg_context *ctx, const char *name, const cJSON *item,
                                     double *value) {
  if (!cJSON_IsNumber(item) || !isfinite(item->valuedouble))
    return fg_fail(ctx, FG_ERR_DATA, "%s must be a number", name);
  *value = item->valuedouble;
  return FG_OK;
}

static fg_status read_source(fg_context *ctx, const char *name, const cJSON *item, char *text,
                             size_t size) {
  if (!cJSON_IsString(item)) return fg_fail(ctx, FG_ERR_DATA, "%s must be a text", name);
  if (strlen(item->valuestring) >= size)
    return fg_fail(ctx, FG_ERR_DATA, "%s has more than %zu bytes", name, size - 1);
  strcpy(text, item->valuestring);
  return FG_OK;
}

/* Reads a number, or {"value": ..., "source": ...}. A number without its source gets a source that
 * states so. */
static fg_status read_constant(fg_context *ctx, const cJSON *item, int c,
                               fg_forming_material *material) {
  char *source = material->source[c];
  fg_text_clip(source, FG_FORMING_SOURCE, "as given, without a source");
  if (!cJSON_IsObject(item))
    return read_constant_value(ctx, rows[c].name, item, &material->value[c]);
  const cJSON *member;
  bool valued = false;
  cJSON_ArrayForEach(member, item) {
    if (!strcmp(member->string, "value")) {
      FG_TRY(read_constant_value(ctx, rows[c].name, member, &material->value[c]));
      valued = true;
    } else if (!strcmp(member->string, "source")) {
      FG_TRY(read_source(ctx, "source", member, source, FG_FORMING_SOURCE));
    } else if (strcmp(member->string, "unit") != 0) {
      return fg_fail(ctx, FG_ERR_DATA, "%s.%.40s is not known; there are value, source, unit",
                     rows[c].name, member->string);
    } else if (!cJSON_IsString(member) || strcmp(member->valuestring, rows[c].unit) != 0) {
      return fg_fail(ctx, FG_ERR_DATA, "%s: the unit must be \"%s\"", rows[c].name, rows[c].unit);
    }
  }
  return valued ? FG_OK : fg_fail(ctx, FG_ERR_DATA, "%s.value is missing", rows[c].name);
}

static fg_status read_curve_numbers(fg_context *ctx, const char *name, const cJSON *item,
                                    double *values, size_t *count) {
  const cJSON *entry;
  size_t n = 0;
  if (!cJSON_IsArray(item)) return fg_fail(ctx, FG_ERR_DATA, "%s must be an array", name);
  cJSON_ArrayForEach(entry, item) {
    if (n == FG_FORMING_CURVE_MAX)
      return fg_fail(ctx, FG_ERR_DATA, "%s has more than %d values", name, FG_FORMING_CURVE_MAX);
    FG_TRY(read_constant_value(ctx, name, entry, &values[n]));
    n++;
  }
  *count = n;
  return FG_OK;
}

static fg_status read_curve(fg_context *ctx, const cJSON *item, fg_forming_material *m) {
  size_t temperatures = 0, shares = 0;
  const cJSON *member;
  if (!cJSON_IsObject(item)) return fg_fail(ctx, FG_ERR_DATA, "yield_curve must be an object");
  fg_text_clip(m->curve_source, FG_FORMING_SOURCE, "as given, without a source");
  cJSON_ArrayForEach(member, item) {
    const char *name = member->string;
    if (!strcmp(name, "temperature_C"))
      FG_TRY(read_curve_numbers(ctx, "yield_curve.temperature_C", member, m->curve_temperature_C,
                                &temperatures));
    else if (!strcmp(name, "share"))
      FG_TRY(read_curve_numbers(ctx, "yield_curve.share", member, m->curve_share, &shares));
    else if (!strcmp(name, "source"))
      FG_TRY(read_source(ctx, "yield_curve.source", member, m->curve_source, FG_FORMING_SOURCE));
    else
      return fg_fail(ctx, FG_ERR_DATA,
                     "yield_curve.%.40s is not known; there are temperature_C, share, source",
                     name);
  }
  if (temperatures != shares || !shares)
    return fg_fail(ctx, FG_ERR_DATA,
                   "yield_curve has %zu temperatures and %zu shares; it needs as many of each",
                   temperatures, shares);
  m->curve_count = shares;
  return FG_OK;
}

static fg_status read_material_member(fg_context *ctx, const cJSON *item,
                                      fg_forming_material *material) {
  const char *name = item->string;
  if (!strcmp(name, "schema"))
    return cJSON_IsString(item) && !strcmp(item->valuestring, FG_FORMING_MATERIAL_SCHEMA)
               ? FG_OK
               : fg_fail(ctx, FG_ERR_DATA, "schema must be \"%s\"", FG_FORMING_MATERIAL_SCHEMA);
  if (!strcmp(name, "name"))
    return read_source(ctx, name, item, material->name, sizeof material->name);
  if (!strcmp(name, "version")) return FG_OK; /* of whoever wrote it */
  if (!strcmp(name, "yield_curve")) return read_curve(ctx, item, material);
  for (int c = 0; c < FG_FORMING_CONSTANTS; c++)
    if (!strcmp(name, rows[c].name)) return read_constant(ctx, item, c, material);
  char known[400] = "";
  for (int c = 0; c < FG_FORMING_CONSTANTS; c++) {
    size_t used = strlen(known);
    fg_text_clip(known + used, sizeof known - used, "%s, ", rows[c].name);
  }
  return fg_fail(ctx, FG_ERR_DATA,
                 "%.40s is not a member of a material; there are %sname, yield_curve", name, known);
}

static fg_status read_material_root(fg_context *ctx, const cJSON *root,
                                    fg_forming_material *material) {
  const cJSON *item;
  if (!cJSON_IsObject(root)) return fg_fail(ctx, FG_ERR_DATA, "not a JSON object");
  cJSON_ArrayForEach(item, root) {
    for (const cJSON *other = root->child; other != item; other = other->next)
      if (!strcmp(other->string, item->string))
        return fg_fail(ctx, FG_ERR_DATA, "%.40s is given twice", item->string);
    FG_TRY(read_material_member(ctx, item, material));
  }
  if (!cJSON_GetObjectItemCaseSensitive(root, "schema"))
    return fg_fail(ctx, FG_ERR_DATA, "schema is missing; a material has \"schema\": \"%s\"",
                   FG_FORMING_MATERIAL_SCHEMA);
  return fg_forming_material_check(ctx, material);
}

fg_status fg_forming_material_load(fg_context *ctx, const char *path,
                                   fg_forming_material *material) {
  char *text = NULL;
  fg_forming_material read = *material;
  fg_context words = {0};
  FG_TRY(fg_file_read_text(ctx, path, BYTES_MAX, &text));
  fg_text_clip(read.file.path, sizeof read.file.path, "%s", path);
  fg_sha256_text(text, read.file.sha256);
  cJSON *root;
  fg_status status = fg_json_read(ctx, path, text, &root);
  free(text);
  FG_TRY(status);
  status = read_material_root(&words, root, &read);
  cJSON_Delete(root);
  if (status != FG_OK) return fg_fail(ctx, status, "%s: %.*s", path, 700, words.message);
  *material = read;
  return FG_OK;
}
