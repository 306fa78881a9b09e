/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/trend.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "foilgauge/traceability.h"
#include "quantity/quantity_rows.h"
#include "station/cause_keep.h"

/* Values as they are read: one more of the point before, or the first of another. */
typedef struct filling {
  size_t values, value_room, points, size_room, foil_room;
  int64_t last_point;
} filling;

static fg_status add_value(fg_context *ctx, fg_trend *trend, filling *at, int64_t point,
                           int64_t foil, double value) {
  fg_lot_quantity *quantity = &trend->quantity;
  void *block = quantity->value;
  FG_TRY(fg_memory_reserve(ctx, at->values + 1, sizeof value, &at->value_room, &block));
  quantity->value = block;
  quantity->value[at->values++] = value;
  if (at->points && at->last_point == point) {
    quantity->size[at->points - 1]++;
    return FG_OK;
  }
  at->last_point = point;
  block = quantity->size;
  FG_TRY(fg_memory_reserve(ctx, at->points + 1, sizeof *quantity->size, &at->size_room, &block));
  quantity->size = block;
  block = trend->foil;
  FG_TRY(fg_memory_reserve(ctx, at->points + 1, sizeof foil, &at->foil_room, &block));
  trend->foil = block;
  quantity->size[at->points] = 1;
  trend->foil[at->points++] = foil;
  return FG_OK;
}

static void bind(fg_query *query, int64_t quantity, const fg_trend_choice *choice) {
  fg_query_integer(query, quantity);
  fg_query_integer(query, choice->bump);
  fg_query_text(query, choice->lot);
  fg_query_text(query, choice->die);
}

/* Values of a quantity, foil by foil. Crushed bumps are left out of charts, as of a lot's
 * statistics: they show damage, not the process. */
#define CHOSEN                                                                                     \
  " quantity = ?1 AND value IS NOT NULL AND (?2 = 0 OR bump = ?2) AND (measured.foil, bump) NOT "  \
  "IN (SELECT foil, number FROM bumps WHERE flags <> '' AND instr(flags, 'crushed'))"
#define NAMED " (?3 = '' OR foils.lot = ?3) AND (?4 = '' OR foils.die = ?4)"

/* A foil that is scanned again is no further foil: its newest scan counts. */
static const char of_foils[] =
    "SELECT foils.id, foils.id, value, u FROM foils CROSS JOIN measured ON measured.foil = foils.id"
    " WHERE" CHOSEN " AND" NAMED " AND" FG_NEWEST_SCAN_OF_FOIL " ORDER BY foils.id, bump";
/* A lot's values are the means of its foils, of all scans that show a foil: it was made once. Lots
 * come in the order of their first foil. */
static const char of_lots[] =
    "WITH mean AS (SELECT measured.foil AS foil, avg(value) AS value FROM measured WHERE" CHOSEN
    " GROUP BY measured.foil), first AS (SELECT lot, min(id) AS id FROM foils GROUP BY lot)"
    " SELECT first.id, first.id, avg(mean.value), NULL FROM mean JOIN foils ON foils.id = mean.foil"
    " JOIN first ON first.lot = foils.lot WHERE" NAMED
    " GROUP BY first.id, CASE foils.serial WHEN '' THEN mean.foil ELSE foils.serial END"
    " ORDER BY first.id, min(mean.foil)";

static fg_status read_values(fg_context *ctx, sqlite3 *reader, fg_trend *trend) {
  const fg_trend_choice *choice = trend->choice;
  filling at = {0};
  fg_query query;
  int64_t quantity;
  fg_status status = FG_OK;
  FG_TRY(fg_trend_find_quantity(ctx, reader, choice, &quantity));
  fg_query_begin(reader, choice->by_lots ? of_lots : of_foils, &query);
  bind(&query, quantity, choice);
  trend->u_shared = NAN;
  while (status == FG_OK && fg_query_row(&query)) {
    if (!fg_query_is_null(&query, 3))
      trend->u_shared = fmin(trend->u_shared, fg_query_get_number(&query, 3));
    status = add_value(ctx, trend, &at, fg_query_get_integer(&query, 0),
                       fg_query_get_integer(&query, 1), fg_query_get_number(&query, 2));
  }
  fg_status ended = fg_query_end(ctx, &query, "reading the values");
  trend->quantity.count = at.values;
  trend->count = trend->total = at.points;
  return status == FG_OK ? ended : status;
}

