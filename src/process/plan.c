/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/plan.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/splitmix.h"
#include "core/text.h"
#include "process/plan_words.h"

static fg_status push_run(fg_context *ctx, fg_plan *plan, const double *coded, const char *point,
                          size_t block, size_t replicate) {
  if (plan->runs >= FG_PLAN_RUNS)
    return fg_fail(ctx, FG_ERR_USAGE, "the plan has more than 100000 runs; take a fraction");
  FG_TRY(fg_memory_reserve(ctx, plan->runs + 1, sizeof *plan->run, &plan->capacity,
                           (void **)&plan->run));
  fg_plan_run *run = &plan->run[plan->runs++];
  *run =
      (fg_plan_run){.standard = plan->runs, .block = block, .replicate = replicate, .point = point};
  memcpy(run->coded, coded, sizeof run->coded);
  return FG_OK;
}

/* Order of the corners, and the generators of the fraction. */
typedef struct fraction {
  size_t basic[FG_PLAN_FACTORS], basics; /* factors that run through all combinations */
  size_t made[FG_PLAN_FACTORS];          /* factor made by generator g */
  fg_word by[FG_PLAN_FACTORS];
  fg_word block[FG_PLAN_FACTORS];
} fraction;

static fg_status parse_generator(fg_context *ctx, const fg_plan *plan, const char *text,
                                 size_t *made, fg_word *by) {
  const char *equals = strchr(text, '=');
  if (!equals) return fg_fail(ctx, FG_ERR_USAGE, "generator '%s': D=A:B:C is expected", text);
  *made = fg_plan_find_factor(plan, text, (size_t)(equals - text));
  if (*made == plan->factors)
    return fg_fail(ctx, FG_ERR_USAGE, "generator '%s': there is no factor '%.*s'", text,
                   (int)(equals - text), text);
  return fg_word_parse(ctx, plan, equals + 1, by);
}

static fg_status read_generators(fg_context *ctx, const fg_plan_options *o, fg_plan *plan,
                                 fraction *f) {
  uint32_t made = 0;
  fg_word relation[FG_PLAN_FACTORS];
  if (o->generators >= o->factors || o->block_generators > o->factors)
    return fg_fail(ctx, FG_ERR_USAGE, "more generators than factors allow");
  for (size_t g = 0; g < o->generators; g++) {
    FG_TRY(parse_generator(ctx, plan, o->generator[g], &f->made[g], &f->by[g]));
    uint32_t bit = (uint32_t)1 << f->made[g];
    if (made & bit)
      return fg_fail(ctx, FG_ERR_USAGE, "factor '%s' has two generators", plan->name[f->made[g]]);
    made |= bit;
    relation[g] = (fg_word){f->by[g].mask ^ bit, f->by[g].sign};
  }
  for (size_t g = 0; g < o->generators; g++)
    if (f->by[g].mask & made)
      return fg_fail(ctx, FG_ERR_USAGE,
                     "generator '%s' uses a factor that a generator makes; use basic ones only",
                     o->generator[g]);
  for (size_t k = 0; k < plan->factors; k++)
    if (!(made >> k & 1)) f->basic[f->basics++] = k;
  for (size_t b = 0; b < o->block_generators; b++)
    FG_TRY(fg_word_parse(ctx, plan, o->block_generator[b], &f->block[b]));
  return fg_plan_close_words(ctx, relation, o->generators, plan);
}

static void fill_corner(const fraction *f, size_t generators, size_t index, double *coded) {
  for (size_t b = 0; b < f->basics; b++)
    coded[f->basic[b]] = index >> b & 1 ? 1 : -1;
  for (size_t g = 0; g < generators; g++)
    coded[f->made[g]] = fg_word_value(&f->by[g], coded);
}

static size_t block_of(const fg_plan_options *o, const fraction *f, const double *coded,
                       size_t replicate) {
  size_t block = o->replicate_blocks ? replicate - 1 : 0;
  for (size_t b = 0; b < o->block_generators; b++)
    block = block * 2 + (fg_word_value(&f->block[b], coded) > 0);
  return block + 1;
}

static fg_status add_corners(fg_context *ctx, const fg_plan_options *o, size_t replicates,
                             fg_plan *plan) {
  fraction f = {0};
  FG_TRY(read_generators(ctx, o, plan, &f));
  for (size_t r = 1; r <= replicates; r++)
    for (size_t i = 0; i < (size_t)1 << f.basics; i++) {
      double coded[FG_PLAN_FACTORS] = {0};
      fill_corner(&f, o->generators, i, coded);
      FG_TRY(push_run(ctx, plan, coded, "corner", block_of(o, &f, coded, r), r));
    }
  plan->blocks = ((size_t)1 << o->block_generators) * (o->replicate_blocks ? replicates : 1);
  return FG_OK;
}

