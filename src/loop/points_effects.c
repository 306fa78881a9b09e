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

static void engine_basis(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                         const double *shape, double *columns) {
  const fg_points_problem *p = problem->self;
  size_t count = fg_points_effect_columns(p->points, candidate->effect->id, shape, columns);
  for (size_t c = 0; c < count; c++)
    fg_points_project(p, columns + c * problem->rows);
}

static size_t engine_columns(const fg_loop_problem *problem, const fg_loop_candidate *candidate) {
  (void)problem;
  const part_row *part = find_part(candidate->effect->id);
  if (part) return part->columns;
  const fg_field_row *field = fg_field_find(candidate->effect->id);
  return field ? field->columns : 0;
}

static bool on_x(const fg_loop_problem *problem, size_t a, size_t b) {
  (void)problem;
  return a == b && a == FG_POINTS_SCAN_X;
}
static bool on_y(const fg_loop_problem *problem, size_t a, size_t b) {
  (void)problem;
  return a == b && a == FG_POINTS_SCAN_Y;
}
static bool on_s(const fg_loop_problem *problem, size_t a, size_t b) {
  (void)problem;
  return a == b && a == FG_POINTS_FOIL_S;
}
static bool on_phi(const fg_loop_problem *problem, size_t a, size_t b) {
  (void)problem;
  return a == b && a == FG_POINTS_BUMP_PHI;
}
static bool on_normal(const fg_loop_problem *problem, size_t a, size_t b) {
  (void)problem;
  return a == b && a == FG_POINTS_EDGE_NORMAL;
}

/* Periods at equal steps of frequency, one lobe of the picture's height apart, down to 0.4 mm. */
static size_t ripple_starts(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                            double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]) {
  const fg_loop_coordinate *y = &problem->coordinate[candidate->a];
  double span = y->high - y->low, step = 0.6 / span, frequency = 1.2 / span;
  if ((1 / 0.4 - frequency) / step > FG_LOOP_STARTS) step = (1 / 0.4 - frequency) / FG_LOOP_STARTS;
  size_t n = 0;
  for (; n < FG_LOOP_STARTS && frequency < 1 / 0.4; frequency += step)
    starts[n++][0] = 1 / frequency;
  return n;
}

static size_t step_starts(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                          double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]) {
  const fg_loop_coordinate *y = &problem->coordinate[candidate->a];
  size_t n = FG_LOOP_STARTS / 2;
  for (size_t i = 0; i < n; i++)
    starts[i][0] = y->low + (y->high - y->low) * ((double)i + 1) / ((double)n + 1);
  return n;
}

#define SCANNER(id_, on_, shapes_, name_, starts_, stepwise_, words_)                              \
  {                                                                                                \
    .id = id_, .level = "points", .frame = "scanner", .words = words_, .shapes = shapes_,          \
    .shape_name = {name_}, .accepts = on_, .columns = engine_columns, .basis = engine_basis,       \
    .starts = starts_, .stepwise = stepwise_                                                       \
  }
#define PART(id_, on_, frame_, words_)                                                             \
  {                                                                                                \
    .id = id_, .level = "points", .frame = frame_, .words = words_, .accepts = on_,                \
    .columns = engine_columns, .basis = engine_basis                                               \
  }

static const fg_loop_effect effects[] = {
    SCANNER("scan.scale_y", on_y, 0, NULL, NULL, false, "a wrong scale along"),
    SCANNER("scan.shear", on_y, 0, NULL, NULL, false, "a shear along"),
    SCANNER("scan.carriage_ripple", on_y, 1, "period_mm", ripple_starts, false, "a ripple along"),
    SCANNER("scan.row_step", on_y, 1, "y_mm", step_starts, true, "a step at one place of"),
    SCANNER("scan.optical_quadratic", on_x, 0, NULL, NULL, false, "a quadratic distortion along"),
    SCANNER("scan.optical_cubic", on_x, 0, NULL, NULL, false, "a cubic distortion along"),
    SCANNER("scan.carriage_quadratic", on_y, 0, NULL, NULL, false, "a quadratic distortion along"),
    PART("part.ovality", on_s, "part", "an oval foil along"),
    PART("part.spiral", on_s, "part", "a spiral foil along"),
    PART("part.bump_crown", on_phi, "bump", "flattened or raised crowns over"),
    PART("part.bump_skew", on_phi, "bump", "skewed bumps over"),
    {.id = NULL},
};

static const fg_loop_effect free_effects[] = {
    SCANNER("free.scan.x.dx", on_x, 0, NULL, NULL, false, "a curve over"),
    SCANNER("free.scan.x.dy", on_x, 0, NULL, NULL, false, "a curve over"),
    SCANNER("free.scan.y.dx", on_y, 0, NULL, NULL, false, "a curve over"),
    SCANNER("free.scan.y.dy", on_y, 0, NULL, NULL, false, "a curve over"),
    PART("free.foil.s", on_s, "part", "a curve over"),
    PART("free.bump.phi", on_phi, "bump", "a curve over"),
    PART("free.edge.normal", on_normal, "scanner", "a curve over"),
    {.id = NULL},
};

const fg_loop_effect *fg_points_effects(void) {
  return effects;
}

const fg_loop_effect *fg_points_free_effects(void) {
  return free_effects;
}
