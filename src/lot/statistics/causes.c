/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Causes of a control chart's signals: groups of foils (dies, coils, operators) with a mean each.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "foilgauge/distribution.h"
#include "lot/statistics/analysis.h"

/* Probability of a cause by chance: all columns tried and the order of the foils share it
 * (Bonferroni). Without that a group that differs by chance in one of twenty lots would explain any
 * chart. */
static const double chance = 0.05;
enum { COLUMNS_TRIED = 3, CAUSES_TRIED = COLUMNS_TRIED + 1, FOILS_PER_GROUP = 2 };

/* Points of a chart with their groups. */
typedef struct grouping {
  size_t *group; /* group of each point */
  double *moved; /* the points once every group has the chart's centre as mean */
} grouping;

static size_t find_group(fg_lot_cause *cause, const char *name) {
  for (size_t g = 0; g < cause->groups; g++)
    if (!strcmp(cause->name[g], name)) return g;
  if (cause->groups == FG_LOT_GROUPS_MAX) return FG_LOT_GROUPS_MAX;
  cause->name[cause->groups] = name;
  return cause->groups++;
}

/* Returns false when the column does not sort all foils of the chart into a few groups. */
static bool find_groups(const fg_lot_analysis *analysis, const fg_lot_quantity *quantity,
                        fg_lot_cause *cause, const grouping *by) {
  size_t point = 0;
  for (size_t i = 0; i < analysis->foil_count; i++) {
    if (!quantity->size[i]) continue;
    const char *name =
        fg_manifest_cell(&analysis->lot->manifest, analysis->foils[i].item, cause->column);
    size_t group = *name ? find_group(cause, name) : FG_LOT_GROUPS_MAX;
    if (group == FG_LOT_GROUPS_MAX) return false;
    by->group[point] = group;
    cause->foils[group]++;
    cause->mean[group] += quantity->chart.point[point++].value;
  }
  for (size_t g = 0; g < cause->groups; g++) {
    if (cause->foils[g] < FOILS_PER_GROUP) return false;
    cause->mean[g] /= (double)cause->foils[g];
  }
  return cause->groups >= 2;
}

static bool is_in_turn(const fg_lot_cause *cause, const grouping *by, size_t points) {
  for (size_t i = 0; i < points; i++)
    if (by->group[i] != i % cause->groups) return false;
  return true;
}

/* Returns the p-value of a one-way analysis of variance of the foils' values. */
static double find_p_value(const fg_lot_quantity *quantity, const fg_lot_cause *cause,
                           const grouping *by) {
  double between = 0, within = 0;
  size_t points = quantity->chart.count;
  for (size_t g = 0; g < cause->groups; g++)
    between += (double)cause->foils[g] * pow(cause->mean[g] - quantity->chart.centre, 2);
  for (size_t i = 0; i < points; i++)
    within += pow(quantity->chart.point[i].value - cause->mean[by->group[i]], 2);
  double dof = (double)(cause->groups - 1), rest = (double)(points - cause->groups);
  if (!(rest > 0) || !(between > 0)) return 1;
  if (!(within > 0)) return 0;
  return fg_distribution_f_upper(between / dof / (within / rest), dof, rest);
}

static fg_status count_unexplained_signals(fg_context *ctx, unsigned rules,
                                           const fg_lot_quantity *quantity, fg_lot_cause *cause,
                                           const grouping *by) {
  fg_chart chart;
  for (size_t i = 0; i < quantity->chart.count; i++)
    by->moved[i] =
        quantity->chart.point[i].value - cause->mean[by->group[i]] + quantity->chart.centre;
  FG_TRY(fg_chart_individuals(ctx, by->moved, quantity->chart.count, rules, &chart));
  cause->signals_left = chart.signals;
  fg_chart_free(&chart);
  return FG_OK;
}

