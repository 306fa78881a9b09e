/* SPDX-License-Identifier: GPL-3.0-or-later */
/* JSON is read into a struct by the rows that write it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/json_read.h"
#include "core/member_read.h"
#include "support/test.h"

enum { PARTS_MAX = 2, NUMBERS_MAX = 3 };

typedef enum side { LEFT, RIGHT } side;

typedef struct limit {
  char quantity[8];
  double lower, upper;
} limit;

typedef struct part {
  char name[8], command[16];
  double length_mm, share;
  size_t count, pads;
  int number;
  uint64_t seed;
  bool fitted;
  side side;
  limit limits[PARTS_MAX];
  size_t limit_count;
  double numbers[NUMBERS_MAX];
  size_t number_count;
  struct {
    double u_mm;
  } inner;
} part;

static const char *const side_words[] = {"left", "right", NULL};

static const fg_member limit_rows[] = {
    {FG_NUMBER("min", limit, lower), .options = FG_MEMBER_LEFT_OUT},
    {FG_NUMBER("max", limit, upper), .options = FG_MEMBER_LEFT_OUT},
};
static const fg_members limit_members = FG_MEMBERS(limit_rows);
static const limit no_limits = {.lower = -INFINITY, .upper = INFINITY};

static const fg_member inner_rows[] = {
    {FG_NUMBER("u_mm", part, inner.u_mm), .options = FG_MEMBER_REQUIRED | FG_MEMBER_ABOVE_0},
};
static const fg_members inner_members = FG_MEMBERS(inner_rows);

static const fg_member part_rows[] = {
    {FG_HEAD("test/part/1")},
    {FG_TEXT("name", part, name)},
    {FG_TEXT("command", part, command), .options = FG_MEMBER_ANY_TEXT},
    {FG_NUMBER("length_mm", part, length_mm)},
    {FG_NUMBER("share", part, share), .lowest = -1, .highest = 1},
    {FG_COUNT("count", part, count)},
    {FG_COUNT("pads", part, pads), .lowest = 1, .highest = 9, .options = FG_MEMBER_EMPTY_IS_NULL},
    {FG_INTEGER("number", part, number)},
    {FG_SEED("seed", part, seed)},
    {FG_FLAG("fitted", part, fitted)},
    {FG_WORD("side", part, side, side_words)},
    {FG_MAP("limits", part, limits, limit_count, quantity, &limit_members), .fresh = &no_limits,
     .options = FG_MEMBER_NOT_EMPTY, .highest = PARTS_MAX},
    {FG_NUMBERS_OF("numbers", part, numbers, number_count), .highest = NUMBERS_MAX},
    {FG_GROUP("inner", &inner_members)},
};
static const fg_members part_members = FG_MEMBERS(part_rows);

static fg_status read_part(const char *json, const char *between, part *read, fg_context *ctx) {
  const fg_reading reading = {.ctx = ctx, .path = "p.json", .between = between};
  cJSON *root = cJSON_Parse(json);
  assert_non_null(root);
  fg_status status = fg_object_read(&reading, &part_members, root, read);
  cJSON_Delete(root);
  return status;
}

#define HEAD "\"schema\": \"test/part/1\""

/* The same rows write the members again. */
static void every_kind_is_read_and_written_again(void **state) {
  static const char *const json =
      "{" HEAD
      ", \"version\": \"?\", \"name\": \"abc\", \"command\": \"a\\nb\", \"length_mm\": 2.5, "
      "\"share\": -0.5, \"count\": 3, \"pads\": null, \"number\": -4, \"seed\": 77, \"fitted\": "
      "true, "
      "\"side\": \"right\", \"limits\": {\"h\": {\"min\": 1.0}, \"r\": {\"max\": 2.0}}, "
      "\"numbers\": [1.0, 2.0], \"inner\": {\"u_mm\": 0.1}}";
  (void)state;
  fg_context ctx = {0};
  char *text = NULL;
  size_t size;
  part p = {.pads = 5, .numbers = {9, 9, 9}};
  assert_ok(&ctx, read_part(json, ": ", &p, &ctx));
  assert_string_equal(p.name, "abc");
  assert_int_equal(p.pads, 0);
  assert_true(p.limit_count == 2 && p.limits[0].lower == 1 && isinf(p.limits[0].upper));
  assert_true(p.number_count == 2 && p.numbers[1] == 2 && p.side == RIGHT && p.seed == 77);
  FILE *out = open_memstream(&text, &size);
  assert_non_null(out);
  fg_document_json(out, &part_members, &p);
  assert_int_equal(fclose(out), 0);
  cJSON *first = cJSON_Parse(json), *again = cJSON_Parse(text);
  cJSON_DeleteItemFromObject(first, "version");
  cJSON_DeleteItemFromObject(again, "version");
  assert_true(cJSON_Compare(first, again, true));
  cJSON_Delete(first);
  cJSON_Delete(again);
  free(text);
}

