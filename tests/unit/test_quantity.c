/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A quantity is one row: reports, schemas, lots and tables know every row. */
#include <stdbool.h>
#include <string.h>
#include <strings.h>
#include <sys/types.h>

#include <cjson/cJSON.h>

#include "foilgauge/bearing.h"
#include "foilgauge/report.h"
#include "foilgauge/scan_loop.h"
#include "quantity/quantity_rows.h"
#include "report/lot/characteristics.h"
#include "support/made_lot.h"
#include "support/measured_render.h"
#include "support/synthetic_foil.h"
#include "support/test.h"

static void every_format_is_complete(void **state) {
  (void)state;
  for (fg_quantity_owner owner = 0; owner < FG_QUANTITY_OWNERS; owner++) {
    size_t count;
    const fg_quantity *rows = fg_quantities(owner, &count);
    assert_true(count > 0);
    for (size_t i = 0; i < count; i++) {
      in_row("%s", rows[i].name);
      assert_true(rows[i].name && rows[i].unit && rows[i].symbol && rows[i].words);
      assert_true(!rows[i].characteristic || rows[i].nominal); /* an export states it */
      /* Quality systems get characteristics from a lot's statistics. */
      if (rows[i].characteristic && owner != FG_QUANTITY_OF_BEARING)
        assert_true(rows[i].uses & FG_QUANTITY_IN_LOT);
      if (rows[i].by_arc_length) assert_int_equal(owner, FG_QUANTITY_OF_BUMP);
      if (rows[i].covariance) assert_true(fg_quantity_has_u(&rows[i]));
    }
  }
}

static void names_of_quantities_are_unique(void **state) {
  (void)state;
  for (fg_quantity_owner owner = 0; owner < FG_QUANTITY_OWNERS; owner++) {
    size_t count;
    const fg_quantity *rows = fg_quantities(owner, &count);
    for (size_t i = 0; i < count; i++)
      for (size_t k = 0; k < i; k++) {
        in_row("%s beside %s", rows[i].name, rows[k].name);
        assert_string_not_equal(rows[i].name, rows[k].name);
        assert_string_not_equal(rows[i].words, rows[k].words);
        assert_int_not_equal(rows[i].offset, rows[k].offset);
        if (rows[i].rank && rows[i].rank == rows[k].rank)
          fail_msg("%s has the rank of %s, %d: each has its own", rows[i].name, rows[k].name,
                   rows[i].rank);
        /* A column of S beside one of s is read as the other. */
        bool letters_tell_apart = strcmp(rows[i].symbol, rows[k].symbol) == 0 ||
                                  strcasecmp(rows[i].symbol, rows[k].symbol) != 0;
        assert_true(letters_tell_apart);
      }
  }
  /* A tolerance names a quantity of a foil or of its bumps: never of both. */
  size_t count;
  const fg_quantity *rows = fg_quantities(FG_QUANTITY_OF_FOIL, &count);
  for (size_t i = 0; i < count; i++)
    assert_null(fg_quantity_find(FG_QUANTITY_OF_BUMP, rows[i].name));
}

/* More rows of one use than there is room for would be cut off. */
static void every_use_has_room(void **state) {
  (void)state;
  for (fg_quantity_owner owner = 0; owner < FG_QUANTITY_OWNERS; owner++)
    for (unsigned use = FG_QUANTITY_ON_PAGE; use <= FG_QUANTITY_IN_LOT; use <<= 1) {
      const fg_quantity *shown[FG_QUANTITY_SHOWN_MAX];
      size_t count, wanted = 0;
      const fg_quantity *rows = fg_quantities(owner, &count);
      for (size_t i = 0; i < count; i++)
        wanted += rows[i].uses & use && fg_quantity_applies(owner, &rows[i], FG_FOIL_CLASSICAL);
      assert_int_equal(fg_quantity_shown(owner, (fg_quantity_use)use, FG_FOIL_CLASSICAL, shown),
                       wanted);
      for (size_t i = 1; i < wanted; i++)
        assert_true(!shown[i]->rank || (shown[i - 1]->rank && shown[i - 1]->rank < shown[i]->rank));
    }
  char names[800] = "";
  fg_quantity_list(FG_QUANTITY_OF_BUMP, FG_FOIL_CLASSICAL, true, names, sizeof names);
  fg_quantity_list(FG_QUANTITY_OF_FOIL, FG_FOIL_CLASSICAL, true, names, sizeof names);
  assert_true(strlen(names) + 1 < sizeof names);
}

