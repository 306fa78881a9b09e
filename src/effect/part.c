/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Effects of the part, one row each: the functions before the rows compute the midline's
 * displacement. */
#include <math.h>

#include "effect/effect.h"
#include "effect/midline.h"

enum { DENT_WIDTHS = 3, DENT_PLACES = 64 };

/* a cos n(psi - psi0): a cosine and a sine. */
static size_t harmonic(const fg_edge_fit_row *row, int n, double share, double *values) {
  values[0] = cos(n * row->psi) * share;
  values[1] = sin(n * row->psi) * share;
  return 2;
}

static size_t ovality(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, const double *shape,
                      double *values) {
  (void)shape;
  (void)edge_fit;
  return harmonic(row, 2, fg_midline_along_normal(row), values);
}

static size_t ovality_radial(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row,
                             const double *shape, double *values) {
  (void)shape;
  (void)edge_fit;
  return harmonic(row, 2, fg_midline_along_radius(row), values);
}

static double cubic_of_psi(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row) {
  double u = row->psi / edge_fit->parts[row->part].half_span_rad;
  return u * u * u;
}

static size_t spiral(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, const double *shape,
                     double *values) {
  (void)shape;
  values[0] = cubic_of_psi(edge_fit, row) * fg_midline_along_normal(row);
  return 1;
}

static size_t spiral_radial(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row,
                            const double *shape, double *values) {
  (void)shape;
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
static size_t crown(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, const double *shape,
                    double *values) {
  (void)shape;
  size_t count = fg_midline_legendre(row, 4, 2, 4, values);
  count += fg_midline_stretch(edge_fit, row, 4, values + count);
  return count + fg_midline_legendre(row, 3, 1, 1, values + count);
}

static size_t skew(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, const double *shape,
                   double *values) {
  (void)shape;
  size_t count = fg_midline_legendre(row, 3, 2, 4, values);
  count += fg_midline_stretch(edge_fit, row, 3, values + count);
  return count + fg_midline_legendre(row, 4, 1, 1, values + count);
}

/* a cos n(psi - psi0), along the normal or along the radius. */
#define LOBES(n)                                                                                   \
  static size_t lobes_##n(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row,                 \
                          const double *shape, double *values) {                                   \
    (void)edge_fit, (void)shape;                                                                   \
    return harmonic(row, n, fg_midline_along_normal(row), values);                                 \
  }                                                                                                \
  static size_t lobes_##n##_radial(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row,        \
                                   const double *shape, double *values) {                          \
    (void)edge_fit, (void)shape;                                                                   \
    return harmonic(row, n, fg_midline_along_radius(row), values);                                 \
  }
LOBES(3)
LOBES(4)
LOBES(5)

#define DEGREE (M_PI / 180)

/* A bell over the direction from O: its place and its standard deviation, degrees. */
static size_t dent(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, const double *shape,
                   double *values) {
  (void)edge_fit;
  double u = (row->psi / DEGREE - shape[0]) / shape[1];
  values[0] = exp(-0.5 * u * u) * fg_midline_along_normal(row);
  return 1;
}

/* Places evenly over the foil, for each of some widths. */
static void dent_grid(const fg_edge_fit *edge_fit, size_t i, size_t count, double *shape,
                      double *reach) {
  static const double widths[DENT_WIDTHS] = {0.7, 1.6, 3.6};
  double places = (double)count / DENT_WIDTHS, low = edge_fit->psi_rad[0] / DEGREE;
  double step = (edge_fit->psi_rad[1] / DEGREE - low) / places;
  shape[0] = low + step * ((double)(i / DENT_WIDTHS) + 0.5);
  shape[1] = widths[i % DENT_WIDTHS];
  reach[0] = step;
  reach[1] = 0.5 * shape[1];
}

