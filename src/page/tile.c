/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "page/tile.h"

#include <stdarg.h>

static void end_tile(FILE *out, const char *small) {
  if (small && *small) fprintf(out, "<small>%s</small>", small);
  fputs("</dd></div>\n", out);
}

void fg_html_tile(FILE *out, const char *title, const char *small, const char *format, ...) {
  va_list values;
  fprintf(out, "<div><dt>%s</dt><dd>", title);
  va_start(values, format);
  vfprintf(out, format, values);
  va_end(values);
  end_tile(out, small);
}

void fg_html_count_tile(FILE *out, fg_tile_look look, const char *title, size_t count,
                        const char *small) {
  static const struct {
    const char *style, *mark;
  } looks[FG_TILE_LOOKS] = {[FG_TILE_PLAIN] = {"", ""},
                            [FG_TILE_GOOD] = {" class=\"good\"", "✓ "},
                            [FG_TILE_BAD] = {" class=\"bad\"", "✗ "},
                            [FG_TILE_OPEN] = {" class=\"open\"", "? "}};
  fprintf(out, "<div%s><dt>%s</dt><dd>%s%zu", looks[look].style, title, looks[look].mark, count);
  end_tile(out, small);
}
