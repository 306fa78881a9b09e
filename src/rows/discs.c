/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of round holes and discs: each part is one circle.
 *
 * The scanner acts on all discs alike, which separates it from the discs. A disc's own form error
 * (an oval pin, the wall of a hole that shows at one side) does not repeat, so part effects are not
 * sought on a plate; on a single ring ovality is collinear with a scale and a shear. The roughness
 * of edges differs by factors of ten and more between features of one picture, so every disc's rows
 * have their own noise. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/spread.h"
#include "rows/edge_fit.h"

/* Number of rows that suffices for any search; the blocks grow with the edges. */
enum { ROWS_MAX = 2000, BLOCK_MIN = 2, ROWS_MIN = 32, NEIGHBOUR_LAG = 3 };
/* A known diameter is a disc's when it is so near. */
#define DIAMETER_SHARE 0.03
/* No edge is taken for better than this. */
#define NOISE_MIN_UM 0.02

/* ---- known diameters ---- */

typedef struct sized {
  double diameter_mm;
  size_t index;
} sized;

static int compare_sized(const void *a, const void *b) {
  const sized *p = a, *q = b;
  if (p->diameter_mm != q->diameter_mm)
    return (p->diameter_mm > q->diameter_mm) - (p->diameter_mm < q->diameter_mm);
  return (p->index > q->index) - (p->index < q->index);
}

static void know_radius(fg_edge_fit *edge_fit, size_t view, double diameter_mm) {
  fg_edge_fit_part *part = &edge_fit->parts[edge_fit->views[view].part];
  if (fabs(diameter_mm / (2 * part->overall_radius_mm) - 1) > DIAMETER_SHARE) return;
  part->overall_radius_mm = part->known_radius_mm = 0.5 * diameter_mm;
  part->radius_known = true;
  edge_fit->known_count++;
}

void fg_edge_fit_hold_radii(fg_edge_fit *edge_fit, bool hold) {
  for (size_t p = 0; p < edge_fit->part_count; p++) {
    fg_edge_fit_part *part = &edge_fit->parts[p];
    part->radius_known = hold && part->known_radius_mm > 0;
    if (part->radius_known) part->overall_radius_mm = part->known_radius_mm;
  }
}

/* Assigns known diameters to discs, each used once. Equal numbers are assigned by rank, which is
 * independent of the scale; else the nearest pairs go first. */
static void match_known_diameters(fg_edge_fit *edge_fit, const sized *discs, size_t count,
                                  const sized *known, size_t known_count, bool *taken) {
  for (size_t i = 0; i < count && count == known_count; i++)
    know_radius(edge_fit, discs[i].index, known[i].diameter_mm);
  if (count == known_count) return;
  for (size_t round = 0; round < (count < known_count ? count : known_count); round++) {
    size_t best_disc = count, best_known = known_count;
    double best = INFINITY;
    for (size_t i = 0; i < count; i++)
      for (size_t k = 0; k < known_count && !taken[i]; k++) {
        double off = fabs(log(discs[i].diameter_mm / known[k].diameter_mm));
        if (taken[count + k] || off >= best) continue;
        best = off;
        best_disc = i;
        best_known = k;
      }
    taken[best_disc] = taken[count + best_known] = true;
    know_radius(edge_fit, discs[best_disc].index, known[best_known].diameter_mm);
  }
}

/* Known diameters of the views [first, last), which are of one scan. */
static fg_status match_scan(fg_context *ctx, fg_edge_fit *edge_fit, size_t first, size_t last) {
  const fg_design *design = &edge_fit->views[first].measurement->design;
  size_t count = last - first, known_count = design->discs.count;
  sized *discs = NULL;
  bool *taken = NULL;
  fg_status status = FG_OK;
  if (!known_count) return FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count + known_count, sizeof *discs, (void **)&discs));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count + known_count, sizeof *taken, (void **)&taken));
  for (size_t i = 0; i < count; i++)
    discs[i] = (sized){edge_fit->views[first + i].disc->diameter_mm, first + i};
  for (size_t k = 0; k < known_count; k++)
    discs[count + k] = (sized){design->discs.diameters_mm[k], k};
  fg_sort_items(discs, count, sizeof *discs, compare_sized);
  fg_sort_items(discs + count, known_count, sizeof *discs, compare_sized);
  match_known_diameters(edge_fit, discs, count, discs + count, known_count, taken);
exit:
  free(discs);
  free(taken);
  return status;
}

static fg_status match_diameters(fg_context *ctx, fg_edge_fit *edge_fit) {
  for (size_t first = 0; first < edge_fit->view_count;) {
    size_t last = first;
    while (last < edge_fit->view_count && edge_fit->views[last].scan == edge_fit->views[first].scan)
      last++;
    FG_TRY(match_scan(ctx, edge_fit, first, last));
    first = last;
  }
  return FG_OK;
}

/* ---- rows ---- */

/* Averages a block's usable stations in polar coordinates: a mean of points lies inside the circle
 * by the sagitta. */
static bool average_block(const fg_disc *disc, size_t from, size_t to, fg_edge_fit_row *row) {
  double n = 0, radius = 0, turn = 0, first = 0;
  for (size_t k = from; k < to && k < disc->station_count; k++) {
    const fg_disc_point *p = &disc->stations[k];
    if (!p->used) continue;
    double dx = p->at.x - disc->centre_mm.x, dy = p->at.y - disc->centre_mm.y;
    double angle = atan2(dy, dx);
    if (n == 0) first = angle;
    turn += remainder(angle - first, 2 * M_PI);
    radius += hypot(dx, dy);
    n++;
  }
  if (n < FG_EDGE_FIT_BLOCK_SHARE * (double)(to - from)) return false;
  double angle = first + turn / n;
  *row = (fg_edge_fit_row){.weight = n};
  row->at = (fg_point){disc->centre_mm.x + radius / n * cos(angle),
                       disc->centre_mm.y + radius / n * sin(angle)};
  row->phi = remainder(angle, 2 * M_PI) / M_PI;
  row->spread_mm =
      (double)(to - from) * 2 * M_PI * disc->radius_mm / (double)disc->station_count / sqrt(12);
  row->s_mm = (row->phi + 1) * M_PI * disc->radius_mm;
  return true;
}

