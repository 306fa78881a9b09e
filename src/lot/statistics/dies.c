/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lot/statistics/dies.h"

#include <math.h>

#include "lot/input/recipe.h"

fg_lot_to_die fg_lot_bump_to_die(const fg_lot *lot, const fg_lot_foil *foil, const fg_bump *bump) {
  fg_lot_to_die to = {NULL, false, NAN, NAN, NAN, NAN};
  size_t column = fg_manifest_column(&lot->manifest, lot->settings.die_column);
  if (!lot->settings.die_count || column == FG_NO_COLUMN) return to;
  to.die = fg_lot_dies_find(&lot->settings, fg_manifest_cell(&lot->manifest, foil->item, column));
  if (!to.die) return to;
  to.by_mean = true;
  to.radius_mm = to.die->radius_mm;
  to.u_radius_mm = to.die->u_radius_mm;
  for (size_t i = 0; i < to.die->bump_count; i++)
    if (to.die->bump[i].number == bump->number) {
      to.by_mean = false;
      to.radius_mm = to.die->bump[i].radius_mm;
      to.u_radius_mm = to.die->bump[i].u_radius_mm;
    }
  double ratio = bump->radius_mm / to.radius_mm;
  to.error_pct = 100 * (ratio - 1);
  to.u_error_pct = 100 * hypot(bump->u_radius_mm, ratio * to.u_radius_mm) / to.radius_mm;
  return to;
}

/* Sums of the errors against design and die, and of the dies' own errors. */
typedef struct sums {
  double count, design, die, design_square, die_square, own, u_own;
} sums;

static void add_die_error(const fg_lot_analysis *analysis, const fg_bump *bump,
                          const fg_lot_to_die *to, sums *s) {
  double design_mm = analysis->lot->settings.design.bumps.radius_mm;
  double error = bump->radius_error_pct;
  s->count++;
  s->design += error;
  s->design_square += error * error;
  s->die += to->error_pct;
  s->die_square += to->error_pct * to->error_pct;
  s->own += 100 * (to->radius_mm - design_mm) / design_mm;
  s->u_own += 100 * to->u_radius_mm / design_mm;
}

static double sd_of_sums(double count, double sum, double square) {
  return count > 1 ? sqrt(fmax(square - sum * sum / count, 0) / (count - 1)) : NAN;
}

static void finish_die_sum(const sums *s, fg_lot_die_sum *sum) {
  sum->bumps = (size_t)s->count;
  sum->design_mean_pct = s->design / s->count;
  sum->die_mean_pct = s->die / s->count;
  sum->design_sd_pct = sd_of_sums(s->count, s->design, s->design_square);
  sum->die_sd_pct = sd_of_sums(s->count, s->die, s->die_square);
  sum->die_error_pct = s->own / s->count;
  sum->u_die_error_pct = s->u_own / s->count;
  sum->explained_pct = 100 * sum->die_error_pct / sum->design_mean_pct;
}

static void sum_die(const fg_lot_analysis *analysis, const fg_lot_die *die, sums *all,
                    fg_lot_die_sum *sum) {
  sums s = {0};
  *sum = (fg_lot_die_sum){.die = die};
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const fg_lot_foil *foil = &analysis->foils[i];
    bool of_this = false;
    for (size_t k = 0; k < foil->foil->bump_count; k++) {
      const fg_bump *bump = &foil->foil->bumps[k];
      fg_lot_to_die to = fg_lot_bump_to_die(analysis->lot, foil, bump);
      if (to.die != die || !fg_lot_bump_counts(foil->foil, bump) || !isfinite(to.error_pct))
        continue;
      add_die_error(analysis, bump, &to, &s);
      add_die_error(analysis, bump, &to, all);
      sum->by_mean += to.by_mean;
      of_this = true;
    }
    sum->foils += of_this;
  }
  if (s.count > 0) finish_die_sum(&s, sum);
}

void fg_lot_analyse_dies(fg_lot_analysis *analysis) {
  const fg_lot_settings *settings = &analysis->lot->settings;
  fg_lot_dies *dies = &analysis->dies;
  sums all = {0};
  *dies = (fg_lot_dies){.explained_variance_pct = NAN,
                        .foils_differ_pct = NAN,
                        .dies_differ_pct = NAN,
                        .explained_difference_pct = NAN};
  for (size_t i = 0; i < settings->die_count; i++) {
    fg_lot_die_sum *sum = &dies->sum[dies->count];
    sum_die(analysis, &settings->dies[i], &all, sum);
    dies->count += sum->bumps > 0;
  }
  dies->all = (fg_lot_die_sum){.die_error_pct = NAN,
                               .u_die_error_pct = NAN,
                               .design_mean_pct = NAN,
                               .die_mean_pct = NAN,
                               .explained_pct = NAN};
  for (size_t i = 0; i < dies->count; i++)
    dies->all.foils += dies->sum[i].foils;
  dies->all.bumps = (size_t)all.count;
  dies->all.design_sd_pct = sd_of_sums(all.count, all.design, all.design_square);
  dies->all.die_sd_pct = sd_of_sums(all.count, all.die, all.die_square);
  double ratio = dies->all.die_sd_pct / dies->all.design_sd_pct;
  dies->explained_variance_pct = 100 * (1 - ratio * ratio);
  if (dies->count != 2) return;
  dies->foils_differ_pct = dies->sum[1].design_mean_pct - dies->sum[0].design_mean_pct;
  dies->dies_differ_pct = dies->sum[1].die_error_pct - dies->sum[0].die_error_pct;
  dies->explained_difference_pct = 100 * dies->dies_differ_pct / dies->foils_differ_pct;
}
