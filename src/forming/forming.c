/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A strip from bent to free: the section of every piece, the resulting strip, its circles. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "core/text.h"
#include "forming/forming.h"
#include "forming/section.h"
#include "forming/strip.h"
#include "quantity/quantity_rows.h"

enum { LAYERS = 200, STEPS = 200, MAX = 100000 };

/* ---- one curvature ---- */

static void take_section(const fg_forming *forming, fg_section *section, fg_forming_piece *piece,
                         bool *yields_back) {
  const fg_forming_material *material = &forming->material;
  const fg_forming_schedule *schedule = &forming->schedule;
  double side = piece->curvature_die < 0 ? -1 : 1;
  double hot = schedule->count ? schedule->temperature_C[schedule->count - 1] : FG_FORMING_COLD_C;
  fg_section_bend(material, piece->curvature_die, section);
  double stiffness = fg_section_stiffness(material, section);
  double bent = fg_section_moment(material, FG_FORMING_COLD_C, section);
  piece->stress_mpa[FG_FORMING_BENT] =
      side * fg_section_face_stress(material, FG_FORMING_COLD_C, section);
  fg_section_treat(material, schedule, forming->options.steps, section);
  double left = fg_section_moment(material, FG_FORMING_COLD_C, section);
  double change = left / stiffness;
  piece->moment_n = side * bent;
  piece->share = bent > 0 ? left / bent : 0;
  piece->curvature = piece->curvature_die - side * change;
  piece->stress_mpa[FG_FORMING_HEATED] = side * fg_section_face_stress(material, hot, section);
  piece->stress_mpa[FG_FORMING_FREE] =
      side *
      (fg_section_face_stress(material, FG_FORMING_COLD_C, section) -
       fg_section_plane_modulus(material, FG_FORMING_COLD_C) * change * section->thickness_mm / 2);
  *yields_back = *yields_back || fg_section_yields_back(material, change, section);
}

/* Finds an earlier piece of the same curvature, which has the same section: at the same place of an
 * earlier pitch, or in this one. */
static const fg_forming_piece *find_duplicate(const fg_forming *forming, size_t at) {
  for (size_t i = 0; i < at; i++)
    if (forming->pieces[i].curvature_die == forming->pieces[at].curvature_die)
      return &forming->pieces[i];
  return NULL;
}

static fg_status bend_all(fg_context *ctx, fg_forming *forming) {
  fg_section section;
  FG_TRY(fg_section_make(ctx, forming->design.thickness_mm, forming->options.layers, &section));
  for (size_t i = 0; i < forming->count; i++) {
    fg_forming_piece *piece = &forming->pieces[i];
    const fg_forming_piece *duplicate = find_duplicate(forming, i);
    if (!duplicate) {
      take_section(forming, &section, piece, &forming->yields_back);
      continue;
    }
    piece->curvature = duplicate->curvature;
    piece->moment_n = duplicate->moment_n;
    piece->share = duplicate->share;
    memcpy(piece->stress_mpa, duplicate->stress_mpa, sizeof piece->stress_mpa);
  }
  fg_section_free(&section);
  return FG_OK;
}

/* ---- the whole strip ---- */

static double opened_pct(const fg_design *design, double radius_mm) {
  return 100 * (design->overall_radius_mm - radius_mm) / design->overall_radius_mm;
}

/* Each pitch turns the strip by an angle about one centre: its chord gives the radius on which the
 * lands' middles lie. */
/* A strip that has become straight has no radius, and no rounding makes one. */
static const double straight = 1e4; /* times the design's */

static double radius_of(const fg_forming *forming, double radius_mm) {
  return radius_mm > 0 && radius_mm < straight * forming->design.overall_radius_mm ? radius_mm
                                                                                   : NAN;
}

static void find_overall(fg_forming *forming) {
  fg_forming_pitch die = fg_forming_pitch_of(forming, true);
  fg_forming_pitch free_pitch = fg_forming_pitch_of(forming, false);
  double in =
      1 / forming->pieces[0].curvature_die -
      (forming->options.die ? forming->die.overall_radius_mm : forming->design.overall_radius_mm);
  forming->turn_die_deg = die.turn_rad * 180 / M_PI;
  forming->turn_deg = free_pitch.turn_rad * 180 / M_PI;
  bool closes = free_pitch.turn_rad > 1e-9 && free_pitch.turn_rad < 2 * M_PI;
  forming->overall_radius_mm =
      closes ? free_pitch.chord_mm / (2 * sin(free_pitch.turn_rad / 2)) - in : NAN;
  /* A plain strip may turn by more than half a circle: its curvature gives the radius. */
  if (!forming->bump_count)
    forming->overall_radius_mm = radius_of(forming, 1 / forming->pieces[0].curvature - in);
  forming->springback_error_pct = opened_pct(&forming->design, forming->overall_radius_mm);
  forming->strip_radius_mm = radius_of(forming, 1 / forming->pieces[0].curvature - in);
  forming->strip_springback_error_pct = opened_pct(&forming->design, forming->strip_radius_mm);
}

