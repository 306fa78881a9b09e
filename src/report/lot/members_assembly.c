/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Member of lot.json about bearings drawn from the lot's foils. */
#include <math.h>

#include "report/lot/parts_members.h"

/* Cells of the page's tables: percent, an interval of it, a gain that may be chance. */
static void put_percent(FILE *out, double share) {
  if (isfinite(share))
    fprintf(out, "%.1f", 100 * share);
  else
    fputs("–", out);
}

static void put_share_range(FILE *out, double low, double high) {
  put_percent(out, low);
  fputs(" … ", out);
  put_percent(out, high);
}

static void put_by_draws(FILE *out, const fg_subject *subject) {
  const fg_assembly_share *share = subject->object;
  put_share_range(out, share->draws_low, share->draws_high);
}

static void put_by_foils(FILE *out, const fg_subject *subject) {
  const fg_assembly_share *share = subject->object;
  put_share_range(out, share->foils_low, share->foils_high);
}

static void put_by_measurement(FILE *out, const fg_subject *subject) {
  const fg_assembly_share *share = subject->object;
  put_share_range(out, share->surely, share->possibly);
}

static void put_gain(FILE *out, const fg_subject *subject) {
  const fg_lot_change *change = subject->object;
  fprintf(out, "%s%.1f%s", change->gain < 0 ? "−" : "+", 100 * fabs(change->gain),
          change->clear ? "" : " (chance)");
}

static const char *const foils_by_words[] = {FG_ASSEMBLY_BY_BOOTSTRAP, FG_ASSEMBLY_BY_BEARINGS,
                                             NULL};

static const fg_member share_rows[] = {
    {FG_COUNT("count", fg_assembly_share, count), .words = "bearings"},
    {FG_NUMBER("share", fg_assembly_share, share), .words = "of the bearings drawn",
     .page = {.rank = 2, .heading = "drawn", .decimals = 1, .scale = 100}},
    {FG_NUMBER("draws_low", fg_assembly_share, draws_low),
     .words = "by the number of draws: Clopper and Pearson, at the recipe's confidence",
     .page = {.rank = 2, .heading = "by number\nof draws"}, .markup = put_by_draws},
    {FG_NUMBER("draws_high", fg_assembly_share, draws_high)},
    {FG_NUMBER("foils_low", fg_assembly_share, foils_low),
     .words = "by the number of foils: Clopper and Pearson of as many independent bearings as "
              "these foils are worth",
     .page = {.rank = 2, .heading = "by number\nof foils"}, .markup = put_by_foils},
    {FG_NUMBER("foils_high", fg_assembly_share, foils_high)},
    {FG_STRING("foils_by", fg_assembly_share, foils_by), .choices = foils_by_words,
     .words = "where the number of independent bearings is from: bootstrap over foils, or, where "
              "that shows nothing, foils / pads"},
    {FG_NUMBER("surely", fg_assembly_share, surely), .words = "share whose value ± U lies within",
     .page = {.rank = 2, .heading = "by measurement\nsurely … possibly"},
     .markup = put_by_measurement},
    {FG_NUMBER("possibly", fg_assembly_share, possibly),
     .words = "share that is not outside by more than U"},
};
const fg_members fg_lot_assembly_share_members = FG_MEMBERS_DEFINED(share_rows, "assembly_share");

/* Result of one limit, which the subject's index counts. */
static const fg_assembly_limit *limit_of(const fg_subject *subject) {
  return &((const fg_lot_analysis *)subject->whole)->assembly.plan.limit[subject->index];
}

static fg_subject find_limit_of_result(const fg_subject *subject) {
  return (fg_subject){.object = limit_of(subject)};
}

static fg_subject find_within(const fg_subject *subject) {
  return (fg_subject){.object =
                          &((const fg_assembly_result *)subject->object)->within[subject->index]};
}

static double find_rejected(const fg_subject *subject) {
  return (double)((const fg_assembly_result *)subject->object)->rejected[subject->index];
}

static double find_rejected_alone(const fg_subject *subject) {
  return (double)((const fg_assembly_result *)subject->object)->alone[subject->index];
}

static const char *find_limited(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return ((const fg_assembly_limit *)subject->object)->row->tolerance;
}

