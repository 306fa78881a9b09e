/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The manual's words for the members of recipes and designs agree with their readers. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/json_read.h"
#include "foilgauge/lot.h"
#include "foilgauge/station.h"
#include "support/test.h"

enum { MAX = 128 };

static size_t list_members(fg_member_words_list *list_all, fg_member_words *list) {
  size_t count = list_all(list, MAX);
  assert_in_range(count, 1, MAX);
  for (size_t i = 0; i < count; i++) {
    assert_non_null(list[i].meaning);
    assert_true(strlen(list[i].meaning) > 5);
    for (size_t k = 0; k < i; k++)
      assert_string_not_equal(list[i].name, list[k].name);
  }
  return count;
}

static fg_status parse_recipe(const char *member, const char *value, fg_lot_settings *settings,
                              fg_context *ctx) {
  char json[400];
  const char *dot = strchr(member, '.');
  snprintf(json, sizeof json, "{\"schema\": \"foilgauge/recipe/1\", \"%.*s\": %s\"%s\": %s%s}",
           dot ? (int)(dot - member) : 0, member, dot ? "{" : "", dot ? dot + 1 : member, value,
           dot ? "}" : "");
  if (!dot)
    snprintf(json, sizeof json, "{\"schema\": \"foilgauge/recipe/1\", \"%s\": %s}", member, value);
  fg_lot_settings_default(settings);
  return fg_lot_settings_parse(ctx, "recipe", json, settings);
}

/* A default that is written out says nothing else than one that is left out. */
static void recipes_take_what_is_listed(void **state) {
  (void)state;
  static fg_member_words list[MAX];
  static fg_lot_settings settings, usual;
  fg_lot_settings_default(&usual);
  size_t count = list_members(fg_recipe_members, list), values = 0;
  for (size_t i = 0; i < count; i++) {
    fg_context ctx = {.message = ""};
    const char *value = list[i].usual[0] ? list[i].usual : "[]";
    if (!strcmp(list[i].name, "schema")) continue;
    fg_status status = parse_recipe(list[i].name, value, &settings, &ctx);
    assert_has_not(ctx.message, "unknown");
    if (!list[i].usual[0]) continue;
    assert_ok(NULL, status);
    char *a, *b;
    assert_ok(&ctx, fg_lot_settings_format(&ctx, &settings, true, &a));
    assert_ok(&ctx, fg_lot_settings_format(&ctx, &usual, true, &b));
    assert_string_equal(a, b);
    free(a);
    free(b);
    values++;
  }
  assert_true(values > 20);
  fg_context ctx = {.message = ""};
  assert_status(NULL, parse_recipe("nothing_of_this_name", "1", &settings, &ctx), FG_ERR_DATA);
  assert_has(ctx.message, "unknown");
}

static void recipes_refuse_what_lies_beyond(void **state) {
  (void)state;
  static fg_member_words list[MAX];
  static fg_lot_settings settings;
  size_t count = list_members(fg_recipe_members, list), limits = 0;
  for (size_t i = 0; i < count; i++) {
    double lowest, highest;
    char value[40];
    fg_context ctx = {.message = ""};
    if (sscanf(list[i].limits, "%lf to %lf", &lowest, &highest) != 2) continue;
    snprintf(value, sizeof value, list[i].usual[0] == '[' ? "[%.17g]" : "%.17g", 2 * highest);
    assert_status(NULL, parse_recipe(list[i].name, value, &settings, &ctx), FG_ERR_DATA);
    limits++;
  }
  assert_true(limits > 10);
}

static fg_status load_station(const char *member, const char *value, fg_context *ctx) {
  static fg_station_settings settings;
  char path[] = "/tmp/foilgauge-member-XXXXXX";
  int descriptor = mkstemp(path);
  FILE *out = fdopen(descriptor, "w");
  assert_non_null(out);
  bool check = !strncmp(member, "station.check.", 14);
  fprintf(out, "{\"schema\": \"foilgauge/recipe/1\", \"station\": {%s\"%s\": %s%s}}",
          check ? "\"check\": {" : "", strrchr(member, '.') + 1, value, check ? "}" : "");
  assert_int_equal(fclose(out), 0);
  fg_status status = fg_station_settings_load(ctx, path, NULL, &settings);
  remove(path);
  return status;
}

static void stations_take_what_is_listed(void **state) {
  (void)state;
  static fg_member_words list[MAX];
  size_t count = list_members(fg_station_members, list);
  for (size_t i = 0; i < count; i++) {
    fg_context ctx = {.message = ""};
    load_station(list[i].name, list[i].usual[0] ? list[i].usual : "\"x{file}\"", &ctx);
    assert_has_not(ctx.message, "unknown");
  }
  fg_context ctx = {.message = ""};
  assert_status(NULL, load_station("station.check.nothing", "1", &ctx), FG_ERR_DATA);
  assert_has(ctx.message, "there are design, file_name, every_h, scale_max_ppm");
}

/* A page that is older than the code would say nothing of a new member. */
static void the_pages_say_them(void **state) {
  (void)state;
  static const struct {
    fg_member_words_list *list;
    const char *page;
  } pages[] = {{fg_recipe_members, "@recipe_members@"},
               {fg_station_members, "@station_members@"}};
  static const char *const texts[] = {"src/manual/text/foilgauge-recipe.5.md"};
  char *whole = NULL;
  size_t size;
  FILE *out = open_memstream(&whole, &size);
  assert_non_null(out);
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
    in_row("texts[%zu]", i);
    FILE *in = fopen(texts[i], "r");
    assert_non_null(in);
    for (int c = getc(in); c != EOF; c = getc(in))
      putc(c, out);
    fclose(in);
  }
  assert_int_equal(fclose(out), 0);
  for (size_t i = 0; i < sizeof pages / sizeof *pages; i++)
    assert_has(whole, pages[i].page);
  free(whole);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(recipes_take_what_is_listed),
      cmocka_unit_test(recipes_refuse_what_lies_beyond),
      cmocka_unit_test(stations_take_what_is_listed),
      cmocka_unit_test(the_pages_say_them),
  };
  return cmocka_run_group_tests_name("member_words", tests, NULL, NULL);
}
