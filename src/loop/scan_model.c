/* Correcting scans by a scanner's model. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "loop/scan_loop.h"
#include "loop/scan_model.h"

/* Adds in squares what one parameter of the model moves every quantity by. */
static void add_doubt(fg_foil *foil, const fg_foil *moved) {
  if (moved->bump_count != foil->bump_count) return;
#define WIDEN(u, value, other) (u) = hypot((u), (value) - (other))
  fg_overall *o = &foil->overall;
  WIDEN(o->u_radius_mm, o->radius_mm, moved->overall.radius_mm);
  WIDEN(o->u_springback_error_pct, o->springback_error_pct, moved->overall.springback_error_pct);
  for (size_t b = 0; b < foil->bump_count; b++) {
    fg_bump *p = &foil->bumps[b];
    const fg_bump *q = &moved->bumps[b];
    WIDEN(p->u_radius_mm, p->radius_mm, q->radius_mm);
    WIDEN(p->u_centre_to_centre_mm, p->centre_to_centre_mm, q->centre_to_centre_mm);
    WIDEN(p->u_bump_angle_deg, p->bump_angle_deg, q->bump_angle_deg);
    WIDEN(p->u_intersection_angle_deg, p->intersection_angle_deg, q->intersection_angle_deg);
    WIDEN(p->u_height_mm, p->height_mm, q->height_mm);
    WIDEN(p->u_clearance_mm, p->clearance_mm, q->clearance_mm);
    WIDEN(p->u_clearance_error, p->clearance_error, q->clearance_error);
    WIDEN(p->u_radius_error_pct, p->radius_error_pct, q->radius_error_pct);
    WIDEN(p->u_bump_angle_error_pct, p->bump_angle_error_pct, q->bump_angle_error_pct);
    WIDEN(p->u_height_model_mm, p->height_model_mm, q->height_model_mm);
    WIDEN(p->u_bump_angle_model_deg, p->bump_angle_model_deg, q->bump_angle_model_deg);
  }
#undef WIDEN
}

static void add_disc_doubt(fg_disc *disc, const fg_disc *moved) {
  double off = moved->radius_mm - disc->radius_mm;
  disc->u_radius_mm = hypot(disc->u_radius_mm, off);
  disc->u_diameter_mm = 2 * disc->u_radius_mm;
  disc->covariance[2][2] += off * off;
}

static size_t number_count(const fg_field *field) {
  return field->row->columns + field->row->shapes;
}

/* Moves the k-th number by its uncertainty; false where it has none. */
static bool move_number(fg_field *field, size_t k) {
  size_t columns = field->row->columns;
  double u = k < columns ? field->u_amplitude_mm[k] : field->u_shape[k - columns];
  *(k < columns ? &field->amplitude_mm[k] : &field->shape[k - columns]) += u;
  return u > 0;
}

static fg_status widen_by_model(fg_context *ctx, const fg_scan_model *model,
                                const fg_measurement *m, unsigned threads,
                                fg_measurement *corrected) {
  for (size_t f = 0; f < model->fields.count; f++)
    for (size_t c = 0; c < number_count(&model->fields.fields[f]); c++) {
      fg_field_list moved = model->fields;
      fg_measurement other;
      if (!move_number(&moved.fields[f], c)) continue;
      FG_TRY(fg_scan_correct(ctx, m, &moved, NULL, 0, NULL, threads, &other));
      for (size_t k = 0; k < corrected->foil_count; k++)
        add_doubt(&corrected->foils[k], &other.foils[k]);
      for (size_t k = 0; k < corrected->disc_count; k++)
        add_disc_doubt(&corrected->discs[k], &other.discs[k]);
      fg_measurement_free(&other);
    }
  return FG_OK;
}

/* How far the foils reach (a scan without: its picture) over the model's region; 1: to its border.
 */
static double find_reach(const fg_field_frame *frame, const fg_measurement *m) {
  double reach = 0;
  for (int axis = 0; axis < 2; axis++) {
    double length = frame->high_mm[axis] - frame->low_mm[axis];
    double pixels = (double)(axis ? m->height_px : m->width_px);
    for (size_t f = 0; f < m->foil_count; f++) {
      double low = m->foils[f].place_mm[axis], high = low + m->foils[f].place_mm[2 + axis];
      reach = fmax(reach, (high - frame->low_mm[axis]) / length);
      reach = fmax(reach, (frame->high_mm[axis] - low) / length);
    }
    if (!m->foil_count) reach = fmax(reach, pixels * 25.4 / m->dpi[axis] / length);
  }
  return reach;
}

/* A curve that was found over one length says little beyond it, and nothing at twice that. */
static fg_status check_place(fg_context *ctx, const fg_scan_model *model, const fg_measurement *m,
                             char *warning) {
  static const double warned = 1.1, refused = 2;
  const fg_field_frame *frame = &model->fields.frame;
  double width = frame->high_mm[0] - frame->low_mm[0],
         height = frame->high_mm[1] - frame->low_mm[1];
  for (int axis = 0; axis < 2; axis++)
    if (fabs(m->dpi[axis] / model->dpi[axis] - 1) > 1e-4)
      return fg_fail(
          ctx, FG_ERR_DATA,
          "%s: the scan has %g dpi and the model is of a scanner at %g dpi; find a model "
          "at this resolution",
          m->scan, m->dpi[axis], model->dpi[axis]);
  double reach = find_reach(frame, m);
  if (reach > refused)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: a foil lies %.1f times as far on the glass as the %.0f x %.0f mm that the "
                   "model was found in; find a model on scans that reach as far",
                   m->scan, reach, width, height);
  if (warning && reach > warned)
    snprintf(warning, 200,
             "%.80s: the scan reaches beyond the %.0f x %.0f mm the model was found in", m->scan,
             width, height);
  return FG_OK;
}

fg_status fg_scan_model_apply(fg_context *ctx, const fg_scan_model *model, fg_measurement *m,
                              unsigned threads, char *warning) {
  if (warning) warning[0] = 0;
  FG_TRY(check_place(ctx, model, m, warning));
  fg_measurement corrected;
  FG_TRY(fg_scan_correct(ctx, m, &model->fields, NULL, 0, NULL, threads, &corrected));
  fg_status status = widen_by_model(ctx, model, m, threads, &corrected);
  if (status == FG_OK) status = fg_scan_model_widen_tie(ctx, model, m, threads, &corrected);
  if (status != FG_OK) {
    fg_measurement_free(&corrected);
    return status;
  }
  for (size_t f = 0; f < m->foil_count; f++)
    fg_foil_free(&m->foils[f]);
  for (size_t d = 0; d < m->disc_count; d++)
    fg_disc_free(&m->discs[d]);
  free(m->foils);
  free(m->discs);
  *m = corrected;
  memcpy(m->model_sha256, model->sha256, sizeof m->model_sha256);
  return FG_OK;
}
