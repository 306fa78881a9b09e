/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The search's explanation against all others, by evidence: what nobody named must be able to win.
 */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "effect_search/iterate.h"
#include "evidence/displacement_map.h"
#include "evidence/unnamed.h"
#include "evidence/unseen.h"
#include "evidence/verdict.h"
#include "rows/scatter.h"
#include "scan_loop/form_errors.h"
#include "scan_loop/left_open.h"
#include "scan_loop/state.h"

/* A fit of another set moves the geometry, and with it the columns: so often. */
enum { LINEARISATIONS = 3 };
/* Ratio of misfit to noise from which the misfit counts. */
#define MISFIT_MIN 1.2
/* Relative difference up to which two shapes are one. */
#define SAME_SHAPE 0.02

/* Returns the effect that shows a part in reports: a rival's is its free curve. */
static const fg_effect *shown_as(const fg_evidence_part *part) {
  if (fg_effect_bears_name(part->effect)) return part->effect;
  return part->effect ? fg_rival_curve(part->effect->coordinate, part->effect->moves)
                      : fg_rival_curve(part->rival->coordinate, part->rival->moves);
}

/* ---- explanations in the form of the search ---- */

static bool is_used(const fg_explanations *explanations, size_t candidate) {
  for (size_t m = 0; m < explanations->count; m++)
    if (explanations->each[m].mask >> candidate & 1) return true;
  return false;
}

static bool is_same_shape(const fg_effect *effect, const double *a, const double *b) {
  for (size_t s = 0; effect->starts && s < effect->shapes; s++)
    if (fabs(a[s] - b[s]) > SAME_SHAPE * fabs(b[s])) return false;
  return true;
}

/* Returns the candidate of an effect with this shape, adds it, or puts it in the place of one that
 * no explanation has; FG_CANDIDATES_MAX: there is no room. */
static size_t find_candidate(const fg_edge_fit *edge_fit, fg_explanations *to,
                             const fg_effect *effect, const double *shape) {
  double values[FG_FIELD_COLUMNS];
  size_t at = FG_CANDIDATES_MAX;
  for (size_t e = 0; e < to->candidate_count; e++) {
    const fg_candidate *one = &to->candidates[e];
    if (one->kind != effect) continue;
    bool same = is_same_shape(effect, one->shape, shape);
    if (same || !is_used(to, e)) at = e;
    if (same) break;
  }
  if (at == FG_CANDIDATES_MAX && to->candidate_count < FG_CANDIDATES_MAX) {
    at = to->candidate_count++;
    to->alone[at] = to->share[at] = 0;
    to->smallest_um[at] = NAN;
  }
  for (size_t e = 0; at == FG_CANDIDATES_MAX && e < to->candidate_count; e++)
    if (!is_used(to, e) && to->candidates[e].kind->sought == FG_EFFECT_PLACED) at = e;
  if (at == FG_CANDIDATES_MAX || to->candidates[at].kind == effect) {
    for (size_t s = 0; at < FG_CANDIDATES_MAX && effect->starts && s < effect->shapes; s++)
      to->candidates[at].shape[s] = shape[s];
    return at;
  }
  to->candidates[at] = (fg_candidate){
      .kind = effect,
      .polynomial = effect->polynomial,
      .columns = effect->midline ? effect->midline(edge_fit, edge_fit->rows, shape, values)
                                 : effect->columns,
      .shapes = effect->shapes,
      .shape = {shape[0], shape[1]}};
  return at;
}

/* `behind`: by what the evidence, ln, is behind that of the first; `certain`: only these named
 * effects of the model; NULL: all. */
