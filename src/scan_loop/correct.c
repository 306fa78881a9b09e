/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Foils with corrected edges, measured again. */
#include <math.h>

#include "measure/again.h"
#include "scan_loop/state.h"

static fg_point moved(const void *user, fg_point at) {
  fg_point d = fg_field_at(user, at);
  return (fg_point){at.x + d.x, at.y + d.y};
}

/* The row of a view that is nearest to a place; NULL: the view has none. */
static const fg_edge_fit_row *nearest_row(const fg_edge_fit *edge_fit, size_t view, fg_point at) {
  const fg_edge_fit_row *row = NULL;
  double nearest = INFINITY;
  for (size_t i = 0; i < edge_fit->row_count; i++) {
    if (edge_fit->rows[i].view != view) continue;
    double dx = edge_fit->rows[i].at.x - at.x, dy = edge_fit->rows[i].at.y - at.y;
    if (dx * dx + dy * dy >= nearest) continue;
    nearest = dx * dx + dy * dy;
    row = &edge_fit->rows[i];
  }
  return row;
}

/* Displacement of edges to remove: a scanner's fields, and of a fit its part effects. */
typedef struct correction {
  const fg_field_list *fields;    /* NULL: none */
  const fg_joint_fit_result *fit; /* NULL: none */
} correction;

/* The shift at a place, that of the nearest row of its view. */
static fg_point shift_at(const fg_joint_fit_result *fit, size_t view, fg_point at) {
  const fg_edge_fit_row *row = nearest_row(fit->edge_fit, view, at);
  return row ? fit->shift_mm[row - fit->edge_fit->rows] : (fg_point){0, 0};
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
  for (*view = 0; fit && *view < fit->edge_fit->view_count; ++*view) {
    const fg_edge_fit_view *one = &fit->edge_fit->views[*view];
    if (foil ? one->foil == foil : one->disc == disc) return true;
  }
  return false;
}

static void correct_strip(const void *user, const fg_foil *foil, fg_strip *strip) {
  const correction *c = user;
  size_t view;
  if (c->fields && c->fields->count) fg_strip_move(strip, moved, c->fields);
  if (find_view(c->fit, foil, NULL, &view)) take_shift(c->fit, view, strip);
}

static fg_point correct_point(const void *user, const fg_disc *disc, fg_point at) {
  const correction *c = user;
  size_t view;
  if (c->fields) at = moved(c->fields, at);
  if (!find_view(c->fit, NULL, disc, &view)) return at;
  fg_point d = shift_at(c->fit, view, at);
  return (fg_point){at.x - d.x, at.y - d.y};
}

static fg_status correct_measurement(fg_context *ctx, const fg_measurement *m, const correction *c,
                                     unsigned threads, fg_measurement *corrected) {
  const fg_measure_mover mover = {.strip = correct_strip, .point = correct_point, .user = c};
  return fg_measure_again(ctx, m, &mover, threads, corrected);
}

fg_status fg_scan_loop_correct(fg_context *ctx, const fg_measurement *m,
                               const fg_field_list *fields, unsigned threads,
                               fg_measurement *corrected) {
  return correct_measurement(ctx, m, &(correction){.fields = fields}, threads, corrected);
}

/* Widens the foils' uncertainties by the contribution of the set's effects to the geometry's
 * covariance: the correction is not known exactly. */
static void widen_by_effects(const fg_joint_fit_result *fit, const fg_measurement *before,
                             fg_measurement *after) {
  const fg_edge_fit *edge_fit = fit->edge_fit;
  for (size_t v = 0; v < edge_fit->view_count; v++) {
    const fg_edge_fit_part *part = &edge_fit->parts[edge_fit->views[v].part];
    const fg_joint_fit_part *adds = &fit->parts[edge_fit->views[v].part];
    if (edge_fit->views[v].measurement != before || edge_fit->views[v].disc) continue;
    fg_foil *foil = &after->foils[edge_fit->views[v].foil - before->foils];
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
  FG_TRY(correct_measurement(ctx, m, &(correction){&fit->fields, fit}, threads, corrected));
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