/* A calibration's moves beyond the room for them would be written over other members of the bump.
 */
static void a_calibration_has_room_for_every_row(void **state) {
  (void)state;
  for (fg_quantity_owner owner = 0; owner < FG_QUANTITY_OWNERS; owner++) {
    size_t count, moves = fg_quantity_moves(owner);
    if (moves > FG_CALIBRATED_MAX)
      fail_msg("the owner of %s has %zu values with u_: raise FG_CALIBRATED_MAX, which is %d, in "
               "include/foilgauge/foil.h",
               fg_quantities(owner, &count)->name, moves, FG_CALIBRATED_MAX);
  }
}

/* ---- reports ---- */

static char *text_of(const fg_report *report,
                     fg_status (*write)(fg_context *, const fg_report *, FILE *)) {
  fg_context ctx = {0};
  char *text = NULL;
  size_t length;
  FILE *out = open_memstream(&text, &length);
  assert_non_null(out);
  assert_ok(&ctx, write(&ctx, report, out));
  fclose(out);
  return text;
}

/* The member of an object that a row is written as, "overall.radius_mm" two levels down. */
static const cJSON *member_of(const cJSON *object, const char *name, const char *before) {
  char group[64], last[96];
  const char *dot = strchr(name, '.');
  snprintf(group, sizeof group, "%.*s", dot ? (int)(dot - name) : 0, name);
  snprintf(last, sizeof last, "%s%s", before, dot ? dot + 1 : name);
  if (dot) object = cJSON_GetObjectItemCaseSensitive(object, group);
  return cJSON_GetObjectItemCaseSensitive(object, last);
}

static void same(const cJSON *written, double number) {
  assert_true(cJSON_IsNumber(written));
  assert_true(fabs(written->valuedouble - number) <= 1e-9 * fabs(number));
}

static void holds_every_row(const cJSON *object, fg_quantity_owner owner, fg_foil_kind kind,
                            const void *values) {
  size_t count;
  const fg_quantity *rows = fg_quantities(owner, &count);
  for (size_t i = 0; i < count; i++) {
    double numbers[FG_QUANTITY_NUMBERS_MAX];
    if (!fg_quantity_applies(owner, &rows[i], kind)) continue;
    size_t width = fg_quantity_numbers(&rows[i], values, numbers);
    for (size_t k = 0; k < width; k++) {
      bool pair = rows[i].kind == FG_QUANTITY_PAIR;
      size_t per = fg_quantity_values(&rows[i]);
      const cJSON *written = member_of(object, rows[i].name, k < per ? "" : "u_");
      if (pair) written = cJSON_GetArrayItem(written, (int)(k % per));
      if (!written) fail_msg("JSON lacks %s", rows[i].name);
      same(written, numbers[k]);
    }
  }
}

/* The heading of a CSV holds the names of all numbers, in their order. */
static void heads_every_row(const char *csv, fg_quantity_owner owner) {
  size_t count;
  const fg_quantity *rows = fg_quantities(owner, &count);
  const char *at = csv, *end = strchr(csv, '\n');
  for (size_t i = 0; i < count; i++)
    for (size_t k = 0; k < fg_quantity_width(&rows[i]); k++) {
      char name[64], cell[80];
      fg_quantity_column(&rows[i], k, name, sizeof name);
      snprintf(cell, sizeof cell, ",%s,", name);
      at = strstr(at, cell);
      if (!at || at > end) fail_msg("CSV lacks %s", name);
    }
}

static const cJSON *item(const cJSON *object, const char *list, int i) {
  return cJSON_GetArrayItem(cJSON_GetObjectItemCaseSensitive(object, list), i);
}

