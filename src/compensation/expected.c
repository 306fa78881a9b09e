/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The expected lot: means with intervals, and the shares within the design's tolerances. */
#include "compensation/expected.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "compensation/draws.h"
#include "core/memory.h"
#include "core/select.h"
#include "foilgauge/foil_kind.h"
#include "foilgauge/quantity.h"
#include "lot/statistics/assembly.h"

enum {
  DRAWS = 4000,       /* of means: their quantiles are known to 2 % of an interval */
  LOT_DRAWS = 300,    /* of whole lots, foil by foil */
  LOT_FOILS = 60,     /* of each: a larger lot's shares scatter as those of so many */
  BEARING_DRAWS = 60, /* lots that bearings are drawn from, */
  BEARINGS = 200,     /* so many of each */
};

/* Draws of one value: of the process, of the lot's mean, and squares of single foils about it. */
typedef struct value_draws {
  double process[DRAWS], lot[DRAWS], single;
} value_draws;

enum { VALUES_BY_BUMP = 3, WHOLE_VALUES = 2 };

static size_t value_count(size_t bumps) {
  return WHOLE_VALUES + VALUES_BY_BUMP * bumps;
}

static double value_of_foil(const fg_drawn_foil *foil, size_t value) {
  if (value < WHOLE_VALUES) return value ? foil->pitch_deg : foil->overall_radius_mm;
  size_t bump = (value - WHOLE_VALUES) / VALUES_BY_BUMP;
  switch ((value - WHOLE_VALUES) % VALUES_BY_BUMP) {
  case 0:
    return foil->radius_mm[bump];
  case 1:
    return foil->angle_deg[bump];
  default:
    return foil->height_mm[bump];
  }
}

static void draw_values(fg_drawer *drawer, size_t bumps, double foils, value_draws *draws) {
  fg_drawn_process process;
  fg_drawn_foil own, mean, single;
  for (size_t d = 0; d < DRAWS; d++) {
    fg_draw_process(drawer, &process);
    fg_process_foil(drawer, &process, &own);
    fg_draw_mean(drawer, &process, foils, &mean);
    fg_draw_foil(drawer, &process, &single);
    for (size_t v = 0; v < value_count(bumps); v++) {
      double of_process = value_of_foil(&own, v), step = value_of_foil(&single, v) - of_process;
      draws[v].process[d] = of_process;
      draws[v].lot[d] = value_of_foil(&mean, v);
      draws[v].single += step * step / DRAWS;
    }
  }
}

static fg_expected_value summarise_draws(value_draws *draws) {
  double sum = 0, squares = 0;
  for (size_t d = 0; d < DRAWS; d++)
    sum += draws->process[d] / DRAWS;
  for (size_t d = 0; d < DRAWS; d++)
    squares += (draws->process[d] - sum) * (draws->process[d] - sum) / DRAWS;
  fg_sort(draws->lot, DRAWS);
  return (fg_expected_value){.value = sum,
                             .u = sqrt(squares),
                             .low = draws->lot[DRAWS / 40],
                             .high = draws->lot[DRAWS - 1 - DRAWS / 40],
                             .sd = sqrt(draws->single)};
}

static fg_status find_values(fg_context *ctx, fg_drawer *drawer, size_t bumps,
                             fg_expected_lot *expected) {
  value_draws *draws;
  FG_TRY(fg_memory_allocate(ctx, value_count(bumps), sizeof *draws, (void **)&draws));
  draw_values(drawer, bumps, (double)expected->foils, draws);
  expected->overall_radius_mm = summarise_draws(&draws[0]);
  if (bumps) expected->pitch_deg = summarise_draws(&draws[1]);
  expected->bumps = bumps;
  for (size_t i = 0; i < bumps; i++) {
    value_draws *of = draws + WHOLE_VALUES + VALUES_BY_BUMP * i;
    expected->bump[i] = (fg_expected_bump){(int)i + 1, summarise_draws(&of[0]),
                                           summarise_draws(&of[1]), summarise_draws(&of[2])};
  }
  free(draws);
  return FG_OK;
}

