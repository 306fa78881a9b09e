/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Correcting scans by a scanner's model. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/foil_kind.h"
#include "foilgauge/traceability.h"
#include "scan_loop/scanner_model.h"
#include "scan_loop/state.h"

/* Returns how far a box extends beyond the model's region; 1: to its border. */
static double reach_of(const fg_field_frame *frame, const double low[2], const double high[2]) {
  double reach = 0;
  for (int axis = 0; axis < 2; axis++) {
    double length = frame->high_mm[axis] - frame->low_mm[axis];
    reach = fmax(reach, (high[axis] - frame->low_mm[axis]) / length);
    reach = fmax(reach, (frame->high_mm[axis] - low[axis]) / length);
  }
  return reach;
}

static double foil_reach(const fg_field_frame *frame, const fg_foil *foil) {
  const double *place = foil->place_mm;
  return reach_of(frame, place, (double[]){place[0] + place[2], place[1] + place[3]});
}

static double disc_reach(const fg_field_frame *frame, const fg_disc *disc) {
  fg_point c = disc->centre_mm;
  double r = disc->radius_mm;
  return reach_of(frame, (double[]){c.x - r, c.y - r}, (double[]){c.x + r, c.y + r});
}

static double mark_reach(const fg_field_frame *frame, const fg_mark *mark) {
  const double at[2] = {mark->at_mm.x, mark->at_mm.y};
  return reach_of(frame, at, at);
}

/* Returns the reach of the farthest part; of a scan without parts, of its picture. */
static double find_reach(const fg_field_frame *frame, const fg_measurement *m) {
  double reach = 0;
  for (size_t f = 0; f < m->foil_count; f++)
    reach = fmax(reach, foil_reach(frame, &m->foils[f]));
  for (size_t d = 0; d < m->disc_count; d++)
    reach = fmax(reach, disc_reach(frame, &m->discs[d]));
  for (size_t k = 0; m->grid && k < m->grid->count; k++)
    reach = fmax(reach, mark_reach(frame, &m->grid->marks[k]));
  if (m->foil_count || m->disc_count || m->grid) return reach;
  double size_mm[2];
  fg_measurement_size_mm(m, size_mm);
  return reach_of(frame, frame->low_mm, size_mm);
}

/* A curve found over one length is unreliable beyond it, and meaningless at twice that. */
static const double reach_warned = 1.1, reach_refused = 2;

static fg_status check_place(fg_context *ctx, const fg_scanner_model *model,
                             const fg_measurement *m, char *warning) {
  const fg_field_frame *frame = &model->fields.frame;
  double width = frame->high_mm[0] - frame->low_mm[0],
         height = frame->high_mm[1] - frame->low_mm[1];
  double factor = fg_calibration_factor(&m->design.calibration);
  for (int axis = 0; axis < 2; axis++)
    if (fabs(m->dpi[axis] * factor / model->dpi[axis] - 1) > 1e-4)
      return fg_fail(
          ctx, FG_ERR_DATA,
          "%s: the scan has %g dpi and the model is of a scanner at %g dpi; find a model "
          "at this resolution",
          m->scan, m->dpi[axis] * factor, model->dpi[axis]);
  double reach = find_reach(frame, m);
  if (reach > reach_refused)
    return fg_fail(
        ctx, FG_ERR_DATA,
        "%s: the part lies %.1f times as far on the glass as the %.0f x %.0f mm that the "
        "model was found in; find a model on scans that reach as far",
        m->scan, reach, width, height);
  if (warning && reach > reach_warned)
    snprintf(warning, 200,
             "%.80s: the scan reaches beyond the %.0f x %.0f mm the model was found in", m->scan,
             width, height);
  return FG_OK;
}

static void flag_reach(const fg_field_frame *frame, fg_measurement *m) {
  for (size_t f = 0; f < m->foil_count; f++)
    if (foil_reach(frame, &m->foils[f]) > reach_warned)
      m->foils[f].flags |= FG_FOIL_BEYOND_MODEL_REGION;
  for (size_t d = 0; d < m->disc_count; d++)
    if (disc_reach(frame, &m->discs[d]) > reach_warned)
      m->discs[d].flags |= FG_BUMP_BEYOND_MODEL_REGION;
}

/* The larger in size. */
static void raise_max(double *max, double move) {
  if (isfinite(move) && !(fabs(move) <= fabs(*max))) *max = move;
}

/* Returns the uncertainty `added` such that sqrt(u² + added²) is the total. */
static double added(double u, double own) {
  return sqrt(fmax(0, u * u - own * own));
}

static bool is_left(const fg_correction_choice choice[FG_CORRECTED]) {
  return !fg_benefit_is_moved(choice) && choice[FG_CORRECTED_RADIUS].reason != FG_CORRECTION_NONE;
}

