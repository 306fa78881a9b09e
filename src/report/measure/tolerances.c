/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Verdicts by tolerances: the design names quantities, their rows read the values. The outcome
 * of a foil, a scan or a run is decided here and nowhere else. */
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "foilgauge/foil_kind.h"
#include "foilgauge/report.h"
#include "foilgauge/traceability.h"
#include "quantity/parts.h"
#include "quantity/quantity_rows.h"
#include "report/measure/cures.h"
#include "report/verdict_members.h"

fg_verdict fg_judge_value(const fg_tolerance *tolerance, double value, double u) {
  if (isnan(value)) return FG_VERDICT_NOT_MEASURED;
  double expanded = isnan(u) ? 0 : FG_COVERAGE_FACTOR * u;
  if (value + expanded < tolerance->lower || value - expanded > tolerance->upper)
    return FG_VERDICT_FAIL;
  if (value - expanded >= tolerance->lower && value + expanded <= tolerance->upper)
    return FG_VERDICT_PASS;
  return FG_VERDICT_UNDECIDED;
}

int fg_judgement_compare(const fg_judgement *a, const fg_judgement *b) {
  int ranks = fg_verdict_rank(b->verdict) - fg_verdict_rank(a->verdict);
  if (ranks) return ranks;
  if (a->severity != b->severity) return a->severity > b->severity ? -1 : 1;
  return a->number - b->number;
}

void fg_outcome_add(fg_report_outcome *sum, const fg_report_outcome *part) {
  sum->verdict = fg_verdict_worse(sum->verdict, part->verdict);
  sum->exceeded += part->exceeded;
  sum->undecided += part->undecided;
  sum->not_measured += part->not_measured;
  sum->rejected += part->rejected;
}

int fg_outcome_exit_code(const fg_report_outcome *outcome) {
  if (outcome->not_measured) return 2;
  if (outcome->verdict == FG_VERDICT_FAIL) return 1;
  return outcome->undecided ? 3 : 0;
}

static void add_unmeasured(fg_report_outcome *outcome) {
  fg_outcome_add(outcome,
                 &(fg_report_outcome){.verdict = FG_VERDICT_NOT_MEASURED, .not_measured = 1});
}

/* Returns the deviation that the tolerance allows. It is U at least, because values nearer than
 * U to each other are not told apart; a count without U differs by 1 at least. */
static double allowed_deviation(const fg_design *design, const fg_tolerance *tolerance,
                                const fg_quantity *row, double limit, double u) {
  double expanded = u > 0 ? FG_COVERAGE_FACTOR * u : 0, nominal = 0;
  double allowed = (tolerance->upper - tolerance->lower) / 2;
  if (!isfinite(allowed)) {
    fg_nominal derived;
    if (row->nominal && fg_design_derive(NULL, design, &derived) == FG_OK)
      nominal = row->nominal(design, &derived);
    allowed = fabs(limit - (isfinite(nominal) ? nominal : 0));
  }
  allowed = fmax(allowed, expanded);
  return allowed > 0 ? allowed : 1;
}

static double severity_of(const fg_design *design, const fg_tolerance *tolerance,
                          const fg_quantity *row, const fg_margin *margin, double u) {
  if (isnan(margin->inside)) return INFINITY;
  if (!isfinite(margin->limit)) return 0;
  return 1 - margin->inside / allowed_deviation(design, tolerance, row, margin->limit, u);
}

static bool is_by_micrometer(const fg_design *design, const fg_quantity *row) {
  return design->thickness_measured_mm > 0 && !strcmp(row->name, "thickness_mm");
}

fg_verdict fg_judge_measured(const fg_design *design, const fg_tolerance *tolerance,
                             const fg_quantity *row, double value, double u) {
  fg_verdict verdict = fg_judge_value(tolerance, value, u);
  bool decided = verdict == FG_VERDICT_PASS || verdict == FG_VERDICT_FAIL;
  bool may_judge = fg_design_may_judge(design) || is_by_micrometer(design, row);
  return decided && !may_judge ? FG_VERDICT_UNDECIDED : verdict;
}

