/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "grid_loop/problem.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "geometry/mark_nodes.h"

/* Prior sd of scale, ratio and shear of a board of which nothing is stated: printers err by some
 * parts in a thousand. */
#define U_PRINTED 0.01
/* Spacing of the splines of a map, as a share of the region's longer side. */
enum { MAP_INTERVALS = 10 };
/* Nodes of a mark on a smooth field, and columns of a map over them. */
enum { SMOOTH_NODES = 8, MARK_MAP_MAX = 2 * 5 * 5 };

/* Marks show two waves as one where they have this share of a wave in common. */
#define ALIKE_SHARE 0.5
/* Step of frequencies in waves over the region, and steps by which a wave is tried askew. */
#define ALIKE_STEP 0.25
enum { ALIKE_STEPS = 8 };
/* Shortest wave that marks on a turned board tell, pitches. */
#define TURNED_WAVE 0.7

/* Share of a shape over which its derivative is taken. */
#define SHAPE_STEP 1e-4

size_t fg_grid_effect_columns(const grid_effect *effect) {
  return effect->kind->columns + (effect->loose ? effect->kind->shapes : 0);
}

static fg_point moved_by_shape(const grid_effect *effect, const fg_field_frame *frame,
                               const double *shape, fg_point at) {
  fg_point d[FG_FIELD_COLUMNS], sum = {0, 0};
  effect->kind->glass(frame, shape, at, d);
  for (size_t k = 0; k < effect->kind->columns; k++) {
    sum.x += effect->amplitude_mm[k] * d[k].x;
    sum.y += effect->amplitude_mm[k] * d[k].y;
  }
  return sum;
}

size_t fg_grid_effect_moves(const grid_effect *effect, const fg_field_frame *frame, fg_point at,
                            fg_point d[FG_FIELD_COLUMNS]) {
  size_t n = effect->kind->columns;
  effect->kind->glass(frame, effect->shape, at, d);
  for (size_t s = 0; effect->loose && s < effect->kind->shapes; s++) {
    double low[FG_FIELD_SHAPES], high[FG_FIELD_SHAPES];
    memcpy(low, effect->shape, sizeof low);
    memcpy(high, effect->shape, sizeof high);
    double step = SHAPE_STEP * fmax(fabs(effect->shape[s]), 1e-3);
    low[s] -= step;
    high[s] += step;
    fg_point a = moved_by_shape(effect, frame, low, at);
    fg_point b = moved_by_shape(effect, frame, high, at);
    /* No slope leads across a jump. */
    bool across =
        effect->kind->jumps && hypot(b.x - a.x, b.y - a.y) > 0.5 * fabs(effect->amplitude_mm[0]);
    double weight = across ? 0 : 1 / (2 * step);
    d[n++] = (fg_point){weight * (b.x - a.x), weight * (b.y - a.y)};
  }
  return n;
}

double fg_grid_nearest_jump(const grid_effect *effect, double along) {
  double first = effect->shape[0], pitch = effect->shape[1];
  return effect->kind->shapes > 1 ? first + pitch * round((along - first) / pitch) : first;
}

/* Nodes that an effect needs on a mark: what a mark does not see as one place is a wave, a decay,
 * or a jump between its edges. */
static size_t nodes_for(const grid_effect *effect, const grid_row *row) {
  if (!effect->kind->shapes || effect->kind->polynomial != FG_EFFECT_NO_POLYNOMIAL) return 1;
  if (!effect->kind->jumps) return SMOOTH_NODES;
  double along = fg_point_along(row->at, effect->kind->axis);
  return fabs(along - fg_grid_nearest_jump(effect, along)) < row->reach_mm ? FG_MARK_NODES_MAX : 1;
}

size_t fg_grid_effect_of_row(const grid_effect *effect, const fg_field_frame *frame,
                             const grid_row *row, double value[FG_FIELD_COLUMNS]) {
  fg_mark_node nodes[FG_MARK_NODES_MAX];
  fg_mark mark = {.at_mm = row->at, .reach_mm = row->reach_mm, .polarity = row->corner};
  size_t count = fg_mark_nodes(&mark, row->direction, nodes_for(effect, row), nodes);
  size_t columns = fg_grid_effect_columns(effect);
  for (size_t c = 0; c < columns; c++)
    value[c] = 0;
  for (size_t k = 0; k < count; k++) {
    fg_point d[FG_FIELD_COLUMNS], weight = nodes[k].weight;
    fg_grid_effect_moves(effect, frame, nodes[k].at, d);
    for (size_t c = 0; c < columns; c++)
      value[c] += weight.x * d[c].x + weight.y * d[c].y;
  }
  return columns;
}

