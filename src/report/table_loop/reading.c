/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words for the size of a finding in its reader's terms: a difference between two levels, two ends,
 * two sides. The engine compares amplitudes, half a range each, which would mislead a reader of a
 * gauge. */
#include "report/table_loop/reading.h"

#include <math.h>
#include <string.h>

#include "core/text.h"
#include "report/table_loop/cycle_words.h"
#include "report/unit_words.h"
#include "report/value_words.h"

enum { VALUE_WORDS = 160 };

typedef struct reading {
  const fg_loop_report *report;
  const fg_loop_claim *claim;
  const fg_loop_coordinate *a, *b;
  char *text; /* FG_LOOP_WORDS */
} reading;

/* Student's t of the claim's interval, over the 2 of U = 2u. */
static double widening(const fg_loop_claim *claim) {
  double half = (claim->interval[1] - claim->interval[0]) / 2;
  double t = half / claim->amplitude_u;
  return isfinite(t) && t > 0 ? t / 2 : 1;
}

/* "0.592 ± 0.093 µm", without its sign. */
static void put_difference(const reading *r, double difference, double u, char text[VALUE_WORDS]) {
  const char *unit = fg_unit_of_name(r->report->spec->response);
  char number[80];
  fg_scan_loop_value_words(fabs(difference), u * widening(r->claim), number, sizeof number);
  fg_text_clip(text, VALUE_WORDS, "%s%s%s", number, *unit && strcmp(unit, "°") != 0 ? " " : "",
               unit);
}

/* The whole range of the effect over the rows. */
static void put_range(const reading *r, char text[VALUE_WORDS]) {
  put_difference(r, 2 * r->claim->amplitude, 2 * r->claim->amplitude_u, text);
}

/* "humidity 30 %", "operator B". */
static void put_place(const fg_loop_coordinate *at, double value, char text[VALUE_WORDS]) {
  char name[FG_LOOP_NAME], number[60];
  fg_name_words(at->name, name, sizeof name);
  if (at->levels) {
    size_t level = value > 0 ? (size_t)value : 0;
    fg_text_clip(text, VALUE_WORDS, "%s %s", name,
                 at->level_name[level < at->levels ? level : at->levels - 1]);
    return;
  }
  fg_value_with_unit(at->name, value, 5, number, sizeof number);
  fg_text_clip(text, VALUE_WORDS, "%s %s", name, number);
}

/* "from the first run to the last", "from humidity 30 % to 60 %". */
static void put_ends(const fg_loop_coordinate *at, char text[VALUE_WORDS]) {
  char low[VALUE_WORDS], high[VALUE_WORDS];
  const char *rows = fg_loop_row_words(at);
  if (at->roles & (FG_LOOP_ORDER | FG_LOOP_BUMP)) {
    bool named = !strcmp(at->name, "run") || !strcmp(at->name, "row") || at->roles & FG_LOOP_BUMP;
    fg_text_clip(text, VALUE_WORDS, "from the first %.*s to the last%s%s", (int)strlen(rows) - 1,
                 rows, named ? "" : " by ", named ? "" : at->name);
    return;
  }
  put_place(at, at->low, low);
  fg_value_with_unit(at->name, at->high, 5, high, sizeof high);
  fg_text_clip(text, VALUE_WORDS, "from %.100s to %.50s", low, high);
}

static void read_range(const reading *r) {
  char range[VALUE_WORDS];
  if (r->claim->candidate.effect->from_zero) {
    put_difference(r, r->claim->amplitude, r->claim->amplitude_u, range);
    fg_text_clip(r->text, FG_LOOP_WORDS, "it moves a row by up to %s", range);
    return;
  }
  put_range(r, range);
  fg_text_clip(r->text, FG_LOOP_WORDS, "by it the rows differ by up to %s", range);
}

/* "(0.099 ± 0.011 µm per %)"; over an order a row is no unit. */
static void append_slope(const reading *r) {
  const char *unit = fg_unit_of_name(r->a->name);
  double factor = 2 / (r->a->high - r->a->low);
  char slope[VALUE_WORDS];
  size_t used = strlen(r->text);
  if (r->a->roles & (FG_LOOP_ORDER | FG_LOOP_BUMP) || !*unit) return;
  put_difference(r, factor * r->claim->coefficient[0], factor * r->claim->coefficient_u[0], slope);
  fg_text_clip(r->text + used, FG_LOOP_WORDS - used, " (%s per %s)", slope, unit);
}

