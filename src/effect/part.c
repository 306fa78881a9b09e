/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Effects of the part, one row each: the functions before the rows compute the midline's
 * displacement. */
#include <math.h>

#include "effect/effect.h"
#include "effect/midline.h"

/* a cos 2(psi - psi0): a cosine and a sine. */
static size_t cosines(const fg_edge_fit_row *row, double share, double *values) {
  values[0] = cos(2 * row->psi) * share;
  values[1] = sin(2 * row->psi) * share;
  return 2;
}

static size_t ovality(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, double *values) {
  (void)edge_fit;
  return cosines(row, fg_midline_along_normal(row), values);
}

static size_t ovality_radial(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row,
                             double *values) {
  (void)edge_fit;
  return cosines(row, fg_midline_along_radius(row), values);
}

static double cubic_of_psi(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row) {
  double u = row->psi / edge_fit->parts[row->part].half_span_rad;
  return u * u * u;
}

static size_t spiral(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, double *values) {
  values[0] = cubic_of_psi(edge_fit, row) * fg_midline_along_normal(row);
  return 1;
}

static size_t spiral_radial(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row,
                            double *values) {
  values[0] = cubic_of_psi(edge_fit, row) * fg_midline_along_radius(row);
  return 1;
}

/* Half of it to either edge; from one end of the foil to the other. */
static double thickness_taper(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row) {
  double span = edge_fit->parts[row->part].end_to_end_rad;
  return span > 0 ? 0.5 * row->psi / span : 0;
}

/* A deviation shifts the arc's centre and with it the zero of the angle. So an even deviation has a
 * component of its slope, of which the circle leaves P3, and an odd one a component of P4. */
static size_t crown(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, double *values) {
  size_t count = fg_midline_legendre(row, 4, 2, 4, values);
  count += fg_midline_stretch(edge_fit, row, 4, values + count);
  return count + fg_midline_legendre(row, 3, 1, 1, values + count);
}

static size_t skew(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, double *values) {
  size_t count = fg_midline_legendre(row, 3, 2, 4, values);
  count += fg_midline_stretch(edge_fit, row, 3, values + count);
  return count + fg_midline_legendre(row, 4, 1, 1, values + count);
}

const fg_effect fg_effects_part[] = {
    {.id = "part.ovality",
     .direction = "normal",
     .words = "an oval foil",
     .equation = "a cos 2(ψ − ψ0)",
     .coordinate = FG_EFFECT_FOIL,
     .numbers = FG_EFFECT_OVAL,
     .on_discs = FG_EFFECT_ON_ONE_DISC,
     .midline = ovality,
     .ring = FG_EFFECT_RING_OF_PART},
    {.id = "part.ovality",
     .direction = "radial",
     .second = true,
     .words = "an oval foil",
     .equation = "a cos 2(ψ − ψ0)",
     .coordinate = FG_EFFECT_FOIL,
     .numbers = FG_EFFECT_OVAL,
     .midline = ovality_radial},
    {.id = "part.spiral",
     .direction = "normal",
     .words = "a spiral foil",
     .equation = "a (ψ/ψ_end)³",
     .coordinate = FG_EFFECT_FOIL,
     .midline = spiral},
    {.id = "part.spiral",
     .direction = "radial",
     .second = true,
     .words = "a spiral foil",
     .equation = "a (ψ/ψ_end)³",
     .coordinate = FG_EFFECT_FOIL,
     .midline = spiral_radial},
    {.id = "part.thickness_taper",
     .words = "a strip whose thickness changes along the foil",
     .says = {"the strip is thicker towards the free end",
              "the strip is thinner towards the free end"},
     .equation = "t = t0 + Δt ψ/ψ_span, from the lip's end to the free end",
     .sought = FG_EFFECT_OF_WIDTH,
     .coordinate = FG_EFFECT_FOIL,
     .amplitude_name = "thickness_change_um",
     .amplitude_symbol = "Δt",
     .width = thickness_taper},
    {.id = "part.bump_crown",
     .words = "bumps flatter or sharper at the crown than a circle",
     .equation = "even in the place in the arc, led by a P4",
     .coordinate = FG_EFFECT_PHI,
     .numbers = FG_EFFECT_LED,
     .midline = crown,
     .bends = true},
    {.id = "part.bump_skew",
     .words = "bumps that lean to one side",
     .equation = "odd in the place in the arc, led by a P3",
     .coordinate = FG_EFFECT_PHI,
     .numbers = FG_EFFECT_LED,
     .midline = skew,
     .bends = true},
    {.id = NULL},
};