static fg_judgement judge_quantity(const fg_design *design, const fg_tolerance *tolerance,
                                   const fg_quantity *row, const void *object, int number) {
  double value = fg_quantity_value(row, object), u = fg_quantity_uncertainty(row, object);
  fg_verdict verdict = fg_judge_measured(design, tolerance, row, value, u);
  fg_margin margin = fg_margin_to(tolerance->lower, tolerance->upper, value);
  return (fg_judgement){.tolerance = tolerance,
                        .row = row,
                        .number = number,
                        .value = value,
                        .u = u,
                        .margin = margin,
                        .severity = severity_of(design, tolerance, row, &margin, u),
                        .exceeded = verdict == FG_VERDICT_FAIL,
                        .verdict = verdict,
                        .cure = verdict == FG_VERDICT_UNDECIDED ? fg_cure_of(design, row) : NULL};
}

/* Judges a bump that the design states and the foil lacks. Behind the last bump that was found,
 * only the design claims that there is one: where the scan's border may hide it, it is not
 * measured. */
static fg_judgement judge_nothing(const fg_tolerance *tolerance, const fg_quantity *row, int number,
                                  bool hidden) {
  return (fg_judgement){.tolerance = tolerance,
                        .row = row,
                        .number = number,
                        .value = NAN,
                        .u = NAN,
                        .margin = fg_margin_to(tolerance->lower, tolerance->upper, NAN),
                        .severity = INFINITY,
                        .missing = !hidden,
                        .verdict = hidden ? FG_VERDICT_NOT_MEASURED : FG_VERDICT_FAIL};
}

/* Finds a part by its number, not its index: an empty place at the pitch makes numbers jump. */
static const void *find_part(const fg_foil *foil, fg_quantity_owner owner, int number) {
  for (size_t i = 0; i < fg_part_count(foil, owner); i++) {
    const fg_foil_part part = fg_part_at(foil, owner, i);
    if (part.number == number) return part.object;
  }
  return NULL;
}

static int last_found(const fg_foil *foil, fg_quantity_owner owner) {
  int last = 0;
  for (size_t i = 0; i < fg_part_count(foil, owner); i++) {
    int number = fg_part_at(foil, owner, i).number;
    if (number > last) last = number;
  }
  return last;
}

static int last_number(const fg_design *design, const fg_foil *foil) {
  int last = last_found(foil, fg_foil_kind_parts(design->kind)),
      stated = (int)fg_design_stated_parts(design);
  if (foil->flags & FG_FOIL_BEAM_PLACES_UNKNOWN) return last;
  return last > stated ? last : stated;
}

static bool lacks_parts(const fg_design *design, const fg_foil *foil) {
  return design->tolerance_count &&
         fg_part_count(foil, fg_foil_kind_parts(design->kind)) < fg_design_stated_parts(design);
}

static bool may_be_hidden(const fg_foil *foil) {
  return foil->flags & FG_FOIL_TOUCHES_BORDER;
}

/* Text after text, as far as there is room. */
__attribute__((format(printf, 3, 4))) static void add_words(char *words, size_t size,
                                                            const char *format, ...) {
  size_t used = strlen(words);
  va_list list;
  va_start(list, format);
  vsnprintf(words + used, size - used, format, list);
  va_end(list);
}

static int count_missing(const fg_foil *foil, fg_quantity_owner owner, int last) {
  int missing = 0;
  for (int number = 1; number <= last; number++)
    missing += find_part(foil, owner, number) == NULL;
  return missing;
}

/* "bumps 3, 7 are missing (7 found, the design has 9)" */
static void name_missing(const fg_design *design, const fg_foil *foil, char *words, size_t size) {
  enum { NAMED_MAX = 12 };
  fg_quantity_owner owner = fg_foil_kind_parts(design->kind);
  size_t found = fg_part_count(foil, owner), stated = fg_design_stated_parts(design);
  const char *word = fg_part_word(owner);
  int last = last_found(foil, owner), missing = count_missing(foil, owner, last);
  if (foil->flags & FG_FOIL_BEAM_PLACES_UNKNOWN) {
    add_words(words, size, "%zu of %zu %ss missing, which cannot be told", stated - found, stated,
              word);
    return;
  }
  if (!missing || !may_be_hidden(foil)) {
    last = last_number(design, foil);
    missing = count_missing(foil, owner, last);
  }
  add_words(words, size, missing == 1 ? "%s" : "%ss", word);
  for (int number = 1, named = 0; number <= last && named < NAMED_MAX; number++)
    if (!find_part(foil, owner, number))
      add_words(words, size, "%s %d", named++ ? "," : "", number);
  if (missing > NAMED_MAX) add_words(words, size, " and others");
  add_words(words, size, missing == 1 ? " is missing (%zu found" : " are missing (%zu found",
            found);
  if (stated) add_words(words, size, ", the design has %zu", stated);
  add_words(words, size, ")");
}

