/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Grids: marks drawn with known places are found on their lattice, to a small share of a pixel. */
#include "foilgauge/grid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/lattice.h"
#include "measure/grids.h"
#include "support/random.h"
#include "support/test.h"

enum { SIDE = 900, SUPER = 4 };
#define NOISE 2.0
#define BLUR  1.2

/* A board in pixels: places are origin + step R (column, row). */
typedef struct drawn_board {
  fg_mark_kind kind;
  double x, y, step, turn, contrast; /* turn: rad */
  bool covered;                      /* an object lies on its middle */
} drawn_board;

static double share_of(double distance) {
  return 0.5 * erfc(-distance / BLUR * M_SQRT1_2);
}

/* Share of a mark at a pixel: board coordinates in steps. */
static double coverage(const drawn_board *board, double x, double y) {
  double c = cos(board->turn), s = sin(board->turn), dx = x - board->x, dy = y - board->y;
  double u = (dx * c + dy * s) / board->step, v = (dy * c - dx * s) / board->step;
  double du = (u - round(u)) * board->step, dv = (v - round(v)) * board->step;
  bool inside = round(u) >= 0 && round(v) >= 0 && round(u) < 7 && round(v) < 6;
  double stroke = 4, arm = 0.3 * board->step;
  switch (board->kind) {
  case FG_MARKS_DOTS:
    return inside ? share_of(0.25 * board->step - hypot(du, dv)) : 0;
  case FG_MARKS_CROSSES: {
    double a = (share_of(stroke - du) + share_of(stroke + du) - 1) * share_of(arm - fabs(dv));
    double b = (share_of(stroke - dv) + share_of(stroke + dv) - 1) * share_of(arm - fabs(du));
    return inside ? a + b - a * b : 0;
  }
  case FG_MARKS_LINES: {
    bool on = round(u) >= 0 && round(u) < 7 && v > 0 && v < 4;
    return on ? share_of(stroke - du) + share_of(stroke + du) - 1 : 0;
  }
  default: { /* products of signs, blurred by the nearest edges */
    double a = 2 * share_of(du) - 1, b = 2 * share_of(dv) - 1;
    double sign = ((long)round(u) + (long)round(v)) % 2 ? -1 : 1;
    return 0.5 * (1 + sign * a * b);
  }
  }
}

static void draw_board(const drawn_board *board, uint64_t seed, fg_tiles *tiles) {
  uint8_t *rows = malloc((size_t)SIDE * FG_TILE_PX);
  uint64_t random = seed;
  assert_ok(&test_context, fg_tiles_create(&test_context, SIDE, SIDE, 1, NULL, tiles));
  for (int y = 0; y < SIDE; y += FG_TILE_PX) {
    for (int j = 0; j < FG_TILE_PX && y + j < SIDE; j++)
      for (int x = 0; x < SIDE; x++) {
        double level = 120 + board->contrast * (coverage(board, x, y + j) - 0.5);
        if (board->covered && hypot(x - SIDE / 2, y + j - SIDE / 2) < 140) level = 130;
        level += NOISE * random_gaussian(&random);
        rows[j * SIDE + x] = (uint8_t)lround(fmax(0, fmin(255, level)));
      }
    assert_ok(&test_context, fg_tiles_add_strip(&test_context, tiles, rows, SIDE));
  }
  assert_ok(&test_context, fg_tiles_finish(&test_context, tiles));
  free(rows);
}

static void measure_board(const drawn_board *board, fg_measurement *m) {
  fg_tiles tiles = {0};
  memset(m, 0, sizeof *m);
  m->dpi[0] = m->dpi[1] = 25.4 * 100; /* 100 px per mm */
  m->file.width_px = m->file.height_px = SIDE;
  fg_design_default(&m->design);
  assert_int_equal(fg_design_become(NULL, FG_FOIL_GRID, &m->design), FG_OK);
  m->design.grid.marks = board->kind;
  draw_board(board, 5, &tiles);
  assert_ok(&test_context, fg_measure_grid(&test_context, &tiles, 2, m));
  fg_tiles_free(&tiles);
}

