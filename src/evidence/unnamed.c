/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/unnamed.h"

#include <math.h>
#include <string.h>

#include "effect/midline.h"

/* Starts of the search for a shape: they are refined where an effect shows. Half a cycle over the
 * picture lies between two periods. */
enum { STARTS = 24, PERIODS = 48, BROKEN_NUMBERS = 3 };
/* A wave of changing size is wider in frequency than one cycle over the picture. */
enum { BAND_PERIODS = 24, ENVELOPE = 3, BAND_NUMBERS = 2 * ENVELOPE };
enum { JOINTS = 40, JOINT_NUMBERS = 2 };
enum { LENGTHS = 3, EVENT_PLACES = 24, EVENT_NUMBERS = 3, PULSE_PLACES = 40 };
enum { SPOT_STARTS = 96, SPOT_NUMBERS = 2 };
enum { BURR_WIDTHS = 2, BURR_PLACES = 288, BURR_DISCS_MAX = 20 };

static double start_along(const fg_field_frame *frame, int axis, size_t i, size_t count) {
  double low = frame->low_mm[axis], high = frame->high_mm[axis];
  return low + (high - low) * ((double)i + 1) / ((double)count + 1);
}

static double start_in_x(const fg_field_frame *frame, size_t i, size_t count) {
  return start_along(frame, 0, i, count);
}

static double start_in_y(const fg_field_frame *frame, size_t i, size_t count) {
  return start_along(frame, 1, i, count);
}

/* A slope, a jump, and another slope behind it. */
static void fill_broken_line(const fg_field_frame *frame, int axis, double place_mm, fg_point at,
                             double *values) {
  double along = fg_point_along(at, axis);
  values[0] = (along - frame->centre_mm[axis]) / FG_FIELD_HALF_MM;
  values[1] = along > place_mm ? 1 : 0;
  values[2] = along > place_mm ? (along - place_mm) / FG_FIELD_HALF_MM : 0;
}

