/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A foil from its strip: arcs, uncertainties, numbers, flags, derived quantities. */
#include "foilgauge/foil.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "geometry/arc_foil.h"
#include "geometry/arc_step.h"
#include "geometry/bump_misfit.h"
#include "geometry/bump_places.h"
#include "geometry/defects.h"
#include "geometry/fillet_deviation.h"
#include "geometry/foil_kind.h"
#include "geometry/foil_uncertainty.h"
#include "geometry/labels.h"
#include "geometry/land_deviation.h"
#include "geometry/recognise.h"
#include "geometry/shadow_uncertainty.h"

/* A bump is crushed when its height or radius is off the sound ones' by this factor. */
#define CRUSHED_HEIGHT 0.6
#define CRUSHED_RADIUS 1.6
#define OUTLIER_SHARE  0.02
/* Below this many blurs of width, no plateau is left between the edges. */
#define COARSE_WIDTHS 2.0
/* Springback moves the overall radius by less than this factor, and the thickness by nothing. */
#define SCALE_FACTOR 1.2
/* Chance of lands that lie as if the scan jumped between two of them, below which they are flagged,
 * and the smallest jump: without noise the edge model itself deviates by 0.1 µm. */
#define FLAGGED_JUMP_CHANCE 1e-4
#define FLAGGED_JUMP_MM     0.0005

bool fg_foil_is_measured(const fg_foil *foil) {
  return !(foil->flags & (FG_FOIL_NOT_MEASURED | FG_FOIL_NOT_THIS_DESIGN));
}

static void set_unknown(double *values, size_t count) {
  for (size_t i = 0; i < count; i++)
    values[i] = NAN;
}

static void forget_overall(fg_overall *o) {
  *o = (fg_overall){.centre_mm = {NAN, NAN},
                    .u_centre_mm = {NAN, NAN},
                    .radius_mm = NAN,
                    .u_radius_mm = NAN,
                    .springback_error_pct = NAN,
                    .u_springback_error_pct = NAN,
                    .rms_um = NAN};
  set_unknown(o->covariance[0], 9);
}

void fg_foil_give_up(fg_foil *foil, const char *why) {
  foil->flags |= FG_FOIL_NOT_MEASURED;
  snprintf(foil->error, sizeof foil->error, "%s", why);
  foil->rotation_deg = NAN;
  foil->thickness.mm = foil->thickness.u_mm = NAN;
  foil->thickness.scan_mm = foil->thickness.u_scan_mm = foil->thickness.u_tone_mm = NAN;
  foil->noise.sd_um = foil->noise.correlation_mm = foil->noise.edge_model_um = NAN;
  foil->correction = (fg_correction){NAN, NAN, NAN, NAN, NAN, NAN};
  foil->arc = (fg_foil_arc){NAN, NAN, NAN, NAN, NAN, NAN};
  forget_overall(&foil->overall);
}

/* Of a bump without a circle: the direction of the middle of its stretch of the strip. */
static double stretch_position_deg(const fg_foil *foil, fg_range range) {
  double x = 0, y = 0;
  for (size_t k = range.first; k <= range.last; k++) {
    const fg_station *s = &foil->strip.stations[k];
    double dx = (s->left.x + s->right.x) / 2 - foil->overall.centre_mm.x;
    double dy = (s->left.y + s->right.y) / 2 - foil->overall.centre_mm.y;
    if (!isfinite(dx + dy)) continue;
    x += dx;
    y += dy;
  }
  return atan2(y, x) * 180 / M_PI;
}

