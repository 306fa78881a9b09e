/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Known diameters beside which no scale was found: their deviations, and the scale that would have
 * shown. */
#include <math.h>

#include "core/small_solve.h"
#include "scan_loop/state.h"

/* Standard uncertainties from which evidence finds a scale, and from which a mean deviation is
 * worth a note. */
#define FOUND_ERRORS 5.0
#define NOTED_ERRORS 3.0
/* Scatter of known radii over their u, from which it is worth one. */
#define NOTED_SCATTER 3.0
/* Standard uncertainty of a flatbed's scale of which nothing is known. */
#define UNKNOWN_SCALE 0.003

/* Ratio of the squares that a correction leaves to those before, from which known radii refuse it:
 * noise alone rarely adds as much. */
#define REFUSED_RATIO 1.5

/* Deviations of radii from the known ones, um. */
typedef struct deviations {
  size_t count;
  double mean_um, u_um; /* u: as stated, of one radius */
  double left;          /* squares beside a level and a scale */
  double scatter;       /* root of their mean over u; at least 1 */
} deviations;

static double radius_of(const fg_edge_fit_view *view, const fg_measurement *scans) {
  return scans[view->scan].discs[view->disc - view->measurement->discs].radius_mm;
}

/* `scan`: this one alone; -1: all. */
static deviations compare_with_known(const fg_scan_loop *loop, const fg_measurement *scans,
                                     int scan) {
  const fg_edge_fit *edge_fit = &loop->edge_fit;
  double sum = 0, x[2] = {0, 0};
  deviations found = {.u_um = 500 * fg_scan_loop_u_diameter_mm(&loop->before[0]), .scatter = 1};
  fg_normal_equations system;
  fg_normal_clear(&system, 2);
  for (size_t v = 0; v < edge_fit->view_count; v++) {
    const fg_edge_fit_view *view = &edge_fit->views[v];
    double known_mm = edge_fit->parts[view->part].known_radius_mm;
    if (view->held_out || !(known_mm > 0) || view->disc->flags & FG_BUMP_POOR_FIT) continue;
    if (scan >= 0 && view->scan != (size_t)scan) continue;
    double by[2] = {view->disc->bright ? 1 : -1, known_mm};
    double um = 1000 * (radius_of(view, scans) - known_mm);
    fg_normal_add(&system, by, um, 1);
    sum += um;
    found.count++;
  }
  if (found.count) found.mean_um = sum / (double)found.count;
  if (found.count < 4 || !fg_normal_solve(&system, 1e-9, x, NULL)) return found;
  found.left = fmax(0, system.sum_squares - x[0] * system.right[0] - x[1] * system.right[1]);
  found.scatter = fmax(1, sqrt(found.left / ((double)found.count - 2)) / found.u_um);
  return found;
}

bool fg_scan_loop_gauges_refuse(const fg_scan_loop *loop, size_t scan) {
  const deviations before = compare_with_known(loop, loop->before, (int)scan);
  const deviations after = compare_with_known(loop, loop->after, (int)scan);
  return after.left > REFUSED_RATIO * before.left;
}

/* The joint fit lets radii follow the scan, so a scale is told by the gauges alone. */
static void put_smallest(double scale, fg_explanations *explanations) {
  for (size_t e = 0; e < explanations->candidate_count; e++)
    if (explanations->candidates[e].kind->scales) {
      explanations->smallest_um[e] = scale * 1000 * FG_FIELD_HALF_MM;
      explanations->share[e] = 1;
    }
}

static fg_status note_scatter(fg_context *ctx, fg_scan_loop *loop, const deviations *of) {
  if (of->scatter < NOTED_SCATTER) return FG_OK;
  return fg_scan_loop_bumps_note(
      ctx, &loop->bumps,
      "points: the radii of the %zu known discs deviate from the known ones by %.2g um beside any "
      "level and scale, at a stated uncertainty of %.2g um: a cause that is not found moves them, "
      "or a stated diameter is another disc's",
      of->count, of->scatter * of->u_um, of->u_um);
}

fg_status fg_scan_loop_note_known_sizes(fg_context *ctx, fg_scan_loop *loop) {
  if (!loop->by_evidence || !loop->edge_fit.known_count || fg_effect_set_scales(&loop->set))
    return FG_OK;
  const deviations of = compare_with_known(loop, loop->after, -1);
  double u_scale = of.scatter * loop->tone.u_scale, smallest = FOUND_ERRORS * u_scale;
  if (u_scale < UNKNOWN_SCALE) loop->u_scale = u_scale;
  put_smallest(smallest, &loop->explanations);
  FG_TRY(note_scatter(ctx, loop, &of));
  if (fabs(of.mean_um) * sqrt((double)of.count) < NOTED_ERRORS * of.scatter * of.u_um) return FG_OK;
  return fg_scan_loop_bumps_note(
      ctx, &loop->bumps,
      "points: the radii of the %zu known discs come %.2g um too %s in the mean, within what the "
      "level of the edges leaves open; a scale below %.0f ppm would not have shown beside it: "
      "gauges of more different sizes tell level and scale apart",
      of.count, fabs(of.mean_um), of.mean_um > 0 ? "large" : "small", 1e6 * smallest);
}
