/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/displacement.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "effect/columns.h"
#include "evidence/verdict.h"

/* Models of less weight than this, relative to the likeliest, change nothing. */
#define WEIGHT_MIN 1e-3
/* Weight of a model that the likeliest leads by FG_EVIDENCE_LEAD: models that a verdict does not
 * tell apart have weight. */
#define WEIGHT_AT_MARGIN 0.1
/* Ridge of the bumps' own sizes where they are not bounded: their sum over the bumps lies in the
 * flat directions. */
#define RIDGE 1e-9
enum { MODELS_MAX = 48 };

fg_point fg_displacement_at(const fg_displacement *d, fg_point at) {
  fg_point each[FG_RIVAL_COLUMNS], sum = {0, 0};
  for (size_t e = 0; e < d->effects; e++) {
    d->effect[e].effect->glass(&d->frame, d->effect[e].shape, at, each);
    for (size_t c = 0; c < d->effect[e].columns; c++) {
      sum.x += 1e-3 * d->effect[e].um[c] * each[c].x;
      sum.y += 1e-3 * d->effect[e].um[c] * each[c].y;
    }
  }
  for (size_t r = 0; r < d->rivals; r++) {
    size_t count = d->rival[r].rival->glass(&d->frame, at, each);
    for (size_t c = 0; c < count; c++) {
      sum.x += 1e-3 * d->rival[r].um[c] * each[c].x;
      sum.y += 1e-3 * d->rival[r].um[c] * each[c].y;
    }
  }
  return sum;
}

static bool is_of_scanner(const fg_evidence_part *part) {
  return part->effect ? part->effect->glass != NULL : part->rival->glass != NULL;
}

/* ---- the mean ---- */

static double *amplitudes_of_effect(const fg_evidence_part *part, fg_displacement *d) {
  const fg_effect *effect =
      part->effect->polynomial ? &fg_effect_powers[part->effect->axis] : part->effect;
  for (size_t e = 0; e < d->effects; e++)
    if (d->effect[e].effect == effect && d->effect[e].shape[0] == part->shape[0] &&
        d->effect[e].columns == part->count)
      return d->effect[e].um;
  if (d->effects == FG_DISPLACEMENT_EFFECTS) return NULL;
  memset(&d->effect[d->effects], 0, sizeof d->effect[0]);
  d->effect[d->effects].effect = effect;
  d->effect[d->effects].columns = part->count;
  memcpy(d->effect[d->effects].shape, part->shape, sizeof part->shape);
  return d->effect[d->effects++].um;
}

static double *amplitudes_of_rival(const fg_rival *rival, fg_displacement *d) {
  for (size_t r = 0; r < d->rivals; r++)
    if (d->rival[r].rival == rival) return d->rival[r].um;
  if (d->rivals == FG_DISPLACEMENT_RIVALS) return NULL;
  memset(&d->rival[d->rivals], 0, sizeof d->rival[0]);
  d->rival[d->rivals].rival = rival;
  return d->rival[d->rivals++].um;
}

static void add_mean(const fg_evidence_search *s, const fg_evidence_model *model,
                     const fg_evidence_posterior *posterior, double weight, fg_displacement *d) {
  for (size_t k = 0; k < model->parts; k++) {
    const fg_evidence_part *part = model->part[k];
    if (!is_of_scanner(part)) continue;
    double *um = part->effect ? amplitudes_of_effect(part, d) : amplitudes_of_rival(part->rival, d);
    if (um && part->rival && part->rival->stretch) um += part->stretch * part->count;
    const double *mean = posterior->mean + fg_evidence_first_of(s, model, k);
    for (size_t c = 0; um && c < part->count; c++)
      um[c] += weight * mean[c];
  }
}

/* ---- how the geometry follows the scanner's columns ---- */

/* Numbers of the geometry that are wanted, in um: of each part R0, then X and R of every bump. */
typedef struct wanted {
  size_t count;
  double *flat;    /* count × rank */
  double *scatter; /* lower factor of the bumps' own sizes, count of the scatter squared */
} wanted;

