/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sentences of the page over lots. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/text.h"
#include "core/utf8.h"
#include "foilgauge/words.h"
#include "lots/index.h"

enum {
  SAID_MAX = 3,    /* quantities with a sentence of their own */
  LISTED_MAX = 12, /* lots that a sentence can list */
  VALUE = 80,
  DECIMALS_MAX = 8,
  RATIO_DECIMALS = 4
};

size_t fg_index_number(const fg_index *index, const fg_index_lot *lot) {
  return (size_t)(lot - index->lots) + 1;
}

void fg_index_clip_name(const char *name, size_t letters, char *text, size_t size) {
  size_t end = 0, count = 0;
  for (; name[end] && count < letters; count++) {
    size_t length = fg_utf8_length(name + end);
    end += length ? length : 1;
  }
  fg_text_clip(text, size, "%.*s%s", (int)end, name, name[end] ? "…" : "");
}

static const char *unit_behind(const fg_index_axis *axis, char space[8]) {
  const char *unit = fg_index_unit(axis);
  fg_text_clip(space, 8, "%s%s", *unit && strcmp(unit, "°") != 0 ? " " : "", unit);
  return space;
}

static int axis_decimals(const fg_index_axis *axis) {
  if (axis->scale == FG_INDEX_OVER_DESIGN) return RATIO_DECIMALS;
  return axis->row->decimals < DECIMALS_MAX ? axis->row->decimals : DECIMALS_MAX;
}

void fg_index_value(const fg_index_axis *axis, double value, char *text, size_t size) {
  char unit[8];
  if (isfinite(value))
    fg_text_clip(text, size, "%s%.*f%s", value < 0 ? "−" : "", axis_decimals(axis), fabs(value),
                 unit_behind(axis, unit));
  else
    fg_text_clip(text, size, "–");
}

void fg_index_difference(const fg_index_axis *axis, const fg_index_pair *pair, char *text,
                         size_t size) {
  char unit[8];
  double reach = (pair->high - pair->low) / 2;
  /* Two digits of the half interval. */
  int decimals = isfinite(reach) && reach > 0 ? 1 - (int)floor(log10(reach)) : axis_decimals(axis);
  decimals = decimals < 0 ? 0 : decimals > DECIMALS_MAX ? DECIMALS_MAX : decimals;
  if (isfinite(reach))
    fg_text_clip(text, size, "%.*f ± %.*f%s", decimals, pair->difference, decimals, reach,
                 unit_behind(axis, unit));
  else
    fg_text_clip(text, size, "%.*f%s", decimals, pair->difference, unit_behind(axis, unit));
}

void fg_index_p(double p, char *text, size_t size) {
  if (isnan(p))
    fg_text_clip(text, size, "–");
  else if (p < 1e-4)
    fg_text_clip(text, size, "< 0.0001");
  else
    fg_text_clip(text, size, "%.2g", p);
}

static fg_status name_dies_of(fg_context *ctx, const fg_index *index, fg_index_lot *lot) {
  for (size_t die = 0; die < index->die_count; die++) {
    bool has = false;
    for (size_t i = 0; i < lot->foil_count && !has; i++)
      has = lot->die[i] == die;
    if (has)
      FG_TRY(fg_text_append(ctx, &lot->die_names, "%s%s", lot->die_names ? ", " : "",
                            index->dies[die].name));
  }
  return FG_OK;
}

fg_status fg_index_name_dies(fg_context *ctx, fg_index *index) {
  for (size_t i = 0; i < index->count; i++)
    FG_TRY(name_dies_of(ctx, index, &index->lots[i]));
  return FG_OK;
}

static fg_status append_sentence(fg_context *ctx, fg_index *index, char *sentence) {
  fg_status status = fg_memory_reserve(ctx, index->sentence_count + 1, sizeof *index->sentences,
                                       &index->sentence_capacity, (void **)&index->sentences);
  if (status == FG_OK)
    index->sentences[index->sentence_count++] = sentence;
  else
    free(sentence);
  return status;
}

/* "Bump radius", "Bump radius over its design". */
static const char *name_axis(const fg_index_axis *axis, char *text, size_t size) {
  fg_text_clip(text, size, "%s%s", axis->row->words,
               axis->scale == FG_INDEX_OVER_DESIGN ? " over its design" : "");
  if (text[0] >= 'a' && text[0] <= 'z') text[0] = (char)(text[0] - 'a' + 'A');
  return text;
}