static void reports_hold_every_row(void **state) {
  (void)state;
  fg_design design = synthetic_design();
  fg_nominal nominal = synthetic_nominal(&design);
  fg_measurement measurement = synthetic_measurement(&design);
  fg_foil *foil = &measurement.foils[0];
  foil->correction = (fg_correction){1e-3, 2e-4, 3e-3, 4e-4, 5e-3, 6e-4};
  fg_report_scan scan = {"a.png", &measurement, NULL, NULL};
  fg_report report = {&design, &nominal, &scan, 1, NULL};
  char *text = text_of(&report, fg_report_write_json);
  cJSON *json = cJSON_Parse(text);
  const cJSON *written = item(json, "foils", 0);
  holds_every_row(written, FG_QUANTITY_OF_FOIL, design.kind, foil);
  holds_every_row(item(written, "bumps", 3), FG_QUANTITY_OF_BUMP, design.kind, &foil->bumps[3]);
  holds_every_row(cJSON_GetObjectItemCaseSensitive(written, "strip"), FG_QUANTITY_OF_STRIP,
                  design.kind, &foil->strip);
  cJSON_Delete(json);
  free(text);
  text = text_of(&report, fg_report_write_csv);
  heads_every_row(text, FG_QUANTITY_OF_BUMP);
  free(text);
  synthetic_free(&measurement);
}

static void reports_hold_every_row_of_arcs(void **state) {
  (void)state;
  fg_design design = synthetic_design();
  fg_nominal nominal = synthetic_nominal(&design);
  fg_measurement measurement = synthetic_measurement(&design);
  fg_foil *foil = &measurement.foils[0];
  assert_int_equal(fg_design_become(NULL, FG_FOIL_ARC, &design), FG_OK);
  design.arc.subtended_angle_deg = 110;
  measurement.design = design;
  foil->bump_count = 0;
  foil->correction = (fg_correction){1e-3, 2e-4, 3e-3, 4e-4, 5e-3, 6e-4};
  foil->arc = (fg_foil_arc){110.5, 0.001, 0.45, 0.0009, 39.8, 0.002};
  fg_report_scan scan = {"arc.png", &measurement, NULL, NULL};
  fg_report report = {&design, &nominal, &scan, 1, NULL};
  char *text = text_of(&report, fg_report_write_json);
  cJSON *json = cJSON_Parse(text);
  holds_every_row(item(json, "foils", 0), FG_QUANTITY_OF_FOIL, FG_FOIL_ARC, foil);
  cJSON_Delete(json);
  free(text);
  text = text_of(&report, fg_report_write_csv);
  heads_every_row(text, FG_QUANTITY_OF_FOIL);
  free(text);
  synthetic_free(&measurement);
}

static void reports_hold_every_row_of_discs(void **state) {
  (void)state;
  fg_design design = synthetic_design();
  assert_int_equal(fg_design_become(NULL, FG_FOIL_DISCS, &design), FG_OK);
  fg_nominal nominal = {0};
  fg_disc disc = synthetic_disc(1, 1.5);
  fg_measurement measurement = {
      .file = {.bit_depth = 8}, .dpi = {1200, 1200}, .discs = &disc, .disc_count = 1};
  memset(measurement.sha256, 'a', 64);
  fg_report_scan scan = {"discs.png", &measurement, NULL, NULL};
  fg_report report = {&design, &nominal, &scan, 1, NULL};
  char *text = text_of(&report, fg_report_write_json);
  cJSON *json = cJSON_Parse(text);
  holds_every_row(item(json, "discs", 0), FG_QUANTITY_OF_DISC, design.kind, &disc);
  cJSON_Delete(json);
  free(text);
  text = text_of(&report, fg_report_write_csv);
  heads_every_row(text, FG_QUANTITY_OF_DISC);
  free(text);
  free(disc.edge);
  free(disc.residual_um);
}

/* ---- schemas ---- */

static cJSON *load_schema(const char *path) {
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  char *text = calloc(1, 1 << 20);
  assert_true(fread(text, 1, (1 << 20) - 1, file) > 0);
  fclose(file);
  cJSON *schema = cJSON_Parse(text);
  assert_non_null(schema);
  free(text);
  return schema;
}

static const cJSON *properties_of(const cJSON *schema, const char *definition) {
  const cJSON *all = cJSON_GetObjectItemCaseSensitive(schema, "$defs");
  const cJSON *one = cJSON_GetObjectItemCaseSensitive(all, definition);
  return cJSON_GetObjectItemCaseSensitive(one, "properties");
}

