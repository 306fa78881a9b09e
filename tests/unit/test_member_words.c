/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recipes read every member that their rows, and so the manual, list. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/station.h"
#include "lot/input/recipe_members.h"
#include "report/design/members.h"
#include "station/settings.h"
#include "support/test.h"

static fg_status parse_recipe(const char *object, const char *member, const char *value,
                              fg_lot_settings *settings, fg_context *ctx) {
  char json[400];
  snprintf(json, sizeof json, "{\"schema\": \"foilgauge/recipe/1\", %s%s%s\"%s\": %s%s}",
           *object ? "\"" : "", object, *object ? "\": {" : "", member, value, *object ? "}" : "");
  fg_lot_settings_default(settings);
  return fg_lot_settings_parse(ctx, "recipe", json, settings);
}

/* Default of a member as JSON; the caller frees. */
static char *write_default(const fg_member *row, const void *usual) {
  char *text = NULL;
  size_t size;
  fg_json json;
  FILE *out = open_memstream(&text, &size);
  assert_non_null(out);
  fg_json_begin(&json, out);
  fg_json_object(&json, NULL);
  fg_json_line(&json);
  fg_member_json(&json, row, &(fg_subject){.object = usual, .whole = usual});
  assert_int_equal(fclose(out), 0);
  const char *value = strstr(text, "\": ");
  assert_non_null(value);
  memmove(text, value + 3, strlen(value + 3) + 1);
  return text;
}

/* A default that is written out says nothing else than one that is left out. */
static void check_default(const char *object, const fg_member *row, const void *usual) {
  static fg_lot_settings settings, defaults;
  fg_context ctx = {.message = ""};
  char *value = write_default(row, usual), *a, *b;
  in_row("%s", row->name);
  assert_ok(&ctx, parse_recipe(object, row->name, value, &settings, &ctx));
  fg_lot_settings_default(&defaults);
  assert_ok(&ctx, fg_lot_settings_format(&ctx, &settings, true, &a));
  assert_ok(&ctx, fg_lot_settings_format(&ctx, &defaults, true, &b));
  assert_string_equal(a, b);
  free(a);
  free(b);
  free(value);
}

static void check_limit(const char *object, const fg_member *row) {
  static fg_lot_settings settings;
  fg_context ctx = {.message = ""};
  char value[40];
  in_row("%s", row->name);
  snprintf(value, sizeof value, "%.17g", 2 * row->highest);
  assert_status(NULL, parse_recipe(object, row->name, value, &settings, &ctx), FG_ERR_DATA);
  assert_has(ctx.message, "it must be a");
}

static size_t check_recipe(const char *object, const fg_members *members, const void *usual) {
  size_t values = 0;
  for (size_t i = 0; i < members->count; i++) {
    const fg_member *row = &members->rows[i];
    if (row->kind == FG_MEMBER_HEAD) continue;
    assert_true(row->words && strlen(row->words) > 5);
    if (row->kind == FG_MEMBER_OBJECT && !row->read)
      values += check_recipe(row->name, row->members, usual);
    if (row->kind > FG_MEMBER_WORD || row->kind == FG_MEMBER_OBJECT) continue;
    check_default(object, row, usual);
    if (row->kind <= FG_MEMBER_SEED && row->highest > row->lowest) check_limit(object, row);
    values++;
  }
  return values;
}

static void recipes_read_every_row(void **state) {
  static fg_lot_settings settings;
  fg_context ctx = {.message = ""};
  (void)state;
  assert_true(check_recipe("", &fg_recipe_members, fg_recipe_document.find_usual()) > 25);
  assert_status(NULL, parse_recipe("", "nothing_of_this_name", "1", &settings, &ctx), FG_ERR_DATA);
  assert_has(ctx.message, "nothing_of_this_name is not known; there are schema, name");
}

static fg_status load_station(const char *members, fg_context *ctx, fg_station_settings *settings) {
  char path[] = "/tmp/foilgauge-member-XXXXXX";
  int descriptor = mkstemp(path);
  FILE *out = fdopen(descriptor, "w");
  assert_non_null(out);
  fprintf(out, "{\"schema\": \"foilgauge/recipe/1\", \"station\": {%s}}", members);
  assert_int_equal(fclose(out), 0);
  fg_status status = fg_station_settings_load(ctx, path, NULL, settings);
  remove(path);
  return status;
}

static void stations_read_their_rows(void **state) {
  static const struct {
    const char *members, *words;
  } bad[] = {
      {"\"receive_s\": 3601", "station: receive_s is 3601; it must be a number from 0 to 3600"},
      {"\"check\": {\"nothing\": 1}", "check.nothing is not known; there are design, file_name"},
      {"\"check\": {\"every_h\": 1}", "check needs the design of the plate or ring"},
      {"\"check\": {\"withhold\": 1}", "check.withhold must be true or false"},
      {"\"scan_command\": \"x\"", "{file}, the scan to write, is not in it"},
      {"\"nothing\": 1", "nothing is not known; there are file_name, scan_command"},
  };
  static fg_station_settings settings;
  fg_context ctx = {.message = ""};
  (void)state;
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    in_row("bad[%zu]", i);
    assert_status(&ctx, load_station(bad[i].members, &ctx, &settings), FG_ERR_DATA);
    assert_has(ctx.message, bad[i].words);
  }
  assert_ok(&ctx, load_station("\"receive_s\": 3, \"scan_command\": \"a\\nb {file}\", \"check\": "
                               "{\"design\": \"/d.json\", \"every_h\": 8, \"withhold\": true}",
                               &ctx, &settings));
  assert_true(settings.receive_s == 3 && settings.check.every_h == 8 && settings.check.withhold);
  assert_string_equal(settings.check.design, "/d.json");
}

/* A page that is older than the code would say nothing of a new member. */
static void pages_list_the_rows(void **state) {
  static const struct {
    const fg_document *document;
    const char *page;
  } pages[] = {{&fg_recipe_document, "src/manual/text/foilgauge-recipe.5.md"},
               {&fg_station_settings_document, "src/manual/text/foilgauge-recipe.5.md"},
               {&fg_design_document, "src/manual/text/foilgauge-design.5.md"}};
  (void)state;
  for (size_t i = 0; i < sizeof pages / sizeof *pages; i++) {
    char *whole = NULL, mark[80];
    size_t size;
    FILE *out = open_memstream(&whole, &size), *in = fopen(pages[i].page, "r");
    assert_true(out && in);
    for (int c = getc(in); c != EOF; c = getc(in))
      putc(c, out);
    fclose(in);
    assert_int_equal(fclose(out), 0);
    snprintf(mark, sizeof mark, "@members_of_%s@", pages[i].document->file);
    assert_has(whole, mark);
    free(whole);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(recipes_read_every_row),
      cmocka_unit_test(stations_read_their_rows),
      cmocka_unit_test(pages_list_the_rows),
  };
  return cmocka_run_group_tests_name("member_words", tests, NULL, NULL);
}
