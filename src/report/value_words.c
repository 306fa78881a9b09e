/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/value_words.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "core/text.h"
#include "foilgauge/report.h"

void fg_scan_loop_value_words(double value, double u, char *words, size_t size) {
  double expanded = FG_COVERAGE_FACTOR * u;
  if (!isfinite(value)) {
    fg_text_clip(words, size, "–");
  } else if (!(expanded > 0) || !isfinite(expanded)) {
    fg_text_clip(words, size, "%.5g", value);
  } else {
    enum { DECIMALS_MAX = 9 };
    int decimals = (int)fmin(DECIMALS_MAX + 1, fmax(0, 1 - floor(log10(expanded))));
    if (decimals > DECIMALS_MAX)
      fg_text_clip(words, size, "%.4g ± %.2g", value, expanded);
    else
      fg_text_clip(words, size, "%.*f ± %.*f", decimals, value, decimals, expanded);
  }
}

void fg_scan_loop_length_words(double um, char *words, size_t size) {
  if (!isfinite(um))
    fg_text_clip(words, size, "–");
  else if (fabs(um) < 1e-3 && um != 0)
    fg_text_clip(words, size, "%.3g nm", 1000 * um);
  else
    fg_text_clip(words, size, "%.3g µm", um);
}

enum { LINE = 100 }; /* columns of a terminal */

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