/* Keeps points [first, last] alone. */
static void cut(fg_trend *trend, size_t first, size_t last) {
  fg_lot_quantity *quantity = &trend->quantity;
  size_t before = 0, kept = 0;
  for (size_t i = 0; i <= last; i++)
    *(i < first ? &before : &kept) += quantity->size[i];
  memmove(quantity->value, quantity->value + before, kept * sizeof *quantity->value);
  trend->before = first;
  trend->count = last + 1 - first;
  memmove(quantity->size, quantity->size + first, trend->count * sizeof *quantity->size);
  memmove(trend->foil, trend->foil + first, trend->count * sizeof *trend->foil);
  quantity->count = kept;
}

/* Chooses the points of the chart, and those that are drawn: a drawn range that begins before
 * the newest extends the chart. */
static void choose_points(fg_trend *trend) {
  const fg_trend_choice *choice = trend->choice;
  size_t total = trend->total, first = 0;
  if (!total) return;
  if (choice->newest && choice->newest < total) first = total - choice->newest;
  size_t from = choice->from ? choice->from - 1 : first;
  size_t to = choice->to && choice->to <= total ? choice->to - 1 : total - 1;
  if (from > to) from = to;
  if (from < first) first = from;
  if (choice->of_the_drawn)
    cut(trend, from, to);
  else
    cut(trend, first, total - 1);
  trend->first = from - trend->before;
  trend->last = to - trend->before;
}

static void find_trend_spread(fg_lot_quantity *quantity) {
  double squares = 0;
  quantity->mean = 0;
  for (size_t i = 0; i < quantity->count; i++)
    quantity->mean += quantity->value[i] / (double)quantity->count;
  for (size_t i = 0; i < quantity->count; i++)
    squares += pow(quantity->value[i] - quantity->mean, 2);
  quantity->sd = quantity->count > 1 ? sqrt(squares / (double)(quantity->count - 1)) : NAN;
}

static fg_status chart_lots(unsigned rules, fg_trend *trend) {
  fg_context unused;
  fg_lot_quantity *quantity = &trend->quantity;
  const fg_subgroups by_lot = {quantity->value, quantity->size, trend->count};
  quantity->has_chart =
      trend->count >= 2 && fg_chart_subgroups(&unused, &by_lot, FG_SIGMA_FROM_SD, rules,
                                              &quantity->means, NULL) == FG_OK;
  quantity->stable = quantity->has_chart && !quantity->means.signals;
  return FG_OK;
}

/* Judges capability; too few values have none, which is no error. The error that all values share
 * is part of each one's, so no larger than the smallest. */
static void judge_trend(const fg_lot_settings *settings, fg_trend *trend) {
  fg_context unused;
  fg_lot_quantity *quantity = &trend->quantity;
  bool known = fg_design_may_judge(&settings->design), has_u = fg_quantity_has_u(quantity->row);
  if (fg_lot_judge_capability(&unused, settings->confidence, trend->count, quantity) != FG_OK)
    quantity->has_capability = false;
  double u = known ? trend->u_shared : NAN;
  fg_lot_widen_capability(settings->confidence, has_u ? u : 0, quantity);
}

static fg_status find_shifts(fg_context *ctx, const fg_station_request *request, sqlite3 *reader,
                             fg_trend *trend) {
  FG_TRY(fg_causes_read(ctx, reader, trend->choice, &trend->cause, &trend->causes));
  const fg_shifted_points points = {.foil = trend->foil,
                                    .count = trend->count,
                                    .cause = {trend->cause, trend->choice->found},
                                    .causes = {trend->causes, trend->choice->found_count}};
  return fg_causes_find_shifts(ctx, request, reader, &points, &trend->shift);
}

static void shift_values(fg_trend *trend, double sign) {
  double *value = trend->quantity.value;
  for (size_t i = 0; trend->shift && i < trend->count; i++)
    for (size_t k = 0; k < trend->quantity.size[i]; k++)
      *value++ += sign * trend->shift[i];
}

/* Moves points and limits to where the causes have them: rules were applied about them. */
static void shift_chart(fg_trend *trend) {
  fg_chart *chart = &trend->quantity.chart;
  for (size_t i = 0; trend->shift && i < chart->count; i++) {
    chart->point[i].value += trend->shift[i];
    chart->point[i].lower += trend->shift[i];
    chart->point[i].upper += trend->shift[i];
  }
}

