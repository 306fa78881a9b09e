/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/load_test/plots.h"

#include <math.h>

#include "foilgauge/report.h"
#include "page/plot_frame.h"

/* LOOP_SAMPLES: samples drawn of a loop; more make the page larger, but no line finer. */
enum { LOOP_SAMPLES = 1200, CURVE_STEPS = 180 };

static void put_record(const fg_plot *at, const fg_load_test *test, const fg_load_direction *d) {
  const fg_load_sample *s = test->samples + d->first;
  size_t step = d->count / LOOP_SAMPLES + 1;
  fputs("<path class=\"land\" d=\"", at->out);
  for (size_t i = 0; i < d->count; i += step)
    fprintf(at->out, "%c%.1f %.1f", i ? 'L' : 'M', fg_plot_x(at, s[i].x_mm),
            fg_plot_y(at, s[i].force_n));
  fputs("\"/>\n", at->out);
}

static double zero_of(const fg_load_direction *d) {
  return isfinite(d->zero_n) ? d->zero_n : 0;
}

static void put_clearance(const fg_plot *at, const fg_load_direction *d, double threshold) {
  char text[60];
  if (!isfinite(d->clearance.value)) return;
  double low = zero_of(d) - threshold, high = zero_of(d) + threshold;
  fg_plot_dot(at, d->push_mm, high, 5, "s1");
  fg_plot_dot(at, d->pull_mm, low, 5, "s1");
  double x1 = fg_plot_x(at, d->pull_mm), x2 = fg_plot_x(at, d->push_mm), y = at->bottom - 16;
  fprintf(at->out, "<path class=\"s1\" d=\"M%.1f %.1fV%.1fM%.1f %.1fV%.1fM%.1f %.1fH%.1f\"/>\n", x1,
          fg_plot_y(at, low), y + 6, x2, fg_plot_y(at, high), y + 6, x1, y, x2);
  snprintf(text, sizeof text, "%.1f ± %.1f µm", 1000 * d->clearance.value,
           1000 * FG_COVERAGE_FACTOR * d->clearance.u);
  fprintf(at->out, "<text class=\"x level\" x=\"%.1f\" y=\"%.1f\">%s</text>\n", (x1 + x2) / 2,
          y - 6, text);
}

void fg_load_plot_loops(FILE *out, const fg_load_test *test, const fg_load_direction *d) {
  const fg_load_sample *s = test->samples + d->first;
  double x[2] = {INFINITY, -INFINITY}, f[2] = {d->force_low_n, d->force_high_n};
  double threshold = test->options.threshold_n;
  for (size_t i = 0; i < d->count; i++)
    fg_range_add(x, s[i].x_mm, 0);
  fg_range_add(f, zero_of(d), threshold);
  fg_range_pad(x, 0.04, 1e-9);
  fg_range_pad(f, 0.08, 1e-9);
  fg_plot at = fg_plot_frame_begin(out, &(fg_plot_frame){"Force over displacement, every cycle", .width = 560, .height = 350, .left = 66, .x = x, .y = f, .y_title = "force, N", .x_title = "displacement, mm", .band = (double[]){zero_of(d) - threshold, zero_of(d) + threshold}, .band_style = "band"});
  put_record(&at, test, d);
  put_clearance(&at, d, threshold);
  fg_plot_end(&at);
}

static void put_stiffness_profile(const fg_plot *at, const fg_load_profile *profile) {
  double x[FG_LOAD_POINTS], y[FG_LOAD_POINTS], low[FG_LOAD_POINTS], high[FG_LOAD_POINTS];
  if (!profile->count) return;
  for (size_t i = 0; i < profile->count; i++) {
    const fg_load_point *p = &profile->point[i];
    double reach = FG_COVERAGE_FACTOR * p->u_stiffness_n_mm;
    x[i] = p->x_mm;
    y[i] = p->stiffness_n_mm;
    low[i] = y[i] - reach;
    high[i] = y[i] + reach;
  }
  fg_plot_ribbon(at, x, low, high, profile->count, "ci", "fill:#1f6fd0;fill-opacity:.14");
  fg_plot_line(at, x, y, profile->count, "s2");
}

void fg_load_plot_stiffness(FILE *out, const fg_load_direction *d) {
  double x[2] = {INFINITY, -INFINITY}, k[2] = {0, 0};
  for (int side = 0; side < FG_LOAD_SIDES; side++)
    for (size_t i = 0; i < d->profile[side].count; i++) {
      const fg_load_point *p = &d->profile[side].point[i];
      fg_range_add(x, p->x_mm, 0);
      fg_range_add(k, p->stiffness_n_mm, 0);
    }
  if (!(x[1] > x[0])) return;
  fg_range_add(k, d->stiffness.value + 2 * d->stiffness.u, 0);
  fg_range_pad(x, 0.04, 1e-9);
  fg_range_pad(k, 0.06, 1e-9);
  fg_plot at = fg_plot_frame_begin(
      out, &(fg_plot_frame){"Stiffness of the loading strokes over displacement", .width = 560,
                            .height = 350, .left = 66, .x = x, .y = k, .y_title = "dF/dx, N/mm",
                            .x_title = "displacement, mm"});
  for (int side = 0; side < FG_LOAD_SIDES; side++)
    put_stiffness_profile(&at, &d->profile[side]);
  if (isfinite(d->stiffness.value))
    fg_plot_dot(&at, d->stiffness_at_mm, d->stiffness.value, 5, "s1");
  fg_plot_end(&at);
}

