/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rows/edge_fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"

/* Maximum relative difference of one bump's radii in two scans: a ripple of the carriage changes
 * them by a tenth and more. */
#define SAME_SHARE 0.2
/* Lower limit of half the angle between the outer bumps, which is 0 for one bump. */
#define HALF_SPAN_MIN_RAD 0.1
static double turn_to(double angle, double near) {
  return angle - 2 * M_PI * round((angle - near) / (2 * M_PI));
}

static double bump_direction(const fg_foil *foil, const fg_bump *bump) {
  return atan2(bump->centre_mm.y - foil->overall.centre_mm.y,
               bump->centre_mm.x - foil->overall.centre_mm.x);
}

/* Of the strip at a station, from O. */
static fg_point strip_middle_at(const fg_foil *foil, size_t station) {
  const fg_station *s = &foil->strip.stations[station];
  return (fg_point){0.5 * (s->left.x + s->right.x) - foil->overall.centre_mm.x,
                    0.5 * (s->left.y + s->right.y) - foil->overall.centre_mm.y};
}

static bool is_usable(const fg_bump *bump) {
  return !(bump->flags & FG_BUMP_NOT_FITTED) && isfinite(bump->radius_mm);
}

/* Angle that the strip spans about O, without a lip. */
static double end_to_end(const fg_foil *foil) {
  double span = 0;
  size_t last = foil->strip.count;
  for (size_t k = 0; k < foil->strip.count; k++) {
    if (foil->labels[k].kind == FG_ARC_LIP || !(foil->strip.stations[k].weight > 0)) continue;
    fg_point to = strip_middle_at(foil, k), from = strip_middle_at(foil, last < k ? last : k);
    span += atan2(from.x * to.y - from.y * to.x, from.x * to.x + from.y * to.y);
    last = k;
  }
  return fabs(span);
}

/* The part as its first view shows it. */
static fg_status start_part(fg_context *ctx, const fg_foil *foil, fg_edge_fit_part *part) {
  FG_TRY(fg_memory_allocate(ctx, foil->bump_count, sizeof *part->bumps, (void **)&part->bumps));
  part->overall_radius_mm = foil->overall.radius_mm;
  part->end_to_end_rad = end_to_end(foil);
  part->sense = foil->orientation == FG_CLOCKWISE ? 1 : -1;
  double before = 0;
  for (size_t i = 0; i < foil->bump_count; i++) {
    const fg_bump *bump = &foil->bumps[i];
    if (!is_usable(bump)) continue;
    double direction = bump_direction(foil, bump);
    if (part->bump_count) direction = turn_to(direction, before);
    before = direction;
    part->bumps[part->bump_count++] = (fg_edge_fit_bump){.number = bump->number,
                                                         .distance_mm = bump->centre_to_centre_mm,
                                                         .direction_rad = direction,
                                                         .radius_mm = bump->radius_mm};
  }
  if (!part->bump_count) return FG_OK;
  double first = part->bumps[0].direction_rad;
  double last = part->bumps[part->bump_count - 1].direction_rad;
  part->middle_rad = 0.5 * (first + last);
  part->half_span_rad =
      fmax(0.5 * fabs(last - first), HALF_SPAN_MIN_RAD) * (1 + 1.0 / (double)part->bump_count);
  return FG_OK;
}

static const fg_bump *find_numbered_bump(const fg_foil *foil, int number) {
  for (size_t i = 0; i < foil->bump_count; i++)
    if (foil->bumps[i].number == number && is_usable(&foil->bumps[i])) return &foil->bumps[i];
  return NULL;
}