static fg_status add_axial(fg_context *ctx, const fg_plan_options *o, size_t replicates,
                           fg_plan *plan) {
  size_t corners = plan->runs / replicates;
  plan->axial = o->axial > 0 ? o->axial : pow((double)corners, 0.25);
  if (o->composite_blocks) plan->blocks = 2;
  for (size_t r = 1; r <= replicates; r++)
    for (size_t k = 0; k < plan->factors; k++)
      for (int side = -1; side <= 1; side += 2) {
        double coded[FG_PLAN_FACTORS] = {0};
        coded[k] = side * plan->axial;
        size_t block = o->composite_blocks ? 2 : o->replicate_blocks ? r : 1;
        FG_TRY(push_run(ctx, plan, coded, "axial", block, r));
      }
  return FG_OK;
}

/* Box and Behnken (1960): within each row of an incomplete block design the factors named run
 * through all corners while the others stay at the centre. Rows of three factors for six and seven;
 * pairs for three to five. */
static const signed char TRIPLES_6[6][3] = {{0, 1, 3}, {1, 2, 4}, {2, 3, 5},
                                            {0, 3, 4}, {1, 4, 5}, {0, 2, 5}};
static const signed char TRIPLES_7[7][3] = {{3, 4, 5}, {0, 5, 6}, {1, 4, 6}, {0, 1, 3},
                                            {2, 3, 6}, {0, 2, 4}, {1, 2, 5}};

static fg_status add_edges(fg_context *ctx, const signed char *members, size_t count, size_t block,
                           size_t replicate, fg_plan *plan) {
  for (size_t i = 0; i < (size_t)1 << count; i++) {
    double coded[FG_PLAN_FACTORS] = {0};
    for (size_t m = 0; m < count; m++)
      coded[members[m]] = i >> m & 1 ? 1 : -1;
    FG_TRY(push_run(ctx, plan, coded, "edge", block, replicate));
  }
  return FG_OK;
}

static fg_status add_box_behnken(fg_context *ctx, const fg_plan_options *o, size_t replicates,
                                 fg_plan *plan) {
  if (o->factors < 3 || o->factors > 7)
    return fg_fail(ctx, FG_ERR_USAGE, "a Box-Behnken plan needs 3 to 7 factors, there are %zu",
                   o->factors);
  plan->blocks = o->replicate_blocks ? replicates : 1;
  for (size_t r = 1; r <= replicates; r++) {
    size_t block = o->replicate_blocks ? r : 1;
    for (size_t t = 0; o->factors > 5 && t < o->factors; t++)
      FG_TRY(add_edges(ctx, o->factors == 6 ? TRIPLES_6[t] : TRIPLES_7[t], 3, block, r, plan));
    for (size_t a = 0; o->factors <= 5 && a < o->factors; a++)
      for (size_t b = a + 1; b < o->factors; b++)
        FG_TRY(add_edges(ctx, (signed char[]){(signed char)a, (signed char)b}, 2, block, r, plan));
  }
  return FG_OK;
}

static fg_status add_centres(fg_context *ctx, const fg_plan_options *o, fg_plan *plan) {
  const double coded[FG_PLAN_FACTORS] = {0};
  for (size_t b = 1; b <= plan->blocks; b++)
    for (size_t i = 1; i <= o->centre_points; i++)
      FG_TRY(push_run(ctx, plan, coded, "centre", b, i));
  return FG_OK;
}

/* Sort key: each run gets a random key for its plot and one of its own; sorting by block, plot key,
 * own key shuffles plots within blocks and runs within plots. */
typedef struct sort_key {
  uint64_t plot, own;
  fg_plan_run run;
} sort_key;

static int compare_keys(const void *a, const void *b) {
  const sort_key *x = a, *y = b;
  if (x->run.block != y->run.block) return x->run.block < y->run.block ? -1 : 1;
  if (x->plot != y->plot) return x->plot < y->plot ? -1 : 1;
  if (x->own != y->own) return x->own < y->own ? -1 : 1;
  return (x->run.standard > y->run.standard) - (x->run.standard < y->run.standard);
}

/* Returns true for runs of one load: the same block, replicate, and setting of every hard factor.
 * Centre points of a block share one. */
static bool same_plot(const fg_plan_options *o, const fg_plan_run *a, const fg_plan_run *b) {
  if (a->block != b->block) return false;
  bool centres =
      a->point[0] == 'c' && a->point[1] == 'e' && b->point[0] == 'c' && b->point[1] == 'e';
  if (!centres && a->replicate != b->replicate) return false;
  for (size_t k = 0; k < o->factors; k++)
    if (o->factor[k].hard_to_change && a->coded[k] != b->coded[k]) return false;
  return true;
}

