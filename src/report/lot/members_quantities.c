/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of lot.json about quantities: their values over the lot, charts, capability, groups,
 * gauge studies. */
#include <math.h>

#include "foilgauge/traceability.h"
#include "foilgauge/words.h"
#include "page/page.h"
#include "report/lot/members.h"
#include "report/lot/page_parts.h"
#include "report/lot/parts_members.h"

/* A ratio from which a higher number tells nothing more. */
static const double ratio_told = 100;

static const fg_lot_quantity *quantity_of(const fg_subject *subject) {
  return subject->object;
}

bool fg_lot_has_beams(const fg_subject *subject) {
  return ((const fg_lot_analysis *)subject->whole)->parts == FG_QUANTITY_OF_BEAM;
}

int fg_lot_traceability(const fg_subject *subject) {
  const fg_lot_analysis *analysis = subject->whole;
  return fg_design_traceability_cell(&analysis->lot->settings.design);
}

bool fg_lot_has_no_beams(const fg_subject *subject) {
  return !fg_lot_has_beams(subject);
}

/* Capability. */
static const fg_member ratio_rows[] = {
    {FG_NUMBER("value", fg_ratio, value)},
    {FG_NUMBER("low", fg_ratio, low), .words = "end of its interval"},
    {FG_NUMBER("high", fg_ratio, high), .words = "end of its interval"},
};
static const fg_members ratio_members = FG_MEMBERS_DEFINED(ratio_rows, "ratio");

static const char *find_quantity_words(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return quantity_of(subject)->row->words;
}

static const char *find_unit(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return quantity_of(subject)->row->unit;
}

static double find_lower(const fg_subject *subject) {
  return quantity_of(subject)->tolerance->lower;
}

static double find_upper(const fg_subject *subject) {
  return quantity_of(subject)->tolerance->upper;
}

static void show_tolerance(FILE *out, const fg_subject *subject) {
  fg_lot_put_number(out, find_lower(subject), 6);
  fputs(" … ", out);
  fg_lot_put_number(out, find_upper(subject), 6);
}

static void show_ratio_value(FILE *out, double value) {
  if (value > ratio_told)
    fprintf(out, "&gt; %.0f", ratio_told);
  else
    fg_lot_put_number(out, value, 3);
}

static void show_ratio(FILE *out, const fg_ratio *ratio) {
  show_ratio_value(out, ratio->value);
  if (!isfinite(ratio->value) || ratio->value > ratio_told) return;
  fputs(" <i>", out);
  fg_lot_put_number(out, ratio->low, 3);
  fputs(" … ", out);
  fg_lot_put_number(out, ratio->high, 3);
  fputs("</i>", out);
}

#define SHOW_RATIO(function, field)                                                                \
  static void function(FILE *out, const fg_subject *subject) {                                     \
    show_ratio(out, &quantity_of(subject)->capability.field);                                      \
  }
SHOW_RATIO(show_pp, p)
SHOW_RATIO(show_ppk, pk)
SHOW_RATIO(show_cp, c)
SHOW_RATIO(show_cpk, ck)

static void show_quantile_ppk(FILE *out, const fg_subject *subject) {
  show_ratio_value(out, quantity_of(subject)->capability.quantile_pk);
}

static const char *find_state(const fg_subject *subject, char *buffer) {
  const fg_capability *c = &quantity_of(subject)->capability;
  snprintf(buffer, FG_MEMBER_TEXT_MAX, "%s, %s", c->stable ? "stable" : "not stable",
           c->normal ? "normal" : "not normal: the quantile method holds");
  return buffer;
}

#define RATIO(name, field, heading_, show_, words_)                                                \
  {                                                                                                \
    FG_OBJECT(name, fg_lot_quantity, capability.field, &ratio_members),                            \
        .options = FG_MEMBER_ON_LINE, .words = (words_),                                           \
        .page = {.rank = 3, .heading = (heading_)}, .markup = (show_)                              \
  }

