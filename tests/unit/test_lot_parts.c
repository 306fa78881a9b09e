/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Manifests, recipes and records of a lot. */
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "foilgauge/lot.h"
#include "lot/input/manifest.h"
#include "lot/run/journal.h"
#include "lot/run/record.h"
#include "lot/run/seal.h"
#include "support/synthetic_foil.h"
#include "support/test.h"

static void a_written_manifest_reads_back_equal(void **state) {
  (void)state;
  fg_context ctx;
  fg_manifest manifest = {0}, again = {0};
  const char *text =
      "\xEF\xBB\xBF"
      "foil;scan;die\r\n007;\"a;b \"\"c\"\".png\";A\r\n;;\r\n<b>&\xC3\xA4;/x/y.png;\r\n";
  assert_ok(&ctx, fg_manifest_parse(&ctx, "m.csv", text, "dir", &manifest));
  assert_int_equal(manifest.items, 2);
  assert_string_equal(fg_manifest_scan(&manifest, 0), "dir/a;b \"c\".png");
  assert_string_equal(fg_manifest_scan(&manifest, 1), "/x/y.png");
  assert_string_equal(fg_manifest_label(&manifest, 0), "007");
  size_t die = fg_manifest_column(&manifest, "die");
  assert_string_equal(fg_manifest_cell(&manifest, 0, die), "A");
  assert_string_equal(fg_manifest_cell(&manifest, 1, die), "");
  char *first, *second;
  assert_ok(&ctx, fg_manifest_format(&ctx, &manifest, &first));
  assert_ok(&ctx, fg_manifest_parse(&ctx, "m.csv", first, "", &again));
  assert_ok(&ctx, fg_manifest_format(&ctx, &again, &second));
  assert_string_equal(first, second);
  free(first);
  free(second);
  fg_manifest_free(&manifest);
  fg_manifest_free(&again);
}

/* Numbers with decimal commas get points; names that hold commas stay. */
static void manifest_numbers_get_points(void **state) {
  (void)state;
  fg_context ctx;
  fg_manifest manifest = {0};
  const char *text =
      "sep=;\r\nscan;coil_mm;name;mixed\r\na,5.png;0,102;a,1;0,5\r\nb.png;1;2,5;1.5\r\n"
      "c.png;;3;\r\n";
  assert_ok(&ctx, fg_manifest_parse(&ctx, "m.csv", text, "dir", &manifest));
  assert_int_equal(manifest.items, 3);
  assert_string_equal(fg_manifest_scan(&manifest, 0), "dir/a,5.png");
  assert_string_equal(fg_manifest_cell(&manifest, 0, 1), "0.102");
  assert_string_equal(fg_manifest_cell(&manifest, 1, 1), "1");
  assert_string_equal(fg_manifest_cell(&manifest, 1, 2), "2,5");
  assert_string_equal(fg_manifest_cell(&manifest, 0, 3), "0,5");
  fg_manifest_free(&manifest);
}

static void bad_manifests_say_why(void **state) {
  (void)state;
  static const struct {
    const char *text, *words;
  } bad[] = {
      {"", "empty"},
      {"foil,die\n1,2\n", "no column `scan`"},
      {"scan,scan\na,b\n", "twice"},
      {"scan,foil\na.png,1,2\n", "more cells"},
      {"scan,foil\n,1\n", "names no scan"},
      {"scan\n\"a.png\n", "quote"},
  };
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    in_row("bad[%zu]", i);
    fg_context ctx = {""};
    fg_manifest manifest = {0};
    assert_status(&ctx, fg_manifest_parse(&ctx, "m.csv", bad[i].text, "", &manifest), FG_ERR_DATA);
    if (!strstr(ctx.message, bad[i].words)) fail_msg("'%s' lacks '%s'", ctx.message, bad[i].words);
    fg_manifest_free(&manifest);
  }
}

static void a_written_recipe_reads_back_equal(void **state) {
  (void)state;
  fg_context ctx;
  fg_lot_settings settings, again;
  fg_lot_settings_default(&settings);
  strcpy(settings.name, "a \"lot\" <1> \xC3\xA4");
  settings.jobs = 3;
  settings.run_rules = 0x81;
  settings.bandwidth = FG_BANDWIDTH_SHEATHER_JONES;
  settings.seed = 9007199254740991;
  settings.material.friction = 0.25;
  settings.assembly.bearings = 0;
  settings.assembly.seed = 77;
  settings.design.tolerance_count = 1;
  strcpy(settings.design.calibration.not_needed, "made up");
  settings.design.tolerances[0] = (fg_tolerance){"height_mm", 0.5, INFINITY};
  char *text, *second;
  assert_ok(&ctx, fg_lot_settings_format(&ctx, &settings, true, &text));
  fg_lot_settings_default(&again);
  assert_ok(&ctx, fg_lot_settings_parse(&ctx, "r.json", text, &again));
  assert_int_equal(again.jobs, 3);
  assert_int_equal(again.run_rules, 0x81);
  assert_int_equal(again.assembly.bearings, 0);
  assert_true(again.assembly.seed == 77);
  assert_true(again.seed == settings.seed);
  assert_ok(&ctx, fg_lot_settings_format(&ctx, &again, true, &second));
  assert_string_equal(text, second);
  free(text);
  free(second);
  assert_ok(&ctx, fg_lot_settings_format(&ctx, &again, false, &text));
  assert_has_not(text, "jobs");
  free(text);
}