static bool is_restricted(const fg_plan_options *o) {
  for (size_t k = 0; k < o->factors; k++)
    if (o->factor[k].hard_to_change) return true;
  return false;
}

static void draw_keys(const fg_plan_options *o, const fg_plan *plan, sort_key *keys) {
  uint64_t state = o->seed;
  bool restricted = is_restricted(o);
  for (size_t i = 0; i < plan->runs; i++) {
    keys[i].run = plan->run[i];
    keys[i].own = fg_splitmix_next(&state);
    if (!restricted) continue;
    keys[i].plot = fg_splitmix_next(&state);
    for (size_t k = 0; k < i; k++)
      if (same_plot(o, &keys[k].run, &keys[i].run)) {
        keys[i].plot = keys[k].plot;
        break;
      }
  }
}

static fg_status shuffle(fg_context *ctx, const fg_plan_options *o, fg_plan *plan) {
  sort_key *keys = NULL;
  FG_TRY(fg_memory_allocate(ctx, plan->runs, sizeof *keys, (void **)&keys));
  draw_keys(o, plan, keys);
  fg_sort_items(keys, plan->runs, sizeof *keys, compare_keys);
  bool restricted = is_restricted(o);
  for (size_t i = 0; i < plan->runs; i++) {
    bool same = i && keys[i].plot == keys[i - 1].plot && keys[i].run.block == keys[i - 1].run.block;
    if (restricted && !same) plan->plots++;
    plan->run[i] = keys[i].run;
    plan->run[i].plot = plan->plots;
  }
  free(keys);
  return FG_OK;
}

static fg_status check_options(fg_context *ctx, const fg_plan_options *o) {
  if (!o->factors || o->factors > FG_PLAN_FACTORS)
    return fg_fail(ctx, FG_ERR_USAGE, "%zu factors; 1 to 20 are possible", o->factors);
  for (size_t k = 0; k < o->factors; k++) {
    const fg_plan_factor *f = &o->factor[k];
    if (!isfinite(f->low) || !isfinite(f->high) || !(f->low < f->high))
      return fg_fail(ctx, FG_ERR_USAGE, "factor '%s': the low level must be below the high one",
                     f->name);
    if (!*f->name || strpbrk(f->name, ":=-, "))
      return fg_fail(ctx, FG_ERR_USAGE, "factor '%s': a name without : = - , and blanks is needed",
                     f->name);
    for (size_t i = 0; i < k; i++)
      if (strcmp(f->name, o->factor[i].name) == 0)
        return fg_fail(ctx, FG_ERR_USAGE, "two factors are called '%s'", f->name);
  }
  if (o->kind == FG_PLAN_BOX_BEHNKEN && o->generators)
    return fg_fail(ctx, FG_ERR_USAGE, "a Box-Behnken plan has no generators");
  if (o->kind != FG_PLAN_FACTORIAL && o->block_generators)
    return fg_fail(ctx, FG_ERR_USAGE, "block generators are for factorial plans");
  if (o->composite_blocks && (o->kind != FG_PLAN_COMPOSITE || o->replicate_blocks))
    return fg_fail(ctx, FG_ERR_USAGE,
                   "corners and axial points as blocks: for composite plans, without replicate "
                   "blocks");
  if (!(o->axial >= 0) || !isfinite(o->axial))
    return fg_fail(ctx, FG_ERR_USAGE, "the axial distance must be positive");
  return FG_OK;
}

static fg_status copy_factors(fg_context *ctx, const fg_plan_options *o, fg_plan *plan) {
  for (size_t k = 0; k < o->factors; k++) {
    plan->low[k] = o->factor[k].low;
    plan->high[k] = o->factor[k].high;
    plan->step[k] = o->factor[k].step;
    FG_TRY(fg_text_print(ctx, &plan->name[k], "%s", o->factor[k].name));
    plan->factors++;
  }
  return FG_OK;
}

/* Refuses a step so coarse that two levels become equal: the plan would be another one. */
static fg_status check_steps(fg_context *ctx, const fg_plan *plan) {
  for (size_t k = 0; k < plan->factors; k++)
    for (size_t i = 0; plan->step[k] > 0 && i < plan->runs; i++)
      for (size_t j = i + 1; j < plan->runs; j++) {
        double a = plan->run[i].coded[k], b = plan->run[j].coded[k];
        if (fabs(a - b) < 1e-9 || fg_plan_setting(plan, i, k) != fg_plan_setting(plan, j, k))
          continue;
        return fg_fail(ctx, FG_ERR_USAGE,
                       "%s: rounded to %g, its settings of %.4g and %.4g (coded) both become %g; "
                       "take a finer step or a wider range",
                       plan->name[k], plan->step[k], a, b, fg_plan_setting(plan, i, k));
      }
  return FG_OK;
}