/* One number of lobes, along the normal or along the radius. */
#define LOBES_ROW(n, along, is_second, function, same)                                             \
  {                                                                                                \
    .id = "part.lobes", .direction = along, .second = is_second, .words = "a foil with lobes",     \
    .equation = "a cos n(ψ − ψ0), n = 3 to 5", .coordinate = FG_EFFECT_FOIL,                       \
    .numbers = FG_EFFECT_OVAL, .by_evidence = true, .midline = function, .lobes = n,               \
    .size_from = "0.1 % of R0; assumed", .size_um = {                                              \
      20                                                                                           \
    }                                                                                              \
  }

const fg_effect fg_effects_part[] = {
    {.id = "part.ovality",
     .direction = "normal",
     .rival = "foil.ring of one harmonic",
     .words = "an oval foil",
     .equation = "a cos 2(ψ − ψ0)",
     .size_um = {20},
     .size_from = "0.1 % of R0; assumed",
     .coordinate = FG_EFFECT_FOIL,
     .numbers = FG_EFFECT_OVAL,
     .on_discs = FG_EFFECT_ON_ONE_DISC,
     .midline = ovality,
     .ring = FG_EFFECT_RING_OF_PART},
    {.id = "part.ovality",
     .direction = "radial",
     .rival = "foil.ring of one harmonic, radial",
     .second = true,
     .words = "an oval foil",
     .equation = "a cos 2(ψ − ψ0)",
     .size_um = {20},
     .size_from = "0.1 % of R0; assumed",
     .coordinate = FG_EFFECT_FOIL,
     .numbers = FG_EFFECT_OVAL,
     .midline = ovality_radial},
    {.id = "part.spiral",
     .direction = "normal",
     .words = "a spiral foil",
     .equation = "a (ψ/ψ_end)³",
     .size_um = {20},
     .size_from = "0.1 % of R0; assumed",
     .coordinate = FG_EFFECT_FOIL,
     .midline = spiral},
    {.id = "part.spiral",
     .direction = "radial",
     .second = true,
     .words = "a spiral foil",
     .equation = "a (ψ/ψ_end)³",
     .size_um = {20},
     .size_from = "0.1 % of R0; assumed",
     .coordinate = FG_EFFECT_FOIL,
     .midline = spiral_radial},
    LOBES_ROW(3, "normal", false, lobes_3, "foil.ring of one harmonic"),
    LOBES_ROW(3, "radial", true, lobes_3_radial, "foil.ring of one harmonic, radial"),
    LOBES_ROW(4, "normal", true, lobes_4, "foil.ring of one harmonic"),
    LOBES_ROW(4, "radial", true, lobes_4_radial, "foil.ring of one harmonic, radial"),
    LOBES_ROW(5, "normal", true, lobes_5, "foil.ring of one harmonic"),
    LOBES_ROW(5, "radial", true, lobes_5_radial, "foil.ring of one harmonic, radial"),
    {.id = "part.dent",
     .words = "a dent at one place of the foil",
     .says = {"it stands out", "it lies deeper"},
     .equation = "a exp(−(ψ − ψ0)²/(2 w²))",
     .sought = FG_EFFECT_PLACED,
     .coordinate = FG_EFFECT_FOIL,
     .by_evidence = true,
     .midline = dent,
     .shapes = 2,
     .shape_name = {"place_deg", "width_deg"},
     .shape_symbol = {"ψ0", "w"},
     .shape_is = {FG_EFFECT_PLACE, FG_EFFECT_LENGTH},
     .grid = dent_grid,
     .starts = DENT_WIDTHS * DENT_PLACES,
     .size_um = {15},
     .size_from = "as of a lost row; assumed"},
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
     .bends = true,
     .size_um = {5, 2, 1, 0.5, 3, 1, 0.5},
     .size_from = "0.15 % of R, higher terms ever less; assumed"},
    {.id = "part.bump_skew",
     .words = "bumps that lean to one side",
     .equation = "odd in the place in the arc, led by a P3",
     .coordinate = FG_EFFECT_PHI,
     .numbers = FG_EFFECT_LED,
     .midline = skew,
     .bends = true,
     .size_um = {5, 2, 1, 0.5, 3, 1, 0.5},
     .size_from = "0.15 % of R, higher terms ever less; assumed"},
    {.id = NULL},
};
