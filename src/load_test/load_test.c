/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/load_test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "load_test/analysis.h"
#include "load_test/break_away.h"
#include "load_test/noise.h"

fg_load_options fg_load_options_default(void) {
  return (fg_load_options){.threshold_n = FG_LOAD_THRESHOLD_N,
                           .u_force_pct = FG_LOAD_U_FORCE_PCT,
                           .u_displacement_pct = FG_LOAD_U_DISPLACEMENT_PCT,
                           .diameter_mm = FG_LOAD_DIAMETER_MM,
                           .length_mm = FG_LOAD_LENGTH_MM,
                           .u_weight_pct = FG_LOAD_U_WEIGHT_PCT,
                           .lever_mm = NAN,
                           .rig_n_mm = NAN};
}

const char *fg_load_quantity_name(fg_load_quantity quantity) {
  static const char *const names[FG_LOAD_QUANTITIES] = {
      [FG_LOAD_CLEARANCE] = "clearance_mm",
      [FG_LOAD_STIFFNESS] = "stiffness_n_mm",
      [FG_LOAD_LOSS] = "loss_factor",
      [FG_LOAD_PRELOAD] = "preload_kpa",
      [FG_LOAD_HYSTERESIS] = "radial_hysteresis_n",
      [FG_LOAD_FRICTION] = "friction_coefficient",
  };
  return names[quantity];
}

const fg_load_flag *fg_load_flags(void) {
  static const fg_load_flag flags[] = {
      {FG_LOAD_NO_CONTACT, "no_contact",
       "the force never passes the threshold: the foil is not touched, there is no clearance"},
      {FG_LOAD_ONE_SIDE, "one_side", "pushed or pulled only: a clearance takes both"},
      {FG_LOAD_TOO_FEW, "too_few_samples", "too few samples, or no travel"},
      {FG_LOAD_WRONG_WAY, "energy_gained",
       "the loops run the wrong way round: are the rows in the order of time?"},
      {FG_LOAD_ZERO_OFF, "zero_off",
       "the load cell's zero is off by more than half of the threshold: set it, or choose a higher "
       "threshold"},
      {FG_LOAD_NO_GAP, "no_gap",
       "no gap: the foils of both sides touch the rotor at once, or within U; there is no "
       "clearance"},
      {FG_LOAD_GAP_UNKNOWN, "gap_not_known",
       "the record does not say whether there is a gap: the travel may be that of foils that press "
       "the rotor, and no clearance is named"},
      {FG_LOAD_UNITS, "units_suspect",
       "a clearance beyond 5 % of the diameter or below 1 um, or a stiffness beyond 1e5 N/mm: are "
       "the units what they say?"},
      {FG_LOAD_UNSAMPLED, "unsampled",
       "the threshold is passed in a stretch that the record did not sample: U holds the stretch, "
       "and where that leaves nothing known there is no clearance"},
      {FG_LOAD_SAME_SIDE, "same_side",
       "push and pull contact lie on the same side of the gap: there is no clearance"},
      {FG_LOAD_BRANCHES_APART, "branches_apart",
       "loading and unloading pass the threshold further apart than friction and U explain: there "
       "is no clearance"},
      {FG_LOAD_OUTLIERS, "outliers",
       "readings that jump away from their neighbours and back took no part: look at plug and "
       "probe"},
      {FG_LOAD_SATURATED, "saturated",
       "force or displacement stays at its largest reading while the other moves on, as at the end "
       "of an instrument's range: those samples took no part, and the loops are not known"},
      {FG_LOAD_LOOPS, "loops_on_the_way",
       "the displacement goes back and forth on the way: those samples took no part"},
      {FG_LOAD_ONE_SENSE, "one_sense",
       "the strokes all run the same way: a clearance takes the strokes of both"},
      {FG_LOAD_FORCE_TURNED, "force_turned",
       "the force runs against the displacement, as a reaction does; its sign was turned"},
      {FG_LOAD_AT_END, "stiffness_at_end",
       "the stiffness is largest at the last place before the turn: a foil that hardens is stiffer "
       "at the turn and beyond"},
      {FG_LOAD_FRICTION_HIGH, "friction_high",
       "friction in the middle is more than half of the threshold: choose a higher one (from the "
       "threshold on there is no clearance)"},
      {FG_LOAD_ONE_CYCLE, "one_cycle", "one cycle: nothing says how cycles differ"},
      {0, NULL, NULL},
  };
  return flags;
}