fg_status fg_plan_make(fg_context *ctx, const fg_plan_options *options, fg_plan *plan) {
  fg_status status = FG_OK;
  size_t replicates = options->replicates ? options->replicates : 1;
  *plan = (fg_plan){0};
  FG_TRY_EXIT(check_options(ctx, options));
  FG_TRY_EXIT(copy_factors(ctx, options, plan));
  if (options->kind == FG_PLAN_BOX_BEHNKEN)
    FG_TRY_EXIT(add_box_behnken(ctx, options, replicates, plan));
  else
    FG_TRY_EXIT(add_corners(ctx, options, replicates, plan));
  if (options->kind == FG_PLAN_COMPOSITE) FG_TRY_EXIT(add_axial(ctx, options, replicates, plan));
  FG_TRY_EXIT(add_centres(ctx, options, plan));
  FG_TRY_EXIT(check_steps(ctx, plan));
  FG_TRY_EXIT(shuffle(ctx, options, plan));
exit:
  if (status != FG_OK) fg_plan_free(plan);
  return status;
}

/* A column of whole numbers read off the runs. */
static fg_status add_counts(fg_context *ctx, const fg_plan *plan, const char *name, size_t offset,
                            double *values, fg_table *table) {
  for (size_t i = 0; i < plan->runs; i++) {
    size_t count = 0;
    memcpy(&count, (const char *)&plan->run[i] + offset, sizeof count);
    values[i] = (double)count;
  }
  return fg_table_add_numbers(ctx, table, name, values, plan->runs);
}

/* The nearest multiple of the step between the levels; where there is none, the nearest. */
static double round_between(const fg_plan *plan, size_t k, double value) {
  double low = fmin(plan->low[k], plan->high[k]), high = fmax(plan->low[k], plan->high[k]);
  double step = plan->step[k], room = 1e-9 * step, nearest = fg_round_to(value, step);
  double inwards = nearest < low - room    ? nearest + step
                   : nearest > high + room ? nearest - step
                                           : nearest;
  bool between = inwards >= low - room && inwards <= high + room;
  return between ? fg_round_to(inwards, step) : nearest;
}

double fg_plan_setting(const fg_plan *plan, size_t run, size_t k) {
  double centre = (plan->low[k] + plan->high[k]) / 2, half = (plan->high[k] - plan->low[k]) / 2;
  double coded = plan->run[run].coded[k];
  double value = coded == -1 ? plan->low[k] : coded == 1 ? plan->high[k] : centre + coded * half;
  return fabs(coded) > 1 ? fg_round_to(value, plan->step[k]) : round_between(plan, k, value);
}

static fg_status add_factor(fg_context *ctx, const fg_plan *plan, size_t k, double *values,
                            fg_table *table) {
  for (size_t i = 0; i < plan->runs; i++)
    values[i] = fg_plan_setting(plan, i, k);
  return fg_table_add_numbers(ctx, table, plan->name[k], values, plan->runs);
}

fg_status fg_plan_table(fg_context *ctx, const fg_plan *plan, fg_table *table) {
  fg_status status = FG_OK;
  double *values = NULL;
  const char **points = NULL;
  *table = (fg_table){0};
  FG_TRY_EXIT(fg_memory_allocate(ctx, plan->runs, sizeof *values, (void **)&values));
  FG_TRY_EXIT(fg_memory_allocate(ctx, plan->runs, sizeof *points, (void **)&points));
  for (size_t i = 0; i < plan->runs; i++) {
    values[i] = (double)i + 1;
    points[i] = plan->run[i].point;
  }
  FG_TRY_EXIT(fg_table_add_numbers(ctx, table, "run", values, plan->runs));
  FG_TRY_EXIT(
      add_counts(ctx, plan, "standard_order", offsetof(fg_plan_run, standard), values, table));
  FG_TRY_EXIT(fg_table_add_words(ctx, table, "point", points, plan->runs));
  if (plan->blocks > 1)
    FG_TRY_EXIT(add_counts(ctx, plan, "block", offsetof(fg_plan_run, block), values, table));
  if (plan->plots)
    FG_TRY_EXIT(add_counts(ctx, plan, "whole_plot", offsetof(fg_plan_run, plot), values, table));
  for (size_t k = 0; k < plan->factors; k++)
    FG_TRY_EXIT(add_factor(ctx, plan, k, values, table));
exit:
  free(values);
  free(points);
  if (status != FG_OK) fg_table_free(table);
  return status;
}

void fg_plan_free(fg_plan *plan) {
  if (!plan) return;
  for (size_t k = 0; k < plan->factors; k++)
    free(plan->name[k]);
  free(plan->run);
  free(plan->word);
  free(plan->word_sign);
  *plan = (fg_plan){0};
}
