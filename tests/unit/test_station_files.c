/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A station's files: when nobody writes to one any more, whatever clocks say; what a lot's folder
 * is called. */
#include <string.h>

#include "core/utf8.h"
#include "station/file_stability.h"
#include "station/lot_folder.h"
#include "station/naming.h"
#include "support/test.h"

#define SECOND INT64_C(1000000000)

static bool look(fg_file_stability *rest, const char *name, int64_t bytes, int64_t modified_ns,
                 int64_t now_ns) {
  fg_context ctx;
  fg_stable_file *file;
  assert_ok(&ctx, fg_file_stability_note(&ctx, rest, name, bytes, modified_ns, now_ns, &file));
  return now_ns - file->since_ns >= FG_STABLE_NS;
}

static void test_a_file_is_stable_when_it_stays_the_same(void **state) {
  fg_file_stability rest = {0};
  (void)state;
  assert_false(look(&rest, "a", 10, 5, 0));
  assert_false(look(&rest, "a", 10, 5, SECOND));
  assert_false(look(&rest, "a", 20, 5, 2 * SECOND)); /* it grew */
  assert_false(look(&rest, "a", 20, 5, 3 * SECOND));
  assert_false(look(&rest, "a", 20, 6, 4 * SECOND)); /* written to in place */
  assert_false(look(&rest, "b", 20, 6, 5 * SECOND));
  assert_true(look(&rest, "a", 20, 6, 6 * SECOND));
  assert_true(look(&rest, "b", 20, 6, 7 * SECOND));
  fg_file_stability_free(&rest);
}

/* The file server's clock is a year ahead, an hour behind, or set back between two writes. */
static void test_clocks_of_files_say_nothing(void **state) {
  static const int64_t times[] = {365 * 86400 * SECOND, -3600 * SECOND, 0, -86400 * SECOND};
  fg_file_stability rest = {0};
  (void)state;
  for (size_t i = 0; i < sizeof times / sizeof *times; i++)
    assert_false(look(&rest, "a", 10, times[i], (int64_t)i * SECOND));
  assert_true(look(&rest, "a", 10, times[3], 5 * SECOND));
  fg_file_stability_free(&rest);
}

static void test_removed_files_are_forgotten(void **state) {
  fg_file_stability rest = {0};
  (void)state;
  look(&rest, "a", 10, 5, 0);
  look(&rest, "b", 10, 5, 0);
  fg_file_stability_end_round(&rest);
  look(&rest, "b", 10, 5, SECOND);
  fg_file_stability_end_round(&rest);
  assert_int_equal(rest.count, 1);
  assert_false(look(&rest, "a", 10, 5, 9 * SECOND)); /* another file of that name */
  assert_true(look(&rest, "b", 10, 5, 9 * SECOND));
  fg_file_stability_free(&rest);
}

static void test_folders_of_lots(void **state) {
  static const char *const lots[][2] = {
      {"", "without_lot"},
      {"without_lot", "%77ithout_lot"},
      {"2026-03 A", "2026-03 A"},
      {"a/b", "a%2Fb"},
      {"..", "%2E%2E"},
      {".", "%2E"},
      {"../../etc", "%2E.%2F..%2Fetc"},
      {"a%2Fb", "a%252Fb"},
      {"Größe", "Größe"},
      {"\xFF", "%FF"},
      {"a\nb", "a%0Ab"},
      {"end.", "end%2E"},
  };
  char name[FG_LOT_FOLDER_NAME];
  (void)state;
  for (size_t i = 0; i < sizeof lots / sizeof *lots; i++) {
    in_row("lots[%zu]", i);
    fg_lot_folder_name(lots[i][0], name);
    assert_string_equal(name, lots[i][1]);
  }
}

static void test_long_lots_stay_apart(void **state) {
  char lot[500], one[FG_LOT_FOLDER_NAME], other[FG_LOT_FOLDER_NAME];
  (void)state;
  memset(lot, '/', sizeof lot);
  lot[sizeof lot - 1] = '\0';
  fg_lot_folder_name(lot, one);
  lot[sizeof lot - 2] = 'x';
  fg_lot_folder_name(lot, other);
  assert_string_not_equal(one, other);
  assert_true(strlen(one) < 255 && !strchr(one, '/'));
}

static void test_names_are_text(void **state) {
  fg_named named;
  char file[400] = "A\xFF\n-";
  (void)state;
  assert_true(fg_naming_split("{lot}-{serial}", "A\xFF\n-b.png", &named));
  assert_string_equal(named.lot, "A\xEF\xBF\xBD\xEF\xBF\xBD~6e91b61a"); /* of its bytes */
  assert_string_equal(named.serial, "b");
  for (int i = 0; i < 60; i++) /* cut off between characters, never in one */
    strcat(file, "\xE2\x82\xAC");
  assert_true(fg_naming_split("{lot}-{serial}", file, &named));
  assert_true(fg_utf8_is_valid(named.serial));
  assert_true(strlen(named.serial) <= 127 && strchr(named.serial, '~'));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_a_file_is_stable_when_it_stays_the_same),
      cmocka_unit_test(test_clocks_of_files_say_nothing),
      cmocka_unit_test(test_removed_files_are_forgotten),
      cmocka_unit_test(test_folders_of_lots),
      cmocka_unit_test(test_long_lots_stay_apart),
      cmocka_unit_test(test_names_are_text),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