grid_columns fg_grid_columns(const grid_problem *problem) {
  grid_columns c = {0};
  size_t effect_columns = 0;
  for (size_t e = 0; e < problem->model.effects; e++)
    effect_columns += fg_grid_effect_columns(&problem->model.effect[e]);
  c.board = GRID_POSE * problem->scan_count;
  c.effect = c.board + GRID_AFFINE * problem->board_count;
  c.map = c.effect + effect_columns;
  c.board_map = c.map + (problem->model.has_map ? 2 * fg_map_splines(&problem->model.map) : 0);
  c.count = c.board_map +
            (problem->model.has_board_map ? 2 * fg_map_splines(&problem->model.board_map) : 0);
  return c;
}

static size_t add_map_columns(const fg_map_frame *frame, size_t first, fg_point at,
                              fg_point direction, size_t *index, double *value) {
  fg_map_weight weights[FG_MAP_WEIGHTS];
  size_t n = 0, splines = fg_map_splines(frame);
  fg_map_weigh(frame, at, weights);
  for (size_t k = 0; k < FG_MAP_WEIGHTS; k++) {
    index[n] = first + weights[k].spline;
    value[n++] = direction.x * weights[k].value;
    index[n] = first + splines + weights[k].spline;
    value[n++] = direction.y * weights[k].value;
  }
  return n;
}

/* The mean of a map over a mark's edges. A mark is smaller than a spline's interval: its nodes lie
 * in two intervals at most, along either axis. */
static size_t add_marks_map(const fg_map_frame *frame, size_t first, const grid_row *row,
                            size_t *index, double *value) {
  fg_mark_node nodes[FG_MARK_NODES_MAX];
  fg_mark mark = {.at_mm = row->at, .reach_mm = row->reach_mm, .polarity = row->corner};
  size_t count = fg_mark_nodes(&mark, row->direction, SMOOTH_NODES, nodes), n = 0;
  for (size_t k = 0; k < count; k++) {
    size_t own_index[2 * FG_MAP_WEIGHTS];
    double own[2 * FG_MAP_WEIGHTS];
    size_t columns = add_map_columns(frame, first, nodes[k].at, nodes[k].weight, own_index, own);
    for (size_t c = 0; c < columns; c++) {
      size_t at = 0;
      while (at < n && index[at] != own_index[c])
        at++;
      if (at == n) {
        if (n == MARK_MAP_MAX) continue;
        index[n] = own_index[c];
        value[n++] = 0;
      }
      value[at] += own[c];
    }
  }
  return n;
}

size_t fg_grid_row_columns(const grid_problem *problem, const grid_columns *columns,
                           const grid_row *row, size_t *index, double *value) {
  size_t n = 0;
  fg_point e = row->direction, p = row->place;
  double turn = problem->pose[row->scan].turn_rad, c = cos(turn), s = sin(turn);
  fg_point on_board = {e.x * c + e.y * s, e.y * c - e.x * s}; /* e in the board's frame */
  const double pose[GRID_POSE] = {-e.x, -e.y, e.x * row->arm.y - e.y * row->arm.x};
  const double affine[GRID_AFFINE] = {-(on_board.x * p.x + on_board.y * p.y),
                                      -(on_board.x * p.x - on_board.y * p.y),
                                      -(on_board.x * p.y + on_board.y * p.x)};
  for (size_t k = 0; k < GRID_POSE; k++, n++) {
    index[n] = columns->pose + GRID_POSE * row->scan + k;
    value[n] = pose[k];
  }
  for (size_t k = 0; k < GRID_AFFINE; k++, n++) {
    index[n] = columns->board + GRID_AFFINE * row->board + k;
    value[n] = affine[k];
  }
  size_t at = columns->effect;
  for (size_t f = 0; f < problem->model.effects; f++) {
    const grid_effect *effect = &problem->model.effect[f];
    size_t own = fg_grid_effect_of_row(effect, &problem->model.frame, row, value + n);
    for (size_t k = 0; k < own; k++, n++)
      index[n] = at++;
  }
  if (problem->model.has_map)
    n += add_marks_map(&problem->model.map, columns->map, row, index + n, value + n);
  if (problem->model.has_board_map)
    n += add_map_columns(&problem->model.board_map, columns->board_map, p,
                         (fg_point){-on_board.x, -on_board.y}, index + n, value + n);
  return n;
}

/* ---- rows ---- */

static fg_point turned_by(double turn, fg_point p) {
  return (fg_point){p.x * cos(turn) - p.y * sin(turn), p.x * sin(turn) + p.y * cos(turn)};
}