static void read_slope(const reading *r) {
  char range[VALUE_WORDS], ends[VALUE_WORDS];
  put_difference(r, 2 * r->claim->coefficient[0], 2 * r->claim->coefficient_u[0], range);
  put_ends(r->a, ends);
  fg_text_clip(r->text, FG_LOOP_WORDS, "it %s by %s %s",
               r->claim->coefficient[0] < 0 ? "falls" : "rises", range, ends);
  append_slope(r);
}

/* y = c0 x + c1 (2 x² - 1), x from -1 to 1: turns at x = -c0 / (4 c1). */
static void read_bend(const reading *r) {
  const double *c = r->claim->coefficient;
  double turn = -c[0] / (4 * c[1]), half = (r->a->high - r->a->low) / 2;
  char range[VALUE_WORDS], ends[VALUE_WORDS], at[VALUE_WORDS], far[VALUE_WORDS];
  put_range(r, range);
  if (!(fabs(turn) < 1)) {
    put_ends(r->a, ends);
    fg_text_clip(r->text, FG_LOOP_WORDS, "it %s by %s %s, %s at the end",
                 c[0] < 0 ? "falls" : "rises", range, ends,
                 (c[0] < 0) == (c[1] < 0) ? "faster" : "slower");
    return;
  }
  put_place(r->a, r->a->low + half * (1 + turn), at);
  put_place(r->a, turn > 0 ? r->a->low : r->a->high, far);
  fg_text_clip(r->text, FG_LOOP_WORDS, "it is %s near %s, and %s %s at %s",
               c[1] > 0 ? "lowest" : "highest", at, range, c[1] > 0 ? "higher" : "lower", far);
}

/* A level's mean: the first's is 0. */
static double level_value(const fg_loop_coordinate *at, size_t k) {
  return at->levels ? (double)k : at->few[k];
}

static void read_levels(const reading *r) {
  size_t low = 0, high = 0, levels = r->claim->columns + 1;
  char range[VALUE_WORDS], from[VALUE_WORDS], to[VALUE_WORDS];
  double lowest = 0, highest = 0;
  for (size_t k = 1; k < levels; k++) {
    double value = r->claim->coefficient[k - 1];
    if (value < lowest) lowest = value, low = k;
    if (value > highest) highest = value, high = k;
  }
  put_range(r, range);
  put_place(r->a, level_value(r->a, low), from);
  put_place(r->a, level_value(r->a, high), to);
  fg_text_clip(r->text, FG_LOOP_WORDS, "%s reads %s higher than %s", to, range, from);
  if (levels == 2) return;
  size_t used = strlen(r->text);
  fg_text_clip(r->text + used, FG_LOOP_WORDS - used, ", the lowest of %zu", levels);
}

/* The claim's words already name the place of the step. */
static void read_step(const reading *r) {
  char range[VALUE_WORDS];
  put_difference(r, 2 * r->claim->coefficient[0], 2 * r->claim->coefficient_u[0], range);
  fg_text_clip(r->text, FG_LOOP_WORDS, "beyond it the response is %s %s", range,
               r->claim->coefficient[0] < 0 ? "lower" : "higher");
}

/* 2 exp(-x / l) - 1: from the first row on; a length beyond the rows is undetermined. */
static void read_fade(const reading *r) {
  char range[VALUE_WORDS], place[VALUE_WORDS];
  const char *rows = fg_loop_row_words(r->a);
  double length = r->claim->shape[0];
  put_range(r, range);
  fg_text_clip(r->text, FG_LOOP_WORDS, "the first %.*s lies %s %s than the last",
               (int)strlen(rows) - 1, rows, range,
               r->claim->coefficient[0] < 0 ? "lower" : "higher");
  if (!(length < r->a->high - r->a->low)) return;
  size_t used = strlen(r->text);
  fg_value_with_unit(r->a->name, length, 3, place, sizeof place);
  fg_text_clip(r->text + used, FG_LOOP_WORDS - used, "; a third of that is left after %s%s%s",
               place, *fg_unit_of_name(r->a->name) ? "" : " ",
               *fg_unit_of_name(r->a->name) ? "" : rows);
}

static void read_swing(const reading *r) {
  char range[VALUE_WORDS];
  put_range(r, range);
  fg_text_clip(r->text, FG_LOOP_WORDS, "it swings by %s from peak to valley", range);
  char orders[FG_LOOP_WORDS];
  size_t used = strlen(r->text);
  fg_loop_order_words(r->report, r->claim, widening(r->claim), orders, sizeof orders);
  if (r->claim->orders > 1) fg_text_clip(r->text + used, FG_LOOP_WORDS - used, "; %s", orders);
}