static void bad_recipes_say_why(void **state) {
  (void)state;
  static const struct {
    const char *members, *words;
  } bad[] = {
      {"\"padz\": 3", "padz is not known; there are schema, name, model"},
      {"\"pads\": 0", "pads is 0"},
      {"\"pads\": 2.5", "whole number"},
      {"\"pads\": \"3\"", "must be a number"},
      {"\"pads\": 90, \"bumps_per_pad\": 90", "at most"},
      {"\"run_rules\": [9]", "run_rules is 9"},
      {"\"bandwidth\": \"wide\"", "silverman"},
      {"\"pads\": 3, \"pads\": 3", "twice"},
      {"\"friction\": -0.1", "friction is -0.1"},
      {"\"design\": {\"schema\": \"foilgauge/design/1\", \"form\": \"discs\"}", "made of foils"},
      {"\"assembly\": 5", "must be an object"},
      {"\"assembly\": {\"bearings\": -1}", "assembly.bearings is -1"},
      {"\"assembly\": {\"bearings\": 1e9}", "from 0 to 100000"},
      {"\"assembly\": {\"bearings\": 2.5}", "whole number"},
      {"\"assembly\": {\"seed\": -1}", "assembly.seed is -1"},
      {"\"assembly\": {\"seed\": null}", "assembly.seed must be a number"},
      {"\"assembly\": {\"baerings\": 1}",
       "assembly.baerings is not known; there are bearings, seed, design_deviation_pct"},
      {"\"assembly\": {\"seed\": 1, \"seed\": 1}", "assembly.seed is given twice"},
  };
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    in_row("bad[%zu]", i);
    fg_context ctx = {""};
    fg_lot_settings settings;
    char text[300];
    fg_lot_settings_default(&settings);
    snprintf(text, sizeof text, "{\"schema\": \"foilgauge/recipe/1\", %s}", bad[i].members);
    assert_status(&ctx, fg_lot_settings_parse(&ctx, "r.json", text, &settings), FG_ERR_DATA);
    if (!strstr(ctx.message, bad[i].words)) fail_msg("'%s' lacks '%s'", ctx.message, bad[i].words);
  }
}

/* Every row of the quantities survives; a value that is not known stays unknown. */
static void record_keeps_every_field(void **state) {
  (void)state;
  fg_context ctx;
  fg_design design = synthetic_design();
  fg_measurement measurement = synthetic_measurement(&design);
  measurement.foils[0].flags = FG_FOIL_NO_LIP | FG_FOIL_ROUGH_EDGE;
  measurement.foils[0].bumps[3].flags = FG_BUMP_NOT_FITTED;
  measurement.foils[0].bumps[3].height_mm = NAN;
  fg_record record = {.scan = (char[]){"a \"b\" <c>.png"}}, back;
  memset(record.sha256, 'a', 64);
  memset(record.measured_with, 'b', 64);
  char *line;
  size_t length;
  assert_ok(&ctx, fg_record_format(&ctx, &record, &measurement, &line, &length));
  assert_int_equal(strlen(line), length);
  assert_ptr_equal(strchr(line, '\n'), line + length - 1);
  assert_ok(&ctx, fg_record_parse(&ctx, line, &back));
  assert_string_equal(back.scan, record.scan);
  assert_null(back.error);
  assert_int_equal(back.foil_count, 1);
  assert_int_equal(back.foils[0].flags, measurement.foils[0].flags);
  assert_int_equal(back.foils[0].bump_count, SYNTHETIC_BUMPS);
  size_t count;
  const fg_quantity *fields = fg_quantities(FG_QUANTITY_OF_BUMP, &count);
  for (size_t b = 0; b < SYNTHETIC_BUMPS; b++)
    for (size_t i = 0; i < count; i++) {
      double was = fg_quantity_value(&fields[i], &measurement.foils[0].bumps[b]);
      double is = fg_quantity_value(&fields[i], &back.foils[0].bumps[b]);
      if (isnan(was) != isnan(is) || fabs(was - is) > 1e-9 * fabs(was))
        fail_msg("%s: %.12g became %.12g", fields[i].name, was, is);
      was = fg_quantity_uncertainty(&fields[i], &measurement.foils[0].bumps[b]);
      is = fg_quantity_uncertainty(&fields[i], &back.foils[0].bumps[b]);
      if (isnan(was) != isnan(is) || fabs(was - is) > 1e-9 * fabs(was))
        fail_msg("u of %s: %.12g became %.12g", fields[i].name, was, is);
    }
  for (size_t cut = 1; cut < length - 1; cut += length / 97) {
    char *torn = strndup(line, cut);
    fg_record nothing;
    assert_status(&ctx, fg_record_parse(&ctx, torn, &nothing), FG_ERR_DATA);
    free(torn);
  }
  fg_record_free(&back);
  free(line);
  synthetic_free(&measurement);
}

