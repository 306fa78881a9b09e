/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bearings with random shims under their bumps, or of foils of a lot: their films, and the
 * stability of a rotor on them. Every draw has a random stream of its own, so that neither the
 * number of draws nor that of threads changes any of them. */
#include <math.h>
#include <stdlib.h>

#include "core/parallel.h"
#include "core/select.h"
#include "core/splitmix.h"
#include "film/draw_file.h"
#include "film/stock.h"
#include "foilgauge/density.h"
#include "foilgauge/memory.h"
#include "lot/statistics/assembly.h"

enum { DRAWS_OF_A_TASK = 10, SCATTER_DRAWS = 200 };
static const double confidence = 0.95;

/* Ratio that stands for a bearing that is stable at every mass, among sorted ratios, and one that
 * only a quantile between such a bearing and a finite one exceeds. */
static const double large = 1e100, finite_max = 1e50;

typedef struct draw_task {
  fg_film_report *report;
  const fg_film_bearing *perfect;
  const fg_film_workspace *solved; /* of the perfect bearing */
  const fg_film_stock *stock;      /* NULL: random shims, or */
  const fg_film_sensitivity *scatter;
  double spread_mm; /* of a tolerance, or */
  bool measured;    /* the clearances' uncertainties */
  fg_film_draws *draws;
  fg_film_draw_file *file; /* NULL: none, and no shard */
} draw_task;

/* Streams of random numbers: of shims, of a scatter of every parameter, and of these. */
enum {
  STREAM_SHIMS,
  STREAM_SCATTER,
  STREAM_SPREAD = STREAM_SCATTER + FG_FILM_PARAMETERS,
  STREAM_MEASURED
};

static uint64_t seed_draw(const fg_film_report *r, uint64_t purpose, size_t draw) {
  uint64_t state = r->options.seed * 0xd1342543de82ef95u + purpose;
  state = fg_splitmix_next(&state) ^ draw;
  return fg_splitmix_next(&state);
}

/* A scatter of one percent, normal. */
static void draw_scatter(const fg_film_report *r, const fg_film_sensitivity *scatter, size_t draw,
                         fg_film_bearing *bearing) {
  uint64_t state = seed_draw(r, STREAM_SCATTER + (uint64_t)scatter->parameter, draw);
  for (size_t i = 0; i < bearing->count; i++)
    fg_film_change_bump(scatter, fg_splitmix_normal(&state), i, bearing);
}

/* Shims of heights between both ends, of equal probability: a higher one closes the clearance. */
static void draw_shims(const fg_film_report *r, size_t draw, fg_film_bearing *bearing) {
  uint64_t state = seed_draw(r, STREAM_SHIMS, draw);
  double low = r->options.draw.shim_low_pct, high = r->options.draw.shim_high_pct;
  for (size_t i = 0; i < bearing->count; i++) {
    double height_pct = low + (high - low) * fg_splitmix_uniform(&state);
    bearing->clearance_mm[i] -= height_pct / 100 * r->clearance_um * 1e-3;
  }
}

static void draw_spread(const fg_film_report *r, double spread_mm, size_t draw,
                        fg_film_bearing *bearing) {
  uint64_t state = seed_draw(r, STREAM_SPREAD, draw);
  for (size_t i = 0; i < bearing->count; i++)
    bearing->clearance_mm[i] += spread_mm * (2 * fg_splitmix_uniform(&state) - 1);
}

static void draw_measured(const fg_film_report *r, size_t draw, fg_film_bearing *bearing) {
  uint64_t state = seed_draw(r, STREAM_MEASURED, draw);
  double common = fg_splitmix_normal(&state);
  for (size_t i = 0; i < bearing->count; i++)
    bearing->clearance_mm[i] +=
        r->u_shared_mm[i] * common + r->u_own_mm[i] * fg_splitmix_normal(&state);
}

/* Foils of the stock, picked as a lot's assembly picks them. */
static void draw_foils(const fg_film_report *r, const fg_film_stock *stock, size_t draw,
                       fg_film_bearing *bearing) {
  size_t foil[FG_BEARING_BUMPS_MAX], pads = r->options.pads ? r->options.pads : 1;
  fg_assembly_pick(r->options.seed, draw, stock->foils, pads, foil);
  for (size_t i = 0; i < bearing->count; i++) {
    size_t from = foil[i / stock->places] * stock->places + i % stock->places;
    bearing->clearance_mm[i] = stock->clearance_mm[from];
    bearing->stiffness_n_mm2[i] *= stock->stiffness[from];
  }
}

/* On from the perfect bearing's film; where none is found so that a rotor rests on, from rotors
 * held at places. Without one the first result stands. */
static fg_status find_film(fg_context *ctx, const fg_film_report *r, fg_film_workspace *workspace,
                           const fg_film_bearing *bearing, fg_film_result *result) {
  fg_film_result other;
  double rpm = r->options.speed_rpm;
  FG_TRY(fg_film_solve_bearing(ctx, r, workspace, bearing, rpm, FG_FILM_ONWARD, result));
  if (result->outcome != FG_FILM_UNSOLVED && !fg_film_falls_off(result)) return FG_OK;
  FG_TRY(fg_film_solve_from_places(ctx, r, workspace, bearing, rpm, &other));
  if (other.outcome != FG_FILM_UNSOLVED && !fg_film_falls_off(&other)) *result = other;
  return FG_OK;
}