static const fg_member limit_rows[] = {
    {FG_TEXT_BY("quantity", find_limited), .options = FG_MEMBER_NEVER_NULL},
    {FG_NUMBER("min", fg_assembly_limit, lower), .words = "null: no lower limit"},
    {FG_NUMBER("max", fg_assembly_limit, upper), .words = "null: no upper limit"},
    {FG_FLAG("asked", fg_assembly_limit, asked),
     .words = "a bearing that is not within does not count as assembled"},
};
static const fg_members limit_members = FG_MEMBERS(limit_rows);

static const fg_member limit_result_rows[] = {
    {FG_SAME(&limit_members), .part = find_limit_of_result, .options = FG_MEMBER_NEVER_NULL},
    {FG_PART("within", find_within, &fg_lot_assembly_share_members),
     .options = FG_MEMBER_ON_LINE | FG_MEMBER_NEVER_NULL},
    {FG_COUNT_BY("rejected", find_rejected),
     .words = "bearings that it keeps from being assembled"},
    {FG_COUNT_BY("rejected_alone", find_rejected_alone), .words = "and nothing else does"},
};
static const fg_members limit_result_members = FG_MEMBERS(limit_result_rows);

static bool find_limit_result(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = list->object;
  return i < ((const fg_lot_analysis *)list->whole)->assembly.plan.limits;
}

static const double *list_probabilities(const fg_subject *subject, double *values, size_t *count) {
  (void)subject, (void)values;
  *count = FG_ASSEMBLY_QUANTILES;
  return fg_assembly_probability;
}

static bool make_quantile_row(size_t i, fg_member *row) {
  if (i >= FG_ASSEMBLY_VALUES) return false;
  *row = (fg_member){FG_NUMBERS(fg_assembly_row(i)->tolerance, fg_assembly_result, quantile[0])};
  row->offset += i * sizeof((fg_assembly_result *)0)->quantile[0];
  return true;
}

static const fg_member quantile_rows[] = {
    {FG_NUMBERS_BY("probability", list_probabilities), .options = FG_MEMBER_NEVER_NULL,
     .lowest = FG_ASSEMBLY_QUANTILES, .highest = FG_ASSEMBLY_QUANTILES},
    {FG_SAME_BY(make_quantile_row)},
};
static const fg_members quantile_members = FG_MEMBERS(quantile_rows);

static const fg_member result_rows[] = {
    {FG_OBJECT("assembled", fg_assembly_result, assembled, &fg_lot_assembly_share_members),
     .options = FG_MEMBER_ON_LINE, .words = "within every limit that is asked"},
    {FG_LIST_BY("limits", find_limit_result, &limit_result_members)},
    {FG_GROUP("quantiles", &quantile_members), .words = "of the bearings' values"},
};
static const fg_members result_members = FG_MEMBERS_DEFINED(result_rows, "assembly_result");

static const fg_member design_rows[] = {
    {FG_NUMBER("clearance_mm", fg_lot_assembly, clearance_mm), .words = "of the design"},
    {FG_NUMBER("deviation_pct", fg_lot_assembly, deviation_pct), .words = "of it"},
    {FG_OBJECT("drawn", fg_lot_assembly, design, &result_members)},
};
static const fg_members design_members = FG_MEMBERS(design_rows);

static const char *const change_names[] = {"mean_radius_at_design", "spread_within_foils_halved",
                                           "spread_between_foils_halved", "foils_sorted", NULL};

static const fg_member change_rows[] = {
    {FG_STRING("change", fg_lot_change, name), .choices = change_names,
     .options = FG_MEMBER_NEVER_NULL},
    {FG_STRING("words", fg_lot_change, words), .options = FG_MEMBER_NEVER_NULL,
     .page = {.rank = 1, .heading = "the same lot with", .words = true}},
    {FG_NUMBER("share", fg_lot_change, share), .words = "of the bearings that would assemble",
     .page = {.rank = 1, .heading = "assemble, %", .decimals = 1, .scale = 100}},
    {FG_NUMBER("gain", fg_lot_change, gain), .words = "over the lot as it is",
     .page = {.rank = 1, .heading = "change"}, .markup = put_gain},
    {FG_FLAG("clear", fg_lot_change, clear), .words = "more than twice the scatter of the draws"},
};
const fg_members fg_lot_change_members = FG_MEMBERS(change_rows);