/* Place of a mark on its board, by the certificate or the lattice; false where a certificate has
 * none. */
static bool find_board_place(const grid_problem *problem, double pitch, const int index[2],
                             fg_point *place) {
  if (problem->certificate.columns)
    return fg_grid_certificate_at(&problem->certificate, index, place);
  *place = (fg_point){pitch * index[0], pitch * index[1]};
  return true;
}

/* A scan's marks are those of the certificate where the first and the last columns and rows are
 * seen, and lie as in the table. */
static fg_status check_certificate(fg_context *ctx, const fg_measurement *m,
                                   const fg_grid_certificate *certificate) {
  const fg_grid *grid = m->grid;
  int rows = grid->kind == FG_MARKS_LINES ? 1 : grid->rows;
  if (grid->columns != certificate->columns || rows != certificate->rows)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s shows %d columns and %d rows of marks, the certificate has %d and %d: lay "
                   "the whole plate on the glass, its columns along x as in the table",
                   m->scan, grid->columns, rows, certificate->columns, certificate->rows);
  double better;
  int turn = fg_grid_certificate_turn(certificate, grid, &better);
  if (!turn) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: the plate lies turned by %d degrees clockwise against its certificate: its "
                 "marks fit the table %.1f times better so; lay it on the glass as in the table",
                 m->scan, 90 * turn, better);
}

static fg_status read_certificate(fg_context *ctx, const fg_measurement *measurements, size_t count,
                                  bool same_part, grid_problem *problem) {
  const char *path = problem->design->certificate;
  if (!path[0]) return FG_OK;
  FG_TRY(fg_grid_certificate_load(ctx, path, problem->design->marks == FG_MARKS_LINES,
                                  &problem->certificate));
  for (size_t i = 0; i < (same_part ? 1 : count); i++)
    FG_TRY(check_certificate(ctx, &measurements[i], &problem->certificate));
  return FG_OK;
}

/* Finds the place of a mark on its board; false: the mark is not used, or the board has no such
 * place. */
static bool find_place_of_mark(const grid_problem *problem, size_t scan, const fg_mark *mark,
                               fg_point *place) {
  double pitch = problem->board[problem->board_of[scan]].pitch_mm;
  int index[2];
  if (!mark->used) return false;
  fg_grid_board_index(problem, scan, mark, index);
  return find_board_place(problem, pitch, index, place);
}

/* The pose that lays the board's places nearest to the measured ones. */
static void find_pose(const grid_problem *problem, size_t scan, const fg_grid *grid,
                      grid_pose *pose) {
  double n = 0, mean[4] = {0}, dot = 0, cross = 0;
  fg_point place;
  for (size_t i = 0; i < grid->count; i++) {
    const fg_mark *m = &grid->marks[i];
    if (!find_place_of_mark(problem, scan, m, &place)) continue;
    const double values[4] = {place.x, place.y, m->at_mm.x, m->at_mm.y};
    n++;
    for (int k = 0; k < 4; k++)
      mean[k] += (values[k] - mean[k]) / n;
  }
  for (size_t i = 0; i < grid->count; i++) {
    const fg_mark *m = &grid->marks[i];
    if (!find_place_of_mark(problem, scan, m, &place)) continue;
    double px = place.x - mean[0], py = place.y - mean[1];
    double x = m->at_mm.x - mean[2], y = m->at_mm.y - mean[3];
    dot += px * x + py * y;
    cross += px * y - py * x;
  }
  pose->turn_rad = atan2(cross, dot);
  fg_point middle = turned_by(pose->turn_rad, (fg_point){mean[0], mean[1]});
  pose->origin = (fg_point){mean[2] - middle.x, mean[3] - middle.y};
}

static fg_status add_scan_rows(const fg_grid *grid, size_t scan, grid_problem *problem) {
  const grid_pose *pose = &problem->pose[scan];
  int components = grid->kind == FG_MARKS_LINES ? 1 : 2;
  for (size_t i = 0; i < grid->count; i++) {
    const fg_mark *m = &grid->marks[i];
    fg_point place;
    if (!find_place_of_mark(problem, scan, m, &place)) continue;
    fg_point arm = turned_by(pose->turn_rad, place);
    fg_point off = {pose->origin.x + arm.x - m->at_mm.x, pose->origin.y + arm.y - m->at_mm.y};
    for (int k = 0; k < components; k++) {
      fg_point e = turned_by(pose->turn_rad, (fg_point){k == 0, k == 1});
      problem->rows[problem->row_count++] = (grid_row){.scan = scan,
                                                       .board = problem->board_of[scan],
                                                       .mark = i,
                                                       .group = (size_t)k,
                                                       .at = m->at_mm,
                                                       .place = place,
                                                       .direction = e,
                                                       .reach_mm = m->reach_mm,
                                                       .corner = m->polarity != 0,
                                                       .value = e.x * off.x + e.y * off.y,
                                                       .arm = arm,
                                                       .used = true};
    }
  }
  return FG_OK;
}

