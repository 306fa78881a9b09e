/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Changes of the setup: a shift of the chart there may come from it. */
#include "station/trend.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

/* Changes of the setup from one foil to the next, the newest first. A foil measured again by an
 * older setup is a change, too. Recipes are long: they are read where the setup changes alone. */
static const char changes[] =
    "SELECT foil, now.program <> before.program, now.recipe <> before.recipe,"
    " now.model_sha256 IS NOT before.model_sha256"
    " FROM (SELECT foils.id AS foil, setup, lag(setup) OVER (ORDER BY foils.id) AS last"
    " FROM foils JOIN scans ON scans.id = scan WHERE foils.id BETWEEN ? AND ?) AS each"
    " JOIN setups AS now ON now.id = each.setup JOIN setups AS before ON before.id = each.last"
    " WHERE each.setup <> each.last ORDER BY foil DESC LIMIT ?";

/* The first of the drawn points that is not before the foil. */
static size_t find_point(const fg_trend *trend, int64_t foil) {
  size_t point = trend->first;
  while (point < trend->last && trend->foil[point] < foil)
    point++;
  return point;
}

void fg_trend_find_changes(sqlite3 *reader, fg_trend *trend) {
  fg_context unused;
  fg_query query;
  if (trend->choice->by_lots || trend->last <= trend->first) return;
  fg_query_begin(reader, changes, &query);
  fg_query_integer(&query, trend->foil[trend->first]);
  fg_query_integer(&query, trend->foil[trend->last]);
  fg_query_integer(&query, FG_TREND_CHANGES);
  while (fg_query_row(&query))
    trend->change[trend->changes++] =
        (fg_trend_change){.point = find_point(trend, fg_query_get_integer(&query, 0)),
                          .program = fg_query_get_integer(&query, 1),
                          .recipe = fg_query_get_integer(&query, 2),
                          .model = fg_query_get_integer(&query, 3)};
  /* A chart without these marks is better than none. */
  if (fg_query_end(&unused, &query, "reading the setups") != FG_OK) trend->changes = 0;
}

static const char recipes_between[] =
    "SELECT count(DISTINCT recipe) FROM setups WHERE id IN (SELECT setup FROM scans JOIN foils ON "
    "scans.id = scan WHERE foils.id BETWEEN ? AND ?)";
static const char other_recipe[] =
    "SELECT a.recipe <> b.recipe FROM setups AS a, setups AS b"
    " WHERE a.id = (SELECT setup FROM scans JOIN foils ON scans.id = scan WHERE foils.id = ?)"
    " AND b.id = (SELECT setup FROM scans JOIN foils ON scans.id = scan WHERE foils.id = ?)";

static int64_t number_of_two(sqlite3 *reader, const char *sql, int64_t first, int64_t second) {
  fg_context unused;
  fg_query query;
  fg_query_begin(reader, sql, &query);
  fg_query_integer(&query, first);
  fg_query_integer(&query, second);
  int64_t number = fg_query_row(&query) ? fg_query_get_integer(&query, 0) : 0;
  return fg_query_end(&unused, &query, "reading the recipes") == FG_OK ? number : 0;
}

/* Foils of other parts may lie between those of the chart. */
bool fg_trend_mixes_recipes(sqlite3 *reader, const fg_trend *trend) {
  bool mixed = false;
  if (trend->choice->by_lots || trend->count < 2 ||
      number_of_two(reader, recipes_between, trend->foil[0], trend->foil[trend->count - 1]) < 2)
    return false;
  for (size_t i = 1; i < trend->count && !mixed; i++)
    mixed = number_of_two(reader, other_recipe, trend->foil[0], trend->foil[i]) > 0;
  return mixed;
}

static fg_status parse_tolerance(fg_context *ctx, const char *recipe, fg_trend *trend) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof(fg_lot_settings), &block));
  fg_lot_settings *settings = block;
  const fg_design *design = &settings->design;
  fg_lot_settings_default(settings);
  fg_status status = fg_lot_settings_parse(ctx, "the recipe of then", recipe, settings);
  for (size_t i = 0; status == FG_OK && i < design->tolerance_count; i++) {
    if (strcmp(design->tolerances[i].quantity, trend->choice->row->name) != 0) continue;
    trend->tolerance = design->tolerances[i];
    trend->quantity.tolerance = &trend->tolerance;
  }
  free(settings);
  return status;
}

fg_status fg_trend_find_tolerance(fg_context *ctx, sqlite3 *reader, fg_trend *trend) {
  fg_context inner;
  fg_query query;
  fg_status status = FG_OK;
  if (!trend->count) return FG_OK;
  fg_query_begin(reader,
                 "SELECT recipe FROM foils JOIN scans ON scans.id = scan JOIN setups ON setups.id ="
                 " setup WHERE foils.id = ?",
                 &query);
  fg_query_integer(&query, trend->foil[trend->count - 1]);
  /* A recipe that only another program can read has no tolerance that could be drawn. */
  if (fg_query_row(&query)) status = parse_tolerance(&inner, fg_query_get_text(&query, 0), trend);
  fg_status ended = fg_query_end(ctx, &query, "reading the recipes");
  if (status == FG_ERR_MEMORY) return fg_fail(ctx, status, "%s", inner.message);
  return ended;
}