/* Foils that are left out. */
static const char *find_foil_label(const fg_subject *subject, char *buffer) {
  (void)buffer;
  const fg_lot_analysis *analysis = subject->whole;
  return fg_manifest_label(&analysis->lot->manifest, ((const fg_lot_foil *)subject->object)->item);
}

static const char *find_reason(const fg_subject *subject, char *buffer) {
  (void)buffer;
  const fg_lot_analysis *analysis = subject->whole;
  return fg_lot_left_out_words(analysis->assembly.reason[subject->index]);
}

static const fg_member foil_rows[] = {
    {FG_INTEGER("number", fg_foil, number), .words = "of the foil in its scan"},
};
static const fg_members foil_members = FG_MEMBERS(foil_rows);

static const fg_member left_out_rows[] = {
    {FG_COUNT("input", fg_lot_foil, item), .words = "place of its scan in `inputs`"},
    {FG_TEXT_BY("label", find_foil_label), .options = FG_MEMBER_NEVER_NULL},
    {FG_SAME(&foil_members), .pointed = true, .offset = offsetof(fg_lot_foil, foil)},
    {FG_TEXT_BY("why", find_reason), .options = FG_MEMBER_NEVER_NULL},
};
static const fg_members left_out_members = FG_MEMBERS(left_out_rows);

static bool find_left_out(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_lot_analysis *analysis = list->whole;
  if (i >= analysis->foil_count) return false;
  bool in_stock = analysis->assembly.reason[i] == FG_LOT_IN_STOCK;
  element->object = in_stock ? NULL : &analysis->foils[i];
  return true;
}

static const char *statement_at(const fg_subject *subject, size_t i) {
  const fg_lot_assembly *assembly = subject->object;
  bool behind = i >= sizeof assembly->statement / sizeof *assembly->statement;
  return behind ? NULL : assembly->statement[i];
}

static const char *find_scope(const fg_subject *subject, char *buffer) {
  (void)subject, (void)buffer;
  return fg_assembly_scope;
}

#define REPLACEMENT "a bearing takes different foils, which go back after it"
static const char *find_replacement(const fg_subject *subject, char *buffer) {
  (void)subject, (void)buffer;
  return REPLACEMENT;
}

static fg_subject find_drawn(const fg_subject *subject) {
  const fg_lot_assembly *assembly = subject->object;
  return (fg_subject){.object = assembly->why[0] ? NULL : assembly, .whole = subject->whole};
}

static const fg_member drawn_rows[] = {
    {FG_OBJECT("drawn", fg_lot_assembly, drawn, &result_members)},
    {FG_GROUP("design", &design_members),
     .words = "bearings of the design beside them: every clearance anywhere within ± "
              "deviation_pct of the design's"},
    {FG_ARRAY("changes", fg_lot_assembly, change, changes, &fg_lot_change_members),
     .options = FG_MEMBER_ON_LINE,
     .words = "share of bearings that assemble of the same lot changed in one thing, the largest "
              "gain first"},
    {FG_COUNT("classes", fg_lot_assembly, classes), .words = "boxes that foils_sorted sorts into"},
};
static const fg_members drawn_members = FG_MEMBERS(drawn_rows);

static const fg_member assembly_rows[] = {
    {FG_COUNT("bearings", fg_lot_assembly, plan.bearings), .words = "that are drawn"},
    {FG_SEED("seed", fg_lot_assembly, plan.seed), .words = "of the draws"},
    {FG_COUNT("foils", fg_lot_assembly, stock.foils), .words = "in stock"},
    {FG_COUNT("pads", fg_lot_assembly, plan.layout.pads), .words = "foils of a bearing"},
    {FG_TEXT_BY("replacement", find_replacement), .schema = "{\"const\": \"" REPLACEMENT "\"}"},
    {FG_LIST_BY("left_out", find_left_out, &left_out_members), .options = FG_MEMBER_ON_LINE,
     .words = "foils that are not drawn from"},
    {FG_TEXT("why_none", fg_lot_assembly, why), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "why no bearings were drawn"},
    {FG_TEXTS_BY("statements", statement_at), .words = "the outcome in sentences"},
    {FG_TEXT_BY("scope", find_scope), .options = FG_MEMBER_NEVER_NULL,
     .words = "what drawn bearings do not tell: no rotordynamic simulation"},
    {FG_SAME(&drawn_members), .part = find_drawn},
};
const fg_members fg_lot_assembly_members = FG_MEMBERS_DEFINED(assembly_rows, "assembly");
