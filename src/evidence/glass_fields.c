/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/glass_fields.h"

#include <math.h>
#include <string.h>

#include "evidence/line.h"

/* Highest total degree of a field over both axes, and of lines. */
enum { DEGREE = 8 };

/* Products of degree 1, each of which moves x or y. */
enum { LINEAR = 4 };

/* Scales and shears have names, which discs show apart; on a foil its circles follow them. */
static void leave_out_linear(const fg_edge_fit *edge_fit, size_t count, double *variance) {
  if (edge_fit->discs) memset(variance, 0, count * sizeof *variance);
}

static fg_line line_of_axis(const fg_field_frame *frame, int axis) {
  return fg_line_over(frame->first_mm[axis], frame->last_mm[axis]);
}

#define OVER_LINE(name, over, moved_x, moved_y)                                                    \
  size_t fg_glass_##name(const fg_field_frame *frame, fg_point at, fg_point *d) {                  \
    double values[FG_LINE_COLUMNS];                                                                \
    const fg_line l = line_of_axis(frame, over);                                                   \
    fg_line_fill(&l, fg_point_along(at, over), values);                                            \
    for (size_t c = 0; c < FG_LINE_COLUMNS; c++)                                                   \
      d[c] = (fg_point){(moved_x)*values[c], (moved_y)*values[c]};                                 \
    return FG_LINE_COLUMNS;                                                                        \
  }
OVER_LINE(x_over_x, 0, 1, 0)
OVER_LINE(y_over_x, 0, 0, 1)
OVER_LINE(x_over_y, 1, 1, 0)
OVER_LINE(y_over_y, 1, 0, 1)

bool fg_glass_x_variances(const fg_edge_fit *edge_fit, size_t i, double *variance) {
  const fg_line l = line_of_axis(&edge_fit->frame, 0);
  if (!fg_line_variances(&l, 1, i, variance)) return false;
  leave_out_linear(edge_fit, 1, variance + FG_LINE_SINES);
  return true;
}

bool fg_glass_y_variances(const fg_edge_fit *edge_fit, size_t i, double *variance) {
  const fg_line l = line_of_axis(&edge_fit->frame, 1);
  if (!fg_line_variances(&l, 1, i, variance)) return false;
  leave_out_linear(edge_fit, 1, variance + FG_LINE_SINES);
  return true;
}

static void fill_legendre(double u, size_t count, double *values) {
  values[0] = 1;
  values[1] = u;
  for (size_t n = 1; n + 1 < count; n++)
    values[n + 1] =
        ((2 * (double)n + 1) * u * values[n] - (double)n * values[n - 1]) / ((double)n + 1);
}

/* Returns the share by which terms of one degree more are smaller, for a smoother or rougher field;
 * 0: there is none. */
static double fall_of(size_t length) {
  static const double falls[] = {0.1, 0.2, 0.35, 0.5, 0.65, 0.8};
  return length < sizeof falls / sizeof *falls ? falls[length] : 0;
}

/* Lines of the picture, each shifted by another amount along the carriage's way, or moved by what
 * grows along the line from its middle: polynomials of degree 1 to DEGREE, of that from 0 on. */
static size_t fill_shifts(const fg_field_frame *frame, fg_point at, fg_point along, fg_point *d) {
  double polynomial[DEGREE + 1];
  const fg_line y = line_of_axis(frame, 1);
  fill_legendre((at.y - y.middle) / y.half, DEGREE + 1, polynomial);
  for (int k = 0; k <= DEGREE; k++)
    d[k] = (fg_point){along.x * polynomial[k], along.y * polynomial[k]};
  return DEGREE;
}

static size_t add_shifts(const fg_field_frame *frame, fg_point at, fg_point along, fg_point *d) {
  fg_point all[DEGREE + 1];
  size_t count = fill_shifts(frame, at, along, all);
  memcpy(d, all + 1, count * sizeof *d);
  return count;
}

static size_t add_levers(const fg_field_frame *frame, fg_point at, fg_point along, fg_point *d) {
  const fg_line x = line_of_axis(frame, 0);
  double lever = (at.x - x.middle) / x.half;
  return 1 + fill_shifts(frame, at, (fg_point){lever * along.x, lever * along.y}, d);
}

/* Lines that are stretched, about whatever point of theirs. */
size_t fg_glass_stretched_lines(const fg_field_frame *frame, fg_point at, fg_point *d) {
  size_t count = add_shifts(frame, at, (fg_point){1, 0}, d);
  return count + add_levers(frame, at, (fg_point){1, 0}, d + count);
}

/* Lines of a rigid bar: shifted both ways, and turned. */
size_t fg_glass_rigid_lines(const fg_field_frame *frame, fg_point at, fg_point *d) {
  size_t count = add_shifts(frame, at, (fg_point){1, 0}, d);
  count += add_shifts(frame, at, (fg_point){0, 1}, d + count);
  return count + add_levers(frame, at, (fg_point){0, 1}, d + count);
}