static void fill_bump(const fg_layout *layout, size_t i, const fg_design *design,
                      const fg_nominal *nominal, fg_foil *foil, fg_bump *bump) {
  const fg_arc *arc = &layout->bumps[i];
  const fg_station *stations = foil->strip.stations;
  bump->arc_start_mm = stations[arc->ranges[0].first].s_mm;
  bump->arc_end_mm = stations[arc->ranges[0].last].s_mm;
  bump->centre_mm = (fg_point){arc->circle.x, arc->circle.y};
  bump->radius_mm = arc->circle.radius;
  memcpy(bump->covariance, arc->covariance, sizeof bump->covariance);
  if (!layout->fitted[i]) {
    bump->flags |= FG_BUMP_NOT_FITTED;
    bump->radius_mm = bump->centre_mm.x = bump->centre_mm.y = NAN;
    set_unknown(bump->covariance[0], 9);
  }
  for (int k = 0; k < 2; k++)
    bump->u_centre_mm[k] = sqrt(bump->covariance[k][k]);
  bump->u_radius_mm = sqrt(bump->covariance[2][2]);
  bump->rms_um = layout->fitted[i] ? 1000 * arc->rms_mm : NAN;
  bump->points = arc->points;
  if ((double)arc->outliers > OUTLIER_SHARE * (double)arc->points) bump->flags |= FG_BUMP_OUTLIERS;
  bump->flags |= fg_defect_flags(layout, i);
  if (layout->fitted[i] && fg_arc_step_is_flagged(arc)) bump->flags |= FG_BUMP_POOR_FIT;
  const fg_thickness strip = fg_foil_thickness(design, foil);
  fg_bump_derive(design, nominal, &foil->overall, &strip, bump);
  if (!layout->fitted[i]) bump->position_deg = stretch_position_deg(foil, arc->ranges[0]);
}

static void add_shadows(const fg_layout *layout, const fg_design *design, const fg_nominal *nominal,
                        fg_foil *foil) {
  fg_arc_shadow lands, own;
  fg_arc_find_shadow(&layout->line, &layout->overall, &lands);
  for (size_t i = 0; lands.count && i < foil->bump_count; i++) {
    if (!layout->fitted[i]) continue;
    fg_arc_find_shadow(&layout->line, &layout->bumps[i], &own);
    fg_bump_add_shadow(&own, &lands, design, nominal, &foil->overall, &foil->bumps[i]);
  }
}

static double median_of(fg_context *ctx, const fg_foil *foil, double (*get)(const fg_bump *)) {
  double *values = NULL, median = NAN;
  size_t n = 0;
  if (fg_memory_allocate(ctx, foil->bump_count, sizeof *values, (void **)&values) != FG_OK)
    return NAN;
  for (size_t i = 0; i < foil->bump_count; i++)
    if (isfinite(get(&foil->bumps[i]))) values[n++] = get(&foil->bumps[i]);
  if (n) median = fg_select(values, n, n / 2);
  free(values);
  return median;
}

static double get_height(const fg_bump *b) {
  return b->height_mm;
}
static double get_radius(const fg_bump *b) {
  return b->radius_mm;
}
static bool is_beyond(double value, double reference, double factor) {
  return value > factor * reference || value < reference / factor;
}

/* Bumps are held against their median, the design after the foil's springback; a median
 * that is itself far off the design is that of crushed bumps, and no reference. */
static void flag_bumps(fg_context *ctx, const fg_layout *layout, const fg_design *design,
                       const fg_nominal *nominal, fg_foil *foil) {
  double height = median_of(ctx, foil, get_height), radius = median_of(ctx, foil, get_radius);
  if (height < CRUSHED_HEIGHT * nominal->height_mm ||
      is_beyond(radius, design->bumps.radius_mm, CRUSHED_RADIUS)) {
    height = nominal->height_mm;
    radius = design->bumps.radius_mm;
  }
  double rms_max = 1000 * fg_misfit_rms_limit(ctx, layout);
  for (size_t i = 0; i < foil->bump_count; i++) {
    fg_bump *b = &foil->bumps[i];
    if (b->height_mm < CRUSHED_HEIGHT * height || is_beyond(b->radius_mm, radius, CRUSHED_RADIUS))
      b->flags |= FG_BUMP_CRUSHED;
    if (b->rms_um > rms_max) b->flags |= FG_BUMP_POOR_FIT;
  }
}

/* Puts the bumps into order from the lip, without one: clockwise as seen. */
static void order_bumps(const fg_layout *layout, fg_foil *foil) {
  size_t n = foil->bump_count;
  double turn =
      n > 1 ? fg_places_turn(foil->bumps[0].position_deg, foil->bumps[1].position_deg) : 0;
  if (n == 1) turn = layout->turning.sense > 0 ? -1 : 1;
  bool reversed = layout->turning.lip_last && !layout->turning.lip_first;
  if (!layout->turning.lip_first && !layout->turning.lip_last) {
    foil->flags |= FG_FOIL_NO_LIP;
    reversed = turn < 0;
  }
  foil->orientation = (turn > 0) != reversed ? FG_CLOCKWISE : FG_COUNTERCLOCKWISE;
  for (size_t i = 0; reversed && i < n / 2; i++) {
    fg_bump swap = foil->bumps[i];
    foil->bumps[i] = foil->bumps[n - 1 - i];
    foil->bumps[n - 1 - i] = swap;
  }
}