static fg_status read_and_chart(fg_context *ctx, const fg_station_request *request,
                                const fg_lot_settings *settings, sqlite3 *reader, fg_trend *trend) {
  FG_TRY(read_values(ctx, reader, trend));
  choose_points(trend);
  fg_trend_find_changes(reader, trend);
  find_trend_spread(&trend->quantity);
  FG_TRY(fg_trend_find_tolerance(ctx, reader, trend));
  if (trend->choice->by_lots) return chart_lots(settings->run_rules, trend);
  if (!trend->count) return FG_OK;
  FG_TRY(find_shifts(ctx, request, reader, trend));
  shift_values(trend, -1);
  FG_TRY(fg_lot_chart_quantity(ctx, settings->run_rules, trend->count, &trend->quantity));
  if (!trend->choice->taken_out) shift_chart(trend);
  if (!trend->choice->taken_out) shift_values(trend, 1);
  /* Between levels of a cause capability would be that of no state of the process. */
  trend->mixed = fg_trend_mixes_recipes(reader, trend);
  if (trend->quantity.stable && !trend->shift && !trend->mixed) judge_trend(settings, trend);
  return FG_OK;
}

fg_status fg_trend_read(fg_context *ctx, const fg_inspection *station, sqlite3 *reader,
                        const fg_trend_choice *choice, fg_trend *trend) {
  const fg_lot_settings *settings = &station->settings->lot;
  *trend = (fg_trend){.choice = choice, .quantity = {.row = choice->row, .owner = choice->owner}};
  fg_status status = read_and_chart(ctx, station->request, settings, reader, trend);
  if (status != FG_OK) fg_trend_free(trend);
  return status;
}

void fg_trend_free(fg_trend *trend) {
  fg_lot_quantity *quantity = &trend->quantity;
  free(quantity->value);
  free(quantity->size);
  fg_chart_free(&quantity->chart);
  fg_chart_free(&quantity->means);
  fg_chart_free(&quantity->deviations);
  free(trend->foil);
  free(trend->shift);
  fg_causes_free(trend->cause, trend->causes);
  *trend = (fg_trend){0};
}

const fg_chart *fg_trend_chart(const fg_trend *trend) {
  return trend->choice->by_lots ? &trend->quantity.means : &trend->quantity.chart;
}

size_t fg_trend_number(const fg_trend *trend, size_t point) {
  return trend->before + point + 1;
}

void fg_trend_name(sqlite3 *reader, const fg_trend *trend, size_t point, char *name, size_t size) {
  fg_query query;
  fg_context unused;
  fg_query_begin(reader, "SELECT serial, lot FROM foils WHERE id = ?", &query);
  fg_query_integer(&query, trend->foil[point]);
  const char *text =
      fg_query_row(&query) ? fg_query_get_text(&query, trend->choice->by_lots ? 1 : 0) : "?";
  snprintf(name, size, "%s", text[0] ? text : "without a lot");
  fg_query_end(&unused, &query, "reading a name");
}

static void add_run(fg_trend_run runs[FG_TREND_RUNS], size_t *all, fg_trend_run run) {
  if (*all < FG_TREND_RUNS) runs[*all] = run;
  ++*all;
}

/* Points are gone through from the newest; where a rule ends at points in a row, that is one run.
 */
size_t fg_trend_runs(const fg_trend *trend, fg_trend_run runs[FG_TREND_RUNS], size_t *all) {
  const fg_chart *chart = fg_trend_chart(trend);
  *all = 0;
  for (size_t i = chart->count; i-- > 0;)
    for (unsigned rule = 1; rule <= FG_RUN_RULES; rule++) {
      unsigned bit = 1u << (rule - 1);
      if (!(chart->point[i].rules & bit)) continue;
      if (i + 1 < chart->count && chart->point[i + 1].rules & bit) continue;
      size_t begin = i;
      while (begin > 0 && chart->point[begin - 1].rules & bit)
        begin--;
      size_t length = fg_run_rule_length(rule);
      add_run(runs, all,
              (fg_trend_run){rule, begin + 1 > length ? begin + 1 - length : 0, i, *all + 1});
    }
  return *all < FG_TREND_RUNS ? *all : FG_TREND_RUNS;
}
