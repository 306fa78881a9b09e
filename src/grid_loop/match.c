/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pose of a board in every scan: quarter turns and steps against the first one. A lattice looks the
 * same after each, but the board does not: missing marks, letters, dirt, an object on it. */
#include <math.h>
#include <stdlib.h>

#include "grid_loop/problem.h"

/* The right turn is told when its correlation exceeds every other turn's by this share of its
 * distance from 1. Overlap of the boards, as a share of the smaller. */
#define CLEARLY_BETTER 0.25
#define OVERLAP_MIN    0.5
enum { SAMPLES_ALONG = 90 };

/* Lattice place of a scan, as a place of the board: quarter turns from x towards y, then steps. */
static void turn_place(int turns, const int offset[2], double c, double r, double to[2]) {
  static const int matrix[4][4] = {{1, 0, 0, 1}, {0, 1, -1, 0}, {-1, 0, 0, -1}, {0, -1, 1, 0}};
  const int *m = matrix[turns & 3];
  to[0] = m[0] * c + m[1] * r + offset[0];
  to[1] = m[2] * c + m[3] * r + offset[1];
}

void fg_grid_board_index(const grid_problem *problem, size_t scan, const fg_mark *mark,
                         int index[2]) {
  double to[2];
  turn_place(problem->turns[scan], problem->offset[scan], mark->column, mark->row, to);
  index[0] = (int)lround(to[0]);
  index[1] = (int)lround(to[1]);
}

static int board_level(const fg_grid *grid, double c, double r) {
  int width = (grid->columns + 1) * grid->per_step, height = (grid->rows + 1) * grid->per_step;
  double x = (c + 1) * grid->per_step, y = (r + 1) * grid->per_step;
  if (!(x >= 0 && y >= 0 && x < width && y < height)) return 0;
  return grid->picture[(size_t)y * (size_t)width + (size_t)x];
}

/* Correlation of two pictures of a board under a turn and steps; -1 without enough in common. */
static double correlate_boards(const fg_grid *first, const fg_grid *other, int turns,
                               const int offset[2]) {
  double n = 0, seen = 0, sum[2] = {0}, square[2] = {0}, product = 0;
  for (int j = 0; j < SAMPLES_ALONG; j++)
    for (int i = 0; i < SAMPLES_ALONG; i++) {
      double c = (i + 0.5) / SAMPLES_ALONG * (other->columns + 1) - 1, to[2];
      double r = (j + 0.5) / SAMPLES_ALONG * (other->rows + 1) - 1;
      turn_place(turns, offset, c, r, to);
      int b = board_level(other, c, r), a = board_level(first, to[0], to[1]);
      seen += b > 0;
      if (!a || !b) continue;
      n++;
      sum[0] += a;
      sum[1] += b;
      square[0] += a * a;
      square[1] += b * b;
      product += a * b;
    }
  if (n < OVERLAP_MIN * seen || n < 16) return -1;
  double va = square[0] - sum[0] * sum[0] / n, vb = square[1] - sum[1] * sum[1] / n;
  return va > 0 && vb > 0 ? (product - sum[0] * sum[1] / n) / sqrt(va * vb) : -1;
}

/* Corners' polarities turn with the board; boards without them always agree. */
static bool polarities_agree(const fg_grid *first, const fg_grid *other, int turns,
                             const int offset[2]) {
  const fg_mark *a = &first->marks[0], *b = &other->marks[0];
  if (first->kind != FG_MARKS_CHESSBOARD || first->squares_per_step != 1) return true;
  double to[2];
  turn_place(turns, offset, b->column, b->row, to);
  bool odd = (int)lround(to[0] + to[1] - a->column - a->row) % 2 != 0;
  return a->polarity * (odd ? -1 : 1) == b->polarity * (turns % 2 ? -1 : 1);
}

/* Best steps of one turn, about those that lay the middles on each other. */
static double match_turn(const fg_grid *first, const fg_grid *other, int turns, int best[2]) {
  static const int none[2] = {0, 0};
  double middle[2], best_correlation = -1;
  turn_place(turns, none, 0.5 * (other->columns - 1), 0.5 * (other->rows - 1), middle);
  double from[2] = {0.5 * (first->columns - 1) - middle[0], 0.5 * (first->rows - 1) - middle[1]};
  int reach = 3 + (first->columns > first->rows ? first->columns : first->rows) / 4;
  if (reach > 12) reach = 12;
  for (int j = -reach; j <= reach; j++)
    for (int i = -reach; i <= reach; i++) {
      int offset[2] = {(int)floor(from[0] + 0.5) + i, (int)floor(from[1] + 0.5) + j};
      if (!polarities_agree(first, other, turns, offset)) continue;
      double correlation = correlate_boards(first, other, turns, offset);
      if (correlation <= best_correlation) continue;
      best_correlation = correlation;
      best[0] = offset[0];
      best[1] = offset[1];
    }
  return best_correlation;
}

static fg_status match_scan(fg_context *ctx, const fg_measurement *first,
                            const fg_measurement *other, int *turns, int offset[2]) {
  double score[4], best = -1, second = -1;
  int found = 0, each[4][2];
  if (!first->grid->picture || !other->grid->picture)
    return fg_fail(ctx, FG_ERR_DATA, "%s: this grid does not show how it was turned: give --turned",
                   other->scan);
  for (int t = 0; t < 4; t++) {
    score[t] = *turns < 0 || *turns == t ? match_turn(first->grid, other->grid, t, each[t]) : -1;
    if (score[t] > best) {
      second = best;
      best = score[t];
      found = t;
    } else {
      second = fmax(second, score[t]);
    }
  }
  if (best < 0)
    return fg_fail(ctx, FG_ERR_DATA, "%s and %s have no part of a board in common", first->scan,
                   other->scan);
  if (*turns < 0 && 1 - best > (1 - CLEARLY_BETTER) * (1 - second))
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: the board looks alike after a quarter turn, and nothing tells how it was "
                   "turned against %s: say it with --turned 0,90 (degrees, clockwise as the scans "
                   "show it, one for each scan)",
                   other->scan, first->scan);
  *turns = found;
  offset[0] = each[found][0];
  offset[1] = each[found][1];
  return FG_OK;
}

fg_status fg_grid_match_scans(fg_context *ctx, const fg_measurement *measurements, size_t count,
                              const fg_grid_loop_options *options, grid_problem *problem) {
  for (size_t i = 1; i < count && options->same_part; i++) {
    problem->turns[i] = options->turns[i];
    FG_TRY(match_scan(ctx, &measurements[0], &measurements[i], &problem->turns[i],
                      problem->offset[i]));
    problem->model.turned |= problem->turns[i] % 2 != problem->turns[0] % 2;
  }
  return FG_OK;
}
