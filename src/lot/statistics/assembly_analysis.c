/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bearings drawn from the lot's foils: the foils that take part, the requirements of a bearing, and
 * the share of a lot with one property changed. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/spread.h"
#include "core/text.h"
#include "lot/statistics/analysis.h"

static const double rad_per_deg = 3.14159265358979323846 / 180;

/* Number of boxes that a workshop sorts into. */
enum { CLASSES_MAX = 5 };

const char *fg_lot_left_out_words(fg_lot_left_out why) {
  static const char *const words[FG_LOT_LEFT_OUT] = {
      [FG_LOT_IN_STOCK] = "in stock",
      [FG_LOT_NOT_MEASURED] = "not measured",
      [FG_LOT_DEFECT] = "rejected for its bumps' number",
      [FG_LOT_FAILS] = "fails its own tolerances",
      [FG_LOT_FLAGGED] = "flagged: what is seen of it may not be its own",
      [FG_LOT_CRUSHED] = "crushed bump",
      [FG_LOT_NO_CLEARANCE] = "no clearance at one of its places",
      [FG_LOT_SCANNED_AGAIN] = "scanned again: one scan of it counts",
  };
  return words[why];
}

static fg_lot_left_out find_reason(const fg_lot_analysis *analysis, size_t at) {
  static const unsigned doubtful = FG_FOIL_TOUCHES_OTHER | FG_FOIL_TOUCHES_BORDER | FG_FOIL_GAP;
  const fg_bearing_layout *layout = &analysis->layout;
  const fg_lot_foil *foil = &analysis->foils[at];
  if (!fg_foil_is_measured(foil->foil) || foil->verdict == FG_VERDICT_NOT_MEASURED)
    return FG_LOT_NOT_MEASURED;
  if (fg_foil_defect(&analysis->lot->settings.design, foil->foil, NULL, 0)) return FG_LOT_DEFECT;
  if (foil->verdict == FG_VERDICT_FAIL) return FG_LOT_FAILS;
  if (foil->foil->flags & doubtful) return FG_LOT_FLAGGED;
  for (size_t k = 0; k < foil->foil->bump_count; k++)
    if (foil->foil->bumps[k].flags & FG_BUMP_CRUSHED) return FG_LOT_CRUSHED;
  for (size_t k = 0; k < layout->bumps_per_pad; k++)
    if (!isfinite(fg_lot_clearance_of(analysis, foil, (int)(layout->first_bump + k)).mm))
      return FG_LOT_NO_CLEARANCE;
  return FG_LOT_IN_STOCK;
}

static fg_status find_left_out(fg_context *ctx, fg_lot_analysis *analysis) {
  fg_lot_assembly *assembly = &analysis->assembly;
  size_t count = analysis->foil_count;
  void *block;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *assembly->reason, &block));
  assembly->reason = block;
  FG_TRY(fg_memory_allocate(ctx, count, 2 * sizeof(size_t), &block));
  size_t *owner = block, *scans = owner + count; /* scans: in stock, of the part that owns them */
  fg_status status = fg_lot_find_owners(ctx, analysis, owner);
  for (size_t i = 0; i < count && status == FG_OK; i++) {
    fg_lot_left_out why = find_reason(analysis, i);
    if (why == FG_LOT_IN_STOCK && scans[owner[i]]++) why = FG_LOT_SCANNED_AGAIN;
    assembly->reason[i] = why;
    assembly->left_out[why]++;
  }
  free(owner);
  return status;
}

static fg_status fill_stock(fg_context *ctx, fg_lot_analysis *analysis) {
  fg_lot_assembly *assembly = &analysis->assembly;
  fg_stock *stock = &assembly->stock;
  size_t places = analysis->layout.bumps_per_pad, at = 0;
  FG_TRY(find_left_out(ctx, analysis));
  FG_TRY(fg_stock_allocate(ctx, assembly->left_out[FG_LOT_IN_STOCK], places, stock));
  for (size_t i = 0; i < analysis->foil_count; i++)
    for (size_t k = 0; k < places && assembly->reason[i] == FG_LOT_IN_STOCK; k++) {
      fg_lot_clearance c = fg_lot_clearance_of(analysis, &analysis->foils[i],
                                               (int)(analysis->layout.first_bump + k));
      stock->clearance_mm[at] = c.mm;
      stock->shared_mm[at] = c.u_shared_mm;
      stock->own_mm[at++] = c.u_own_mm;
    }
  return FG_OK;
}

static void add_limit(fg_assembly_plan *plan, const char *quantity, double lower, double upper,
                      bool asked) {
  if (plan->limits == FG_ASSEMBLY_LIMITS_MAX) return;
  plan->limit[plan->limits++] =
      (fg_assembly_limit){fg_quantity_of_bearing_for(quantity), lower, upper, asked};
}

/* Requirements of a bearing. A rotor must have room: at its best place, or, where the crowns leave
 * half of the bearing open, on the sleeve's axis. Also noted: contact on the axis, and the design's
 * tolerances. */