/* Pose of a further view: the mean turn of its bumps. */
static fg_status start_pose(fg_context *ctx, const fg_edge_fit_part *part, const fg_foil *foil,
                            fg_edge_fit_pose *pose) {
  double c = 0, s = 0, sense = foil->orientation == FG_CLOCKWISE ? 1 : -1;
  size_t matched = 0;
  for (size_t i = 0; i < part->bump_count; i++) {
    const fg_bump *bump = find_numbered_bump(foil, part->bumps[i].number);
    if (!bump) continue;
    double turn = bump_direction(foil, bump) - part->bumps[i].direction_rad;
    c += cos(turn);
    s += sin(turn);
    matched++;
    if (fabs(bump->radius_mm / part->bumps[i].radius_mm - 1) > SAME_SHARE)
      return fg_fail(ctx, FG_ERR_DATA,
                     "bump %d is %.3f mm in one scan and %.3f mm in another: not the same foil",
                     bump->number, part->bumps[i].radius_mm, bump->radius_mm);
  }
  if (sense != part->sense)
    return fg_fail(ctx, FG_ERR_DATA,
                   "the foil lies mirrored in one of the scans: not the same "
                   "side on the glass, or not the same foil");
  if (matched < part->bump_count || matched != foil->bump_count)
    return fg_fail(ctx, FG_ERR_DATA,
                   "the scans do not show the same bumps (%zu and %zu): not the same foil",
                   part->bump_count, foil->bump_count);
  pose->origin_mm = foil->overall.centre_mm;
  pose->turn_rad = atan2(s, c);
  return FG_OK;
}

static size_t index_of_bump(const fg_edge_fit_part *part, int number) {
  for (size_t i = 0; i < part->bump_count; i++)
    if (part->bumps[i].number == number) return i;
  return part->bump_count;
}

/* The datum line of a station. */
static fg_point datum_at(const fg_foil *foil, fg_datum datum, const fg_station *s) {
  fg_point middle = {0.5 * (s->left.x + s->right.x), 0.5 * (s->left.y + s->right.y)};
  if (datum == FG_DATUM_MID) return middle;
  double left = hypot(s->left.x - foil->overall.centre_mm.x, s->left.y - foil->overall.centre_mm.y);
  double right =
      hypot(s->right.x - foil->overall.centre_mm.x, s->right.y - foil->overall.centre_mm.y);
  bool inner_is_left = left < right;
  return (datum == FG_DATUM_INNER) == inner_is_left ? s->left : s->right;
}

/* Mean over the fitted stations of [from, to). */
static bool average_block(const fg_edge_fit_view *view, size_t from, size_t to,
                          fg_edge_fit_row *row) {
  const fg_foil *foil = view->foil;
  double n = 0;
  *row = (fg_edge_fit_row){0};
  for (size_t k = from; k < to; k++) {
    if (!foil->labels[k].fitted) continue;
    const fg_station *s = &foil->strip.stations[k];
    fg_point p = datum_at(foil, view->measurement->design.datum, s);
    row->at.x += p.x;
    row->at.y += p.y;
    row->half_width_mm += 0.5 * hypot(s->right.x - s->left.x, s->right.y - s->left.y);
    row->s_mm += s->s_mm;
    n++;
  }
  if (n < FG_EDGE_FIT_BLOCK_SHARE * (double)(to - from)) return false;
  row->at.x /= n;
  row->at.y /= n;
  row->half_width_mm /= n;
  row->s_mm /= n;
  row->weight = n;
  double step = foil->strip.step_mm, length = step * (double)(to - from);
  double blur = 5e-4 * (foil->strip.blur_left_um + foil->strip.blur_right_um);
  row->spread_mm = sqrt(length * length / 12 + blur * blur);
  return true;
}

static void count_arc(fg_edge_fit_part *part, int number, double length_mm) {
  double radius = part->bumps[index_of_bump(part, number)].radius_mm, n = (double)++part->arcs;
  part->half_arc_rad += (0.5 * length_mm / radius - part->half_arc_rad) / n;
  part->mean_radius_mm += (radius - part->mean_radius_mm) / n;
}

/* Adds the rows of one run of labels [first, last]. The mean of points on an arc lies inside it by
 * the sagitta's mean, (2h)²/24R with h half the block: some nanometres, which cancel because the
 * caller's geometry is fitted to the same means. */
