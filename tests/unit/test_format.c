/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A format is one row: whoever lists formats lists every row, and so do the documents. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cjson/cJSON.h>

#include "foilgauge/foil.h"
#include "lot/input/manifest.h"
#include "scan/format.h"
#include "support/test.h"

static void every_format_is_complete(void **state) {
  (void)state;
  size_t count;
  const fg_format *const *formats = fg_formats(&count);
  assert_true(count > 0);
  for (size_t i = 0; i < count; i++) {
    const fg_format *one = formats[i];
    assert_true(one->name[0]);
    assert_true(one->matches && one->has_colour && one->open && one->start);
    assert_true(one->read_row && one->finish && one->close);
    assert_non_null(one->endings[0]);
  }
}

/* Number of formats with this ending. */
static int count_ending(const char *wanted) {
  size_t count;
  int found = 0;
  const fg_format *const *formats = fg_formats(&count);
  for (size_t i = 0; i < count; i++)
    for (const char *const *ending = formats[i]->endings; *ending; ending++)
      found += !strcasecmp(*ending, wanted);
  return found;
}

static void an_ending_belongs_to_one_row(void **state) {
  (void)state;
  size_t count;
  const fg_format *const *formats = fg_formats(&count);
  for (size_t i = 0; i < count; i++)
    for (const char *const *ending = formats[i]->endings; *ending; ending++) {
      assert_int_equal((*ending)[0], '.');
      assert_int_equal(count_ending(*ending), 1);
    }
}

static void put_empty(const char *folder, const char *name, const char *ending) {
  char path[128];
  snprintf(path, sizeof path, "%s/%s%s", folder, name, ending);
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  fclose(file);
}

static void a_lot_takes_every_ending(void **state) {
  (void)state;
  char folder[] = "/tmp/foilgauge-formats-XXXXXX", command[96], endings[200];
  assert_non_null(mkdtemp(folder));
  size_t count, files = 0;
  const fg_format *const *formats = fg_formats(&count);
  fg_format_list_endings(endings, sizeof endings);
  for (size_t i = 0; i < count; i++)
    for (const char *const *ending = formats[i]->endings; *ending; ending++) {
      put_empty(folder, "scan", *ending);
      assert_has(endings, *ending);
      files++;
    }
  put_empty(folder, "notes", ".doc");
  fg_context ctx = {0};
  fg_manifest manifest;
  const char *path = folder;
  assert_ok(&ctx, fg_manifest_collect(&ctx, &path, 1, NULL, NULL, &manifest));
  assert_int_equal(manifest.items, files);
  fg_manifest_free(&manifest);
  snprintf(command, sizeof command, "rm -r %s", folder);
  assert_int_equal(system(command), 0);
}

static void messages_name_every_row(void **state) {
  (void)state;
  size_t count;
  const fg_format *const *formats = fg_formats(&count);
  const uint8_t nothing[4] = {1, 0, 2, 3};
  char names[100], problem[300];
  fg_scan_format_names(" or ", names, sizeof names);
  fg_format_problem(nothing, sizeof nothing, problem, sizeof problem);
  for (size_t i = 0; i < count; i++) {
    assert_has(names, formats[i]->name);
    assert_has(problem, formats[i]->name);
  }
}

static char *read_text(const char *path) {
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  char *text = calloc(1, 1 << 20);
  assert_true(fread(text, 1, (1 << 20) - 1, file) > 0);
  fclose(file);
  return text;
}

/* The words that the member `format` of an input may have. */
static const cJSON *formats_of(const cJSON *schema) {
  const cJSON *defs = cJSON_GetObjectItemCaseSensitive(schema, "$defs");
  const cJSON *input = cJSON_GetObjectItemCaseSensitive(defs, "input");
  const cJSON *members = cJSON_GetObjectItemCaseSensitive(input, "properties");
  const cJSON *format = cJSON_GetObjectItemCaseSensitive(members, "format");
  return cJSON_GetObjectItemCaseSensitive(format, "enum");
}

static void documents_name_every_row(void **state) {
  (void)state;
  size_t count;
  const fg_format *const *formats = fg_formats(&count);
  char *manual = read_text("src/manual/text/foilgauge-measure.1.md"),
       *text = read_text("reports/schema/measure.schema.json");
  cJSON *schema = cJSON_Parse(text);
  const cJSON *words = formats_of(schema);
  assert_int_equal(cJSON_GetArraySize(words), count);
  for (size_t i = 0; i < count; i++) {
    char row[16];
    bool known = false;
    const cJSON *word;
    cJSON_ArrayForEach(word, words) known = known || !strcmp(word->valuestring, formats[i]->name);
    assert_true(known);
    snprintf(row, sizeof row, "\n| %s", formats[i]->name);
    assert_has(manual, row);
  }
  cJSON_Delete(schema);
  free(manual);
  free(text);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_format_is_complete), cmocka_unit_test(an_ending_belongs_to_one_row),
      cmocka_unit_test(a_lot_takes_every_ending), cmocka_unit_test(messages_name_every_row),
      cmocka_unit_test(documents_name_every_row),
  };
  return cmocka_run_group_tests_name("format", tests, NULL, NULL);
}
