/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The result of a loop on grids, from its solution. */
#include <gsl/gsl_blas.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/text.h"
#include "grid_loop/grid_loop.h"

/* A value is found from this many standard uncertainties on. A posterior that is no narrower than
 * this share of its prior has learnt nothing of its own. */
#define FOUND_Z    3.0
#define TIED_SHARE 0.3
#define U_PRIOR    0.01
/* A board is turned enough where its rows climb by this many pitches. */
#define TELLING_PITCHES 1.0
/* Columns and rows of the reported map. */
enum { MAP_SIDE_MAX = 15 };

size_t fg_grid_displacement_columns(const grid_problem *problem, const grid_columns *columns,
                                    fg_point at, size_t *index, fg_point *value) {
  size_t n = 0, column = columns->effect;
  for (size_t e = 0; e < problem->model.effects; e++) {
    const grid_effect *effect = &problem->model.effect[e];
    fg_point d[FG_FIELD_COLUMNS];
    size_t own = fg_grid_effect_moves(effect, &problem->model.frame, at, d);
    for (size_t k = 0; k < own; k++, n++) {
      index[n] = column++;
      value[n] = d[k];
    }
  }
  if (!problem->model.has_map) return n;
  fg_map_weight weights[FG_MAP_WEIGHTS];
  fg_map_weigh(&problem->model.map, at, weights);
  size_t splines = fg_map_splines(&problem->model.map);
  for (size_t k = 0; k < FG_MAP_WEIGHTS; k++) {
    index[n] = columns->map + weights[k].spline;
    value[n++] = (fg_point){weights[k].value, 0};
    index[n] = columns->map + splines + weights[k].spline;
    value[n++] = (fg_point){0, weights[k].value};
  }
  return n;
}

static double covariance_at(const fg_grid_loop *loop, size_t a, size_t b) {
  return loop->widening * loop->widening * gsl_matrix_get(loop->solution.covariance, a, b);
}

/* ---- claims ---- */

static size_t effect_column(const fg_grid_loop *loop, size_t effect) {
  size_t at = loop->solution.columns.effect;
  for (size_t e = 0; e < effect; e++)
    at += fg_grid_effect_columns(&loop->problem.model.effect[e]);
  return at;
}

static fg_grid_claim *add_claim(fg_grid_loop_result *result, const char *id, const char *words) {
  if (result->claims == FG_GRID_CLAIMS) return &result->claim[FG_GRID_CLAIMS - 1];
  fg_grid_claim *claim = &result->claim[result->claims++];
  *claim = (fg_grid_claim){.id = id, .words = words, .shape = NAN};
  return claim;
}

static void judge_claim(fg_grid_claim *claim) {
  claim->z = fabs(claim->value) / claim->u;
  claim->verdict = claim->z >= FOUND_Z ? FG_GRID_FOUND : FG_GRID_ABSENT;
}

static void tell_effect(fg_grid_loop *loop, size_t e) {
  const grid_effect *effect = &loop->problem.model.effect[e];
  fg_grid_claim *claim = add_claim(&loop->result, effect->kind->id, effect->kind->words);
  size_t at = effect_column(loop, e);
  double a = gsl_vector_get(loop->solution.estimate, at), va = covariance_at(loop, at, at);
  claim->ratio = effect->kind->numbers == FG_EFFECT_RATIO;
  double unit = claim->ratio ? 1 / FG_FIELD_HALF_MM : 1000;
  claim->value = unit * a;
  claim->u = unit * sqrt(va);
  if (effect->kind->shapes) claim->shape = effect->shape[0];
  if (effect->kind->scales) loop->result.scale = claim->value;
  if (effect->kind->columns == 2) {
    double b = gsl_vector_get(loop->solution.estimate, at + 1), size = hypot(a, b);
    double vb = covariance_at(loop, at + 1, at + 1), ab = covariance_at(loop, at, at + 1);
    claim->value = unit * size;
    claim->u = unit * sqrt((a * a * va + b * b * vb + 2 * a * b * ab)) / size;
  }
  judge_claim(claim);
}

