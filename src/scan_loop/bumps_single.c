/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bumps that deviate by their numbers: a few of them, or a cycle over them. The geometry absorbs a
 * whole bump that is raised, because every bump has a circle; so here its radius and angle are
 * compared with those of the others. The unit is the mean of a number over the foils. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/text.h"
#include "scan_loop/bump_pattern.h"
#include "scan_loop/bumps.h"

/* Collects the means of the numbers over the foils, each foil relative to its own mean, beside the
 * effects found. */
static bool collect_bump_means(const fg_scan_loop_bumps *bumps,
                               const fg_scan_loop_bump_level *level, size_t coordinate,
                               fg_bump_values *out) {
  const fg_loop_problem *problem = &level->problem.problem;
  const double *number = problem->coordinate[coordinate].value;
  double count[FG_BUMP_PATTERN_MAX] = {0};
  *out = (fg_bump_values){0};
  for (size_t i = 0; i < problem->rows; i++) {
    size_t part = bumps->bump[level->problem.row[i]].part, k = 0;
    double mean = 0, n = 0;
    if (problem->held_out[i]) continue;
    for (size_t j = 0; j < problem->rows; j++)
      if (!problem->held_out[j] && bumps->bump[level->problem.row[j]].part == part) {
        mean += problem->residual[j] - level->result.effect_fit[j];
        n++;
      }
    while (k < out->n && out->number[k] < number[i])
      k++;
    if (k == out->n || out->number[k] != number[i]) {
      if (out->n == FG_BUMP_PATTERN_MAX) return false;
      for (size_t m = out->n++; m > k; m--) {
        out->number[m] = out->number[m - 1];
        out->value[m] = out->value[m - 1];
        count[m] = count[m - 1];
      }
      out->number[k] = number[i];
      out->value[k] = count[k] = 0;
    }
    out->value[k] += problem->residual[i] - level->result.effect_fit[i] - mean / n;
    count[k]++;
  }
  for (size_t k = 0; k < out->n; k++)
    out->value[k] /= count[k];
  return out->n >= FG_BUMP_PATTERN_MIN;
}

static fg_status fill_single_bump_curve(fg_context *ctx, const fg_bump_values *at,
                                        const fg_bump_pattern *found, double p_value,
                                        size_t coordinate, fg_loop_result *result) {
  fg_loop_curve *curve = &result->curve;
  double square = 0;
  free(curve->shape);
  *curve = (fg_loop_curve){.coordinate = coordinate, .p_value = p_value};
  fg_text_clip(curve->name, sizeof curve->name, "bump");
  FG_TRY(fg_memory_allocate(ctx, at->n, sizeof *curve->shape, (void **)&curve->shape));
  for (size_t k = 0; k < at->n; k++) {
    curve->shape[k][0] = at->number[k];
    curve->shape[k][1] = fg_bump_pattern_at(found, at, k);
    square += curve->shape[k][1] * curve->shape[k][1];
  }
  curve->count = at->n;
  curve->rms = sqrt(square / (double)at->n);
  result->has_curve = true;
  return FG_OK;
}

/* "3, 6, 9 (every 3rd)" */
static void list_numbers(const fg_bump_pattern *found, const fg_bump_values *at, char *words,
                         size_t size) {
  size_t used = 0, seen = 0;
  double last = 0, step = 0;
  bool even = true;
  words[0] = 0;
  for (size_t k = 0; k < at->n && used + 1 < size; k++) {
    if (!found->apart[k]) continue;
    used += (size_t)snprintf(words + used, size - used, "%s%g", used ? ", " : "", at->number[k]);
    if (seen == 1) step = at->number[k] - last;
    even = even && (seen < 2 || at->number[k] - last == step);
    last = at->number[k];
    seen++;
  }
  if (seen > 2 && even && step > 1 && used + 1 < size)
    snprintf(words + used, size - used, ", every %g%s,", step,
             step == 2   ? "nd"
             : step == 3 ? "rd"
                         : "th");
}

static fg_status note_pattern(fg_context *ctx, fg_scan_loop_bumps *bumps, size_t response,
                              const fg_bump_values *at, const fg_bump_pattern *found) {
  const fg_scan_loop_bump_response *what = &fg_scan_loop_bump_responses[response];
  char words[200];
  if (found->period > 0)
    return fg_scan_loop_bumps_note(ctx, bumps, "bumps: %s repeats every %.3g bumps, by +-%.3g %s",
                                   what->name, found->period, what->scale * found->by, what->unit);
  list_numbers(found, at, words, sizeof words);
  return fg_scan_loop_bumps_note(
      ctx, bumps, "bumps: %s of bump%s %s differs from that of the others by %.3g %s", what->name,
      found->count > 1 ? "s" : "", words, what->scale * found->by, what->unit);
}

static bool find_coordinate(const fg_loop_problem *problem, size_t *coordinate) {
  for (size_t c = 0; c < problem->coordinates; c++)
    if (problem->coordinate[c].roles & FG_LOOP_BUMP) {
      *coordinate = c;
      return true;
    }
  return false;
}

fg_status fg_scan_loop_bumps_find_single(fg_context *ctx, fg_scan_loop_bumps *bumps,
                                         size_t response, uint64_t seed) {
  fg_scan_loop_bump_level *level = &bumps->level[response];
  size_t coordinate;
  fg_bump_values at;
  if (level->result.has_curve || !find_coordinate(&level->problem.problem, &coordinate) ||
      !collect_bump_means(bumps, level, coordinate, &at))
    return FG_OK;
  double p_value;
  const fg_bump_pattern found = fg_bump_pattern_find(&at, seed, &p_value);
  p_value = fmin(1, FG_SCAN_LOOP_BUMP_RESPONSES * p_value);
  if (!(p_value < FG_BUMP_PATTERN_P) || !(fabs(found.by) > level->min)) return FG_OK;
  FG_TRY(fill_single_bump_curve(ctx, &at, &found, p_value, coordinate, &level->result));
  return note_pattern(ctx, bumps, response, &at, &found);
}