#define BROKEN_LINE(name, over, moved_x, moved_y)                                                  \
  static void name(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {   \
    double values[BROKEN_NUMBERS];                                                                 \
    fill_broken_line(frame, over, shape[0], at, values);                                           \
    for (int c = 0; c < BROKEN_NUMBERS; c++)                                                       \
      d[c] = (fg_point){(moved_x)*values[c], (moved_y)*values[c]};                                 \
  }
BROKEN_LINE(x_broken_over_x, 0, 1, 0)
BROKEN_LINE(y_broken_over_x, 0, 0, 1)
BROKEN_LINE(x_broken_over_y, 1, 1, 0)
BROKEN_LINE(y_broken_over_y, 1, 0, 1)

/* ---- decays and waves, along the axes and of the things for which no effect has a name ---- */

static double span_along(const fg_field_frame *frame, int axis) {
  return frame->high_mm[axis] - frame->low_mm[axis];
}

/* Evenly in the logarithm. */
static double length_along(const fg_field_frame *frame, int axis, size_t i, size_t count) {
  double low = 0.5;
  return low * pow(span_along(frame, axis) / low, (double)i / (double)count);
}

/* Evenly in frequency, from one and a half cycles on. */
static double period_along(const fg_field_frame *frame, int axis, size_t i, size_t count) {
  (void)count;
  return span_along(frame, axis) / (1.5 + 0.5 * (double)i);
}

static double length_in_x(const fg_field_frame *frame, size_t i, size_t count) {
  return length_along(frame, 0, i, count);
}

static double length_in_y(const fg_field_frame *frame, size_t i, size_t count) {
  return length_along(frame, 1, i, count);
}

static double period_in_x(const fg_field_frame *frame, size_t i, size_t count) {
  return period_along(frame, 0, i, count);
}

static double period_in_y(const fg_field_frame *frame, size_t i, size_t count) {
  return period_along(frame, 1, i, count);
}

#define DECAY(name, over, moved_x, moved_y)                                                        \
  static void name(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {   \
    double value = exp(-(fg_point_along(at, over) - frame->low_mm[over]) / shape[0]);              \
    d[0] = (fg_point){(moved_x)*value, (moved_y)*value};                                           \
  }
DECAY(x_decays_over_x, 0, 1, 0)
DECAY(y_decays_over_x, 0, 0, 1)
DECAY(x_decays_over_y, 1, 1, 0)

#define WAVE(name, over, moved_x, moved_y)                                                         \
  static void name(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {   \
    double angle = 2 * M_PI * fg_point_along(at, over) / shape[0];                                 \
    (void)frame;                                                                                   \
    d[0] = (fg_point){(moved_x)*sin(angle), (moved_y)*sin(angle)};                                 \
    d[1] = (fg_point){(moved_x)*cos(angle), (moved_y)*cos(angle)};                                 \
  }
WAVE(x_waves_over_x, 0, 1, 0)
WAVE(y_waves_over_x, 0, 0, 1)
WAVE(x_waves_over_y, 1, 1, 0)

/* ---- waves whose size and phase change over the picture: a resonance that is not always excited
 * ----
 */

/* Evenly in frequency, one cycle over the picture between two. */
static double band_along(const fg_field_frame *frame, int axis, size_t i, size_t count) {
  (void)count;
  return span_along(frame, axis) / (2 + (double)i);
}

static double band_in_x(const fg_field_frame *frame, size_t i, size_t count) {
  return band_along(frame, 0, i, count);
}

static double band_in_y(const fg_field_frame *frame, size_t i, size_t count) {
  return band_along(frame, 1, i, count);
}

/* A wave over one axis times an envelope over it or the other. */
static void fill_band(const fg_field_frame *frame, int axis, int envelope_axis, double period_mm,
                      fg_point at, double *values) {
  double angle = 2 * M_PI * fg_point_along(at, axis) / period_mm;
  double from = fg_point_along(at, envelope_axis) - frame->low_mm[envelope_axis];
  double u = 2 * from / span_along(frame, envelope_axis) - 1;
  const double envelope[ENVELOPE] = {1, u, (3 * u * u - 1) / 2};
  for (int k = 0; k < ENVELOPE; k++) {
    values[2 * k] = envelope[k] * sin(angle);
    values[2 * k + 1] = envelope[k] * cos(angle);
  }
}

#define BAND(name, over, envelope_over, moved_x, moved_y)                                          \
  static void name(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {   \
    double values[BAND_NUMBERS];                                                                   \
    fill_band(frame, over, envelope_over, shape[0], at, values);                                   \
    for (int c = 0; c < BAND_NUMBERS; c++)                                                         \
      d[c] = (fg_point){(moved_x)*values[c], (moved_y)*values[c]};                                 \
  }
BAND(x_band_over_x, 0, 0, 1, 0)
BAND(y_band_over_x, 0, 0, 0, 1)
BAND(x_band_over_y, 1, 1, 1, 0)
BAND(y_band_over_y, 1, 1, 0, 1)
BAND(x_slanted_over_y, 1, 0, 1, 0)
BAND(y_slanted_over_y, 1, 0, 0, 1)

/* ---- events: what happens to the carriage at one place, and settles behind it, there or elsewhere
 */

/* Every length at every place along an axis. */
static void place_grid(const fg_edge_fit *edge_fit, int axis, const double lengths[LENGTHS],
                       double reach_share, size_t i, size_t count, double *shape, double *reach) {
  size_t places = count / LENGTHS;
  shape[0] = start_along(&edge_fit->frame, axis, i / LENGTHS, places);
  shape[1] = lengths[i % LENGTHS];
  reach[0] = span_along(&edge_fit->frame, axis) / (double)(places + 1);
  reach[1] = reach_share * shape[1];
}

static void event_grid(const fg_edge_fit *edge_fit, size_t i, size_t count, double *shape,
                       double *reach) {
  static const double lengths[LENGTHS] = {0.6, 1.8, 5.4};
  place_grid(edge_fit, 1, lengths, 0.7, i, count, shape, reach);
}

#define EVENT(name, moved_x, moved_y)                                                              \
  static void name(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {   \
    double t = fmax(0, (at.y - shape[0]) / shape[1]), behind = t > 0 ? 1 : 0, falls = exp(-t);     \
    const double values[EVENT_NUMBERS] = {behind, behind * falls, t * falls};                      \
    (void)frame;                                                                                   \
    for (int c = 0; c < EVENT_NUMBERS; c++)                                                        \
      d[c] = (fg_point){(moved_x)*values[c], (moved_y)*values[c]};                                 \
  }
EVENT(x_event_over_y, 1, 0)
EVENT(y_event_over_y, 0, 1)

/* ---- a pulse: a nudge of the carriage, a flaw of the lens; on one arc it is a dent of the part
 * ----
 */

static void pulse_grid(const fg_edge_fit *edge_fit, int axis, size_t i, size_t count, double *shape,
                       double *reach) {
  static const double lengths[LENGTHS] = {0.4, 0.9, 2};
  place_grid(edge_fit, axis, lengths, 0.5, i, count, shape, reach);
}

static void pulse_grid_x(const fg_edge_fit *edge_fit, size_t i, size_t count, double *shape,
                         double *reach) {
  pulse_grid(edge_fit, 0, i, count, shape, reach);
}

static void pulse_grid_y(const fg_edge_fit *edge_fit, size_t i, size_t count, double *shape,
                         double *reach) {
  pulse_grid(edge_fit, 1, i, count, shape, reach);
}

#define PULSE(name, over, moved_x, moved_y)                                                        \
  static void name(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {   \
    double u = (fg_point_along(at, over) - shape[0]) / shape[1], value = exp(-0.5 * u * u);        \
    (void)frame;                                                                                   \
    d[0] = (fg_point){(moved_x)*value, (moved_y)*value};                                           \
  }
PULSE(x_pulse_over_x, 0, 1, 0)
PULSE(y_pulse_over_x, 0, 0, 1)
PULSE(x_pulse_over_y, 1, 1, 0)
PULSE(y_pulse_over_y, 1, 0, 1)

/* ---- a flaw of the glass at one place of the edges, which are all that shows it ---- */

static void spot_grid(const fg_edge_fit *edge_fit, size_t i, size_t count, double *shape,
                      double *reach) {
  const double step_mm = 0.5;
  size_t row = (size_t)(((double)i + 0.5) / (double)count * (double)edge_fit->row_count);
  shape[0] = edge_fit->rows[row].ideal.x;
  shape[1] = edge_fit->rows[row].ideal.y;
  reach[0] = reach[1] = step_mm;
}

#define SPOT(name, width_mm)                                                                       \
  static void name(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {   \
    double u = (at.x - shape[0]) / (width_mm), v = (at.y - shape[1]) / (width_mm);                 \
    double value = exp(-0.5 * (u * u + v * v));                                                    \
    (void)frame;                                                                                   \
    d[0] = (fg_point){value, 0};                                                                   \
    d[1] = (fg_point){0, value};                                                                   \
  }
SPOT(small_spot, 0.5)
SPOT(large_spot, 1.2)

/* ---- a strip that is joined from two pieces: another slope and level behind one place ---- */

static void joint_grid(const fg_edge_fit *edge_fit, size_t i, size_t count, double *shape,
                       double *reach) {
  double low = edge_fit->psi_rad[0], step = (edge_fit->psi_rad[1] - low) / ((double)count + 1);
  shape[0] = low + step * ((double)i + 1);
  reach[0] = step;
}

static size_t joint_of_foil(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row,
                            const double *shape, double *values) {
  double share = fg_midline_along_normal(row), behind = row->psi - shape[0];
  (void)edge_fit;
  values[0] = behind > 0 ? share : 0;
  values[1] = behind > 0 ? share * behind : 0;
  return JOINT_NUMBERS;
}

/* ---- a burr or a flat of one disc: its place in turns, from the first disc on, and its standard
 * deviation in degrees ---- */

static void burr_grid(const fg_edge_fit *edge_fit, size_t i, size_t count, double *shape,
                      double *reach) {
  static const double widths[BURR_WIDTHS] = {7, 20};
  double places = (double)count / BURR_WIDTHS;
  double step = (double)edge_fit->part_count / places;
  shape[0] = step * ((double)(i / BURR_WIDTHS) + 0.5);
  shape[1] = widths[i % BURR_WIDTHS];
  reach[0] = step;
  reach[1] = 0.5 * shape[1];
}

static size_t burr_of_disc(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row,
                           const double *shape, double *values) {
  double disc = floor(shape[0]), turn = 0.5 * row->phi + 0.5 - (shape[0] - disc);
  double u = 360 * remainder(turn, 1) / shape[1];
  (void)edge_fit;
  values[0] = disc == (double)row->part ? exp(-0.5 * u * u) : 0;
  return 1;
}

#define BAND_ROW(name, over, thing, basis, from, tried)                                            \
  {                                                                                                \
    .id = name, .sought = FG_EFFECT_PLACED, .coordinate = (over) ? FG_EFFECT_Y : FG_EFFECT_X,      \
    .moves = thing, .columns = BAND_NUMBERS, .shapes = 1, .shape_is = {FG_EFFECT_LENGTH},          \
    .glass = basis, .axis = over, .start = from, .starts = tried,                                  \
    .size_from = "as of a wave, the change of its size less; assumed", .size_um = {                \
      10,                                                                                          \
      10,                                                                                          \
      6,                                                                                           \
      6,                                                                                           \
      4                                                                                            \
    }                                                                                              \
  }

#define EVENT_ROW(name, thing, basis)                                                              \
  {                                                                                                \
    .id = name, .sought = FG_EFFECT_PLACED, .coordinate = FG_EFFECT_Y, .moves = thing,             \
    .columns = EVENT_NUMBERS, .shapes = 2, .shape_is = {FG_EFFECT_PLACE, FG_EFFECT_LENGTH},        \
    .glass = basis, .axis = 1, .grid = event_grid, .starts = LENGTHS * EVENT_PLACES,               \
    .jumps = true, .size_from = "as of a lost row; assumed", .size_um = {                          \
      15                                                                                           \
    }                                                                                              \
  }

#define PULSE_ROW(name, over, thing, basis, from)                                                  \
  {                                                                                                \
    .id = name, .sought = FG_EFFECT_PLACED, .coordinate = (over) ? FG_EFFECT_Y : FG_EFFECT_X,      \
    .moves = thing, .columns = 1, .shapes = 2, .shape_is = {FG_EFFECT_PLACE, FG_EFFECT_LENGTH},    \
    .glass = basis, .axis = over, .grid = from, .starts = LENGTHS * PULSE_PLACES,                  \
    .size_from = "as of a lost row; assumed", .size_um = {                                         \
      15                                                                                           \
    }                                                                                              \
  }

#define SPOT_ROW(name, basis)                                                                      \
  {                                                                                                \
    .id = name, .sought = FG_EFFECT_PLACED, .coordinate = FG_EFFECT_Y, .moves = "x and y",         \
    .columns = SPOT_NUMBERS, .shapes = 2, .shape_is = {FG_EFFECT_PLACE, FG_EFFECT_PLACE},          \
    .glass = basis, .axis = 1, .grid = spot_grid, .starts = SPOT_STARTS,                           \
    .size_from = "as of a lost row; assumed", .size_um = {                                         \
      15                                                                                           \
    }                                                                                              \
  }

#define LENGTH_ROW(name, over, thing, basis, count, wave_x, wave_y, from, tried)                   \
  {                                                                                                \
    .id = name, .sought = FG_EFFECT_PLACED, .coordinate = (over) ? FG_EFFECT_Y : FG_EFFECT_X,      \
    .moves = thing, .columns = count, .shapes = 1, .shape_is = {FG_EFFECT_LENGTH}, .glass = basis, \
    .wave = {wave_x, wave_y}, .axis = over, .start = from, .starts = tried,                        \
    .size_from = "a pixel of 2400 dpi; assumed", .size_um = {                                      \
      10                                                                                           \
    }                                                                                              \
  }

#define ROW(name, over, thing, basis, from)                                                        \
  {                                                                                                \
    .id = name, .sought = FG_EFFECT_PLACED, .coordinate = (over) ? FG_EFFECT_Y : FG_EFFECT_X,      \
    .moves = thing, .columns = BROKEN_NUMBERS, .shapes = 1, .glass = basis, .axis = over,          \
    .start = from, .starts = STARTS, .jumps = true, .size_from = "as of a lost row; assumed",      \
    .size_um = {                                                                                   \
      15                                                                                           \
    }                                                                                              \
  }

const fg_effect fg_unnamed_effects[FG_UNNAMED_EFFECTS + 1] = {
    ROW("scan.x.dx with a jump", 0, "x", x_broken_over_x, start_in_x),
    ROW("scan.x.dy with a jump", 0, "y", y_broken_over_x, start_in_x),
    ROW("scan.y.dx with a jump", 1, "x", x_broken_over_y, start_in_y),
    ROW("scan.y.dy with a jump", 1, "y", y_broken_over_y, start_in_y),
    LENGTH_ROW("scan.x.dx as a decay", 0, "x", x_decays_over_x, 1, 0, 0, length_in_x, STARTS),
    LENGTH_ROW("scan.x.dy as a decay", 0, "y", y_decays_over_x, 1, 0, 0, length_in_x, STARTS),
    LENGTH_ROW("scan.y.dx as a decay", 1, "x", x_decays_over_y, 1, 0, 0, length_in_y, STARTS),
    LENGTH_ROW("scan.x.dx as a wave", 0, "x", x_waves_over_x, 2, 1, 0, period_in_x, PERIODS),
    LENGTH_ROW("scan.x.dy as a wave", 0, "y", y_waves_over_x, 2, 0, 1, period_in_x, PERIODS),
    LENGTH_ROW("scan.y.dx as a wave", 1, "x", x_waves_over_y, 2, 1, 0, period_in_y, PERIODS),
    BAND_ROW("scan.x.dx as a wave of changing size", 0, "x", x_band_over_x, band_in_x,
             BAND_PERIODS),
    BAND_ROW("scan.x.dy as a wave of changing size", 0, "y", y_band_over_x, band_in_x,
             BAND_PERIODS),
    BAND_ROW("scan.y.dx as a wave of changing size", 1, "x", x_band_over_y, band_in_y,
             BAND_PERIODS),
    BAND_ROW("scan.y.dy as a wave of changing size", 1, "y", y_band_over_y, band_in_y,
             BAND_PERIODS),
    BAND_ROW("scan.y.dx as a slanted wave", 1, "x", x_slanted_over_y, period_in_y, PERIODS),
    BAND_ROW("scan.y.dy as a slanted wave", 1, "y", y_slanted_over_y, period_in_y, PERIODS),
    EVENT_ROW("scan.y.dx as an event", "x", x_event_over_y),
    EVENT_ROW("scan.y.dy as an event", "y", y_event_over_y),
    PULSE_ROW("scan.x.dx as a pulse", 0, "x", x_pulse_over_x, pulse_grid_x),
    PULSE_ROW("scan.x.dy as a pulse", 0, "y", y_pulse_over_x, pulse_grid_x),
    PULSE_ROW("scan.y.dx as a pulse", 1, "x", x_pulse_over_y, pulse_grid_y),
    PULSE_ROW("scan.y.dy as a pulse", 1, "y", y_pulse_over_y, pulse_grid_y),
    SPOT_ROW("scan.xy at a small place", small_spot),
    SPOT_ROW("scan.xy at a large place", large_spot),
    {.id = "foil.s with a jump",
     .sought = FG_EFFECT_PLACED,
     .coordinate = FG_EFFECT_FOIL,
     .moves = "along the normal",
     .columns = JOINT_NUMBERS,
     .shapes = 1,
     .midline = joint_of_foil,
     .grid = joint_grid,
     .starts = JOINTS,
     .jumps = true,
     .size_um = {15},
     .size_from = "as of a dent; assumed"},
    {.id = "disc.form at one place",
     .sought = FG_EFFECT_PLACED,
     .coordinate = FG_EFFECT_COORDINATES, /* no curve: it is the disc's own */
     .moves = "along the normal",
     .columns = 1,
     .shapes = 2,
     .shape_is = {FG_EFFECT_PLACE, FG_EFFECT_LENGTH},
     .midline = burr_of_disc,
     .grid = burr_grid,
     .starts = BURR_WIDTHS * BURR_PLACES,
     .size_um = {15},
     .size_from = "as of a dent; assumed"},
    {.id = NULL},
};

/* Returns true for a line that is broken across its way: y over x, or x over y. */
static bool is_broken_across(const fg_effect *effect) {
  bool over_x = effect->coordinate == FG_EFFECT_X, moves_y = !strcmp(effect->moves, "y");
  return effect->columns == BROKEN_NUMBERS && !effect->grid && over_x == moves_y;
}

bool fg_unnamed_is_of_one_place(const fg_effect *effect) {
  return effect->grid == pulse_grid_x || effect->grid == pulse_grid_y || effect->grid == spot_grid;
}

bool fg_unnamed_shows(const fg_effect *effect, const fg_edge_fit *edge_fit) {
  if (effect->midline == burr_of_disc)
    return edge_fit->discs && edge_fit->part_count <= BURR_DISCS_MAX;
  if (!edge_fit->discs) return true;
  if (fg_unnamed_is_of_one_place(effect)) return false;
  return effect->jumps ? is_broken_across(effect) : effect->columns != BAND_NUMBERS;
}

size_t fg_unnamed_of_kind(const fg_effect *effect) {
  size_t count = 0;
  for (const fg_effect *one = fg_unnamed_effects; one->id; one++)
    count += fg_unnamed_is_of_one_place(one) == fg_unnamed_is_of_one_place(effect);
  return count;
}

bool fg_effect_bears_name(const fg_effect *effect) {
  for (const fg_effect *one = fg_unnamed_effects; one->id; one++)
    if (one == effect) return false;
  return effect != NULL;
}