static void add_explanation(const fg_edge_fit *edge_fit, const fg_evidence_model *model,
                            const double *middle_mm, double behind, const bool *certain,
                            fg_explanations *to) {
  if (to->count == FG_EXPLANATIONS_MAX) return;
  fg_explanation one = {.dof = 1, .excess = 1 + 2 * fmax(0, behind)};
  for (size_t k = 0; k < model->parts; k++) {
    const fg_evidence_part *part = model->part[k];
    const fg_effect *effect = shown_as(part);
    if (certain && !certain[k] && effect == part->effect) continue;
    size_t e = effect ? find_candidate(edge_fit, to, effect, part->shape) : FG_CANDIDATES_MAX;
    if (e == FG_CANDIDATES_MAX) continue;
    one.mask |= 1u << e;
    if (part->effect && part->effect->polynomial)
      one.middle_mm[e] =
          isfinite(middle_mm[k]) ? middle_mm[k] : edge_fit->frame.centre_mm[part->effect->axis];
  }
  for (size_t m = 0; m < to->count; m++)
    if (to->each[m].mask == one.mask) return;
  to->each[to->count++] = one;
  to->total = to->count;
}

/* A named effect beside a rival is not found, unless it is certain: without it the rivals are an
 * explanation, too. */
static void list_explanations(const fg_edge_fit *edge_fit, const fg_evidence_verdict *v,
                              fg_explanations *to) {
  to->count = to->total = 0;
  to->right = v->outcome != FG_EVIDENCE_UNATTRIBUTED;
  if (v->outcome == FG_EVIDENCE_CLEAN) {
    to->each[0] = (fg_explanation){.mask = 0};
    to->count = to->total = 1;
    if (!edge_fit->discs) to->p_value = fmax(to->p_value, v->p_null); /* a disc's form is noise */
    return;
  }
  for (size_t k = 0; k < v->ties; k++)
    add_explanation(edge_fit, &v->tie[k], v->middle_mm[k], v->tie[0].score - v->tie[k].score, NULL,
                    to);
  if (v->tie[0].named && !fg_evidence_is_named(&v->tie[0]))
    add_explanation(edge_fit, &v->tie[0], v->middle_mm[0], v->tie[0].score - v->score_without,
                    v->certain, to);
  to->p_value = fmin(to->p_value, fmax(v->p_null, DBL_MIN));
}

/* ---- the loop's set ---- */

static bool same_kinds(const fg_effect_set *a, const fg_effect_set *b) {
  if (a->count != b->count) return false;
  for (size_t i = 0; i < a->count; i++) {
    size_t k = 0;
    while (k < b->count && a->effects[i].kind != b->effects[k].kind)
      k++;
    if (k == b->count) return false;
  }
  return true;
}

/* Returns true where a fit leaves less than no effect does: sets that the rows hardly tell apart
 * may not converge. */
static bool has_converged(const fg_scan_loop *loop) {
  const fg_edge_fit *edge_fit = &loop->edge_fit;
  return fg_edge_fit_weighted_square(edge_fit, loop->residual_after) <=
         fg_edge_fit_weighted_square(edge_fit, loop->residual_before); /* false for NaN */
}

/* Returns true for a named effect whose numbers are 0 within U: linear columns asked for it, the
 * fit does not. */
static bool is_zero_within_u(const fg_effect_found *effect) {
  const double sigmas = 2;
  return effect->columns > 0 && !fg_effect_is_free(effect->kind) &&
         !fg_effect_found_exceeds(effect, sigmas);
}

static void unlist_zero_effects(const fg_effect_set *set, fg_explanations *explanations) {
  for (size_t e = 0; e < set->count; e++)
    for (size_t c = 0; is_zero_within_u(&set->effects[e]) && c < explanations->candidate_count; c++)
      if (explanations->candidates[c].kind == set->effects[e].kind)
        explanations->each[0].mask &= ~(1u << c);
}

/* Radii are fitted; for a scale, the gauges' are data beside them. */
static fg_status fit_set(fg_context *ctx, fg_scan_loop *loop, fg_effect_set *set) {
  fg_edge_fit_hold_radii(&loop->edge_fit, false);
  loop->edge_fit.gauge_um = fg_effect_set_scales(set) ? loop->gauge_um : 0;
  return fg_joint_fit(ctx, &loop->edge_fit, set, loop->residual_after);
}

