/* Tolerances: the design names quantities, the table of fields says where they lie. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "foilgauge/report.h"

const char *fg_verdict_word(fg_verdict verdict) {
  switch (verdict) {
  case FG_VERDICT_PASS:
    return "pass";
  case FG_VERDICT_FAIL:
    return "fail";
  case FG_VERDICT_UNDECIDED:
    return "cannot_tell";
  case FG_VERDICT_NOT_MEASURED:
    return "not_measured";
  case FG_VERDICT_NONE:
    return "no_tolerance";
  }
  return "";
}

static bool is_exceeded(const fg_tolerance *tolerance, double value) {
  return value < tolerance->lower || value > tolerance->upper;
}

fg_verdict fg_judge_value(const fg_tolerance *tolerance, double value, double u) {
  if (isnan(value)) return FG_VERDICT_NOT_MEASURED;
  double expanded = isnan(u) ? 0 : FG_COVERAGE_FACTOR * u;
  if (value + expanded < tolerance->lower || value - expanded > tolerance->upper)
    return FG_VERDICT_FAIL;
  if (value - expanded >= tolerance->lower && value + expanded <= tolerance->upper)
    return FG_VERDICT_PASS;
  return FG_VERDICT_UNDECIDED;
}

/* `object` NULL: the design states it and the part lacks it. */
static fg_judgement judge(const fg_tolerance *tolerance, const fg_report_field *field,
                          const void *object, int number) {
  double value = object ? fg_report_value(field, object) : NAN;
  double u = object ? fg_report_uncertainty(field, object) : NAN;
  return (fg_judgement){.tolerance = tolerance,
                        .field = field,
                        .number = number,
                        .value = value,
                        .u = u,
                        .exceeded = is_exceeded(tolerance, value),
                        .verdict = fg_judge_value(tolerance, value, u)};
}

/* A place at the pitch that is empty makes numbers jump: look for the number, not the index. */
static const fg_bump *find_bump(const fg_foil *foil, int number) {
  for (size_t i = 0; i < foil->bump_count; i++)
    if (foil->bumps[i].number == number) return &foil->bumps[i];
  return NULL;
}

static int last_bump_number(const fg_design *design, const fg_foil *foil) {
  int last = (int)design->bump_count;
  for (size_t i = 0; i < foil->bump_count; i++)
    if (foil->bumps[i].number > last) last = foil->bumps[i].number;
  return last;
}

fg_status fg_foil_judgements(fg_context *ctx, const fg_design *design, const fg_foil *foil,
                             fg_judgement **list, size_t *count) {
  int last = last_bump_number(design, foil);
  void *block;
  *list = NULL;
  *count = 0;
  FG_TRY(
      fg_memory_allocate(ctx, design->tolerance_count, ((size_t)last + 1) * sizeof **list, &block));
  *list = block;
  for (size_t i = 0; i < design->tolerance_count; i++) {
    const fg_tolerance *tolerance = &design->tolerances[i];
    const fg_report_field *field = fg_report_find(FG_REPORT_FOIL, tolerance->quantity);
    if (field) (*list)[(*count)++] = judge(tolerance, field, foil, 0);
    field = fg_report_find(FG_REPORT_BUMP, tolerance->quantity);
    for (int number = 1; field && number <= last; number++)
      (*list)[(*count)++] = judge(tolerance, field, find_bump(foil, number), number);
  }
  return FG_OK;
}

fg_status fg_disc_judgements(fg_context *ctx, const fg_design *design, const fg_disc *disc,
                             fg_judgement **list, size_t *count) {
  void *block;
  *list = NULL;
  *count = 0;
  FG_TRY(fg_memory_allocate(ctx, design->tolerance_count, sizeof **list, &block));
  *list = block;
  for (size_t i = 0; i < design->tolerance_count; i++) {
    const fg_tolerance *tolerance = &design->tolerances[i];
    const fg_report_field *field = fg_report_find(FG_REPORT_DISC, tolerance->quantity);
    if (field) (*list)[(*count)++] = judge(tolerance, field, disc, disc->number);
  }
  return FG_OK;
}

fg_verdict fg_verdict_worse(fg_verdict a, fg_verdict b) {
  static const int severity[] = {
      [FG_VERDICT_NONE] = 0,         [FG_VERDICT_PASS] = 1, [FG_VERDICT_UNDECIDED] = 2,
      [FG_VERDICT_NOT_MEASURED] = 3, [FG_VERDICT_FAIL] = 4,
  };
  return severity[a] >= severity[b] ? a : b;
}

fg_verdict fg_judgements_verdict(const fg_judgement *list, size_t count) {
  fg_verdict verdict = FG_VERDICT_NONE;
  for (size_t i = 0; i < count; i++)
    verdict = fg_verdict_worse(verdict, list[i].verdict);
  return verdict;
}

