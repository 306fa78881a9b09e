/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Helpers of the analysis: parts that count, quantities by name, spreads, distinct words. */
#include <math.h>
#include <string.h>

#include "lot/statistics/analysis.h"

bool fg_lot_bump_counts(const fg_foil *foil, const fg_bump *bump) {
  return fg_foil_is_measured(foil) && !(bump->flags & FG_BUMP_CRUSHED);
}

bool fg_lot_part_counts(const fg_foil *foil, fg_quantity_owner owner, const fg_foil_part *part) {
  if (owner == FG_QUANTITY_OF_BEAM)
    return fg_foil_is_measured(foil) && !(part->flags & (unsigned)FG_LOT_BEAM_DAMAGED);
  return fg_lot_bump_counts(foil, part->object);
}

int fg_lot_part_number(const fg_foil *foil, const fg_foil_part *part) {
  return foil->flags & FG_FOIL_BEAM_PLACES_UNKNOWN ? 0 : part->number;
}

const fg_lot_quantity *fg_lot_find_quantity(const fg_lot_analysis *analysis, const char *name) {
  for (size_t i = 0; i < analysis->quantity_count; i++)
    if (!strcmp(analysis->quantities[i].row->name, name)) return &analysis->quantities[i];
  return NULL;
}

const fg_lot_words *fg_lot_words_of(const fg_lot_analysis *analysis) {
  static const fg_lot_words words[FG_QUANTITY_OWNERS] = {
      [FG_QUANTITY_OF_BUMP] = {.one = "bump",
                               .many = "bumps",
                               .counted = "Bumps measured",
                               .how = "crushed",
                               .damaged = "Crushed bumps",
                               .json_damaged = "bumps_crushed",
                               .json_worst = "worst_bump",
                               .numbers = "bump, 1 is next to the lip",
                               .before_number = " ",
                               .mean = "foil (mean of its bumps)"},
      [FG_QUANTITY_OF_BEAM] = {.one = "beam",
                               .many = "beams",
                               .counted = "Beams measured",
                               .how = "torn, bent or hidden",
                               .damaged = "Damaged beams",
                               .json_damaged = "beams_damaged",
                               .json_worst = "worst_beam",
                               .numbers = "beam, from left to right with the free ends up",
                               .before_number = ", beam ",
                               .mean = "foil (mean of its beams)"},
  };
  return &words[analysis->parts];
}

const fg_lot_quantity *fg_lot_leading_quantity(const fg_lot_analysis *analysis) {
  for (size_t i = 0; i < analysis->quantity_count; i++)
    if (analysis->quantities[i].tolerance && fg_owner_is_part(analysis->quantities[i].owner))
      return &analysis->quantities[i];
  const bool beams = analysis->parts == FG_QUANTITY_OF_BEAM;
  return fg_lot_find_quantity(analysis, beams ? "compliance_error_pct" : "height_mm");
}

fg_status fg_lot_find_spread_and_density(fg_context *ctx, const double *values, size_t count,
                                         fg_bandwidth_rule rule, fg_lot_spread *spread,
                                         fg_density *density) {
  double squares = 0;
  *density = (fg_density){0};
  *spread =
      (fg_lot_spread){.count = count, .mode = NAN, .sd = NAN, .min = INFINITY, .max = -INFINITY};
  for (size_t i = 0; i < count; i++) {
    spread->mean += (values[i] - values[0]) / (double)count;
    spread->min = fmin(spread->min, values[i]);
    spread->max = fmax(spread->max, values[i]);
  }
  spread->mean = count ? spread->mean + values[0] : NAN;
  for (size_t i = 0; i < count; i++)
    squares += (values[i] - spread->mean) * (values[i] - spread->mean);
  if (count > 1) spread->sd = sqrt(squares / (double)(count - 1));
  spread->relative_sd_pct = 100 * spread->sd / fabs(spread->mean);
  if (!(spread->sd > 0)) return FG_OK;
  FG_TRY(fg_density_fit(ctx, values, count, rule, density));
  spread->mode = fg_density_mode(density);
  return FG_OK;
}

fg_status fg_lot_find_spread(fg_context *ctx, const double *values, size_t count,
                             fg_bandwidth_rule rule, fg_lot_spread *spread) {
  fg_density density;
  FG_TRY(fg_lot_find_spread_and_density(ctx, values, count, rule, spread, &density));
  fg_density_free(&density);
  return FG_OK;
}

size_t fg_manifest_word_index(fg_manifest_words *words, const char *word) {
  for (size_t i = 0; i < words->count; i++)
    if (!strcmp(words->word[i], word)) return i;
  if (words->count == FG_LOT_WORDS_MAX) return FG_LOT_WORDS_MAX;
  words->word[words->count] = word;
  return words->count++;
}

void fg_lot_list_words(const fg_lot_analysis *analysis, size_t column, fg_manifest_words *words) {
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const char *word = fg_manifest_cell(&analysis->lot->manifest, analysis->foils[i].item, column);
    if (*word) fg_manifest_word_index(words, word);
  }
}
