/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Limits that the user sets, in real units: "temperature_C <= 700", "2*a + b >= 3". */
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "process/experiment_parts.h"

/* weight[k] of every factor of the surface and the limit, as "sum <= limit". */
typedef struct line {
  double weight[FG_SURFACE_FACTORS], limit;
  const fg_experiment *experiment;
  const char *text, *at;
} line;

static fg_status fail_at(fg_context *ctx, const line *l, const char *what) {
  return fg_fail(ctx, FG_ERR_USAGE,
                 "constraint '%s', character %zu: %s; write it like 'temperature_C <= 700' or "
                 "'2*a + b >= 3'",
                 l->text, (size_t)(l->at - l->text) + 1, what);
}

static void skip_space(line *l) {
  while (isspace((unsigned char)*l->at))
    l->at++;
}

static bool is_name_byte(char c) {
  return isalnum((unsigned char)c) || c == '_' || c == '.' || (unsigned char)c >= 0x80;
}

static const fg_factor *surface_factor(const fg_experiment *e, size_t k) {
  for (size_t f = 0; f < e->factors; f++)
    if (e->factor[f].variable == e->surface.variable[k]) return &e->factor[f];
  return NULL;
}

static fg_status read_name(fg_context *ctx, line *l, double weight) {
  const char *start = l->at, *end;
  bool quoted = *start == '`';
  start += quoted;
  for (end = start; quoted ? *end && *end != '`' : is_name_byte(*end); end++)
    ;
  size_t length = (size_t)(end - start);
  if (length == 0) return fail_at(ctx, l, "the name of a factor is missing");
  for (size_t k = 0; k < l->experiment->surface.factors; k++) {
    const fg_factor *factor = surface_factor(l->experiment, k);
    if (!factor || strlen(factor->name) != length || memcmp(factor->name, start, length) != 0)
      continue;
    l->weight[k] += weight;
    l->at = end + (quoted && *end == '`');
    return FG_OK;
  }
  return fail_at(ctx, l, "this is no numeric factor of the model");
}

/* [sign] [number *] name */
static fg_status read_term(fg_context *ctx, line *l, bool first) {
  double weight = 1;
  skip_space(l);
  if (*l->at == '+' || *l->at == '-')
    weight = *l->at++ == '-' ? -1 : 1;
  else if (!first)
    return fail_at(ctx, l, "'+', '-', '<=' or '>=' is expected");
  skip_space(l);
  if (isdigit((unsigned char)*l->at) || *l->at == '.') {
    char *end;
    weight *= strtod(l->at, &end);
    l->at = end;
    skip_space(l);
    if (*l->at != '*') return fail_at(ctx, l, "'*' and the name of a factor are expected");
    l->at++;
    skip_space(l);
  }
  FG_TRY(read_name(ctx, l, weight));
  skip_space(l);
  return FG_OK;
}

static fg_status read_line(fg_context *ctx, line *l) {
  bool first = true;
  do {
    FG_TRY(read_term(ctx, l, first));
    first = false;
  } while (*l->at && *l->at != '<' && *l->at != '>');
  if (!*l->at || l->at[1] != '=') return fail_at(ctx, l, "'<=' or '>=' is expected");
  double sign = *l->at == '<' ? 1 : -1;
  char *end;
  l->at += 2;
  l->limit = sign * strtod(l->at, &end);
  if (end == l->at || !isfinite(l->limit)) return fail_at(ctx, l, "a number is expected");
  l->at = end;
  skip_space(l);
  if (*l->at) return fail_at(ctx, l, "nothing may follow the number");
  for (size_t k = 0; k < l->experiment->surface.factors; k++)
    l->weight[k] *= sign;
  return FG_OK;
}

fg_status fg_experiment_constrain(fg_context *ctx, const fg_experiment *e, const char *text,
                                  fg_region *region) {
  line l = {.experiment = e, .text = text, .at = text};
  if (region->planes == FG_REGION_PLANES)
    return fg_fail(ctx, FG_ERR_USAGE, "more than %d constraints", FG_REGION_PLANES);
  FG_TRY(read_line(ctx, &l));
  /* real = offset + half x, so sum w real <= limit becomes sum (w half) x <= limit - sum w offset.
   */
  for (size_t k = 0; k < e->surface.factors; k++) {
    const fg_factor *factor = surface_factor(e, k);
    double offset = fg_factor_real(factor, 0), half = fg_factor_real(factor, 1) - offset;
    region->normal[region->planes][k] = l.weight[k] * half;
    l.limit -= l.weight[k] * offset;
  }
  region->limit[region->planes++] = l.limit;
  return FG_OK;
}