/* ---- shares of whole lots ---- */

/* A tolerance that springback decides, with the row of its quantity. */
typedef struct asked_limit {
  const fg_quantity *row;
  bool of_bump;
  double lower, upper;
  double share[LOT_DRAWS];
} asked_limit;

typedef struct drawn_lots {
  const fg_next_die *next;
  asked_limit limit[FG_TOLERANCES_MAX];
  size_t limits, foils;
  double share[LOT_DRAWS], assembled[BEARING_DRAWS];
  fg_stock stock; /* clearances of the foils of one lot */
  fg_assembly_plan plan;
} drawn_lots;

static void list_limits(const fg_design *design, drawn_lots *lots) {
  for (size_t i = 0; i < design->tolerance_count; i++) {
    const fg_tolerance *tolerance = &design->tolerances[i];
    const fg_quantity *row = fg_quantity_find(FG_QUANTITY_OF_BUMP, tolerance->quantity);
    bool of_bump = row != NULL;
    if (!row && !strncmp(tolerance->quantity, "overall.", strlen("overall.")))
      row = fg_quantity_find(FG_QUANTITY_OF_FOIL, tolerance->quantity);
    if (!row || row->kind != FG_QUANTITY_NUMBER || (of_bump && !lots->next->die.bumps)) continue;
    lots->limit[lots->limits++] =
        (asked_limit){row, of_bump, tolerance->lower, tolerance->upper, {0}};
  }
}

/* A drawn foil with everything that is derived of a measured one. */
static void fill_measured(const fg_next_die *next, const fg_drawn_foil *drawn, fg_foil *foil,
                          fg_bump *bumps) {
  const fg_design *design = &next->target;
  const fg_thickness strip = {.mm = design->thickness_mm};
  double r0 = drawn->overall_radius_mm;
  *foil = (fg_foil){.bumps = bumps, .bump_count = next->die.bumps};
  foil->overall.radius_mm = r0;
  foil->overall.springback_error_pct =
      100 * (design->overall_radius_mm - r0) / design->overall_radius_mm;
  for (size_t i = 0; i < next->die.bumps; i++) {
    bumps[i] = (fg_bump){.number = (int)i + 1, .radius_mm = drawn->radius_mm[i]};
    bumps[i].centre_mm.x = r0 + drawn->radius_mm[i] - drawn->height_mm[i];
    fg_bump_derive(design, &next->nominal, &foil->overall, &strip, &bumps[i]);
  }
}

static bool is_within(const asked_limit *limit, const fg_foil *foil) {
  if (!limit->of_bump) {
    double value = fg_quantity_value(limit->row, foil);
    return value >= limit->lower && value <= limit->upper;
  }
  for (size_t i = 0; i < foil->bump_count; i++) {
    double value = fg_quantity_value(limit->row, &foil->bumps[i]);
    if (!(value >= limit->lower && value <= limit->upper)) return false;
  }
  return true;
}

/* Draws the foils of one lot and counts those within. */
static void draw_lot(fg_drawer *drawer, drawn_lots *lots, size_t d) {
  fg_drawn_process process;
  fg_drawn_foil drawn;
  fg_foil foil;
  fg_bump bumps[FG_COMPENSATION_BUMPS];
  double each = 1 / (double)lots->foils;
  fg_draw_process(drawer, &process);
  for (size_t f = 0; f < lots->foils; f++) {
    bool all = true;
    fg_draw_foil(drawer, &process, &drawn);
    fill_measured(lots->next, &drawn, &foil, bumps);
    for (size_t k = 0; k < lots->limits; k++) {
      bool within = is_within(&lots->limit[k], &foil);
      lots->limit[k].share[d] += within ? each : 0;
      all = all && within;
    }
    lots->share[d] += all ? each : 0;
    for (size_t i = 0; i < lots->stock.places; i++)
      lots->stock.clearance_mm[f * lots->stock.places + i] = bumps[i].clearance_fitted_mm;
  }
}