/* Leaves effects that are 0 within U out of the only explanation, unless nothing else is in it. */
static fg_status drop_zero_effects(fg_context *ctx, fg_scan_loop *loop) {
  const fg_effect_set all = loop->set;
  fg_effect_set some = {.count = 0};
  for (size_t e = 0; e < all.count; e++)
    if (!is_zero_within_u(&all.effects[e])) some.effects[some.count++] = all.effects[e];
  if (loop->explanations.count > 1 || !some.count || some.count == all.count) return FG_OK;
  fg_status status = fit_set(ctx, loop, &some);
  if (status == FG_ERR_NUMERIC) return fit_set(ctx, loop, &loop->set);
  loop->set = some;
  unlist_zero_effects(&all, &loop->explanations);
  return status;
}

/* Fits the likeliest explanation. FG_ERR_NUMERIC where it cannot be fitted, or one effect alone is
 * nothing then: the one before stays. */
static fg_status fit_explanation(fg_context *ctx, fg_scan_loop *loop, fg_effect_set *set) {
  size_t numbers = fg_edge_fit_geometry_size(&loop->edge_fit);
  double *geometry = NULL;
  FG_TRY(fg_memory_allocate(ctx, numbers, sizeof *geometry, (void **)&geometry));
  fg_edge_fit_geometry_save(&loop->edge_fit, geometry);
  fg_status status = fit_set(ctx, loop, set);
  /* Beside known radii more is left; no effect at all leaves the same, but for its last digits. */
  bool comparable = set->count && !fg_effect_set_scales(set);
  if (status == FG_OK && comparable && !has_converged(loop)) status = FG_ERR_NUMERIC;
  if (status == FG_OK && set->count == 1 && is_zero_within_u(&set->effects[0]))
    status = FG_ERR_NUMERIC;
  if (status == FG_ERR_NUMERIC) {
    fg_edge_fit_geometry_load(&loop->edge_fit, geometry);
    fg_status before = fit_set(ctx, loop, &loop->set);
    if (before != FG_OK) status = before;
  }
  free(geometry);
  return status;
}

/* Adopts the verdict, with its likeliest explanation fitted. FG_ERR_NUMERIC as above: the
 * explanations so far stay. */
static fg_status adopt_verdict(fg_context *ctx, fg_scan_loop *loop, const fg_evidence_verdict *v,
                               bool *moved) {
  fg_explanations next = loop->explanations;
  fg_effect_set set;
  list_explanations(&loop->edge_fit, v, &next);
  fg_explanations_get_set(&next, 0, &set);
  *moved = false;
  if (same_kinds(&set, &loop->set)) {
    loop->explanations = next;
    return FG_OK;
  }
  FG_TRY(fit_explanation(ctx, loop, &set));
  *moved = true;
  loop->set = set;
  loop->explanations = next;
  return drop_zero_effects(ctx, loop);
}

/* In place of named effects that cannot be fitted, the likeliest explanation without a name is
 * adopted. */
static fg_status adopt_fitting_verdict(fg_context *ctx, fg_scan_loop *loop,
                                       const fg_evidence_search *search, fg_evidence_verdict *v,
                                       bool *moved) {
  fg_status status = adopt_verdict(ctx, loop, v, moved);
  if (status == FG_ERR_NUMERIC && fg_evidence_choose_unnamed(search, v))
    status = adopt_verdict(ctx, loop, v, moved);
  return status == FG_ERR_NUMERIC ? FG_OK : status;
}

static fg_status open_parts(fg_context *ctx, const fg_edge_fit *edge_fit,
                            fg_displacement_part **parts) {
  if (*parts) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, edge_fit->part_count, sizeof **parts, (void **)parts));
  for (size_t p = 0; p < edge_fit->part_count; p++)
    FG_TRY(fg_memory_allocate(ctx, edge_fit->parts[p].bump_count, sizeof *(*parts)[p].bumps,
                              (void **)&(*parts)[p].bumps));
  return FG_OK;
}