/* Ratio and shear of a board; x over y, so twice the half difference. */
static void tell_board(fg_grid_loop *loop) {
  static const char *const ids[2] = {"board.axis_ratio", "board.shear"};
  static const char *const words[2] = {"a board that is longer along its columns than its rows",
                                       "a board whose axes are not square"};
  for (size_t k = 0; k < 2; k++) {
    fg_grid_claim *claim = add_claim(&loop->result, ids[k], words[k]);
    size_t at = loop->solution.columns.board + 1 + k;
    claim->of_board = claim->ratio = true;
    claim->value = 2 * gsl_vector_get(loop->solution.estimate, at);
    claim->u = 2 * sqrt(covariance_at(loop, at, at));
    judge_claim(claim);
  }
}

/* A ratio or shear of the scanner that the data do not part from the board's: where their sum is
 * told and they are not. `scale` of the sum: ratio q + 2h, shear q + 2k. */
static void tie_with_board(fg_grid_loop *loop, fg_grid_claim *scanner, fg_grid_claim *board,
                           size_t scanner_column, size_t board_column) {
  double q = 1 / FG_FIELD_HALF_MM;
  double variance = q * q * covariance_at(loop, scanner_column, scanner_column) +
                    4 * covariance_at(loop, board_column, board_column) +
                    4 * q * covariance_at(loop, scanner_column, board_column);
  double sum = fabs(scanner->value + board->value), u = sqrt(fmax(0, variance));
  if (scanner->u < TIED_SHARE * U_PRIOR || sum < FOUND_Z * u) return;
  scanner->verdict = board->verdict = FG_GRID_TIED;
  scanner->value = board->value = scanner->value + board->value;
  scanner->u = board->u = u;
  scanner->z = board->z = sum / u;
  loop->result.tied = true;
}

static void tell_claims(fg_grid_loop *loop) {
  fg_grid_loop_result *result = &loop->result;
  const grid_columns *columns = &loop->solution.columns;
  for (size_t e = 0; e < loop->problem.model.effects; e++)
    tell_effect(loop, e);
  size_t board = result->claims;
  tell_board(loop);
  result->axis_ratio = 1 + result->claim[0].value;
  result->u_axis_ratio = result->claim[0].u;
  result->board_ratio = 1 + result->claim[board].value;
  result->u_board_ratio = result->claim[board].u;
  for (size_t k = 0; k < 2; k++)
    tie_with_board(loop, &result->claim[k], &result->claim[board + k], columns->effect + k,
                   columns->board + 1 + k);
}

/* The longest ripple, and its shorter likeness on marks in line with the axes. */
static void tell_likeness(fg_grid_loop *loop) {
  const grid_problem *problem = &loop->problem;
  fg_grid_loop_result *result = &loop->result;
  for (size_t e = 0; e < problem->model.effects; e++) {
    const grid_effect *effect = &problem->model.effect[e];
    if (effect->kind->numbers == FG_EFFECT_WAVE && effect->shape[0] > result->wave_mm)
      result->wave_mm = effect->shape[0];
  }
  double likeness = problem->alike_per_mm - 1 / result->wave_mm;
  if (result->wave_mm > 0 && likeness > 0)
    result->short_wave_mm = 1 / likeness;
  else
    result->wave_mm = 0;
  result->telling_turn_deg = TELLING_PITCHES * problem->board[0].pitch_mm /
                             (result->high_mm[0] - result->low_mm[0]) * 180 / M_PI;
}

/* ---- the map ---- */

/* Displacement of all map points by every column (x and y by turns), less shift and turn, which are
 * the poses', and less scale where nothing tells it: they have no meaning. */
enum { GAUGES_MAX = 4 };

