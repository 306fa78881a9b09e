/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Foils of the lot, their verdicts, and the worst of them. */
#include "lot/statistics/analysis.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "foilgauge/foil_kind.h"
#include "report/measure/scan_model_words.h"

static fg_status list_lot_foils(fg_context *ctx, fg_lot_analysis *analysis) {
  const fg_lot *lot = analysis->lot;
  size_t count = 0;
  void *block;
  for (size_t i = 0; i < lot->manifest.items; i++)
    count += lot->records[i].foil_count;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *analysis->foils, &block));
  analysis->foils = block;
  for (size_t i = 0; i < lot->manifest.items; i++) {
    analysis->failed_scans += lot->records[i].error != NULL;
    for (size_t k = 0; k < lot->records[i].foil_count; k++)
      analysis->foils[analysis->foil_count++] = (fg_lot_foil){.item = i,
                                                              .foil = &lot->records[i].foils[k],
                                                              .worst_value = NAN,
                                                              .worst_u = NAN,
                                                              .worst_limit = NAN,
                                                              .worst_margin = NAN};
  }
  return FG_OK;
}

/* Finds the scans that show one foil (column `foil`). */
static fg_status find_scans_of_foils(fg_context *ctx, fg_lot_analysis *analysis) {
  size_t count = analysis->foil_count, *owner;
  bool *measured = NULL;
  fg_status status = FG_OK;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *owner, (void **)&owner));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *measured, (void **)&measured));
  FG_TRY_EXIT(fg_lot_find_owners(ctx, analysis, owner));
  for (size_t i = 0; i < count; i++) {
    fg_lot_foil *foil = &analysis->foils[i];
    foil->owner = owner[i];
    foil->again = measured[owner[i]];
    measured[owner[i]] = measured[owner[i]] || fg_foil_is_measured(foil->foil);
    analysis->scanned_again += foil->again;
  }
exit:
  free(owner);
  free(measured);
  return status;
}

static void find_worst_value(const fg_decision *decision, fg_lot_foil *foil) {
  const fg_judgement *worst = NULL;
  for (size_t i = 0; i < decision->count; i++)
    if (!worst || fg_judgement_compare(&decision->judgements[i], worst) < 0)
      worst = &decision->judgements[i];
  if (!worst) return;
  foil->severity = worst->severity;
  foil->worst_number = worst->number;
  foil->worst_row = worst->row;
  foil->worst_value = worst->value;
  foil->worst_u = worst->u;
  foil->worst_limit = worst->margin.limit;
  foil->worst_margin = worst->margin.inside;
}

static fg_status decide_foil(fg_context *ctx, fg_lot_analysis *analysis, fg_lot_foil *foil) {
  fg_decision decision;
  FG_TRY(fg_foil_decide(ctx, &analysis->lot->settings.design, foil->foil, &decision));
  fg_outcome_add(&analysis->outcome, &decision.outcome);
  foil->verdict = decision.outcome.verdict;
  foil->exceeded = decision.outcome.exceeded > 0;
  find_worst_value(&decision, foil);
  if (decision.outcome.rejected || !fg_foil_is_measured(foil->foil)) foil->severity = INFINITY;
  fg_decision_free(&decision);
  return FG_OK;
}

/* Ranks foils without ranking parts by the distance of one of their own quantities from the lot's
 * mean. */
static void rank_foils_by_spread(fg_lot_analysis *analysis, const char *name) {
  const fg_lot_quantity *quantity = fg_lot_find_quantity(analysis, name);
  for (size_t i = 0; quantity && quantity->sd > 0 && i < analysis->foil_count; i++) {
    fg_lot_foil *foil = &analysis->foils[i];
    if (!fg_foil_is_measured(foil->foil)) continue;
    foil->worst_row = quantity->row;
    foil->worst_value = fg_quantity_value(quantity->row, foil->foil);
    foil->worst_u = fg_quantity_uncertainty(quantity->row, foil->foil);
    foil->severity = fabs(foil->worst_value - quantity->mean) / quantity->sd;
  }
}

