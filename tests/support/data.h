/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The numbers of reference in tests/data (tests/data/SOURCES.md). Tests run in the project's
 * folder. */
#ifndef FG_TESTS_DATA_H
#define FG_TESTS_DATA_H

#include <stdio.h>

#include "core/file.h"
#include "support/test.h"

/* Returns the whole file, NUL-terminated; without it the test fails. The caller frees it. */
static inline char *data_read(const char *name) {
  enum { BYTES_MAX = 1 << 20 };
  fg_context ctx = {0};
  char path[200], *text = NULL;
  snprintf(path, sizeof path, "tests/data/%s", name);
  if (fg_file_read_text(&ctx, path, BYTES_MAX, &text) != FG_OK) fail_msg("%s", ctx.message);
  return text;
}

#endif
