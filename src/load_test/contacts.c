/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contradictions among the contacts of a direction, and between them and the strokes. */
#include <math.h>

#include "load_test/analysis.h"
#include "load_test/local_fit.h"

/* Number of places of a loaded branch where its strokes are compared, and its minimum; half of the
 * window there, as a share of the branch. */
enum { PLACES = 16, PLACES_MIN = 8 };
static const double window_share = 1.0 / 8;

/* Standard uncertainties that two contacts may be apart by. */
static const double reach = 2;

/* Returns the distance of loading and unloading on one side that friction explains: at the place
 * where the unloading stroke passes T the loading one is 2 H above it, and has risen by that since
 * it passed T. NaN: unknown from this branch. */
static double parted_by_friction(const fg_load_stroke *load, const fg_load_stroke *unload,
                                 double contact, double end) {
  double friction = 0, slope = INFINITY;
  size_t known = 0;
  for (int k = 0; k < PLACES; k++) {
    fg_local_fit a, b;
    double x = contact + (end - contact) * ((double)k + 0.5) / PLACES;
    double window = window_share * fabs(end - contact);
    if (!fg_local_fit_at(load, x, window, &a) || !fg_local_fit_at(unload, x, window, &b)) continue;
    friction = fmax(friction, fabs(a.value - b.value) / 2);
    slope = fmin(slope, a.slope);
    known++;
  }
  if (known < PLACES_MIN) return NAN;
  return slope > 0 ? 2 * friction / slope : INFINITY;
}

static double min_of(double a, double b) {
  return a < b ? a : b;
}

static fg_status find_parted(fg_context *ctx, const fg_load_strokes *strokes,
                             const fg_load_direction *d, double *parted) {
  fg_load_stroke up = {0}, down = {0};
  fg_status status = FG_OK;
  *parted = NAN;
  FG_TRY_EXIT(fg_load_strokes_merge_sense(ctx, strokes, 1, &up));
  FG_TRY_EXIT(fg_load_strokes_merge_sense(ctx, strokes, -1, &down));
  if (up.count && down.count) {
    double high = min_of(up.x[up.count - 1], down.x[down.count - 1]);
    double low = -min_of(-up.x[0], -down.x[0]);
    *parted = parted_by_friction(&up, &down, d->push_mm, high) +
              parted_by_friction(&down, &up, d->pull_mm, low);
  }
exit:
  fg_load_stroke_free(&up);
  fg_load_stroke_free(&down);
  return status;
}

static double or_zero(double value) {
  return isfinite(value) ? value : 0;
}

fg_status fg_load_check_contacts(fg_context *ctx, const fg_load_strokes *strokes, double gap_at_mm,
                                 fg_load_direction *d) {
  double more = d->unloading.value - d->clearance.value, parted;
  /* Strokes follow each other by half a cycle, contacts of one stroke by a quarter. */
  double drift = or_zero(fabs(d->drift_um_cycle)) / 1000 / 2;
  double u = hypot(d->clearance.u_repeat, d->unloading.u_repeat);
  double within = reach * d->clearance.u_repeat + drift;
  if (!isfinite(d->clearance.value)) return FG_OK;
  if (gap_at_mm < d->pull_mm - within || gap_at_mm > d->push_mm + within)
    d->flags |= FG_LOAD_SAME_SIDE;
  if (!isfinite(more)) return FG_OK;
  FG_TRY(find_parted(ctx, strokes, d, &parted));
  if (more < -reach * u - drift || more > parted + reach * u + drift)
    d->flags |= FG_LOAD_BRANCHES_APART;
  return FG_OK;
}