bool fg_foil_defect(const fg_design *design, const fg_foil *foil, char *words, size_t size) {
  char unused[1];
  fg_quantity_owner owner = fg_foil_kind_parts(design->kind);
  if (!words) {
    words = unused;
    size = sizeof unused;
  }
  words[0] = '\0';
  if (!fg_foil_is_measured(foil) || !fg_owner_is_part(owner)) return false;
  if (foil->flags & (FG_FOIL_MISSING_BUMP | FG_FOIL_MISSING_BEAM) ||
      (lacks_parts(design, foil) && !may_be_hidden(foil))) {
    name_missing(design, foil, words, size);
    return true;
  }
  size_t found = fg_part_count(foil, owner), stated = fg_design_stated_parts(design);
  if (!design->tolerance_count || !stated || found <= stated) return false;
  add_words(words, size, "%zu %ss where the design has %zu", found, fg_part_word(owner), stated);
  return true;
}

static fg_status allocate_judgements(fg_context *ctx, size_t count, size_t each,
                                     fg_decision *decision) {
  void *block;
  *decision = (fg_decision){.outcome = {.verdict = FG_VERDICT_NONE}};
  FG_TRY(fg_memory_allocate(ctx, count, each * sizeof *decision->judgements, &block));
  decision->judgements = block;
  return FG_OK;
}

static void add_judgement(fg_decision *decision, fg_judgement judgement) {
  fg_report_outcome *outcome = &decision->outcome;
  decision->judgements[decision->count++] = judgement;
  outcome->verdict = fg_verdict_worse(outcome->verdict, judgement.verdict);
  outcome->exceeded += judgement.exceeded;
  outcome->undecided += judgement.verdict == FG_VERDICT_UNDECIDED;
  outcome->not_measured += judgement.verdict == FG_VERDICT_NOT_MEASURED;
}

static void judge_parts(const fg_design *design, const fg_tolerance *tolerance,
                        const fg_quantity *row, fg_quantity_owner owner, const fg_foil *foil,
                        fg_decision *decision) {
  int found = last_found(foil, owner), last = last_number(design, foil);
  for (int number = 1; number <= last; number++) {
    const void *part = find_part(foil, owner, number);
    bool hidden = number > found && may_be_hidden(foil);
    add_judgement(decision, part ? judge_quantity(design, tolerance, row, part, number)
                                 : judge_nothing(tolerance, row, number, hidden));
  }
}

static bool is_sized(const fg_beam *beam) {
  return isfinite(beam->length_mm) && isfinite(beam->width_mm);
}

static bool is_foil_whole(const fg_design *design, const fg_foil *foil) {
  for (size_t i = 0; i < foil->beam_count; i++)
    if (!is_sized(&foil->beams[i])) return false;
  for (size_t i = 0; i < foil->bump_count; i++)
    if (foil->bumps[i].flags & FG_BUMP_NOT_FITTED) return false;
  return !(lacks_parts(design, foil) && may_be_hidden(foil));
}

/* Judges the foil as a whole, beyond its single values. */
static void judge_whole(const fg_design *design, const fg_foil *foil, fg_report_outcome *outcome) {
  if (fg_foil_defect(design, foil, NULL, 0)) {
    outcome->verdict = FG_VERDICT_FAIL;
    outcome->rejected = 1;
  }
  if (!outcome->not_measured && !is_foil_whole(design, foil)) add_unmeasured(outcome);
}

fg_status fg_foil_decide(fg_context *ctx, const fg_design *design, const fg_foil *foil,
                         fg_decision *decision) {
  const fg_quantity_owner owner = fg_foil_kind_parts(design->kind);
  size_t parts = fg_owner_is_part(owner) ? (size_t)last_number(design, foil) : 0;
  FG_TRY(allocate_judgements(ctx, design->tolerance_count, parts + 1, decision));
  if (!fg_foil_is_measured(foil)) {
    add_unmeasured(&decision->outcome);
    return FG_OK;
  }
  for (size_t i = 0; i < design->tolerance_count; i++) {
    const fg_tolerance *tolerance = &design->tolerances[i];
    const fg_quantity *row = fg_quantity_find(FG_QUANTITY_OF_FOIL, tolerance->quantity);
    if (row) add_judgement(decision, judge_quantity(design, tolerance, row, foil, 0));
    row = fg_owner_is_part(owner) ? fg_quantity_find(owner, tolerance->quantity) : NULL;
    if (row) judge_parts(design, tolerance, row, owner, foil, decision);
  }
  judge_whole(design, foil, &decision->outcome);
  return FG_OK;
}

