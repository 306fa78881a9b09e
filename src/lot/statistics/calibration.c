/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uncertainty of a lot's means: statistical errors average out, the calibration's error is the same
 * in every foil. */
#include <math.h>
#include <string.h>

#include "foilgauge/foil_kind.h"
#include "lot/statistics/analysis.h"
#include "quantity/quantity_rows.h"

/* Sums over the values of a foil, and of the lot. `alike` is the common error by the thickness,
 * whose uncertainty is mainly that of the scanner's tone curve. */
typedef struct sums {
  double u, squares, alike, move[FG_CALIBRATION_SOURCES];
  size_t count;
} sums;

typedef struct reading {
  const fg_lot_analysis *analysis;
  const fg_lot_quantity *quantity;
  size_t at; /* index of the quantity in the moves */
} reading;

/* Returns the change of a value, derived again, with a strip thicker by its statistical u. Foils
 * that lie flat have none. */
static double move_by_thickness(const reading *r, const fg_foil *foil, const fg_foil_part *part) {
  double moves[FG_CALIBRATED_MAX] = {0};
  const fg_design *design = &r->analysis->lot->settings.design;
  fg_foil thick = *foil;
  if (fg_foil_traits_of(design->kind)->lies_flat) return 0;
  fg_quantity_narrow_calibrated(FG_QUANTITY_OF_FOIL, &thick, &foil->calibrated);
  double u = isfinite(thick.u_thickness_mm) ? thick.u_thickness_mm : 0;
  thick.thickness_mm += u;
  if (thick.u_thickness_scan_mm > 0) thick.thickness_scan_mm += thick.u_thickness_scan_mm;
  if (!part) {
    fg_quantity_keep_farthest(FG_QUANTITY_OF_FOIL, foil, &thick, moves);
    return moves[r->at];
  }
  const fg_thickness strip[] = {fg_foil_thickness(design, foil), fg_foil_thickness(design, &thick)};
  const fg_bump *bump = part->object;
  fg_bump both[] = {*bump, *bump};
  for (int i = 0; i < 2; i++)
    fg_bump_derive(design, &r->analysis->lot->nominal, &foil->overall, &strip[i], &both[i]);
  fg_quantity_keep_farthest(FG_QUANTITY_OF_BUMP, &both[0], &both[1], moves);
  return moves[r->at];
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

static void add_reading(sums *sum, const reading *r, const fg_foil *foil,
                        const fg_foil_part *part) {
  const fg_quantity *row = r->quantity->row;
  const void *object = part ? part->object : foil;
  const fg_calibrated *calibrated = part ? part->calibrated : &foil->calibrated;
  double u = fg_quantity_uncertainty(row, object);
  double own = fg_quantity_calibration(r->quantity->owner, row, calibrated);
  if (!isfinite(fg_quantity_value(row, object)) || !isfinite(u)) return;
  bool whole = is_common_error(&r->analysis->lot->settings.design, row);
  double alike = whole ? sqrt(fmax(0, u * u - own * own)) : move_by_thickness(r, foil, part);
  double statistical = fmax(0, u * u - own * own - alike * alike);
  sum->u += sqrt(statistical);
  sum->squares += statistical;
  sum->alike += alike;
  for (size_t s = 0; s < FG_CALIBRATION_SOURCES; s++)
    sum->move[s] += calibrated->move[s][r->at];
  sum->count++;
}

static sums sum_foil(const reading *r, const fg_foil *foil) {
  sums sum = {0};
  if (!fg_foil_is_measured(foil)) return sum;
  if (r->quantity->owner == FG_QUANTITY_OF_FOIL) add_reading(&sum, r, foil, NULL);
  for (size_t k = 0; k < fg_part_count(foil, r->quantity->owner); k++) {
    const fg_foil_part part = fg_part_at(foil, r->quantity->owner, k);
    if (fg_lot_part_counts(foil, r->quantity->owner, &part)) add_reading(&sum, r, foil, &part);
  }
  return sum;
}

static fg_lot_mean_u find_quantity_mean_u(const fg_lot_analysis *analysis,
                                          const fg_lot_quantity *quantity) {
  sums all = {0};
  const fg_lot_mean_u unknown = {NAN, NAN, NAN};
  bool own = (quantity->row->uses & FG_QUANTITY_IS_OWN) != 0;
  if (!fg_quantity_has_u(quantity->row)) return unknown;
  const reading r = {analysis, quantity, fg_quantity_move_of(quantity->owner, quantity->row)};
  for (size_t i = 0; i < analysis->foil_count; i++) {
    sums foil = sum_foil(&r, analysis->foils[i].foil);
    all.squares += own ? foil.squares : foil.u * foil.u; /* R0 errs alike in all bumps of a foil */
    all.alike += foil.alike;
    for (size_t s = 0; s < FG_CALIBRATION_SOURCES; s++)
      all.move[s] += foil.move[s];
    all.count += foil.count;
  }
  if (!all.count) return unknown;
  double n = (double)all.count, calibration = hypot(all.move[0], all.move[1]) / n;
  double statistical = hypot(sqrt(all.squares), all.alike) / n;
  return (fg_lot_mean_u){statistical, calibration, hypot(statistical, calibration)};
}

void fg_lot_find_mean_u(fg_lot_analysis *analysis) {
  for (size_t i = 0; i < analysis->quantity_count; i++)
    analysis->quantities[i].mean_u = find_quantity_mean_u(analysis, &analysis->quantities[i]);
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
