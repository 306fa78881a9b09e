/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Summary of the drawn bearings in three lines. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "core/text.h"
#include "lot/statistics/analysis.h"

__attribute__((format(printf, 3, 4))) static void append_words(char *text, size_t size,
                                                               const char *format, ...) {
  size_t used = strlen(text);
  va_list list;
  va_start(list, format);
  vsnprintf(text + used, size - used, format, list);
  va_end(list);
}

/* Formats a share with as many digits as tell it from all and from none: "97.4", "99.96",
 * "above 99.99". */
static const char *format_percent(double share, char text[16]) {
  double value = 100 * share;
  if (value > 99.99 && value < 100) return "above 99.99";
  if (value > 0 && value < 0.01) return "below 0.01";
  bool near = (value > 99 && value < 100) || (value > 0 && value < 1);
  snprintf(text, 16, near ? "%.2f" : "%.1f", value);
  return text;
}

const char fg_assembly_scope[] =
    "This is geometry: clearances of the bearings at rest. It is no rotordynamic simulation: what "
    "bearings of such spread do at speed (thesis 5.12) `foilgauge film --foils` says.";

static void state_how_many(const fg_lot_assembly *assembly, char *text, size_t size) {
  const fg_assembly_share *share = &assembly->drawn.assembled;
  size_t foils = assembly->stock.foils, pads = assembly->plan.layout.pads;
  char now[16], low[16], high[16], sure[16], maybe[16];
  append_words(
      text, size,
      "%zu of %zu bearings drawn from %zu foil%s assemble: %s %% (%s to %s %% as so few foils tell",
      share->count, assembly->plan.bearings, foils, fg_plural(foils),
      format_percent(share->share, now), format_percent(share->foils_low, low),
      format_percent(share->foils_high, high));
  if (share->surely < share->possibly)
    append_words(text, size, ", %s to %s %% as the measurement does",
                 format_percent(share->surely, sure), format_percent(share->possibly, maybe));
  append_words(text, size, "). That is %.1f of the %zu bearing%s that these foils make.",
               share->share * (double)(foils / pads), foils / pads, fg_plural(foils / pads));
}

static void append_limit(const fg_assembly_limit *limit, char *text, size_t size) {
  append_words(text, size, "%s", limit->row->words);
  if (isfinite(limit->lower) && limit->lower == 0 && !isfinite(limit->upper)) {
    append_words(text, size, " below 0, the rotor touches");
    return;
  }
  if (isfinite(limit->lower)) append_words(text, size, " below %.4g µm", 1000 * limit->lower);
  if (isfinite(limit->upper))
    append_words(text, size, "%s above %.4g µm", isfinite(limit->lower) ? " or" : "",
                 1000 * limit->upper);
}

static void state_what_rejects(const fg_lot_assembly *assembly, char *text, size_t size) {
  const fg_assembly_plan *plan = &assembly->plan;
  const fg_assembly_result *drawn = &assembly->drawn;
  size_t first = 0, rejected = plan->bearings - drawn->assembled.count;
  for (size_t i = 0; i < plan->limits; i++)
    if (drawn->rejected[i] > drawn->rejected[first]) first = i;
  if (!rejected) {
    append_words(text, size, "Nothing rejects any of them.");
    return;
  }
  append_words(text, size, "What rejects the other %zu: ", rejected);
  append_limit(&plan->limit[first], text, size);
  append_words(text, size, " (%zu of them, %zu by this alone)", drawn->rejected[first],
               drawn->alone[first]);
  for (size_t i = 0; i < plan->limits; i++) {
    if (i == first || !drawn->rejected[i]) continue;
    append_words(text, size, "; ");
    append_limit(&plan->limit[i], text, size);
    append_words(text, size, " (%zu, %zu alone)", drawn->rejected[i], drawn->alone[i]);
  }
  append_words(text, size, ".");
}

static void state_what_would_help(const fg_lot_assembly *assembly, char *text, size_t size) {
  const fg_lot_change *best = &assembly->change[0];
  char now[16], then[16];
  if (assembly->drawn.assembled.count == assembly->plan.bearings) {
    append_words(text, size, "Every bearing drawn assembles already, so no change can show more.");
    return;
  }
  if (!assembly->changes || !best->clear || best->gain <= 0) {
    append_words(text, size,
                 "None of the changes tried makes more of them assemble than chance does.");
    return;
  }
  append_words(text, size, "What would change it most: %s: %s %% would assemble (%+.1f points)",
               best->words, format_percent(best->share, now), 100 * best->gain);
  for (size_t i = 1; i < assembly->changes && assembly->change[i].gain > 0; i++)
    append_words(text, size, "%s %s, %s %%", i == 1 ? "; then" : ";", assembly->change[i].words,
                 format_percent(assembly->change[i].share, then));
  append_words(text, size, ".");
}

void fg_lot_summarise_assembly(fg_lot_analysis *analysis) {
  fg_lot_assembly *assembly = &analysis->assembly;
  const size_t size = sizeof assembly->statement[0];
  state_how_many(assembly, assembly->statement[0], size);
  state_what_rejects(assembly, assembly->statement[1], size);
  state_what_would_help(assembly, assembly->statement[2], size);
}
