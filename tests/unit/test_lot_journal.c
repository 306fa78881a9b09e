/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The journal of a lot, and who owns its folder. */
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "foilgauge/lot.h"
#include "lot/input/manifest.h"
#include "lot/run/folder_lock.h"
#include "lot/run/journal.h"
#include "lot/run/record.h"
#include "lot/run/seal.h"
#include "support/synthetic_foil.h"
#include "support/test.h"

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
  assert_ok(&ctx, fg_record_format(&ctx, &record, NULL, &line, &length));
  assert_ok(&ctx, fg_journal_append(&ctx, journal, line, length, &entry));
  free(line);
}

static fg_journal_head head_of(size_t index, size_t count) {
  fg_journal_head head = {.version = "1", .shard = {index, count}, .items = 3};
  memset(head.manifest_sha256, 'c', 64);
  memset(head.recipe_sha256, 'd', 64);
  memset(head.measured_with, 'e', 64);
  return head;
}

static void journal_drops_a_torn_last_line(void **state) {
  (void)state;
  fg_context ctx;
  char folder[] = "/tmp/foilgauge-test-XXXXXX", path[64];
  assert_non_null(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/results.jsonl", folder);
  fg_journal_head head = head_of(2, 5), read;
  const char *from[] = {path};
  fg_journal_entry none = {0};
  assert_ok(&ctx, fg_journal_rewrite(&ctx, path, &head, from, NULL, &none, 1));
  fg_journal journal;
  assert_ok(&ctx, fg_journal_open(&ctx, path, &journal));
  append(&journal, "one");
  append(&journal, "two");
  assert_ok(&ctx, fg_journal_close(&ctx, &journal));
  struct stat whole;
  assert_int_equal(stat(path, &whole), 0);
  for (off_t cut = 1; cut < 60; cut += 7) {
    seen s = {0};
    fg_journal_damage damage;
    assert_int_equal(truncate(path, whole.st_size - cut), 0);
    assert_ok(&ctx, fg_journal_read(&ctx, path, &read, &damage,
                                    &(fg_journal_visitor){.visit = note, .user = &s}));
    assert_int_equal(damage.lines, 1);
    assert_int_equal(damage.first, 3);
    assert_int_equal(s.count, 1);
    assert_string_equal(s.scans[0], "one");
    assert_int_equal(read.shard.index, 2);
    assert_int_equal(read.shard.count, 5);
  }
  assert_int_equal(truncate(path, 20), 0);
  assert_status(&ctx, fg_journal_read_head(&ctx, path, &read), FG_ERR_DATA);
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
static void journal_keeps_every_undamaged_line(void **state) {
  (void)state;
  fg_context ctx;
  char folder[] = "/tmp/foilgauge-test-XXXXXX", path[64];
  assert_non_null(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/results.jsonl", folder);
  fg_journal_head head = head_of(1, 1);
  const char *from[] = {path};
  fg_journal_entry none = {0};
  assert_ok(&ctx, fg_journal_rewrite(&ctx, path, &head, from, NULL, &none, 1));
  struct stat info;
  assert_int_equal(stat(path, &info), 0);
  off_t first = info.st_size;
  fg_journal journal;
  assert_ok(&ctx, fg_journal_open(&ctx, path, &journal));
  append(&journal, "one");
  append(&journal, "two");
  assert_ok(&ctx, fg_journal_close(&ctx, &journal));
  assert_int_equal(stat(path, &info), 0);
  off_t second = first + (info.st_size - first) / 2;
  for (off_t at = 0; at < info.st_size; at++) {
    seen s = {0};
    fg_journal_damage damage;
    bool joined = at + 1 == first || at + 1 == second; /* no newline: two lines are one */
    change_byte(path, at);
    assert_ok(&ctx, fg_journal_salvage(&ctx, path, &damage,
                                       &(fg_journal_visitor){.visit = note, .user = &s}));
    assert_int_equal(damage.lines, 1);
    assert_int_equal(damage.first, at < first ? 1 : at < second ? 2 : 3);
    assert_int_equal(s.count, (at < first ? 2 : 1) - (joined ? 1 : 0));
    change_byte(path, at);
  }
  unlink(path);
  rmdir(folder);
}

static fg_status check_order(fg_context *ctx, void *user, fg_record *record,
                             fg_journal_entry entry) {
  size_t *count = user;
  (void)ctx;
  (void)entry;
  assert_int_equal(strtoul(record->scan, NULL, 10), ++*count);
  return FG_OK;
}

/* Several batches, parsed by several threads, with a damaged line in the second. */
static void records_are_visited_in_order_by_any_number_of_threads(void **state) {
  enum { RECORDS = 700, DAMAGED = 400 };
  (void)state;
  fg_context ctx;
  char folder[] = "/tmp/foilgauge-test-XXXXXX", path[64];
  assert_non_null(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/results.jsonl", folder);
  fg_journal_head head = head_of(1, 1);
  const char *from[] = {path};
  fg_journal_entry none = {0};
  assert_ok(&ctx, fg_journal_rewrite(&ctx, path, &head, from, NULL, &none, 1));
  fg_journal journal;
  assert_ok(&ctx, fg_journal_open(&ctx, path, &journal));
  for (size_t i = 1; i <= RECORDS; i++) {
    char scan[16];
    snprintf(scan, sizeof scan, "%zu", i);
    append(&journal, scan);
    if (i != DAMAGED) continue;
    append(&journal, "a scan that is damaged");
    change_byte(path, journal.end - 10);
  }
  assert_ok(&ctx, fg_journal_close(&ctx, &journal));
  for (unsigned threads = 1; threads <= 4; threads++) {
    size_t count = 0;
    fg_journal_damage damage;
    const fg_journal_visitor by = {.visit = check_order, .user = &count, .threads = threads};
    assert_ok(&ctx, fg_journal_read(&ctx, path, &head, &damage, &by));
    assert_int_equal(count, RECORDS);
    assert_int_equal(damage.lines, 1);
    assert_int_equal(damage.first, DAMAGED + 2);
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
static void a_hole_in_the_journal_takes_no_memory(void **state) {
  (void)state;
  fg_context ctx;
  char folder[] = "/tmp/foilgauge-test-XXXXXX", path[64];
  assert_non_null(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/results.jsonl", folder);
  fg_journal_head head = head_of(1, 1);
  const char *from[] = {path};
  fg_journal_entry none = {0};
  assert_ok(&ctx, fg_journal_rewrite(&ctx, path, &head, from, NULL, &none, 1));
  struct stat info;
  assert_int_equal(stat(path, &info), 0);
  assert_int_equal(truncate(path, info.st_size + (100 << 20)), 0);
  fg_journal journal;
  assert_ok(&ctx, fg_journal_open(&ctx, path, &journal));
  append(&journal, "\n");
  append(&journal, "two");
  assert_ok(&ctx, fg_journal_close(&ctx, &journal));
  seen s = {0};
  fg_journal_damage damage;
  assert_ok(&ctx, fg_journal_salvage(&ctx, path, &damage,
                                     &(fg_journal_visitor){.visit = note, .user = &s}));
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
  assert_ok(&ctx, fg_journal_salvage(&ctx, path, &damage,
                                     &(fg_journal_visitor){.visit = note, .user = &s}));
  assert_true(damage.earlier);
  assert_status(
      &ctx,
      fg_journal_read(&ctx, path, &head, &damage, &(fg_journal_visitor){.visit = note, .user = &s}),
      FG_ERR_DATA);
  assert_has(ctx.message, "earlier version");
  write_text(path, "somebody's own text\nof two lines\n");
  assert_status(
      &ctx,
      fg_journal_salvage(&ctx, path, &damage, &(fg_journal_visitor){.visit = note, .user = &s}),
      FG_ERR_DATA);
  assert_has(ctx.message, "another folder");
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
  assert_ok(&ctx, fg_folder_lock(&ctx, folder, &first));
  assert_status(&ctx, fg_folder_lock(&ctx, folder, &second), FG_ERR_IO);
  assert_has(ctx.message, "another run");
  close(first);
  assert_ok(&ctx, fg_folder_lock(&ctx, folder, &second));
  close(second);
  snprintf(path, sizeof path, "%s/.lock", folder);
  unlink(path);
  rmdir(folder);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(journal_drops_a_torn_last_line),
      cmocka_unit_test(journal_keeps_every_undamaged_line),
      cmocka_unit_test(records_are_visited_in_order_by_any_number_of_threads),
      cmocka_unit_test(a_hole_in_the_journal_takes_no_memory),
      cmocka_unit_test(journal_knows_earlier_ones_and_other_files),
      cmocka_unit_test(folder_has_one_owner),
  };
  return cmocka_run_group_tests_name("lot journal", tests, NULL, NULL);
}