static bool has_word(const cJSON *list, const char *word) {
  const cJSON *one;
  cJSON_ArrayForEach(one, list) if (strcmp(one->valuestring, word) == 0) return true;
  return false;
}

static void schemas_know_every_row(void **state) {
  (void)state;
  static const struct {
    const char *path, *definition;
  } schemas[FG_QUANTITY_OWNERS] = {
      [FG_QUANTITY_OF_FOIL] = {"reports/schema/measure.schema.json", "foil"},
      [FG_QUANTITY_OF_BUMP] = {"reports/schema/measure.schema.json", "bump"},
      [FG_QUANTITY_OF_BEAM] = {"reports/schema/measure.schema.json", "beam"},
      [FG_QUANTITY_OF_DISC] = {"reports/schema/measure.schema.json", "disc"},
      [FG_QUANTITY_OF_STRIP] = {"reports/schema/measure.schema.json", "strip"},
      [FG_QUANTITY_OF_BEARING] = {"reports/schema/lot.schema.json", "bearing"},
  };
  for (fg_quantity_owner owner = 0; owner < FG_QUANTITY_OWNERS; owner++) {
    size_t count;
    const fg_quantity *rows = fg_quantities(owner, &count);
    cJSON *schema = load_schema(schemas[owner].path);
    for (size_t i = 0; i < count; i++) {
      char group[64], u_name[96];
      const char *dot = strchr(rows[i].name, '.'), *name = dot ? dot + 1 : rows[i].name;
      snprintf(group, sizeof group, "%.*s", dot ? (int)(dot - rows[i].name) : 0, rows[i].name);
      snprintf(u_name, sizeof u_name, "u_%s", name);
      const cJSON *known = properties_of(schema, dot ? group : schemas[owner].definition);
      if (!cJSON_HasObjectItem(known, name))
        fail_msg("%s lacks %s", schemas[owner].path, rows[i].name);
      if (cJSON_HasObjectItem(known, u_name) != fg_quantity_has_u(&rows[i]))
        fail_msg("%s: %s is there, or its row has an uncertainty, but not both",
                 schemas[owner].path, u_name);
    }
    cJSON_Delete(schema);
  }
}

static void require(const char *path, const cJSON *definition, const char *name) {
  if (!cJSON_HasObjectItem(cJSON_GetObjectItemCaseSensitive(definition, "properties"), name))
    fail_msg("%s lacks %s", path, name);
  if (!has_word(cJSON_GetObjectItemCaseSensitive(definition, "required"), name))
    fail_msg("%s: `required` lacks %s", path, name);
}

/* Every bump has every row; `forming` writes those with an uncertainty, and none of the u_. */
static void schemas_require_every_row_of_bumps(void **state) {
  (void)state;
  static const char measure[] = "reports/schema/measure.schema.json";
  static const char forming[] = "reports/schema/form.schema.json";
  cJSON *of_measure = load_schema(measure), *of_forming = load_schema(forming);
  const cJSON *bump = cJSON_GetObjectItemCaseSensitive(
      cJSON_GetObjectItemCaseSensitive(of_measure, "$defs"), "bump");
  const cJSON *list = cJSON_GetObjectItemCaseSensitive(
      cJSON_GetObjectItemCaseSensitive(of_forming, "properties"), "bumps");
  const cJSON *formed_bump = cJSON_GetObjectItemCaseSensitive(list, "items");
  size_t count;
  const fg_quantity *rows = fg_quantities(FG_QUANTITY_OF_BUMP, &count);
  for (size_t i = 0; i < count; i++) {
    char u_name[96];
    snprintf(u_name, sizeof u_name, "u_%s", rows[i].name);
    require(measure, bump, rows[i].name);
    if (!fg_quantity_has_u(&rows[i])) continue;
    require(measure, bump, u_name);
    if (rows[i].kind == FG_QUANTITY_NUMBER) require(forming, formed_bump, rows[i].name);
  }
  cJSON_Delete(of_measure);
  cJSON_Delete(of_forming);
}

/* ---- lots ---- */

