/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plates and boards: marks on a square lattice, with the errors of their own printing. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "render/parse.h"
#include "render/random.h"

static const double quarter_turn = 1.57079632679489661923;
static const char *const mark_words[] = {"dots", "chessboard", "crosses", "lines"};
enum { MARK_WORDS = sizeof mark_words / sizeof *mark_words, MARKS_MAX = 250000 };

/* ---- the spec ---- */

static fg_status read_marks_word(const fg_place *place, const cJSON *item, fg_grid_marks *marks) {
  for (int k = 0; cJSON_IsString(item) && k < MARK_WORDS; k++)
    if (!strcmp(item->valuestring, mark_words[k])) {
      *marks = (fg_grid_marks)k;
      return FG_OK;
    }
  return fg_member_fail(place, "marks", item,
                        "must be \"dots\", \"chessboard\", \"crosses\" or \"lines\"");
}

static fg_status read_missing_marks(const fg_place *place, const cJSON *array,
                                    fg_grid_request *request) {
  const cJSON *item;
  if (array && !cJSON_IsArray(array))
    return fg_member_fail(place, "missing", array, "must be an array of [column, row]");
  cJSON_ArrayForEach(item, array) {
    double index[2];
    int count;
    if (request->missing_count == FG_GRID_MISSING_MAX)
      return fg_member_fail(place, "missing", NULL, "at most 64 marks can be missing");
    FG_TRY(
        fg_member_numbers(place, "missing", item, (fg_array_limits){0, 1e5, 2, 2}, index, &count));
    request->missing[request->missing_count][0] = (int)index[0];
    request->missing[request->missing_count++][1] = (int)index[1];
  }
  return FG_OK;
}

static fg_status read_grid(const fg_place *place, const cJSON *grid, fg_grid_request *request) {
  static const fg_spec_row table[] = {
      FG_SPEC_NUMBER(fg_grid_request, pitch_mm, 0.01, 1000),
      FG_SPEC_INTEGER(fg_grid_request, columns, 1, 10000),
      FG_SPEC_INTEGER(fg_grid_request, rows, 1, 10000),
      FG_SPEC_NUMBER(fg_grid_request, mark_mm, 0.001, 1000),
      FG_SPEC_NUMBER(fg_grid_request, length_mm, 0.001, 1000),
      FG_SPEC_NUMBER(fg_grid_request, rotate_deg, -3600, 3600),
      FG_SPEC_NUMBER(fg_grid_request, ratio, -0.1, 0.1),
      FG_SPEC_NUMBER(fg_grid_request, shear, -0.1, 0.1),
      FG_SPEC_NUMBER(fg_grid_request, scale, -0.1, 0.1),
      FG_SPEC_NUMBER(fg_grid_request, place_um, 0, 1000),
      FG_SPEC_OTHER("marks"),
      FG_SPEC_OTHER("centre_mm"),
      FG_SPEC_OTHER("missing"),
      FG_SPEC_END,
  };
  *request =
      (fg_grid_request){.pitch_mm = 5, .columns = 10, .rows = 10, .mark_mm = NAN, .length_mm = NAN};
  int count;
  FG_TRY(fg_members_read(place, grid, table, request));
  FG_TRY(read_marks_word(place, fg_spec_member(grid, "marks"), &request->marks));
  FG_TRY(fg_member_numbers(place, "centre_mm", fg_spec_member(grid, "centre_mm"),
                           (fg_array_limits){-1e4, 1e4, 2, 2}, request->centre_mm, &count));
  FG_TRY(read_missing_marks(place, fg_spec_member(grid, "missing"), request));
  if (request->marks == FG_GRID_LINES) request->rows = 1;
  if (isnan(request->mark_mm))
    request->mark_mm = (request->marks == FG_GRID_DOTS ? 0.5 : 0.08) * request->pitch_mm;
  if (isnan(request->length_mm))
    request->length_mm = (request->marks == FG_GRID_LINES ? 4 : 0.6) * request->pitch_mm;
  if ((size_t)request->columns * (size_t)request->rows > MARKS_MAX)
    return fg_member_fail(place, "rows", NULL, "a grid has at most 250000 marks");
  return FG_OK;
}