/* c x y, both from -1 to 1: the change over x differs by 4 c between the ends of y. */
static void read_product(const reading *r) {
  char range[VALUE_WORDS], ends[VALUE_WORDS], low[VALUE_WORDS], high[VALUE_WORDS];
  double c = r->claim->coefficient[0];
  put_difference(r, 4 * c, 4 * r->claim->coefficient_u[0], range);
  put_ends(r->a, ends);
  put_place(r->b, r->b->low, low);
  put_place(r->b, r->b->high, high);
  fg_text_clip(r->text, FG_LOOP_WORDS, "the change %s is %s %s at %s than at %s", ends, range,
               c < 0 ? "lower" : "higher", high, low);
}

/* Slopes of the levels of a factor, half the change over the number's range; their sum is zero. */
static void read_slopes(const reading *r, const fg_loop_coordinate *factor,
                        const fg_loop_coordinate *number) {
  size_t low = 0, high = 0;
  double slope[FG_LOOP_COLUMNS + 1] = {0};
  size_t last = r->claim->columns;
  for (size_t k = 0; k < last; k++) {
    slope[k] = r->claim->coefficient[k];
    slope[last] -= slope[k];
  }
  for (size_t k = 1; k <= last; k++) {
    if (slope[k] < slope[low]) low = k;
    if (slope[k] > slope[high]) high = k;
  }
  char range[VALUE_WORDS], ends[VALUE_WORDS], from[VALUE_WORDS], to[VALUE_WORDS];
  put_difference(r, 2 * (slope[high] - slope[low]), 2 * r->claim->slopes_u, range);
  put_ends(number, ends);
  put_place(factor, (double)low, from);
  put_place(factor, (double)high, to);
  fg_text_clip(r->text, FG_LOOP_WORDS, "the change %s is %s higher for %s than for %s", ends, range,
               to, from);
}

/* Of two factors of two levels the cells are c, -c, -c, c. */
static void read_cells(const reading *r) {
  char range[VALUE_WORDS], from[VALUE_WORDS], to[VALUE_WORDS], x[VALUE_WORDS], y[VALUE_WORDS];
  double c = r->claim->coefficient[0];
  if (r->claim->columns > 1) {
    read_range(r);
    return;
  }
  put_difference(r, 4 * c, 4 * r->claim->coefficient_u[0], range);
  put_place(r->a, 0, from);
  put_place(r->a, 1, to);
  put_place(r->b, 0, x);
  put_place(r->b, 1, y);
  fg_text_clip(r->text, FG_LOOP_WORDS, "%s over %s is %s %s for %s than for %s", to, from, range,
               c < 0 ? "lower" : "higher", y, x);
}

/* Levels of the direction are in ascending order: the second is the positive one. */
static void read_loop(const reading *r) {
  const double *c = r->claim->coefficient, *u = r->claim->coefficient_u;
  char middle[VALUE_WORDS], ends[VALUE_WORDS], low[VALUE_WORDS], high[VALUE_WORDS],
      name[FG_LOOP_NAME];
  put_difference(r, 2 * c[1], 2 * u[1], middle);
  put_difference(r, 2 * c[0], 2 * u[0], ends);
  put_place(r->b, r->b->low, low);
  put_place(r->b, r->b->high, high);
  fg_name_words(r->a->name, name, sizeof name);
  fg_text_clip(r->text, FG_LOOP_WORDS,
               "in the middle of the range of %s %s reads %s %s than %s, at its ends %s %s", name,
               high, middle, c[1] < 0 ? "lower" : "higher", low, ends,
               c[0] < 0 ? "lower" : "higher");
}

static void read_slope_differs(const reading *r) {
  if (r->a->levels && r->b->levels)
    read_cells(r);
  else if (r->a->levels)
    read_slopes(r, r->a, r->b);
  else if (r->b->levels)
    read_slopes(r, r->b, r->a);
  else
    read_product(r);
}

/* Every wrong row has a size of its own. */
static void read_outlier_rows(const reading *r) {
  const fg_loop_claim *claim = r->claim;
  *r->text = '\0';
  for (size_t k = 0; k < claim->columns; k++) {
    fg_loop_candidate one = claim->candidate;
    char range[VALUE_WORDS], row[FG_LOOP_WORDS];
    size_t used = strlen(r->text);
    one.rows = 1;
    one.row[0] = claim->candidate.row[k];
    fg_loop_rows_words(r->report, &one, row);
    put_difference(r, claim->coefficient[k], claim->coefficient_u[k], range);
    fg_text_clip(r->text + used, FG_LOOP_WORDS - used, "%s%s lies %s %s%s", k ? ", " : "",
                 claim->columns > 1 ? row : "it", range,
                 claim->coefficient[k] < 0 ? "below" : "above", k ? "" : " what the others say");
  }
}

