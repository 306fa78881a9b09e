/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uncertainty of a lot's means: statistical errors average out, the calibration's error is the same
 * in every foil. */
#include <math.h>
#include <string.h>

#include "foilgauge/distribution.h"
#include "foilgauge/foil_kind.h"
#include "foilgauge/traceability.h"
#include "lot/statistics/analysis.h"
#include "quantity/quantity_rows.h"

/* Sums over the values of a foil, and of the lot. `alike` is the common error by the thickness,
 * whose uncertainty is mainly that of the scanner's tone curve. */
typedef struct sums {
  double u, squares, alike, move[FG_CALIBRATION_SOURCES];
  size_t count;
} sums;

/* A quantity with its sums. */
typedef struct reading {
  fg_lot_quantity *quantity;
  size_t at;  /* index of the quantity in the moves */
  bool whole; /* its whole error is common */
  sums foil, all;
} reading;

enum { READINGS_MAX = 2 * (FG_QUANTITY_SHOWN_MAX + FG_TOLERANCES_MAX) };

typedef struct readings {
  const fg_lot_analysis *analysis;
  reading reading[READINGS_MAX];
  size_t count;
} readings;

/* Makes a strip thicker by its statistical u. */
static fg_foil thicken(const fg_foil *foil) {
  fg_foil thick = *foil;
  fg_quantity_narrow_calibrated(FG_QUANTITY_OF_FOIL, &thick, &foil->calibrated);
  double u = isfinite(thick.thickness.u_mm) ? thick.thickness.u_mm : 0;
  thick.thickness.mm += u;
  if (thick.thickness.u_scan_mm > 0) thick.thickness.scan_mm += thick.thickness.u_scan_mm;
  return thick;
}

/* Finds the changes of a bump's values, derived again with the thicker strip. */
static void move_bump(const fg_lot *lot, const fg_foil *foil, const fg_foil *thick,
                      const fg_bump *bump, double moves[FG_CALIBRATED_MAX]) {
  const fg_design *design = &lot->settings.design;
  const fg_thickness strip[] = {fg_foil_thickness(design, foil), fg_foil_thickness(design, thick)};
  fg_bump both[] = {*bump, *bump};
  for (int i = 0; i < 2; i++)
    fg_bump_derive(design, &lot->nominal, &foil->overall, &strip[i], &both[i]);
  fg_quantity_keep_farthest(FG_QUANTITY_OF_BUMP, &both[0], &both[1], moves);
}

/* An unknown tone curve moves the edges alike in every scan. So a quantity between two edges, or at
 * one, has a common error. Its part is unknown where the thickness is not the only cause: the whole
 * error then counts as common. */
static bool is_common_error(const fg_design *design, const fg_quantity *row) {
  bool between = row->uses & FG_QUANTITY_BETWEEN_EDGES && !fg_foil_kind_has_bumps(design->kind) &&
                 strncmp(row->name, "thickness", 9) != 0;
  bool on_edge = row->uses & FG_QUANTITY_OF_DATUM && design->datum != FG_DATUM_MID;
  return design->tone != FG_TONE_LINEAR && (between || on_edge);
}

static void add_reading(reading *r, const void *object, const fg_calibrated *calibrated,
                        const double moves[FG_CALIBRATED_MAX]) {
  const fg_quantity *row = r->quantity->row;
  double u = fg_quantity_uncertainty(row, object);
  double own = fg_quantity_calibration(r->quantity->owner, row, calibrated);
  if (!isfinite(fg_quantity_value(row, object)) || !isfinite(u)) return;
  double alike = r->whole ? sqrt(fmax(0, u * u - own * own)) : moves[r->at];
  double statistical = fmax(0, u * u - own * own - alike * alike);
  r->foil.u += sqrt(statistical);
  r->foil.squares += statistical;
  r->foil.alike += alike;
  for (size_t s = 0; s < FG_CALIBRATION_SOURCES; s++)
    r->foil.move[s] += calibrated->move[s][r->at];
  r->foil.count++;
}

static void add_readings(readings *all, fg_quantity_owner owner, const void *object,
                         const fg_calibrated *calibrated, const double moves[FG_CALIBRATED_MAX]) {
  for (size_t i = 0; i < all->count; i++)
    if (all->reading[i].quantity->owner == owner)
      add_reading(&all->reading[i], object, calibrated, moves);
}

/* Foils that lie flat move by no thickness. */
static void read_foil(readings *all, const fg_foil *foil) {
  const fg_lot *lot = all->analysis->lot;
  fg_quantity_owner owner = all->analysis->parts;
  bool flat = fg_foil_traits_of(lot->settings.design.kind)->lies_flat;
  fg_foil thick = thicken(foil);
  double moves[FG_CALIBRATED_MAX] = {0};
  if (!flat) fg_quantity_keep_farthest(FG_QUANTITY_OF_FOIL, foil, &thick, moves);
  add_readings(all, FG_QUANTITY_OF_FOIL, foil, &foil->calibrated, moves);
  for (size_t k = 0; k < fg_part_count(foil, owner); k++) {
    const fg_foil_part part = fg_part_at(foil, owner, k);
    double part_moves[FG_CALIBRATED_MAX] = {0};
    if (!fg_lot_part_counts(foil, owner, &part)) continue;
    if (!flat) move_bump(lot, foil, &thick, part.object, part_moves);
    add_readings(all, owner, part.object, part.calibrated, part_moves);
  }
}

