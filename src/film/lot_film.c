/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "film/lot_film.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/text.h"
#include "film/stock.h"

/* Stiffness of the stock's bumps over the design's. The analysis has that of all bumps of all
 * foils, one after the other. */
static void fill_stiffness(const fg_lot_analysis *analysis, fg_film_stock *stock) {
  const double *normalised = analysis->stiffness.normalised;
  size_t at = 0, foil_at = 0;
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const fg_foil *foil = analysis->foils[i].foil;
    bool taken = analysis->assembly.reason[i] == FG_LOT_IN_STOCK;
    for (size_t k = 0; k < foil->bump_count; k++, at++) {
      double place = foil->bumps[k].number - (double)analysis->layout.first_bump;
      if (!taken || !(place >= 0 && place < (double)stock->places)) continue;
      double ratio = normalised ? normalised[at] : NAN;
      stock->stiffness[foil_at * stock->places + (size_t)place] = ratio > 0 ? ratio : 1;
    }
    foil_at += taken;
  }
}

/* The foils that the lot's assembly draws from. */
static fg_status take_stock(fg_context *ctx, const fg_lot_analysis *analysis,
                            fg_film_stock *stock) {
  const fg_stock *from = &analysis->assembly.stock;
  size_t numbers = from->foils * from->places;
  *stock = (fg_film_stock){
      .foils = from->foils, .places = from->places, .left_out = analysis->foil_count - from->foils};
  FG_TRY(fg_memory_allocate(ctx, numbers, sizeof(double), (void **)&stock->clearance_mm));
  FG_TRY(fg_memory_allocate(ctx, numbers, sizeof(double), (void **)&stock->stiffness));
  memcpy(stock->clearance_mm, from->clearance_mm, numbers * sizeof(double));
  for (size_t k = 0; k < numbers; k++)
    stock->stiffness[k] = 1;
  fill_stiffness(analysis, stock);
  return FG_OK;
}

static fg_film_options options_of(const fg_lot_analysis *analysis, const fg_film_stock *stock) {
  const fg_lot_settings *settings = &analysis->lot->settings;
  fg_film_options options = fg_film_options_default();
  options.load_n = settings->film.load_n;
  options.load_deg = settings->film.load_deg;
  options.speed_rpm = settings->film.speed_rpm;
  if (settings->film.rotor_mass_kg > 0) options.rotor_mass_kg = settings->film.rotor_mass_kg;
  options.loss_factor = settings->film.loss_factor;
  options.within_pct = settings->film.within_pct;
  options.draw.count = settings->film.bearings;
  options.seed = settings->film.seed;
  options.cells_per_bump = settings->film.cells_per_bump;
  options.cells_axial = settings->film.cells_axial;
  options.material = settings->material;
  options.pads = analysis->layout.pads;
  options.bumps_per_pad = analysis->layout.bumps_per_pad;
  options.first_bump = analysis->layout.first_bump;
  options.pitch_deg = analysis->layout.pitch_deg;
  options.jobs = settings->jobs;
  options.stock = stock;
  return options;
}

static fg_status run_lot_film(fg_context *ctx, fg_lot_analysis *analysis,
                              const fg_film_stock *stock) {
  fg_context inner = {.message = ""};
  fg_film_options options = options_of(analysis, stock);
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *analysis->film, (void **)&analysis->film));
  fg_status status = fg_film_run(&inner, &analysis->lot->settings.design, &options, analysis->film);
  analysis->film->options.stock = NULL; /* it ends before the report does */
  if (status == FG_OK) return FG_OK;
  fg_lot_film_free(analysis);
  if (status == FG_ERR_MEMORY) return fg_fail(ctx, status, "%s", inner.message);
  fg_text_clip(analysis->film_why, sizeof analysis->film_why, "%s", inner.message);
  return FG_OK;
}

fg_status fg_lot_film_find(fg_context *ctx, fg_lot_analysis *analysis) {
  fg_film_stock stock = {0};
  const fg_lot_assembly *assembly = &analysis->assembly;
  if (!(analysis->lot->settings.film.load_n > 0)) return FG_OK;
  if (!assembly->asked || assembly->why[0]) {
    fg_text_clip(analysis->film_why, sizeof analysis->film_why, "%s",
                 assembly->why[0] ? assembly->why : "the recipe's assembly draws no bearings");
    return FG_OK;
  }
  fg_status status = take_stock(ctx, analysis, &stock);
  if (status == FG_OK) status = run_lot_film(ctx, analysis, &stock);
  fg_film_stock_free(&stock);
  return status;
}

void fg_lot_film_free(fg_lot_analysis *analysis) {
  if (analysis->film) fg_film_report_free(analysis->film);
  free(analysis->film);
  analysis->film = NULL;
}
