/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Held-out rows of a table: a share of its groups, or those with a value. */
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/splitmix.h"
#include "core/text.h"
#include "table_loop/parts.h"

/* Holds out every row of the chosen groups. */
static void hold_out(fg_loop_problem *problem, const bool *chosen) {
  for (size_t i = 0; i < problem->rows; i++)
    problem->held_out[i] = chosen[problem->group[i]];
}

static fg_status keep_share(fg_context *ctx, const fg_loop_table_state *build, size_t count) {
  fg_loop_problem *problem = &build->out->problem;
  uint64_t seed = build->spec->seed ^ 0x9e3779b97f4a7c15u;
  size_t *order = NULL, groups = problem->groups;
  bool *chosen = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, groups, sizeof *order, (void **)&order));
  FG_TRY_EXIT(fg_memory_allocate(ctx, groups, sizeof *chosen, (void **)&chosen));
  for (size_t i = 0; i < groups; i++)
    order[i] = i;
  for (size_t i = 0; i < count; i++) {
    size_t k = i + (size_t)(fg_splitmix_uniform(&seed) * (double)(groups - i));
    size_t drawn = order[k];
    order[k] = order[i];
    order[i] = drawn;
    chosen[drawn] = true;
  }
  hold_out(problem, chosen);
exit:
  free(order);
  free(chosen);
  return status;
}

/* Chooses whole groups with a row of that value. */
static fg_status keep_value(fg_context *ctx, const fg_loop_table_state *build, const char *text) {
  fg_loop_problem *problem = &build->out->problem;
  char name[256];
  const char *equals = strchr(text, '='), *value = equals + 1;
  const fg_column *column;
  bool *chosen = NULL;
  fg_text_clip(name, sizeof name, "%.*s", (int)(equals - text), text);
  FG_TRY(fg_table_find(ctx, build->table, name, &column));
  FG_TRY(fg_memory_allocate(ctx, problem->groups, sizeof *chosen, (void **)&chosen));
  char *end;
  double number = strtod(value, &end);
  size_t found = 0;
  for (size_t i = 0; i < problem->rows; i++) {
    size_t row = build->out->row[i];
    bool word = column->word && column->word[row] < column->word_count;
    bool same = word ? !strcmp(column->words[column->word[row]], value)
                     : !*end && *value && column->number[row].value == number;
    if (!same) continue;
    found++;
    chosen[problem->group[i]] = true;
  }
  hold_out(problem, chosen);
  free(chosen);
  if (found) return FG_OK;
  return fg_fail(ctx, FG_ERR_USAGE, "--hold-out %s: no row has that value", text);
}

fg_status fg_loop_table_hold_out(fg_context *ctx, const fg_loop_table_state *build) {
  fg_loop_problem *problem = &build->out->problem;
  const char *text = build->spec->hold_out;
  if (!text) return FG_OK; /* no row is held out */
  if (strchr(text, '=')) return keep_value(ctx, build, text);
  char *end;
  double share = strtod(text, &end);
  if (*end || end == text || !(share >= 0 && share < 0.6))
    return fg_fail(ctx, FG_ERR_USAGE, "--hold-out %s: a share from 0 to below 0.6, or COLUMN=VALUE",
                   text);
  return keep_share(ctx, build, (size_t)(share * (double)problem->groups + 0.5));
}