static int compare_rows(const void *a, const void *b) {
  const grid_row *p = a, *q = b;
  if (p->board != q->board) return p->board < q->board ? -1 : 1;
  if (p->place.y != q->place.y) return p->place.y < q->place.y ? -1 : 1;
  if (p->place.x != q->place.x) return p->place.x < q->place.x ? -1 : 1;
  if (p->group != q->group) return p->group < q->group ? -1 : 1;
  return p->scan < q->scan ? -1 : p->scan > q->scan;
}

static bool is_same_component(const grid_row *a, const grid_row *b) {
  return a->board == b->board && a->place.x == b->place.x && a->place.y == b->place.y;
}

/* Rows of one component of one mark get one number. */
static void number_groups(grid_problem *problem) {
  fg_sort_items(problem->rows, problem->row_count, sizeof *problem->rows, compare_rows);
  size_t group = 0, component = 0;
  for (size_t i = 0; i < problem->row_count; i++) {
    grid_row *row = &problem->rows[i];
    size_t own = row->group;
    if (i && !(is_same_component(row, row - 1) && own == component)) group++;
    component = own;
    row->group = group;
  }
  problem->group_count = problem->row_count ? group + 1 : 0;
}

/* ---- boards and region ---- */

/* The stated pitch, or the first scan's geometric mean of both axes. */
static double pitch_of(const fg_grid *grid, const fg_design_grid *design) {
  double steps = grid->squares_per_step == 2 ? 2 : 1;
  if (design->pitch_mm > 0) return steps * design->pitch_mm;
  if (grid->kind == FG_MARKS_LINES)
    return isfinite(grid->step_mm[0].value) ? grid->step_mm[0].value : grid->step_mm[1].value;
  return sqrt(grid->step_mm[0].value * grid->step_mm[1].value);
}

static void find_boards(const fg_measurement *measurements, size_t count, bool same_part,
                        grid_problem *problem) {
  const fg_design_grid *design = problem->design;
  bool certified = problem->certificate.columns > 0;
  bool known = certified || (design->pitch_mm > 0 && design->u_pitch_mm > 0);
  double u_known = certified ? problem->certificate.u_scale : design->u_pitch_mm / design->pitch_mm;
  /* Marks are referred to 20 °C, as a plate's pitch is: by its temperature and expansion. */
  const fg_calibration_budget heat = fg_calibration_terms(&measurements[0].design.calibration);
  u_known = hypot(u_known, hypot(heat.temperature, heat.expansion));
  problem->scale_known = known;
  problem->board_count = same_part ? 1 : count;
  for (size_t i = 0; i < count; i++) {
    problem->board_of[i] = same_part ? 0 : i;
    if (same_part && i) continue;
    problem->board[i] = (grid_board){.pitch_mm = pitch_of(measurements[i].grid, design),
                                     .u_scale = known ? u_known : U_PRINTED};
  }
}

/* The region of all marks is that of the fields. */
static void find_region(grid_problem *problem) {
  fg_field_frame *frame = &problem->model.frame;
  for (int axis = 0; axis < 2; axis++) {
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < problem->row_count; i++) {
      double at = fg_point_along(problem->rows[i].at, axis);
      low = fmin(low, at);
      high = fmax(high, at);
    }
    if (high - low < 1) low -= 0.5, high += 0.5; /* a ruler along the other axis */
    frame->low_mm[axis] = frame->first_mm[axis] = low;
    frame->high_mm[axis] = frame->last_mm[axis] = high;
    frame->centre_mm[axis] = 0.5 * (low + high);
  }
  frame->knots = FG_FIELD_COLUMNS;
}

/* Share of a wave of `along` (1/mm along x and y) that the marks' places have in common with one of
 * the frequency 0. */
static double window_at(const grid_problem *problem, fg_point along) {
  double cosine = 0, sine = 0, n = 0;
  for (size_t i = 0; i < problem->row_count; i++) {
    const grid_row *row = &problem->rows[i];
    if (i && row->scan == row[-1].scan && row->mark == row[-1].mark) continue;
    double angle = 2 * M_PI * (along.x * row->at.x + along.y * row->at.y);
    cosine += cos(angle);
    sine += sin(angle);
    n++;
  }
  return hypot(cosine, sine) / n;
}