/* Keeps the better of the known cause and this column. */
static fg_status try_column(fg_context *ctx, const fg_lot_analysis *analysis,
                            fg_lot_quantity *quantity, const char *column, const grouping *by) {
  fg_lot_cause cause = {.column = fg_manifest_column(&analysis->lot->manifest, column)};
  if (cause.column == FG_NO_COLUMN || cause.column == quantity->cause.column) return FG_OK;
  if (!find_groups(analysis, quantity, &cause, by)) return FG_OK;
  cause.p_value = find_p_value(quantity, &cause, by);
  if (!(cause.p_value < chance / CAUSES_TRIED)) return FG_OK;
  cause.in_turn = is_in_turn(&cause, by, quantity->chart.count);
  FG_TRY(count_unexplained_signals(ctx, analysis->lot->settings.run_rules, quantity, &cause, by));
  size_t known = quantity->cause.column == FG_NO_COLUMN ? quantity->chart.signals
                                                        : quantity->cause.signals_left;
  if (cause.signals_left < known) quantity->cause = cause;
  return FG_OK;
}

static fg_status find_best_cause(fg_context *ctx, const fg_lot_analysis *analysis,
                                 fg_lot_quantity *quantity) {
  const fg_lot_settings *settings = &analysis->lot->settings;
  const char *const columns[COLUMNS_TRIED] = {settings->group_column, settings->die_column,
                                              settings->operator_column};
  void *groups = NULL, *moved = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, quantity->chart.count, sizeof(size_t), &groups));
  FG_TRY_EXIT(fg_memory_allocate(ctx, quantity->chart.count, sizeof(double), &moved));
  for (size_t i = 0; i < COLUMNS_TRIED; i++)
    FG_TRY_EXIT(try_column(ctx, analysis, quantity, columns[i],
                           &(grouping){.group = groups, .moved = moved}));
exit:
  free(groups);
  free(moved);
  return status;
}

/* The release of a lot rests on the quantities with a tolerance, else on those that the page
 * charts. */
bool fg_lot_is_watched(const fg_lot_analysis *analysis, const fg_lot_quantity *quantity) {
  const fg_design *design = &analysis->lot->settings.design;
  if (!quantity->has_chart) return false;
  if (design->tolerance_count > fg_report_of_bearing(design, NULL, 0))
    return quantity->tolerance != NULL;
  for (const char *const *name = fg_lot_charted; *name; name++)
    if (!strcmp(quantity->row->name, *name)) return true;
  return false;
}

const char *const fg_lot_charted[] = {
    "radius_error_pct",        "height_mm",         "overall.radius_mm",
    "arc.subtended_angle_deg", "length_mm",         "width_mm",
    "compliance_error_pct",    "sagitta_error_pct", NULL};

bool fg_lot_is_trend(const fg_lot_quantity *quantity) {
  const fg_lot_cause *cause = &quantity->cause;
  return quantity->trend.known &&
         (cause->column == FG_NO_COLUMN || quantity->trend.signals_left < cause->signals_left);
}

bool fg_lot_is_explained(const fg_lot_quantity *quantity) {
  return quantity->cause.column != FG_NO_COLUMN && quantity->cause.signals_left == 0 &&
         !(quantity->has_subgroups && quantity->deviations.signals);
}

bool fg_lot_is_uninformative(const fg_lot_quantity *quantity) {
  enum { FOILS_MIN = 8 }; /* the rules of a chart speak of eight points in a row */
  return !quantity->has_chart || (quantity->stable && quantity->chart.count < FOILS_MIN);
}

fg_status fg_lot_analyse_causes(fg_context *ctx, fg_lot_analysis *analysis) {
  fg_lot_process *process = &analysis->process;
  for (size_t i = 0; i < analysis->quantity_count; i++) {
    fg_lot_quantity *quantity = &analysis->quantities[i];
    quantity->cause.column = FG_NO_COLUMN;
    if (quantity->has_chart && quantity->chart.signals) {
      FG_TRY(find_best_cause(ctx, analysis, quantity));
      FG_TRY(fg_lot_find_trend(ctx, analysis->lot->settings.run_rules, chance / CAUSES_TRIED,
                               quantity));
    }
    if (fg_lot_is_uninformative(quantity) || !fg_lot_is_watched(analysis, quantity)) continue;
    process->watched++;
    process->unstable += !quantity->stable;
    process->explained += !quantity->stable && fg_lot_is_explained(quantity);
  }
  return FG_OK;
}
