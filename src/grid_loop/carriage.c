/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The carriage's random part: what all marks that it passes at one time share, and another scan of
 * the same pose does not repeat. */
#include <math.h>

#include "grid_loop/solve.h"

/* Marks that the carriage sees at one time lie in a strip of the bed as high as a lattice step. */
enum { STRIPS_MAX = 400, PER_STRIP_MIN = 4 };
/* A component lies along the carriage's way where it has most of it. */
#define ALONG_MIN 0.7

typedef struct strip_mean {
  double sum, count;
} strip_mean;

/* Means of a scan's residuals along the carriage's way, by strips. */
static void find_strips(const grid_problem *problem, const grid_solution *solution, size_t scan,
                        strip_mean means[STRIPS_MAX]) {
  static const strip_mean empty;
  double pitch = problem->board[problem->board_of[scan]].pitch_mm;
  for (size_t k = 0; k < STRIPS_MAX; k++)
    means[k] = empty;
  for (size_t i = 0; i < problem->row_count; i++) {
    const grid_row *row = &problem->rows[i];
    double strip = (row->at.y - problem->model.frame.low_mm[1]) / pitch;
    if (row->scan != scan || !row->used || fabs(row->direction.y) < ALONG_MIN) continue;
    if (!(strip >= 0 && strip < STRIPS_MAX)) continue;
    means[(size_t)strip].sum += solution->residual[i] / row->direction.y;
    means[(size_t)strip].count++;
  }
}

static bool is_same_pose(const grid_problem *problem, size_t a, size_t b) {
  return problem->board_of[a] == problem->board_of[b] && problem->turns[a] == problem->turns[b];
}

/* Of one pose: sums over its scans and strips, with the variance of the marks taken off. */
typedef struct carriage_sums {
  strip_mean over_scans[STRIPS_MAX]; /* of the strips' means */
  double square[STRIPS_MAX], noise[STRIPS_MAX];
} carriage_sums;

static void add_pose_scan(const grid_problem *problem, const strip_mean means[STRIPS_MAX],
                          carriage_sums *sums) {
  for (size_t k = 0; k < STRIPS_MAX; k++) {
    if (means[k].count < PER_STRIP_MIN) continue;
    double mean = means[k].sum / means[k].count;
    sums->over_scans[k].sum += mean;
    sums->over_scans[k].count++;
    sums->square[k] += mean * mean;
    sums->noise[k] += problem->model.mark_sd * problem->model.mark_sd / means[k].count;
  }
}

/* Deviations of n scans of a pose from their mean have n - 1 degrees of freedom: the scans share
 * what their marks, effects and map have in common. */
static void add_pose(const carriage_sums *sums, double *square, double *dof) {
  for (size_t k = 0; k < STRIPS_MAX; k++) {
    double n = sums->over_scans[k].count, sum = sums->over_scans[k].sum;
    if (n < 2) continue;
    *square += sums->square[k] - sum * sum / n - (n - 1) * sums->noise[k] / n;
    *dof += n - 1;
  }
}

double fg_grid_find_carriage(const grid_problem *problem, const grid_solution *solution) {
  double square = 0, dof = 0;
  for (size_t first = 0; first < problem->scan_count; first++) {
    static const carriage_sums nothing;
    carriage_sums sums = nothing;
    strip_mean means[STRIPS_MAX];
    bool seen = false;
    for (size_t scan = 0; scan < first; scan++)
      seen |= is_same_pose(problem, scan, first);
    for (size_t scan = first; !seen && scan < problem->scan_count; scan++) {
      if (!is_same_pose(problem, scan, first)) continue;
      find_strips(problem, solution, scan, means);
      add_pose_scan(problem, means, &sums);
    }
    add_pose(&sums, &square, &dof);
  }
  return dof > 0 ? 1000 * sqrt(fmax(0, square) / dof) : NAN;
}
