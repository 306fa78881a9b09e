/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tone, sharpening and blur of a check against its baseline: what has changed is told, what only
 * scatters is not, and a state that was kept reads as it was. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "station/check_state.h"
#include "station/database.h"
#include "support/test.h"

enum { LEVEL = 0, BLUR = 1 };

static fg_check_state unknown(int64_t dpi) {
  fg_check_state state = {.dpi = dpi};
  for (size_t k = 0; k < FG_CHECK_QUANTITIES; k++)
    state.value[k] = state.u[k] = NAN;
  return state;
}

static size_t find(const char *name) {
  for (size_t k = 0; k < FG_CHECK_QUANTITIES; k++)
    if (!strcmp(fg_check_quantities[k].name, name)) return k;
  fail_msg("no quantity %s", name);
  return 0;
}

static void set(fg_check_state *state, const char *name, double value, double u) {
  state->value[find(name)] = value;
  state->u[find(name)] = u;
}

static void a_change_counts_beyond_scatter_and_what_matters(void **state) {
  char words[600];
  fg_check_state baseline = unknown(2400), now = unknown(2400);
  (void)state;
  set(&baseline, "level_um", 0.1, 0.05);
  set(&now, "level_um", 0.34, 0.05); /* matters from 0.25 on */
  assert_int_equal(fg_check_state_compare(&now, &baseline, words, sizeof words), 0);
  assert_string_equal(words, "");
  set(&now, "level_um", 0.36, 0.05);
  assert_int_equal(fg_check_state_compare(&now, &baseline, words, sizeof words), 1);
  assert_has(words, "outwards 0.36 µm (was 0.10, allowed ± 0.25)");
  set(&now, "level_um", -0.16, 0.05);
  assert_int_equal(fg_check_state_compare(&now, &baseline, words, sizeof words), 1);
  set(&now, "level_um", 0.8, 0.3); /* 3 sd of 0.304 are 0.91 */
  assert_int_equal(fg_check_state_compare(&now, &baseline, words, sizeof words), 0);
}

static void unknown_members_are_not_compared(void **state) {
  char words[600];
  fg_check_state baseline = unknown(2400), now = unknown(2400);
  (void)state;
  set(&now, "overshoot", 0.3, 0.001);
  assert_int_equal(fg_check_state_compare(&now, &baseline, words, sizeof words), 0);
  set(&baseline, "overshoot", 0.001, 0.001);
  assert_int_equal(fg_check_state_compare(&now, &baseline, words, sizeof words), 1);
  now = unknown(2400);
  assert_int_equal(fg_check_state_compare(&now, &baseline, words, sizeof words), 0);
}

static void a_blur_may_change_by_a_tenth(void **state) {
  char words[600];
  fg_check_state baseline = unknown(1200), now = unknown(1200);
  (void)state;
  set(&baseline, "blur_um", 20, 0.1);
  set(&now, "blur_um", 21.9, 0.1);
  assert_int_equal(fg_check_state_compare(&now, &baseline, words, sizeof words), 0);
  set(&now, "blur_um", 17.9, 0.1);
  assert_int_equal(fg_check_state_compare(&now, &baseline, words, sizeof words), 1);
}

static void a_new_finding_is_a_change_and_one_that_was_there_is_none(void **state) {
  char words[600], narrow[12];
  fg_check_state baseline = unknown(1200), now = unknown(1200);
  (void)state;
  now.findings = baseline.findings = FG_PICTURE_SHARPENED;
  assert_int_equal(fg_check_state_compare(&now, &baseline, words, sizeof words), 0);
  now.findings |= FG_PICTURE_BLOCK_NOISE | FG_PICTURE_CLIPPED;
  assert_int_equal(fg_check_state_compare(&now, &baseline, words, sizeof words), 2);
  assert_string_equal(words, "clipped_levels, block_noise");
  assert_int_equal(fg_check_state_compare(&now, &baseline, narrow, sizeof narrow), 2);
  now.findings = 0;
  assert_int_equal(fg_check_state_compare(&now, &baseline, words, sizeof words), 0);
  /* The quantity of a threshold decides, with its scatter, where it is known. */
  baseline.findings = 0;
  now.findings = FG_PICTURE_UNEVEN_BLUR;
  assert_int_equal(fg_check_state_compare(&now, &baseline, words, sizeof words), 1);
  set(&baseline, "uneven_blur", 1.05, 0.01);
  set(&now, "uneven_blur", 1.1, 0.01);
  assert_int_equal(fg_check_state_compare(&now, &baseline, words, sizeof words), 0);
  /* A quantity without an uncertainty tells nothing. */
  set(&now, "uneven_blur", 3, NAN);
  now.findings = 0;
  assert_int_equal(fg_check_state_compare(&now, &baseline, words, sizeof words), 0);
}