static void remove_gauges(const fg_grid_loop_result *result, size_t count, gsl_matrix *moves) {
  double middle[2] = {0.5 * (result->low_mm[0] + result->high_mm[0]),
                      0.5 * (result->low_mm[1] + result->high_mm[1])};
  int gauges = result->scale_known ? 3 : 4;
  gsl_matrix *gauge = gsl_matrix_calloc((size_t)gauges, 2 * count);
  for (size_t k = 0; gauge && k < 2 * count; k++) {
    double x = result->map[k / 2].at_mm.x - middle[0], y = result->map[k / 2].at_mm.y - middle[1];
    const double values[GAUGES_MAX] = {k % 2 ? 0 : 1, k % 2 ? 1 : 0, k % 2 ? x : -y, k % 2 ? y : x};
    for (int g = 0; g < gauges; g++)
      gsl_matrix_set(gauge, (size_t)g, k, values[g]);
  }
  /* The points lie evenly about the middle: the four are orthogonal. */
  for (int g = 0; gauge && g < gauges; g++) {
    gsl_vector_view row = gsl_matrix_row(gauge, (size_t)g);
    double square;
    gsl_blas_ddot(&row.vector, &row.vector, &square);
    for (size_t c = 0; c < moves->size2; c++) {
      gsl_vector_view column = gsl_matrix_column(moves, c);
      double dot;
      gsl_blas_ddot(&row.vector, &column.vector, &dot);
      gsl_blas_daxpy(-dot / square, &row.vector, &column.vector);
    }
  }
  gsl_matrix_free(gauge);
}

/* Values and standard uncertainties of the map's points from their moves. */
static fg_status tell_map_points(fg_context *ctx, fg_grid_loop *loop, size_t count) {
  fg_grid_loop_result *result = &loop->result;
  const grid_columns *columns = &loop->solution.columns;
  size_t first = columns->effect, n = columns->board_map - first, index[GRID_ROW_MAX];
  fg_point value[GRID_ROW_MAX];
  gsl_matrix *moves = gsl_matrix_calloc(2 * count, n), *spread = gsl_matrix_calloc(2 * count, n);
  if (!moves || !spread) {
    gsl_matrix_free(moves);
    gsl_matrix_free(spread);
    return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %zu columns", n);
  }
  for (size_t p = 0; p < count; p++) {
    size_t own =
        fg_grid_displacement_columns(&loop->problem, columns, result->map[p].at_mm, index, value);
    for (size_t k = 0; k < own; k++) {
      gsl_matrix_set(moves, 2 * p, index[k] - first, value[k].x);
      gsl_matrix_set(moves, 2 * p + 1, index[k] - first, value[k].y);
    }
  }
  remove_gauges(result, count, moves);
  gsl_matrix_const_view own =
      gsl_matrix_const_submatrix(loop->solution.covariance, first, first, n, n);
  gsl_vector_const_view estimate = gsl_vector_const_subvector(loop->solution.estimate, first, n);
  gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1, moves, &own.matrix, 0, spread);
  double random = isfinite(result->carriage_um) ? result->carriage_um : 0;
  for (size_t k = 0; k < 2 * count; k++) {
    gsl_vector_const_view move = gsl_matrix_const_row(moves, k),
                          by = gsl_matrix_const_row(spread, k);
    double d, variance;
    gsl_blas_ddot(&move.vector, &estimate.vector, &d);
    gsl_blas_ddot(&move.vector, &by.vector, &variance);
    fg_grid_map_point *point = &result->map[k / 2];
    fg_point jump = fg_grid_jump_variance(loop, point->at_mm);
    variance = loop->widening * loop->widening * fmax(0, variance) + (k % 2 ? jump.y : jump.x);
    double u = hypot(1000 * sqrt(variance), k % 2 ? random : 0);
    *(k % 2 ? &point->d_um.y : &point->d_um.x) = 1000 * d;
    *(k % 2 ? &point->u_um.y : &point->u_um.x) = u;
  }
  gsl_matrix_free(moves);
  gsl_matrix_free(spread);
  return FG_OK;
}

