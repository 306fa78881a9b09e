/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/unit_words.h"

#include <math.h>
#include <string.h>

#include "core/text.h"

static const struct {
  const char *ending, *unit;
} units[] = {
    {"_C", "°C"},      {"_K", "K"},         {"_h", "h"},     {"_min", "min"}, {"_s", "s"},
    {"_bar", "bar"},   {"_MPa", "MPa"},     {"_GPa", "GPa"}, {"_kPa", "kPa"}, {"_Pa", "Pa"},
    {"_N", "N"},       {"_kN", "kN"},       {"_mm", "mm"},   {"_um", "µm"},   {"_nm", "nm"},
    {"_m", "m"},       {"_deg", "°"},       {"_rad", "rad"}, {"_pct", "%"},   {"_J", "J"},
    {"_W", "W"},       {"_kg", "kg"},       {"_g", "g"},     {"_Hz", "Hz"},   {"_rpm", "1/min"},
    {"_V", "V"},       {"_A", "A"},         {"_l", "l"},     {"_ml", "ml"},   {"_mm2", "mm²"},
    {"_N_mm", "N/mm"}, {"_N_mm2", "N/mm²"},
};

/* The longest ending that fits; NULL: none. */
static const char *ending_of(const char *name, const char **unit) {
  size_t length = strlen(name), longest = 0;
  const char *found = NULL;
  for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
    size_t size = strlen(units[i].ending);
    if (size <= longest || size >= length || strcmp(name + length - size, units[i].ending) != 0)
      continue;
    longest = size;
    found = name + length - size;
    *unit = units[i].unit;
  }
  return found;
}

const char *fg_unit_of_name(const char *name) {
  const char *unit = "";
  ending_of(name, &unit);
  return unit;
}

void fg_name_words(const char *name, char *text, size_t size) {
  const char *unit, *end = ending_of(name, &unit);
  if (!end) {
    fg_text_clip(text, size, "%s", name);
    return;
  }
  fg_text_clip(text, size, "%.*s", (int)(end - name), name);
  for (char *c = text; *c; c++)
    if (*c == '_') *c = ' ';
}

void fg_axis_words(const char *name, char *text, size_t size) {
  const char *unit = fg_unit_of_name(name);
  char words[300];
  fg_name_words(name, words, sizeof words);
  fg_text_clip(text, size, "%s%s%s", words, *unit ? ", " : "", unit);
}

void fg_value_with_unit(const char *name, double value, int digits, char *text, size_t size) {
  const char *unit = fg_unit_of_name(name);
  fg_text_clip(text, size, "%s%.*g%s%s", value < 0 ? "−" : "", digits, fabs(value),
               *unit && strcmp(unit, "°") != 0 ? " " : "", unit);
}
