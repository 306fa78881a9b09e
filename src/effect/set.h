/* Effects with numbers. */
#ifndef FG_EFFECT_SET_H
#define FG_EFFECT_SET_H

#include "effect/effect.h"

enum { FG_SCAN_EFFECTS = 7, FG_SCAN_COLUMNS = FG_FIELD_COLUMNS };

/* One effect that is in the corrected model. Coefficients are linear amplitudes in um of its
 * columns. */
typedef struct fg_scan_effect {
  const fg_effect *kind;
  size_t columns, shapes;
  double coefficient_um[FG_SCAN_COLUMNS], u_coefficient_um[FG_SCAN_COLUMNS];
  double shape[FG_FIELD_SHAPES], u_shape[FG_FIELD_SHAPES];
} fg_scan_effect;

/* Effects in force. */
typedef struct fg_scan_set {
  fg_scan_effect effects[FG_SCAN_EFFECTS];
  size_t count;
} fg_scan_set;

/* An effect of the scanner as a field; the set's fields, and the shift of every row by part effects
 * (mm). */
fg_field fg_scan_field(const fg_scan_effect *effect);
void fg_scan_fields(const fg_points *points, const fg_scan_set *set, fg_field_list *fields);
fg_status fg_scan_shift(fg_context *ctx, const fg_points *points, const fg_scan_set *set,
                        double **shift_mm);

/* Size, um: of its sine and cosine, of what leads it, of all columns; its standard uncertainty. */
double fg_scan_effect_amplitude(const fg_scan_effect *effect);
double fg_scan_effect_u(const fg_scan_effect *effect);

/* What its numbers are called in a report: name and value of parameter i (amplitudes in um, scale
 * and shear as ratios); false when there are no more. A curve has none. */
bool fg_scan_effect_number(const fg_scan_effect *effect, size_t i, const char **name, double *value,
                           double *u);

#endif