/* A plate whose cause has no name corrects other scans by a map: its curve alone would not hold
 * what the picture does beside it. */
static fg_status find_map(fg_context *ctx, fg_scan_loop *loop, fg_evidence_search *search,
                          const fg_evidence_verdict *v, const fg_evidence_window *window) {
  fg_field_map_free(&loop->map);
  if (!loop->edge_fit.discs || v->outcome != FG_EVIDENCE_UNATTRIBUTED) return FG_OK;
  return fg_evidence_find_map(ctx, search, window, &loop->displacement, &loop->map);
}

static fg_status find_displacement(fg_context *ctx, fg_scan_loop *loop, fg_evidence_search *search,
                                   const fg_evidence_window *window) {
  FG_TRY(open_parts(ctx, &loop->edge_fit, &loop->displacement_parts));
  FG_TRY(open_parts(ctx, &loop->edge_fit, &loop->unseen_parts));
  if (!loop->edge_fit.discs) FG_TRY(fg_evidence_find_unseen(ctx, search, loop->unseen_parts));
  return fg_evidence_find_displacement(ctx, search, window, &loop->displacement,
                                       loop->displacement_parts);
}

/* Returns true when an explanation of the loop holds an effect or a curve of the scanner. */
static bool holds_scanner(const fg_explanations *explanations) {
  for (size_t e = 0; e < explanations->candidate_count; e++)
    if (explanations->candidates[e].kind->glass && is_used(explanations, e)) return true;
  return false;
}

static void add_spread(const fg_displacement_part *from, size_t bumps, fg_joint_fit_part *to) {
  to->overall += from->overall;
  for (size_t b = 0; b < bumps; b++)
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++)
        to->bumps[b][i][k] += from->bumps[b][i][k];
}

void fg_scan_loop_set_uncertainties(const fg_scan_loop *loop, fg_joint_fit_result *fit) {
  const fg_edge_fit *edge_fit = &loop->edge_fit;
  for (size_t p = 0; p < edge_fit->part_count; p++) {
    size_t bumps = edge_fit->parts[p].bump_count;
    fit->parts[p].overall = 0;
    memset(fit->parts[p].bumps, 0, bumps * sizeof *fit->parts[p].bumps);
    if (!loop->scanner_is_suspect) continue;
    add_spread(&loop->displacement_parts[p], bumps, &fit->parts[p]);
    if (loop->beside_foil_field) add_spread(&loop->unseen_parts[p], bumps, &fit->parts[p]);
  }
}

/* Sets that a search of models begins with. */
enum { SEEDS_MAX = FG_EXPLANATIONS_MAX + 1 };
typedef struct seed_list {
  fg_effect_set *set; /* owned; SEEDS_MAX */
  size_t count;
} seed_list;

static double scatter_noise_um(const fg_scatter *s) {
  return s->row_um * sqrt((s->share > 0 ? s->integral : 1) * fmax(1, s->swell));
}

/* On discs the search gives every disc's form to the noise, which evidence holds apart: its noise
 * is that of the edge beside them, at its least: a curve in place of a cause leaves more. */
static fg_status take_edge_noise(fg_context *ctx, fg_scan_loop *loop) {
  fg_scatter *now = &loop->edge_fit.scatter, *lowest = &loop->scatter_min;
  FG_TRY(fg_edge_fit_find_scatter(ctx, &loop->edge_fit, loop->residual_after));
  if (!(lowest->row_um > 0) || scatter_noise_um(now) < scatter_noise_um(lowest)) *lowest = *now;
  *now = *lowest;
  return FG_OK;
}