/* States the pair that differs most surely in a quantity, and the number of further pairs. */
static fg_status state_axis(fg_context *ctx, fg_index *index, size_t axis) {
  const fg_index_pair *first = NULL;
  const fg_index_axis *of = &index->axes[axis];
  size_t differing = 0;
  char *sentence = NULL, difference[VALUE], p[16], name[VALUE], more[64] = "";
  for (size_t i = 0; i < index->differing; i++) {
    if (index->pairs[i].axis != axis) continue;
    if (!first) first = &index->pairs[i];
    differing++;
  }
  if (!first) return FG_OK;
  const fg_index_lot *a = &index->lots[first->a], *b = &index->lots[first->b];
  fg_index_difference(of, first, difference, sizeof difference);
  fg_index_p(first->p_holm, p, sizeof p);
  if (differing > 1)
    fg_text_clip(more, sizeof more, "; %zu more pair%s differ%s in it", differing - 1,
                 differing > 2 ? "s" : "", differing > 2 ? "" : "s");
  FG_TRY(fg_text_print(
      ctx, &sentence,
      "%s: larger in lot %zu (%s) than in lot %zu (%s), by %s (p %s%s, %zu and %zu foils)%s.",
      name_axis(of, name, sizeof name), fg_index_number(index, a), a->name,
      fg_index_number(index, b), b->name, difference, *p == '<' ? "" : "= ", p, first->foils_a,
      first->foils_b, more));
  return append_sentence(ctx, index, sentence);
}

/* Returns true when the two lots differ in any quantity. */
static bool is_pair_differing(const fg_index *index, size_t a, size_t b) {
  for (size_t i = 0; i < index->differing; i++)
    if ((index->pairs[i].a == a && index->pairs[i].b == b) ||
        (index->pairs[i].a == b && index->pairs[i].b == a))
      return true;
  return false;
}

/* States "Lots that differ beyond the scatter of foils: 1 from 2, 3; 2 from 3." */
static fg_status state_differing_lots(fg_context *ctx, fg_index *index) {
  char *sentence = NULL;
  for (size_t a = 0; a < index->read; a++) {
    bool begun = false;
    for (size_t b = a + 1; b < index->read; b++) {
      if (!is_pair_differing(index, a, b)) continue;
      if (!begun)
        FG_TRY(fg_text_append(
            ctx, &sentence, "%s%zu from %zu",
            sentence ? "; " : "Lots that differ beyond the scatter of foils: ", a + 1, b + 1));
      else
        FG_TRY(fg_text_append(ctx, &sentence, ", %zu", b + 1));
      begun = true;
    }
  }
  FG_TRY(fg_text_append(ctx, &sentence, "."));
  return append_sentence(ctx, index, sentence);
}

/* Says, of many lots, those that differ from half of the others or more, the worst first. */
static fg_status state_odd(fg_context *ctx, fg_index *index) {
  size_t *others = NULL;
  char *sentence = NULL;
  FG_TRY(fg_memory_allocate(ctx, index->read, sizeof *others, (void **)&others));
  for (size_t a = 0; a < index->read; a++)
    for (size_t b = 0; b < index->read; b++)
      others[a] += is_pair_differing(index, a, b);
  fg_status status = FG_OK;
  for (size_t said = 0; said < SAID_MAX && status == FG_OK; said++) {
    size_t worst = 0;
    for (size_t i = 1; i < index->read; i++)
      if (others[i] > others[worst]) worst = i;
    if (2 * others[worst] < index->read) break;
    status = fg_text_append(ctx, &sentence, "%slot %zu (%s) from %zu",
                            said ? ", " : "Differ from half of the others or more: ", worst + 1,
                            index->lots[worst].name, others[worst]);
    others[worst] = 0;
  }
  free(others);
  if (!sentence || status != FG_OK) {
    free(sentence);
    return status;
  }
  FG_TRY(fg_text_append(ctx, &sentence, " of %zu.", index->read - 1));
  return append_sentence(ctx, index, sentence);
}

/* States the number of lots within tolerance. */
static fg_status state_verdicts(fg_context *ctx, fg_index *index) {
  static const struct {
    fg_verdict verdict;
    const char *words;
  } words[] = {{FG_VERDICT_PASS, "within tolerance"},
               {FG_VERDICT_FAIL, "out of tolerance"},
               {FG_VERDICT_UNDECIDED, "cannot be told"},
               {FG_VERDICT_NOT_MEASURED, "with foils or scans that could not be measured"},
               {FG_VERDICT_NONE, "without tolerances"}};
  char *sentence = NULL;
  FG_TRY(fg_text_print(ctx, &sentence, "Of %zu lot%s:", index->read, index->read == 1 ? "" : "s"));
  const char *separator = " ";
  for (size_t k = 0; k < sizeof words / sizeof *words; k++) {
    size_t lots = 0;
    for (size_t i = 0; i < index->read; i++)
      lots += index->lots[i].verdict == words[k].verdict;
    if (lots) FG_TRY(fg_text_append(ctx, &sentence, "%s%zu %s", separator, lots, words[k].words));
    if (lots) separator = ", ";
  }
  FG_TRY(fg_text_append(ctx, &sentence, "."));
  return append_sentence(ctx, index, sentence);
}