static void plan_assembly(fg_lot_analysis *analysis) {
  fg_lot_assembly *assembly = &analysis->assembly;
  const fg_lot_settings *settings = &analysis->lot->settings;
  fg_assembly_plan *plan = &assembly->plan;
  double angle[FG_BEARING_BUMPS_MAX], level[FG_BEARING_BUMPS_MAX];
  fg_bearing_clearance round;
  fg_context unused;
  size_t places = analysis->layout.pads * analysis->layout.bumps_per_pad;
  *plan = (fg_assembly_plan){.layout = analysis->layout,
                             .bearings = settings->assembly.bearings,
                             .seed = settings->assembly.seed,
                             .confidence = settings->confidence};
  for (size_t i = 0; i < places; i++) {
    angle[i] = fg_bearing_angle_deg(&plan->layout, i / plan->layout.bumps_per_pad,
                                    i % plan->layout.bumps_per_pad);
    level[i] = 0;
  }
  assembly->centred = fg_bearing_assess(&unused, angle, level, places, &round) == FG_OK &&
                      isfinite(round.centred_min_mm);
  add_limit(plan, "clearance_min_mm", 0, INFINITY, !assembly->centred);
  if (assembly->centred) add_limit(plan, "clearance_centred_min_mm", 0, INFINITY, true);
  for (size_t i = 0; i < settings->design.tolerance_count; i++) {
    const fg_tolerance *tolerance = &settings->design.tolerances[i];
    if (fg_quantity_of_bearing_for(tolerance->quantity))
      add_limit(plan, tolerance->quantity, tolerance->lower, tolerance->upper, true);
  }
}

/* Returns the change of the clearance over a bump when its radius becomes `radius_mm` at constant
 * arc length, the foil fitted into the sleeve. */
static double move_clearance(const fg_lot *lot, const fg_bump *bump, double radius_mm) {
  const fg_design *design = &lot->settings.design;
  const fg_overall sleeve = {.radius_mm = design->bumps.sleeve_radius_mm};
  const fg_thickness strip = {.mm = design->thickness_mm};
  double clearance[2];
  for (int moved = 0; moved < 2; moved++) {
    double r = moved ? radius_mm : bump->radius_mm;
    double half = bump->bump_angle_deg * bump->radius_mm / r * rad_per_deg / 2;
    double chord = r * sin(half);
    fg_bump made = {.radius_mm = r};
    made.centre_mm.x = r * cos(half) + sqrt(sleeve.radius_mm * sleeve.radius_mm - chord * chord);
    fg_bump_derive(design, &lot->nominal, &sleeve, &strip, &made);
    clearance[moved] = made.clearance_fitted_mm;
  }
  return clearance[1] - clearance[0];
}

/* Moves every radius equally, until their mean is the design's. */
static fg_status centre_radii(const fg_lot_analysis *analysis, fg_stock *stock) {
  size_t places = stock->places, count = 0, at = 0;
  double mean = 0;
  for (int pass = 0; pass < 2; pass++)
    for (size_t i = 0; i < analysis->foil_count; i++) {
      const fg_foil *foil = analysis->foils[i].foil;
      if (analysis->assembly.reason[i] != FG_LOT_IN_STOCK) continue;
      for (size_t k = 0; k < foil->bump_count; k++) {
        const fg_bump *bump = &foil->bumps[k];
        size_t place = (size_t)bump->number - analysis->layout.first_bump;
        if (bump->number < (int)analysis->layout.first_bump || place >= places) continue;
        if (pass == 0)
          mean += (bump->radius_mm - mean) / (double)++count;
        else
          stock->clearance_mm[at * places + place] += move_clearance(
              analysis->lot, bump,
              bump->radius_mm + analysis->lot->settings.design.bumps.radius_mm - mean);
      }
      at += (size_t)pass;
    }
  return FG_OK;
}

static fg_status halve_within(const fg_lot_analysis *analysis, fg_stock *stock) {
  (void)analysis;
  for (size_t i = 0; i < stock->foils; i++) {
    double *foil = stock->clearance_mm + i * stock->places, mean = fg_mean(foil, stock->places);
    for (size_t k = 0; k < stock->places; k++)
      foil[k] = (foil[k] + mean) / 2;
  }
  return FG_OK;
}

static fg_status halve_between(const fg_lot_analysis *analysis, fg_stock *stock) {
  (void)analysis;
  double all = fg_mean(stock->clearance_mm, stock->foils * stock->places);
  for (size_t i = 0; i < stock->foils; i++) {
    double *foil = stock->clearance_mm + i * stock->places, mean = fg_mean(foil, stock->places);
    for (size_t k = 0; k < stock->places; k++)
      foil[k] += (all - mean) / 2;
  }
  return FG_OK;
}

static const struct {
  const char *name, *words;
  fg_status (*make)(const fg_lot_analysis *analysis, fg_stock *stock);
} changes[] = {
    {"mean_radius_at_design", "the mean bump radius at the design's, arc lengths as they are",
     centre_radii},
    {"spread_within_foils_halved", "half the spread of clearance within foils", halve_within},
    {"spread_between_foils_halved", "half the spread of clearance between foils", halve_between},
};