static void find_mean_radii(fg_forming *forming) {
  for (size_t i = 0; i < forming->count; i++) {
    const fg_forming_piece *piece = &forming->pieces[i];
    double weight = piece->length_mm / forming->length_mm;
    forming->mean_share += weight * piece->share;
    for (int s = 0; s < FG_FORMING_STATES; s++) {
      double size = fabs(piece->stress_mpa[s]);
      forming->mean_stress_mpa[s] += weight * size;
      forming->largest_stress_mpa[s] = fmax(forming->largest_stress_mpa[s], size);
    }
  }
}

/* ---- the circles ---- */

/* Returns the bump whose piece contains the middle of an arc. */
static fg_forming_bump *bump_at(fg_forming *forming, const fg_bump *fitted) {
  double s = 0.5 * (fitted->arc_start_mm + fitted->arc_end_mm);
  for (size_t i = 0; i < forming->count; i++) {
    const fg_forming_piece *piece = &forming->pieces[i];
    if (s >= piece->start_mm && s <= piece->start_mm + piece->length_mm)
      return piece->kind == FG_ARC_BUMP ? &forming->bumps[piece->number - 1] : NULL;
  }
  return NULL;
}

/* Nothing is known of it. */
static void clear_bump(fg_bump *bump) {
  size_t count;
  const fg_quantity *rows = fg_quantities(FG_QUANTITY_OF_BUMP, &count);
  double unknown[FG_QUANTITY_NUMBERS_MAX] = {NAN, NAN, NAN, NAN};
  for (size_t i = 0; i < count; i++)
    if (rows[i].kind != FG_QUANTITY_COUNT) fg_quantity_restore(&rows[i], bump, unknown);
}

static fg_status fit_circles(fg_context *ctx, fg_forming *forming) {
  FG_TRY(fg_forming_draw(ctx, forming, false, &forming->foil.strip));
  FG_TRY(fg_foil_measure(ctx, &forming->design, 1, &forming->foil));
  size_t found = 0;
  for (size_t i = 0; i < forming->foil.bump_count; i++) {
    fg_bump *fitted = &forming->foil.bumps[i];
    fg_forming_bump *bump = bump_at(forming, fitted);
    if (!bump || !isfinite(fitted->radius_mm)) continue;
    fitted->number = bump->number;
    bump->fitted = *fitted;
    found++;
  }
  forming->fitted = !(forming->foil.flags & FG_FOIL_NOT_MEASURED) && found == forming->bump_count;
  return FG_OK;
}

/* The bumps of a sine are no arcs of the design's radius: the die has the circles that are fitted
 * to its shape as to the free strip's. */
static fg_status fit_sine(fg_context *ctx, fg_forming *forming) {
  fg_foil die = {.number = 0};
  fg_status status = fg_forming_draw(ctx, forming, true, &die.strip);
  if (status == FG_OK) status = fg_foil_measure(ctx, &forming->design, 1, &die);
  for (size_t i = 0; i < forming->bump_count; i++)
    forming->bumps[i].die_radius_mm = forming->bumps[i].die_angle_deg = NAN;
  for (size_t i = 0; status == FG_OK && i < die.bump_count; i++) {
    fg_forming_bump *bump = bump_at(forming, &die.bumps[i]);
    if (!bump) continue;
    bump->die_radius_mm = die.bumps[i].radius_mm;
    bump->die_angle_deg = die.bumps[i].bump_angle_deg;
  }
  fg_foil_free(&die);
  return status;
}