static void lots_know_every_row(void **state) {
  (void)state;
  enum { FOILS = 3, BUMPS = 3 };
  fg_context ctx = {0};
  fg_design design = synthetic_design();
  design.bumps.count = BUMPS;
  fg_lot lot = made_lot(&design, FOILS, BUMPS, "", NULL);
  for (size_t f = 0; f < FOILS; f++)
    for (size_t b = 0; b < BUMPS; b++)
      made_bump(&lot, f, b, 3.3 + 0.01 * (double)(f + b), 63 - 0.1 * (double)f);
  fg_lot_analysis analysis = {0};
  if (fg_lot_analyse(&ctx, &lot, &analysis) != FG_OK) fail_msg("%s", ctx.message);
  static const fg_quantity_owner owners[] = {FG_QUANTITY_OF_BUMP, FG_QUANTITY_OF_FOIL};
  for (size_t o = 0; o < 2; o++) {
    size_t count;
    const fg_quantity *rows = fg_quantities(owners[o], &count);
    for (size_t i = 0; i < count; i++) {
      bool wanted = rows[i].uses & FG_QUANTITY_IN_LOT &&
                    fg_quantity_applies(owners[o], &rows[i], design.kind);
      if (wanted != (fg_lot_find_quantity(&analysis, rows[i].name) != NULL))
        fail_msg("statistics of %s in a lot", rows[i].name);
    }
  }
  size_t count;
  fg_characteristic *list = NULL;
  assert_ok(&ctx, fg_characteristics_list(&ctx, &analysis, &list, &count));
  for (size_t o = 0; o < 2; o++) {
    size_t rows_count;
    const fg_quantity *rows = fg_quantities(owners[o], &rows_count);
    for (size_t i = 0; i < rows_count; i++) {
      size_t exported = 0;
      for (size_t k = 0; k < count; k++)
        exported += list[k].row == &rows[i];
      size_t wanted = owners[o] == FG_QUANTITY_OF_BUMP ? BUMPS : 1;
      bool applies = fg_quantity_applies(owners[o], &rows[i], design.kind);
      assert_int_equal(exported, rows[i].characteristic && applies ? wanted : 0);
    }
  }
  free(list);
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
}

/* ---- tables ---- */

static void tables_tell_results_from_causes(void **state) {
  (void)state;
  static const char *const results[] = {"radius_mm",
                                        "bump_radius_mm",
                                        "overall_radius_mm",
                                        "overall.radius_mm",
                                        "u_radius_mm",
                                        "u_height_mm",
                                        "springback_error_pct",
                                        "rms_um",
                                        "overall.u_radius_mm",
                                        "diameter_mm",
                                        "roundness_um",
                                        "u_centre_x_mm",
                                        "bump_angle_deg",
                                        "bump_bump_angle_deg",
                                        "arc_end_mm",
                                        "points",
                                        "overall.points",
                                        "normalised_stiffness",
                                        "verdict",
                                        "flags"};
  static const char *const causes[] = {"thickness_mm", "position_deg", "centre_x_mm", "die",
                                       "temp_C",       "angle_deg",    "height",      "u_"};
  for (size_t i = 0; i < sizeof results / sizeof *results; i++)
    if (!fg_quantity_is_result(results[i])) fail_msg("%s is taken for a cause", results[i]);
  for (size_t i = 0; i < sizeof causes / sizeof *causes; i++)
    if (fg_quantity_is_result(causes[i])) fail_msg("%s is taken for a result", causes[i]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_format_is_complete),
      cmocka_unit_test(names_of_quantities_are_unique),
      cmocka_unit_test(every_use_has_room),
      cmocka_unit_test(a_calibration_has_room_for_every_row),
      cmocka_unit_test(reports_hold_every_row),
      cmocka_unit_test(reports_hold_every_row_of_arcs),
      cmocka_unit_test(reports_hold_every_row_of_discs),
      cmocka_unit_test(schemas_know_every_row),
      cmocka_unit_test(schemas_require_every_row_of_bumps),
      cmocka_unit_test(lots_know_every_row),
      cmocka_unit_test(tables_tell_results_from_causes),
  };
  return cmocka_run_group_tests_name("quantity", tests, NULL, NULL);
}