static fg_status tell_map(fg_context *ctx, fg_grid_loop *loop) {
  fg_grid_loop_result *result = &loop->result;
  double size[2], u = 0;
  for (int axis = 0; axis < 2; axis++)
    size[axis] = result->high_mm[axis] - result->low_mm[axis];
  double longer = fmax(size[0], size[1]);
  result->map_columns = (size_t)fmax(2, ceil(MAP_SIDE_MAX * size[0] / longer));
  result->map_rows = (size_t)fmax(2, ceil(MAP_SIDE_MAX * size[1] / longer));
  size_t count = result->map_columns * result->map_rows;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *result->map, (void **)&result->map));
  for (size_t k = 0; k < count; k++) {
    double i = (double)(k % result->map_columns), j = (double)(k / result->map_columns);
    result->map[k].at_mm =
        (fg_point){result->low_mm[0] + size[0] * i / (double)(result->map_columns - 1),
                   result->low_mm[1] + size[1] * j / (double)(result->map_rows - 1)};
  }
  FG_TRY(tell_map_points(ctx, loop, count));
  for (size_t k = 0; k < count; k++)
    u += 0.5 * (pow(result->map[k].u_um.x, 2) + pow(result->map[k].u_um.y, 2));
  result->u_map_um = sqrt(u / (double)count);
  return FG_OK;
}

static double rms_of_map(const fg_grid_loop *loop, const fg_map_frame *frame, size_t first) {
  double square = 0, n = 0;
  const double *mm = gsl_vector_const_ptr(loop->solution.estimate, first);
  enum { SIDE = 30 };
  for (int j = 0; j <= SIDE; j++)
    for (int i = 0; i <= SIDE; i++, n += 2) {
      fg_point at = {frame->low_mm[0] + (frame->high_mm[0] - frame->low_mm[0]) * i / (double)SIDE,
                     frame->low_mm[1] + (frame->high_mm[1] - frame->low_mm[1]) * j / (double)SIDE};
      fg_point d = fg_map_at(frame, mm, at);
      square += d.x * d.x + d.y * d.y;
    }
  return 1000 * sqrt(square / n);
}

/* ---- scans ---- */

static fg_status tell_scans(fg_context *ctx, fg_grid_loop *loop) {
  fg_grid_loop_result *result = &loop->result;
  FG_TRY(fg_memory_allocate(ctx, loop->scan_count, sizeof *result->scan, (void **)&result->scan));
  for (size_t i = 0; i < loop->scan_count; i++) {
    const fg_measurement *m = &loop->measurements[i];
    fg_grid_scan *scan = &result->scan[i];
    scan->measurement = m;
    scan->turn_deg = 90 * loop->problem.turns[i];
    FG_TRY(fg_memory_allocate(ctx, m->grid->count, sizeof *scan->residual_mm,
                              (void **)&scan->residual_mm));
    result->marks += m->grid->count;
  }
  for (size_t i = 0; i < loop->problem.row_count; i++) {
    const grid_row *row = &loop->problem.rows[i];
    fg_point *to = &result->scan[row->scan].residual_mm[row->mark];
    /* Measured less corrected, as in a report of one scan. */
    to->x -= row->direction.x * loop->solution.residual[i];
    to->y -= row->direction.y * loop->solution.residual[i];
  }
  return FG_OK;
}

fg_status fg_grid_loop_fill_result(fg_context *ctx, fg_grid_loop *loop) {
  const grid_problem *problem = &loop->problem;
  fg_grid_loop_result *result = &loop->result;
  result->scans = loop->scan_count;
  result->boards = problem->board_count;
  result->turned = problem->model.turned;
  result->scale_known = problem->scale_known;
  result->axes_known = problem->scale_known || problem->model.turned;
  result->mark_um = 1000 * problem->model.mark_sd;
  result->board_mark_um = problem->model.board_sd > 0 ? 1000 * problem->model.board_sd : NAN;
  result->carriage_um = fg_grid_find_carriage(problem, &loop->solution);
  for (int axis = 0; axis < 2; axis++) {
    result->low_mm[axis] = problem->model.frame.low_mm[axis];
    result->high_mm[axis] = problem->model.frame.high_mm[axis];
  }
  FG_TRY(tell_scans(ctx, loop));
  tell_claims(loop);
  tell_likeness(loop);
  if (problem->model.has_map)
    result->map_um = rms_of_map(loop, &problem->model.map, loop->solution.columns.map);
  if (problem->model.has_board_map)
    result->board_map_um =
        rms_of_map(loop, &problem->model.board_map, loop->solution.columns.board_map);
  return tell_map(ctx, loop);
}

