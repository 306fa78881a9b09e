/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Field: displacement by a scanner of a place on the glass. True position = nominal position + d(x,
 * y), in mm of the scan. d is a sum of columns, each with a linear amplitude in mm; shapes enter
 * non-linearly. Amplitudes are displacements at FG_FIELD_HALF_MM from the middle of the scan, so
 * that they are comparable between fields. */
#ifndef FG_FIELD_FIELD_H
#define FG_FIELD_FIELD_H

#include <stddef.h>

#include "field/map.h"
#include "foilgauge/circle.h"

enum { FG_FIELD_COLUMNS = 24, FG_FIELD_SHAPES = 2, FG_FIELDS_MAX = 8 };
#define FG_FIELD_HALF_MM 18.0

/* Frame of a scan's fields. */
typedef struct fg_field_frame {
  double centre_mm[2];            /* of the picture */
  double low_mm[2], high_mm[2];   /* of the picture */
  double first_mm[2], last_mm[2]; /* of the measured edges: knots of free curves lie there, and the
                                     curves are constant beyond */
  size_t knots;                   /* number of knots of free curves, at most FG_FIELD_COLUMNS */
} fg_field_frame;

/* Computes d of every column for unit amplitude. */
typedef void fg_field_basis(const fg_field_frame *frame, const double *shape, fg_point at,
                            fg_point d[FG_FIELD_COLUMNS]);

/* Field with numbers. */
typedef struct fg_field {
  const char *id;
  fg_field_basis *basis;
  size_t columns, shapes;
  double amplitude_mm[FG_FIELD_COLUMNS], u_amplitude_mm[FG_FIELD_COLUMNS];
  double shape[FG_FIELD_SHAPES], u_shape[FG_FIELD_SHAPES];
} fg_field;

typedef struct fg_field_list {
  fg_field_frame frame;
  fg_field fields[FG_FIELDS_MAX];
  size_t count;
  const fg_map_frame *map; /* not owned; NULL: no map */
  const double *map_mm;    /* not owned; its numbers, as in fg_field_map */
} fg_field_list;

static inline bool fg_field_list_is_empty(const fg_field_list *list) {
  return !list->count && !list->map;
}

/* Returns d at a nominal position. */
fg_point fg_field_at(const fg_field_list *list, fg_point nominal);

/* Computes all columns of a curve over [low, high]: cubic B-splines, constant beyond; 0 from
 * `knots` on. */
void fg_field_splines(double low, double high, size_t knots, double at,
                      double values[FG_FIELD_COLUMNS]);

#endif
