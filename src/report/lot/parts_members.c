/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of lot.json: spreads, stiffness of bumps. */
#include "report/lot/parts_members.h"

#define SPREAD_VALUE(name, heading_, words_)                                                       \
  {                                                                                                \
    FG_NUMBER(#name, fg_lot_spread, name), .words = (words_), .page = {                            \
      2,                                                                                           \
      .heading = (heading_),                                                                       \
      .digits = 4                                                                                  \
    }                                                                                              \
  }

static const fg_member spread_rows[] = {
    {FG_COUNT("count", fg_lot_spread, count), .words = "values",
     .page = {.rank = 2, .heading = "n"}},
    SPREAD_VALUE(mean, "mean", NULL),
    SPREAD_VALUE(mode, "mode", "of the kernel density"),
    {FG_NUMBER("sd", fg_lot_spread, sd), .words = "standard deviation"},
    SPREAD_VALUE(relative_sd_pct, "rel. s, %", "sd over the mean"),
    SPREAD_VALUE(min, "min", NULL),
    SPREAD_VALUE(max, "max", NULL),
};
const fg_members fg_lot_spread_members = FG_MEMBERS_DEFINED(spread_rows, "spread");

static const fg_member arch_rows[] = {
    {FG_NUMBER("stiffness_n_mm2", fg_arch_stiffness, stiffness_n_mm2),
     .words = "of the crown per mm of width, while it is loaded"},
    {FG_NUMBER("unloading_n_mm2", fg_arch_stiffness, unloading_n_mm2),
     .words = "where unloading begins; null: friction holds the feet"},
    {FG_NUMBER("foot_n_mm2", fg_arch_stiffness, foot_n_mm2), .words = "of a foot sideways"},
    {FG_NUMBER("foot_share", fg_arch_stiffness, foot_share),
     .words = "share of the load on the sliding foot: 1/2 for a free bump"},
    {FG_FLAG("stuck", fg_arch_stiffness, stuck), .words = "friction holds the foot"},
};
static const fg_members arch_members = FG_MEMBERS_DEFINED(arch_rows, "arch");

static const fg_lot_stiffness *stiffness_of(const fg_subject *subject) {
  return &((const fg_lot_analysis *)subject->whole)->stiffness;
}

static bool has_spread(const fg_subject *subject) {
  return ((const fg_lot_analysis *)subject->whole)->has_stiffness;
}

static bool find_model(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = &stiffness_of(list)->cases[FG_LOT_CASE_DESIGN].by_model[i];
  return i < FG_STIFFNESS_MODELS;
}

static fg_subject find_mean_bump(const fg_subject *model) {
  const fg_stiffness_case *mean = &stiffness_of(model)->cases[FG_LOT_CASE_MEAN];
  return (fg_subject){.object = has_spread(model) ? &mean->by_model[model->index] : NULL};
}

static fg_subject find_spread_by_model(const fg_subject *model) {
  const fg_lot_spread *spread = &stiffness_of(model)->by_model[model->index];
  return (fg_subject){.object = spread->count ? spread : NULL};
}

static const fg_member model_rows[] = {
    {FG_SAME(&fg_stiffness_model_members), .pointed = true,
     .offset = offsetof(fg_stiffness_result, model)},
    {FG_GROUP("design", &fg_stiffness_result_members)},
    {FG_PART("lot_mean", find_mean_bump, &fg_stiffness_result_members),
     .options = FG_MEMBER_LEFT_OUT},
    {FG_PART("normalised", find_spread_by_model, &fg_lot_spread_members),
     .options = FG_MEMBER_ON_LINE | FG_MEMBER_LEFT_OUT},
};
static const fg_members model_members = FG_MEMBERS(model_rows);

static const fg_member term_rows[] = {
    {FG_NUMBER("relative_sd_pct", fg_lot_budget_term, spread_pct),
     .words = "relative sd of the cause over the bumps",
     .page = {.rank = 2, .heading = "varies by, %", .digits = 3}},
    {FG_NUMBER("sensitivity", fg_lot_budget_term, sensitivity),
     .words = "percent of stiffness per percent of the cause",
     .page = {.rank = 2, .heading = "% of stiffness\nper %", .decimals = 2, .plus = true}},
    {FG_NUMBER("variance_pct2", fg_lot_budget_term, variance_pct2),
     .words = "variance of the stiffness from it"},
    {FG_NUMBER("share_pct", fg_lot_budget_term, share_pct),
     .words = "of the observed variance, 0 to 100: averaged over the orders of the causes "
              "(Lindeman, Merenda and Gold 1980)",
     .page = {.rank = 4, .heading = "share of the\nvariance, %", .decimals = 1}},
};
const fg_members fg_lot_budget_term_members = FG_MEMBERS_DEFINED(term_rows, "budget_term");

