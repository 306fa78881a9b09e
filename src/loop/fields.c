#include "loop/fields.h"

#include <math.h>
#include <string.h>

static double from_middle(const fg_field_frame *frame, int axis, double at) {
  return (at - frame->centre_mm[axis]) / FG_FIELD_HALF_MM;
}

static void scale_y(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  (void)shape;
  d[0] = (fg_point){0, from_middle(frame, 1, at.y)};
}

static void shear(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  (void)shape;
  d[0] = (fg_point){from_middle(frame, 1, at.y), 0};
}

/* Both axes: only known lengths tell it from larger parts. */
static void scale(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  (void)shape;
  d[0] = (fg_point){from_middle(frame, 0, at.x), from_middle(frame, 1, at.y)};
}

/* a sin(2 pi y / p + phi) as a sine and a cosine. */
static void ripple(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  (void)frame;
  double angle = 2 * M_PI * at.y / shape[0];
  d[0] = (fg_point){0, sin(angle)};
  d[1] = (fg_point){0, cos(angle)};
}

static void row_step(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  (void)frame;
  d[0] = (fg_point){0, at.y > shape[0] ? 1 : 0};
}

static void optical_quadratic(const fg_field_frame *frame, const double *shape, fg_point at,
                              fg_point *d) {
  (void)frame;
  double u = (at.x - shape[0]) / FG_FIELD_HALF_MM;
  d[0] = (fg_point){u * u, 0};
}

static void optical_cubic(const fg_field_frame *frame, const double *shape, fg_point at,
                          fg_point *d) {
  (void)frame;
  double u = (at.x - shape[0]) / FG_FIELD_HALF_MM;
  d[0] = (fg_point){u * u * u, 0};
}

static void carriage_quadratic(const fg_field_frame *frame, const double *shape, fg_point at,
                               fg_point *d) {
  (void)frame;
  double v = (at.y - shape[0]) / FG_FIELD_HALF_MM;
  d[0] = (fg_point){0, v * v};
}

/* Cubic B-spline of unit knots, centred at 0. */
static double bspline(double u) {
  double a = fabs(u);
  if (a >= 2) return 0;
  if (a >= 1) return (2 - a) * (2 - a) * (2 - a) / 6;
  return 2.0 / 3 - a * a + 0.5 * a * a * a;
}

void fg_field_splines(double low, double high, size_t knots, double at,
                      double values[FG_FIELD_COLUMNS]) {
  double spacing = (high - low) / (double)(knots - 1);
  double place = (fmax(low, fmin(high, at)) - low) / spacing;
  for (size_t i = 0; i < FG_FIELD_COLUMNS; i++)
    values[i] = i < knots ? 1.5 * bspline(place - (double)i) : 0;
}

static void free_curve(const fg_field_frame *frame, int axis, double at,
                       double values[FG_FIELD_COLUMNS]) {
  fg_field_splines(frame->first_mm[axis], frame->last_mm[axis], frame->knots, at, values);
}

static void free_xx(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  (void)shape;
  double values[FG_FIELD_COLUMNS];
  free_curve(frame, 0, at.x, values);
  for (int i = 0; i < FG_FIELD_COLUMNS; i++)
    d[i] = (fg_point){values[i], 0};
}

static void free_yx(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  (void)shape;
  double values[FG_FIELD_COLUMNS];
  free_curve(frame, 0, at.x, values);
  for (int i = 0; i < FG_FIELD_COLUMNS; i++)
    d[i] = (fg_point){0, values[i]};
}

static void free_xy(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  (void)shape;
  double values[FG_FIELD_COLUMNS];
  free_curve(frame, 1, at.y, values);
  for (int i = 0; i < FG_FIELD_COLUMNS; i++)
    d[i] = (fg_point){values[i], 0};
}

static void free_yy(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  (void)shape;
  double values[FG_FIELD_COLUMNS];
  free_curve(frame, 1, at.y, values);
  for (int i = 0; i < FG_FIELD_COLUMNS; i++)
    d[i] = (fg_point){0, values[i]};
}

