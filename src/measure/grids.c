/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/grids.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "core/select.h"
#include "core/text.h"
#include "geometry/lattice.h"
#include "measure/loss.h"
#include "vision/mark_find.h"

/* Cells of the reduced picture that marks are sought in. A step of fewer cells than STEP_CELLS is
 * sought in a finer one. */
#define CELLS_MAX  ((int64_t)12 << 20)
#define STEP_CELLS 14.0
enum { CELL_MIN_PX = 2, PICTURE_MAX = 300000, PER_STEP_MAX = 64 };
/* A mark has this share of the median contrast at least, and shows this share of its pixels. */
#define CONTRAST_SHARE 0.35
#define SEEN_SHARE     0.5
/* Window of a chessboard's corner: share of the step, and px. */
#define CORNER_SHARE  0.4
#define CORNER_MAX_PX 48.0

typedef struct grid_work {
  const fg_tiles *tiles;
  fg_mark_kind kind;
  double mm[2]; /* per pixel */
  fg_reduced picture;
  fg_mark_starts starts;
  bool *found; /* owned; one per start */
  fg_lattice_place *places;
  size_t *start_of; /* owned; of every place */
  size_t place_count;
  fg_lattice lattice;
} grid_work;

static void clear_marks(grid_work *work) {
  free(work->starts.list);
  free(work->found);
  free(work->places);
  free(work->start_of);
  work->starts = (fg_mark_starts){0};
  work->found = NULL;
  work->places = NULL;
  work->start_of = NULL;
  work->place_count = 0;
}

static void free_grid_work(grid_work *work) {
  clear_marks(work);
  free(work->picture.cells);
}

static fg_status fit_mark(fg_context *ctx, void *shared, size_t i) {
  grid_work *work = shared;
  return fg_mark_fit_run(ctx, work->tiles, work->kind, &work->starts.list[i], &work->found[i]);
}

static fg_status find_starts(fg_context *ctx, grid_work *work) {
  if (work->kind == FG_MARKS_CHESSBOARD)
    return fg_mark_find_corners(ctx, &work->picture, &work->starts);
  return fg_mark_find_objects(ctx, &work->picture, work->kind, &work->starts);
}

/* Drops marks of far less contrast than most have. */
static fg_status drop_faint(fg_context *ctx, grid_work *work) {
  size_t count = work->starts.count, n = 0;
  double *contrasts;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *contrasts, (void **)&contrasts));
  for (size_t i = 0; i < count; i++)
    if (work->found[i]) contrasts[n++] = fabs(work->starts.list[i].p[FG_MARK_CONTRAST]);
  double limit = n ? CONTRAST_SHARE * fg_select(contrasts, n, n / 2) : 0;
  free(contrasts);
  for (size_t i = 0; i < count; i++) {
    const fg_mark_fit *fit = &work->starts.list[i];
    if (fabs(fit->p[FG_MARK_CONTRAST]) < limit || fit->share < SEEN_SHARE) work->found[i] = false;
  }
  return FG_OK;
}

static double direction_of(const grid_work *work, const fg_mark_fit *fit) {
  if (work->kind == FG_MARKS_DOTS || work->kind == FG_MARKS_LINES) return NAN;
  /* The two directions differ by a quarter turn: the mean of both, modulo that. */
  double turned = fit->p[FG_MARK_SHAPE + 1] - M_PI / 2;
  double angle = fit->p[FG_MARK_SHAPE] + 0.5 * remainder(turned - fit->p[FG_MARK_SHAPE], M_PI / 2);
  return atan2(sin(angle) * work->mm[1], cos(angle) * work->mm[0]);
}

static fg_status list_places(fg_context *ctx, grid_work *work) {
  size_t count = work->starts.count;
  free(work->places);
  free(work->start_of);
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *work->places, (void **)&work->places));
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *work->start_of, (void **)&work->start_of));
  work->place_count = 0;
  for (size_t i = 0; i < count; i++) {
    const fg_mark_fit *fit = &work->starts.list[i];
    if (!work->found[i]) continue;
    work->places[work->place_count] =
        (fg_lattice_place){.at = {fit->p[FG_MARK_X] * work->mm[0], fit->p[FG_MARK_Y] * work->mm[1]},
                           .direction_rad = direction_of(work, fit)};
    work->start_of[work->place_count++] = i;
  }
  return FG_OK;
}

/* Lines tell their place across them alone: all go onto one line along their mean normal. */
static void project_lines(grid_work *work) {
  double cosine = 0, sine = 0, x = 0, y = 0, n = (double)work->place_count;
  for (size_t i = 0; i < work->place_count; i++) {
    double angle = 2 * work->starts.list[work->start_of[i]].p[FG_MARK_SHAPE];
    cosine += cos(angle);
    sine += sin(angle);
    x += work->places[i].at.x / n;
    y += work->places[i].at.y / n;
  }
  double angle = 0.5 * atan2(sine, cosine), nx = cos(angle), ny = sin(angle);
  for (size_t i = 0; i < work->place_count; i++) {
    fg_point *at = &work->places[i].at;
    double across = (at->x - x) * nx + (at->y - y) * ny;
    *at = (fg_point){x + across * nx, y + across * ny};
  }
}

