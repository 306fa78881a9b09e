/* Values and units as people read them. */
#include <math.h>
#include <string.h>

#include "core/text.h"
#include "report/scan_loop/scan_loop_parts.h"

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

double fg_scan_loop_nice_below(double most) {
  double power = pow(10, floor(log10(most))), share = most / power;
  return power * (share >= 5 ? 5 : share >= 2 ? 2 : 1);
}

const char *fg_scan_loop_unit_words(const char *unit) {
  return !strcmp(unit, "um") ? "µm" : !strcmp(unit, "deg") ? "°" : unit;
}
