/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Columns with the same content as others: they are no second candidates. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/text.h"
#include "table_loop/parts.h"
#include "table_loop/places.h"

/* Two columns on a straight line may differ by so much of their range: digits of a file. */
#define SAME_LINE 1e-9

void fg_loop_table_drop(fg_loop_problem *problem, size_t c) {
  fg_loop_coordinate *at = &problem->coordinate[c];
  for (size_t i = 0; i < at->levels; i++)
    free(at->level_name[i]);
  free(at->level_name);
  free(at->value);
  problem->coordinates--;
  memmove(at, at + 1, (problem->coordinates - c) * sizeof *at);
}

typedef struct value_pair {
  double a, b;
} value_pair;

static int by_values(const void *left, const void *right) {
  const value_pair *x = left, *y = right;
  if (x->a != y->a) return x->a < y->a ? -1 : 1;
  return (x->b > y->b) - (x->b < y->b);
}

/* Both have as many different values as there are different pairs of them. */
static fg_status one_to_one(fg_context *ctx, size_t rows, const fg_loop_coordinate *a,
                            const fg_loop_coordinate *b, bool *same) {
  value_pair *pair = NULL;
  size_t pairs = 1;
  *same = false;
  if (a->distinct != b->distinct) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *pair, (void **)&pair));
  for (size_t i = 0; i < rows; i++)
    pair[i] = (value_pair){a->value[i], b->value[i]};
  fg_sort_items(pair, rows, sizeof *pair, by_values);
  for (size_t i = 1; i < rows; i++)
    pairs += by_values(&pair[i - 1], &pair[i]) != 0;
  *same = pairs == a->distinct;
  free(pair);
  return FG_OK;
}

static bool on_a_line(size_t rows, const fg_loop_coordinate *a, const fg_loop_coordinate *b) {
  size_t low = 0, high = 0;
  for (size_t i = 1; i < rows; i++) {
    if (a->value[i] < a->value[low]) low = i;
    if (a->value[i] > a->value[high]) high = i;
  }
  double slope = (b->value[high] - b->value[low]) / (a->value[high] - a->value[low]);
  double rounding = 0x1p-50 * (fmax(fabs(b->high), fabs(b->low)) +
                               fabs(slope) * fmax(fabs(a->high), fabs(a->low)));
  double allowed = SAME_LINE * (b->high - b->low) + rounding;
  for (size_t i = 0; i < rows; i++)
    if (!(fabs(b->value[low] + slope * (a->value[i] - a->value[low]) - b->value[i]) <= allowed))
      return false;
  return true;
}

/* A column with a part of its own stays. */
static bool has_part(const fg_loop_coordinate *at) {
  return at->roles &
         (FG_LOOP_ORDER | FG_LOOP_BUMP | FG_LOOP_DECLARED | FG_LOOP_TEMPERATURE | FG_LOOP_DURATION);
}

/* Places that were taken in turn, evenly spaced: a cycle of theirs has a base, one of the runs has
 * none. Both stay, and what either explains is tied. */
static bool is_order_of_places(const fg_loop_table_spec *spec, const fg_loop_coordinate *order,
                               const fg_loop_coordinate *places) {
  return order->roles & FG_LOOP_ORDER && !(places->roles & FG_LOOP_ORDER) &&
         fg_loop_places_have_base(spec, places);
}

/* Chooses which of two columns with the same content goes; SIZE_MAX: neither. */
static fg_status find_superfluous(fg_context *ctx, const fg_loop_table_state *build, size_t a,
                                  size_t b, size_t *gone) {
  const fg_loop_problem *problem = &build->out->problem;
  fg_loop_coordinate *x = &problem->coordinate[a], *y = &problem->coordinate[b];
  bool words = x->levels && y->levels, numbers = !x->levels && !y->levels, same = false;
  *gone = SIZE_MAX;
  if ((x->roles | y->roles) & FG_LOOP_SENSITIVITY) return FG_OK;
  if (numbers)
    same = on_a_line(problem->rows, x, y);
  else
    FG_TRY(one_to_one(ctx, problem->rows, x, y, &same));
  if (!same || is_order_of_places(build->spec, x, y) || is_order_of_places(build->spec, y, x))
    return FG_OK;
  if (!words && !numbers)
    (x->levels ? y : x)->coded = true;
  else if (!has_part(x) || !has_part(y))
    *gone = has_part(y) ? a : b;
  return FG_OK;
}

fg_status fg_loop_table_merge_codes(fg_context *ctx, const fg_loop_table_state *build) {
  fg_loop_problem *problem = &build->out->problem;
  if (!build->order && !build->spec->group) FG_TRY(fg_loop_table_find_order(ctx, build));
  for (size_t a = 0; a < problem->coordinates; a++)
    for (size_t b = a + 1; b < problem->coordinates; b++) {
      size_t gone;
      char why[FG_LOOP_NAME + 40];
      FG_TRY(find_superfluous(ctx, build, a, b, &gone));
      if (gone == SIZE_MAX) continue;
      fg_text_clip(why, sizeof why, "says the same as %s", problem->coordinate[a + b - gone].name);
      FG_TRY(fg_loop_table_leave_out(ctx, build, problem->coordinate[gone].name, why));
      fg_loop_table_drop(problem, gone);
      b = a; /* again from here: later columns have moved up */
    }
  return FG_OK;
}