/* `corrected`: as measured again, before the model's uncertainty is added. */
static void sum_up_foil(const fg_foil *before, const fg_foil *corrected, fg_foil *foil) {
  const fg_foil *own = is_left(foil->choice) ? before : corrected;
  fg_correction *c = &foil->correction;
  *c = (fg_correction){NAN, NAN, NAN, NAN, NAN, NAN};
  if (foil->flags & FG_FOIL_NOT_MEASURED) return;
  c->overall_radius_mm = foil->overall.radius_mm - before->overall.radius_mm;
  c->u_overall_radius_mm = added(foil->overall.u_radius_mm, own->overall.u_radius_mm);
  if (before->bump_count != foil->bump_count) return;
  for (size_t b = 0; b < foil->bump_count; b++) {
    const fg_bump *from = &before->bumps[b], *bare = &own->bumps[b], *to = &foil->bumps[b];
    raise_max(&c->radius_mm, to->radius_mm - from->radius_mm);
    raise_max(&c->height_mm, to->height_mm - from->height_mm);
    raise_max(&c->u_radius_mm, added(to->u_radius_mm, bare->u_radius_mm));
    raise_max(&c->u_height_mm, added(to->u_height_mm, bare->u_height_mm));
  }
}

static bool is_left_disc(const fg_correction_choice *choice) {
  return !choice->moved && choice->reason != FG_CORRECTION_NONE;
}

static void sum_up_correction(const fg_measurement *before, const fg_measurement *own,
                              fg_measurement *m) {
  for (size_t f = 0; f < m->foil_count; f++)
    sum_up_foil(&before->foils[f], &own->foils[f], &m->foils[f]);
  for (size_t d = 0; d < m->disc_count; d++) {
    fg_disc *disc = &m->discs[d];
    disc->radius_correction_mm = disc->radius_mm - before->discs[d].radius_mm;
    const fg_disc *bare = is_left_disc(&disc->choice) ? &before->discs[d] : &own->discs[d];
    disc->u_radius_correction_mm = added(disc->u_radius_mm, bare->u_radius_mm);
  }
}

static void replace(fg_measurement *m, fg_measurement *corrected) {
  for (size_t f = 0; f < m->foil_count; f++)
    fg_foil_free(&m->foils[f]);
  for (size_t d = 0; d < m->disc_count; d++)
    fg_disc_free(&m->discs[d]);
  free(m->foils);
  free(m->discs);
  if (m->grid) {
    corrected->grid->corrected = true;
    corrected->grid->uncorrected_rms_um = m->grid->rms_um;
    fg_grid_free(m->grid);
    free(m->grid);
  }
  *m = *corrected;
}

/* Keeps only the model's corrections with a benefit. */
static fg_status keep_beneficial(fg_context *ctx, const fg_measurement *m,
                                 const fg_model_uncertainty *uncertainty,
                                 fg_measurement *corrected) {
  fg_benefit_decision decision, *to = &decision;
  const fg_benefit *benefit = &uncertainty->benefits.discs;
  fg_benefit_decide(&benefit, 1, &to);
  fg_benefit_keep_discs(m, benefit, &decision, corrected);
  for (size_t f = 0; f < m->foil_count; f++) {
    if (m->foils[f].flags & FG_FOIL_NOT_MEASURED) continue;
    benefit = &uncertainty->benefits.foil[f];
    fg_benefit_decide(&benefit, 1, &to);
    FG_TRY(fg_benefit_keep_foil(ctx, &(fg_benefit_foil){m, &m->foils[f], benefit, &decision},
                                &corrected->foils[f]));
  }
  return FG_OK;
}

fg_status fg_scanner_model_apply(fg_context *ctx, const fg_scanner_model *model, fg_measurement *m,
                                 unsigned threads, char *warning) {
  if (warning) warning[0] = 0;
  const char *why_not = fg_foil_traits_of(m->design.kind)->why_no_model;
  if (why_not) return fg_fail(ctx, FG_ERR_USAGE, "%s: %s", m->scan, why_not);
  FG_TRY(check_place(ctx, model, m, warning));
  FG_TRY(fg_artefact_check_due(ctx, model->path, &model->artefact, m->date));
  fg_scanner_model_trace(model, &m->design);
  FG_TRY(fg_model_tone_apply(ctx, &model->tone, threads, m));
  if (!m->warning[0]) fg_text_clip(m->warning, sizeof m->warning, "%s", m->tone_note);
  fg_measurement corrected = {0};
  fg_model_uncertainty uncertainty;
  fg_status status = FG_OK;
  FG_TRY(fg_model_uncertainty_open(ctx, model, m, threads, &uncertainty));
  FG_TRY_EXIT(fg_scan_loop_correct(ctx, m, &model->fields, threads, &corrected));
  if (!fg_field_list_is_empty(&model->fields) || model->others)
    FG_TRY_EXIT(keep_beneficial(ctx, m, &uncertainty, &corrected));
  FG_TRY_EXIT(fg_model_uncertainty_widen(ctx, &uncertainty, &corrected));
  flag_reach(&model->fields.frame, &corrected);
  sum_up_correction(m, &uncertainty.each[0], &corrected);
  replace(m, &corrected);
  memcpy(m->model_sha256, model->sha256, sizeof m->model_sha256);
  m->model = model;
exit:
  if (status != FG_OK) fg_measurement_free(&corrected);
  fg_model_uncertainty_close(&uncertainty);
  return status;
}