static const fg_member capability_rows[] = {
    {FG_TEXT_BY("quantity", find_quantity_words), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .heading = "quantity", .words = true}},
    {FG_TEXT_BY("tolerance", find_unit), .options = FG_MEMBER_NOT_IN_JSON, .markup = show_tolerance,
     .page = {.rank = 2, .heading = "tolerance"}},
    {FG_NUMBER_BY("min", find_lower), .words = "null: no lower limit"},
    {FG_NUMBER_BY("max", find_upper), .words = "null: no upper limit"},
    {FG_FLAG("stable", fg_lot_quantity, capability.stable),
     .words = "no signal on the charts; else cp and cpk are null"},
    {FG_FLAG("normal", fg_lot_quantity, capability.normal),
     .words = "the test of normality does not reject it; else the quantile method holds"},
    {FG_NUMBER("anderson_darling", fg_lot_quantity, capability.normality.a2),
     .words =
         "test of normality, of the foils' means or of the bumps' distances from them, whichever "
         "rejects more; adjusted for the count"},
    {FG_NUMBER("normality_p_value", fg_lot_quantity, capability.normality.p_value),
     .words = "null: fewer than 8 values"},
    RATIO("pp", p, "Pp", show_pp, "tolerance over 6 s of all values; null: a limit is missing"),
    RATIO("ppk", pk, "Ppk", show_ppk, "distance of the mean from the nearer limit over 3 s"),
    RATIO("cp", c, "Cp", show_cp, "as pp, by sigma within subgroups; null: not stable"),
    RATIO("cpk", ck, "Cpk", show_cpk, "as ppk, by sigma within subgroups; null: not stable"),
    {FG_NUMBER("pp_quantile", fg_lot_quantity, capability.quantile_p),
     .words = "pp by the quantile method"},
    {FG_NUMBER("ppk_quantile", fg_lot_quantity, capability.quantile_pk),
     .words = "ppk by the quantile method", .markup = show_quantile_ppk,
     .page = {.rank = 3, .heading = "Ppk by\nquantiles"}},
    {FG_NUMBERS("quantiles", fg_lot_quantity, capability.quantile),
     .words = "X0.135, X50 and X99.865 % of the kernel density"},
    {FG_TEXT_BY("state", find_state), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 4, .heading = "", .words = true}},
};
const fg_members fg_lot_capability_members = FG_MEMBERS_DEFINED(capability_rows, "capability");

/* Charts. */
static bool find_signal(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_chart *chart = list->object;
  if (i >= chart->count) return false;
  element->object = chart->point[i].rules ? &chart->point[i] : NULL;
  return true;
}

static double find_index(const fg_subject *subject) {
  return (double)subject->index + 1;
}

static const double *list_rules(const fg_subject *subject, double *rules, size_t *count) {
  const fg_chart_point *point = subject->object;
  for (unsigned rule = 1; rule <= FG_RUN_RULES; rule++)
    if (point->rules & (1u << (rule - 1))) rules[(*count)++] = rule;
  return rules;
}

static const fg_member signal_rows[] = {
    {FG_COUNT_BY("point", find_index), .lowest = 1, .words = "number on the chart"},
    {FG_NUMBER("value", fg_chart_point, value)},
    {FG_NUMBERS_BY("rules", list_rules), .words = "run rules that end here",
     .schema = "{\"type\": \"array\", \"minItems\": 1, \"items\": {\"type\": \"integer\", "
               "\"minimum\": 1, \"maximum\": 8}}"},
};
static const fg_members signal_members = FG_MEMBERS(signal_rows);

static const fg_member chart_rows[] = {
    {FG_NUMBER("centre", fg_chart, centre)},
    {FG_NUMBER("sigma", fg_chart, sigma), .words = "of one value: the limits are made of it"},
    {FG_COUNT("points", fg_chart, count)},
    {FG_LIST_BY("signals", find_signal, &signal_members), .options = FG_MEMBER_ON_LINE,
     .words = "points at which a run rule ends"},
};
static const fg_members chart_members = FG_MEMBERS_DEFINED(chart_rows, "chart");

static const fg_member place_rows[] = {
    {FG_COUNT_BY("number", find_index), .lowest = 1},
    {FG_COUNT("count", fg_lot_place, count), .words = "values"},
    {FG_NUMBER("mean", fg_lot_place, mean)},
    {FG_NUMBER("sd", fg_lot_place, sd), .words = "from foil to foil"},
};
static const fg_members place_members = FG_MEMBERS_DEFINED(place_rows, "place");