static fg_status fit_marks(fg_context *ctx, unsigned threads, grid_work *work) {
  free(work->found);
  FG_TRY(fg_memory_allocate(ctx, work->starts.count, sizeof *work->found, (void **)&work->found));
  FG_TRY(fg_parallel_run(ctx, threads, work->starts.count, fit_mark, work));
  FG_TRY(drop_faint(ctx, work));
  FG_TRY(list_places(ctx, work));
  if (work->kind == FG_MARKS_LINES) project_lines(work);
  return FG_OK;
}

static double step_px(const grid_work *work) {
  const fg_point *a = &work->lattice.axis[0];
  return hypot(a->x / work->mm[0], a->y / work->mm[1]);
}

/* Fits corners again in a window as large as their squares allow. */
static fg_status widen_corners(fg_context *ctx, unsigned threads, grid_work *work) {
  double reach = fmin(CORNER_SHARE * step_px(work), CORNER_MAX_PX);
  fg_mark_starts kept = {0};
  fg_status status = FG_OK;
  for (size_t i = 0; i < work->place_count; i++) {
    if (!work->places[i].on) continue;
    FG_TRY_EXIT(fg_memory_reserve(ctx, kept.count + 1, sizeof *kept.list, &kept.capacity,
                                  (void **)&kept.list));
    kept.list[kept.count] = work->starts.list[work->start_of[i]];
    kept.list[kept.count++].reach_px = fmax(reach, 4 * CELL_MIN_PX);
  }
  free(work->starts.list);
  work->starts = kept;
  FG_TRY(fit_marks(ctx, threads, work));
  return fg_lattice_find(ctx, work->places, work->place_count, false, &work->lattice);
exit:
  free(kept.list);
  return status;
}

/* Marks in one reduction of the picture. */
static fg_status find_marks(fg_context *ctx, int64_t cells_max, unsigned threads, grid_work *work) {
  clear_marks(work);
  free(work->picture.cells);
  work->picture.cells = NULL;
  FG_TRY(fg_reduce(ctx, work->tiles, cells_max, &work->picture));
  FG_TRY(find_starts(ctx, work));
  FG_TRY(fit_marks(ctx, threads, work));
  FG_TRY(fg_lattice_find(ctx, work->places, work->place_count, work->kind == FG_MARKS_LINES,
                         &work->lattice));
  if (work->kind == FG_MARKS_CHESSBOARD) FG_TRY(widen_corners(ctx, threads, work));
  return FG_OK;
}

static fg_status find_marks_finer(fg_context *ctx, unsigned threads, grid_work *work) {
  for (int64_t cells = CELLS_MAX;; cells *= 4) {
    fg_status status = find_marks(ctx, cells, threads, work);
    bool finest = work->picture.cell_px <= CELL_MIN_PX;
    if (status != FG_OK && (status != FG_ERR_DATA || finest)) return status;
    if (finest || (status == FG_OK && step_px(work) >= STEP_CELLS * work->picture.cell_px))
      return FG_OK;
  }
}

/* The dark pair of opposite sectors, against the lattice's axes. */
static int polarity_of(const grid_work *work, const fg_mark_fit *fit) {
  if (work->kind != FG_MARKS_CHESSBOARD) return 0;
  const fg_point *a = &work->lattice.axis[0];
  double first = fit->p[FG_MARK_SHAPE], second = fit->p[FG_MARK_SHAPE + 1];
  /* Between the two normals both distances are positive. */
  double middle = first + 0.5 * remainder(second - first, 2 * M_PI);
  int sign = sin(2 * (middle - atan2(a->y, a->x))) > 0 ? 1 : -1;
  return fit->p[FG_MARK_CONTRAST] < 0 ? sign : -sign;
}

/* Length over which the edges of a mark tell its place, px. */
static double reach_of(const grid_work *work, const fg_mark_fit *fit) {
  if (work->kind == FG_MARKS_DOTS) return fit->p[FG_MARK_SHAPE];
  return work->kind == FG_MARKS_CHESSBOARD ? fit->reach_px : 0;
}

static int compare_marks(const void *a, const void *b) {
  const fg_mark *x = a, *y = b;
  if (x->row != y->row) return x->row - y->row;
  return x->column - y->column;
}