static void find_crowns(fg_forming *forming) {
  for (size_t i = 0; i < forming->bump_count; i++)
    forming->bumps[i].curvature_radius_mm = NAN;
  for (size_t i = 0; i < forming->count; i++) {
    const fg_forming_piece *piece = &forming->pieces[i];
    if (piece->kind != FG_ARC_BUMP) continue;
    fg_forming_bump *bump = &forming->bumps[piece->number - 1];
    double radius = -1 / piece->curvature;
    /* Of a sine the crown has the sharpest of all. */
    bool sharper = !(bump->curvature_radius_mm > 0) || radius < bump->curvature_radius_mm;
    if (radius > 0 && sharper) bump->curvature_radius_mm = radius;
  }
}

fg_status fg_forming_too_hot(fg_context *ctx, const char *where,
                             const fg_forming_material *material, double temperature_C) {
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s%g degrees C is beyond the material's yield_curve, which ends at %g; is the "
                 "temperature in degrees Celsius?",
                 where, temperature_C, material->curve_temperature_C[material->curve_count - 1]);
}

static fg_status check_schedule(fg_context *ctx, const fg_forming_material *material,
                                const fg_forming_schedule *schedule) {
  for (size_t i = 0; i < schedule->count; i++)
    if (!isfinite(fg_section_yield_share(material, schedule->temperature_C[i]))) {
      char where[600] = "";
      if (schedule->file.path[0])
        fg_text_clip(where, sizeof where, "%s: row %zu: temperature_C: ", schedule->file.path,
                     i + 1);
      return fg_forming_too_hot(ctx, where, material, schedule->temperature_C[i]);
    }
  return FG_OK;
}

static fg_status copy_schedule(fg_context *ctx, const fg_forming_schedule *from,
                               fg_forming_schedule *to) {
  *to = (fg_forming_schedule){0};
  if (!from || !from->count) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, 2 * from->count, sizeof *to->time_h, (void **)&to->time_h));
  to->temperature_C = to->time_h + from->count;
  to->count = from->count;
  to->file = from->file;
  memcpy(to->time_h, from->time_h, from->count * sizeof *to->time_h);
  memcpy(to->temperature_C, from->temperature_C, from->count * sizeof *to->time_h);
  return FG_OK;
}

static fg_status set_options(fg_context *ctx, const fg_forming_options *options,
                             fg_forming *forming) {
  if (options) forming->options = *options;
  fg_forming_options *own = &forming->options;
  if (!own->layers) own->layers = LAYERS;
  if (!own->steps) own->steps = STEPS;
  if (own->layers > MAX || own->steps > MAX)
    return fg_fail(ctx, FG_ERR_USAGE, "%zu layers and %zu steps: at most %d of each", own->layers,
                   own->steps, MAX);
  if (own->die) {
    forming->die = *own->die;
    own->die = &forming->die;
  }
  return FG_OK;
}

fg_status fg_forming_bend(fg_context *ctx, const fg_design *design,
                          const fg_forming_material *material, const fg_forming_schedule *schedule,
                          const fg_forming_options *options, fg_forming *forming) {
  fg_numerics_start();
  *forming = (fg_forming){.design = *design, .material = *material};
  FG_TRY(set_options(ctx, options, forming));
  FG_TRY(fg_design_derive(ctx, design, &forming->nominal));
  FG_TRY(fg_forming_material_check(ctx, material));
  FG_TRY(copy_schedule(ctx, schedule, &forming->schedule));
  FG_TRY(check_schedule(ctx, material, &forming->schedule));
  FG_TRY(fg_forming_lay_out(ctx, forming));
  FG_TRY(bend_all(ctx, forming));
  find_overall(forming);
  find_mean_radii(forming);
  find_crowns(forming);
  return FG_OK;
}

fg_status fg_forming_run(fg_context *ctx, const fg_design *design,
                         const fg_forming_material *material, const fg_forming_schedule *schedule,
                         const fg_forming_options *options, fg_forming *forming) {
  fg_status status = fg_forming_bend(ctx, design, material, schedule, options, forming);
  for (size_t i = 0; status == FG_OK && i < forming->bump_count; i++)
    clear_bump(&forming->bumps[i].fitted);
  if (status == FG_OK && forming->bump_count) status = fit_circles(ctx, forming);
  if (status == FG_OK && forming->bump_count && forming->options.shape == FG_FORMING_SINE)
    status = fit_sine(ctx, forming);
  if (status != FG_OK) fg_forming_free(forming);
  return status;
}

void fg_forming_free(fg_forming *forming) {
  fg_forming_schedule_free(&forming->schedule);
  free(forming->pieces);
  free(forming->bumps);
  fg_foil_free(&forming->foil);
  *forming = (fg_forming){0};
}
