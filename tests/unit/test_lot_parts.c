/* Manifests, recipes, records and the journal of a lot. */
#include <fcntl.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "../support/synthetic_foil.h"
#include "foilgauge/lot.h"
#include "lot/journal.h"
#include "lot/manifest.h"
#include "lot/record.h"

static void manifest_reads_back_what_it_writes(void **state) {
  (void)state;
  fg_context ctx;
  fg_manifest manifest = {0}, again = {0};
  const char *text =
      "\xEF\xBB\xBF"
      "foil;scan;die\r\n007;\"a;b \"\"c\"\".png\";A\r\n;;\r\n<b>&\xC3\xA4;/x/y.png;\r\n";
  assert_int_equal(fg_manifest_parse(&ctx, "m.csv", text, "dir", &manifest), FG_OK);
  assert_int_equal(manifest.items, 2);
  assert_string_equal(fg_manifest_scan(&manifest, 0), "dir/a;b \"c\".png");
  assert_string_equal(fg_manifest_scan(&manifest, 1), "/x/y.png");
  assert_string_equal(fg_manifest_label(&manifest, 0), "007");
  size_t die = fg_manifest_column(&manifest, "die");
  assert_string_equal(fg_manifest_cell(&manifest, 0, die), "A");
  assert_string_equal(fg_manifest_cell(&manifest, 1, die), "");
  char *first, *second;
  assert_int_equal(fg_manifest_format(&ctx, &manifest, &first), FG_OK);
  assert_int_equal(fg_manifest_parse(&ctx, "m.csv", first, "", &again), FG_OK);
  assert_int_equal(fg_manifest_format(&ctx, &again, &second), FG_OK);
  assert_string_equal(first, second);
  free(first);
  free(second);
  fg_manifest_free(&manifest);
  fg_manifest_free(&again);
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
    fg_context ctx = {""};
    fg_manifest manifest = {0};
    assert_int_equal(fg_manifest_parse(&ctx, "m.csv", bad[i].text, "", &manifest), FG_ERR_DATA);
    if (!strstr(ctx.message, bad[i].words)) fail_msg("'%s' lacks '%s'", ctx.message, bad[i].words);
    fg_manifest_free(&manifest);
  }
}

static void recipe_reads_back_what_it_writes(void **state) {
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
  settings.design.tolerance_count = 1;
  settings.design.tolerances[0] = (fg_tolerance){"height_mm", 0.5, INFINITY};
  char *text, *second;
  assert_int_equal(fg_lot_settings_format(&ctx, &settings, true, &text), FG_OK);
  fg_lot_settings_default(&again);
  assert_int_equal(fg_lot_settings_parse(&ctx, "r.json", text, &again), FG_OK);
  assert_int_equal(again.jobs, 3);
  assert_int_equal(again.run_rules, 0x81);
  assert_true(again.seed == settings.seed);
  assert_int_equal(fg_lot_settings_format(&ctx, &again, true, &second), FG_OK);
  assert_string_equal(text, second);
  free(text);
  free(second);
  assert_int_equal(fg_lot_settings_format(&ctx, &again, false, &text), FG_OK);
  assert_null(strstr(text, "jobs"));
  free(text);
}

static void bad_recipes_say_why(void **state) {
  (void)state;
  static const struct {
    const char *members, *words;
  } bad[] = {
      {"\"padz\": 3", "unknown member 'padz'"},
      {"\"pads\": 0", "pads is 0"},
      {"\"pads\": 2.5", "whole number"},
      {"\"pads\": \"3\"", "must be a number"},
      {"\"pads\": 90, \"bumps_per_pad\": 90", "at most"},
      {"\"run_rules\": [9]", "run_rules is 9"},
      {"\"bandwidth\": \"wide\"", "silverman"},
      {"\"pads\": 3, \"pads\": 3", "twice"},
      {"\"friction\": -0.1", "friction is -0.1"},
      {"\"design\": {\"schema\": \"foilgauge/design/1\", \"form\": \"discs\"}", "made of foils"},
  };
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    fg_context ctx = {""};
    fg_lot_settings settings;
    char text[300];
    fg_lot_settings_default(&settings);
    snprintf(text, sizeof text, "{\"schema\": \"foilgauge/recipe/1\", %s}", bad[i].members);
    assert_int_equal(fg_lot_settings_parse(&ctx, "r.json", text, &settings), FG_ERR_DATA);
    if (!strstr(ctx.message, bad[i].words)) fail_msg("'%s' lacks '%s'", ctx.message, bad[i].words);
  }
}