/* Ranks foils without tolerances by the distance of the leading quantity (heights of bumps) from
 * the lot's mean. */
static void rank_by_spread(fg_lot_analysis *analysis) {
  const char *of_foils = fg_foil_traits_of(analysis->lot->settings.design.kind)->ranked_by;
  if (of_foils) {
    rank_foils_by_spread(analysis, of_foils);
    return;
  }
  const fg_lot_quantity *leading = fg_lot_leading_quantity(analysis);
  if (!leading || !(leading->sd > 0)) return;
  for (size_t i = 0; i < analysis->foil_count; i++) {
    fg_lot_foil *foil = &analysis->foils[i];
    for (size_t k = 0; k < fg_part_count(foil->foil, leading->owner); k++) {
      const fg_foil_part part = fg_part_at(foil->foil, leading->owner, k);
      double value = fg_quantity_value(leading->row, part.object);
      double severity = fabs(value - leading->mean) / leading->sd;
      if (!(severity > foil->severity)) continue;
      foil->severity = severity;
      foil->worst_number = part.number;
      foil->worst_row = leading->row;
      foil->worst_value = value;
      foil->worst_u = fg_quantity_uncertainty(leading->row, part.object);
    }
  }
}

/* Compares verdicts first, then severities. */
static bool is_worse_foil(const fg_lot_foil *foil, const fg_lot_foil *than) {
  if (foil->verdict != than->verdict)
    return fg_verdict_worse(foil->verdict, than->verdict) == foil->verdict;
  return foil->severity > than->severity;
}

static void find_worst_three(fg_lot_analysis *analysis) {
  for (int place = 0; place < FG_LOT_WORST; place++)
    for (size_t i = 0; i < analysis->foil_count; i++) {
      const fg_lot_foil *foil = &analysis->foils[i];
      bool taken = false;
      for (int k = 0; k < place; k++)
        taken = taken || analysis->worst[k]->owner == foil->owner;
      if (taken) continue;
      if (!analysis->worst[place] || is_worse_foil(foil, analysis->worst[place]))
        analysis->worst[place] = foil;
    }
}

static fg_status decide_foils(fg_context *ctx, fg_lot_analysis *analysis) {
  analysis->outcome = (fg_report_outcome){.verdict = FG_VERDICT_NONE};
  for (size_t i = 0; i < analysis->foil_count; i++) {
    fg_lot_foil *foil = &analysis->foils[i];
    FG_TRY(decide_foil(ctx, analysis, foil));
    analysis->by_verdict[foil->verdict]++;
    analysis->exceeded += foil->exceeded;
  }
  fg_report_outcome failed = {.verdict = FG_VERDICT_NOT_MEASURED,
                              .not_measured = analysis->failed_scans};
  if (analysis->failed_scans) fg_outcome_add(&analysis->outcome, &failed);
  return FG_OK;
}

bool fg_lot_foil_is_good(const fg_lot_foil *foil) {
  return foil->verdict == FG_VERDICT_PASS || foil->verdict == FG_VERDICT_NONE;
}

/* Rows of the page are limited: nobody reads 100,000. */
static void choose_listed_foils(fg_lot_analysis *analysis) {
  size_t rows = 0;
  for (int good = 0; good < 2; good++)
    for (size_t i = 0; i < analysis->foil_count && rows < FG_LOT_FOIL_ROWS_MAX; i++)
      if (fg_lot_foil_is_good(&analysis->foils[i]) == (good == 1)) {
        analysis->foils[i].row = true;
        rows++;
      }
}

