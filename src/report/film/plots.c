/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/film/plots.h"

#include <math.h>
#include <stdio.h>

#include "page/plot_frame.h"

enum { LEVELS = 16 };

/* Dark blue over white to dark red: below ambient pressure, and above. */
static void put_colour(FILE *out, double share) {
  static const int blue[3] = {0x1b, 0x4f, 0x9c}, red[3] = {0xb3, 0x2a, 0x1e};
  const int *end = share < 0 ? blue : red;
  double depth = fmin(1, fabs(share));
  for (int c = 0; c < 3; c++)
    fprintf(out, "%02x", (int)lround(255 + depth * (end[c] - 255)));
}

/* Pressure above ambient over its largest deviation, rounded to a level. */
static int pressure_level(const fg_film_report *r, size_t column, size_t node, double reach) {
  double above = r->column[column].pressure_kpa[node] - r->options.ambient_kpa;
  return (int)lround(above / reach * LEVELS);
}

static double find_pressure_reach(const fg_film_report *r) {
  double reach = 1e-9;
  for (size_t i = 0; i < r->columns * r->nodes; i++)
    reach = fmax(reach, fabs(r->pressure_kpa[i] - r->options.ambient_kpa));
  return reach;
}

/* A row of nodes, at both sides of the middle: neighbours of one level are one stretch. */
static void put_row(const fg_plot *at, const fg_film_report *r, size_t node, double reach) {
  double step = r->length_mm / 2 / (double)(r->nodes - 1), z = step * (double)node;
  double half = r->columns > 1 ? (r->column[1].angle_deg - r->column[0].angle_deg) / 2 : 0;
  double low = fmax(0, z - step / 2), high = fmin(r->length_mm / 2, z + step / 2);
  for (size_t i = 0, end; i < r->columns; i = end) {
    int level = pressure_level(r, i, node, reach);
    for (end = i + 1; end < r->columns && pressure_level(r, end, node, reach) == level &&
                      r->column[end].pad == r->column[i].pad;)
      end++;
    if (!level) continue;
    double x = fg_plot_x(at, r->column[i].angle_deg - half);
    double width = fg_plot_x(at, r->column[end - 1].angle_deg + half) - x;
    for (int side = -1; side <= 1; side += 2) {
      double top = fg_plot_y(at, side > 0 ? high : -low);
      fprintf(at->out, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"#", x,
              top, width, fg_plot_y(at, side > 0 ? low : -high) - top);
      put_colour(at->out, (double)level / LEVELS);
      fputs("\"/>\n", at->out);
    }
  }
}

void fg_film_plot_field(FILE *out, const fg_film_report *r) {
  double x[2] = {r->column[0].angle_deg, r->column[r->columns - 1].angle_deg};
  double z[2] = {-r->length_mm / 2, r->length_mm / 2}, reach = find_pressure_reach(r);
  fg_plot at = fg_plot_open(out, &(fg_plot_frame){"Pressure of the unwrapped film", .height = 300,
                                                  .left = 76, .x = x, .y = z,
                                                  .y_title = "along the axis, mm",
                                                  .x_title = "angle from the first bump, degrees"});
  for (size_t node = 0; node < r->nodes; node++)
    put_row(&at, r, node, reach);
  fg_plot_axes(&at);
  fg_plot_end(&at);
}

/* A value of a column over the angle; pads stand apart. */
static void put_columns(const fg_plot *at, const fg_film_report *r,
                        double (*value)(const fg_film_column *), const char *style) {
  const char *mark = "M";
  fprintf(at->out, "<path class=\"%s\" d=\"", style);
  for (size_t i = 0; i < r->columns; i++) {
    if (i && r->column[i].pad != r->column[i - 1].pad) mark = "M";
    fprintf(at->out, "%s%.1f %.1f", mark, fg_plot_x(at, r->column[i].angle_deg),
            fg_plot_y(at, fg_plot_inside(at, value(&r->column[i]))));
    mark = "L";
  }
  fputs("\"/>\n", at->out);
}

static double film_of(const fg_film_column *column) {
  return column->film_um;
}
static double clearance_of(const fg_film_column *column) {
  return column->clearance_um;
}
static double deflection_of(const fg_film_column *column) {
  return column->deflection_um;
}