/* Every row of the table of fields survives; a value that is not known stays unknown. */
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
  assert_int_equal(fg_record_format(&ctx, &record, &measurement, &line, &length), FG_OK);
  assert_int_equal(strlen(line), length);
  assert_ptr_equal(strchr(line, '\n'), line + length - 1);
  assert_int_equal(fg_record_parse(&ctx, line, &back), FG_OK);
  assert_string_equal(back.scan, record.scan);
  assert_null(back.error);
  assert_int_equal(back.foil_count, 1);
  assert_int_equal(back.foils[0].flags, measurement.foils[0].flags);
  assert_int_equal(back.foils[0].bump_count, SYNTHETIC_BUMPS);
  size_t count;
  const fg_report_field *fields = fg_report_fields(FG_REPORT_BUMP, &count);
  for (size_t b = 0; b < SYNTHETIC_BUMPS; b++)
    for (size_t i = 0; i < count; i++) {
      double was = fg_report_value(&fields[i], &measurement.foils[0].bumps[b]);
      double is = fg_report_value(&fields[i], &back.foils[0].bumps[b]);
      if (isnan(was) != isnan(is) || fabs(was - is) > 1e-9 * fabs(was))
        fail_msg("%s: %.12g became %.12g", fields[i].name, was, is);
      was = fg_report_uncertainty(&fields[i], &measurement.foils[0].bumps[b]);
      is = fg_report_uncertainty(&fields[i], &back.foils[0].bumps[b]);
      if (isnan(was) != isnan(is) || fabs(was - is) > 1e-9 * fabs(was))
        fail_msg("u of %s: %.12g became %.12g", fields[i].name, was, is);
    }
  for (size_t cut = 1; cut < length - 1; cut += length / 97) {
    char *torn = strndup(line, cut);
    fg_record nothing;
    assert_int_equal(fg_record_parse(&ctx, torn, &nothing), FG_ERR_DATA);
    free(torn);
  }
  fg_record_free(&back);
  free(line);
  synthetic_free(&measurement);
}

typedef struct seen {
  char scans[8][16];
  size_t count;
} seen;

static fg_status note(fg_context *ctx, void *user, fg_record *record, fg_journal_entry entry) {
  seen *s = user;
  (void)ctx;
  (void)entry;
  snprintf(s->scans[s->count++], 16, "%s", record->scan);
  return FG_OK;
}

static void append(fg_journal *journal, const char *scan) {
  fg_context ctx;
  fg_record record = {.scan = (char *)(uintptr_t)scan, .error = (char[]){"why"}};
  fg_journal_entry entry;
  char *line;
  size_t length;
  memset(record.measured_with, 'b', 64);
  assert_int_equal(fg_record_format(&ctx, &record, NULL, &line, &length), FG_OK);
  assert_int_equal(fg_journal_append(&ctx, journal, line, length, &entry), FG_OK);
  free(line);
}

static fg_journal_head head_of(size_t index, size_t count) {
  fg_journal_head head = {.version = "1", .shard = {index, count}, .items = 3};
  memset(head.manifest_sha256, 'c', 64);
  memset(head.recipe_sha256, 'd', 64);
  memset(head.measured_with, 'e', 64);
  return head;
}

static void journal_drops_what_is_torn(void **state) {
  (void)state;
  fg_context ctx;
  char folder[] = "/tmp/foilgauge-test-XXXXXX", path[64];
  assert_non_null(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/results.jsonl", folder);
  fg_journal_head head = head_of(2, 5), read;
  const char *from[] = {path};
  fg_journal_entry none = {0};
  assert_int_equal(fg_journal_rewrite(&ctx, path, &head, from, NULL, &none, 1), FG_OK);
  fg_journal journal;
  assert_int_equal(fg_journal_open(&ctx, path, &journal), FG_OK);
  append(&journal, "one");
  append(&journal, "two");
  assert_int_equal(fg_journal_close(&ctx, &journal), FG_OK);
  struct stat whole;
  assert_int_equal(stat(path, &whole), 0);
  for (off_t cut = 1; cut < 60; cut += 7) {
    seen s = {0};
    size_t torn;
    assert_int_equal(truncate(path, whole.st_size - cut), 0);
    assert_int_equal(fg_journal_read(&ctx, path, true, &read, &torn, note, &s), FG_OK);
    assert_int_equal(torn, 1);
    assert_int_equal(s.count, 1);
    assert_string_equal(s.scans[0], "one");
    assert_int_equal(read.shard.index, 2);
    assert_int_equal(read.shard.count, 5);
  }
  assert_int_equal(truncate(path, 20), 0);
  assert_int_equal(fg_journal_read_head(&ctx, path, &read), FG_ERR_DATA);
  unlink(path);
  rmdir(folder);
}

static void folder_has_one_owner(void **state) {
  (void)state;
  fg_context ctx;
  char folder[] = "/tmp/foilgauge-test-XXXXXX", path[64];
  assert_non_null(mkdtemp(folder));
  int first, second;
  assert_int_equal(fg_folder_lock(&ctx, folder, &first), FG_OK);
  assert_int_equal(fg_folder_lock(&ctx, folder, &second), FG_ERR_IO);
  assert_non_null(strstr(ctx.message, "another run"));
  close(first);
  assert_int_equal(fg_folder_lock(&ctx, folder, &second), FG_OK);
  close(second);
  snprintf(path, sizeof path, "%s/.lock", folder);
  unlink(path);
  rmdir(folder);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(manifest_reads_back_what_it_writes),
      cmocka_unit_test(bad_manifests_say_why),
      cmocka_unit_test(recipe_reads_back_what_it_writes),
      cmocka_unit_test(bad_recipes_say_why),
      cmocka_unit_test(record_keeps_every_field),
      cmocka_unit_test(journal_drops_what_is_torn),
      cmocka_unit_test(folder_has_one_owner),
  };
  return cmocka_run_group_tests_name("parts of a lot", tests, NULL, NULL);
}
