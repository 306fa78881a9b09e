/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checked memory: overflow is an error with words, growth keeps the contents. */
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "support/test.h"

static void overflow_is_an_error(void **state) {
  (void)state;
  fg_context ctx = {0};
  void *block = &ctx;
  assert_status(&ctx, fg_memory_allocate(&ctx, SIZE_MAX / 2, 3, &block), FG_ERR_MEMORY);
  assert_null(block);
  assert_has(ctx.message, "out of memory");
}

static void growth_keeps_content(void **state) {
  (void)state;
  fg_context ctx = {0};
  int *items = NULL;
  size_t capacity = 0;
  for (int i = 0; i < 1000; i++) {
    assert_ok(&ctx,
              fg_memory_reserve(&ctx, (size_t)i + 1, sizeof *items, &capacity, (void **)&items));
    items[i] = i;
  }
  for (int i = 0; i < 1000; i++)
    assert_int_equal(items[i], i);
  free(items);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(overflow_is_an_error),
      cmocka_unit_test(growth_keeps_content),
  };
  return cmocka_run_group_tests_name("memory", tests, NULL, NULL);
}
