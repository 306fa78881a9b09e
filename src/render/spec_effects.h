/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Effects: deviations of the picture or the part from the declared model. One row each.
 *
 * A scanner effect is a field: true position = nominal position + d(x, y), in mm. A part effect
 * moves the midline in the foil's coordinates, changes the strip's thickness, or changes the table
 * of bumps.
 */
#ifndef FG_RENDER_SPEC_EFFECTS_H
#define FG_RENDER_SPEC_EFFECTS_H

#include <stdbool.h>
#include <stddef.h>

#include "render/curve.h"
#include "render/jumps.h"
#include "render/lift.h"
#include "render/members.h"

enum { FG_RENDER_EFFECT_PARAMETERS_MAX = 5, FG_RENDER_EFFECTS_MAX = 16 };

typedef enum fg_render_effect_target {
  FG_RENDER_EFFECT_SCANNER, /* field(p, x_mm, y_mm, d) adds to d */
  FG_RENDER_EFFECT_STEP, /* field(...) as for the scanner, but a jump at p[1] of the row's axis, and
                            with `repeats` at every p[2] from there: it comes after the optics, so
                            it is sharp in the picture and not blurred */
  FG_RENDER_EFFECT_PART, /* shape(p, psi_rad, ·): radial shift about O in mm, outwards positive; psi
                     is counted from the foil's middle, towards the free end */
  FG_RENDER_EFFECT_NORMAL, /* shift along the midline's normal: a part effect with member `along` */
  FG_RENDER_EFFECT_WIDTH,  /* change of half the strip's thickness, mm */
  FG_RENDER_EFFECT_BUMP,  /* shape(p, u, ·): shift in mm away from the bump's centre; u is -1 and 1
                      where the arc meets its fillets */
  FG_RENDER_EFFECT_LIFT,  /* of single bumps: lift.h */
  FG_RENDER_EFFECT_EDGE,  /* curve over the direction of the strip's inner side in the scan, degrees
                           */
  FG_RENDER_EFFECT_TABLE, /* shape(p, index, count): factor on the bump's radius; index from 1 */
  FG_RENDER_EFFECT_STRETCH, /* shape(p, R - R_D in mm, ·): factor on the bump's arc length R alpha
                             */
} fg_render_effect_target;

typedef struct fg_render_effect_parameter {
  const char *name;
  double fallback; /* default; NaN: required; +inf: the middle of the picture along the row's axis,
                      mm; -inf: in y */
  double low, high;
} fg_render_effect_parameter;

typedef struct fg_render_effect_row {
  const char *id;
  fg_render_effect_target target;
  fg_render_effect_parameter parameters[FG_RENDER_EFFECT_PARAMETERS_MAX];
  void (*field)(const double *p, double x_mm, double y_mm, double d_mm[2]);
  double (*shape)(const double *p, double coordinate, double extent);
  int axis;                   /* 0 x, 1 y: axis of a fallback of +inf, or of a curve's coordinate */
  const fg_curve_axis *curve; /* NULL: none. With one, it replaces field or shape */
  bool repeats;               /* of a step */
} fg_render_effect_row;

typedef struct fg_render_effect {
  const fg_render_effect_row *row;
  fg_render_effect_target target; /* the row's, or FG_RENDER_EFFECT_NORMAL */
  double p[FG_RENDER_EFFECT_PARAMETERS_MAX];
  fg_curve curve;
  fg_lift lift; /* FG_RENDER_EFFECT_LIFT */
  int moves;    /* FG_RENDER_EFFECT_SCANNER with a curve: the axis of the displacement, 0 x, 1 y */
  bool apart;   /* FG_RENDER_EFFECT_EDGE: the edges move away from each other, not together */
} fg_render_effect;

typedef struct fg_render_effect_list {
  fg_render_effect effects[FG_RENDER_EFFECTS_MAX];
  size_t count;
  fg_render_jump_list jumps; /* of the scanner's lost rows and seams */
} fg_render_effect_list;

/* Every effect that a spec may name; ends with id NULL. */
const fg_render_effect_row *fg_render_effect_rows(void);

/* spec_effects_parse.c */
fg_status fg_render_effects_parse(const fg_place *place, const cJSON *array,
                                  fg_render_effect_list *list);

/* Fills in parameters that refer to the picture's middle. Defined with all below in
 * spec_effects_apply.c */
void fg_render_effects_resolve(fg_render_effect_list *list, double width_mm, double height_mm);

bool fg_render_effects_have(const fg_render_effect_list *list, fg_render_effect_target target);

/* d(x, y) of all scanner effects. `side_mm` is x, y of the drawn pixel: it decides the side of a
 * jump. */
void fg_render_effects_field(const fg_render_effect_list *list, double x_mm, double y_mm,
                             const double side_mm[2], double d_mm[2]);

/* The first jump along an axis at or above low_mm and below high_mm; NaN without. */
double fg_render_effects_next_step(const fg_render_effect_list *list, int axis, double low_mm,
                                   double high_mm);

/* Sum (factors: product) of the shapes of one target. */
double fg_render_effects_shape(const fg_render_effect_list *list, fg_render_effect_target target,
                               double coordinate, double extent);

/* Value and slope (per u, outwards) of a bump's curves at its end u = -1 or 1. They need not be 0
 * there: the fillets continue and fade them out. */
void fg_render_effects_bump_end(const fg_render_effect_list *list, double u, double *value_mm,
                                double *slope_mm);

/* Returns the height by which a bump is raised, mm: with its flanks, or at its middle alone. */
double fg_render_effects_lift(const fg_render_effect_list *list, int bump, bool whole);

/* Shift of the two edges of a strip whose inner side lies in the direction (nx, ny) of the scan, to
 * that side, mm: [0] the inner edge, [1] the outer. */
void fg_render_effects_edges(const fg_render_effect_list *list, double nx, double ny,
                             double shift_mm[2]);

/* Returns the largest move by a part, width, bump or edge effect, mm. */
double fg_render_effects_reach(const fg_render_effect_list *list);

#endif