/* Of a tolerance's trial only the threshold speed counts. */
static fg_status solve_drawn(fg_context *ctx, const draw_task *t, fg_film_workspace *workspace,
                             const fg_film_bearing *bearing, fg_film_result *result) {
  const fg_film_report *r = t->report;
  fg_film_threshold_verdict threshold = FG_FILM_THRESHOLD_NOT_ASKED;
  bool asked = isfinite(r->tolerance.threshold_rpm) && !t->scatter && !t->measured;
  *result = (fg_film_result){.outcome = FG_FILM_UNSOLVED, .mass_over_perfect = NAN};
  if (!(t->spread_mm > 0)) {
    FG_TRY(find_film(ctx, r, workspace, bearing, result));
    result->mass_over_perfect = fg_film_mass_over(r, result->critical_mass_kg);
  }
  if (asked) FG_TRY(fg_film_compare_threshold(ctx, r, workspace, bearing, &threshold));
  result->threshold = threshold;
  return FG_OK;
}

static fg_status solve_draw(fg_context *ctx, const draw_task *t, fg_film_workspace *workspace,
                            size_t draw) {
  fg_film_bearing bearing = *t->perfect;
  fg_film_result *result = &t->draws->result[draw];
  bool varied = t->scatter || t->spread_mm > 0 || t->measured;
  if (t->stock)
    draw_foils(t->report, t->stock, draw, &bearing);
  else if (t->measured)
    draw_measured(t->report, draw, &bearing);
  else if (t->spread_mm > 0)
    draw_spread(t->report, t->spread_mm, draw, &bearing);
  else if (t->scatter)
    draw_scatter(t->report, t->scatter, draw, &bearing);
  else
    draw_shims(t->report, draw, &bearing);
  if (!varied) fg_film_add_bore(t->report, &bearing);
  fg_film_state_copy(&workspace->film, &t->solved->state, &workspace->state);
  fg_film_case_copy(&t->solved->before, workspace->film.columns, &workspace->before);
  return solve_drawn(ctx, t, workspace, &bearing, result);
}

/* True for a draw of an earlier run or of another shard. */
static bool is_elsewhere(const draw_task *t, size_t draw) {
  const fg_film_options *o = &t->report->options;
  if (!t->file) return false;
  return t->file->known[draw] || (o->draw.shards && draw % o->draw.shards != o->draw.shard - 1);
}

static fg_status solve_draws(fg_context *ctx, void *shared, size_t item) {
  const draw_task *t = shared;
  size_t end = (item + 1) * DRAWS_OF_A_TASK;
  fg_film_workspace workspace;
  FG_TRY(fg_film_workspace_open(ctx, t->report, &workspace));
  fg_status status = FG_OK;
  for (size_t i = item * DRAWS_OF_A_TASK; i < end && status == FG_OK; i++) {
    if (i >= t->draws->count || is_elsewhere(t, i)) continue;
    status = solve_draw(ctx, t, &workspace, i);
    t->draws->result[i].draw = i + 1;
    if (status == FG_OK && t->file)
      status = fg_film_draw_file_add(ctx, t->file, &t->draws->result[i]);
  }
  fg_film_workspace_close(&workspace);
  return status;
}

static void finish_share(fg_film_share *share, size_t of) {
  share->share = of ? (double)share->count / (double)of : NAN;
  share->low = share->high = NAN;
  if (of)
    fg_assembly_interval((double)share->count, (double)of, confidence, &share->low, &share->high);
}

static void count_draw(fg_film_draws *draws, const fg_film_result *result, double perfect_kg) {
  draws->within.count += result->threshold == FG_FILM_THRESHOLD_WITHIN;
  draws->not_lower.count +=
      result->threshold == FG_FILM_THRESHOLD_WITHIN || result->threshold == FG_FILM_THRESHOLD_ABOVE;
  if (result->outcome == FG_FILM_UNSOLVED) return;
  draws->solved.count++;
  draws->touching.count += result->outcome == FG_FILM_TOUCHING;
  draws->more_stable.count += result->critical_mass_kg > perfect_kg;
  draws->less_stable.count += result->critical_mass_kg < perfect_kg;
}