/* Adds the sums of the foil, and empties them. R0 errs alike in all bumps of a foil. */
static void add_foil(reading *r) {
  bool own = (r->quantity->row->uses & FG_QUANTITY_IS_OWN) != 0;
  r->all.squares += own ? r->foil.squares : r->foil.u * r->foil.u;
  r->all.alike += r->foil.alike;
  for (size_t s = 0; s < FG_CALIBRATION_SOURCES; s++)
    r->all.move[s] += r->foil.move[s];
  r->all.count += r->foil.count;
  r->foil = (sums){0};
}

static void list_readings(fg_lot_analysis *analysis, readings *all) {
  all->analysis = analysis;
  for (size_t i = 0; i < analysis->quantity_count; i++) {
    fg_lot_quantity *quantity = &analysis->quantities[i];
    quantity->mean_u = (fg_lot_mean_u){NAN, NAN, NAN};
    if (!fg_quantity_has_u(quantity->row)) continue;
    all->reading[all->count++] =
        (reading){.quantity = quantity,
                  .at = fg_quantity_move_of(quantity->owner, quantity->row),
                  .whole = is_common_error(&analysis->lot->settings.design, quantity->row)};
  }
}

static fg_lot_mean_u combine_sums(const sums *all) {
  if (!all->count) return (fg_lot_mean_u){NAN, NAN, NAN};
  double n = (double)all->count, calibration = hypot(all->move[0], all->move[1]) / n;
  double statistical = hypot(sqrt(all->squares), all->alike) / n;
  return (fg_lot_mean_u){statistical, calibration, hypot(statistical, calibration)};
}

/* Ppk is Pp at most, wherever the mean lies: `centred` is Pp, NaN with one limit. */
static void widen_ratio(double reach, const fg_ratio *centred, fg_ratio *ratio) {
  double high = ratio->value + hypot(ratio->high - ratio->value, reach);
  ratio->low = ratio->value - hypot(ratio->value - ratio->low, reach);
  bool bounded = isfinite(high) && isfinite(centred->high);
  ratio->high = bounded ? fmin(high, fmax(ratio->high, centred->high)) : high;
}

void fg_lot_widen_capability(double confidence, double u, fg_lot_quantity *quantity) {
  fg_capability *c = &quantity->capability;
  if (!quantity->has_capability) return;
  double z = fg_distribution_normal_quantile((1 + (confidence > 0 ? confidence : 0.95)) / 2);
  double reach = z * u / (3 * c->sd);
  bool two_limits = isfinite(c->p.value);
  double sigmas = two_limits ? c->c.value / c->p.value : c->ck.value / c->pk.value;
  widen_ratio(reach, &c->p, &c->pk);
  widen_ratio(reach * sigmas, &c->c, &c->ck);
}

/* The error that all values share has no bound where nothing is known of the scanner's scale. */
static void widen_by_mean(const fg_lot_settings *settings, fg_lot_quantity *quantity) {
  bool known = fg_design_may_judge(&settings->design) || !fg_quantity_has_u(quantity->row);
  double u = isfinite(quantity->mean_u.u) ? quantity->mean_u.u : 0;
  fg_lot_widen_capability(settings->confidence, known ? u : NAN, quantity);
}

void fg_lot_find_mean_u(fg_lot_analysis *analysis) {
  readings all = {0};
  list_readings(analysis, &all);
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const fg_foil *foil = analysis->foils[i].foil;
    if (fg_foil_is_measured(foil)) read_foil(&all, foil);
    for (size_t k = 0; k < all.count; k++)
      add_foil(&all.reading[k]);
  }
  for (size_t k = 0; k < all.count; k++)
    all.reading[k].quantity->mean_u = combine_sums(&all.reading[k].all);
  for (size_t i = 0; i < analysis->quantity_count; i++)
    widen_by_mean(&analysis->lot->settings, &analysis->quantities[i]);
}

/* Returns the change of ln K by one standard deviation of a source. */
static double relative_move(const fg_foil *foil, const fg_bump *bump, size_t source,
                            const fg_arch_sensitivity *sensitivity) {
  static const char *const names[] = {"radius_mm", "bump_angle_deg"};
  const double slopes[] = {sensitivity->radius, sensitivity->angle};
  double sum = 0;
  for (size_t i = 0; i < 2; i++) {
    const fg_quantity *row = fg_quantity_find(FG_QUANTITY_OF_BUMP, names[i]);
    size_t at = fg_quantity_move_of(FG_QUANTITY_OF_BUMP, row);
    sum += slopes[i] * bump->calibrated.move[source][at] / fg_quantity_value(row, bump);
  }
  const fg_quantity *row = fg_quantity_find(FG_QUANTITY_OF_FOIL, "thickness_mm");
  double thickness = fg_quantity_value(row, foil);
  if (thickness > 0)
    sum += sensitivity->thickness *
           foil->calibrated.move[source][fg_quantity_move_of(FG_QUANTITY_OF_FOIL, row)] / thickness;
  return sum;
}

double fg_lot_stiffness_calibration(const fg_lot_analysis *analysis) {
  double sum[FG_CALIBRATION_SOURCES] = {0};
  size_t count = 0;
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const fg_foil *foil = analysis->foils[i].foil;
    for (size_t b = 0; fg_foil_is_measured(foil) && b < foil->bump_count; b++) {
      const fg_bump *bump = &foil->bumps[b];
      if (!fg_lot_bump_counts(foil, bump) || !isfinite(bump->bump_angle_deg)) continue;
      for (size_t s = 0; s < FG_CALIBRATION_SOURCES; s++)
        sum[s] += relative_move(foil, bump, s, &analysis->stiffness.sensitivity);
      count++;
    }
  }
  return count ? hypot(sum[0], sum[1]) / (double)count : 0;
}
