/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members: one row gives JSON, CSV, the terminal's table and the page's. */
#include <math.h>
#include <stdlib.h>

#include "core/member.h"
#include "page/table.h"
#include "support/test.h"

typedef struct part {
  double radius_mm, u_radius_mm, height_mm;
  size_t count;
  int number;
  bool fitted;
  char name[16];
  const char *error;
} part;

typedef struct whole {
  part *parts;
  size_t part_count;
} whole;

static const char *look_at(const fg_subject *subject) {
  return ((const part *)subject->object)->fitted ? "pass" : "fail";
}

static bool find_part(const fg_subject *list, size_t i, fg_subject *element) {
  const whole *of = list->object;
  element->object = &of->parts[i];
  return i < of->part_count;
}

static bool has_no_height(const fg_subject *list) {
  (void)list;
  return false;
}

static const fg_member part_rows[] = {
    {FG_INTEGER("number", part, number), .csv = {1}, .page = {1, .heading = "no."}},
    {FG_TEXT("name", part, name), .options = FG_MEMBER_EMPTY_IS_NULL, .csv = {3},
     .page = {3, .heading = "name", .words = true}, .terminal = {3, .heading = "name"}},
    {FG_NUMBER_U("radius_mm", part, radius_mm, u_radius_mm), .words = "of the part",
     .heading = "R,\nµm", .csv = {2}, .page = {2, .scale = 1000, .by_u = true},
     .terminal = {2, .decimals = 1, .scale = 1000}, .look = look_at},
    {FG_NUMBER("height_mm", part, height_mm), .options = FG_MEMBER_LEFT_OUT, .csv = {2},
     .page = {2, .heading = "h"}, .column = has_no_height},
    {FG_COUNT("count", part, count)},
    {FG_FLAG("fitted", part, fitted)},
    {FG_STRING("error", part, error)},
};
static const fg_members part_members = FG_MEMBERS(part_rows);

static const fg_member whole_rows[] = {
    {FG_LIST("parts", whole, parts, part_count, &part_members), .options = FG_MEMBER_ON_LINE},
};
static const fg_members whole_members = FG_MEMBERS(whole_rows);

static part parts[] = {{1.5, 0.0012, 0.25, 3, 1, true, "a,b", NULL},
                       {-2, 0.002, NAN, 0, 2, false, "", "lost"}};
static const whole all = {parts, 2};
static const fg_subject list = {.object = &all, .whole = &all};

/* Text that a writer makes; the caller frees. */
static char *written(void (*write)(FILE *)) {
  char *text = NULL;
  size_t size;
  FILE *out = open_memstream(&text, &size);
  assert_non_null(out);
  write(out);
  assert_int_equal(fclose(out), 0);
  return text;
}

static void write_json(FILE *out) {
  fg_document_json(out, &whole_members, &all);
}

static void write_csv(FILE *out) {
  fg_members_csv(out, &part_members, &list, find_part);
}

static void write_terminal(FILE *out) {
  fg_members_terminal(out, "  ", &part_members, &list, find_part);
}

static void write_html(FILE *out) {
  fg_html_table(out, &part_members, &list, find_part);
}

static void assert_written(void (*write)(FILE *), const char *expected) {
  char *text = written(write);
  assert_string_equal(text, expected);
  free(text);
}

static void json_has_every_row(void **state) {
  (void)state;
  assert_written(
      write_json,
      "{\n \"parts\": [\n"
      "  {\"number\": 1, \"name\": \"a,b\", \"radius_mm\": 1.5, \"u_radius_mm\": 0.0012, "
      "\"height_mm\": 0.25, \"count\": 3, \"fitted\": true, \"error\": null},\n"
      "  {\"number\": 2, \"name\": null, \"radius_mm\": -2, \"u_radius_mm\": 0.002, "
      "\"count\": 0, \"fitted\": false, \"error\": \"lost\"}\n ]\n}\n");
}

static void csv_has_its_columns_by_rank(void **state) {
  (void)state;
  assert_written(write_csv, "number,radius_mm,u_radius_mm,height_mm,name\n"
                            "1,1.5,0.0012,0.25,\"a,b\"\n2,-2,0.002,,\n");
}