static const fg_member together_rows[] = {
    {FG_NUMBER("correlation", fg_lot_budget, correlation), .words = "of radius and arc length"},
    {FG_NUMBER("variance_pct2", fg_lot_budget, together_pct2), .words = "variance by it"},
};
static const fg_members together_members = FG_MEMBERS(together_rows);

static const fg_member budget_rows[] = {
    {FG_OBJECT("radius_at_arc_length", fg_lot_budget, radius, &fg_lot_budget_term_members),
     .options = FG_MEMBER_ON_LINE},
    {FG_OBJECT("arc_length", fg_lot_budget, arc_length, &fg_lot_budget_term_members),
     .options = FG_MEMBER_ON_LINE},
    {FG_GROUP("radius_with_arc_length", &together_members), .options = FG_MEMBER_ON_LINE},
    {FG_OBJECT("thickness", fg_lot_budget, thickness, &fg_lot_budget_term_members),
     .options = FG_MEMBER_ON_LINE},
    {FG_NUMBER("sum_pct2", fg_lot_budget, sum_pct2), .words = "of the known variances above"},
    {FG_NUMBER("observed_relative_sd_pct", fg_lot_budget, observed_pct),
     .words = "of the measured bumps"},
    {FG_NUMBER("unexplained_pct2", fg_lot_budget, unexplained_pct2),
     .words = "observed squared minus sum; negative where curvature takes away"},
    {FG_NUMBER("rest_share_pct", fg_lot_budget, rest_share_pct),
     .words = "of the observed variance: what no cause explains; with the causes' share_pct 100"},
    {FG_NUMBER("measurement_relative_sd_pct", fg_lot_budget, measurement_pct),
     .words = "of the observed: what the bumps' own uncertainties make"},
    {FG_NUMBER("parts_relative_sd_pct", fg_lot_budget, parts_pct),
     .words = "the observed without measurement"},
};
static const fg_members budget_members = FG_MEMBERS(budget_rows);

#define STIFFNESS_SPREAD(name, field)                                                              \
  FG_OBJECT(name, fg_lot_stiffness, field, &fg_lot_spread_members), .options = FG_MEMBER_ON_LINE,  \
                                                                    .present = has_spread

static const char *find_note(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return fg_lot_stiffness_note(subject->whole);
}

static const char *find_model_word(const fg_subject *subject, char *buffer) {
  (void)subject, (void)buffer;
  return "classical";
}

static const fg_member stiffness_rows[] = {
    {FG_TEXT_BY("model", find_model_word), .schema = "{\"const\": \"classical\"}",
     .words = "an arch on sliding feet (include/foilgauge/bearing.h)"},
    {FG_TEXT_BY("note", find_note), .words = "what the model leaves out of this lot's form"},
    {FG_OBJECT("design_free", fg_lot_stiffness, design_free, &arch_members),
     .options = FG_MEMBER_ON_LINE, .words = "the design's bump, both feet sliding"},
    {FG_OBJECT("design_welded", fg_lot_stiffness, design_welded, &arch_members),
     .options = FG_MEMBER_ON_LINE, .words = "the design's bump, one end welded"},
    {FG_OBJECT("sensitivity", fg_lot_stiffness, sensitivity, &fg_sensitivity_members),
     .options = FG_MEMBER_ON_LINE},
    {FG_LIST_BY("models", find_model, &model_members), .lowest = FG_STIFFNESS_MODELS,
     .highest = FG_STIFFNESS_MODELS,
     .words = "every model's stiffness as designed and of a bump of the lot's mean radius, arc "
              "length and thickness; normalised: over the design's by the same model"},
    {STIFFNESS_SPREAD("normalised", measured), .words = "measured bumps over the design's"},
    {FG_NUMBER("u_normalised_by_thickness", fg_lot_stiffness, u_by_thickness),
     .present = has_spread,
     .words = "of the mean of normalised: what the thickness' uncertainty leaves in doubt"},
    {FG_NUMBER("u_normalised_by_calibration", fg_lot_stiffness, u_by_calibration),
     .present = has_spread,
     .words = "of the mean of normalised: what the calibration leaves in doubt, thickness "
              "included"},
    {STIFFNESS_SPREAD("normalised_at_design_thickness", at_design_thickness),
     .words = "the same bumps with the design's thickness"},
    {STIFFNESS_SPREAD("normalised_resampled", resampled),
     .words = "radius and arc length drawn from their densities"},
    {STIFFNESS_SPREAD("normalised_foot", foot), .words = "of the feet sideways"},
    {FG_OBJECT("budget", fg_lot_stiffness, budget, &budget_members), .present = has_spread,
     .words = "where the relative sd of normalised (arch) comes from, to first order about the "
              "lot's mean; variances in percent squared, null: not known"},
};
const fg_members fg_lot_stiffness_members = FG_MEMBERS(stiffness_rows);