static size_t parameter_of(const fg_edge_fit *edge_fit, size_t index) {
  size_t at = 0;
  for (size_t p = 0; p < edge_fit->part_count; p++) {
    size_t bumps = edge_fit->parts[p].bump_count;
    if (index < 1 + 2 * bumps)
      return index ? at + 1 + 3 * ((index - 1) / 2) + 2 * ((index - 1) % 2) : at;
    index -= 1 + 2 * bumps;
    at += 1 + 3 * bumps;
  }
  return at;
}

static fg_status open_wanted(fg_context *ctx, fg_evidence_search *s, wanted *w) {
  fg_evidence_problem *p = &s->problem;
  const fg_edge_fit *edge_fit = p->edge_fit;
  size_t n = s->scatter.count;
  for (size_t part = 0; part < edge_fit->part_count; part++)
    w->count += 1 + 2 * edge_fit->parts[part].bump_count;
  FG_TRY(fg_memory_allocate(ctx, w->count * p->rank + 1, sizeof *w->flat, (void **)&w->flat));
  FG_TRY(fg_memory_allocate(ctx, n * n + 1, sizeof *w->scatter, (void **)&w->scatter));
  for (size_t i = 0; i < w->count; i++)
    for (size_t k = 0; k < p->rank; k++)
      w->flat[i * p->rank + k] =
          p->directions[k * edge_fit->parameters + parameter_of(edge_fit, i)];
  for (size_t i = 0; i < n; i++) {
    double *row = w->scatter + i * n;
    fg_evidence_products(p, s->scatter.first + i, s->scatter.first, i + 1, row);
    row[i] += RIDGE + 1e-6 * row[i];
    for (size_t k = 0; k <= i; k++) {
      double value = row[k] - fg_dot(row, w->scatter + k * n, k);
      row[k] = k < i ? value / w->scatter[k * n + k] : sqrt(fmax(value, RIDGE));
    }
  }
  return FG_OK;
}

/* Least squares of the geometry to one column, without any prior. `sizes`: room for the scatter. */
static void follow_column(fg_evidence_search *s, const wanted *w, size_t column, double *sizes,
                          double *to) {
  fg_evidence_problem *p = &s->problem;
  size_t n = s->scatter.count, rank = p->rank, at = 0;
  fg_evidence_products(p, column, s->scatter.first, n, sizes);
  for (size_t i = 0; i < n; i++)
    sizes[i] = (sizes[i] - fg_dot(w->scatter + i * n, sizes, i)) / w->scatter[i * n + i];
  for (size_t i = n; i-- > 0;) {
    for (size_t k = i + 1; k < n; k++)
      sizes[i] -= w->scatter[k * n + i] * sizes[k];
    sizes[i] /= w->scatter[i * n + i];
  }
  for (size_t i = 0; i < w->count; i++) {
    double sum = 0;
    for (size_t k = 0; k < rank; k++) {
      double along = p->along[column * rank + k];
      for (size_t c = 0; c < n; c++)
        along -= p->along[(s->scatter.first + c) * rank + k] * sizes[c];
      sum += w->flat[i * rank + k] * along;
    }
    to[i] = sum;
  }
  size_t bump = 0;
  for (size_t part = 0; part < p->edge_fit->part_count; part++) {
    for (size_t b = 0; b < p->edge_fit->parts[part].bump_count && 3 * bump < n; b++, bump++) {
      to[at + 1 + 2 * b] += sizes[3 * bump];
      to[at + 2 + 2 * b] += sizes[3 * bump + 1];
    }
    at += 1 + 2 * p->edge_fit->parts[part].bump_count;
  }
}