fg_status fg_disc_decide(fg_context *ctx, const fg_design *design, const fg_disc *disc,
                         fg_decision *decision) {
  FG_TRY(allocate_judgements(ctx, design->tolerance_count, 1, decision));
  for (size_t i = 0; i < design->tolerance_count; i++) {
    const fg_tolerance *tolerance = &design->tolerances[i];
    const fg_quantity *row = fg_quantity_find(FG_QUANTITY_OF_DISC, tolerance->quantity);
    if (row) add_judgement(decision, judge_quantity(design, tolerance, row, disc, disc->number));
  }
  return FG_OK;
}

/* Judges a bearing with unknown places, one of which may be the lowest of all: known places give
 * an upper bound of the smallest clearance, and nothing on circularity. */
static fg_judgement judge_part(const fg_tolerance *tolerance, fg_judgement judgement) {
  bool min = judgement.row == fg_quantity_of_bearing_for("clearance_min_mm") ||
             judgement.row == fg_quantity_of_bearing_for("clearance_centred_min_mm");
  double expanded = isnan(judgement.u) ? 0 : FG_COVERAGE_FACTOR * judgement.u;
  if (min && judgement.value + expanded < tolerance->lower) return judgement;
  judgement.verdict = FG_VERDICT_NOT_MEASURED;
  judgement.exceeded = false;
  return judgement;
}

fg_status fg_bearing_decide(fg_context *ctx, const fg_design *design,
                            const fg_bearing_clearance *clearance, bool whole,
                            fg_decision *decision) {
  static const fg_bearing_clearance unknown = {
      .mean_mm = NAN,
      .min_mm = NAN,
      .max_mm = NAN,
      .circularity_mm = NAN,
      .centred_min_mm = NAN,
  };
  FG_TRY(allocate_judgements(ctx, design->tolerance_count, 1, decision));
  for (size_t i = 0; i < design->tolerance_count; i++) {
    const fg_tolerance *tolerance = &design->tolerances[i];
    const fg_quantity *row = fg_quantity_of_bearing_for(tolerance->quantity);
    if (!row) continue;
    fg_judgement judgement =
        judge_quantity(design, tolerance, row, clearance ? clearance : &unknown, 0);
    add_judgement(decision, clearance && whole ? judgement : judge_part(tolerance, judgement));
  }
  return FG_OK;
}

void fg_decision_free(fg_decision *decision) {
  free(decision->judgements);
  *decision = (fg_decision){.outcome = {.verdict = FG_VERDICT_NONE}};
}

static fg_verdict object_verdict(const fg_design *design, fg_quantity_owner owner,
                                 const void *object) {
  fg_verdict verdict = FG_VERDICT_NONE;
  for (size_t i = 0; i < design->tolerance_count; i++) {
    const fg_quantity *row = fg_quantity_find(owner, design->tolerances[i].quantity);
    if (row)
      verdict = fg_verdict_worse(
          verdict, judge_quantity(design, &design->tolerances[i], row, object, 0).verdict);
  }
  return verdict;
}

fg_verdict fg_bump_verdict(const fg_design *design, const fg_foil *foil, const fg_bump *bump) {
  if (!fg_foil_is_measured(foil)) return FG_VERDICT_NOT_MEASURED;
  fg_verdict verdict = object_verdict(design, FG_QUANTITY_OF_BUMP, bump);
  if (bump->flags & FG_BUMP_NOT_FITTED)
    verdict = fg_verdict_worse(verdict, FG_VERDICT_NOT_MEASURED);
  return verdict;
}

static unsigned reported(unsigned flags, fg_verdict verdict) {
  flags &= ~(unsigned)FG_BUMP_OUT_OF_TOLERANCE;
  return verdict == FG_VERDICT_FAIL ? flags | FG_BUMP_OUT_OF_TOLERANCE : flags;
}

unsigned fg_bump_flags(const fg_design *design, const fg_foil *foil, const fg_bump *bump) {
  return reported(bump->flags, fg_bump_verdict(design, foil, bump));
}

