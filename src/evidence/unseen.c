/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/unseen.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "evidence/fit.h"
#include "evidence/shift.h"

/* Sizes less likely than this, relative to the likeliest, change nothing. */
#define WEIGHT_MIN 1e-3
enum { LENGTHS_MAX = 8, SIZES_MAX = LENGTHS_MAX * FG_EVIDENCE_AMPLITUDES };

/* Sizes of a map: variances of its columns, and ln evidence, then the weight. */
typedef struct sizes {
  size_t count, columns;
  double variance[SIZES_MAX][FG_RIVAL_COLUMNS], weight[SIZES_MAX];
} sizes;

static const fg_evidence_option *find_map(const fg_evidence_search *s) {
  for (size_t o = 0; o < s->option_count; o++)
    if (s->options[o].rival && s->options[o].rival->loose) return &s->options[o];
  return NULL;
}

/* The leading model without the map, of whose sizes it holds the likeliest. */
static fg_evidence_model without_map(const fg_evidence_search *s, const fg_rival *map) {
  fg_evidence_model model = s->models[0];
  size_t kept = 0;
  for (size_t k = 0; k < model.parts; k++)
    if (model.part[k]->rival != map) model.part[kept++] = model.part[k];
  model.parts = kept;
  return model;
}

static void list_sizes(const fg_evidence_search *s, const fg_evidence_option *map, sizes *to) {
  double variance[FG_RIVAL_COLUMNS];
  to->count = 0;
  to->columns = map->each;
  for (size_t l = 0; l < LENGTHS_MAX && map->rival->variances(s->problem.edge_fit, l, variance);
       l++)
    for (int a = 0; a < FG_EVIDENCE_AMPLITUDES; a++, to->count++)
      for (size_t c = 0; c < map->each; c++)
        to->variance[to->count][c] =
            pow(fg_evidence_amplitude_um(&s->request.prior, a), 2) * variance[c];
}

static fg_status weigh_sizes(fg_context *ctx, fg_evidence_search *s, const fg_evidence_model *model,
                             size_t first, sizes *to) {
  size_t n = to->columns;
  fg_evidence_factor factor;
  double *gram = NULL, top = -INFINITY, total = 0;
  fg_status status = FG_OK;
  FG_TRY(fg_evidence_factor_open(ctx, &s->problem, &s->scatter, model, &factor));
  FG_TRY_EXIT(fg_memory_allocate(ctx, 2 * n * (n + 1), sizeof *gram, (void **)&gram));
  double *right = gram + n * n, *work = right + n;
  FG_TRY_EXIT(fg_evidence_gram_beside(ctx, &s->problem, &factor, first, n, gram, right));
  for (size_t i = 0; i < to->count; i++) {
    to->weight[i] = fg_evidence_of(n, gram, right, to->variance[i], work);
    top = fmax(top, to->weight[i]);
  }
  for (size_t i = 0; i < to->count; i++)
    total += to->weight[i] = exp(to->weight[i] - top);
  for (size_t i = 0; i < to->count; i++)
    to->weight[i] = to->weight[i] < WEIGHT_MIN ? 0 : to->weight[i] / total;
exit:
  free(gram);
  fg_evidence_factor_close(&factor);
  return status;
}

static fg_status add_sizes(fg_context *ctx, fg_evidence_search *s, const fg_evidence_model *base,
                           const fg_evidence_option *map, const sizes *of,
                           fg_evidence_shift *shift) {
  fg_evidence_model model = *base;
  fg_evidence_part part = {.rival = map->rival, .first = map->first, .count = map->each};
  model.part[model.parts++] = &part;
  for (size_t i = 0; i < of->count; i++) {
    if (!(of->weight[i] > 0)) continue;
    memcpy(part.variance, of->variance[i], sizeof part.variance);
    FG_TRY(fg_evidence_shift_add(ctx, s, &model, of->weight[i], shift));
  }
  return FG_OK;
}

fg_status fg_evidence_find_unseen(fg_context *ctx, fg_evidence_search *s,
                                  fg_displacement_part *parts) {
  const fg_evidence_option *map = find_map(s);
  fg_evidence_shift shift, own;
  sizes *of = NULL;
  fg_status status = FG_OK;
  if (!map) return FG_OK;
  const fg_evidence_model base = without_map(s, map->rival);
  if (base.parts == FG_EVIDENCE_PARTS) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *of, (void **)&of));
  own = shift = (fg_evidence_shift){.count = 0};
  list_sizes(s, map, of);
  FG_TRY_EXIT(weigh_sizes(ctx, s, &base, map->first, of));
  FG_TRY_EXIT(fg_evidence_shift_open(ctx, s, &shift));
  FG_TRY_EXIT(fg_evidence_shift_open(ctx, s, &own));
  FG_TRY_EXIT(add_sizes(ctx, s, &base, map, of, &shift));
  FG_TRY_EXIT(fg_evidence_shift_add(ctx, s, &s->models[0], 1, &own));
  fg_evidence_shift_spread(s->problem.edge_fit, &shift, &own, parts);
exit:
  free(of);
  fg_evidence_shift_close(&own);
  fg_evidence_shift_close(&shift);
  return status;
}