/* Quantities. */
static bool is_of_bumps(const fg_subject *subject) {
  return fg_owner_is_part(quantity_of(subject)->owner) && fg_lot_has_no_beams(subject);
}

static bool is_of_beams(const fg_subject *subject) {
  return fg_owner_is_part(quantity_of(subject)->owner) && fg_lot_has_beams(subject);
}

static bool has_chart(const fg_subject *subject) {
  return quantity_of(subject)->has_chart;
}

static bool has_subgroups(const fg_subject *subject) {
  return quantity_of(subject)->has_subgroups;
}

static bool has_capability(const fg_subject *subject) {
  return quantity_of(subject)->has_capability;
}

static double find_bandwidth(const fg_subject *subject) {
  return quantity_of(subject)->has_density ? quantity_of(subject)->density.bandwidth : NAN;
}

static bool is_values_table(const fg_subject *list) {
  return list->index == FG_LOT_VALUES;
}

static bool is_mean_u_table(const fg_subject *list) {
  return list->index == FG_LOT_MEAN_U;
}

static int find_value_decimals(const fg_subject *subject) {
  return fg_report_decimals(quantity_of(subject)->row, quantity_of(subject)->sd);
}

static int find_u_decimals(const fg_subject *subject) {
  return fg_report_decimals(quantity_of(subject)->row, quantity_of(subject)->mean_u.u) + 1;
}

static const char *find_runs(const fg_subject *subject, char *buffer) {
  const fg_lot_quantity *quantity = subject->object;
  (void)buffer;
  return fg_lot_is_uninformative(quantity) ? NULL
         : quantity->stable                ? "stable"
         : fg_lot_is_explained(quantity)   ? "groups differ"
                                           : "not stable";
}

static const char *look_at_runs(const fg_subject *subject) {
  const fg_lot_quantity *quantity = subject->object;
  return fg_lot_is_uninformative(quantity) ? NULL : quantity->stable ? "pass" : "cannot_tell";
}

#define VALUE(name, field, heading_, words_)                                                       \
  {                                                                                                \
    FG_NUMBER(name, fg_lot_quantity, field),                                                       \
        .words = (words_), .page = {.rank = 3, .heading = (heading_)}, .column = is_values_table,  \
        .decimals_by = find_value_decimals                                                         \
  }
/* Shown as U = 2 u. */
#define MEAN_U(name, field, rank_, heading_, words_)                                               \
  {                                                                                                \
    FG_NUMBER(name, fg_lot_quantity, mean_u.field),                                                \
        .words = (words_),                                                                         \
        .page = {.rank = rank_, .heading = (heading_), .scale = FG_COVERAGE_FACTOR},               \
        .column = is_mean_u_table, .decimals_by = find_u_decimals                                  \
  }