static bool is_axis_differing(const fg_index *index, size_t axis) {
  for (size_t i = 0; i < index->differing; i++)
    if (index->pairs[i].axis == axis) return true;
  return false;
}

/* States that further quantities differ: most follow from the first ones. */
static fg_status state_more_quantities(fg_context *ctx, fg_index *index, size_t quantities,
                                       const char *what, const char *where) {
  char *sentence = NULL;
  FG_TRY(fg_text_print(ctx, &sentence, "%s differ in %zu more quantit%s as well: see \"%s\".", what,
                       quantities, quantities == 1 ? "y" : "ies", where));
  return append_sentence(ctx, index, sentence);
}

static size_t count_tested(const fg_index *index) {
  size_t tested = 0;
  for (size_t i = 0; i < index->axis_count; i++)
    tested += index->axes[i].scale != FG_INDEX_APART && index->axes[i].same_as == FG_INDEX_NONE;
  return tested;
}

static fg_status state_pairs(fg_context *ctx, fg_index *index) {
  char *sentence = NULL;
  if (index->read < 2) {
    FG_TRY(fg_text_print(ctx, &sentence, "One lot: there is nothing to compare it with."));
  } else if (!index->pair_count) {
    FG_TRY(fg_text_print(ctx, &sentence,
                         "No two lots can be compared: it takes two with two measured foils each, "
                         "of different scans."));
  } else if (!index->differing) {
    FG_TRY(fg_text_print(ctx, &sentence,
                         "No two lots differ beyond the scatter of their foils in any of %zu "
                         "quantities (%zu test%s, together at 5 %%).",
                         count_tested(index), index->pair_count, fg_plural(index->pair_count)));
  }
  if (sentence) return append_sentence(ctx, index, sentence);
  if (index->read > LISTED_MAX)
    FG_TRY(state_odd(ctx, index));
  else if (index->read > 2)
    FG_TRY(state_differing_lots(ctx, index));
  size_t before = index->sentence_count;
  size_t axis = 0, more = 0;
  for (; axis < index->axis_count; axis++)
    if (index->sentence_count < before + SAID_MAX)
      FG_TRY(state_axis(ctx, index, axis));
    else
      more += is_axis_differing(index, axis);
  return more ? state_more_quantities(ctx, index, more, "Lots", "Which lots differ") : FG_OK;
}

/* States the lots whose mean the others make unlikely in a quantity. */
static fg_status state_unexpected(fg_context *ctx, fg_index *index, const fg_index_axis *axis) {
  char *sentence = NULL, name[VALUE], value[VALUE], low[VALUE], high[VALUE];
  size_t lots = 0;
  for (size_t i = 0; i < index->read; i++) {
    const fg_index_stat *stat = fg_index_stat_of(axis, &index->lots[i]);
    if (!stat || !stat->unexpected) continue;
    fg_index_value(axis, stat->foil_mean, value, sizeof value);
    fg_index_value(axis, stat->expected_low, low, sizeof low);
    fg_index_value(axis, stat->expected_high, high, sizeof high);
    if (!lots++)
      FG_TRY(fg_text_print(ctx, &sentence, "%s, out of the run of the other lots:",
                           name_axis(axis, name, sizeof name)));
    if (lots > 3) continue;
    FG_TRY(fg_text_append(ctx, &sentence, "%s lot %zu (%s), %s where %s to %s is expected",
                          lots > 1 ? ";" : "", i + 1, index->lots[i].name, value, low, high));
  }
  if (!sentence) return FG_OK;
  if (lots > 3) FG_TRY(fg_text_append(ctx, &sentence, "; and %zu more", lots - 3));
  FG_TRY(fg_text_append(ctx, &sentence, "."));
  return append_sentence(ctx, index, sentence);
}