/* Middle 95 % of the shares of drawn lots. */
static double spread_shares(double *share, size_t count, double *low, double *high) {
  double mean = 0;
  for (size_t i = 0; i < count; i++)
    mean += share[i] / (double)count;
  fg_sort(share, count);
  *low = share[(count - 1) / 40];
  *high = share[count - 1 - (count - 1) / 40];
  return mean;
}

/* A bearing takes the pads that fit around at the target's pitch; a rotor must have room in it. */
static fg_status plan_bearings(fg_context *ctx, drawn_lots *lots) {
  const fg_next_die *next = lots->next;
  size_t places = next->die.bumps;
  double turn = (double)places * next->target.bumps.pitch_deg;
  size_t pads = places ? (size_t)fmax(1, floor(360 * (1 + 1e-6) / turn)) : 0;
  if (!pads || lots->foils < pads || pads * places > FG_BEARING_BUMPS_MAX) return FG_OK;
  lots->plan = (fg_assembly_plan){.layout = {pads, places, 1, next->target.bumps.pitch_deg},
                                  .bearings = BEARINGS,
                                  .seed = 1,
                                  .confidence = 0.95,
                                  .limits = 1};
  lots->plan.limit[0] = (fg_assembly_limit){fg_quantity_of_bearing_for("clearance_centred_min_mm"),
                                            0, INFINITY, true};
  return fg_stock_allocate(ctx, lots->foils, places, &lots->stock);
}

static fg_status draw_bearings(fg_context *ctx, drawn_lots *lots, size_t d) {
  fg_assembly_result result = {.rejected = {0}};
  FG_TRY(fg_assembly_draw(ctx, &lots->stock, &lots->plan, false, &result));
  lots->assembled[d] = result.assembled.share;
  fg_assembly_result_free(&result);
  return FG_OK;
}

static void fill_shares(drawn_lots *lots, fg_expected_lot *expected) {
  expected->share = expected->share_low = expected->share_high = NAN;
  expected->assembled = expected->assembled_low = expected->assembled_high = NAN;
  for (size_t k = 0; k < lots->limits; k++) {
    asked_limit *limit = &lots->limit[k];
    fg_expected_share *share = &expected->tolerance[expected->tolerances++];
    *share = (fg_expected_share){.lower = limit->lower, .upper = limit->upper};
    snprintf(share->quantity, sizeof share->quantity, "%s", limit->row->name);
    share->share = spread_shares(limit->share, LOT_DRAWS, &share->low, &share->high);
  }
  if (lots->limits)
    expected->share =
        spread_shares(lots->share, LOT_DRAWS, &expected->share_low, &expected->share_high);
  if (lots->stock.foils)
    expected->assembled = spread_shares(lots->assembled, BEARING_DRAWS, &expected->assembled_low,
                                        &expected->assembled_high);
}

static fg_status find_shares(fg_context *ctx, fg_drawer *drawer, const fg_next_die *next,
                             fg_expected_lot *expected) {
  drawn_lots *lots;
  fg_status status = FG_OK;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *lots, (void **)&lots));
  lots->next = next;
  lots->foils = expected->foils < LOT_FOILS ? expected->foils : LOT_FOILS;
  list_limits(&next->target, lots);
  FG_TRY_EXIT(plan_bearings(ctx, lots));
  for (size_t d = 0; d < LOT_DRAWS; d++) {
    draw_lot(drawer, lots, d);
    if (lots->stock.foils && d < BEARING_DRAWS) FG_TRY_EXIT(draw_bearings(ctx, lots, d));
  }
  fill_shares(lots, expected);
exit:
  fg_stock_free(&lots->stock);
  free(lots);
  return status;
}

fg_status fg_expected_lot_find(fg_context *ctx, const fg_formed_sets *sets, fg_next_die *next) {
  fg_drawer drawer;
  FG_TRY(fg_drawer_begin(ctx, next->laws, &next->die, sets, &drawer));
  fg_status status = find_values(ctx, &drawer, next->die.bumps, &next->expected);
  if (status == FG_OK) status = find_shares(ctx, &drawer, next, &next->expected);
  fg_drawer_end(&drawer);
  return status;
}