static const fg_member quantity_rows[] = {
    {FG_TEXT_BY("quantity", find_quantity_words), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .heading = "quantity", .words = true}, .column = is_values_table},
    {FG_TEXT_BY("quantity", find_quantity_words), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .heading = "U of the mean", .words = true}, .column = is_mean_u_table},
    {FG_TEXT_BY("unit", find_unit), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .heading = "unit"}},
    {FG_COUNT("count", fg_lot_quantity, count), .words = "known values",
     .page = {.rank = 2, .heading = "n"}, .column = is_values_table},
    VALUE("mean", mean, "mean", NULL),
    VALUE("sd", sd, "s", "standard deviation of the values"),
    MEAN_U("u_mean", u, 4, "together",
           "uncertainty of the mean by measurement: what statistics leave averages out "
           "over the foils, what the calibration leaves does not"),
    MEAN_U("u_mean_statistical", u_statistical, 3, "statistics", "part of u_mean"),
    MEAN_U("u_mean_calibration", u_calibration, 3, "calibration", "part of u_mean"),
    VALUE("median", median, "median", NULL),
    VALUE("mode", mode, "mode", "of the kernel density"),
    VALUE("min", min, "min", NULL),
    VALUE("max", max, "max", NULL),
    {FG_NUMBER_BY("bandwidth", find_bandwidth), .words = "of the kernel density"},
    {FG_LIST("bumps", fg_lot_quantity, place, places, &place_members), .present = is_of_bumps,
     .options = FG_MEMBER_ON_LINE,
     .words = "by number; of a cantilever's beams it is called beams"},
    {FG_LIST("beams", fg_lot_quantity, place, places, &place_members), .present = is_of_beams,
     .options = FG_MEMBER_ON_LINE, .words = "by number"},
    {FG_OBJECT("individuals", fg_lot_quantity, chart, &chart_members), .present = has_chart,
     .words = "chart of the foils' means"},
    {FG_FLAG("stable", fg_lot_quantity, stable), .present = has_chart,
     .words = "chance explains the signals on the charts of individuals and deviations, at a level "
              "of " FG_LOT_CHART_LEVEL_TEXT " %"},
    {FG_NUMBER("signals_by_chance", fg_lot_quantity, chance.expected), .present = has_chart,
     .words = "on the chart of individuals of a steady process, expected"},
    {FG_COUNT("signals_explained", fg_lot_quantity, chance.max), .present = has_chart,
     .words = "up to so many chance explains"},
    {FG_TEXT_BY("runs", find_runs), .options = FG_MEMBER_NOT_IN_JSON, .look = look_at_runs,
     .page = {.rank = 4, .heading = "runs"}, .column = is_values_table},
    {FG_SAME(&fg_lot_cause_members), .present = has_chart},
    {FG_OBJECT("means", fg_lot_quantity, means, &chart_members), .present = has_subgroups,
     .words = "chart of subgroups: a foil's parts"},
    {FG_OBJECT("deviations", fg_lot_quantity, deviations, &chart_members), .present = has_subgroups,
     .words = "chart of the standard deviations within foils"},
    {FG_GROUP("capability", &fg_lot_capability_members), .present = has_capability},
};
const fg_members fg_lot_quantity_members = FG_MEMBERS_DEFINED(quantity_rows, "quantity");

/* Groups. */
static const char *find_difference_name(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return ((const fg_lot_difference *)subject->object)->quantity->row->name;
}

#define DIFFERENCE(name, field, words_)                                                            \
  { FG_NUMBER(name, fg_lot_difference, field), .words = (words_) }
#define GROUP_TEST(name, test, words_)                                                             \
  DIFFERENCE(name, p[test], words_),                                                               \
      DIFFERENCE(name "_holm", p_holm[test], "adjusted for all tests of comparisons (Holm 1979)")

static const fg_member difference_rows[] = {
    {FG_TEXT_BY("quantity", find_difference_name), .options = FG_MEMBER_NEVER_NULL},
    {FG_STRING("a", fg_lot_difference, a), .options = FG_MEMBER_NEVER_NULL, .words = "a group"},
    {FG_STRING("b", fg_lot_difference, b), .options = FG_MEMBER_NEVER_NULL, .words = "the other"},
    {FG_COUNT("count_a", fg_lot_difference, count_a),
     .words = "values of group a, of all its foils"},
    {FG_COUNT("count_b", fg_lot_difference, count_b), .words = "those of group b"},
    {FG_COUNT("foils_a", fg_lot_difference, foils_a),
     .words = "foils of group a, the unit of all tests; scans of one foil are one"},
    {FG_COUNT("foils_b", fg_lot_difference, foils_b), .words = "those of group b"},
    DIFFERENCE("mean_a", mean_a,
               "mean of the foils' levels; a bump that is missing does not shift its foil's level "
               "by its place's effect"),
    DIFFERENCE("mean_b", mean_b, "that of group b"),
    DIFFERENCE("sd_a", sd_a, "of the foils' levels"),
    DIFFERENCE("sd_b", sd_b, "that of group b"),
    DIFFERENCE("within_sd_a", within_sd_a,
               "of bumps (beams) within a foil, pooled; null: a quantity of the whole foil"),
    DIFFERENCE("within_sd_b", within_sd_b, "that of group b"),
    DIFFERENCE("difference", comparison.difference, "of the means, a - b"),
    DIFFERENCE("difference_low", comparison.low, "end of its interval"),
    DIFFERENCE("difference_high", comparison.high, "end of its interval"),
    DIFFERENCE("variance_ratio", comparison.variance_ratio, "of the foils' levels, a over b"),
    GROUP_TEST("p_means", FG_LOT_TEST_MEANS, "Welch's test of the foils' levels"),
    GROUP_TEST("p_variances", FG_LOT_TEST_VARIANCES,
               "F of the foils' levels, by relabelling; null: fewer than three foils in a group"),
    GROUP_TEST("p_levene", FG_LOT_TEST_LEVENE,
               "Levene's test of the foils' levels, by relabelling"),
    GROUP_TEST("p_within", FG_LOT_TEST_WITHIN,
               "spread of bumps within a foil: Welch's test of its logarithm"),
};
const fg_members fg_lot_difference_members = FG_MEMBERS_DEFINED(difference_rows, "comparison");

