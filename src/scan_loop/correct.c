/* Foils with corrected edges, measured again. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "geometry/disc_fit.h"
#include "scan_loop/state.h"

static fg_status copy_strip(fg_context *ctx, const fg_strip *from, fg_strip *to) {
  *to = *from;
  to->stations = NULL;
  FG_TRY(fg_memory_allocate(ctx, from->count, sizeof *to->stations, (void **)&to->stations));
  memcpy(to->stations, from->stations, from->count * sizeof *to->stations);
  return FG_OK;
}

static fg_point moved(const fg_field_list *fields, fg_point at) {
  fg_point d = fg_field_at(fields, at);
  return (fg_point){at.x + d.x, at.y + d.y};
}

static void move_edges(const fg_field_list *fields, fg_strip *strip) {
  for (size_t k = 0; k < strip->count; k++) {
    fg_station *s = &strip->stations[k];
    fg_point *edges[2] = {&s->left, &s->right};
    for (int side = 0; side < 2; side++) {
      if (!isfinite(edges[side]->x)) continue;
      *edges[side] = moved(fields, *edges[side]);
    }
  }
}

/* The row of a view that is nearest to a place; NULL: the view has none. */
static const fg_points_row *nearest_row(const fg_points *points, size_t view, fg_point at) {
  const fg_points_row *row = NULL;
  double nearest = INFINITY;
  for (size_t i = 0; i < points->row_count; i++) {
    if (points->rows[i].view != view) continue;
    double dx = points->rows[i].at.x - at.x, dy = points->rows[i].at.y - at.y;
    if (dx * dx + dy * dy >= nearest) continue;
    nearest = dx * dx + dy * dy;
    row = &points->rows[i];
  }
  return row;
}

/* The shift at a place, that of the nearest row of its view, outwards from the arc's own centre. */
static fg_point shift_at(const fg_points *points, size_t view, const double *shift_mm,
                         fg_point at) {
  const fg_points_row *row = nearest_row(points, view, at);
  if (!row) return (fg_point){0, 0};
  double shift = shift_mm[row - points->rows];
  return (fg_point){shift * row->normal.x, shift * row->normal.y};
}

static void take_shift(const fg_points *points, size_t view, const double *shift_mm,
                       fg_strip *strip) {
  for (size_t k = 0; k < strip->count; k++) {
    fg_station *s = &strip->stations[k];
    fg_point middle = {0.5 * (s->left.x + s->right.x), 0.5 * (s->left.y + s->right.y)};
    fg_point d = shift_at(points, view, shift_mm, middle);
    s->left.x -= d.x;
    s->left.y -= d.y;
    s->right.x -= d.x;
    s->right.y -= d.y;
  }
}

fg_status fg_scan_loop_correct_foil(fg_context *ctx, const fg_foil *foil, const fg_design *design,
                                    const fg_field_list *fields, const fg_points *points,
                                    size_t view, const double *shift_mm, unsigned threads,
                                    fg_foil *corrected) {
  memset(corrected, 0, sizeof *corrected);
  memcpy(corrected->place_mm, foil->place_mm, sizeof corrected->place_mm);
  corrected->number = foil->number;
  if (foil->flags & FG_FOIL_NOT_MEASURED) { /* nothing to correct; why stays as it is */
    fg_foil_give_up(corrected, foil->error);
    corrected->flags = foil->flags;
    return FG_OK;
  }
  FG_TRY(copy_strip(ctx, &foil->strip, &corrected->strip));
  if (fields && fields->count) move_edges(fields, &corrected->strip);
  if (shift_mm) take_shift(points, view, shift_mm, &corrected->strip);
  fg_status status = fg_strip_measure_thickness(ctx, &corrected->strip);
  if (status == FG_OK) status = fg_foil_measure(ctx, design, threads, corrected);
  if (status != FG_OK) fg_foil_free(corrected);
  return status;
}

static void take_disc_shift(const fg_points *points, size_t view, const double *shift_mm,
                            fg_disc *disc) {
  for (size_t k = 0; k < disc->station_count; k++) {
    fg_point *at = &disc->stations[k].at, d = shift_at(points, view, shift_mm, *at);
    at->x -= d.x;
    at->y -= d.y;
  }
}