static fg_status add_run(fg_context *ctx, fg_edge_fit *edge_fit, size_t v, size_t first,
                         size_t last, size_t group) {
  const fg_edge_fit_view *view = &edge_fit->views[v];
  const fg_foil *foil = view->foil;
  const fg_station_label *label = &foil->labels[first];
  double length = foil->strip.stations[last].s_mm;
  bool reversed = foil->bump_count > 1 &&
                  foil->bumps[0].arc_start_mm > foil->bumps[foil->bump_count - 1].arc_start_mm;
  double whole = foil->strip.stations[foil->strip.count - 1].s_mm;
  double start = foil->strip.stations[first].s_mm;
  fg_edge_fit_part *part = &edge_fit->parts[view->part];
  if (label->kind == FG_ARC_BUMP) count_arc(part, label->number, length - start);
  for (size_t k = first; k + FG_EDGE_FIT_BLOCK <= last + 1; k += FG_EDGE_FIT_BLOCK) {
    fg_edge_fit_row row;
    if (!average_block(view, k, k + FG_EDGE_FIT_BLOCK, &row)) continue;
    row.view = v;
    row.part = view->part;
    row.group = group;
    row.bump = label->kind == FG_ARC_BUMP ? label->number : 0;
    row.bump_index = index_of_bump(part, row.bump);
    row.phi = 2 * (row.s_mm - start) / (length - start) - 1;
    if (reversed) {
      row.phi = -row.phi;
      row.s_mm = whole - row.s_mm;
    }
    FG_TRY(fg_edge_fit_add_row(ctx, edge_fit, &row));
  }
  return FG_OK;
}

static bool is_arc(const fg_station_label *label) {
  return label->kind == FG_ARC_BUMP || label->kind == FG_ARC_LAND;
}

static bool same_run(const fg_station_label *a, const fg_station_label *b) {
  return a->kind == b->kind && a->number == b->number;
}

/* Lands are numbered over all bumps of a foil, also those that no circle fitted. */
static size_t land_numbers(const fg_foil *foil) {
  int max = 0;
  for (size_t k = 0; k < foil->strip.count; k++)
    if (foil->labels[k].kind == FG_ARC_LAND && foil->labels[k].number > max)
      max = foil->labels[k].number;
  return (size_t)max + 1;
}

/* Adds the rows of a view. Groups are the independent units: every bump (over all views of its
 * part) and land. */
static fg_status add_view(fg_context *ctx, fg_edge_fit *edge_fit, size_t v, size_t first_group) {
  const fg_foil *foil = edge_fit->views[v].foil;
  const fg_edge_fit_part *part = &edge_fit->parts[edge_fit->views[v].part];
  for (size_t k = 0; k < foil->strip.count;) {
    const fg_station_label *label = &foil->labels[k];
    size_t last = k;
    while (last + 1 < foil->strip.count && same_run(&foil->labels[last + 1], label))
      last++;
    size_t group = label->kind == FG_ARC_BUMP
                       ? first_group + index_of_bump(part, label->number)
                       : first_group + part->bump_count + (size_t)label->number;
    bool known =
        label->kind != FG_ARC_BUMP || index_of_bump(part, label->number) < part->bump_count;
    if (is_arc(label) && known) FG_TRY(add_run(ctx, edge_fit, v, k, last, group));
    k = last + 1;
  }
  return FG_OK;
}

/* Renumbers groups without gaps: 0 .. group_count - 1. */
static fg_status pack_groups(fg_context *ctx, fg_edge_fit *edge_fit, size_t max) {
  size_t *packed = NULL;
  FG_TRY(fg_memory_allocate(ctx, max, sizeof *packed, (void **)&packed));
  for (size_t i = 0; i < edge_fit->row_count; i++)
    packed[edge_fit->rows[i].group] = 1;
  size_t next = 0;
  for (size_t g = 0; g < max; g++)
    packed[g] = packed[g] ? next++ : 0;
  for (size_t i = 0; i < edge_fit->row_count; i++)
    edge_fit->rows[i].group = packed[edge_fit->rows[i].group];
  edge_fit->group_count = next;
  free(packed);
  return FG_OK;
}