/* Gauge studies. */
static const fg_lot_gauge *gauge_of(const fg_subject *subject) {
  return subject->object;
}

static const char *find_gauge_name(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return gauge_of(subject)->quantity->row->name;
}

static const char *find_gauge_words(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return gauge_of(subject)->quantity->row->words;
}

static const char *find_gauge_unit(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return gauge_of(subject)->quantity->row->unit;
}

static double find_whole_categories(const fg_subject *subject) {
  return floor(gauge_of(subject)->study.distinct_categories);
}

#define GAUGE_SD(name, heading_, words_)                                                           \
  {                                                                                                \
    FG_NUMBER(#name, fg_lot_gauge, study.name), .words = (words_), .page = {                       \
      3,                                                                                           \
      .heading = (heading_),                                                                       \
      .digits = 3                                                                                  \
    }                                                                                              \
  }

static const fg_member gauge_rows[] = {
    {FG_TEXT_BY("quantity", find_gauge_name), .options = FG_MEMBER_NEVER_NULL},
    {FG_TEXT_BY("quantity", find_gauge_words), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .heading = "quantity", .words = true}},
    {FG_INTEGER("bump", fg_lot_gauge, number), .options = FG_MEMBER_NOT_NEGATIVE,
     .present = fg_lot_has_no_beams, .words = "its number; 0: the whole foil",
     .page = {.rank = 2, .heading = "bump"}, .column = fg_lot_has_no_beams},
    {FG_INTEGER("beam", fg_lot_gauge, number), .options = FG_MEMBER_NOT_NEGATIVE,
     .present = fg_lot_has_beams, .words = "of a cantilever, instead of bump",
     .page = {.rank = 2, .heading = "beam"}, .column = fg_lot_has_beams},
    {FG_TEXT_BY("unit", find_gauge_unit), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 2, .heading = "unit", .words = true}},
    {FG_COUNT("parts", fg_lot_gauge, study.parts)},
    {FG_COUNT("operators", fg_lot_gauge, study.operators)},
    {FG_COUNT("trials", fg_lot_gauge, study.trials), .words = "of each operator at each part, at most"},
    GAUGE_SD(repeatability, "repeatability", "standard deviation of one operator's trials"),
    GAUGE_SD(reproducibility, "reproducibility", "standard deviation of the operators"),
    GAUGE_SD(grr, "GRR", "standard deviation of both together"),
    GAUGE_SD(part, "part", "standard deviation of the parts"),
    GAUGE_SD(grr_pct, "GRR, %", "grr over the total standard deviation"),
    {FG_NUMBER("distinct_categories", fg_lot_gauge, study.distinct_categories),
     .words = "1.41 part / grr"},
    {FG_COUNT_BY("categories", find_whole_categories), .options = FG_MEMBER_NOT_IN_JSON,
     .words = "classes of parts that the gauge tells apart",
     .page = {.rank = 4, .heading = "categories"}},
    {FG_NUMBER("p_interaction", fg_lot_gauge, study.p_interaction),
     .words = "of no interaction of operator and part"},
};
const fg_members fg_lot_gauge_members = FG_MEMBERS_DEFINED(gauge_rows, "gauge");
