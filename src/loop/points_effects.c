#include "loop/points_effects.h"

#include <math.h>
#include <string.h>

/* A part effect's columns at one row. */
typedef size_t part_basis(const fg_points *points, const fg_points_row *row, double *values);

static double radial_share(const fg_points_row *row) {
  return row->radial.x * row->normal.x + row->radial.y * row->normal.y;
}

/* Radial a cos 2(psi - psi0): a cosine and a sine. */
static size_t ovality(const fg_points *points, const fg_points_row *row, double *values) {
  (void)points;
  values[0] = cos(2 * row->psi) * radial_share(row);
  values[1] = sin(2 * row->psi) * radial_share(row);
  return 2;
}

static size_t spiral(const fg_points *points, const fg_points_row *row, double *values) {
  double u = row->psi / points->parts[row->part].half_span_rad;
  values[0] = u * u * u * radial_share(row);
  return 1;
}

/* Even and odd deviations of a bump's arc beyond what a circle can follow (1, u, u²). */
static size_t bump_crown(const fg_points *points, const fg_points_row *row, double *values) {
  (void)points;
  /* Legendre's P4: no part of it is a circle's (P0 and P2). */
  double u2 = row->phi * row->phi;
  values[0] = row->bump ? (35 * u2 * u2 - 30 * u2 + 3) / 8 : 0;
  return 1;
}

static size_t bump_skew(const fg_points *points, const fg_points_row *row, double *values) {
  (void)points;
  double u = row->phi; /* P3 */
  values[0] = row->bump ? (5 * u * u * u - 3 * u) / 2 : 0;
  return 1;
}

/* The residual over the place in the arc, the same on every bump. */
static size_t free_phi(const fg_points *points, const fg_points_row *row, double *values) {
  (void)points;
  double power = row->phi * row->phi * row->phi;
  for (int i = 0; i < 6; i++) {
    values[i] = row->bump ? power : 0;
    power *= row->phi;
  }
  return 6;
}

/* Radial deviation over the foil: harmonics 1.5 to 5 of its span. */
static size_t free_s(const fg_points *points, const fg_points_row *row, double *values) {
  double u = row->psi / points->parts[row->part].half_span_rad * M_PI;
  for (int i = 0; i < 5; i++) {
    values[2 * i] = cos((i + 1) * u) * radial_share(row);
    values[2 * i + 1] = sin((i + 1) * u) * radial_share(row);
  }
  return 10;
}

/* The residual over the direction of the edge in the scan: what the edge model does not know. */
static size_t free_normal(const fg_points *points, const fg_points_row *row, double *values) {
  (void)points;
  for (int i = 0; i < 3; i++) {
    values[2 * i] = cos((i + 2) * row->normal_rad);
    values[2 * i + 1] = sin((i + 2) * row->normal_rad);
  }
  return 6;
}

typedef struct part_row {
  const char *id;
  size_t columns;
  part_basis *basis;
} part_row;

static const part_row part_rows[] = {
    {"part.ovality", 2, ovality},         {"part.spiral", 1, spiral},
    {"part.bump_crown", 1, bump_crown},   {"part.bump_skew", 1, bump_skew},
    {"free.bump.phi", 6, free_phi},       {"free.foil.s", 10, free_s},
    {"free.edge.normal", 6, free_normal}, {NULL, 0, NULL},
};

static const part_row *find_part(const char *id) {
  for (const part_row *row = part_rows; row->id; row++)
    if (!strcmp(row->id, id)) return row;
  return NULL;
}

static size_t part_columns(const fg_points *points, const part_row *part, double *columns) {
  double values[FG_LOOP_COLUMNS];
  for (size_t i = 0; i < points->row_count; i++) {
    part->basis(points, &points->rows[i], values);
    for (size_t c = 0; c < part->columns; c++)
      columns[c * points->row_count + i] = values[c];
  }
  return part->columns;
}

/* The true position is d beyond the nominal one: along the normal the nominal lacks d. */
static size_t field_columns(const fg_points *points, const fg_field_row *field, const double *shape,
                            double *columns) {
  fg_point d[FG_FIELD_COLUMNS];
  for (size_t i = 0; i < points->row_count; i++) {
    const fg_points_row *row = &points->rows[i];
    field->basis(&points->frame, shape, row->ideal, d);
    for (size_t c = 0; c < field->columns; c++)
      columns[c * points->row_count + i] = -(d[c].x * row->normal.x + d[c].y * row->normal.y);
  }
  return field->columns;
}

size_t fg_points_effect_columns(const fg_points *points, const char *id, const double *shape,
                                double *columns) {
  const part_row *part = find_part(id);
  if (part) return part_columns(points, part, columns);
  const fg_field_row *field = fg_field_find(id);
  return field ? field_columns(points, field, shape, columns) : 0;
}