/* Variances of `shifts` ways to be shifted and of one lever. */
static bool fill_line_variances(const fg_edge_fit *edge_fit, size_t length, int shifts,
                                double *variance) {
  double fall = fall_of(length);
  if (fall == 0) return false;
  for (int way = 0; way < shifts; way++, variance += DEGREE) {
    for (int k = 0; k < DEGREE; k++)
      variance[k] = pow(fall, 2 * k);
    leave_out_linear(edge_fit, 1, variance);
  }
  for (int k = 0; k <= DEGREE; k++)
    variance[k] = pow(fall, 2 * k);
  leave_out_linear(edge_fit, 1, variance);
  return true;
}

bool fg_glass_stretched_variances(const fg_edge_fit *edge_fit, size_t length, double *variance) {
  return fill_line_variances(edge_fit, length, 1, variance);
}

bool fg_glass_rigid_variances(const fg_edge_fit *edge_fit, size_t length, double *variance) {
  return fill_line_variances(edge_fit, length, 2, variance);
}

/* Products of Legendre polynomials by total degree, 1 to DEGREE; each moves x, then y. */
size_t fg_glass_plane(const fg_field_frame *frame, fg_point at, fg_point *d) {
  const fg_line x = line_of_axis(frame, 0), y = line_of_axis(frame, 1);
  double px[DEGREE + 1], py[DEGREE + 1];
  fill_legendre((at.x - x.middle) / x.half, DEGREE + 1, px);
  fill_legendre((at.y - y.middle) / y.half, DEGREE + 1, py);
  size_t count = 0;
  for (int degree = 1; degree <= DEGREE; degree++)
    for (int i = 0; i <= degree; i++) {
      double value = px[i] * py[degree - i];
      d[count++] = (fg_point){value, 0};
      d[count++] = (fg_point){0, value};
    }
  return count;
}

bool fg_glass_plane_variances(const fg_edge_fit *edge_fit, size_t length, double *variance) {
  double fall = fall_of(length);
  size_t count = 0;
  if (fall == 0) return false;
  for (int degree = 1; degree <= DEGREE; degree++)
    for (int i = 0; i < 2 * (degree + 1); i++)
      variance[count++] = pow(fall, 2 * (degree - 1)) / (degree + 1);
  leave_out_linear(edge_fit, LINEAR, variance);
  return true;
}

/* Maps of the glass that one cause makes: a product of powers that moves x or y, a lens, a tilt of
 * the glass about either axis. Each with the products of degree 1, which its middle makes, and with
 * two that the middle of a lens makes. */
enum { PRODUCTS_FIRST = 2, PRODUCTS_LAST = 3, MAP_COLUMNS = LINEAR + 3 };
#define MIDDLE_SHARE 0.3 /* of a lens: distance of its middle over the picture's half */

static size_t add_map(const fg_point linear[LINEAR], fg_point one, fg_point second, fg_point third,
                      fg_point *d) {
  memcpy(d, linear, LINEAR * sizeof *d);
  d[LINEAR] = one;
  d[LINEAR + 1] = second;
  d[LINEAR + 2] = third;
  return MAP_COLUMNS;
}

size_t fg_glass_maps(const fg_field_frame *frame, fg_point at, fg_point *d) {
  const fg_line lx = line_of_axis(frame, 0), ly = line_of_axis(frame, 1);
  const double half = fmax(lx.half, ly.half), x = (at.x - lx.middle) / half;
  const double y = (at.y - ly.middle) / half;
  const fg_point linear[LINEAR] = {{x, 0}, {0, x}, {y, 0}, {0, y}}, none = {0, 0};
  size_t count = 0;
  for (int degree = PRODUCTS_FIRST; degree <= PRODUCTS_LAST; degree++)
    for (int i = 0; i <= degree; i++) {
      double value = pow(x, i) * pow(y, degree - i);
      count += add_map(linear, (fg_point){value, 0}, none, none, d + count);
      count += add_map(linear, (fg_point){0, value}, none, none, d + count);
    }
  count += add_map(linear, (fg_point){x * (x * x + y * y), y * (x * x + y * y)},
                   (fg_point){3 * x * x + y * y, 2 * x * y},
                   (fg_point){2 * x * y, x * x + 3 * y * y}, d + count);
  count += add_map(linear, (fg_point){x * x, x * y}, none, none, d + count);
  return count + add_map(linear, (fg_point){x * y, y * y}, none, none, d + count);
}

bool fg_glass_map_variances(const fg_edge_fit *edge_fit, size_t i, double *variance) {
  for (int c = 0; c < MAP_COLUMNS; c++)
    variance[c] = c <= LINEAR ? 1 : MIDDLE_SHARE * MIDDLE_SHARE;
  leave_out_linear(edge_fit, LINEAR, variance);
  return i == 0;
}

size_t fg_glass_map_columns(const fg_edge_fit *edge_fit) {
  (void)edge_fit;
  return MAP_COLUMNS;
}
