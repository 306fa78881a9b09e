/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The candidates of a search, and sets of them as bits. */
#include <math.h>

#include "effect_search/state.h"

bool fg_search_seeks(const fg_search *s, const fg_effect *kind) {
  for (size_t i = 0; i < s->out->barred.count; i++)
    if (fg_effect_same(s->out->barred.each[i].effect, kind)) return false;
  return !kind->by_evidence && fg_effect_shows(s->columns.edge_fit, kind);
}

void fg_search_add(fg_search *s, const fg_candidate *effect) {
  fg_explanations *out = s->out;
  size_t e = out->candidate_count++, first;
  fg_candidate *to = &out->candidates[e];
  *to = *effect;
  to->shapes = effect->kind->shapes;
  to->columns = to->terms =
      fg_search_columns_add(&s->columns, effect->kind, effect->shape, &first, &out->share[e]);
  for (size_t c = 0; c < to->columns; c++)
    to->column[c] = first + c;
}

const fg_effect_found *fg_search_find_known(const fg_effect_set *known, const fg_effect *kind) {
  for (size_t e = 0; known && e < known->count; e++)
    if (known->effects[e].kind == kind) return &known->effects[e];
  return NULL;
}

size_t fg_search_bits(unsigned mask) {
  size_t n = 0;
  for (; mask; mask &= mask - 1)
    n++;
  return n;
}

unsigned fg_search_mask_of(const fg_explanations *out, bool of_free) {
  unsigned mask = 0;
  for (size_t e = 0; e < out->candidate_count; e++)
    if (fg_effect_is_free(out->candidates[e].kind) == of_free) mask |= 1u << e;
  return mask;
}

static bool are_collinear(const fg_candidate *a, const fg_candidate *b) {
  if (!fg_effect_same(a->kind, b->kind)) return false;
  if (b->kind->sought == FG_EFFECT_SMOOTH) return true;
  return b->kind->second || fabs(a->shape[0] / b->shape[0] - 1) < FG_SEARCH_COLLINEAR_SHARE;
}

bool fg_search_has_collinear(const fg_explanations *out, unsigned mask) {
  for (size_t a = 0; a < out->candidate_count; a++)
    for (size_t b = a + 1; (mask >> a & 1) && b < out->candidate_count; b++)
      if ((mask >> b & 1) && are_collinear(&out->candidates[a], &out->candidates[b])) return true;
  return false;
}

void fg_search_keep(fg_explanations *out, const fg_explanation *explanation) {
  out->total++;
  size_t at = out->count < FG_EXPLANATIONS_MAX ? out->count++ : FG_EXPLANATIONS_MAX;
  double own = fg_search_akaike(explanation);
  if (at == FG_EXPLANATIONS_MAX && own >= fg_search_akaike(&out->each[FG_EXPLANATIONS_MAX - 1]))
    return;
  if (at == FG_EXPLANATIONS_MAX) at--;
  for (; at > 0 && fg_search_akaike(&out->each[at - 1]) > own; at--)
    out->each[at] = out->each[at - 1];
  out->each[at] = *explanation;
}