/* A line of one foil with every bump, as it stands in a journal. */
static char *line_of(const char *scan, size_t *length) {
  fg_context ctx;
  fg_design design = synthetic_design();
  fg_measurement measurement = synthetic_measurement(&design);
  fg_record record = {.scan = (char *)(uintptr_t)scan};
  char *line;
  memset(record.sha256, 'a', 64);
  memset(record.measured_with, 'b', 64);
  assert_ok(&ctx, fg_record_format(&ctx, &record, &measurement, &line, length));
  synthetic_free(&measurement);
  return line;
}

static void record_notices_every_changed_byte(void **state) {
  (void)state;
  static const unsigned char changes[] = {0x01, 0x02, 0x10, 0x20, 0x80};
  fg_context ctx;
  fg_record record;
  size_t length;
  char *line = line_of("a.png", &length);
  for (size_t i = 0; i < length; i++)
    for (size_t k = 0; k < sizeof changes; k++) {
      line[i] = (char)(line[i] ^ changes[k]);
      if (fg_record_parse(&ctx, line, &record) != FG_ERR_DATA)
        fail_msg("byte %zu of %zu changed by %02x is accepted", i, length, changes[k]);
      line[i] = (char)(line[i] ^ changes[k]);
    }
  assert_ok(&ctx, fg_record_parse(&ctx, line, &record));
  fg_record_free(&record);
  free(line);
}

/* The verdict on a line with `other` instead of `part`, sealed as if it had been written so. */
static fg_status parse_with(const char *part, const char *other) {
  fg_context ctx;
  fg_record record;
  size_t length;
  char *line = line_of("a.png", &length), *text, *at = strstr(line, part);
  assert_non_null(at);
  *strstr(line, ", \"checksum\"") = '\0';
  assert_true(asprintf(&text, "%.*s%s%s}", (int)(at - line), line, other, at + strlen(part)) > 0);
  length = strlen(text);
  assert_ok(&ctx, fg_seal_line(&ctx, &text, &length));
  fg_status status = fg_record_parse(&ctx, text, &record);
  if (status == FG_OK) fg_record_free(&record);
  free(text);
  free(line);
  return status;
}

static void record_refuses_absurd_numbers(void **state) {
  (void)state;
  static const char *const numbers[] = {"100000000", "1e8", "1e300", "-1", "2.5", "\"1\"", "null"};
  assert_ok(NULL, parse_with("\"number\": 2", "\"number\": 2"));
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
    in_row("numbers[%zu]", i);
    char other[64];
    snprintf(other, sizeof other, "\"number\": %s", numbers[i]);
    assert_status(NULL, parse_with("\"number\": 2", other), FG_ERR_DATA);
    assert_status(NULL, parse_with("\"number\": 1", other), FG_ERR_DATA);
  }
  assert_status(NULL, parse_with("\"values\": [", "\"values\": [1e999, "), FG_ERR_DATA);
}

static void record_keeps_a_name_of_any_bytes(void **state) {
  (void)state;
  static const char *const names[] = {"a\xE4.png", "a\xF6.png", "a\\xE4.png", "a\xEF\xBF\xBD.png",
                                      "\xFF\x01\n\"\\\xC3"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    in_row("names[%zu]", i);
    fg_context ctx;
    fg_record record;
    size_t length;
    char *line = line_of(names[i], &length);
    assert_true(fg_utf8_is_valid(line));
    assert_ok(&ctx, fg_record_parse(&ctx, line, &record));
    assert_string_equal(record.scan, names[i]);
    fg_record_free(&record);
    free(line);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_written_manifest_reads_back_equal),
      cmocka_unit_test(manifest_numbers_get_points),
      cmocka_unit_test(bad_manifests_say_why),
      cmocka_unit_test(a_written_recipe_reads_back_equal),
      cmocka_unit_test(bad_recipes_say_why),
      cmocka_unit_test(record_keeps_every_field),
      cmocka_unit_test(record_notices_every_changed_byte),
      cmocka_unit_test(record_refuses_absurd_numbers),
      cmocka_unit_test(record_keeps_a_name_of_any_bytes),
  };
  return cmocka_run_group_tests_name("parts of a lot", tests, NULL, NULL);
}