/* The maximum that the marks have in common with a wave along y, or with one that is a little
 * askew: what a map leaves looks like those. */
static double max_window_at(const grid_problem *problem, double frequency, double askew) {
  double max = 0;
  for (int i = -ALIKE_STEPS; i <= ALIKE_STEPS; i++)
    max = fmax(max, window_at(problem, (fg_point){askew * i / ALIKE_STEPS, frequency}));
  return max;
}

/* Two waves look alike where the sum of their frequencies is one at which all marks have one phase:
 * on a board in line with the axes, the inverse of the pitch. On a turned one none does, and waves
 * are told that are shorter than two pitches, but for those that look like a map's. */
static void find_alike(grid_problem *problem) {
  double whole = 1 / problem->board[0].pitch_mm, max = whole / TURNED_WAVE, max_straight = 0;
  double width = 1 / (problem->model.frame.high_mm[1] - problem->model.frame.low_mm[1]);
  double step = ALIKE_STEP * width;
  problem->alike_per_mm = 0;
  problem->min_wave_mm = 1 / max;
  for (int i = -(int)(0.5 * whole / step); whole + i * step < max + 2 * width; i++) {
    double frequency = whole + i * step;
    double straight = window_at(problem, (fg_point){0, frequency});
    if (straight > fmax(max_straight, ALIKE_SHARE))
      problem->alike_per_mm = frequency, max_straight = straight;
    if (max_window_at(problem, frequency, 2 * width) < ALIKE_SHARE) continue;
    if (!problem->alike_to_per_mm) problem->alike_from_per_mm = frequency - 1.5 * width;
    problem->alike_to_per_mm = frequency + 1.5 * width;
  }
  if (problem->alike_per_mm > 0) problem->min_wave_mm = 2 / problem->alike_per_mm;
}

/* Splines over a box of marks; false where `splines` are too few for a map. */
static bool lay_map(const double low[2], const double high[2], double splines,
                    fg_map_frame *frame) {
  double size[2] = {high[0] - low[0], high[1] - low[1]}, longer = fmax(size[0], size[1]);
  for (double intervals = MAP_INTERVALS; intervals >= 2; intervals--) {
    for (int axis = 0; axis < 2; axis++) {
      frame->low_mm[axis] = low[axis];
      frame->high_mm[axis] = high[axis];
      frame->side[axis] = 3 + (size_t)fmax(1, ceil(intervals * size[axis] / longer - 1e-9));
    }
    if ((double)fg_map_splines(frame) <= splines) return true;
  }
  return false;
}

void fg_grid_lay_maps(grid_problem *problem, double marks_per_spline) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, marks = 0;
  for (size_t i = 0; i < problem->row_count; i++) {
    const grid_row *row = &problem->rows[i];
    if (row->scan == 0) marks += 0.5;
    if (row->board != 0) continue;
    for (int axis = 0; axis < 2; axis++) {
      low[axis] = fmin(low[axis], fg_point_along(row->place, axis));
      high[axis] = fmax(high[axis], fg_point_along(row->place, axis));
    }
  }
  double splines = marks / marks_per_spline;
  problem->model.has_map = lay_map(problem->model.frame.low_mm, problem->model.frame.high_mm,
                                   splines, &problem->model.map);
  problem->model.has_board_map = problem->model.has_map && problem->model.turned &&
                                 lay_map(low, high, splines, &problem->model.board_map);
}

fg_status fg_grid_problem_build(fg_context *ctx, const fg_measurement *measurements, size_t count,
                                const fg_grid_loop_options *options, grid_problem *problem) {
  size_t marks = 0;
  *problem = (grid_problem){.design = &measurements[0].design.grid, .scan_count = count};
  FG_TRY(fg_grid_match_scans(ctx, measurements, count, options, problem));
  FG_TRY(read_certificate(ctx, measurements, count, options->same_part, problem));
  find_boards(measurements, count, options->same_part, problem);
  for (size_t i = 0; i < count; i++)
    marks += measurements[i].grid->count;
  FG_TRY(fg_memory_allocate(ctx, 2 * marks, sizeof *problem->rows, (void **)&problem->rows));
  for (size_t i = 0; i < count; i++) {
    find_pose(problem, i, measurements[i].grid, &problem->pose[i]);
    FG_TRY(add_scan_rows(measurements[i].grid, i, problem));
  }
  number_groups(problem);
  find_region(problem);
  find_alike(problem);
  return FG_OK;
}

void fg_grid_problem_free(grid_problem *problem) {
  free(problem->rows);
  fg_grid_certificate_free(&problem->certificate);
  *problem = (grid_problem){0};
}