static fg_status correct_disc(fg_context *ctx, const fg_disc *disc, const fg_field_list *fields,
                              const fg_points *points, const double *shift_mm, fg_disc *corrected) {
  *corrected = *disc;
  corrected->edge = NULL;
  corrected->residual_um = NULL;
  corrected->stations = NULL;
  FG_TRY(fg_memory_allocate(ctx, disc->station_count, sizeof *disc->stations,
                            (void **)&corrected->stations));
  memcpy(corrected->stations, disc->stations, disc->station_count * sizeof *disc->stations);
  for (size_t k = 0; fields && k < disc->station_count; k++)
    corrected->stations[k].at = moved(fields, disc->stations[k].at);
  size_t v = 0;
  while (points && v < points->view_count && points->views[v].disc != disc)
    v++;
  if (shift_mm && points && v < points->view_count) take_disc_shift(points, v, shift_mm, corrected);
  return fg_disc_measure_again(ctx, corrected);
}

static fg_status correct_discs(fg_context *ctx, const fg_measurement *m,
                               const fg_field_list *fields, const fg_points *points,
                               const double *shift_mm, fg_measurement *corrected) {
  FG_TRY(fg_memory_allocate(ctx, m->disc_count, sizeof *m->discs, (void **)&corrected->discs));
  for (size_t d = 0; d < m->disc_count; d++) {
    corrected->disc_count++;
    FG_TRY(correct_disc(ctx, &m->discs[d], fields, points, shift_mm, &corrected->discs[d]));
  }
  return FG_OK;
}

/* The view of a foil of a scan; the number of views when it has none. */
static size_t find_view(const fg_points *points, const fg_foil *foil) {
  size_t v = 0;
  while (points && v < points->view_count && points->views[v].foil != foil)
    v++;
  return v;
}

fg_status fg_scan_loop_correct(fg_context *ctx, const fg_measurement *m,
                               const fg_field_list *fields, const fg_points *points,
                               const double *shift_mm, unsigned threads,
                               fg_measurement *corrected) {
  *corrected = *m;
  corrected->foils = NULL;
  corrected->foil_count = 0;
  corrected->discs = NULL;
  corrected->disc_count = 0;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, m->foil_count, sizeof *m->foils, (void **)&corrected->foils));
  for (size_t f = 0; f < m->foil_count; f++) {
    size_t view = find_view(points, &m->foils[f]);
    bool known = points && view < points->view_count;
    FG_TRY_EXIT(fg_scan_loop_correct_foil(ctx, &m->foils[f], &m->design, fields, points, view,
                                          known ? shift_mm : NULL, threads, &corrected->foils[f]));
    corrected->foil_count++;
  }
  FG_TRY_EXIT(correct_discs(ctx, m, fields, points, shift_mm, corrected));
exit:
  if (status != FG_OK) fg_measurement_free(corrected);
  return status;
}

/* What was corrected is not known exactly: the uncertainties of the foils take what the fit of the
 * set adds to its geometry's. */
static void widen_by_effects(const fg_points *points, const fg_measurement *before,
                             fg_measurement *after) {
  for (size_t v = 0; v < points->view_count; v++) {
    const fg_points_part *part = &points->parts[points->views[v].part];
    if (points->views[v].measurement != before || points->views[v].disc) continue;
    fg_foil *foil = &after->foils[points->views[v].foil - before->foils];
    double share = foil->overall.u_springback_error_pct / foil->overall.u_radius_mm;
    for (size_t b = 0; b < foil->bump_count; b++)
      for (size_t k = 0; k < part->bump_count; k++) {
        fg_points_bump bump = part->bumps[k];
        if (bump.number == foil->bumps[b].number)
          fg_bump_widen(&after->design, &after->nominal, &foil->overall, bump.effects_mm2,
                        &foil->bumps[b]);
      }
    foil->overall.u_radius_mm = hypot(foil->overall.u_radius_mm, sqrt(part->effects_mm2));
    foil->overall.u_springback_error_pct = share * foil->overall.u_radius_mm;
  }
}

fg_status fg_scan_loop_correct_all(fg_context *ctx, const fg_scan_loop *loop,
                                   const fg_effect_set *set, fg_measurement *after) {
  fg_field_list fields;
  double *shift = NULL;
  fg_effect_set_fields(&loop->points, set, &fields);
  fg_status status = fg_effect_set_shift(ctx, &loop->points, set, &shift);
  for (size_t i = 0; i < loop->scan_count && status == FG_OK; i++)
    status = fg_scan_loop_correct(ctx, &loop->before[i], &fields, &loop->points, shift,
                                  loop->options.threads, &after[i]);
  for (size_t i = 0; i < loop->scan_count && status == FG_OK && set->count; i++)
    widen_by_effects(&loop->points, &loop->before[i], &after[i]);
  free(shift);
  return status;
}