/* Robust sd of the rows against their neighbours at the lag: the noise of the edge, independent of
 * the disc's form error and of a scanner's jumps and waves. */
static double noise_beside_roundness(const fg_disc *disc, const fg_edge_fit_row *rows, size_t count,
                                     double *work) {
  for (size_t i = 0; i < count; i++) {
    size_t before = (i + count - NEIGHBOUR_LAG) % count, after = (i + NEIGHBOUR_LAG) % count;
    double sum = 0;
    static const double share[3] = {1, -0.5, -0.5};
    const size_t at[3] = {i, before, after};
    for (int k = 0; k < 3; k++)
      sum += share[k] *
             hypot(rows[at[k]].at.x - disc->centre_mm.x, rows[at[k]].at.y - disc->centre_mm.y);
    work[i] = fabs(1000 * sum) / sqrt(1.5); /* 1 + 1/4 + 1/4 */
  }
  return fg_spread_limit(work, count, 1);
}

/* An edge that is no circle is no gauge: all that it leaves counts as its noise. */
static double noise_of(const fg_disc *disc, const fg_edge_fit_row *rows, size_t count,
                       double *work) {
  if ((disc->flags & FG_BUMP_POOR_FIT) || count < ROWS_MIN) return disc->rms_um;
  return fmax(noise_beside_roundness(disc, rows, count, work), NOISE_MIN_UM);
}

static fg_status add_disc(fg_context *ctx, fg_edge_fit *edge_fit, size_t v, size_t block) {
  const fg_disc *disc = edge_fit->views[v].disc;
  for (size_t k = 0; k < disc->station_count; k += block) {
    fg_edge_fit_row row;
    if (!average_block(disc, k, k + block, &row)) continue;
    row.view = v;
    row.part = edge_fit->views[v].part;
    row.group = v;
    FG_TRY(fg_edge_fit_add_row(ctx, edge_fit, &row));
  }
  return FG_OK;
}

static int compare_places(const void *a, const void *b) {
  const fg_edge_fit_row *p = a, *q = b;
  return (p->s_mm > q->s_mm) - (p->s_mm < q->s_mm);
}

/* Weights in units of the cleanest disc's row. */
static fg_status weigh_discs(fg_context *ctx, fg_edge_fit *edge_fit, size_t block) {
  double *noise = NULL, *work = NULL, min = INFINITY;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, edge_fit->view_count, sizeof *noise, (void **)&noise));
  FG_TRY_EXIT(fg_memory_allocate(ctx, edge_fit->row_count, sizeof *work, (void **)&work));
  for (size_t first = 0; first < edge_fit->row_count;) {
    size_t last = first, v = edge_fit->rows[first].view;
    while (last < edge_fit->row_count && edge_fit->rows[last].view == v)
      last++;
    fg_sort_items(edge_fit->rows + first, last - first, sizeof *edge_fit->rows, compare_places);
    noise[v] = noise_of(edge_fit->views[v].disc, edge_fit->rows + first, last - first, work);
    min = fmin(min, noise[v]);
    first = last;
  }
  for (size_t i = 0; i < edge_fit->row_count; i++) {
    double ratio = min / noise[edge_fit->rows[i].view];
    edge_fit->rows[i].weight *= FG_EDGE_FIT_BLOCK / (double)block * ratio * ratio;
  }
exit:
  free(noise);
  free(work);
  return status;
}

fg_status fg_edge_fit_build_discs(fg_context *ctx, const fg_edge_fit_view *views, size_t count,
                                  fg_edge_fit *edge_fit) {
  fg_status status = FG_OK;
  size_t stations = 0;
  edge_fit->discs = true;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *views, (void **)&edge_fit->views));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *edge_fit->poses, (void **)&edge_fit->poses));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *edge_fit->parts, (void **)&edge_fit->parts));
  for (size_t v = 0; v < count; v++) {
    edge_fit->views[v] = views[v];
    edge_fit->views[v].part = v;
    edge_fit->poses[v] = (fg_edge_fit_pose){views[v].disc->centre_mm, 0};
    edge_fit->parts[v] = (fg_edge_fit_part){
        .overall_radius_mm = views[v].disc->radius_mm, .sense = 1, .half_span_rad = M_PI};
    stations += views[v].disc->station_count;
  }
  edge_fit->view_count = edge_fit->part_count = edge_fit->group_count = count;
  size_t block = (stations + ROWS_MAX - 1) / ROWS_MAX;
  if (block < BLOCK_MIN) block = BLOCK_MIN;
  FG_TRY_EXIT(match_diameters(ctx, edge_fit));
  for (size_t v = 0; v < count; v++)
    FG_TRY_EXIT(add_disc(ctx, edge_fit, v, block));
  FG_TRY_EXIT(weigh_discs(ctx, edge_fit, block));
  fg_edge_fit_find_frame(edge_fit);
  fg_edge_fit_count_parameters(edge_fit);
exit:
  if (status != FG_OK) fg_edge_fit_free(edge_fit);
  return status;
}