static void add_change(fg_lot_assembly *assembly, const char *name, const char *words,
                       size_t assembled) {
  double of = (double)assembly->plan.bearings, before = assembly->drawn.assembled.share;
  double share = (double)assembled / of;
  /* As if the draws were independent; the same draws twice scatter less. */
  double scatter = sqrt((before * (1 - before) + share * (1 - share)) / of);
  assembly->change[assembly->changes++] =
      (fg_lot_change){.name = name,
                      .words = words,
                      .share = share,
                      .gain = share - before,
                      .clear = fabs(share - before) > 2 * scatter};
}

/* Sorts by gain, the largest first; equal ones keep their order. */
static void rank_changes(fg_lot_assembly *assembly) {
  fg_lot_change *change = assembly->change;
  for (size_t i = 1; i < assembly->changes; i++)
    for (size_t k = i; k > 0 && change[k].gain > change[k - 1].gain; k--) {
      fg_lot_change other = change[k];
      change[k] = change[k - 1];
      change[k - 1] = other;
    }
}

/* Returns false when a changed bump has no clearance. */
static bool has_all_clearances(const fg_stock *stock) {
  for (size_t i = 0; i < stock->foils * stock->places; i++)
    if (!isfinite(stock->clearance_mm[i])) return false;
  return true;
}

static fg_status try_change(fg_context *ctx, fg_lot_analysis *analysis, size_t i) {
  fg_lot_assembly *assembly = &analysis->assembly;
  fg_stock changed;
  fg_assembly_result result;
  FG_TRY(fg_stock_copy(ctx, &assembly->stock, &changed));
  fg_status status = changes[i].make(analysis, &changed);
  if (status == FG_OK && has_all_clearances(&changed)) {
    status = fg_assembly_draw(ctx, &changed, &assembly->plan, false, &result);
    if (status == FG_OK) {
      add_change(assembly, changes[i].name, changes[i].words, result.assembled.count);
      fg_assembly_result_free(&result);
    }
  }
  fg_stock_free(&changed);
  return status;
}

static fg_status try_changes(fg_context *ctx, fg_lot_analysis *analysis) {
  fg_lot_assembly *assembly = &analysis->assembly;
  size_t max = assembly->stock.foils / assembly->plan.layout.pads, sorted;
  for (size_t i = 0; i < sizeof changes / sizeof *changes; i++)
    FG_TRY(try_change(ctx, analysis, i));
  assembly->classes = max < CLASSES_MAX ? max : CLASSES_MAX;
  if (assembly->classes > 1) {
    FG_TRY(fg_assembly_draw_sorted(ctx, &assembly->stock, &assembly->plan, assembly->classes,
                                   &sorted));
    add_change(assembly, "foils_sorted", "foils of like mean clearance together", sorted);
  }
  rank_changes(assembly);
  return FG_OK;
}

fg_status fg_lot_analyse_assembly(fg_context *ctx, fg_lot_analysis *analysis) {
  fg_lot_assembly *assembly = &analysis->assembly;
  const fg_lot_settings *settings = &analysis->lot->settings;
  size_t pads = analysis->layout.pads, places = pads * analysis->layout.bumps_per_pad;
  assembly->clearance_mm = analysis->lot->nominal.clearance_mm;
  assembly->deviation_pct = settings->assembly.design_deviation_pct;
  assembly->asked = settings->assembly.bearings > 0;
  if (!assembly->asked) return FG_OK;
  FG_TRY(fill_stock(ctx, analysis));
  plan_assembly(analysis);
  if (!analysis->foil_count)
    snprintf(assembly->why, sizeof assembly->why, "No bearings are drawn: no foil was measured.");
  else if (assembly->stock.foils < pads)
    snprintf(assembly->why, sizeof assembly->why,
             "No bearings are drawn: %zu of %zu foils can be built in, a bearing takes %zu "
             "different ones.",
             assembly->stock.foils, analysis->foil_count, pads);
  else if (places < 3)
    snprintf(assembly->why, sizeof assembly->why,
             "No bearings are drawn: a bearing of %zu bump%s has no circle.", places,
             fg_plural(places));
  memcpy(assembly->statement[0], assembly->why, sizeof assembly->why);
  if (assembly->why[0]) return FG_OK;
  FG_TRY(fg_assembly_draw(ctx, &assembly->stock, &assembly->plan, true, &assembly->drawn));
  FG_TRY(fg_assembly_draw_design(ctx, assembly->clearance_mm,
                                 fabs(assembly->clearance_mm) * assembly->deviation_pct / 100,
                                 &assembly->plan, &assembly->design));
  FG_TRY(try_changes(ctx, analysis));
  fg_lot_summarise_assembly(analysis);
  return FG_OK;
}

void fg_lot_assembly_free(fg_lot_assembly *assembly) {
  fg_assembly_result_free(&assembly->drawn);
  fg_assembly_result_free(&assembly->design);
  fg_stock_free(&assembly->stock);
  free(assembly->reason);
  *assembly = (fg_lot_assembly){.asked = false};
}