void fg_film_plot_thickness(FILE *out, const fg_film_report *r) {
  static const struct {
    double (*value)(const fg_film_column *);
    const char *style, *words;
  } lines[] = {{film_of, "s1", "film under load"},
               {clearance_of, "s2", "clearance, rotor centred"},
               {deflection_of, "thin", "foil's deflection"}};
  double x[2] = {r->column[0].angle_deg, r->column[r->columns - 1].angle_deg};
  double y[2] = {0, 0};
  for (size_t i = 0; i < r->columns; i++)
    for (size_t k = 0; k < 3; k++)
      fg_range_add(y, lines[k].value(&r->column[i]), 0);
  fg_range_pad(y, 0.08, 1);
  fg_plot at = fg_plot_frame_begin(
      out, &(fg_plot_frame){"Thickness of the film over the angle", .height = 320, .left = 76,
                            .top = 34, .x = x, .y = y, .y_title = "µm",
                            .x_title = "angle from the first bump, degrees"});
  fg_plot_level(&at, 0, "zero");
  for (size_t k = 0; k < 3; k++) {
    put_columns(&at, r, lines[k].value, lines[k].style);
    fprintf(out, "<path class=\"%s\" d=\"M%zu 14h26\"/><text x=\"%zu\" y=\"19\">%s</text>\n",
            lines[k].style, 80 + 300 * k, 114 + 300 * k, lines[k].words);
  }
  fg_plot_end(&at);
}

/* Two neighbouring speeds whose rotors are this far apart, over C, are on two films. */
static const double far_apart = 0.2;

static bool changes_film(const fg_film_report *r, size_t i) {
  const double *from = r->by_speed[i - 1].place_um, *to = r->by_speed[i].place_um;
  return hypot(to[0] - from[0], to[1] - from[1]) > far_apart * r->clearance_um;
}

/* A line for every film that the map passes. */
static void put_films(fg_plot *at, const fg_film_report *r, const double *x, const double *y) {
  size_t begin = 0;
  for (size_t i = 1; i <= r->speed_count; i++) {
    if (i < r->speed_count && !changes_film(r, i)) continue;
    fg_plot_line(at, x + begin, y + begin, i - begin, "s1");
    begin = i;
  }
}

/* Axes of decimal logarithms: the numbers stand for powers of ten. */
void fg_film_plot_stability(FILE *out, const fg_film_report *r) {
  double x[2] = {INFINITY, -INFINITY}, y[2] = {INFINITY, -INFINITY};
  double speed[FG_FILM_SPEEDS_MAX], mass[FG_FILM_SPEEDS_MAX];
  for (size_t i = 0; i < r->speed_count; i++) {
    double critical = r->by_speed[i].critical_mass_kg;
    speed[i] = r->by_speed[i].speed_rpm / 1000;
    mass[i] = isfinite(critical) && critical > 0 ? log10(critical) : NAN;
    fg_range_add(x, speed[i], 0);
    fg_range_add(y, mass[i], 0);
  }
  fg_range_add(y, log10(r->options.rotor_mass_kg), 0);
  fg_range_pad(y, 0.08, 0.1);
  fg_range_pad(x, 0.02, 0.01);
  fg_plot at = fg_plot_frame_begin(out, &(fg_plot_frame){"Critical mass over speed", .height = 340,
                                                         .left = 76, .top = 34, .x = x, .y = y,
                                                         .y_title = "log10 of critical mass in kg",
                                                         .x_title = "speed, 1000 rpm"});
  fg_plot_level(&at, log10(r->options.rotor_mass_kg), "limit");
  put_films(&at, r, speed, mass);
  for (size_t i = 0; i < r->speed_count; i++)
    if (isfinite(mass[i])) fg_plot_dot(&at, speed[i], mass[i], 4, "s1");
  bool all_whirl = false;
  for (size_t i = 0; i < r->speed_count; i++) {
    if (!(r->by_speed[i].critical_mass_kg <= 0)) continue;
    fg_plot_dot(&at, speed[i], y[0], 4, "s3");
    all_whirl = true;
  }
  fg_plot_key(&at, 80, "s1", "critical mass");
  if (isfinite(r->threshold_rpm)) {
    fg_plot_dot(&at, r->threshold_rpm / 1000, log10(r->options.rotor_mass_kg), 6, "s2");
    fg_plot_key(&at, 300, "s2", "threshold of this rotor");
  }
  if (all_whirl) fg_plot_key(&at, 620, "s3", "every rotor whirls");
  fg_plot_end(&at);
}

