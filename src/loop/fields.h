/* Scanner effects as fields: true position = nominal position + d(x, y), in mm of the scan.
 *
 * A row of the table is one effect: d is a sum of columns, each with a linear amplitude in mm; up
 * to two shape parameters enter non-linearly. Amplitudes are what the effect does at FG_FIELD_HALF
 * from the middle of the scan, so that they compare.
 */
#ifndef FG_LOOP_FIELDS_H
#define FG_LOOP_FIELDS_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/circle.h"
#include "foilgauge/status.h"

enum { FG_FIELD_COLUMNS = 24, FG_FIELD_SHAPES = 2, FG_FIELDS_MAX = 8 };
#define FG_FIELD_HALF_MM 18.0

/* Where a scan's fields live. */
typedef struct fg_field_frame {
  double centre_mm[2];            /* of the picture */
  double low_mm[2], high_mm[2];   /* of the picture */
  double first_mm[2], last_mm[2]; /* of the edges that were measured: free curves have their knots
                                     there, and stay constant beyond */
  size_t knots;                   /* of free curves, at most FG_FIELD_COLUMNS */
} fg_field_frame;

typedef struct fg_field_row {
  const char *id;
  size_t columns, shapes;
  const char *shape_name[FG_FIELD_SHAPES];
  /* d of every column for unit amplitude. */
  void (*basis)(const fg_field_frame *frame, const double *shape, fg_point at,
                fg_point d[FG_FIELD_COLUMNS]);
} fg_field_row;

/* One effect with numbers. */
typedef struct fg_field {
  const fg_field_row *row;
  double amplitude_mm[FG_FIELD_COLUMNS], u_amplitude_mm[FG_FIELD_COLUMNS];
  double shape[FG_FIELD_SHAPES], u_shape[FG_FIELD_SHAPES];
} fg_field;

typedef struct fg_field_list {
  fg_field_frame frame;
  fg_field fields[FG_FIELDS_MAX];
  size_t count;
} fg_field_list;

/* The table; ends with id NULL. The first rows are listed effects; the ones after
 * fg_field_is_free() says true are free curves, for what no listed one explains. */
const fg_field_row *fg_field_rows(void);
const fg_field_row *fg_field_find(const char *id);
bool fg_field_is_free(const fg_field_row *row);

/* d at a nominal position. */
fg_point fg_field_at(const fg_field_list *list, fg_point nominal);

/* All columns of a curve over [low, high]: cubic B-splines, constant beyond; 0 from `knots` on. */
void fg_field_splines(double low, double high, size_t knots, double at,
                      double values[FG_FIELD_COLUMNS]);

/* What the numbers of a field are called in a report: name and value of parameter i (amplitudes in
 * um, scale and shear as ratios); false when there are no more. */
bool fg_field_parameter(const fg_field *field, size_t i, const char **name, double *value,
                        double *u);

#endif