static void find_ranges(const fg_load_test *test, fg_load_direction *d) {
  const fg_load_sample *s = test->samples + d->first;
  double low = INFINITY, high = -INFINITY;
  d->force_low_n = INFINITY, d->force_high_n = -INFINITY;
  for (size_t i = 0; i < d->count; i++) {
    low = fmin(low, s[i].x_mm), high = fmax(high, s[i].x_mm);
    d->force_low_n = fmin(d->force_low_n, s[i].force_n);
    d->force_high_n = fmax(d->force_high_n, s[i].force_n);
  }
  d->travel_mm = high - low;
}

/* Corrects the force's sign: a load cell may read the pushing or the resisting force. */
static void negate_force(fg_load_test *test, fg_load_direction *d) {
  fg_load_sample *s = test->samples + d->first;
  double x = 0, f = 0, together = 0, n = (double)d->count;
  for (size_t i = 0; i < d->count; i++)
    x += s[i].x_mm / n, f += s[i].force_n / n;
  for (size_t i = 0; i < d->count; i++)
    together += (s[i].x_mm - x) * (s[i].force_n - f);
  if (together >= 0) return;
  for (size_t i = 0; i < d->count; i++)
    s[i].force_n = -s[i].force_n;
  d->flags |= FG_LOAD_FORCE_TURNED;
}

/* Range of plausible clearances, outside of which the unit is wrong: a share of the bore, and the
 * roundness of a rotor. */
static const double clearance_share_max = 0.05, clearance_min_mm = 0.001;

/* Likewise of a stiffness: of steel as thick as the foil is, not of a foil. */
static const double stiffness_max_n_mm = 1e5;

static void forget_clearance(fg_load_direction *d) {
  d->clearance = d->unloading = d->gap = (fg_load_value){NAN, NAN, NAN};
  d->push_mm = d->pull_mm = NAN;
}

/* U = 2 u: a gap within it is none that is shown. */
static const double gap_reach = 2;

/* Upper limit of y (dF/dx) / F: a foil's force grows with its compression y at most as y², so that
 * y is at most 2 F / (dF/dx). Travel beyond that of both sides is free. */
static const double yield_max = 2;

static double find_yield_mm(const fg_load_test *test, const fg_load_findings *findings) {
  return yield_max * test->options.threshold_n * findings->compliance_mm_n;
}

/* Checks the gap. Without a gap there is no free place, and so neither a zero nor a friction of the
 * rig alone. When the branches allow anything between no gap and the whole travel, the travel
 * decides. */
static void check_gap(double yield_mm, fg_load_zero *zero, fg_load_direction *d) {
  double u = gap_reach * d->gap.u_repeat, c = d->clearance.value;
  const fg_load_value none = {NAN, NAN, NAN};
  bool known = isfinite(d->gap.value), decided = known && !(d->gap.value + u >= c);
  if (known && d->gap.value > u) return;
  if (!isfinite(c) && !(known && u < yield_mm)) { /* no U to compare with */
    d->gap = none;
    return;
  }
  if (c - yield_mm > gap_reach * d->clearance.u_repeat) {
    if (!decided) d->gap = none;
    return;
  }
  d->flags |= known ? FG_LOAD_NO_GAP : FG_LOAD_GAP_UNKNOWN;
  d->flags &= ~(unsigned)FG_LOAD_UNSAMPLED;
  forget_clearance(d);
  d->zero_n = zero->force_n = zero->friction_n = NAN;
}

/* An unsampled stretch may leave anything between nothing and twice the value. */
static bool leaves_nothing(const fg_load_direction *d) {
  return (d->flags & FG_LOAD_UNSAMPLED) && !(d->clearance.value > 2 * d->clearance.u_repeat);
}

/* Flags a clearance that is none although both thresholds are passed. */
static void check_clearance(const fg_load_test *test, const fg_load_zero *zero,
                            fg_load_direction *d) {
  double t = test->options.threshold_n, c = d->clearance.value;
  if (fabs(zero->force_n) > t / 2) d->flags |= FG_LOAD_ZERO_OFF;
  if (zero->friction_n > t / 2) d->flags |= FG_LOAD_FRICTION_HIGH;
  if (c <= 0 && !leaves_nothing(d)) d->flags |= FG_LOAD_NO_GAP;
  if ((d->flags & (FG_LOAD_ZERO_OFF | FG_LOAD_NO_GAP | FG_LOAD_CONTRADICTION)) ||
      zero->friction_n >= t || leaves_nothing(d))
    forget_clearance(d);
  else if (c > clearance_share_max * test->options.diameter_mm || c < clearance_min_mm)
    d->flags |= FG_LOAD_UNITS;
}