/* Bumps of a foil whose line may have gone over to another's may belong to either. */
static void flag_mixed_bumps(fg_foil *foil) {
  if (!(foil->flags & FG_FOIL_TOUCHES_OTHER) || !(foil->flags & FG_FOIL_BUMP_COUNT)) return;
  for (size_t i = 0; i < foil->bump_count; i++)
    foil->bumps[i].flags |= FG_BUMP_TOUCHES_OTHER;
}

static void find_rotation(fg_foil *foil) {
  double c = 0, s = 0;
  for (size_t i = 0; i < foil->bump_count; i++) {
    c += cos(foil->bumps[i].position_deg * M_PI / 180);
    s += sin(foil->bumps[i].position_deg * M_PI / 180);
  }
  foil->rotation_deg = atan2(s, c) * 180 / M_PI;
}

static void take_over_facts(fg_foil *foil) {
  static const unsigned pairs[][2] = {
      {FG_STRIP_TOUCHES_BORDER, FG_FOIL_TOUCHES_BORDER},
      {FG_STRIP_TOUCHES_OTHER, FG_FOIL_TOUCHES_OTHER},
      {FG_STRIP_CLIPPED, FG_FOIL_CLIPPED},
      {FG_STRIP_SIDE_BAND, FG_FOIL_SIDE_BAND},
      {FG_STRIP_GAP, FG_FOIL_GAP},
  };
  for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++)
    if (foil->strip.facts & pairs[i][0]) foil->flags |= pairs[i][1];
  if (foil->strip.loss_um > 0) foil->flags |= FG_FOIL_LOSSY;
}

fg_status fg_foil_fill_bumps(fg_context *ctx, const fg_design *design, fg_layout *layout,
                             fg_foil *foil) {
  fg_nominal nominal;
  FG_TRY(fg_design_derive(ctx, design, &nominal));
  size_t n = layout->turning.bump_count;
  FG_TRY(fg_foil_find_uncertainties(ctx, layout, design, foil));
  fg_foil_find_thickness(design, foil);
  fg_layout_overall(layout, design, &foil->overall);
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *foil->bumps, (void **)&foil->bumps));
  foil->bump_count = n;
  for (size_t i = 0; i < n; i++)
    fill_bump(layout, i, design, &nominal, foil, &foil->bumps[i]);
  add_shadows(layout, design, &nominal, foil);
  fg_arc_add_shadow(&layout->line, &layout->overall);
  fg_layout_overall(layout, design, &foil->overall);
  order_bumps(layout, foil);
  fg_places_number(layout, design, &nominal, foil);
  flag_bumps(ctx, layout, design, &nominal, foil);
  fg_foil_recognise(design, foil);
  flag_mixed_bumps(foil);
  find_rotation(foil);
  if (layout->land_count < 3) foil->flags |= FG_FOIL_FEW_LANDS;
  bool land, fillet;
  FG_TRY(fg_land_deviation_find(ctx, layout, &land));
  FG_TRY(fg_fillet_deviation_find(ctx, design, layout, &fillet));
  const fg_land_step jump = layout->land_step;
  bool step = jump.chance < FLAGGED_JUMP_CHANCE && jump.jump_mm > FLAGGED_JUMP_MM;
  if (land || fillet || step || layout->land_displaced) foil->flags |= FG_FOIL_LAND_DEVIATES;
  return fg_labels_fill(ctx, layout, design->datum, foil);
}

/* A plain strip that was taken for a foil with bumps: the design is wrong, not the scan. */
static fg_status hint_at_arc(fg_context *ctx, const fg_design *design, const fg_strip *strip,
                             const char **error) {
  fg_layout plain;
  unsigned flags = 0;
  const char *why;
  FG_TRY(fg_arc_foil_layout(ctx, design, strip, &plain, &flags, &why));
  if (!why && !(flags & FG_FOIL_BUMPS_ON_ARC))
    *error = "it is a plain strip without bumps; its design needs \"form\": \"arc\" (--design)";
  fg_layout_free(&plain);
  return FG_OK;
}