/* rms distance of the marks from the drawn ones, whatever the lattice's first mark, px. */
static double rms_error(const drawn_board *board, const fg_grid *grid) {
  double square = 0, c = cos(board->turn), s = sin(board->turn);
  for (size_t i = 0; i < grid->count; i++) {
    double x = grid->marks[i].at_mm.x * 100 - board->x, y = grid->marks[i].at_mm.y * 100 - board->y;
    double u = (x * c + y * s) / board->step, v = (y * c - x * s) / board->step;
    double du = (u - round(u)) * board->step, dv = (v - round(v)) * board->step;
    square += grid->kind == FG_MARKS_LINES ? 2 * du * du : du * du + dv * dv;
  }
  return sqrt(square / 2 / (double)grid->count);
}

static void marks_are_found_to_a_hundredth_of_a_pixel(void **state) {
  (void)state;
  static const drawn_board boards[] = {
      {FG_MARKS_DOTS, 120.3, 90.7, 100, 0.05, -150, false},
      {FG_MARKS_DOTS, 200.2, 60.1, 80, 0.4, 150, true},
      {FG_MARKS_CROSSES, 120.3, 90.7, 100, -0.03, -150, false},
      {FG_MARKS_CHESSBOARD, 40.3, 50.7, 110, 0.1, -150, true},
      {FG_MARKS_CHESSBOARD, 40.3, 50.7, 60, 0.6, 150, false},
      {FG_MARKS_LINES, 100.4, 80.2, 90, 0.02, -150, false},
  };
  for (size_t i = 0; i < sizeof boards / sizeof *boards; i++) {
    fg_measurement m;
    in_row("board %zu of %s", i, fg_mark_kind_word(boards[i].kind));
    measure_board(&boards[i], &m);
    double error = rms_error(&boards[i], m.grid);
    assert_true(m.grid->count >= 6);
    assert_true(error < 0.02);
    /* The stated u covers it. */
    assert_true(error < 1.6 * m.grid->mark_u_um / 10);
    if (isfinite(m.grid->axis_ratio.value))
      assert_true(fabs(m.grid->axis_ratio.value - 1) < 4 * m.grid->axis_ratio.u + 1e-6);
    double step =
        isfinite(m.grid->step_px[0].value) ? m.grid->step_px[0].value : m.grid->step_px[1].value;
    assert_true(fabs(step - boards[i].step) < 0.01);
    fg_measurement_free(&m);
  }
}

static void a_lattice_is_found_across_gaps_and_strangers(void **state) {
  (void)state;
  fg_lattice_place places[200];
  fg_lattice lattice;
  size_t count = 0;
  uint64_t random = 3;
  for (int j = 0; j < 10; j++)
    for (int i = 0; i < 12; i++) {
      if (hypot(i - 6, j - 5) < 2.5) continue;
      places[count++] = (fg_lattice_place){
          .at = {3 + 5 * i - 0.4 * j + 0.01 * random_gaussian(&random), 2 + 0.4 * i + 5 * j},
          .direction_rad = NAN};
    }
  size_t marks = count;
  for (int k = 0; k < 20; k++)
    places[count++] = (fg_lattice_place){
        .at = {60 * random_uniform(&random), 50 * random_uniform(&random)}, .direction_rad = NAN};
  assert_ok(&test_context, fg_lattice_find(&test_context, places, count, false, &lattice));
  assert_true(fabs(hypot(lattice.axis[0].x, lattice.axis[0].y) - hypot(5, 0.4)) < 0.05);
  size_t on = 0;
  for (size_t k = 0; k < marks; k++)
    on += places[k].on;
  assert_int_equal(on, marks);
}

static void a_blank_picture_has_no_grid(void **state) {
  (void)state;
  fg_tiles tiles = {0};
  fg_measurement m = {.dpi = {2540, 2540}};
  fg_context ctx = {0};
  fg_design_default(&m.design);
  assert_int_equal(fg_design_become(NULL, FG_FOIL_GRID, &m.design), FG_OK);
  for (int kind = 0; kind < FG_MARK_KINDS; kind++) {
    const drawn_board blank = {.kind = FG_MARKS_DOTS, .step = 1e9, .x = -1e9, .contrast = 0};
    m.design.grid.marks = (fg_mark_kind)kind;
    draw_board(&blank, 7, &tiles);
    assert_int_equal(fg_measure_grid(&ctx, &tiles, 1, &m), FG_ERR_DATA);
    assert_has(ctx.message, "no grid in the picture");
    fg_tiles_free(&tiles);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(marks_are_found_to_a_hundredth_of_a_pixel),
      cmocka_unit_test(a_lattice_is_found_across_gaps_and_strangers),
      cmocka_unit_test(a_blank_picture_has_no_grid),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