static double curve_at(const fg_load_bearing *b, double deg) {
  double sum = b->mean_mm;
  for (int order = 2; order <= FG_LOAD_ORDER_MAX; order += 2)
    if (b->harmonic[order])
      sum += b->cosine_mm[order] * cos(order * deg * M_PI / 180) +
             b->sine_mm[order] * sin(order * deg * M_PI / 180);
  return 1000 * sum;
}

static void put_load_curve(const fg_plot *at, const fg_load_bearing *b) {
  double x[CURVE_STEPS + 1], y[CURVE_STEPS + 1];
  for (int i = 0; i <= CURVE_STEPS; i++) {
    x[i] = at->x_low + (at->x_high - at->x_low) * i / CURVE_STEPS;
    y[i] = curve_at(b, x[i]);
  }
  fg_plot_line(at, x, y, CURVE_STEPS + 1, "hint");
  if (!isfinite(b->min_at_deg)) return;
  for (double deg = b->min_at_deg - 720; deg <= at->x_high; deg += 180) /* both ends of the axis */
    if (deg >= at->x_low) fg_plot_segment(at, deg, at->y_low, deg, at->y_high, "limit");
}

static void put_direction(const fg_plot *at, const fg_load_direction *d) {
  double reach = 1000 * FG_COVERAGE_FACTOR * d->clearance.u_repeat, c = 1000 * d->clearance.value;
  if (!isfinite(c)) return;
  fg_plot_segment(at, d->azimuth_deg, c - reach, d->azimuth_deg, c + reach, "s2");
  fg_plot_dot(at, d->azimuth_deg, c, 4.5, "s2");
  if (!isfinite(d->predicted.value)) return;
  fg_plot_dot(at, d->azimuth_deg, 1000 * d->predicted.value, 4.5, "s1");
  if (isfinite(d->gap.value))
    fg_plot_shape(at, d->azimuth_deg, 1000 * d->gap.value, 4.5, FG_SHAPE_TRIANGLE, "s2");
}

void fg_load_plot_azimuths(FILE *out, const fg_load_test *test, size_t bearing) {
  double x[2] = {INFINITY, -INFINITY}, c[2] = {INFINITY, -INFINITY};
  for (size_t i = 0; i < test->direction_count; i++) {
    const fg_load_direction *d = &test->directions[i];
    double reach = 1000 * FG_COVERAGE_FACTOR * d->clearance.u_repeat;
    if (d->bearing != bearing) continue;
    fg_range_add(x, d->azimuth_deg, 10);
    fg_range_add(c, 1000 * d->clearance.value, reach);
    if (!isfinite(d->predicted.value)) continue;
    fg_range_add(c, 1000 * d->predicted.value, 0);
    fg_range_add(c, 1000 * d->gap.value, 0);
  }
  if (!(c[1] >= c[0])) return;
  fg_range_pad(c, 0.1, 1e-9);
  fg_plot at = fg_plot_frame_begin(
      out, &(fg_plot_frame){"Clearance over the azimuths", .height = 290, .left = 92, .x = x,
                            .y = c, .y_title = "clearance, µm", .x_title = "azimuth, degrees"});
  put_load_curve(&at, &test->bearings[bearing]);
  for (size_t i = 0; i < test->direction_count; i++)
    if (test->directions[i].bearing == bearing) put_direction(&at, &test->directions[i]);
  fg_plot_end(&at);
}

void fg_load_plot_break_away(FILE *out, const fg_load_test *test, size_t bearing) {
  const fg_break_away *b = &test->bearings[bearing].break_away;
  double rig = isfinite(b->rig_n) ? b->rig_n : 0, mu = b->friction.value;
  double start = b->intercept_n.value + rig, end = start + mu * b->weight_high_n;
  double x[2] = {0, b->weight_high_n}, f[2] = {0, 0};
  for (size_t i = 0; i < test->pull_count; i++)
    if (test->pulls[i].bearing == bearing) fg_range_add(f, test->pulls[i].friction_n, 0);
  fg_range_add(f, start, 0);
  fg_range_add(f, end, 0);
  fg_range_pad(x, 0.04, 1e-9);
  fg_range_pad(f, 0.08, 1e-9);
  fg_plot at = fg_plot_frame_begin(out, &(fg_plot_frame){"Break-away friction over dead weight",
                                                         .width = 560, .height = 350, .left = 66,
                                                         .x = x, .y = f, .y_title = "friction, N",
                                                         .x_title = "dead weight, N"});
  if (isfinite(mu)) fg_plot_segment(&at, 0, start, b->weight_high_n, end, "s2");
  for (size_t i = 0; i < test->pull_count; i++)
    if (test->pulls[i].bearing == bearing)
      fg_plot_dot(&at, test->pulls[i].weight_n, test->pulls[i].friction_n, 3.5, "s1");
  fg_plot_end(&at);
}
