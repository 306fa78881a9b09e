/* SPDX-License-Identifier: GPL-3.0-or-later */
/* File names against patterns: the answer of every pattern that backtracks, without its time. */
#include <stdio.h>
#include <string.h>

#include "station/naming.h"
#include "support/random.h"
#include "support/test.h"

enum { NAME = 250, RANDOM = 200000 };

/* The definition: every length of every open place is tried, the shortest first. `place`: where
 * each ends. */
static bool match_slowly(const char *pattern, const char *name, const char **place) {
  while (*pattern && *pattern != '{' && *pattern != '*')
    if (*pattern++ != *name++) return false;
  if (!*pattern) return !*name;
  const char *next = *pattern == '{' ? strchr(pattern, '}') + 1 : pattern + 1;
  for (const char *end = name + (*pattern == '{');; end++) {
    if (end > name && !end[-1]) return false;
    if (!match_slowly(next, end, place + 2)) continue;
    place[0] = name;
    place[1] = end;
    return true;
  }
}

/* Texts of so few letters that they are found in many places. */
static void make_text(uint64_t *seed, int longest, char *text) {
  int length = (int)(random_uniform(seed) * (longest + 1));
  for (int i = 0; i < length; i++)
    text[i] = "_a-"[(int)(3 * random_uniform(seed) * random_uniform(seed))];
  text[length] = '\0';
}

static void make_pattern(uint64_t *seed, char *pattern) {
  static const char *const open[] = {"{serial}", "*", "{lot}", "*", "{die}", "*"};
  size_t count = (size_t)(6 * random_uniform(seed)) + 1;
  make_text(seed, 2, pattern);
  for (size_t i = 0; i < count; i++) {
    if (i && !pattern[strlen(pattern) - 1]) return;
    strcat(pattern, open[i]);
    char text[4] = "";
    make_text(seed, 2, text);
    if (i + 1 < count && !text[0]) strcpy(text, "_");
    strcat(pattern, text);
  }
}

/* The value of the first field called `field`, from the places of the pattern's open places. */
static void check_field(const char *pattern, const char **place, const char *field,
                        const char *value) {
  const char *at = strstr(pattern, field);
  if (!at) return;
  size_t k = 0;
  for (const char *before = pattern; before < at; before++)
    k += *before == '{' || *before == '*';
  size_t length = (size_t)(place[2 * k + 1] - place[2 * k]);
  if (strlen(value) != length || strncmp(value, place[2 * k], length) != 0)
    fail_msg("'%s': %s is '%s'", pattern, field, value);
}

static void test_as_defined(void **state) {
  uint64_t seed = 7;
  (void)state;
  int fits = 0;
  for (int i = 0; i < RANDOM; i++) {
    char pattern[200], name[20];
    const char *place[16];
    fg_named named;
    make_pattern(&seed, pattern);
    make_text(&seed, 12, name);
    if (!name[0]) continue;
    bool expected = match_slowly(pattern, name, place);
    if (fg_naming_split(pattern, name, &named) != expected)
      fail_msg("'%s' as '%s' %s", name, pattern, expected ? "fits" : "does not fit");
    if (!expected) continue;
    fits++;
    check_field(pattern, place, "{serial}", named.serial);
    check_field(pattern, place, "{lot}", named.lot);
    check_field(pattern, place, "{die}", named.die);
  }
  assert_true(fits > RANDOM / 20);
}

/* Whoever tries every length of every open place needs longer than this universe has been there. */
static void test_long_names(void **state) {
  static const char *const patterns[] = {
      "{serial}_{lot}_{die}_{operator}_{check}x",
      "*_*_*_*_*_*_*_*_*_*_*_*_*_*_*_*_*_*_*_*x",
      "*__*__*__*__*__*__*__*__*__*__*__*__*__*x{serial}",
      "{serial}_*_*_*_*_*_*_*_*_*_*_*_*_*_*_*_x",
  };
  char name[NAME + 1];
  (void)state;
  memset(name, '_', NAME);
  name[NAME] = '\0';
  for (size_t i = 0; i < sizeof patterns / sizeof *patterns; i++) {
    in_row("patterns[%zu]", i);
    fg_context ctx;
    fg_named named;
    assert_ok(&ctx, fg_naming_check(&ctx, patterns[i]));
    assert_false(fg_naming_split(patterns[i], name, &named));
    assert_int_equal(strlen(named.serial), FG_NAMED_TEXT - 1);
    assert_string_equal(named.lot, "");
  }
}

/* Names that differ behind the longest text, or in bytes that are no text, are foils of their own.
 */
static void test_alike_names(void **state) {
  (void)state;
  fg_named one, other;
  char name[NAME + 1], alike[NAME + 1];
  memset(name, 'a', NAME);
  name[FG_NAMED_TEXT - 1] = '\0';
  assert_true(fg_naming_split("{serial}", name, &one));
  assert_string_equal(one.serial, name);
  name[FG_NAMED_TEXT - 1] = 'b';
  name[FG_NAMED_TEXT] = '\0';
  memcpy(alike, name, sizeof name);
  alike[FG_NAMED_TEXT - 1] = 'c';
  fg_naming_split("{serial}", name, &one);
  fg_naming_split("{serial}", alike, &other);
  assert_int_equal(strlen(one.serial), FG_NAMED_TEXT - 1);
  assert_string_not_equal(one.serial, other.serial);
  fg_naming_split("{serial}", name, &other);
  assert_string_equal(one.serial, other.serial);
  fg_naming_split("{serial}", "foil\xE4", &one);
  fg_naming_split("{serial}", "foil\xF6", &other);
  assert_string_not_equal(one.serial, other.serial);
  assert_int_equal(strncmp(one.serial, "foil\xEF\xBF\xBD~", 8), 0);
  fg_naming_split("{serial}", "foil\xC3\xA4", &one);
  assert_string_equal(one.serial, "foil\xC3\xA4");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_as_defined),
      cmocka_unit_test(test_long_names),
      cmocka_unit_test(test_alike_names),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