static void terminal_is_as_wide_as_its_cells(void **state) {
  (void)state;
  assert_written(write_terminal, "        R   ±  name\n"
                                 "       µm\n"
                                 "   1500.0 2.4   a,b\n"
                                 "  -2000.0 4.0     -\n");
}

static void page_has_headings_words_and_looks(void **state) {
  (void)state;
  assert_written(
      write_html,
      "<div class=\"scroll\"><table>\n<thead><tr><th>no.</th><th title=\"of the part\">R,<br>µm"
      "</th><th class=\"w\">name</th></tr></thead>\n<tbody>\n"
      "<tr><td>1</td><td class=\"pass\">1500.0 <i>± 2.4</i></td><td class=\"words\">a,b</td></tr>\n"
      "<tr><td>2</td><td class=\"fail\">−2000.0 <i>± 4.0</i></td><td class=\"words\"></td></tr>\n"
      "</tbody></table></div>\n");
}

/* A table of the page alone. */
static const char *look_at_line(const fg_subject *subject) {
  return ((const part *)subject->object)->fitted ? NULL : "total";
}

static void put_link(FILE *out, const fg_subject *subject) {
  fprintf(out, "<a href=\"#%d\">part</a>", ((const part *)subject->object)->number);
}

static const fg_member line_rows[] = {
    {FG_INTEGER("number", part, number), .page = {1, .heading = "part"}, .markup = put_link},
    {FG_NUMBER("radius_mm", part, radius_mm), .page = {2, .heading = "R", .plus = true}},
};
static const fg_members line_members = FG_MEMBERS_LOOKED_AT(line_rows, look_at_line);

static void write_lines(FILE *out) {
  fg_html_table(out, &line_members, &list, find_part);
}

static void page_has_classes_of_lines_signs_and_links(void **state) {
  (void)state;
  assert_written(write_lines,
                 "<div class=\"scroll\"><table>\n<thead><tr><th>part</th><th>R</th></tr></thead>\n"
                 "<tbody>\n<tr><td><a href=\"#1\">part</a></td><td>+2</td></tr>\n"
                 "<tr class=\"total\"><td><a href=\"#2\">part</a></td><td>−2</td></tr>\n"
                 "</tbody></table></div>\n");
}

/* Arrays inside an object. */
typedef struct arrays {
  double all[3], first[4];
  size_t count;
} arrays;

static const fg_member array_rows[] = {
    {FG_NUMBERS("all", arrays, all)},
    {FG_NUMBERS_OF("first", arrays, first, count)},
};
static const fg_members array_members = FG_MEMBERS(array_rows);

static void write_arrays(FILE *out) {
  fg_document_json(out, &array_members, &(arrays){{1, NAN, 3}, {4, 5, 6, 7}, 2});
}

static void json_has_arrays_of_the_object(void **state) {
  (void)state;
  assert_written(write_arrays, "{\n \"all\": [1, null, 3],\n \"first\": [4, 5]\n}\n");
}

static void p_values_end_at_a_minimum(void **state) {
  (void)state;
  static const fg_member row = {FG_NUMBER("p", part, radius_mm),
                                .page = {1, .digits = 2, .min = 1e-12}};
  static const struct {
    double p;
    const char *text;
  } cases[] = {{1e-20, "< 1e-12"}, {1e-12, "1e-12"}, {0.0123, "0.012"}, {NAN, "–"}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    const part one = {.radius_mm = cases[i].p};
    char text[40];
    fg_member_show(&row, FG_ON_PAGE, &(fg_subject){.object = &one}, text, sizeof text);
    assert_string_equal(text, cases[i].text);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(json_has_every_row),
      cmocka_unit_test(p_values_end_at_a_minimum),
      cmocka_unit_test(csv_has_its_columns_by_rank),
      cmocka_unit_test(terminal_is_as_wide_as_its_cells),
      cmocka_unit_test(page_has_headings_words_and_looks),
      cmocka_unit_test(json_has_arrays_of_the_object),
      cmocka_unit_test(page_has_classes_of_lines_signs_and_links),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
