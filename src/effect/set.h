/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Effects with numbers. */
#ifndef FG_EFFECT_SET_H
#define FG_EFFECT_SET_H

#include "effect/effect.h"

enum { FG_EFFECT_SET_MAX = 7, FG_EFFECT_COLUMNS_MAX = FG_FIELD_COLUMNS };

/* Effect in the corrected model. Coefficients are linear amplitudes of its columns in um. */
typedef struct fg_effect_found {
  const fg_effect *kind;
  size_t columns, shapes;
  double coefficient_um[FG_EFFECT_COLUMNS_MAX], u_coefficient_um[FG_EFFECT_COLUMNS_MAX];
  double shape[FG_FIELD_SHAPES], u_shape[FG_FIELD_SHAPES];
} fg_effect_found;

/* Effects in force. */
typedef struct fg_effect_set {
  fg_effect_found effects[FG_EFFECT_SET_MAX];
  size_t count;
} fg_effect_set;

/* Makes a field from an effect of the scanner; the set's fields, and the shift of every row by part
 * effects (mm). */
fg_field fg_effect_found_field(const fg_effect_found *effect);
void fg_effect_set_fields(const fg_edge_fit *edge_fit, const fg_effect_set *set,
                          fg_field_list *fields);
fg_status fg_effect_set_shift(fg_context *ctx, const fg_edge_fit *edge_fit,
                              const fg_effect_set *set, double **shift_mm);

/* Returns true where a set holds a scale of both axes, which known radii alone show. */
bool fg_effect_set_scales(const fg_effect_set *set);

/* Size, um: of sine and cosine, of the leading coefficient, or of all columns; its standard
 * uncertainty. */
double fg_effect_found_amplitude(const fg_effect_found *effect);
double fg_effect_found_u(const fg_effect_found *effect);
/* Returns true when one of its coefficients is not less than so many standard uncertainties. */
bool fg_effect_found_exceeds(const fg_effect_found *effect, double sigmas);

/* Reads name and value of parameter i for reports (amplitudes in um, scale and shear as ratios);
 * false when there are no more. A curve has none. */
bool fg_effect_found_number(const fg_effect_found *effect, size_t i, const char **name,
                            double *value, double *u);

#endif
