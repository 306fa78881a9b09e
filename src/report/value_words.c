/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A number with its uncertainty, and a length, as sentences write them. */
#include "report/value_words.h"

#include <math.h>

#include "core/text.h"
#include "foilgauge/report.h"

void fg_scan_loop_value_words(double value, double u, char *words, size_t size) {
  double expanded = FG_COVERAGE_FACTOR * u;
  if (!isfinite(value)) {
    fg_text_clip(words, size, "–");
  } else if (!(expanded > 0) || !isfinite(expanded)) {
    fg_text_clip(words, size, "%.5g", value);
  } else {
    int decimals = (int)fmin(9, fmax(0, 1 - floor(log10(expanded))));
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