static fg_status state_die_pair(fg_context *ctx, fg_index *index, const fg_index_die_pair *of) {
  const fg_index_axis *axis = &index->axes[of->pair.axis];
  char *sentence = NULL, difference[VALUE], p[16], name[VALUE];
  fg_index_difference(axis, &of->pair, difference, sizeof difference);
  fg_index_p(of->pair.p_holm, p, sizeof p);
  FG_TRY(fg_text_print(ctx, &sentence,
                       "%s: larger of die %s than of die %s, by %s (p %s%s, %s %zu lot%s).",
                       name_axis(axis, name, sizeof name), index->dies[of->pair.a].name,
                       index->dies[of->pair.b].name, difference, *p == '<' ? "" : "= ", p,
                       of->basis == FG_INDEX_WITHIN_LOTS ? "within" : "between the means of",
                       of->lots, of->lots == 1 ? "" : "s"));
  return append_sentence(ctx, index, sentence);
}

/* States the numbers of pairs of dies that were tested, and that cannot be. */
static fg_status state_no_die(fg_context *ctx, fg_index *index) {
  size_t tests = 0, tested = 0, apart = 0;
  char *sentence = NULL;
  for (size_t i = 0; i < index->die_pair_count; i++)
    tests += index->die_pairs[i].basis != FG_INDEX_CONFOUNDED;
  for (size_t a = 0; a < index->die_count; a++)
    for (size_t b = a + 1; b < index->die_count; b++) {
      bool asked = false, told = false;
      for (size_t i = 0; i < index->die_pair_count; i++) {
        const fg_index_die_pair *of = &index->die_pairs[i];
        bool these = (of->pair.a == a && of->pair.b == b) || (of->pair.a == b && of->pair.b == a);
        asked = asked || these;
        told = told || (these && of->basis != FG_INDEX_CONFOUNDED);
      }
      tested += told;
      apart += asked && !told;
    }
  if (tested)
    FG_TRY(fg_text_append(ctx, &sentence,
                          "No two dies differ beyond chance, of %zu pair%s that can be compared "
                          "(%zu test%s).",
                          tested, fg_plural(tested), tests, fg_plural(tests)));
  if (apart)
    FG_TRY(fg_text_append(ctx, &sentence,
                          "%s%zu pair%s of dies cannot be told from their lots: no lot has foils "
                          "of both, and there are fewer than two lots of each.",
                          sentence ? " " : "", apart, apart == 1 ? "" : "s"));
  return sentence ? append_sentence(ctx, index, sentence) : FG_OK;
}

/* States the dies that differ, a sentence for each quantity; else that none differ, or why they
 * cannot be compared. */
static fg_status state_dies(fg_context *ctx, fg_index *index) {
  if (index->die_count < 2 || index->die_count > FG_INDEX_DIES_MAX) return FG_OK;
  size_t said = 0;
  for (size_t axis = 0; axis < index->axis_count; axis++)
    for (size_t i = 0; i < index->dies_differing; i++)
      if (index->die_pairs[i].pair.axis == axis) {
        if (said++ < SAID_MAX) FG_TRY(state_die_pair(ctx, index, &index->die_pairs[i]));
        break;
      }
  if (said > SAID_MAX)
    FG_TRY(state_more_quantities(ctx, index, said - SAID_MAX, "Dies", "Which dies differ"));
  return said ? FG_OK : state_no_die(ctx, index);
}

static fg_status state_designs_apart(fg_context *ctx, fg_index *index) {
  char *sentence = NULL;
  if (index->designs < 2) return FG_OK;
  FG_TRY(fg_text_print(ctx, &sentence,
                       "The lots are of %zu different designs: lengths and angles are shown and "
                       "compared over what each lot's own design asks for",
                       index->designs));
  const char *separator = ". On no common axis, for designs do not state them: ";
  for (size_t i = 0; i < index->axis_count; i++) {
    if (index->axes[i].scale != FG_INDEX_APART) continue;
    FG_TRY(fg_text_append(ctx, &sentence, "%s%s", separator, index->axes[i].row->words));
    separator = "; ";
  }
  FG_TRY(fg_text_append(ctx, &sentence, "."));
  return append_sentence(ctx, index, sentence);
}

fg_status fg_index_make_sentences(fg_context *ctx, fg_index *index) {
  FG_TRY(state_verdicts(ctx, index));
  FG_TRY(state_pairs(ctx, index));
  for (size_t i = 0; i < index->axis_count; i++)
    if (index->axes[i].same_as == FG_INDEX_NONE)
      FG_TRY(state_unexpected(ctx, index, &index->axes[i]));
  FG_TRY(state_dies(ctx, index));
  return state_designs_apart(ctx, index);
}
