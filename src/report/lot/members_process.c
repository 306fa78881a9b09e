/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of lot.json about the state of the process and the causes of its charts' signals. */
#include <math.h>

#include "report/lot/parts_members.h"

#define SIGNALS_LEFT_WORDS "of the same chart "

static const fg_member trend_rows[] = {
    {FG_NUMBER("per_foil", fg_lot_trend, per_foil), .words = "slope",
     .options = FG_MEMBER_NEVER_NULL},
    {FG_NUMBER("u_per_foil", fg_lot_trend, u_per_foil), .options = FG_MEMBER_NEVER_NULL,
     .words = "its standard uncertainty, widened for neighbours that are alike"},
    {FG_NUMBER("freedom", fg_lot_trend, dof), .words = "degrees of freedom",
     .options = FG_MEMBER_NEVER_NULL},
    {FG_NUMBER("first_to_last", fg_lot_trend, first_to_last), .words = "of the foils",
     .options = FG_MEMBER_NEVER_NULL},
    {FG_NUMBER("neighbours", fg_lot_trend, correlation), .options = FG_MEMBER_NEVER_NULL,
     .words = "correlation of neighbours beside the trend"},
    {FG_NUMBER("p_value", fg_lot_trend, p_value), .words = "of no trend",
     .options = FG_MEMBER_NEVER_NULL},
    {FG_COUNT("signals_left", fg_lot_trend, signals_left),
     .words = SIGNALS_LEFT_WORDS "without the trend"},
};
static const fg_members trend_members = FG_MEMBERS(trend_rows);

/* A group of the cause, which the subject's index counts. */
static const fg_lot_cause *cause_of(const fg_subject *subject) {
  return subject->object;
}

static const char *find_group_name(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return cause_of(subject)->name[subject->index];
}

static double count_foils_of_group(const fg_subject *subject) {
  return (double)cause_of(subject)->foils[subject->index];
}

static double find_mean_of_group(const fg_subject *subject) {
  return cause_of(subject)->mean[subject->index];
}

static const fg_member group_rows[] = {
    {FG_TEXT_BY("name", find_group_name), .options = FG_MEMBER_NEVER_NULL},
    {FG_COUNT_BY("foils", count_foils_of_group), .lowest = 2},
    {FG_NUMBER_BY("mean", find_mean_of_group)},
};
static const fg_members group_members = FG_MEMBERS(group_rows);

static bool find_group(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = list->object;
  return i < cause_of(list)->groups;
}

static const char *find_column(const fg_subject *subject, char *buffer) {
  (void)buffer;
  const fg_lot_analysis *analysis = subject->whole;
  return analysis->lot->manifest.name[cause_of(subject)->column];
}

static const fg_member signals_by_rows[] = {
    {FG_TEXT_BY("column", find_column), .options = FG_MEMBER_NEVER_NULL,
     .words = "of the manifest"},
    {FG_NUMBER("p_value", fg_lot_cause, p_value), .words = "of groups with one mean"},
    {FG_COUNT("signals_left", fg_lot_cause, signals_left),
     .words = SIGNALS_LEFT_WORDS "with all groups moved to one mean"},
    {FG_FLAG("in_turn", fg_lot_cause, in_turn), .words = "one foil of each group after the other"},
    {FG_LIST_BY("groups", find_group, &group_members), .options = FG_MEMBER_ON_LINE},
};
static const fg_members signals_by_members = FG_MEMBERS(signals_by_rows);

static fg_subject find_trend(const fg_subject *subject) {
  const fg_lot_quantity *quantity = subject->object;
  return (fg_subject){.object = quantity->trend.known ? &quantity->trend : NULL};
}

static fg_subject find_signals_by(const fg_subject *subject) {
  const fg_lot_quantity *quantity = subject->object;
  bool known = quantity->cause.column != FG_NO_COLUMN;
  return (fg_subject){.object = known ? &quantity->cause : NULL, .whole = subject->whole};
}

static const fg_member cause_rows[] = {
    {FG_PART("trend", find_trend, &trend_members),
     .words = "of the foils' values over their order, where the chart of individuals has signals; "
              "null: none can be told from noise"},
    {FG_PART("signals_by", find_signals_by, &signals_by_members),
     .words = "groups that have a mean of their own, and so make the signals of the chart of "
              "individuals; null: none is known"},
};
const fg_members fg_lot_cause_members = FG_MEMBERS(cause_rows);

/* State of the process. */
static double is_process_stable(const fg_subject *subject) {
  const fg_lot_analysis *analysis = subject->object;
  return analysis->process.watched ? analysis->process.unstable == 0 : NAN;
}

/* Returns the name of a watched quantity that is as asked; "" for others, NULL behind the last. */
static const char *name_watched(const fg_subject *subject, size_t i, bool unstable,
                                bool explained) {
  const fg_lot_analysis *analysis = subject->object;
  if (i >= analysis->quantity_count) return NULL;
  const fg_lot_quantity *quantity = &analysis->quantities[i];
  bool listed = fg_lot_is_watched(analysis, quantity) && !(unstable && quantity->stable) &&
                !(explained && !fg_lot_is_explained(quantity));
  return listed ? quantity->row->name : "";
}

static const char *watched_at(const fg_subject *subject, size_t i) {
  return name_watched(subject, i, false, false);
}

static const char *unstable_at(const fg_subject *subject, size_t i) {
  return name_watched(subject, i, true, false);
}

static const char *explained_at(const fg_subject *subject, size_t i) {
  return name_watched(subject, i, true, true);
}

static const fg_member process_rows[] = {
    {FG_FLAG_BY("stable", is_process_stable), .options = FG_MEMBER_NULLABLE,
     .words = "null: no chart, for there are too few foils"},
    {FG_TEXTS_BY("watched", watched_at), .words = "quantities that are charted"},
    {FG_TEXTS_BY("not_stable", unstable_at), .words = "those with signals"},
    {FG_TEXTS_BY("explained", explained_at),
     .words = "of those not stable: groups explain every signal"},
};
const fg_members fg_lot_process_members = FG_MEMBERS(process_rows);
