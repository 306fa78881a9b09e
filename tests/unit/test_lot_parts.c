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
#include "lot/seal.h"

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
    assert_int_equal(fg_record_parse(&ctx, torn, &nothing), FG_ERR_DATA);
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
  assert_int_equal(fg_record_format(&ctx, &record, &measurement, &line, length), FG_OK);
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
  assert_int_equal(fg_record_parse(&ctx, line, &record), FG_OK);
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
  assert_int_equal(fg_seal_line(&ctx, &text, &length), FG_OK);
  fg_status status = fg_record_parse(&ctx, text, &record);
  if (status == FG_OK) fg_record_free(&record);
  free(text);
  free(line);
  return status;
}

static void record_refuses_absurd_numbers(void **state) {
  (void)state;
  static const char *const numbers[] = {"100000000", "1e8", "1e300", "-1", "2.5", "\"1\"", "null"};
  assert_int_equal(parse_with("\"number\": 2", "\"number\": 2"), FG_OK);
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
    char other[64];
    snprintf(other, sizeof other, "\"number\": %s", numbers[i]);
    assert_int_equal(parse_with("\"number\": 2", other), FG_ERR_DATA);
    assert_int_equal(parse_with("\"number\": 1", other), FG_ERR_DATA);
  }
  assert_int_equal(parse_with("\"values\": [", "\"values\": [1e999, "), FG_ERR_DATA);
}

static void record_keeps_a_name_of_any_bytes(void **state) {
  (void)state;
  static const char *const names[] = {"a\xE4.png", "a\xF6.png", "a\\xE4.png", "a\xEF\xBF\xBD.png",
                                      "\xFF\x01\n\"\\\xC3"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    fg_context ctx;
    fg_record record;
    size_t length;
    char *line = line_of(names[i], &length);
    assert_true(fg_utf8_is_valid(line));
    assert_int_equal(fg_record_parse(&ctx, line, &record), FG_OK);
    assert_string_equal(record.scan, names[i]);
    fg_record_free(&record);
    free(line);
  }
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
    fg_journal_damage damage;
    assert_int_equal(truncate(path, whole.st_size - cut), 0);
    assert_int_equal(fg_journal_read(&ctx, path, &read, &damage, note, &s), FG_OK);
    assert_int_equal(damage.lines, 1);
    assert_int_equal(damage.first, 3);
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

static void change_byte(const char *path, off_t at) {
  char byte;
  int file = open(path, O_RDWR);
  assert_true(file >= 0);
  assert_int_equal(pread(file, &byte, 1, at), 1);
  byte ^= 1;
  assert_int_equal(pwrite(file, &byte, 1, at), 1);
  close(file);
}

/* Two records: whatever byte of the file changes, one line is noted and the rest is kept. */
static void journal_salvages_what_is_whole(void **state) {
  (void)state;
  fg_context ctx;
  char folder[] = "/tmp/foilgauge-test-XXXXXX", path[64];
  assert_non_null(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/results.jsonl", folder);
  fg_journal_head head = head_of(1, 1);
  const char *from[] = {path};
  fg_journal_entry none = {0};
  assert_int_equal(fg_journal_rewrite(&ctx, path, &head, from, NULL, &none, 1), FG_OK);
  struct stat info;
  assert_int_equal(stat(path, &info), 0);
  off_t first = info.st_size;
  fg_journal journal;
  assert_int_equal(fg_journal_open(&ctx, path, &journal), FG_OK);
  append(&journal, "one");
  append(&journal, "two");
  assert_int_equal(fg_journal_close(&ctx, &journal), FG_OK);
  assert_int_equal(stat(path, &info), 0);
  off_t second = first + (info.st_size - first) / 2;
  for (off_t at = 0; at < info.st_size; at++) {
    seen s = {0};
    fg_journal_damage damage;
    bool joined = at + 1 == first || at + 1 == second; /* no newline: two lines are one */
    change_byte(path, at);
    assert_int_equal(fg_journal_salvage(&ctx, path, &damage, note, &s), FG_OK);
    assert_int_equal(damage.lines, 1);
    assert_int_equal(damage.first, at < first ? 1 : at < second ? 2 : 3);
    assert_int_equal(s.count, (at < first ? 2 : 1) - (joined ? 1 : 0));
    change_byte(path, at);
  }
  unlink(path);
  rmdir(folder);
}

static void write_text(const char *path, const char *text) {
  FILE *out = fopen(path, "w");
  assert_non_null(out);
  fputs(text, out);
  fclose(out);
}

/* As after a loss of power: a hole where records were. */
static void journal_takes_no_memory_for_a_hole(void **state) {
  (void)state;
  fg_context ctx;
  char folder[] = "/tmp/foilgauge-test-XXXXXX", path[64];
  assert_non_null(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/results.jsonl", folder);
  fg_journal_head head = head_of(1, 1);
  const char *from[] = {path};
  fg_journal_entry none = {0};
  assert_int_equal(fg_journal_rewrite(&ctx, path, &head, from, NULL, &none, 1), FG_OK);
  struct stat info;
  assert_int_equal(stat(path, &info), 0);
  assert_int_equal(truncate(path, info.st_size + (100 << 20)), 0);
  fg_journal journal;
  assert_int_equal(fg_journal_open(&ctx, path, &journal), FG_OK);
  append(&journal, "\n");
  append(&journal, "two");
  assert_int_equal(fg_journal_close(&ctx, &journal), FG_OK);
  seen s = {0};
  fg_journal_damage damage;
  assert_int_equal(fg_journal_salvage(&ctx, path, &damage, note, &s), FG_OK);
  assert_int_equal(damage.lines, 1);
  assert_int_equal(s.count, 1);
  assert_string_equal(s.scans[0], "two");
  unlink(path);
  rmdir(folder);
}

static void journal_knows_earlier_ones_and_other_files(void **state) {
  (void)state;
  fg_context ctx = {""};
  char folder[] = "/tmp/foilgauge-test-XXXXXX", path[64];
  seen s = {0};
  fg_journal_damage damage;
  fg_journal_head head;
  assert_non_null(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/results.jsonl", folder);
  write_text(path, "{\"schema\": \"foilgauge/results/1\"}\n{\"scan\": \"a.png\"}\n");
  assert_int_equal(fg_journal_salvage(&ctx, path, &damage, note, &s), FG_OK);
  assert_true(damage.earlier);
  assert_int_equal(fg_journal_read(&ctx, path, &head, &damage, note, &s), FG_ERR_DATA);
  assert_non_null(strstr(ctx.message, "earlier version"));
  write_text(path, "somebody's own text\nof two lines\n");
  assert_int_equal(fg_journal_salvage(&ctx, path, &damage, note, &s), FG_ERR_DATA);
  assert_non_null(strstr(ctx.message, "another folder"));
  assert_int_equal(s.count, 0);
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
      cmocka_unit_test(record_notices_every_changed_byte),
      cmocka_unit_test(record_refuses_absurd_numbers),
      cmocka_unit_test(record_keeps_a_name_of_any_bytes),
      cmocka_unit_test(journal_drops_what_is_torn),
      cmocka_unit_test(journal_salvages_what_is_whole),
      cmocka_unit_test(journal_takes_no_memory_for_a_hole),
      cmocka_unit_test(journal_knows_earlier_ones_and_other_files),
      cmocka_unit_test(folder_has_one_owner),
  };
  return cmocka_run_group_tests_name("parts of a lot", tests, NULL, NULL);
}