fg_verdict fg_beam_verdict(const fg_design *design, const fg_foil *foil, const fg_beam *beam) {
  if (!fg_foil_is_measured(foil)) return FG_VERDICT_NOT_MEASURED;
  fg_verdict verdict = object_verdict(design, FG_QUANTITY_OF_BEAM, beam);
  return is_sized(beam) ? verdict : fg_verdict_worse(verdict, FG_VERDICT_NOT_MEASURED);
}

unsigned fg_beam_flags(const fg_design *design, const fg_foil *foil, const fg_beam *beam) {
  unsigned flags = beam->flags & ~(unsigned)FG_BEAM_OUT_OF_TOLERANCE;
  bool out = fg_beam_verdict(design, foil, beam) == FG_VERDICT_FAIL;
  return out ? flags | FG_BEAM_OUT_OF_TOLERANCE : flags;
}

unsigned fg_disc_flags(const fg_design *design, const fg_disc *disc) {
  return reported(disc->flags, object_verdict(design, FG_QUANTITY_OF_DISC, disc));
}

static void add_decision(fg_report_outcome *outcome, fg_decision *decision) {
  fg_outcome_add(outcome, &decision->outcome);
  fg_decision_free(decision);
}

fg_status fg_report_judge_scan(fg_context *ctx, const fg_design *design, const fg_report_scan *scan,
                               fg_report_outcome *outcome) {
  const fg_measurement *measurement = scan->measurement;
  fg_decision decision;
  *outcome = (fg_report_outcome){.verdict = FG_VERDICT_NONE};
  if (!measurement) add_unmeasured(outcome);
  for (size_t k = 0; measurement && k < measurement->foil_count; k++) {
    FG_TRY(fg_foil_decide(ctx, design, &measurement->foils[k], &decision));
    add_decision(outcome, &decision);
  }
  for (size_t k = 0; measurement && k < measurement->disc_count; k++) {
    FG_TRY(fg_disc_decide(ctx, design, &measurement->discs[k], &decision));
    add_decision(outcome, &decision);
  }
  return FG_OK;
}

fg_status fg_report_judge(fg_context *ctx, const fg_report *report, fg_report_outcome *outcome) {
  *outcome = (fg_report_outcome){.verdict = FG_VERDICT_NONE};
  for (size_t i = 0; i < report->scan_count; i++) {
    fg_report_outcome scan;
    FG_TRY(fg_report_judge_scan(ctx, report->design, &report->scans[i], &scan));
    fg_outcome_add(outcome, &scan);
  }
  return FG_OK;
}

static bool has_quantity(fg_quantity_owner owner, fg_foil_kind kind, const char *name) {
  const fg_quantity *row = fg_quantity_find(owner, name);
  return row && row->kind != FG_QUANTITY_PAIR && fg_quantity_applies(owner, row, kind);
}

static void list_bearing(char *text, size_t size) {
  size_t count;
  const fg_quantity *rows = fg_quantities(FG_QUANTITY_OF_BEARING, &count);
  for (size_t i = 0; i < count; i++)
    if (rows[i].tolerance) add_words(text, size, ", %s", rows[i].tolerance);
}

size_t fg_report_of_bearing(const fg_design *design, char *names, size_t size) {
  size_t count = 0;
  if (names) names[0] = 0;
  for (size_t i = 0; i < design->tolerance_count; i++) {
    const char *quantity = design->tolerances[i].quantity;
    if (!fg_quantity_of_bearing_for(quantity)) continue;
    if (names) add_words(names, size, "%s%s", count ? ", " : "", quantity);
    count++;
  }
  return count;
}

fg_status fg_report_check_tolerances(fg_context *ctx, const fg_design *design) {
  const fg_foil_traits *kind = fg_foil_traits_of(design->kind);
  for (size_t i = 0; i < design->tolerance_count; i++) {
    const char *quantity = design->tolerances[i].quantity;
    if (has_quantity(kind->part, design->kind, quantity)) continue;
    if (kind->is_foil && has_quantity(FG_QUANTITY_OF_FOIL, design->kind, quantity)) continue;
    if (kind->has_bumps && fg_quantity_of_bearing_for(quantity)) continue;
    char names[1000] = "";
    fg_quantity_list(kind->part, design->kind, true, names, sizeof names);
    if (kind->is_foil)
      fg_quantity_list(FG_QUANTITY_OF_FOIL, design->kind, true, names, sizeof names);
    if (kind->has_bumps) list_bearing(names, sizeof names);
    return fg_fail(ctx, FG_ERR_DATA, "tolerances.%s: no such quantity is reported; there are: %s",
                   quantity, names);
  }
  return FG_OK;
}