fg_status fg_foil_lay_out_bumps(fg_context *ctx, const fg_design *design, unsigned threads,
                                fg_foil *foil, fg_layout *layout, const char **error) {
  FG_TRY(fg_layout_find(ctx, design, &foil->strip, threads, layout, error));
  if (!*error) return FG_OK;
  fg_status status = hint_at_arc(ctx, design, &foil->strip, error);
  if (status != FG_OK) fg_layout_free(layout);
  return status;
}

/* A foil that is the design's in shape but not in size was scanned at another resolution than was
 * said; every number would be wrong by the same factor. */
static bool is_off_scale(const fg_design *design, const fg_layout *layout, const fg_strip *strip,
                         double *factor) {
  *factor = layout->overall.circle.radius / design->overall_radius_mm;
  double rest = strip->thickness_mm / design->thickness_mm / *factor;
  return fabs(log(*factor)) > log(SCALE_FACTOR) && fabs(log(rest)) < log(SCALE_FACTOR);
}

fg_status fg_foil_measure(fg_context *ctx, const fg_design *design, unsigned threads,
                          fg_foil *foil) {
  const fg_foil_row *kind = fg_foil_row_of(design->kind);
  fg_layout layout;
  const char *error;
  foil->thickness.mm = foil->thickness.scan_mm = foil->strip.thickness_mm;
  foil->thickness.u_mm = foil->thickness.u_scan_mm = foil->strip.u_thickness_mm;
  foil->correction = (fg_correction){NAN, NAN, NAN, NAN, NAN, NAN};
  foil->arc = (fg_foil_arc){NAN, NAN, NAN, NAN, NAN, NAN};
  take_over_facts(foil);
  if (fg_strip_widths_in_blurs(&foil->strip) < COARSE_WIDTHS)
    foil->flags |= FG_FOIL_COARSE_RESOLUTION;
  FG_TRY(kind->lay_out(ctx, design, threads, foil, &layout, &error));
  fg_status status = FG_OK;
  double factor;
  if (error) {
    fg_foil_give_up(foil, error);
  } else if (is_off_scale(design, &layout, &foil->strip, &factor)) {
    char why[sizeof foil->error];
    snprintf(why, sizeof why,
             "thickness and overall radius are %.3g times the design's: the resolution of the scan "
             "(--dpi) or the design (--design) is wrong",
             factor);
    fg_foil_give_up(foil, why);
  } else {
    status = kind->fill(ctx, design, &layout, foil);
  }
  fg_layout_free(&layout);
  return status;
}

void fg_foil_free(fg_foil *foil) {
  if (!foil) return;
  for (size_t i = 0; i < foil->beam_count; i++)
    fg_beam_free(&foil->beams[i]);
  free(foil->beams);
  free(foil->bumps);
  free(foil->labels);
  fg_strip_free(&foil->strip);
  memset(foil, 0, sizeof *foil);
}

void fg_beam_free(fg_beam *beam) {
  if (!beam) return;
  for (size_t i = 0; i < FG_BEAM_SIDES; i++)
    free(beam->edges[i].stations);
  memset(beam, 0, sizeof *beam);
}

void fg_disc_free(fg_disc *disc) {
  if (!disc) return;
  free(disc->edge);
  free(disc->residual_um);
  free(disc->stations);
  memset(disc, 0, sizeof *disc);
}

void fg_measurement_size_mm(const fg_measurement *measurement, double size_mm[2]) {
  size_mm[0] = (double)measurement->file.width_px * 25.4 / measurement->dpi[0];
  size_mm[1] = (double)measurement->file.height_px * 25.4 / measurement->dpi[1];
}

void fg_measurement_free(fg_measurement *measurement) {
  if (!measurement) return;
  for (size_t i = 0; i < measurement->foil_count; i++)
    fg_foil_free(&measurement->foils[i]);
  for (size_t i = 0; i < measurement->disc_count; i++)
    fg_disc_free(&measurement->discs[i]);
  free(measurement->foils);
  free(measurement->discs);
  fg_grid_free(measurement->grid);
  free(measurement->grid);
  memset(measurement, 0, sizeof *measurement);
}
