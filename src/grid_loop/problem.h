/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The linear mixed model of a loop on grids.
 *
 * True place of a mark: m + d(m), m as measured. The board says: T(p + A p + b(p)), T the scan's
 * pose, A = [g + h, k; k, g - h] the board's scale, ratio and shear, b its own smooth deviation.
 * A row is one component, along a direction e that is fixed to the board, so that scans of one mark
 * share it:
 *   e (T0 p - m) = e d(m) - e shift - turn e J (T0 p - origin) - e R (A p + b(p)) + noise. */
#ifndef FG_GRID_LOOP_PROBLEM_H
#define FG_GRID_LOOP_PROBLEM_H

#include "effect/effect.h"
#include "field/map.h"
#include "foilgauge/grid_loop.h"
#include "grid_loop/certificate.h"

enum { GRID_EFFECTS_MAX = FG_FIELDS_MAX, GRID_POSE = 3, GRID_AFFINE = 3, GRID_ROW_MAX = 128 };

/* A sighting of a mark of a board in a scan, one component. */
typedef struct grid_row {
  size_t scan, board, mark; /* mark: index into the scan's marks */
  size_t group;             /* rows of one mark's component share it, and stand together */
  fg_point at, place;       /* measured, mm of the scan; on the board, mm */
  fg_point direction;       /* e in the scan */
  double reach_mm;          /* of the mark's edges; 0: not known */
  bool corner;              /* of a chessboard */
  double value;             /* e (T0 p - m), mm */
  fg_point arm;             /* T0 p - origin */
  bool used, held_out;
} grid_row;

typedef struct grid_pose {
  fg_point origin;
  double turn_rad;
} grid_pose;

enum { GRID_EFFECT_COLUMNS = 2, GRID_EFFECT_ALL = GRID_EFFECT_COLUMNS + FG_FIELD_SHAPES };

/* An effect of the scanner in the model. Where its shape is `loose`, the displacement by a change
 * of each shape, at `amplitude_mm`, is a column, too: the shape's uncertainty then is in all u. */
typedef struct grid_effect {
  const fg_effect *kind;
  double shape[FG_FIELD_SHAPES];
  double amplitude_mm[GRID_EFFECT_COLUMNS];
  bool loose;
} grid_effect;

/* Number of an effect's columns: the amplitudes, then the shapes that are loose. */
size_t fg_grid_effect_columns(const grid_effect *effect);
/* Displacement by every column of an effect for a unit of it; returns their number. */
size_t fg_grid_effect_moves(const grid_effect *effect, const fg_field_frame *frame, fg_point at,
                            fg_point d[FG_FIELD_COLUMNS]);

/* Mean displacement by every column over the edges of a row's mark, along the row's direction. */
size_t fg_grid_effect_of_row(const grid_effect *effect, const fg_field_frame *frame,
                             const grid_row *row, double value[FG_FIELD_COLUMNS]);

/* Coordinate of the effect's jump that is nearest to a place. */
double fg_grid_nearest_jump(const grid_effect *effect, double along);

typedef struct grid_board {
  double pitch_mm; /* of the first fit, or as stated */
  double u_scale;  /* prior sd of scale, ratio and shear each */
} grid_board;

/* Model of scanner and boards, common to all scans. */
typedef struct grid_model {
  fg_field_frame frame;
  bool turned;
  grid_effect effect[GRID_EFFECTS_MAX];
  size_t effects;
  bool has_map, has_board_map;
  fg_map_frame map, board_map;
  /* sizes: of a mark in a scan, of a board's mark, mm; prior of the maps' bends */
  double mark_sd, board_sd, map_size, board_map_size;
} grid_model;

typedef struct grid_problem {
  const fg_design_grid *design;
  fg_grid_certificate certificate; /* owned; no columns: none */
  grid_row *rows;                  /* owned; by group */
  size_t row_count, group_count;
  size_t scan_count, board_count;
  grid_pose pose[FG_GRID_SCANS];
  size_t board_of[FG_GRID_SCANS];
  int turns[FG_GRID_SCANS], offset[FG_GRID_SCANS][2]; /* from lattice indices to the board's */
  grid_board board[FG_GRID_SCANS];
  bool scale_known;
  double alike_per_mm; /* the marks show waves as one whose frequencies have this sum; 0: none */
  double min_wave_mm;  /* the marks tell no shorter wave from longer ones */
  double alike_from_per_mm, alike_to_per_mm; /* waves that look like a map's; 0: none */
  grid_model model;
} grid_problem;

/* Columns of the model, in this order: poses, boards, effects, map, board's map. */
typedef struct grid_columns {
  size_t pose, board, effect, map, board_map, count;
} grid_columns;

grid_columns fg_grid_columns(const grid_problem *problem);

/* Fills a row's columns that are not 0; returns their number. */
size_t fg_grid_row_columns(const grid_problem *problem, const grid_columns *columns,
                           const grid_row *row, size_t *index, double *value);

/* Rows of measured grids; the start of all poses. */
fg_status fg_grid_problem_build(fg_context *ctx, const fg_measurement *measurements, size_t count,
                                const fg_grid_loop_options *options, grid_problem *problem);
void fg_grid_problem_free(grid_problem *problem);

/* Lays the splines of the maps over the marks; no map where there are too few. */
void fg_grid_lay_maps(grid_problem *problem, double marks_per_spline);

/* Finds how every scan's lattice lies on the first one's board. */
fg_status fg_grid_match_scans(fg_context *ctx, const fg_measurement *measurements, size_t count,
                              const fg_grid_loop_options *options, grid_problem *problem);

/* Index of a mark on its board. */
void fg_grid_board_index(const grid_problem *problem, size_t scan, const fg_mark *mark,
                         int index[2]);

#endif