static void read_exchange(const reading *r) {
  char range[VALUE_WORDS];
  put_difference(r, 2 * r->claim->coefficient[0], 2 * r->claim->coefficient_u[0], range);
  fg_text_clip(r->text, FG_LOOP_WORDS, "their responses are %s apart", range);
}

/* Levels, a bend, a step or a wave over a column that the declared model uses as a number
 * departs from the model's own terms in it: the response itself may rise where the effect falls. */
static bool departs(const reading *r) {
  static const bool over_places[FG_LOOP_READINGS] = {[FG_LOOP_READS_BEND] = true,
                                                     [FG_LOOP_READS_LEVELS] = true,
                                                     [FG_LOOP_READS_STEP] = true,
                                                     [FG_LOOP_READS_SWING] = true};
  return r->a && over_places[r->claim->candidate.effect->reads] && !r->a->levels &&
         r->a->roles & FG_LOOP_DECLARED;
}

/* "operator B reads 0.592 ± 0.093 µm higher than operator A", "it rises by 0.72 ± 0.10 from the
 * first run to the last": of claims of the mean and of single rows. U is of 95 %, by Student's t.
 */
static void write_reading(const fg_loop_report *report, const fg_loop_claim *claim,
                          char text[FG_LOOP_WORDS]) {
  static void (*const readers[FG_LOOP_READINGS])(const reading *) = {
      [FG_LOOP_READS_RANGE] = read_range,       [FG_LOOP_READS_SLOPE] = read_slope,
      [FG_LOOP_READS_BEND] = read_bend,         [FG_LOOP_READS_LEVELS] = read_levels,
      [FG_LOOP_READS_STEP] = read_step,         [FG_LOOP_READS_FADE] = read_fade,
      [FG_LOOP_READS_SWING] = read_swing,       [FG_LOOP_READS_SLOPES] = read_slope_differs,
      [FG_LOOP_READS_LOOP] = read_loop,         [FG_LOOP_READS_ROWS] = read_outlier_rows,
      [FG_LOOP_READS_EXCHANGE] = read_exchange,
  };
  const fg_loop_coordinate *at = report->problem->problem.coordinate;
  bool own = claim->candidate.effect->accepts != NULL;
  const reading r = {report, claim, own ? &at[claim->candidate.a] : NULL,
                     own ? &at[claim->candidate.b] : NULL, text};
  *text = '\0';
  readers[claim->candidate.effect->reads](&r);
  if (!departs(&r)) return;
  char name[FG_LOOP_NAME], words[FG_LOOP_WORDS];
  fg_name_words(r.a->name, name, sizeof name);
  memcpy(words, text, sizeof words);
  fg_text_clip(text, FG_LOOP_WORDS, "beside the model's own terms in %s, %s", name, words);
}

double fg_loop_readable_size(const fg_loop_candidate *candidate, double amplitude) {
  const fg_loop_effect *effect = candidate->effect;
  bool as_is = effect->from_zero || effect->scatter != FG_LOOP_OF_THE_MEAN ||
               effect->outlier == FG_LOOP_WRONG_ROW;
  return as_is ? amplitude : 2 * amplitude;
}

void fg_loop_claim_size(const fg_loop_report *report, const fg_loop_claim *claim,
                        char text[FG_LOOP_WORDS]) {
  const fg_loop_effect *effect = claim->candidate.effect;
  if (effect->scatter == FG_LOOP_OF_THE_MEAN) {
    write_reading(report, claim, text);
    return;
  }
  fg_text_clip(text, FG_LOOP_WORDS, "%s %s",
               effect->scatter == FG_LOOP_SERIAL   ? "correlation"
               : effect->scatter == FG_LOOP_LEVELS ? "sd from level to level"
                                                   : "ratio of the sd",
               fg_loop_number_text("%.3g", claim->noise_value).text);
  size_t used = strlen(text);
  if (isfinite(claim->noise_value_u))
    fg_text_clip(text + used, FG_LOOP_WORDS - used, " ± %.2g", 2 * claim->noise_value_u);
}

void fg_loop_claim_sentence(const fg_loop_report *report, const fg_loop_claim *claim,
                            char text[2 * FG_LOOP_WORDS]) {
  char words[FG_LOOP_WORDS], size[FG_LOOP_WORDS];
  bool mean = claim->candidate.effect->scatter == FG_LOOP_OF_THE_MEAN;
  fg_loop_claim_words(report, claim, words);
  fg_loop_claim_size(report, claim, size);
  fg_text_clip(text, (size_t)2 * FG_LOOP_WORDS, mean ? "%s: %s" : "%s (%s)", words, size);
}
