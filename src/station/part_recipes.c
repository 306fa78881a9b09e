/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/part_recipes.h"

#include <stdlib.h>
#include <strings.h>

#include "core/memory.h"
#include "foilgauge/foil_kind.h"
#include "station/keep.h"

typedef struct owned_recipe {
  fg_lot_settings lot;
  fg_scanner_model *model;
  int64_t setup;
} owned_recipe;

/* Recipes of parts, in the order of the settings. */
struct fg_part_recipes {
  owned_recipe *list;
  size_t count; /* that were read */
};

static fg_status read_recipe(fg_context *ctx, const char *path, owned_recipe *recipe) {
  fg_lot_settings_default(&recipe->lot);
  FG_TRY(fg_lot_settings_load(ctx, path, &recipe->lot));
  const fg_foil_traits *kind = fg_foil_traits_of(recipe->lot.design.kind);
  if (kind->why_no_station)
    return fg_fail(ctx, FG_ERR_DATA, "%.300s: design.form is %s: %s", path, kind->name,
                   kind->why_no_station);
  if (!recipe->lot.model[0]) return FG_OK;
  return fg_scanner_model_load(ctx, recipe->lot.model, &recipe->model);
}

fg_status fg_part_recipes_open(fg_context *ctx, fg_inspection *station) {
  const fg_station_settings *settings = station->settings;
  void *block;
  if (!settings->part_count) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *station->parts, &block));
  station->parts = block;
  FG_TRY(fg_memory_allocate(ctx, settings->part_count, sizeof *station->parts->list, &block));
  station->parts->list = block;
  for (size_t i = 0; i < settings->part_count; i++) {
    station->parts->count++;
    FG_TRY(read_recipe(ctx, settings->parts[i].recipe, &station->parts->list[i]));
  }
  return FG_OK;
}

void fg_part_recipes_close(fg_inspection *station) {
  struct fg_part_recipes *parts = station->parts;
  if (!parts) return;
  for (size_t i = 0; i < parts->count; i++)
    if (parts->list[i].model) fg_scanner_model_free(parts->list[i].model);
  free(parts->list);
  free(parts);
  station->parts = NULL;
}

fg_status fg_part_recipes_keep_setups(fg_context *ctx, fg_inspection *station) {
  fg_station_database *database = &station->database;
  FG_TRY(fg_station_keep_setup(ctx, database, &station->settings->lot, &station->setup));
  for (size_t i = 0; station->parts && i < station->parts->count; i++) {
    owned_recipe *recipe = &station->parts->list[i];
    FG_TRY(fg_station_keep_setup(ctx, database, &recipe->lot, &recipe->setup));
  }
  return FG_OK;
}

static fg_part_recipe own_recipe(const fg_inspection *station) {
  return (fg_part_recipe){
      .lot = &station->settings->lot, .model = station->model, .setup = station->setup};
}

static fg_part_recipe recipe_at(const fg_inspection *station, size_t i) {
  const owned_recipe *recipe = &station->parts->list[i];
  return (fg_part_recipe){.part = station->settings->parts[i].part,
                          .lot = &recipe->lot,
                          .model = recipe->model,
                          .setup = recipe->setup};
}

fg_part_recipe fg_part_recipe_of(const fg_inspection *station, const fg_order *order) {
  for (size_t i = 0; station->parts && order->id && i < station->parts->count; i++)
    if (!strcasecmp(station->settings->parts[i].part, order->part)) return recipe_at(station, i);
  return own_recipe(station);
}

fg_part_recipe fg_part_recipe_of_setup(const fg_inspection *station, int64_t setup) {
  for (size_t i = 0; station->parts && i < station->parts->count; i++)
    if (station->parts->list[i].setup == setup) return recipe_at(station, i);
  return own_recipe(station);
}
