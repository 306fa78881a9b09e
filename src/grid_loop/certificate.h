/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plate's certificate: the place of each of its marks. */
#ifndef FG_GRID_LOOP_CERTIFICATE_H
#define FG_GRID_LOOP_CERTIFICATE_H

#include <stdbool.h>

#include "foilgauge/circle.h"
#include "foilgauge/grid.h"
#include "foilgauge/status.h"

typedef struct fg_grid_certificate {
  int columns, rows;
  fg_point *place_mm; /* owned; row by row; NaN: not in the table */
  /* Relative u of a length over half of the plate, by the u of its marks: all may err together. */
  double u_scale;
} fg_grid_certificate;

/* Reads a CSV with column, row (none for lines), x_mm, y_mm (none for lines) and u_um, x along the
 * columns and y down along the rows, as a scan shows them. FG_ERR_DATA names a missing column. */
fg_status fg_grid_certificate_load(fg_context *ctx, const char *path, bool lines,
                                   fg_grid_certificate *certificate);
void fg_grid_certificate_free(fg_grid_certificate *certificate);

/* Place of a mark; false where the table has none. */
bool fg_grid_certificate_at(const fg_grid_certificate *certificate, const int index[2],
                            fg_point *place);

/* Quarter turns, clockwise, by which the plate lies turned against its table: by the marks' own
 * deviations, which must fit far better so. `better` is how many times better; 1 where the answer
 * is 0. */
int fg_grid_certificate_turn(const fg_grid_certificate *certificate, const fg_grid *grid,
                             double *better);

#endif