/* Adds to mean and second moment of the geometry's shift those under one model. */
static fg_status add_moments(fg_context *ctx, fg_evidence_search *s, const wanted *w,
                             const fg_evidence_model *model, const fg_evidence_posterior *posterior,
                             double weight, double *mean, double *second) {
  size_t n = 0, list[FG_EVIDENCE_MODEL_COLUMNS];
  double *follow = NULL;
  for (size_t k = 0; k < model->parts; k++)
    for (size_t c = 0; is_of_scanner(model->part[k]) && c < model->part[k]->count; c++)
      list[n++] = fg_evidence_first_of(s, model, k) + c;
  FG_TRY(fg_memory_allocate(ctx, (n + 1) * (2 * w->count + 2) + s->scatter.count, sizeof *follow,
                            (void **)&follow));
  double *times = follow + n * w->count, *own = times + w->count, *sizes = own + w->count;
  for (size_t c = 0; c < n; c++)
    follow_column(s, w, posterior->column[list[c]], sizes, follow + c * w->count);
  memset(own, 0, w->count * sizeof *own);
  for (size_t c = 0; c < n; c++)
    for (size_t i = 0; i < w->count; i++)
      own[i] += follow[c * w->count + i] * posterior->mean[list[c]];
  for (size_t c = 0; c < n; c++) {
    memset(times, 0, w->count * sizeof *times);
    for (size_t k = 0; k < n; k++)
      for (size_t i = 0; i < w->count; i++)
        times[i] +=
            posterior->covariance[list[c] * posterior->count + list[k]] * follow[k * w->count + i];
    for (size_t i = 0; i < w->count; i++)
      for (size_t k = 0; k < w->count; k++)
        second[i * w->count + k] += weight * follow[c * w->count + i] * times[k];
  }
  for (size_t i = 0; i < w->count; i++) {
    mean[i] += weight * own[i];
    for (size_t k = 0; k < w->count; k++)
      second[i * w->count + k] += weight * own[i] * own[k];
  }
  free(follow);
  return FG_OK;
}

static void fill_parts(const fg_edge_fit *edge_fit, size_t count, const double *mean,
                       const double *second, fg_displacement_part *parts) {
  size_t at = 0;
  for (size_t p = 0; p < edge_fit->part_count; p++) {
    size_t bumps = edge_fit->parts[p].bump_count;
#define SPREAD(i, k) (1e-6 * (second[(i)*count + (k)] - mean[i] * mean[k]))
    parts[p].overall = fmax(0, SPREAD(at, at));
    for (size_t b = 0; b < bumps; b++) {
      const size_t index[3] = {at + 1 + 2 * b, at + 2 + 2 * b, at};
      for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
          parts[p].bumps[b][i][k] = SPREAD(index[i], index[k]);
    }
#undef SPREAD
    at += 1 + 2 * bumps;
  }
}

/* Occam's window (Madigan and Raftery 1994): models that are not far less likely than the best, and
 * include none that is likelier. */
static size_t list_window(const fg_evidence_search *s, const fg_evidence_model **list, bool decided,
                          double *weight) {
  double per_nat = decided ? 1 : log(1 / WEIGHT_AT_MARGIN) / FG_EVIDENCE_LEAD, total = 0;
  size_t count = 0;
  for (size_t m = 0; m < s->count && count < MODELS_MAX; m++) {
    const fg_evidence_model *model = &s->models[m];
    double below = per_nat * (s->models[0].score - model->score);
    bool more = false;
    if (below > log(1 / WEIGHT_MIN)) break; /* sorted */
    for (size_t k = 0; k < count && !more; k++)
      more = fg_evidence_includes(model, list[k]);
    if (more) continue;
    list[count] = model;
    total += weight[count++] = exp(-below);
  }
  for (size_t m = 0; m < count; m++)
    weight[m] /= total;
  return count;
}

fg_status fg_evidence_find_displacement(fg_context *ctx, fg_evidence_search *s, bool decided,
                                        fg_displacement *d, fg_displacement_part *parts) {
  wanted w = {.count = 0};
  const fg_evidence_model *model[MODELS_MAX];
  double *mean = NULL, weight[MODELS_MAX];
  fg_status status = FG_OK;
  size_t models = list_window(s, model, decided, weight);
  *d = (fg_displacement){.frame = s->problem.edge_fit->frame};
  FG_TRY_EXIT(open_wanted(ctx, s, &w));
  FG_TRY_EXIT(fg_memory_allocate(ctx, w.count * (w.count + 1) + 1, sizeof *mean, (void **)&mean));
  for (size_t m = 0; m < models; m++) {
    fg_evidence_posterior posterior;
    FG_TRY_EXIT(fg_evidence_find_posterior(ctx, s, model[m], &posterior));
    add_mean(s, model[m], &posterior, weight[m], d);
    status = add_moments(ctx, s, &w, model[m], &posterior, weight[m], mean, mean + w.count);
    fg_evidence_posterior_close(&posterior);
    if (status != FG_OK) goto exit;
  }
  fill_parts(s->problem.edge_fit, w.count, mean, mean + w.count, parts);
exit:
  free(w.flat);
  free(w.scatter);
  free(mean);
  return status;
}