static fg_status open_search(fg_context *ctx, fg_scan_loop *loop, const double *residual,
                             const double *jacobian, const seed_list *seeds,
                             fg_evidence_search *search) {
  const fg_scan_loop_options *options = &loop->options;
  const fg_evidence_request request = {
      .seed = seeds->set,
      .seeds = seeds->count,
      .prior = {options->prior_size > 0 ? options->prior_size : 1,
                options->prior_weight > 0 ? options->prior_weight : 1},
      .threads = options->threads,
  };
  fg_edge_fit *edge_fit = &loop->edge_fit;
  const fg_scatter before = edge_fit->scatter;
  if (edge_fit->discs) FG_TRY(take_edge_noise(ctx, loop));
  fg_status status = fg_evidence_search_open(ctx, edge_fit, &request, residual, jacobian, search);
  edge_fit->scatter = before;
  return status;
}

/* A misfit of the best model is noise to all models: then the search is repeated with it. */
static fg_status search_models(fg_context *ctx, fg_scan_loop *loop, const double *residual,
                               const double *jacobian, const seed_list *seeds,
                               fg_evidence_search *search) {
  double misfit_um = 0;
  FG_TRY(open_search(ctx, loop, residual, jacobian, seeds, search));
  FG_TRY(fg_evidence_search_run(ctx, search));
  FG_TRY(fg_evidence_find_misfit(ctx, search, &misfit_um));
  loop->gauge_um = search->models[0].scatter_um[FG_EVIDENCE_GAUGE];
  loop->misfit = misfit_um > MISFIT_MIN * search->problem.noise_um;
  if (!loop->misfit) return FG_OK;
  fg_evidence_rescale(&search->problem, misfit_um);
  return fg_evidence_search_run(ctx, search);
}

/* Returns true where the mean displacement is not to be trusted beside the rows that it was seen
 * at; discs show their whole rings. */
static bool leaves_more(const fg_scan_loop *loop, const fg_evidence_verdict *v) {
  return loop->misfit || fg_scan_loop_is_loose(v);
}

/* All that explain as well by the search before. */
static void seed_by_search(const fg_scan_loop *loop, seed_list *seeds) {
  for (seeds->count = 1; seeds->count <= loop->explanations.count; seeds->count++)
    fg_explanations_get_set(&loop->explanations, seeds->count - 1, &seeds->set[seeds->count]);
}

/* The likeliest sets of named effects at one linearisation, for the next. */
static void seed_by_evidence(const fg_evidence_search *search, seed_list *seeds) {
  seeds->count = 1;
  for (size_t m = 0; m < search->count && seeds->count < SEEDS_MAX; m++) {
    const fg_evidence_model *model = &search->models[m];
    fg_effect_set *to = &seeds->set[seeds->count];
    if (!fg_evidence_is_named(model)) continue;
    *to = (fg_effect_set){.count = model->parts};
    for (size_t k = 0; k < model->parts; k++) {
      to->effects[k].kind = model->part[k]->effect;
      memcpy(to->effects[k].shape, model->part[k]->shape, sizeof to->effects[k].shape);
    }
    seeds->count++;
  }
}

/* Columns that err speak against the right names, too: they are taken anew about the likeliest
 * ones before it is decided. */
static fg_status move_to_names(fg_context *ctx, fg_scan_loop *loop, fg_evidence_search *search,
                               bool *moved) {
  fg_evidence_verdict verdict;
  *moved = false;
  FG_TRY(fg_evidence_decide(ctx, search, true, &verdict));
  if (verdict.outcome != FG_EVIDENCE_FOUND && verdict.outcome != FG_EVIDENCE_TIED) return FG_OK;
  fg_status status = adopt_verdict(ctx, loop, &verdict, moved);
  return status == FG_ERR_NUMERIC ? FG_OK : status;
}