static fg_status finish_draws(fg_context *ctx, const fg_film_report *r, fg_film_draws *draws) {
  void *block;
  size_t known = 0;
  FG_TRY(fg_memory_allocate(ctx, draws->count, sizeof(double), &block));
  double *ratio = block;
  for (size_t i = 0; i < draws->count; i++) {
    count_draw(draws, &draws->result[i], r->perfect.critical_mass_kg);
    double value = draws->result[i].mass_over_perfect;
    if (!isnan(value)) ratio[known++] = fmin(value, large);
  }
  fg_sort(ratio, known);
  for (size_t k = 0; k < FG_FILM_QUANTILES; k++)
    draws->quantile[k] = known ? fg_sample_quantile(ratio, known, fg_assembly_probability[k]) : NAN;
  for (size_t k = 0; k < FG_FILM_QUANTILES; k++)
    if (draws->quantile[k] > finite_max) draws->quantile[k] = INFINITY;
  free(ratio);
  finish_share(&draws->solved, draws->count);
  finish_share(&draws->touching, draws->count);
  finish_share(&draws->within, draws->count);
  finish_share(&draws->not_lower, draws->count);
  finish_share(&draws->more_stable, draws->solved.count);
  finish_share(&draws->less_stable, draws->solved.count);
  return FG_OK;
}

static fg_status allocate_draws(fg_context *ctx, size_t count, fg_film_draws *draws) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *draws->result, &block));
  draws->result = block;
  draws->count = draws->asked = count;
  return FG_OK;
}

static fg_status solve_all_draws(fg_context *ctx, draw_task *task) {
  return fg_parallel_run(ctx, task->report->options.jobs,
                         (task->draws->count + DRAWS_OF_A_TASK - 1) / DRAWS_OF_A_TASK, solve_draws,
                         task);
}

static fg_status draw_all(fg_context *ctx, draw_task *task, size_t count) {
  FG_TRY(allocate_draws(ctx, count, task->draws));
  FG_TRY(solve_all_draws(ctx, task));
  return finish_draws(ctx, task->report, task->draws);
}

/* Leaves out draws that are not there. */
static void drop_missing(fg_film_draws *draws) {
  size_t there = 0;
  for (size_t i = 0; i < draws->count; i++)
    if (draws->result[i].draw) draws->result[there++] = draws->result[i];
  draws->count = there;
}

/* Draws that the file of options.draw.keep lacks are solved and added to it. */
static fg_status draw_with_file(fg_context *ctx, draw_task *task, size_t count) {
  fg_film_draw_file file;
  fg_context inner;
  FG_TRY(allocate_draws(ctx, count, task->draws));
  FG_TRY(fg_film_draw_file_open(ctx, task->report, task->perfect, task->stock, task->draws, &file));
  task->file = &file;
  fg_status status = solve_all_draws(ctx, task);
  fg_status closed = fg_film_draw_file_close(&inner, &file);
  task->file = NULL;
  if (status == FG_OK && closed != FG_OK) return fg_fail(ctx, closed, "%s", inner.message);
  FG_TRY(status);
  drop_missing(task->draws);
  return finish_draws(ctx, task->report, task->draws);
}

fg_status fg_film_draw_scatter(fg_context *ctx, fg_film_report *report,
                               const fg_film_bearing *perfect, const fg_film_workspace *solved,
                               fg_film_sensitivity *scatter) {
  fg_film_draws draws = {.count = 0};
  draw_task task = {
      .report = report, .perfect = perfect, .solved = solved, .scatter = scatter, .draws = &draws};
  fg_status status = draw_all(ctx, &task, SCATTER_DRAWS);
  scatter->solved = draws.solved;
  for (size_t k = 0; k < FG_FILM_QUANTILES; k++)
    scatter->quantile[k] = draws.quantile[k];
  free(draws.result);
  return status;
}

fg_status fg_film_draw_spread(fg_context *ctx, fg_film_report *report,
                              const fg_film_bearing *perfect, const fg_film_workspace *solved,
                              double spread_mm, size_t count, fg_film_draws *draws) {
  draw_task task = {.report = report,
                    .perfect = perfect,
                    .solved = solved,
                    .spread_mm = spread_mm,
                    .draws = draws};
  *draws = (fg_film_draws){.count = 0};
  return draw_all(ctx, &task, count);
}

fg_status fg_film_draw_measured(fg_context *ctx, fg_film_report *report,
                                const fg_film_workspace *solved, size_t count,
                                fg_film_draws *draws) {
  draw_task task = {.report = report,
                    .perfect = &report->bearing,
                    .solved = solved,
                    .measured = true,
                    .draws = draws};
  *draws = (fg_film_draws){.count = 0};
  return draw_all(ctx, &task, count);
}

fg_status fg_film_draw(fg_context *ctx, fg_film_report *report, const fg_film_bearing *perfect,
                       const fg_film_workspace *solved) {
  fg_film_stock stock;
  size_t count = report->options.draw.count;
  draw_task task = {
      .report = report, .perfect = perfect, .solved = solved, .draws = &report->draws};
  if (!count) return FG_OK;
  if (!fg_film_draws_from_lot(&report->options)) return draw_with_file(ctx, &task, count);
  if (report->options.stock) {
    task.stock = report->options.stock;
    report->draws.foils = task.stock->foils;
    report->draws.left_out = task.stock->left_out;
    return draw_with_file(ctx, &task, count);
  }
  FG_TRY(fg_film_stock_read(ctx, report, &stock));
  task.stock = &stock;
  report->draws.foils = stock.foils;
  report->draws.left_out = stock.left_out;
  fg_status status = draw_with_file(ctx, &task, count);
  fg_film_stock_free(&stock);
  return status;
}