static bool object_exceeds(const fg_design *design, fg_report_owner owner, const void *object) {
  for (size_t i = 0; i < design->tolerance_count; i++) {
    const fg_report_field *field = fg_report_find(owner, design->tolerances[i].quantity);
    if (field && is_exceeded(&design->tolerances[i], fg_report_value(field, object))) return true;
  }
  return false;
}

void fg_foil_judge(const fg_design *design, fg_foil *foil) {
  foil->in_tolerance = !object_exceeds(design, FG_REPORT_FOIL, foil);
  for (size_t i = 0; i < foil->bump_count; i++) {
    fg_bump *bump = &foil->bumps[i];
    bump->flags &= ~(unsigned)FG_BUMP_OUT_OF_TOLERANCE;
    if (!object_exceeds(design, FG_REPORT_BUMP, bump)) continue;
    bump->flags |= FG_BUMP_OUT_OF_TOLERANCE;
    foil->in_tolerance = false;
  }
}

static void summarise(const fg_judgement *list, size_t count, fg_report_outcome *outcome) {
  outcome->verdict = fg_verdict_worse(outcome->verdict, fg_judgements_verdict(list, count));
  for (size_t i = 0; i < count; i++) {
    if (list[i].exceeded) outcome->exceeded++;
    if (list[i].verdict == FG_VERDICT_NOT_MEASURED) outcome->not_measured++;
  }
}

static void add_unmeasured(fg_report_outcome *outcome) {
  outcome->verdict = fg_verdict_worse(outcome->verdict, FG_VERDICT_NOT_MEASURED);
  outcome->not_measured++;
}

static fg_status add_foil(fg_context *ctx, const fg_design *design, const fg_foil *foil,
                          fg_report_outcome *outcome) {
  fg_judgement *list;
  size_t count;
  if (foil->flags & FG_FOIL_NOT_MEASURED) {
    add_unmeasured(outcome);
    return FG_OK;
  }
  FG_TRY(fg_foil_judgements(ctx, design, foil, &list, &count));
  summarise(list, count, outcome);
  free(list);
  return FG_OK;
}

static fg_status add_disc(fg_context *ctx, const fg_design *design, const fg_disc *disc,
                          fg_report_outcome *outcome) {
  fg_judgement *list;
  size_t count;
  FG_TRY(fg_disc_judgements(ctx, design, disc, &list, &count));
  summarise(list, count, outcome);
  free(list);
  return FG_OK;
}

fg_status fg_report_judge(fg_context *ctx, const fg_report *report, fg_report_outcome *outcome) {
  *outcome = (fg_report_outcome){.verdict = FG_VERDICT_NONE};
  for (size_t i = 0; i < report->scan_count; i++) {
    const fg_measurement *measurement = report->scans[i].measurement;
    if (!measurement) add_unmeasured(outcome);
    for (size_t k = 0; measurement && k < measurement->foil_count; k++)
      FG_TRY(add_foil(ctx, report->design, &measurement->foils[k], outcome));
    for (size_t k = 0; measurement && k < measurement->disc_count; k++)
      FG_TRY(add_disc(ctx, report->design, &measurement->discs[k], outcome));
  }
  return FG_OK;
}

static void append_names(fg_report_owner owner, char *names, size_t size) {
  size_t count;
  const fg_report_field *fields = fg_report_fields(owner, &count);
  for (size_t i = 0; i < count; i++) {
    size_t used = strlen(names);
    if (fields[i].kind != FG_FIELD_PAIR)
      snprintf(names + used, size - used, "%s%s", used ? ", " : "", fields[i].name);
  }
}

static bool has_quantity(fg_report_owner owner, const char *name) {
  const fg_report_field *field = fg_report_find(owner, name);
  return field && field->kind != FG_FIELD_PAIR;
}

fg_status fg_report_check_tolerances(fg_context *ctx, const fg_design *design) {
  bool discs = design->form == FG_FORM_DISCS;
  for (size_t i = 0; i < design->tolerance_count; i++) {
    const char *quantity = design->tolerances[i].quantity;
    if (has_quantity(discs ? FG_REPORT_DISC : FG_REPORT_BUMP, quantity)) continue;
    if (!discs && has_quantity(FG_REPORT_FOIL, quantity)) continue;
    char names[800] = "";
    append_names(discs ? FG_REPORT_DISC : FG_REPORT_BUMP, names, sizeof names);
    if (!discs) append_names(FG_REPORT_FOIL, names, sizeof names);
    return fg_fail(ctx, FG_ERR_DATA, "tolerances.%s: no such quantity is reported; there are: %s",
                   quantity, names);
  }
  return FG_OK;
}
