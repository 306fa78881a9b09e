/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plate that lies turned against its table: its marks fit the table's places of other marks. */
#include <math.h>

#include "core/small_solve.h"
#include "grid_loop/certificate.h"
#include "rows/edge_fit.h"

enum { UNKNOWNS = 3 };
/* Errors of the scanner alone fit no other turn by so much better. */
#define BETTER_MIN 2.0

/* Place that the table has of a mark when the plate lies turned. */
static bool find_turned_place(const fg_grid_certificate *certificate, int turn, const fg_mark *mark,
                              double row[UNKNOWNS]) {
  int c = mark->column, r = mark->row, last[2] = {certificate->columns - 1, certificate->rows - 1};
  const int index[4][2] = {{c, r}, {r, last[0] - c}, {last[0] - c, last[1] - r}, {last[0] - r, c}};
  fg_point place;
  if (!mark->used || !fg_grid_certificate_at(certificate, index[turn], &place)) return false;
  row[0] = 1;
  row[1] = place.x;
  row[2] = place.y;
  return true;
}

/* Mean square of the marks along one axis about the table's places, shifted, turned and stretched
 * to fit; NaN where that cannot be told. */
static double misfit_of_turn(const fg_grid_certificate *certificate, const fg_grid *grid, int turn,
                             int axis) {
  fg_normal_equations system;
  double row[UNKNOWNS], x[UNKNOWNS], square = 0, n = 0;
  fg_normal_clear(&system, UNKNOWNS);
  for (size_t i = 0; i < grid->count; i++)
    if (find_turned_place(certificate, turn, &grid->marks[i], row))
      fg_normal_add(&system, row, fg_point_along(grid->marks[i].at_mm, axis), 1);
  if (!fg_normal_solve(&system, 0, x, NULL)) return NAN;
  for (size_t i = 0; i < grid->count; i++) {
    if (!find_turned_place(certificate, turn, &grid->marks[i], row)) continue;
    double off = fg_point_along(grid->marks[i].at_mm, axis);
    for (int k = 0; k < UNKNOWNS; k++)
      off -= row[k] * x[k];
    square += off * off;
    n++;
  }
  return square / n;
}

int fg_grid_certificate_turn(const fg_grid_certificate *certificate, const fg_grid *grid,
                             double *better) {
  bool square = certificate->columns == certificate->rows;
  double as_table =
      misfit_of_turn(certificate, grid, 0, 0) + misfit_of_turn(certificate, grid, 0, 1);
  int best = 0;
  *better = 1;
  for (int turn = 1; turn < 4 && grid->kind != FG_MARKS_LINES; turn++) {
    if (turn != 2 && !square) continue;
    double own =
        misfit_of_turn(certificate, grid, turn, 0) + misfit_of_turn(certificate, grid, turn, 1);
    double ratio = sqrt(as_table / own);
    if (!(ratio > BETTER_MIN && ratio > *better)) continue;
    best = turn;
    *better = ratio;
  }
  return best;
}
