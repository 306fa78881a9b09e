/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Foils with corrected edges, measured again. Only fields of the scanner move edges: what deviates
 * on the part is its form, and its circles are the least-squares circles through it as it is
 * (ISO 12181's associated circle). */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "effect_search/width_search.h"
#include "measure/again.h"
#include "scan_loop/state.h"

static fg_point moved(const void *user, fg_point at) {
  fg_point d = fg_field_at(user, at);
  return (fg_point){at.x + d.x, at.y + d.y};
}

static fg_point displaced(const void *user, fg_point at) {
  fg_point d = fg_displacement_at(user, at);
  return (fg_point){at.x + d.x, at.y + d.y};
}

/* Displacement of edges by the scanner, which is removed. A deviation of the part is its form: it
 * is reported beside the dimensions and stays in them. */
typedef struct correction {
  const fg_field_list *fields;         /* NULL: none */
  const fg_displacement *displacement; /* NULL: none */
} correction;

static void correct_strip(const void *user, const fg_foil *foil, fg_strip *strip) {
  const correction *c = user;
  (void)foil;
  if (c->fields && !fg_field_list_is_empty(c->fields)) fg_strip_move(strip, moved, c->fields);
  if (c->displacement) fg_strip_move(strip, displaced, c->displacement);
}

static fg_point correct_point(const void *user, const fg_disc *disc, fg_point at) {
  const correction *c = user;
  (void)disc;
  if (c->fields) at = moved(c->fields, at);
  return c->displacement ? displaced(c->displacement, at) : at;
}

static fg_point correct_mark(const void *user, fg_point at) {
  return correct_point(user, NULL, at);
}

static fg_status correct_measurement(fg_context *ctx, const fg_measurement *m, const correction *c,
                                     unsigned threads, fg_measurement *corrected) {
  const fg_measure_mover mover = {
      .strip = correct_strip, .point = correct_point, .flat = correct_mark, .user = c};
  return fg_measure_again(ctx, m, &mover, threads, corrected);
}

fg_status fg_scan_loop_correct(fg_context *ctx, const fg_measurement *m,
                               const fg_field_list *fields, unsigned threads,
                               fg_measurement *corrected) {
  return correct_measurement(ctx, m, &(correction){.fields = fields}, threads, corrected);
}

/* Widens a foil's uncertainties by a covariance of its part's circles. */
static void widen_foil(const fg_measurement *m, const fg_edge_fit_part *part,
                       double (*const bumps)[3][3], double overall, fg_foil *foil) {
  double share = foil->overall.u_springback_error_pct / foil->overall.u_radius_mm;
  for (size_t b = 0; b < foil->bump_count; b++)
    for (size_t k = 0; k < part->bump_count; k++)
      if (part->bumps[k].number == foil->bumps[b].number)
        fg_bump_widen(&m->design, &m->nominal, &foil->overall, bumps[k], &foil->bumps[b]);
  foil->overall.u_radius_mm = hypot(foil->overall.u_radius_mm, sqrt(overall));
  foil->overall.u_springback_error_pct = share * foil->overall.u_radius_mm;
}

/* Widens the foils' uncertainties by those of the scanner's effects: the correction is not known
 * exactly. */
static void widen_by_effects(const fg_joint_fit_result *fit, const fg_measurement *before,
                             fg_measurement *after) {
  const fg_edge_fit *edge_fit = fit->edge_fit;
  for (size_t v = 0; v < edge_fit->view_count; v++) {
    const fg_edge_fit_view *view = &edge_fit->views[v];
    const fg_joint_fit_part *adds = &fit->parts[view->part];
    if (view->measurement != before || view->disc) continue;
    widen_foil(after, &edge_fit->parts[view->part], adds->bumps, adds->overall,
               &after->foils[view->foil - before->foils]);
  }
}

void fg_scan_loop_widen_by_unseen(fg_scan_loop *loop) {
  const fg_edge_fit *edge_fit = &loop->edge_fit;
  if (loop->beside_foil_field && loop->scanner_is_suspect) return; /* it has decided already */
  for (size_t v = 0; loop->unseen_parts && v < edge_fit->view_count; v++) {
    const fg_edge_fit_view *view = &edge_fit->views[v];
    if (!view->foil) continue;
    const fg_displacement_part *adds = &loop->unseen_parts[view->part];
    fg_measurement *after = &loop->after[view->scan];
    fg_foil *foil = &after->foils[view->foil - loop->before[view->scan].foils];
    if (foil->flags & FG_FOIL_NOT_MEASURED) continue;
    widen_foil(after, &edge_fit->parts[view->part], adds->bumps, adds->overall, foil);
  }
}

fg_status fg_scan_loop_correct_fitted(fg_context *ctx, const fg_measurement *m,
                                      const fg_joint_fit_result *fit, unsigned threads,
                                      fg_measurement *corrected) {
  FG_TRY(correct_measurement(ctx, m, &(correction){.fields = &fit->fields}, threads, corrected));
  if (fit->fields.count) widen_by_effects(fit, m, corrected);
  return FG_OK;
}

fg_status fg_scan_loop_correct_all(fg_context *ctx, const fg_scan_loop *loop,
                                   const fg_joint_fit_result *fit, fg_measurement *after) {
  for (size_t i = 0; i < loop->scan_count; i++)
    FG_TRY(
        fg_scan_loop_correct_fitted(ctx, &loop->before[i], fit, loop->options.threads, &after[i]));
  return FG_OK;
}

fg_status fg_scan_loop_correct_by_evidence(fg_context *ctx, const fg_scan_loop *loop,
                                           const fg_joint_fit_result *fit, fg_measurement *after) {
  const correction c = {.displacement = &loop->displacement};
  for (size_t i = 0; i < loop->scan_count; i++) {
    FG_TRY(correct_measurement(ctx, &loop->before[i], &c, loop->options.threads, &after[i]));
    widen_by_effects(fit, &loop->before[i], &after[i]);
  }
  return FG_OK;
}

/* ---- the strip's width ---- */

/* Fills the change of half the width by the mean displacement, um. */
static void fill_stretch(const fg_scan_loop *loop, double *stretch_um) {
  for (size_t i = 0; i < loop->edge_fit.row_count; i++) {
    const fg_edge_fit_row *row = &loop->edge_fit.rows[i];
    fg_point n = row->normal, d[2];
    for (int side = 0; side < 2; side++) {
      double w = side ? -row->half_width_mm : row->half_width_mm;
      d[side] = fg_displacement_at(&loop->displacement,
                                   (fg_point){row->ideal.x + w * n.x, row->ideal.y + w * n.y});
    }
    stretch_um[i] = -500 * ((d[0].x - d[1].x) * n.x + (d[0].y - d[1].y) * n.y);
  }
}

fg_status fg_scan_loop_find_width(fg_context *ctx, fg_scan_loop *loop) {
  double *stretch_um = NULL;
  if (loop->by_evidence && loop->scanner_is_suspect) {
    FG_TRY(fg_memory_allocate(ctx, loop->edge_fit.row_count, sizeof *stretch_um,
                              (void **)&stretch_um));
    fill_stretch(loop, stretch_um);
  }
  fg_status status = fg_search_width(ctx, &loop->edge_fit, &loop->set, stretch_um, &loop->width);
  free(stretch_um);
  return status;
}