fg_status fg_spec_read_grids(const fg_place *place, const cJSON *array, fg_render_spec *spec) {
  if (!array) return FG_OK;
  if (!cJSON_IsArray(array)) return fg_member_fail(place, "grids", array, "must be an array");
  FG_TRY(fg_memory_allocate(place->ctx, (size_t)cJSON_GetArraySize(array),
                            sizeof *spec->grid_requests, (void **)&spec->grid_requests));
  const cJSON *item;
  cJSON_ArrayForEach(item, array) {
    fg_place inner = fg_place_item(place, "grids", (int)spec->grid_request_count);
    FG_TRY(read_grid(&inner, item, &spec->grid_requests[spec->grid_request_count]));
    spec->grid_request_count++;
  }
  return FG_OK;
}

/* ---- the scene ---- */

/* A chessboard's squares lie around its corners: one more each way. */
static size_t count_shapes(const fg_grid_request *request) {
  size_t columns = (size_t)request->columns, rows = (size_t)request->rows;
  if (request->marks == FG_GRID_CHESSBOARD) return (columns + 1) * (rows + 1);
  return columns * rows * (request->marks == FG_GRID_CROSSES ? 2 : 1);
}

size_t fg_grids_shapes(const fg_render_spec *spec) {
  size_t count = 0;
  for (size_t i = 0; i < spec->grid_request_count; i++)
    count += count_shapes(&spec->grid_requests[i]);
  return count;
}

size_t fg_grids_marks(const fg_render_spec *spec) {
  size_t count = 0;
  for (size_t i = 0; i < spec->grid_request_count; i++)
    count += (size_t)spec->grid_requests[i].columns * (size_t)spec->grid_requests[i].rows;
  return count;
}

/* The board as it is: a linear map of lattice steps. */
typedef struct drawn_grid {
  fg_point origin, step[2]; /* along columns, along rows; mm */
} drawn_grid;

static fg_point turned_step(const fg_grid_request *request, double x, double y) {
  double c = cos(request->rotate_deg * quarter_turn / 90),
         s = sin(request->rotate_deg * quarter_turn / 90);
  double px = (1 + request->scale + 0.5 * request->ratio) * x + 0.5 * request->shear * y;
  double py = (1 + request->scale - 0.5 * request->ratio) * y + 0.5 * request->shear * x;
  return (fg_point){px * c - py * s, px * s + py * c};
}

static drawn_grid draw_lattice(const fg_grid_request *request) {
  drawn_grid grid = {.step = {turned_step(request, request->pitch_mm, 0),
                              turned_step(request, 0, request->pitch_mm)}};
  double c = 0.5 * (request->columns - 1), r = 0.5 * (request->rows - 1);
  grid.origin = (fg_point){request->centre_mm[0] - c * grid.step[0].x - r * grid.step[1].x,
                           request->centre_mm[1] - c * grid.step[0].y - r * grid.step[1].y};
  return grid;
}

static fg_point lattice_place(const drawn_grid *grid, double column, double row) {
  return (fg_point){grid->origin.x + column * grid->step[0].x + row * grid->step[1].x,
                    grid->origin.y + column * grid->step[0].y + row * grid->step[1].y};
}

static bool is_missing_mark(const fg_grid_request *request, int column, int row) {
  for (size_t i = 0; i < request->missing_count; i++)
    if (request->missing[i][0] == column && request->missing[i][1] == row) return true;
  return false;
}

/* A stroke of the mark's width along a direction. */
static fg_shape stroke_shape(const fg_grid_request *request, fg_point at, fg_point along) {
  double scale = 0.5 * request->length_mm / hypot(along.x, along.y);
  return (fg_shape){.x0 = at.x - scale * along.x,
                    .y0 = at.y - scale * along.y,
                    .x1 = at.x + scale * along.x,
                    .y1 = at.y + scale * along.y,
                    .radius = 0.5 * request->mark_mm,
                    .value = 1};
}

