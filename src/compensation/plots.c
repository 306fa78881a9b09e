/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "compensation/plots.h"

#include <math.h>

#include "compensation/profile.h"
#include "page/plot_frame.h"

enum { ARC_STEPS = 24, PROFILE_WIDTH = 1000, PROFILE_EDGE = 20, PROFILE_KEYS = 40 };

/* The dimensions of the foil that is expected, drawn as a die is. */
static fg_die_dimensions expected_foil(const fg_next_die *next) {
  fg_die_dimensions foil = next->die;
  foil.overall_radius_mm = next->expected.overall_radius_mm.value;
  foil.pitch_deg = next->die.bumps ? next->expected.pitch_deg.value : 0;
  for (size_t i = 0; i < foil.bumps; i++) {
    foil.bump[i].radius_mm = next->expected.bump[i].radius_mm.value;
    foil.bump[i].bump_angle_deg = next->expected.bump[i].bump_angle_deg.value;
    foil.bump[i].place_deg *= foil.pitch_deg / next->die.pitch_deg;
  }
  return foil;
}

/* A profile as a line; the crowns of all profiles share the middle of the plot. */
static fg_status put_profile(fg_context *ctx, const fg_plot *at, const fg_die_dimensions *die,
                             double shift, const char *style) {
  fg_die_profile_arcs profile;
  FG_TRY(fg_profile_make(ctx, die, 0, &profile));
  for (size_t i = 0; i < profile.count; i++) {
    const fg_profile_arc *arc = &profile.arc[i];
    double x[ARC_STEPS + 1], y[ARC_STEPS + 1];
    for (int k = 0; k <= ARC_STEPS; k++) {
      double angle = arc->from + (arc->to - arc->from) * k / ARC_STEPS;
      x[k] = arc->centre.x + arc->radius * sin(angle);
      y[k] = arc->centre.y + arc->radius * cos(angle) - shift;
    }
    fg_plot_line(at, x, y, ARC_STEPS + 1, style);
  }
  return FG_OK;
}

fg_status fg_next_die_plot_profile(fg_context *ctx, const fg_next_die *next, FILE *out) {
  const fg_die_dimensions foil = expected_foil(next), *dies[] = {&next->present, &next->die, &foil};
  static const char *const styles[] = {"s4", "s1", "s2"};
  double half_turn =
      next->die.bumps ? fmin(M_PI / 2, 0.5 * (double)next->die.bumps * foil.pitch_deg / 180 * M_PI)
                      : M_PI / 2;
  double reach = 1.03 * foil.overall_radius_mm * sin(half_turn), y[2] = {INFINITY, -INFINITY};
  double sag = foil.overall_radius_mm * (1 - cos(half_turn)), room = 0.06 * reach;
  const double x[2] = {-reach, reach};
  y[0] = -sag - room;
  y[1] = room;
  double scale = (PROFILE_WIDTH - 2 * PROFILE_EDGE) / (2 * reach);
  fg_plot at = fg_plot_open(
      out, &(fg_plot_frame){"The die now, the next die and the expected foil",
                            .height = (int)(scale * (y[1] - y[0])) + PROFILE_KEYS + PROFILE_EDGE,
                            .left = PROFILE_EDGE, .right = PROFILE_EDGE, .top = PROFILE_KEYS,
                            .bottom = PROFILE_EDGE, .x = x, .y = y});
  for (size_t i = 0; i < sizeof dies / sizeof *dies; i++)
    FG_TRY(put_profile(ctx, &at, dies[i], dies[i]->overall_radius_mm, styles[i]));
  fg_plot_key(&at, 60, "s4", "die now");
  fg_plot_key(&at, 260, "s1", "next die");
  fg_plot_key(&at, 460, "s2", "expected foil");
  fg_plot_end(&at);
  return FG_OK;
}

static double formed_radius(const fg_next_die *next, int number) {
  const fg_formed_data *data = &next->law->set[next->law->sets - 1].of[FG_FORMED_RADIUS];
  for (size_t i = 0; i < data->places; i++)
    if (data->place[i].number == number) return data->place[i].die * exp(data->place[i].log_ratio);
  return NAN;
}

static void put_radii(const fg_plot *at, const fg_next_die *next) {
  for (size_t i = 0; i < next->die.bumps; i++) {
    int number = (int)i + 1;
    const fg_expected_value *lot = &next->expected.bump[i].radius_mm;
    double formed = formed_radius(next, number), middle = 0.5 * (lot->low + lot->high);
    fg_plot_dot(at, number - 0.15, next->present.bump[i].radius_mm, 4, "s4");
    if (isfinite(formed)) fg_plot_dot(at, number - 0.05, formed, 4, "s3");
    fg_plot_interval(at, number + 0.05, 0, next->die.bump[i].radius_mm,
                     2 * next->die.bump[i].u_radius_mm, "s1");
    fg_plot_interval(at, number + 0.15, 0, middle, 0.5 * (lot->high - lot->low), "s2");
  }
}

