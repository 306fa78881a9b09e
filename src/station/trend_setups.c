/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Changes of the setup: a shift of the chart there may come from it. */
#include "station/trend.h"

/* Changes of the setup from one foil to the next, the newest first. A foil measured again by an
 * older setup is a change, too. */
static const char changes[] =
    "SELECT id, program <> last_program, recipe <> last_recipe, coalesce(model_sha256, '') <> "
    "last_model FROM (SELECT foils.id AS id, setups.id AS setup, program, recipe, model_sha256,"
    " lag(setups.id) OVER each AS last, lag(program) OVER each AS last_program,"
    " lag(recipe) OVER each AS last_recipe, lag(coalesce(model_sha256, '')) OVER each AS last_model"
    " FROM foils JOIN scans ON scans.id = scan JOIN setups ON setups.id = setup"
    " WHERE foils.id BETWEEN ? AND ? WINDOW each AS (ORDER BY foils.id))"
    " WHERE setup <> last ORDER BY id DESC LIMIT ?";

/* The first of the drawn points that is not before the foil. */
static size_t find_point(const fg_trend *trend, int64_t foil) {
  size_t point = trend->first;
  while (point < trend->last && trend->foil[point] < foil)
    point++;
  return point;
}

size_t fg_trend_changes(sqlite3 *reader, const fg_trend *trend,
                        fg_trend_change change[FG_TREND_CHANGES]) {
  fg_context unused;
  fg_query query;
  size_t count = 0;
  if (trend->choice->by_lots || trend->last <= trend->first) return 0;
  fg_query_begin(reader, changes, &query);
  fg_query_integer(&query, trend->foil[trend->first]);
  fg_query_integer(&query, trend->foil[trend->last]);
  fg_query_integer(&query, FG_TREND_CHANGES);
  while (fg_query_row(&query))
    change[count++] = (fg_trend_change){.point = find_point(trend, fg_query_get_integer(&query, 0)),
                                        .program = fg_query_get_integer(&query, 1),
                                        .recipe = fg_query_get_integer(&query, 2),
                                        .model = fg_query_get_integer(&query, 3)};
  /* A chart without these marks is better than none. */
  return fg_query_end(&unused, &query, "reading the setups") == FG_OK ? count : 0;
}