static void absent_members_keep_their_value(void **state) {
  (void)state;
  fg_context ctx = {0};
  part p = {.name = "old", .count = 7, .side = RIGHT};
  assert_ok(&ctx, read_part("{" HEAD "}", ": ", &p, &ctx));
  assert_true(!strcmp(p.name, "old") && p.count == 7 && p.side == RIGHT);
}

static void faults_are_told_with_their_place(void **state) {
  static const struct {
    const char *member, *words;
  } rows[] = {
      {"\"name\": 1", "p.json: name: must be a text in quotes"},
      {"\"name\": \"12345678\"", "name: is too long; at most 7 bytes"},
      {"\"name\": \"a\\u0007\"", "name: holds a control character"},
      {"\"length_mm\": \"1\"", "length_mm: must be a number"},
      {"\"length_mm\": null", "length_mm: must be a number"},
      {"\"length_mm\": 1e999", "length_mm: the number is too large"},
      {"\"share\": 1.5", "share: is 1.5; it must be a number from -1 to 1"},
      {"\"count\": 2.5", "count: is 2.5; it must be a whole number from 0 to"},
      {"\"count\": -1", "count: is -1; it must be a whole number"},
      {"\"count\": null", "count: must be a number"},
      {"\"pads\": 0", "pads: is 0; it must be a whole number from 1 to 9"},
      {"\"number\": 1e12", "number: is 1e+12; it must be a whole number"},
      {"\"fitted\": 1", "fitted: must be true or false"},
      {"\"side\": \"up\"", "side: must be \"left\" or \"right\""},
      {"\"limits\": []", "limits: must be an object"},
      {"\"limits\": {\"h\": 1}", "limits.h: must be an object with at least one of min, max"},
      {"\"limits\": {\"h\": {}}", "limits.h: must be an object with at least one of min, max"},
      {"\"limits\": {\"h\": {\"low\": 1}}", "limits.h.low: is not known; there are min, max"},
      {"\"limits\": {\"h\": {\"min\": 1}, \"h\": {\"min\": 1}}", "limits.h: is given twice"},
      {"\"limits\": {\"12345678\": {\"min\": 1}}", "limits.12345678: a name has 1 to 7 bytes"},
      {"\"limits\": {\"a\": {\"min\": 1}, \"b\": {\"min\": 1}, \"c\": {\"min\": 1}}",
       "limits: more than 2 entries"},
      {"\"numbers\": 1", "numbers: must be an array of numbers"},
      {"\"numbers\": [1, \"2\"]", "numbers[1]: must be a number"},
      {"\"numbers\": [1, 2, 3, 4]", "numbers: more than 3 numbers"},
      {"\"inner\": 1", "inner: must be an object"},
      {"\"inner\": {}", "inner: u_mm is missing"},
      {"\"inner\": {\"u_mm\": 0}", "inner.u_mm: is 0; it must be above 0"},
      {"\"nmae\": 1", "nmae: is not known; there are schema, name, command"},
      {"\"count\": 1, \"count\": 1", "count: is given twice"},
      {"\"schema\": 1", "schema: must be \"test/part/1\""},
  };
  (void)state;
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    in_row("rows[%zu]", i);
    char json[300];
    fg_context ctx = {0};
    part p = {.count = 0};
    bool schema = strstr(rows[i].member, "schema") != NULL;
    snprintf(json, sizeof json, "{%s%s}", schema ? "" : HEAD ", ", rows[i].member);
    assert_status(&ctx, read_part(json, ": ", &p, &ctx), FG_ERR_DATA);
    assert_has(ctx.message, rows[i].words);
  }
  fg_context ctx = {0};
  part p = {.count = 0};
  assert_status(&ctx, read_part("{\"count\": 1}", ": ", &p, &ctx), FG_ERR_DATA);
  assert_has(ctx.message, "schema: is missing; it must be \"test/part/1\"");
  assert_status(&ctx, read_part("{" HEAD ", \"count\": \"1\"}", " ", &p, &ctx), FG_ERR_DATA);
  assert_has(ctx.message, "p.json: count must be a number");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_kind_is_read_and_written_again),
      cmocka_unit_test(absent_members_keep_their_value),
      cmocka_unit_test(faults_are_told_with_their_place),
  };
  return cmocka_run_group_tests_name("member_read", tests, NULL, NULL);
}