static fg_status weigh_once(fg_context *ctx, fg_scan_loop *loop, double *residual, double *jacobian,
                            seed_list *seeds, bool first, bool *moved) {
  fg_evidence_search search = {.count = 0};
  fg_evidence_verdict verdict;
  fg_evidence_window window;
  fg_status status = FG_OK;
  seeds->set[0] = loop->set;
  fg_edge_fit_hold_radii(&loop->edge_fit, true);
  FG_TRY(fg_search_put_back(ctx, &loop->edge_fit, &loop->set, residual, jacobian));
  FG_TRY_EXIT(search_models(ctx, loop, residual, jacobian, seeds, &search));
  seed_by_evidence(&search, seeds);
  if (first && search.problem.large) {
    FG_TRY_EXIT(move_to_names(ctx, loop, &search, moved));
    if (*moved) goto exit;
  }
  FG_TRY_EXIT(fg_evidence_decide(ctx, &search, false, &verdict));
  loop->misfit = fg_scan_loop_is_split_open(&loop->edge_fit, &verdict) ||
                 (!loop->edge_fit.discs && leaves_more(loop, &verdict));
  loop->edge_error_um = search.problem.error_um;
  loop->margin = verdict.margin;
  loop->beside_foil_field = fg_scan_loop_is_beside_foil_field(&loop->edge_fit, &verdict);
  FG_TRY_EXIT(fg_evidence_list_window(
      ctx, &search, verdict.outcome == FG_EVIDENCE_FOUND ? &verdict.tie[0] : NULL, &window));
  FG_TRY_EXIT(find_displacement(ctx, loop, &search, &window));
  FG_TRY_EXIT(fg_scan_loop_find_form_errors(ctx, loop, &search, &verdict));
  FG_TRY_EXIT(adopt_fitting_verdict(ctx, loop, &search, &verdict, moved));
  FG_TRY_EXIT(find_map(ctx, loop, &search, &verdict, &window));
  *moved = *moved && search.problem.large;
exit:
  fg_evidence_search_close(&search);
  return status;
}

/* Fits the explanation in force to its radii. Residuals before and after a scale are from known
 * ones, which alone show it. */
static fg_status fit_beside_known_radii(fg_context *ctx, fg_scan_loop *loop) {
  fg_effect_set none = {.count = 0};
  if (fg_effect_set_scales(&loop->set)) {
    fg_edge_fit_hold_radii(&loop->edge_fit, true);
    loop->edge_fit.gauge_um = 0;
    FG_TRY(fg_joint_fit(ctx, &loop->edge_fit, &none, loop->residual_before));
  }
  return fit_set(ctx, loop, &loop->set);
}

/* A curve of discs stands for a cause without a name, which it may fit badly: nothing is sought
 * about it. */
static bool stands_for_cause(const fg_scan_loop *loop) {
  bool curves = loop->edge_fit.discs && loop->set.count > 0;
  for (size_t e = 0; e < loop->set.count; e++)
    curves = curves && fg_effect_is_free(loop->set.effects[e].kind);
  return curves;
}

fg_status fg_scan_loop_weigh_evidence(fg_context *ctx, fg_scan_loop *loop) {
  fg_edge_fit *edge_fit = &loop->edge_fit;
  double *residual = NULL, *jacobian = NULL;
  seed_list seeds = {NULL, 0};
  bool moved = true;
  fg_status status = FG_OK;
  if (edge_fit->coarse || !fg_evidence_fits(edge_fit)) return FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, edge_fit->row_count, sizeof *residual, (void **)&residual));
  FG_TRY_EXIT(fg_memory_allocate(ctx, edge_fit->row_count, edge_fit->parameters * sizeof *jacobian,
                                 (void **)&jacobian));
  FG_TRY_EXIT(fg_memory_allocate(ctx, SEEDS_MAX, sizeof *seeds.set, (void **)&seeds.set));
  seed_by_search(loop, &seeds);
  for (int round = 0; moved && round < LINEARISATIONS; round++) {
    FG_TRY_EXIT(weigh_once(ctx, loop, residual, jacobian, &seeds, round == 0, &moved));
    moved = moved && !stands_for_cause(loop);
  }
  if (edge_fit->known_count) FG_TRY_EXIT(fit_beside_known_radii(ctx, loop));
  loop->by_evidence = true;
  loop->scanner_is_suspect = holds_scanner(&loop->explanations);
exit:
  free(seeds.set);
  free(residual);
  free(jacobian);
  return status;
}
