/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frame of every unit test: cmocka with what its header needs, calls that must succeed, numbers
 * that must agree, and the row of a table that a failed assertion stands in.
 *
 *   static const struct { ... } cases[] = {...};
 *   for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
 *     in_row("cases[%zu]: %s", i, cases[i].name);
 *     assert_ok(&ctx, fg_design_parse(&ctx, "x", cases[i].json, &design));
 *   }
 */
#ifndef FG_TESTS_TEST_H
#define FG_TESTS_TEST_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "foilgauge/status.h"

/* gcc 12 takes the text that an inlined open_memstream() fills for the local variable pointing to
 * it. */
#if defined __GNUC__ && !defined __clang__ && __GNUC__ >= 12
#pragma GCC diagnostic ignored "-Wdangling-pointer"
#endif

/* Context for calls whose words no assertion reads. */
static __attribute__((unused)) fg_context test_context;

static __attribute__((unused)) char test_row_words[160];

static inline void test_end_row(const int *row) {
  (void)row;
  test_row_words[0] = '\0';
}

static inline __attribute__((format(printf, 1, 2))) int test_begin_row(const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(test_row_words, sizeof test_row_words, format, arguments);
  va_end(arguments);
  return 0;
}

/* First statement of a loop over a table: until the end of its block every failed assertion names
 * the row. */
#define in_row(...)                                                                                \
  __attribute__((cleanup(test_end_row), unused)) int test_row_ = test_begin_row(__VA_ARGS__)

/* Returns the file, and the row where there is one: cmocka prints it before the line's number. */
static __attribute__((noinline, unused)) const char *test_place(const char *file) {
  static char place[400];
  if (!test_row_words[0]) return file;
  snprintf(place, sizeof place, "%s (%s)", file, test_row_words);
  return place;
}

#define TEST_PLACE test_place(__FILE__), __LINE__

/* A test that failed in a row leaves its words behind: the next test begins without. */
static inline int test_forget_row(void **state) {
  (void)state;
  test_row_words[0] = '\0';
  return 0;
}

#undef cmocka_unit_test
#define cmocka_unit_test(test)                                                                     \
  { #test, test, test_forget_row, NULL, NULL }

/* cmocka's own, with the row. */
#undef assert_true
#define assert_true(c) _assert_true(cast_to_largest_integral_type(c), #c, TEST_PLACE)
#undef assert_false
#define assert_false(c) _assert_true(!(cast_to_largest_integral_type(c)), "not " #c, TEST_PLACE)
#undef assert_non_null
#define assert_non_null(c) _assert_true(cast_ptr_to_largest_integral_type(c), #c, TEST_PLACE)
#undef assert_null
#define assert_null(c)                                                                             \
  _assert_true(!(cast_ptr_to_largest_integral_type(c)), #c " == NULL", TEST_PLACE)
#undef assert_int_equal
#define assert_int_equal(a, b)                                                                     \
  _assert_int_equal(cast_to_largest_integral_type(a), cast_to_largest_integral_type(b), TEST_PLACE)
#undef assert_int_not_equal
#define assert_int_not_equal(a, b)                                                                 \
  _assert_int_not_equal(cast_to_largest_integral_type(a), cast_to_largest_integral_type(b),        \
                        TEST_PLACE)
#undef assert_string_equal
#define assert_string_equal(a, b)                                                                  \
  _assert_string_equal((const char *)(a), (const char *)(b), TEST_PLACE)
#undef assert_memory_equal
#define assert_memory_equal(a, b, size)                                                            \
  _assert_memory_equal((const void *)(a), (const void *)(b), size, TEST_PLACE)
#undef assert_in_range
#define assert_in_range(value, low, high)                                                          \
  _assert_in_range(cast_to_largest_integral_type(value), cast_to_largest_integral_type(low),       \
                   cast_to_largest_integral_type(high), TEST_PLACE)
#undef fail
#define fail() _fail(TEST_PLACE)

static inline const char *test_status_name(fg_status status) {
  static const char *const names[] = {
      [FG_OK] = "FG_OK",
      [FG_ERR_USAGE] = "FG_ERR_USAGE",
      [FG_ERR_DATA] = "FG_ERR_DATA",
      [FG_ERR_IO] = "FG_ERR_IO",
      [FG_ERR_MEMORY] = "FG_ERR_MEMORY",
      [FG_ERR_NUMERIC] = "FG_ERR_NUMERIC",
      [FG_ERR_INTERRUPTED] = "FG_ERR_INTERRUPTED",
      [FG_ERR_NOT_MEASURED] = "FG_ERR_NOT_MEASURED",
  };
  return (size_t)status < sizeof names / sizeof *names ? names[status] : "no status";
}

static inline void test_status(const fg_context *ctx, fg_status status, fg_status wanted,
                               const char *call, const char *file, int line) {
  if (status == wanted) return;
  print_error("ERROR: %s is %s, not %s: \"%s\"\n", call, test_status_name(status),
              test_status_name(wanted), ctx ? ctx->message : "");
  _fail(file, line);
}

/* The call returns FG_OK; otherwise its status and the message in `ctx` (NULL: none) are printed.
 */
#define assert_ok(ctx, call) assert_status(ctx, call, FG_OK)

/* The call returns `wanted`. */
#define assert_status(ctx, call, wanted) test_status(ctx, call, wanted, #call, TEST_PLACE)

/* Returns the part of a page that its reader reads first, to be printed; any other text whole. */
static inline const char *test_excerpt(const char *text) {
  const char *note = strstr(text, "<p class=\"note\">"), *body = strstr(text, "<body");
  return note ? note : body ? body : text;
}

/* A message, a page or another text has these words, or has them not; otherwise its beginning is
 * printed. */
#define assert_has(text, words)     test_has(text, words, true, #text, TEST_PLACE)
#define assert_has_not(text, words) test_has(text, words, false, #text, TEST_PLACE)

static inline void test_has(const char *text, const char *words, bool wanted, const char *name,
                            const char *file, int line) {
  if (text && (strstr(text, words) != NULL) == wanted) return;
  print_error("ERROR: %s %s \"%s\":\n%.700s\n", name, wanted ? "lacks" : "has", words,
              text ? test_excerpt(text) : "(NULL)");
  _fail(file, line);
}

/* Two numbers agree within a tolerance; cmocka 1.1.5 knows only float. */
#define assert_near(got, wanted, tolerance)                                                        \
  do {                                                                                             \
    double got_ = (got), wanted_ = (wanted);                                                       \
    if (!(fabs(got_ - wanted_) <= (tolerance)))                                                    \
      fail_msg("%s is %.12g, not %.12g", #got, got_, wanted_);                                     \
  } while (0)

#endif
