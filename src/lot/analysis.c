/* The lot as a whole: its foils, their verdicts, the worst of them. */
#include "lot/analysis.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

static fg_status list_foils(fg_context *ctx, fg_lot_analysis *analysis) {
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
      analysis->foils[analysis->foil_count++] =
          (fg_lot_foil){.item = i, .foil = &lot->records[i].foils[k]};
  }
  return FG_OK;
}

/* 1 at the limit of a two-sided tolerance, 0 in its middle. A one-sided tolerance has no width: the
 * distance counts in units of the limit. */
static double severity_of(const fg_judgement *judgement) {
  double lower = judgement->tolerance->lower, upper = judgement->tolerance->upper;
  double value = judgement->value;
  if (!isfinite(value)) return judgement->verdict == FG_VERDICT_NOT_MEASURED ? INFINITY : 0;
  if (isfinite(lower) && isfinite(upper) && upper > lower)
    return fabs(value - (lower + upper) / 2) / ((upper - lower) / 2);
  double limit = isfinite(upper) ? upper : lower,
         past = isfinite(upper) ? value - limit : limit - value;
  return 1 + past / (fabs(limit) > 0 ? fabs(limit) : 1);
}

static fg_status judge_foil(fg_context *ctx, const fg_lot *lot, fg_lot_foil *foil) {
  fg_judgement *list;
  size_t count;
  if (foil->foil->flags & FG_FOIL_NOT_MEASURED) {
    foil->verdict = FG_VERDICT_NOT_MEASURED;
    foil->severity = INFINITY;
    return FG_OK;
  }
  FG_TRY(fg_foil_judgements(ctx, &lot->settings.design, foil->foil, &list, &count));
  foil->verdict = fg_judgements_verdict(list, count);
  for (size_t i = 0; i < count; i++) {
    double severity = severity_of(&list[i]);
    foil->exceeded = foil->exceeded || list[i].exceeded;
    if (i && !(severity > foil->severity)) continue;
    foil->severity = severity;
    foil->worst_number = list[i].number;
    foil->worst_field = list[i].field;
    foil->worst_value = list[i].value;
  }
  free(list);
  return FG_OK;
}

/* Without tolerances the farthest height from the lot's mean is the worst. */
static void rank_by_spread(fg_lot_analysis *analysis) {
  const fg_lot_quantity *height = fg_lot_find_quantity(analysis, "height_mm");
  if (!height || !(height->sd > 0)) return;
  for (size_t i = 0; i < analysis->foil_count; i++) {
    fg_lot_foil *foil = &analysis->foils[i];
    for (size_t k = 0; k < foil->foil->bump_count; k++) {
      const fg_bump *bump = &foil->foil->bumps[k];
      double severity = fabs(bump->height_mm - height->mean) / height->sd;
      if (!(severity > foil->severity)) continue;
      foil->severity = severity;
      foil->worst_number = bump->number;
      foil->worst_field = height->field;
      foil->worst_value = bump->height_mm;
    }
  }
}

static void find_worst(fg_lot_analysis *analysis) {
  for (int place = 0; place < 3; place++)
    for (size_t i = 0; i < analysis->foil_count; i++) {
      const fg_lot_foil *foil = &analysis->foils[i];
      bool taken = false;
      for (int k = 0; k < place; k++)
        taken = taken || analysis->worst[k] == foil;
      if (taken) continue;
      if (!analysis->worst[place] || foil->severity > analysis->worst[place]->severity)
        analysis->worst[place] = foil;
    }
}

static fg_status judge_all(fg_context *ctx, fg_lot_analysis *analysis) {
  analysis->verdict = FG_VERDICT_NONE;
  for (size_t i = 0; i < analysis->foil_count; i++) {
    fg_lot_foil *foil = &analysis->foils[i];
    FG_TRY(judge_foil(ctx, analysis->lot, foil));
    analysis->by_verdict[foil->verdict]++;
    analysis->exceeded += foil->exceeded;
    analysis->verdict = i ? fg_verdict_worse(analysis->verdict, foil->verdict) : foil->verdict;
  }
  if (analysis->failed_scans)
    analysis->verdict = fg_verdict_worse(analysis->verdict, FG_VERDICT_NOT_MEASURED);
  return FG_OK;
}

const fg_lot_quantity *fg_lot_find_quantity(const fg_lot_analysis *analysis, const char *name) {
  for (size_t i = 0; i < analysis->quantity_count; i++)
    if (!strcmp(analysis->quantities[i].field->name, name)) return &analysis->quantities[i];
  return NULL;
}

fg_status fg_lot_spread_of(fg_context *ctx, const double *values, size_t count,
                           fg_bandwidth_rule rule, fg_lot_spread *spread) {
  fg_density density;
  double squares = 0;
  *spread =
      (fg_lot_spread){.count = count, .mode = NAN, .sd = NAN, .least = INFINITY, .most = -INFINITY};
  for (size_t i = 0; i < count; i++) {
    spread->mean += (values[i] - values[0]) / (double)count;
    spread->least = fmin(spread->least, values[i]);
    spread->most = fmax(spread->most, values[i]);
  }
  spread->mean = count ? spread->mean + values[0] : NAN;
  for (size_t i = 0; i < count; i++)
    squares += (values[i] - spread->mean) * (values[i] - spread->mean);
  if (count > 1) spread->sd = sqrt(squares / (double)(count - 1));
  spread->relative_sd_pct = 100 * spread->sd / fabs(spread->mean);
  if (!(spread->sd > 0)) return FG_OK;
  FG_TRY(fg_density_fit(ctx, values, count, rule, &density));
  spread->mode = fg_density_mode(&density);
  fg_density_free(&density);
  return FG_OK;
}

static fg_status analyse(fg_context *ctx, fg_lot_analysis *analysis) {
  FG_TRY(list_foils(ctx, analysis));
  FG_TRY(judge_all(ctx, analysis));
  FG_TRY(fg_lot_analyse_quantities(ctx, analysis));
  if (!analysis->lot->settings.design.tolerance_count) rank_by_spread(analysis);
  find_worst(analysis);
  FG_TRY(fg_lot_analyse_stiffness(ctx, analysis));
  FG_TRY(fg_lot_analyse_bearings(ctx, analysis));
  FG_TRY(fg_lot_analyse_groups(ctx, analysis));
  return fg_lot_analyse_gauge(ctx, analysis);
}

fg_status fg_lot_analyse(fg_context *ctx, const fg_lot *lot, fg_lot_analysis *analysis) {
  *analysis = (fg_lot_analysis){.lot = lot};
  fg_status status = analyse(ctx, analysis);
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
  free(analysis->bearings);
  free(analysis->differences);
  free(analysis->gauges);
  free(analysis->foils);
  *analysis = (fg_lot_analysis){0};
}