void fg_film_plot_coefficients(FILE *out, const fg_film_report *r, bool damping) {
  static const char *const styles[] = {"s1", "s2", "thin", "s3"};
  static const char *const words[] = {"xx", "xy", "yx", "yy"};
  double x[2] = {INFINITY, -INFINITY}, y[2] = {0, 0};
  double ratio[FG_FILM_FREQUENCIES], value[4][FG_FILM_FREQUENCIES];
  for (size_t i = 0; i < r->coefficient_count; i++) {
    const fg_film_coefficients *at = &r->coefficients[i];
    ratio[i] = log10(at->whirl_ratio);
    fg_range_add(x, ratio[i], 0);
    for (int k = 0; k < 4; k++) {
      value[k][i] = damping ? at->damping_n_s_mm[k] : at->stiffness_n_um[k];
      fg_range_add(y, value[k][i], 0);
    }
  }
  fg_range_pad(y, 0.08, 1e-6);
  fg_plot at = fg_plot_frame_begin(
      out, &(fg_plot_frame){damping ? "Damping over the whirl" : "Stiffness over the whirl",
                            .height = 300, .left = 90, .top = 34, .x = x, .y = y,
                            .y_title = damping ? "damping, N s/mm" : "stiffness, N/µm",
                            .x_title = "log10 of whirl over speed"});
  fg_plot_level(&at, 0, "zero");
  for (size_t k = 0; k < 4; k++) {
    fg_plot_line(&at, ratio, value[k], r->coefficient_count, styles[k]);
    fprintf(out, "<path class=\"%s\" d=\"M%zu 14h26\"/><text x=\"%zu\" y=\"19\">%s</text>\n",
            styles[k], 94 + 200 * k, 128 + 200 * k, words[k]);
  }
  fg_plot_end(&at);
}

/* Field of the orbit, px: both axes have one scale. */
enum { ORBIT_WIDTH = 890, ORBIT_HEIGHT = 560 };

static void set_span(double range[2], double span) {
  double middle = (range[0] + range[1]) / 2;
  range[0] = middle - span / 2;
  range[1] = middle + span / 2;
}

void fg_film_plot_orbit(FILE *out, const fg_film_report *r) {
  const fg_film_orbit *orbit = &r->orbit;
  double x[2] = {INFINITY, -INFINITY}, y[2] = {INFINITY, -INFINITY};
  for (size_t i = 0; i < orbit->count; i++) {
    fg_range_add(x, orbit->point[i].place_um[0], 0);
    fg_range_add(y, orbit->point[i].place_um[1], 0);
  }
  fg_range_pad(x, 0.08, 1e-6);
  fg_range_pad(y, 0.08, 1e-6);
  double um = fmax((x[1] - x[0]) / ORBIT_WIDTH, (y[1] - y[0]) / ORBIT_HEIGHT); /* a px, both ways */
  set_span(x, um * ORBIT_WIDTH);
  set_span(y, um * ORBIT_HEIGHT);
  fg_plot at = fg_plot_frame_begin(
      out, &(fg_plot_frame){"Orbit of the rotor", .width = ORBIT_WIDTH + 110,
                            .height = ORBIT_HEIGHT + 70, .left = 90, .right = 20, .top = 20, .x = x,
                            .y = y, .y_title = "towards 90 degrees, µm",
                            .x_title = "towards 0 degrees, µm"});
  fputs("<path class=\"thin\" d=\"", out);
  for (size_t i = 0; i < orbit->count; i++)
    fprintf(out, "%c%.1f %.1f", i ? 'L' : 'M', fg_plot_x(&at, orbit->point[i].place_um[0]),
            fg_plot_y(&at, orbit->point[i].place_um[1]));
  fputs("\"/>\n", out);
  fg_plot_dot(&at, orbit->point[0].place_um[0], orbit->point[0].place_um[1], 4, "s2");
  fg_plot_end(&at);
}