static fg_status fill_rows(fg_context *ctx, fg_edge_fit *edge_fit) {
  size_t first_group = 0;
  FG_TRY(fg_memory_allocate(ctx, edge_fit->part_count, sizeof *edge_fit->parts,
                            (void **)&edge_fit->parts));
  for (size_t p = 0; p < edge_fit->part_count; p++) {
    size_t groups = 0;
    for (size_t v = 0; v < edge_fit->view_count; v++) {
      const fg_foil *foil = edge_fit->views[v].foil;
      if (edge_fit->views[v].part != p) continue;
      fg_edge_fit_part *part = &edge_fit->parts[p];
      if (!part->bumps) {
        FG_TRY(start_part(ctx, foil, part));
        edge_fit->poses[v] = (fg_edge_fit_pose){foil->overall.centre_mm, 0};
      } else {
        FG_TRY(start_pose(ctx, part, foil, &edge_fit->poses[v]));
      }
      FG_TRY(add_view(ctx, edge_fit, v, first_group));
      size_t own = part->bump_count + land_numbers(foil);
      groups = own > groups ? own : groups;
    }
    first_group += groups;
  }
  fg_edge_fit_find_frame(edge_fit);
  return pack_groups(ctx, edge_fit, first_group);
}

/* Copies the usable views. A part may lose all its views, and with them its geometry: parts are
 * renumbered 0 .. part_count - 1 in the order of their first views. */
static fg_status copy_views(fg_context *ctx, const fg_edge_fit_view *views, size_t count,
                            fg_edge_fit *edge_fit) {
  size_t *given = NULL; /* the caller's number of each new part */
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *given, (void **)&given));
  for (size_t i = 0; i < count; i++) {
    size_t part = 0;
    if (views[i].foil->flags & FG_FOIL_NOT_MEASURED) continue;
    while (part < edge_fit->part_count && given[part] != views[i].part)
      part++;
    if (part == edge_fit->part_count) given[edge_fit->part_count++] = views[i].part;
    edge_fit->views[edge_fit->view_count] = views[i];
    edge_fit->views[edge_fit->view_count++].part = part;
  }
  free(given);
  return FG_OK;
}

/* Orders rows by group, then view and place, as the engine requires. */
static int compare_rows(const void *a, const void *b) {
  const fg_edge_fit_row *p = a, *q = b;
  if (p->group != q->group) return (p->group > q->group) - (p->group < q->group);
  if (p->view != q->view) return (p->view > q->view) - (p->view < q->view);
  return (p->s_mm > q->s_mm) - (p->s_mm < q->s_mm);
}

/* Range of the rows' psi as the measured circles place them. */
static fg_status find_psi_range(fg_context *ctx, fg_edge_fit *edge_fit) {
  double *residual = NULL;
  FG_TRY(fg_memory_allocate(ctx, edge_fit->row_count, sizeof *residual, (void **)&residual));
  fg_edge_fit_residual(edge_fit, NULL, residual, NULL);
  free(residual);
  edge_fit->psi_rad[0] = INFINITY;
  edge_fit->psi_rad[1] = -INFINITY;
  for (size_t i = 0; i < edge_fit->row_count; i++) {
    edge_fit->psi_rad[0] = fmin(edge_fit->psi_rad[0], edge_fit->rows[i].psi);
    edge_fit->psi_rad[1] = fmax(edge_fit->psi_rad[1], edge_fit->rows[i].psi);
  }
  return FG_OK;
}

fg_status fg_edge_fit_build_foils(fg_context *ctx, const fg_edge_fit_view *views, size_t count,
                                  fg_edge_fit *edge_fit) {
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *views, (void **)&edge_fit->views));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *edge_fit->poses, (void **)&edge_fit->poses));
  FG_TRY_EXIT(copy_views(ctx, views, count, edge_fit));
  FG_TRY_EXIT(fill_rows(ctx, edge_fit));
  fg_edge_fit_count_parameters(edge_fit);
  fg_sort_items(edge_fit->rows, edge_fit->row_count, sizeof *edge_fit->rows, compare_rows);
  FG_TRY_EXIT(find_psi_range(ctx, edge_fit));
exit:
  if (status != FG_OK) fg_edge_fit_free(edge_fit);
  return status;
}
