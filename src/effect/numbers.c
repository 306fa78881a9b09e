/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The numbers of an effect as reports name them. */
#include <math.h>

#include "effect/set.h"

typedef struct number {
  const char *name;
  double value, u;
} number;

static size_t leading(const fg_effect_found *effect) {
  return effect->kind->numbers == FG_EFFECT_LED ? 1 : effect->columns;
}

double fg_effect_found_amplitude(const fg_effect_found *effect) {
  double square = 0;
  for (size_t c = 0; c < leading(effect); c++)
    square += effect->coefficient_um[c] * effect->coefficient_um[c];
  return effect->columns == 1 ? effect->coefficient_um[0] : sqrt(square);
}

bool fg_effect_found_exceeds(const fg_effect_found *effect, double sigmas) {
  for (size_t c = 0; c < effect->columns; c++)
    if (!(fabs(effect->coefficient_um[c]) < sigmas * effect->u_coefficient_um[c])) return true;
  return false;
}

double fg_effect_found_u(const fg_effect_found *effect) {
  double a = fabs(fg_effect_found_amplitude(effect)), sum = 0;
  if (effect->columns == 1) return effect->u_coefficient_um[0];
  for (size_t c = 0; c < leading(effect) && a > 0; c++) {
    double part = effect->coefficient_um[c] / a * effect->u_coefficient_um[c];
    sum += part * part;
  }
  return sqrt(sum);
}

/* Sine and cosine columns as amplitude and phase. */
static number wave_number(const fg_effect_found *effect, size_t i) {
  double s = effect->coefficient_um[0], c = effect->coefficient_um[1], a = hypot(s, c);
  double us = effect->u_coefficient_um[0], uc = effect->u_coefficient_um[1];
  if (i == 0) return (number){"amplitude_um", a, a > 0 ? hypot(s * us, c * uc) / a : hypot(us, uc)};
  if (i == 1) return (number){effect->kind->shape_name[0], effect->shape[0], effect->u_shape[0]};
  if (i > effect->shapes + 1) return (number){0};
  if (i > 2)
    return (number){effect->kind->shape_name[i - 2], effect->shape[i - 2], effect->u_shape[i - 2]};
  return (number){"phase_deg", atan2(c, s) * 180 / M_PI,
                  a > 0 ? hypot(s * uc, c * us) / (a * a) * 180 / M_PI : NAN};
}

/* Of a cosine and a sine of n times the angle. */
static number oval_phase(const fg_effect_found *effect) {
  const double *c = effect->coefficient_um, *u = effect->u_coefficient_um;
  double square = c[0] * c[0] + c[1] * c[1], n = effect->kind->lobes ? effect->kind->lobes : 2;
  return (number){"phase_deg", atan2(c[1], c[0]) / n * 180 / M_PI,
                  hypot(c[1] * u[0], c[0] * u[1]) / square / n * 180 / M_PI};
}

static number number_of(const fg_effect_found *effect, size_t i) {
  const fg_effect *kind = effect->kind;
  switch (kind->numbers) {
  case FG_EFFECT_SHAPE:
    return (number){0};
  case FG_EFFECT_WAVE:
    return wave_number(effect, i);
  case FG_EFFECT_RATIO:
    if (i == 0)
      return (number){"value", effect->coefficient_um[0] / 1000 / FG_FIELD_HALF_MM,
                      effect->u_coefficient_um[0] / 1000 / FG_FIELD_HALF_MM};
    break;
  case FG_EFFECT_OVAL:
    if (i == 1) return oval_phase(effect);
    if (i == 2 && kind->lobes) return (number){"lobes", kind->lobes, 0};
    /* fall through */
  case FG_EFFECT_AMPLITUDE:
  case FG_EFFECT_LED:
    if (i == 0)
      return (number){kind->amplitude_name ? kind->amplitude_name : "amplitude_um",
                      fg_effect_found_amplitude(effect), fg_effect_found_u(effect)};
    break;
  }
  if (i > kind->shapes) return (number){0};
  return (number){kind->shape_name[i - 1], effect->shape[i - 1], effect->u_shape[i - 1]};
}

bool fg_effect_found_number(const fg_effect_found *effect, size_t i, const char **name,
                            double *value, double *u) {
  number n = number_of(effect, i);
  *name = n.name;
  *value = n.value;
  *u = n.u;
  return n.name != NULL;
}