static void add_mark(const fg_grid_request *request, const drawn_grid *grid, fg_point at,
                     fg_scene *scene) {
  fg_shape *shapes = scene->shapes + scene->shape_count;
  if (request->marks == FG_GRID_DOTS) {
    *shapes = (fg_shape){.x0 = at.x,
                         .y0 = at.y,
                         .x1 = at.x,
                         .y1 = at.y,
                         .radius = 0.5 * request->mark_mm,
                         .value = 1};
    scene->shape_count++;
    return;
  }
  shapes[0] = stroke_shape(request, at, grid->step[1]);
  scene->shape_count++;
  if (request->marks == FG_GRID_LINES) return;
  shapes[1] = stroke_shape(request, at, grid->step[0]);
  scene->shape_count++;
}

/* Every second square; two sides run along the columns, two along the rows. */
static void add_squares(const fg_grid_request *request, const drawn_grid *grid, fg_scene *scene) {
  double area = grid->step[0].x * grid->step[1].y - grid->step[0].y * grid->step[1].x;
  for (int j = 0; j <= request->rows; j++)
    for (int i = 0; i <= request->columns; i++) {
      if ((i + j) % 2) continue;
      fg_point at = lattice_place(grid, i - 0.5, j - 0.5);
      fg_shape *square = &scene->shapes[scene->shape_count++];
      *square =
          (fg_shape){.x0 = at.x, .y0 = at.y, .x1 = at.x, .y1 = at.y, .value = 1, .adds = true};
      for (int k = 0; k < 2; k++) {
        const fg_point *side = &grid->step[1 - k]; /* along the sides across axis k */
        double length = hypot(side->x, side->y);
        square->normal[k] = (fg_point){side->y / length, -side->x / length};
        square->half_mm[k] = 0.5 * area / length;
      }
      square->radius = 1.1 * hypot(square->half_mm[0], square->half_mm[1]);
    }
}

static void build_grid(fg_render_spec *spec, size_t index, double reach[2][2]) {
  const fg_grid_request *request = &spec->grid_requests[index];
  drawn_grid grid = draw_lattice(request);
  fg_scene *scene = &spec->scene;
  fg_random random;
  fg_random_seed(&random, spec->seed, FG_STREAM_PLACE, 1000 + index);
  bool squares = request->marks == FG_GRID_CHESSBOARD;
  if (squares) add_squares(request, &grid, scene);
  for (int j = 0; j < request->rows; j++)
    for (int i = 0; i < request->columns; i++) {
      fg_point at = lattice_place(&grid, i, j);
      double off[2] = {fg_random_normal(&random), fg_random_normal(&random)};
      if (!squares) {
        at.x += 1e-3 * request->place_um * off[0];
        at.y += 1e-3 * request->place_um * off[1];
      }
      double around =
          squares ? request->pitch_mm : 0.5 * fmax(request->mark_mm, request->length_mm);
      for (int axis = 0; axis < 2; axis++) {
        double along = axis ? at.y : at.x;
        reach[0][axis] = fmin(reach[0][axis], along - around);
        reach[1][axis] = fmax(reach[1][axis], along + around);
      }
      if (!squares && is_missing_mark(request, i, j)) continue;
      if (!squares) add_mark(request, &grid, at, scene);
      scene->marks[scene->mark_count++] =
          (fg_render_mark){.grid = index + 1,
                           .column = i,
                           .row = j,
                           .centre_px = {at.x / spec->pixel_mm[0], at.y / spec->pixel_mm[1]}};
    }
}

fg_status fg_grids_build(const fg_place *place, fg_render_spec *spec, double reach[2][2]) {
  FG_TRY(fg_memory_allocate(place->ctx, fg_grids_marks(spec), sizeof *spec->scene.marks,
                            (void **)&spec->scene.marks));
  for (size_t i = 0; i < spec->grid_request_count; i++)
    build_grid(spec, i, reach);
  return FG_OK;
}
