/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "page/wrapped.h"

#include <stdbool.h>
#include <string.h>

enum { LINE = 100 };

void fg_write_wrapped(FILE *out, const char *first, const char *indent, const char *text) {
  size_t column = strlen(first);
  fputs(first, out);
  for (bool begin = true; *text; begin = false) {
    size_t length = strcspn(text, " ");
    bool fits = column + 1 + length <= LINE;
    if (!begin) fputs(fits ? " " : "\n", out);
    if (!begin && !fits) fputs(indent, out);
    column = begin ? column + length : (fits ? column + 1 : strlen(indent)) + length;
    fwrite(text, 1, length, out);
    text += length + (text[length] == ' ');
  }
  fputc('\n', out);
}