void fg_next_die_plot_radii(const fg_next_die *next, FILE *out) {
  double range[2] = {INFINITY, -INFINITY}, x[2] = {0.4, (double)next->die.bumps + 0.6};
  for (size_t i = 0; i < next->die.bumps; i++) {
    const fg_expected_value *lot = &next->expected.bump[i].radius_mm;
    fg_range_add(range, next->present.bump[i].radius_mm, 0);
    fg_range_add(range, next->die.bump[i].radius_mm, 2 * next->die.bump[i].u_radius_mm);
    fg_range_add(range, lot->low, 0);
    fg_range_add(range, lot->high, 0);
    fg_range_add(range, formed_radius(next, (int)i + 1), 0);
  }
  fg_range_pad(range, 0.08, 0.002);
  fg_plot at = fg_plot_frame_begin(
      out, &(fg_plot_frame){"Radius of every bump: now, in the next die, expected", .height = 320,
                            .left = 80, .top = 34, .x = x, .y = range, .y_title = "bump radius, mm",
                            .ticks = FG_TICKS_OWN});
  for (size_t i = 0; i < next->die.bumps; i++)
    fg_plot_x_number(&at, (int)i + 1);
  fg_plot_x_title(&at, "bump");
  fg_plot_level(&at, next->target.bumps.radius_mm, "land");
  put_radii(&at, next);
  fg_plot_key(&at, 90, "s3", "last foils, mean");
  fg_plot_key(&at, 270, "s4", "die now");
  fg_plot_key(&at, 390, "s1", "next die ± U");
  fg_plot_key(&at, 550, "s2", "next lot's mean, 95 %");
  fg_plot_end(&at);
}

enum { SETTING_LINES = 3 };

/* The settings of one value of the second factor, in order: a stretch of the list behind the first.
 */
static size_t line_of_settings(const fg_next_die *next, size_t line, size_t *first) {
  size_t count = 0;
  double level = NAN;
  *first = 0;
  for (size_t i = 1, lines = 0; i < next->settings; i++) {
    bool other = i == 1 || (isfinite(next->setting[i].second) && next->setting[i].second != level);
    lines += other;
    level = next->setting[i].second;
    if (lines == line + 1 && other) *first = i;
    count += lines == line + 1;
  }
  return count;
}

/* One value of the trade over all settings, with room around it. */
static void plot_trade(const fg_next_die *next, const char *title,
                       double (*value)(const fg_setting_trade *), FILE *out) {
  static const char *const styles[SETTING_LINES] = {"s1", "s2", "s3"};
  double x[2] = {INFINITY, -INFINITY}, y[2] = {INFINITY, -INFINITY};
  for (size_t i = 0; i < next->settings; i++) {
    fg_range_add(x, next->setting[i].first, 0);
    fg_range_add(y, value(&next->setting[i]), 0);
  }
  fg_range_pad(x, 0.03, 0);
  fg_range_pad_by_size(y, 0.1);
  fg_plot at = fg_plot_frame_begin(
      out, &(fg_plot_frame){title, .height = 260, .left = 80, .top = 34, .x = x, .y = y,
                            .y_title = title, .x_title = next->factor[0]});
  for (size_t line = 0; line < SETTING_LINES; line++) {
    double at_x[FG_COMPENSATION_SETTINGS], at_y[FG_COMPENSATION_SETTINGS];
    char words[100];
    size_t first, count = line_of_settings(next, line, &first);
    for (size_t i = 0; i < count; i++) {
      at_x[i] = next->setting[first + i].first;
      at_y[i] = value(&next->setting[first + i]);
    }
    if (!count) continue;
    fg_plot_line(&at, at_x, at_y, count, styles[line]);
    snprintf(words, sizeof words, "%s %.4g", next->factor[1], next->setting[first].second);
    if (isfinite(next->setting[first].second))
      fg_plot_key(&at, 90 + 220 * (double)line, styles[line], words);
  }
  fg_plot_shape(&at, next->setting[0].first, value(&next->setting[0]), 6, FG_SHAPE_SQUARE, "s4");
  fg_plot_shape(&at, next->setting[next->chosen].first, value(&next->setting[next->chosen]), 6,
                FG_SHAPE_DIAMOND, "k3");
  fg_plot_end(&at);
}

static double trade_radius(const fg_setting_trade *trade) {
  double radius = isfinite(trade->radius_mm) ? trade->radius_mm : trade->overall_radius_mm;
  return isfinite(trade->u_next_pct) ? radius : NAN;
}

static double trade_u(const fg_setting_trade *trade) {
  return trade->u_next_pct;
}

void fg_next_die_plot_settings(const fg_next_die *next, FILE *out) {
  plot_trade(next, "radius of the die, mm", trade_radius, out);
  plot_trade(next, "u of the next lot's mean, %", trade_u, out);
}
