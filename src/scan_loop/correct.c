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
  for (int i = 0; i < 2; i++) {
    strip->ends[i].left = moved(fields, strip->ends[i].left);
    strip->ends[i].right = moved(fields, strip->ends[i].right);
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

/* What is taken out of edges: a scanner's fields, and of a fit what its part moved. */
typedef struct correction {
  const fg_field_list *fields;    /* NULL: none */
  const fg_joint_fit_result *fit; /* NULL: none */
} correction;

/* The shift at a place, that of the nearest row of its view. */
static fg_point shift_at(const fg_joint_fit_result *fit, size_t view, fg_point at) {
  const fg_points_row *row = nearest_row(fit->points, view, at);
  return row ? fit->shift_mm[row - fit->points->rows] : (fg_point){0, 0};
}

static void take_shift(const fg_joint_fit_result *fit, size_t view, fg_strip *strip) {
  for (size_t k = 0; k < strip->count; k++) {
    fg_station *s = &strip->stations[k];
    fg_point middle = {0.5 * (s->left.x + s->right.x), 0.5 * (s->left.y + s->right.y)};
    fg_point d = shift_at(fit, view, middle);
    s->left.x -= d.x;
    s->left.y -= d.y;
    s->right.x -= d.x;
    s->right.y -= d.y;
  }
}

/* The view of a foil, or of a disc, in a fit; false: it has none. */
static bool find_view(const fg_joint_fit_result *fit, const fg_foil *foil, const fg_disc *disc,
                      size_t *view) {
  for (*view = 0; fit && *view < fit->points->view_count; ++*view) {
    const fg_points_view *one = &fit->points->views[*view];
    if (foil ? one->foil == foil : one->disc == disc) return true;
  }
  return false;
}

static fg_status correct_foil(fg_context *ctx, const fg_foil *foil, const fg_design *design,
                              const correction *c, unsigned threads, fg_foil *corrected) {
  size_t view;
  memset(corrected, 0, sizeof *corrected);
  memcpy(corrected->place_mm, foil->place_mm, sizeof corrected->place_mm);
  corrected->number = foil->number;
  if (foil->flags & FG_FOIL_NOT_MEASURED) { /* nothing to correct; why stays as it is */
    fg_foil_give_up(corrected, foil->error);
    corrected->flags = foil->flags;
    return FG_OK;
  }
  FG_TRY(copy_strip(ctx, &foil->strip, &corrected->strip));
  if (c->fields && c->fields->count) move_edges(c->fields, &corrected->strip);
  if (find_view(c->fit, foil, NULL, &view)) take_shift(c->fit, view, &corrected->strip);
  fg_status status = fg_strip_measure_thickness(ctx, &corrected->strip);
  if (status == FG_OK) status = fg_foil_measure(ctx, design, threads, corrected);
  if (status != FG_OK) fg_foil_free(corrected);
  return status;
}

static fg_status correct_disc(fg_context *ctx, const fg_disc *disc, const correction *c,
                              fg_disc *corrected) {
  size_t view;
  *corrected = *disc;
  corrected->edge = NULL;
  corrected->residual_um = NULL;
  corrected->stations = NULL;
  FG_TRY(fg_memory_allocate(ctx, disc->station_count, sizeof *disc->stations,
                            (void **)&corrected->stations));
  memcpy(corrected->stations, disc->stations, disc->station_count * sizeof *disc->stations);
  bool shifted = find_view(c->fit, NULL, disc, &view);
  for (size_t k = 0; k < disc->station_count; k++) {
    fg_point *at = &corrected->stations[k].at;
    if (c->fields) *at = moved(c->fields, *at);
    fg_point d = shifted ? shift_at(c->fit, view, *at) : (fg_point){0, 0};
    at->x -= d.x;
    at->y -= d.y;
  }
  return fg_disc_measure_again(ctx, corrected);
}

static fg_status correct(fg_context *ctx, const fg_measurement *m, const correction *c,
                         unsigned threads, fg_measurement *corrected) {
  *corrected = *m;
  corrected->foils = NULL;
  corrected->foil_count = 0;
  corrected->discs = NULL;
  corrected->disc_count = 0;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, m->foil_count, sizeof *m->foils, (void **)&corrected->foils));
  for (size_t f = 0; f < m->foil_count; f++) {
    FG_TRY_EXIT(correct_foil(ctx, &m->foils[f], &m->design, c, threads, &corrected->foils[f]));
    corrected->foil_count++;
  }
  FG_TRY_EXIT(fg_memory_allocate(ctx, m->disc_count, sizeof *m->discs, (void **)&corrected->discs));
  for (size_t d = 0; d < m->disc_count; d++) {
    corrected->disc_count++;
    FG_TRY_EXIT(correct_disc(ctx, &m->discs[d], c, &corrected->discs[d]));
  }
exit:
  if (status != FG_OK) fg_measurement_free(corrected);
  return status;
}

fg_status fg_scan_loop_correct(fg_context *ctx, const fg_measurement *m,
                               const fg_field_list *fields, unsigned threads,
                               fg_measurement *corrected) {
  return correct(ctx, m, &(correction){.fields = fields}, threads, corrected);
}

/* What was corrected is not known exactly: the uncertainties of the foils take what the fit of the
 * set adds to its geometry's. */
static void widen_by_effects(const fg_joint_fit_result *fit, const fg_measurement *before,
                             fg_measurement *after) {
  const fg_points *points = fit->points;
  for (size_t v = 0; v < points->view_count; v++) {
    const fg_points_part *part = &points->parts[points->views[v].part];
    const fg_joint_fit_part *adds = &fit->parts[points->views[v].part];
    if (points->views[v].measurement != before || points->views[v].disc) continue;
    fg_foil *foil = &after->foils[points->views[v].foil - before->foils];
    double share = foil->overall.u_springback_error_pct / foil->overall.u_radius_mm;
    for (size_t b = 0; b < foil->bump_count; b++)
      for (size_t k = 0; k < part->bump_count; k++)
        if (part->bumps[k].number == foil->bumps[b].number)
          fg_bump_widen(&after->design, &after->nominal, &foil->overall, adds->bumps[k],
                        &foil->bumps[b]);
    foil->overall.u_radius_mm = hypot(foil->overall.u_radius_mm, sqrt(adds->overall));
    foil->overall.u_springback_error_pct = share * foil->overall.u_radius_mm;
  }
}

fg_status fg_scan_loop_correct_fitted(fg_context *ctx, const fg_measurement *m,
                                      const fg_joint_fit_result *fit, unsigned threads,
                                      fg_measurement *corrected) {
  FG_TRY(correct(ctx, m, &(correction){&fit->fields, fit}, threads, corrected));
  if (fit->set.count) widen_by_effects(fit, m, corrected);
  return FG_OK;
}

fg_status fg_scan_loop_correct_all(fg_context *ctx, const fg_scan_loop *loop,
                                   const fg_joint_fit_result *fit, fg_measurement *after) {
  for (size_t i = 0; i < loop->scan_count; i++)
    FG_TRY(
        fg_scan_loop_correct_fitted(ctx, &loop->before[i], fit, loop->options.threads, &after[i]));
  return FG_OK;
}