static const fg_field_row rows[] = {
    {"scan.scale_y", 1, 0, {NULL}, scale_y},
    {"scan.scale", 1, 0, {NULL}, scale},
    {"scan.shear", 1, 0, {NULL}, shear},
    {"scan.carriage_ripple", 2, 1, {"period_mm"}, ripple},
    {"scan.row_step", 1, 1, {"y_mm"}, row_step},
    {"scan.optical_quadratic", 1, 1, {"centre_mm"}, optical_quadratic},
    {"scan.optical_cubic", 1, 1, {"centre_mm"}, optical_cubic},
    {"scan.carriage_quadratic", 1, 1, {"centre_mm"}, carriage_quadratic},
    {"free.scan.x.dx", FG_FIELD_COLUMNS, 0, {NULL}, free_xx},
    {"free.scan.x.dy", FG_FIELD_COLUMNS, 0, {NULL}, free_yx},
    {"free.scan.y.dx", FG_FIELD_COLUMNS, 0, {NULL}, free_xy},
    {"free.scan.y.dy", FG_FIELD_COLUMNS, 0, {NULL}, free_yy},
    {NULL, 0, 0, {NULL}, NULL},
};

const fg_field_row *fg_field_rows(void) {
  return rows;
}

const fg_field_row *fg_field_find(const char *id) {
  for (const fg_field_row *row = rows; row->id; row++)
    if (!strcmp(row->id, id)) return row;
  return NULL;
}

bool fg_field_is_free(const fg_field_row *row) {
  return !strncmp(row->id, "free.", 5);
}

fg_point fg_field_at(const fg_field_list *list, fg_point nominal) {
  fg_point sum = {0, 0}, d[FG_FIELD_COLUMNS];
  for (size_t i = 0; i < list->count; i++) {
    const fg_field *field = &list->fields[i];
    field->row->basis(&list->frame, field->shape, nominal, d);
    for (size_t c = 0; c < field->row->columns; c++) {
      sum.x += field->amplitude_mm[c] * d[c].x;
      sum.y += field->amplitude_mm[c] * d[c].y;
    }
  }
  return sum;
}

/* Sine and cosine columns as amplitude and phase. */
static bool ripple_parameter(const fg_field *field, size_t i, const char **name, double *value,
                             double *u) {
  double s = field->amplitude_mm[0], c = field->amplitude_mm[1], a = hypot(s, c);
  double us = field->u_amplitude_mm[0], uc = field->u_amplitude_mm[1];
  if (i == 0) {
    *name = "amplitude_um";
    *value = 1000 * a;
    *u = a > 0 ? 1000 * hypot(s * us, c * uc) / a : 1000 * hypot(us, uc);
  } else if (i == 1) {
    *name = "period_mm";
    *value = field->shape[0];
    *u = field->u_shape[0];
  } else if (i == 2) {
    *name = "phase_deg";
    *value = atan2(c, s) * 180 / M_PI;
    *u = a > 0 ? hypot(s * uc, c * us) / (a * a) * 180 / M_PI : NAN;
  } else {
    return false;
  }
  return true;
}

bool fg_field_parameter(const fg_field *field, size_t i, const char **name, double *value,
                        double *u) {
  if (field->row->basis == ripple) return ripple_parameter(field, i, name, value, u);
  if (i == 0) {
    bool ratio =
        field->row->basis == scale_y || field->row->basis == scale || field->row->basis == shear;
    double unit = ratio ? 1 / FG_FIELD_HALF_MM : 1000;
    *name = ratio ? "value" : "amplitude_um";
    *value = unit * field->amplitude_mm[0];
    *u = unit * field->u_amplitude_mm[0];
    return true;
  }
  if (i > field->row->shapes || fg_field_is_free(field->row)) return false;
  *name = field->row->shape_name[i - 1];
  *value = field->shape[i - 1];
  *u = field->u_shape[i - 1];
  return true;
}
