#include "loop/points_effects.h"

#include <math.h>
#include <string.h>

/* A part effect's columns at one row. */
typedef size_t part_basis(const fg_points *points, const fg_points_row *row, double *values);

/* A part that was bent moves along its own normal; a part that was drawn with another radius moves
 * along the radius. On a land they are one, on the flank of a bump they differ. */
static double along_radius(const fg_points_row *row) {
  return row->radial.x * row->normal.x + row->radial.y * row->normal.y;
}

/* The rows' normals point out of their own arc: on a bump towards the shaft. */
static double along_normal(const fg_points_row *row) {
  return along_radius(row) < 0 ? -1 : 1;
}

/* a cos 2(psi - psi0): a cosine and a sine. */
static size_t oval(const fg_points_row *row, double share, double *values) {
  values[0] = cos(2 * row->psi) * share;
  values[1] = sin(2 * row->psi) * share;
  return 2;
}

static size_t ovality(const fg_points *points, const fg_points_row *row, double *values) {
  (void)points;
  return oval(row, along_normal(row), values);
}

static size_t ovality_radial(const fg_points *points, const fg_points_row *row, double *values) {
  (void)points;
  return oval(row, along_radius(row), values);
}

static double cubic_of_psi(const fg_points *points, const fg_points_row *row) {
  double u = row->psi / points->parts[row->part].half_span_rad;
  return u * u * u;
}

static size_t spiral(const fg_points *points, const fg_points_row *row, double *values) {
  values[0] = cubic_of_psi(points, row) * along_normal(row);
  return 1;
}

static size_t spiral_radial(const fg_points *points, const fg_points_row *row, double *values) {
  values[0] = cubic_of_psi(points, row) * along_radius(row);
  return 1;
}

/* Legendre polynomials first, first + step, ... of the place in the arc, the same on every bump.
 * P0, P1 and P2 are a circle's own. */
static size_t legendre(const fg_points_row *row, int first, int step, int count, double *values) {
  double before = 1, at = row->phi;
  for (int n = 1, k = 0; k < count; n++) {
    if (n == first + k * step) values[k++] = row->bump ? at : 0;
    double next = ((2 * n + 1) * row->phi * at - n * before) / (n + 1);
    before = at;
    at = next;
  }
  return (size_t)count;
}

/* Bumps of unlike radii may be alike over the angle or over the length of their arcs. The place is
 * the angle; over the length it is stretched by R over the mean R, which adds this much of
 * phi P'n, n = first and first + 2. */
static size_t stretch(const fg_points *points, const fg_points_row *row, int first,
                      double *values) {
  const fg_points_part *part = &points->parts[row->part];
  double u = row->phi, u2 = u * u, share = 0;
  if (row->bump) share = part->bumps[row->bump_index].radius_mm / part->mean_radius_mm - 1;
  values[0] = share * (first == 3 ? u * (15 * u2 - 3) / 2 : u2 * (35 * u2 - 15) / 2);
  values[1] = share * (first == 3 ? u * ((315 * u2 - 210) * u2 + 15) / 8
                                  : u2 * ((1386 * u2 - 1260) * u2 + 210) / 16);
  return 2;
}

/* A deviation takes the arc's centre with it, and so the zero of the angle: an even one shows as
 * its slope too, of which P3 is what a circle leaves, and an odd one as P4. */
static size_t bump_crown(const fg_points *points, const fg_points_row *row, double *values) {
  size_t count = legendre(row, 4, 2, 4, values);
  count += stretch(points, row, 4, values + count);
  return count + legendre(row, 3, 1, 1, values + count);
}

static size_t bump_skew(const fg_points *points, const fg_points_row *row, double *values) {
  size_t count = legendre(row, 3, 2, 4, values);
  count += stretch(points, row, 3, values + count);
  return count + legendre(row, 4, 1, 1, values + count);
}

static size_t free_phi(const fg_points *points, const fg_points_row *row, double *values) {
  size_t count = legendre(row, 3, 1, 16, values);
  count += stretch(points, row, 3, values + count);
  return count + stretch(points, row, 4, values + count);
}

/* Over the foil. */
static size_t free_s(const fg_points *points, const fg_points_row *row, double share,
                     double *values) {
  fg_field_splines(points->psi_rad[0], points->psi_rad[1], FG_FIELD_COLUMNS, row->psi, values);
  for (int i = 0; i < FG_FIELD_COLUMNS; i++)
    values[i] *= share;
  return FG_FIELD_COLUMNS;
}

static size_t free_normal_s(const fg_points *points, const fg_points_row *row, double *values) {
  return free_s(points, row, along_normal(row), values);
}

static size_t free_radial_s(const fg_points *points, const fg_points_row *row, double *values) {
  return free_s(points, row, along_radius(row), values);
}