/* Discards everything for rows that are not in the order of time: loading and unloading may be
 * exchanged. */
static void withhold_all(fg_load_direction *d) {
  const fg_load_value none = {NAN, NAN, NAN};
  forget_clearance(d);
  d->stiffness = d->secant = d->loss = d->loss_secant = d->loss_foil = none;
  d->stiffness_at_mm = NAN;
  d->flags &= ~(unsigned)FG_LOAD_AT_END;
  d->friction = (fg_load_friction){NAN, NAN, NAN, NAN, NAN};
}

static bool is_one_sense(const fg_load_strokes *strokes) {
  for (size_t i = 1; i < strokes->count; i++)
    if (strokes->stroke[i].sense != strokes->stroke[0].sense) return false;
  return strokes->count > 1;
}

static void say_why_not(const fg_load_test *test, const fg_load_strokes *strokes,
                        fg_load_direction *d) {
  enum {
    REASONS = FG_LOAD_ZERO_OFF | FG_LOAD_NO_GAP | FG_LOAD_WRONG_WAY | FG_LOAD_FRICTION_HIGH |
              FG_LOAD_UNSAMPLED | FG_LOAD_CONTRADICTION | FG_LOAD_GAP_UNKNOWN
  };
  if (isfinite(d->clearance.value)) {
    if (d->cycles < 2) d->flags |= FG_LOAD_ONE_CYCLE;
    return;
  }
  if (d->flags & REASONS) return;
  double t = test->options.threshold_n;
  bool push = d->force_high_n > t, pull = d->force_low_n < -t;
  if (!d->strokes)
    d->flags |= FG_LOAD_TOO_FEW;
  else if (!push && !pull)
    d->flags |= FG_LOAD_NO_CONTACT;
  else
    d->flags |= !(push && pull)         ? FG_LOAD_ONE_SIDE
                : is_one_sense(strokes) ? FG_LOAD_ONE_SENSE
                                        : FG_LOAD_TOO_FEW;
}

static fg_status measure_direction(fg_context *ctx, fg_load_test *test,
                                   const fg_load_records *records, fg_load_direction *d,
                                   fg_load_findings *findings) {
  fg_load_strokes strokes = {0};
  fg_load_zero zero;
  fg_load_levels levels = {.threshold_n = test->options.threshold_n};
  fg_status status = FG_OK;
  const fg_load_value none = {NAN, NAN, NAN};
  d->predicted = d->difference = none;
  FG_TRY_EXIT(fg_load_bridge_outliers(ctx, test, d));
  negate_force(test, d);
  find_ranges(test, d);
  d->step_mm = fg_load_find_step(test->samples + d->first, d->count);
  FG_TRY_EXIT(fg_load_strokes_cut(ctx, test, d, records, &strokes));
  FG_TRY_EXIT(fg_load_find_noise(ctx, test->samples + d->first, d->step_mm, &strokes));
  d->noise_n = strokes.count ? strokes.noise_n : NAN;
  d->noise_mm = strokes.count ? strokes.noise_mm : NAN;
  d->strokes = strokes.count;
  d->cycles = strokes.count / 2;
  FG_TRY_EXIT(fg_load_find_zero(ctx, &strokes, &zero));
  d->zero_n = zero.force_n;
  levels.zero_n = isfinite(zero.force_n) ? zero.force_n : 0;
  FG_TRY_EXIT(fg_load_find_points(ctx, &strokes, levels, d, findings));
  double yield_mm = find_yield_mm(test, findings);
  fg_load_find_gap(&strokes, zero, yield_mm, d);
  check_gap(yield_mm, &zero, d);
  FG_TRY_EXIT(fg_load_check_contacts(ctx, &strokes, zero.place_mm, d));
  check_clearance(test, &zero, d);
  FG_TRY_EXIT(fg_load_find_stiffness(ctx, &strokes, d, findings));
  if (d->stiffness.value > stiffness_max_n_mm) d->flags |= FG_LOAD_UNITS;
  FG_TRY_EXIT(fg_load_find_loops(ctx, test, &strokes, &zero, d));
  FG_TRY_EXIT(fg_load_find_friction(ctx, &strokes, d));
  if (d->flags & FG_LOAD_WRONG_WAY) withhold_all(d);
  say_why_not(test, &strokes, d);
exit:
  fg_load_strokes_free(&strokes);
  return status;
}