/* A mean over whole discs, with its scatter from disc to disc. */
static void the_state_is_of_the_discs(void **state) {
  fg_disc discs[4] = {{.blur_um = 10, .coverage_deg = 360},
                      {.blur_um = 12, .coverage_deg = 360},
                      {.blur_um = 11, .coverage_deg = 360},
                      {.blur_um = 99, .coverage_deg = 90}};
  const fg_measurement measurement = {
      .dpi = {2400.2, 2400.2}, .discs = discs, .disc_count = 4, .picture = fg_picture_unknown()};
  const fg_check_fit fit = {.level_um = -0.5, .u_level_um = 0.1};
  fg_check_state found;
  (void)state;
  for (int i = 0; i < 4; i++)
    discs[i].picture = fg_picture_unknown();
  discs[0].picture.overshoot = 0.02;
  fg_check_state_find(&measurement, &fit, &found);
  assert_int_equal(found.dpi, 2400);
  assert_float_equal(found.value[BLUR], 11, 1e-12);
  assert_float_equal(found.u[BLUR], 1, 1e-12);
  assert_float_equal(found.value[LEVEL], -0.5, 0);
  assert_float_equal(found.u[LEVEL], 0.1, 0);
  assert_float_equal(found.value[find("overshoot")], 0.02, 0);
  assert_float_equal(found.u[find("overshoot")], 0, 0);
  assert_true(isnan(found.value[find("gamma")]));
}

static void add_check(sqlite3 *writer, int id, int baseline, const fg_check_state *state) {
  fg_context ctx = {0};
  char sql[300];
  snprintf(sql, sizeof sql,
           "INSERT INTO checks (id, at, path, sha256, discs, verdict, words, baseline)"
           " VALUES (%d, %d000, 'c', 's%d', 4, 'pass', '', %d)",
           id, id, id, baseline);
  if (fg_sql_run(&ctx, writer, sql) != FG_OK ||
      fg_check_state_keep(&ctx, writer, id, state) != FG_OK)
    fail_msg("%s", ctx.message);
}

static void a_state_that_is_kept_reads_as_it_was(void **state) {
  fg_context ctx = {0};
  char folder[] = "/tmp/foilgauge_state_XXXXXX", path[64];
  fg_station_database database;
  fg_check_state kept = unknown(2400), read;
  int64_t at;
  (void)state;
  assert_non_null(mkdtemp(folder));
  assert_ok(&ctx, fg_station_database_open(&ctx, folder, &database));
  set(&kept, "blur_um", 11.0625, 0.03);
  set(&kept, "tone_s", -0.25, 0);
  kept.findings = FG_PICTURE_SHADOW | FG_PICTURE_SHADING | FG_PICTURE_ROW_JUMPS;
  add_check(database.writer, 1, 0, &kept);
  assert_ok(&ctx, fg_check_state_baseline(&ctx, database.writer, 2400, &at, &read));
  assert_int_equal(at, 0);
  kept.value[BLUR] = 9;
  add_check(database.writer, 2, 1, &kept);
  kept.dpi = 1200;
  add_check(database.writer, 3, 1, &kept);
  assert_ok(&ctx, fg_check_state_baseline(&ctx, database.writer, 2400, &at, &read));
  assert_int_equal(at, 2000);
  assert_int_equal(read.dpi, 2400);
  assert_int_equal(read.findings, kept.findings);
  for (size_t k = 0; k < FG_CHECK_QUANTITIES; k++) {
    assert_true(isnan(kept.value[k]) ? isnan(read.value[k]) : read.value[k] == kept.value[k]);
    assert_true(isnan(kept.value[k]) || read.u[k] == kept.u[k]);
  }
  assert_ok(&ctx, fg_check_state_baseline(&ctx, database.writer, 600, &at, &read));
  assert_int_equal(at, 0);
  fg_station_database_close(&database);
  snprintf(path, sizeof path, "%s/foilgauge.sqlite", folder);
  unlink(path);
  rmdir(folder);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_change_counts_beyond_scatter_and_what_matters),
      cmocka_unit_test(unknown_members_are_not_compared),
      cmocka_unit_test(a_blur_may_change_by_a_tenth),
      cmocka_unit_test(a_new_finding_is_a_change_and_one_that_was_there_is_none),
      cmocka_unit_test(the_state_is_of_the_discs),
      cmocka_unit_test(a_state_that_is_kept_reads_as_it_was),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
