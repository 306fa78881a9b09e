/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "page/tile.h"

#include <math.h>

#include "foilgauge/report.h"

static void write_tile_value(FILE *out, const fg_tile *tile) {
  double value = fabs(tile->value);
  if (!isfinite(value)) {
    fputs("–", out);
    return;
  }
  bool zero = tile->digits ? value == 0 : value < 0.5 * pow(10, -tile->decimals);
  if (!zero) fputs(tile->value < 0 ? "−" : tile->plus ? "+" : "", out);
  if (tile->digits)
    fprintf(out, "%.*g", tile->digits, value);
  else
    fprintf(out, "%.*f", tile->decimals, value);
  if (tile->unit) fprintf(out, " %s", tile->unit);
}

static void write_tile_small(FILE *out, const fg_tile *tile) {
  bool known = tile->text || isfinite(tile->value);
  bool with_u = known && tile->u_words && isfinite(tile->u);
  const char *words = !known && tile->unknown ? tile->unknown : tile->small ? tile->small : "";
  if (!with_u && !*words) return;
  fputs("<small>", out);
  if (with_u)
    fprintf(out, "± %.*f%s%s", tile->decimals, FG_COVERAGE_FACTOR * tile->u, tile->u_words,
            *words ? ", " : "");
  fprintf(out, "%s</small>", words);
}

void fg_html_tile(FILE *out, const fg_tile *tile) {
  static const struct {
    const char *style, *mark;
  } looks[FG_TILE_LOOKS] = {[FG_TILE_PLAIN] = {"", ""},
                            [FG_TILE_GOOD] = {" class=\"good\"", "✓ "},
                            [FG_TILE_BAD] = {" class=\"bad\"", "✗ "},
                            [FG_TILE_OPEN] = {" class=\"open\"", "? "}};
  if (!tile->title) return;
  fprintf(out, "<div%s><dt>%s</dt><dd>%s", looks[tile->look].style, tile->title,
          looks[tile->look].mark);
  if (tile->text)
    fputs(tile->text, out);
  else
    write_tile_value(out, tile);
  write_tile_small(out, tile);
  fputs("</dd></div>\n", out);
}

void fg_html_tiles(FILE *out, const char *style, const fg_tile *tiles, size_t count) {
  fprintf(out, "<dl class=\"%s\">\n", style);
  for (size_t i = 0; i < count; i++)
    fg_html_tile(out, &tiles[i]);
  fputs("</dl>\n", out);
}