/* Over the direction of the edge in the scan: what the edge model does not know. */
static size_t free_normal(const fg_points *points, const fg_points_row *row, double *values) {
  enum { HARMONICS = 8, OF_DISCS = 6 }; /* a disc has a form of its own */
  for (int i = 0; i < HARMONICS; i++) {
    bool used = i < OF_DISCS || !points->discs;
    values[2 * i] = used ? cos((i + 2) * row->normal_rad) : 0;
    values[2 * i + 1] = used ? sin((i + 2) * row->normal_rad) : 0;
  }
  return 2 * HARMONICS;
}

typedef struct part_row {
  const char *id;
  part_basis *basis;
} part_row;

static const part_row part_rows[] = {
    {"part.ovality", ovality},
    {"part.ovality:radial", ovality_radial},
    {"part.spiral", spiral},
    {"part.spiral:radial", spiral_radial},
    {"part.bump_crown", bump_crown},
    {"part.bump_skew", bump_skew},
    {"free.bump.phi", free_phi},
    {"free.edge.normal", free_normal},
    {"free.foil.s", free_normal_s},
    {"free.foil.s:radial", free_radial_s},
    {NULL, NULL},
};

static const part_row *find_part(const char *id) {
  for (const part_row *row = part_rows; row->id; row++)
    if (!strcmp(row->id, id)) return row;
  return NULL;
}

static size_t part_columns(const fg_points *points, const part_row *part, double *columns) {
  double values[FG_FIELD_COLUMNS];
  size_t count = 0;
  for (size_t i = 0; i < points->row_count; i++) {
    count = part->basis(points, &points->rows[i], values);
    for (size_t c = 0; c < count; c++)
      columns[c * points->row_count + i] = values[c];
  }
  return count;
}

/* u, u² and u³ of one axis, from the middle of the picture, moving along that axis. */
static size_t power_field(const fg_field_frame *frame, int axis, fg_point at, fg_point *d) {
  double u = ((axis ? at.y : at.x) - frame->centre_mm[axis]) / FG_FIELD_HALF_MM, power = u;
  for (int i = 0; i < 3; i++, power *= u)
    d[i] = axis ? (fg_point){0, power} : (fg_point){power, 0};
  return 3;
}

/* Displacements of the columns of a scanner's effect; 0 when it is none. */
static size_t field_at(const fg_points *points, const char *id, const double *shape, fg_point at,
                       fg_point *d) {
  if (!strcmp(id, FG_POWERS_X)) return power_field(&points->frame, 0, at, d);
  if (!strcmp(id, FG_POWERS_Y)) return power_field(&points->frame, 1, at, d);
  const fg_field_row *field = fg_field_find(id);
  if (!field) return 0;
  field->basis(&points->frame, shape, at, d);
  return field->columns;
}

/* The true position is d beyond the nominal one: along the normal the nominal lacks d. */
size_t fg_points_effect_columns(const fg_points *points, const char *id, const double *shape,
                                double *columns) {
  const part_row *part = find_part(id);
  if (part) return part_columns(points, part, columns);
  fg_point at[FG_POINTS_PLACES], d[FG_FIELD_COLUMNS];
  size_t count = 0, rows = points->row_count;
  for (size_t i = 0; i < rows; i++) {
    const fg_points_row *row = &points->rows[i];
    fg_points_places(row, row->ideal, at);
    for (int k = 0; k < FG_POINTS_PLACES; k++) {
      count = field_at(points, id, shape, at[k], d);
      for (size_t c = 0; c < count; c++)
        columns[c * rows + i] =
            (k ? columns[c * rows + i] : 0) -
            (d[c].x * row->normal.x + d[c].y * row->normal.y) / FG_POINTS_PLACES;
    }
  }
  return count;
}

size_t fg_points_width_columns(const fg_points *points, const char *id, const double *shape,
                               double *columns) {
  fg_point d[2][FG_FIELD_COLUMNS];
  size_t count = 0;
  for (size_t i = 0; i < points->row_count && !find_part(id); i++) {
    const fg_points_row *row = &points->rows[i];
    fg_point n = row->normal;
    for (int side = 0; side < 2; side++) {
      double w = side ? -row->half_width_mm : row->half_width_mm;
      fg_point at = {row->ideal.x + w * n.x, row->ideal.y + w * n.y};
      count = field_at(points, id, shape, at, d[side]);
    }
    for (size_t c = 0; c < count; c++)
      columns[c * points->row_count + i] =
          -0.5 * ((d[0][c].x - d[1][c].x) * n.x + (d[0][c].y - d[1][c].y) * n.y);
  }
  return count;
}

const char *fg_effect_name(const char *id) {
  for (const part_row *row = part_rows; row->id; row++) {
    size_t length = strlen(row->id);
    if (!strncmp(row->id, id, length) && id[length] == ':') return row->id;
  }
  return id;
}

const char *fg_effect_form(const char *id) {
  const char *colon = strchr(id, ':');
  if (colon) return colon + 1;
  bool has_other =
      !strcmp(id, "part.ovality") || !strcmp(id, "part.spiral") || !strcmp(id, "free.foil.s");
  return has_other ? "normal" : NULL;
}

bool fg_effect_same(const char *a, const char *b) {
  return !strcmp(fg_effect_name(a), fg_effect_name(b));
}