static fg_status hand_out_marks(fg_context *ctx, const grid_work *work, const fg_measurement *m,
                                fg_grid *grid) {
  double mm = sqrt(work->mm[0] * work->mm[1]);
  FG_TRY(fg_memory_allocate(ctx, work->place_count, sizeof *grid->marks, (void **)&grid->marks));
  for (size_t i = 0; i < work->place_count; i++) {
    const fg_lattice_place *place = &work->places[i];
    const fg_mark_fit *fit = &work->starts.list[work->start_of[i]];
    if (!place->on) continue;
    double contrast = fit->p[FG_MARK_CONTRAST], blur = fit->p[FG_MARK_BLUR];
    double loss = fg_loss_edge_px(m->file.jpeg_quality, contrast, blur);
    grid->marks[grid->count++] = (fg_mark){.column = place->column,
                                           .row = place->row,
                                           .at_mm = place->at,
                                           .u_mm = hypot(fit->u_px, loss) * mm,
                                           .blur_um = 1000 * blur * mm,
                                           .contrast = contrast,
                                           .reach_mm = reach_of(work, fit) * mm,
                                           .polarity = polarity_of(work, fit)};
  }
  fg_sort_items(grid->marks, grid->count, sizeof *grid->marks, compare_marks);
  return FG_OK;
}

/* Corners of one polarity lie two squares apart. */
static int squares_per_step(const fg_grid *grid) {
  int polarities[2] = {0, 0};
  if (grid->kind != FG_MARKS_CHESSBOARD) return 0;
  for (size_t i = 0; i < grid->count; i++)
    polarities[grid->marks[i].polarity > 0]++;
  return polarities[0] && polarities[1] ? 1 : 2;
}

/* ---- the board in its own frame ---- */

static unsigned char level_at(const grid_work *work, const fg_grid *grid, double column,
                              double row) {
  double x = grid->origin_mm.x + column * grid->axis_mm[0][0] + row * grid->axis_mm[1][0];
  double y = grid->origin_mm.y + column * grid->axis_mm[0][1] + row * grid->axis_mm[1][1];
  const fg_reduced *r = &work->picture;
  double cx = (x / work->mm[0] + 0.5) / r->cell_px, cy = (y / work->mm[1] + 0.5) / r->cell_px;
  if (!(cx >= 0 && cy >= 0 && cx < r->width && cy < r->height)) return 0;
  unsigned char level = r->cells[(size_t)cy * (size_t)r->width + (size_t)cx];
  return level ? level : 1;
}

static fg_status draw_board(fg_context *ctx, const grid_work *work, fg_grid *grid) {
  double places = (grid->columns + 1.0) * (grid->rows + 1.0);
  int per_step = (int)sqrt(PICTURE_MAX / places);
  if (grid->kind == FG_MARKS_LINES || per_step < 2) return FG_OK;
  grid->per_step = per_step > PER_STEP_MAX ? PER_STEP_MAX : per_step;
  size_t width = (size_t)((grid->columns + 1) * grid->per_step);
  size_t height = (size_t)((grid->rows + 1) * grid->per_step);
  FG_TRY(fg_memory_allocate(ctx, width, height, (void **)&grid->picture));
  for (size_t j = 0; j < height; j++)
    for (size_t i = 0; i < width; i++)
      grid->picture[j * width + i] = level_at(work, grid, ((double)i + 0.5) / grid->per_step - 1,
                                              ((double)j + 0.5) / grid->per_step - 1);
  return FG_OK;
}

static const char *const sought[FG_MARK_KINDS] = {
    [FG_MARKS_DOTS] = "round dots",
    [FG_MARKS_CHESSBOARD] = "corners of a chessboard",
    [FG_MARKS_CROSSES] = "crosses",
    [FG_MARKS_LINES] = "parallel lines",
};

static fg_status fail_without_grid(fg_context *ctx, const fg_measurement *m, const char *why) {
  char reason[300];
  fg_text_clip(reason, sizeof reason, "%s", why);
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: no grid in the picture: %s (%s were sought: is `marks` of the design right?)",
                 m->scan, reason, sought[m->design.grid.marks]);
}

fg_status fg_measure_grid(fg_context *ctx, const fg_tiles *tiles, unsigned threads,
                          fg_measurement *m) {
  grid_work work = {
      .tiles = tiles, .kind = m->design.grid.marks, .mm = {25.4 / m->dpi[0], 25.4 / m->dpi[1]}};
  fg_status status = find_marks_finer(ctx, threads, &work);
  if (status == FG_ERR_DATA) status = fail_without_grid(ctx, m, ctx->message);
  if (status != FG_OK) goto exit;
  FG_TRY_EXIT(fg_memory_allocate(ctx, 1, sizeof *m->grid, (void **)&m->grid));
  m->grid->kind = work.kind;
  FG_TRY_EXIT(hand_out_marks(ctx, &work, m, m->grid));
  if (!fg_grid_fit(m->grid, m->dpi)) {
    status = fail_without_grid(ctx, m, "all marks lie on one line");
    goto exit;
  }
  m->grid->squares_per_step = squares_per_step(m->grid);
  m->light_on_dark = m->grid->marks[0].contrast > 0;
  m->specks = work.starts.count - m->grid->count;
  FG_TRY_EXIT(draw_board(ctx, &work, m->grid));
exit:
  free_grid_work(&work);
  return status;
}