static void count_parts(fg_lot_analysis *analysis) {
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const fg_foil *foil = analysis->foils[i].foil;
    size_t parts = fg_foil_is_measured(foil) ? fg_part_count(foil, analysis->parts) : 0;
    for (size_t k = 0; k < parts; k++) {
      const fg_foil_part part = fg_part_at(foil, analysis->parts, k);
      analysis->left_out += !fg_lot_part_counts(foil, analysis->parts, &part);
    }
    analysis->part_count += parts;
  }
}

static fg_status analyse_records(fg_context *ctx, fg_lot_analysis *analysis) {
  analysis->parts = fg_foil_kind_parts(analysis->lot->settings.design.kind);
  FG_TRY(list_lot_foils(ctx, analysis));
  FG_TRY(find_scans_of_foils(ctx, analysis));
  count_parts(analysis);
  analysis->repeated = fg_lot_find_repeats(analysis->lot);
  analysis->invalid_dates = fg_lot_date_find_invalid(&analysis->lot->manifest);
  fg_lot_date_find(analysis->lot, &analysis->date);
  FG_TRY(decide_foils(ctx, analysis));
  choose_listed_foils(analysis);
  FG_TRY(fg_lot_analyse_quantities(ctx, analysis));
  FG_TRY(fg_lot_analyse_causes(ctx, analysis));
  fg_lot_find_mean_u(analysis);
  bool bumps = fg_foil_kind_has_bumps(analysis->lot->settings.design.kind);
  if (bumps) FG_TRY(fg_lot_analyse_correlation(ctx, analysis));
  const fg_design *design = &analysis->lot->settings.design;
  if (design->tolerance_count == fg_report_of_bearing(design, NULL, 0)) rank_by_spread(analysis);
  find_worst_three(analysis);
  fg_lot_analyse_thickness(analysis);
  if (bumps) FG_TRY(fg_lot_analyse_stiffness(ctx, analysis));
  if (bumps) FG_TRY(fg_lot_analyse_bearings(ctx, analysis));
  if (bumps) FG_TRY(fg_lot_analyse_assembly(ctx, analysis));
  if (bumps) fg_lot_analyse_dies(analysis);
  FG_TRY(fg_lot_analyse_groups(ctx, analysis));
  return fg_lot_analyse_gauge(ctx, analysis);
}

fg_status fg_lot_analyse(fg_context *ctx, const fg_lot *lot, fg_lot_analysis *analysis) {
  *analysis = (fg_lot_analysis){.lot = lot};
  fg_status status = analyse_records(ctx, analysis);
  if (status != FG_OK) fg_lot_analysis_free(analysis);
  return status;
}

void fg_lot_analysis_free(fg_lot_analysis *analysis) {
  for (size_t i = 0; i < analysis->quantity_count; i++) {
    fg_lot_quantity *quantity = &analysis->quantities[i];
    free(quantity->value);
    free(quantity->size);
    free(quantity->place);
    fg_density_free(&quantity->density);
    fg_chart_free(&quantity->chart);
    fg_chart_free(&quantity->means);
    fg_chart_free(&quantity->deviations);
  }
  free(analysis->quantities);
  free(analysis->stiffness.normalised);
  for (size_t i = 0; i < analysis->bearing_count; i++) {
    fg_decision_free(&analysis->bearings[i].decision);
    free(analysis->bearings[i].pad);
    free(analysis->bearings[i].angle_deg);
  }
  free(analysis->bearings);
  fg_lot_assembly_free(&analysis->assembly);
  free(analysis->differences);
  free(analysis->gauges);
  free(analysis->foils);
  *analysis = (fg_lot_analysis){0};
}

fg_correction fg_lot_correction_largest(const fg_lot_analysis *analysis) {
  fg_correction max = {NAN, NAN, NAN, NAN, NAN, NAN};
  for (size_t i = 0; analysis->lot->model && i < analysis->foil_count; i++)
    if (fg_foil_is_measured(analysis->foils[i].foil))
      fg_correction_largest(&max, &analysis->foils[i].foil->correction);
  return max;
}