static void widen_value(fg_load_value *value, double birge, double scale_pct, double more) {
  value->u_repeat *= birge;
  value->u = sqrt(pow(value->u_repeat, 2) + pow(scale_pct / 100 * value->value, 2) + more * more);
}

/* The instruments' scales are in the area as they are in K X². */
static void widen_loss(fg_load_direction *d) {
  double area = d->area.u_repeat / d->area.value, k = d->stiffness.u_repeat / d->stiffness.value;
  d->loss.u = d->loss.u_repeat = fabs(d->loss.value) * hypot(area, k);
  double secant = d->secant.u_repeat / d->secant.value;
  d->loss_secant.u = d->loss_secant.u_repeat = fabs(d->loss_secant.value) * hypot(area, secant);
  d->loss_foil.u = d->loss_foil.u_repeat;
}

/* Widens a bearing's directions by the scatter of repeats, and adds the instruments' share. */
static void finish_bearing(fg_load_test *test, const fg_load_findings *findings, size_t bearing) {
  const fg_load_options *o = &test->options;
  fg_load_scatter points = {0}, slopes = {0};
  for (size_t i = 0; i < test->direction_count; i++)
    if (test->directions[i].bearing == bearing) {
      points.chi2 += findings[i].points.chi2, points.dof += findings[i].points.dof;
      slopes.chi2 += findings[i].slopes.chi2, slopes.dof += findings[i].slopes.dof;
    }
  double birge = fg_load_birge(&points), steep = fg_load_birge(&slopes);
  double both = hypot(o->u_force_pct, o->u_displacement_pct);
  test->bearings[bearing].birge = birge;
  for (size_t i = 0; i < test->direction_count; i++) {
    fg_load_direction *d = &test->directions[i];
    if (d->bearing != bearing) continue;
    double threshold = o->threshold_n * o->u_force_pct / 100 * findings[i].compliance_mm_n;
    widen_value(&d->clearance, birge, o->u_displacement_pct, threshold);
    widen_value(&d->gap, birge, o->u_displacement_pct, 0);
    widen_value(&d->unloading, birge, o->u_displacement_pct, threshold);
    widen_value(&d->stiffness, steep, both, 0);
    widen_value(&d->area, 1, both, 0);
    widen_value(&d->secant, 1, both, 0);
    widen_loss(d);
    for (int side = 0; side < FG_LOAD_SIDES; side++)
      for (size_t k = 0; k < d->profile[side].count; k++)
        d->profile[side].point[k].u_stiffness_n_mm *= steep;
  }
}

fg_status fg_load_test_measure(fg_context *ctx, const fg_load_options *options,
                               const fg_load_source *sources, size_t count, fg_load_test *test) {
  fg_status status = FG_OK;
  fg_load_records records = {0};
  fg_load_findings *findings = NULL;
  fg_numerics_start();
  *test = (fg_load_test){.options = *options};
  FG_TRY_EXIT(fg_load_records_read(ctx, sources, count, test, &records));
  FG_TRY_EXIT(fg_memory_allocate(ctx, test->direction_count, sizeof *findings, (void **)&findings));
  for (size_t i = 0; i < test->direction_count; i++)
    FG_TRY_EXIT(measure_direction(ctx, test, &records, &test->directions[i], &findings[i]));
  for (size_t i = 0; i < test->bearing_count; i++)
    finish_bearing(test, findings, i);
  FG_TRY_EXIT(fg_break_away_read(ctx, test));
  if (options->lot) FG_TRY_EXIT(fg_load_predict(ctx, test));
  for (size_t i = 0; i < test->bearing_count; i++) {
    fg_load_sum_bearing(test, i, &test->bearings[i]);
    fg_load_sum_hysteresis(test, i, &test->bearings[i]);
    fg_load_sum_break_away(test, i, &test->bearings[i]);
  }
exit:
  fg_load_records_free(&records);
  free(findings);
  if (status != FG_OK) fg_load_test_free(test);
  return status;
}

void fg_load_test_free(fg_load_test *test) {
  if (!test) return;
  for (size_t i = 0; i < test->file_count; i++) {
    free(test->files[i].path);
    free(test->files[i].not_read);
  }
  free(test->files);
  free(test->bearings);
  free(test->directions);
  free(test->samples);
  free(test->pulls);
  memset(test, 0, sizeof *test);
}