/* ---- words ---- */

/* Published scales of flatbeds are off by no more across an A4 sheet. */
#define USUAL_SCALE_MAX 0.006

/* Adds the found effects beside the axes, with U. */
static void say_effects(fg_grid_loop_result *r) {
  size_t said = 0;
  for (size_t i = 0; i < r->claims; i++) {
    const fg_grid_claim *claim = &r->claim[i];
    size_t used = strlen(r->sentence);
    if (claim->of_board || claim->ratio || claim->verdict != FG_GRID_FOUND) continue;
    fg_text_clip(r->sentence + used, sizeof r->sentence - used, "%s%s (%.3g ± %.2g µm)",
                 said++ ? ", " : " Found besides: ", claim->words, fabs(claim->value),
                 2 * claim->u);
  }
  size_t used = strlen(r->sentence);
  if (said) fg_text_clip(r->sentence + used, sizeof r->sentence - used, ".");
}

void fg_grid_loop_write_sentence(fg_grid_loop_result *r) {
  const fg_grid_claim *ratio = &r->claim[0];
  if (r->tied && ratio->verdict == FG_GRID_TIED)
    fg_text_clip(r->sentence, sizeof r->sentence,
                 "A length along x reads %.3f ± %.3f %% longer than along y: scanner or board, one "
                 "pose cannot tell.",
                 100 * ratio->value, 200 * ratio->u);
  else if (r->tied)
    fg_text_clip(r->sentence, sizeof r->sentence,
                 "The axes are not square: scanner or board, one pose cannot tell.");
  else if (r->turned)
    fg_text_clip(
        r->sentence, sizeof r->sentence,
        "The axes (x over y) differ by %.3f ± %.3f %% of the scanner, which stays with the "
        "glass, and by %.3f ± %.3f %% of the board, which turns with it.",
        100 * (r->axis_ratio - 1), 200 * r->u_axis_ratio, 100 * (r->board_ratio - 1),
        200 * r->u_board_ratio);
  else if (r->axes_known)
    fg_text_clip(r->sentence, sizeof r->sentence,
                 "Against the board as stated, the scanner's axes (x over y) differ by %.3f ± %.3f "
                 "%%.",
                 100 * (r->axis_ratio - 1), 200 * r->u_axis_ratio);
  else
    fg_text_clip(r->sentence, sizeof r->sentence,
                 "No difference of the axes shows; one pose would not tell scanner and board "
                 "apart.");
  say_effects(r);
  r->advice[0] = 0;
  if (!r->axes_known)
    fg_text_clip(r->advice, sizeof r->advice,
                 "Scan the board again, turned by a quarter, and give all scans with --same-part; "
                 "or state u_pitch_mm of a board that is known.");
  else if (!r->scale_known)
    fg_text_clip(r->advice, sizeof r->advice,
                 "The scale of both axes together stays unknown: state pitch_mm and u_pitch_mm of "
                 "a board that is known.");
  else if (fabs(r->scale) > USUAL_SCALE_MAX)
    fg_text_clip(r->advice, sizeof r->advice,
                 "A scale of %+.2f %% is more than a flatbed's, at most 0.6 %%: are the stated "
                 "pitch and dpi those of this board and scan?",
                 100 * r->scale);
  else if (r->wave_mm > 0)
    fg_text_clip(
        r->advice, sizeof r->advice,
        "On marks in line with the axes a ripple of %.3g mm looks like the one of %.3g mm: "
        "the board turned by %.0f° and scanned again, or one of a finer pitch, tells them apart.",
        r->short_wave_mm, r->wave_mm, ceil(r->telling_turn_deg));
}
