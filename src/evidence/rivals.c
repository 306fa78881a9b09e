/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/rivals.h"

#include <math.h>
#include <string.h>

#include "effect/midline.h"
#include "evidence/glass_fields.h"
#include "evidence/line.h"

/* Harmonics of a ring, from 2 on; of the edge's direction; polynomials of a bump, from 3 on. */
enum {
  RING_LAST = 9,
  DIRECTION_LAST = 9,
  DISCS_MAX = 8,
  BUMP_FIRST = 3,
  BUMP_ORDERS = 8,
  PHI_ORDERS = 20,
  LAND_FIRST = 1, /* of lands: their mean place is that of the bumps */
  LAND_ORDERS = 12,
  PERIOD_FIRST = 2, /* of patterns over the bumps' numbers */
  PERIOD_LAST = 4
};

static fg_line line_of_foil(const fg_edge_fit *edge_fit) {
  double radius = edge_fit->parts[0].overall_radius_mm;
  return fg_line_over(edge_fit->psi_rad[0] * radius, edge_fit->psi_rad[1] * radius);
}

size_t fg_rival_columns(const fg_rival *rival, const fg_edge_fit *edge_fit,
                        const fg_edge_fit_row *row, double *values) {
  fg_point at[FG_EDGE_FIT_PLACES], d[FG_RIVAL_COLUMNS];
  size_t count = 0;
  if (rival->columns) return rival->columns(edge_fit, row, values);
  fg_edge_fit_places(row, row->ideal, at);
  for (int k = 0; k < FG_EDGE_FIT_PLACES; k++) {
    count = rival->glass(&edge_fit->frame, at[k], d);
    for (size_t c = 0; c < count; c++)
      values[c] = (k ? values[c] : 0) -
                  (d[c].x * row->normal.x + d[c].y * row->normal.y) / FG_EDGE_FIT_PLACES;
  }
  return count;
}

/* ---- of the part ---- */

static size_t along_foil(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, double share,
                         double *values) {
  const fg_line l = line_of_foil(edge_fit);
  fg_line_fill(&l, row->psi * edge_fit->parts[0].overall_radius_mm, values);
  for (size_t c = 0; c < FG_LINE_COLUMNS; c++)
    values[c] *= share;
  return FG_LINE_COLUMNS;
}

static size_t over_foil(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, double *values) {
  return along_foil(edge_fit, row, fg_midline_along_normal(row), values);
}

static size_t over_foil_radial(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row,
                               double *values) {
  return along_foil(edge_fit, row, fg_midline_along_radius(row), values);
}

static bool foil_variances(const fg_edge_fit *edge_fit, size_t i, double *variance) {
  const fg_line l = line_of_foil(edge_fit);
  return fg_line_variances(&l, 1.5, i, variance);
}

static size_t harmonics(double angle, int last, double size, double *values) {
  size_t count = 0;
  for (int k = 2; k <= last; k++) {
    values[count++] = size * cos(k * angle);
    values[count++] = size * sin(k * angle);
  }
  return count;
}

static size_t on_ring(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, double *values) {
  (void)edge_fit;
  return harmonics(row->psi, RING_LAST, fg_midline_along_normal(row), values);
}

static size_t on_ring_radial(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row,
                             double *values) {
  (void)edge_fit;
  return harmonics(row->psi, RING_LAST, fg_midline_along_radius(row), values);
}

static size_t over_direction(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row,
                             double *values) {
  (void)edge_fit;
  return harmonics(row->normal_rad, DIRECTION_LAST, 1, values);
}

static void fill_falling(int first, int last, int each, double power, double *variance) {
  for (int k = first; k <= last; k++)
    for (int e = 0; e < each; e++)
      *variance++ = pow((double)first / k, power);
}

static bool ring_variances(const fg_edge_fit *edge_fit, size_t i, double *variance) {
  (void)edge_fit;
  if (i >= 4) return false;
  fill_falling(2, RING_LAST, 2, 2 * (double)i, variance);
  return true;
}

static bool direction_variances(const fg_edge_fit *edge_fit, size_t i, double *variance) {
  (void)edge_fit;
  if (i >= 2) return false;
  fill_falling(2, DIRECTION_LAST, 2, i ? 3 : 1, variance);
  return true;
}

static size_t over_phi(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, double *values) {
  (void)edge_fit;
  return fg_midline_legendre(row, BUMP_FIRST, 1, PHI_ORDERS, values);
}

static bool phi_variances(const fg_edge_fit *edge_fit, size_t i, double *variance) {
  (void)edge_fit;
  if (i >= 3) return false;
  fill_falling(BUMP_FIRST, BUMP_FIRST + PHI_ORDERS - 1, 1, 1 + 2 * (double)i, variance);
  return true;
}

/* ---- of single discs ---- */

/* Of few discs alone: where many are, a cause of the scanner shows on too many of them to be the
 * form of one. */
static size_t numbers_of_disc(const fg_edge_fit *edge_fit) {
  return edge_fit->discs && edge_fit->part_count <= DISCS_MAX ? 2 * (DIRECTION_LAST - 1) : 0;
}

/* Harmonics from the oval on: the lower ones are the disc's radius and place. */
static size_t over_disc(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, double *values) {
  size_t each = numbers_of_disc(edge_fit), count = each * edge_fit->part_count;
  memset(values, 0, count * sizeof *values);
  if (each) harmonics(M_PI * row->phi, DIRECTION_LAST, 1, values + each * row->part);
  return count;
}

static bool disc_variances(const fg_edge_fit *edge_fit, size_t i, double *variance) {
  if (i >= 3 || !numbers_of_disc(edge_fit)) return false;
  fill_falling(2, DIRECTION_LAST, 2, 1 + 2 * (double)i, variance);
  return true;
}

/* ---- of the lands, alike on all ---- */

static size_t over_lands(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, double *values) {
  fg_edge_fit_row as_bump = *row;
  (void)edge_fit;
  as_bump.bump = !row->bump;
  return fg_midline_legendre(&as_bump, LAND_FIRST, 1, LAND_ORDERS, values);
}

static bool land_variances(const fg_edge_fit *edge_fit, size_t i, double *variance) {
  (void)edge_fit;
  if (i >= 3) return false;
  fill_falling(LAND_FIRST, LAND_FIRST + LAND_ORDERS - 1, 1, 1 + 2 * (double)i, variance);
  return true;
}

/* ---- of single bumps ---- */

static size_t count_bumps(const fg_edge_fit *edge_fit) {
  size_t count = 0;
  for (size_t p = 0; p < edge_fit->part_count; p++)
    count += edge_fit->parts[p].bump_count;
  return count;
}

static size_t bump_index_of(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row) {
  size_t first = 0;
  for (size_t p = 0; p < row->part; p++)
    first += edge_fit->parts[p].bump_count;
  return first + row->bump_index;
}

static size_t orders_of_bump(const fg_edge_fit *edge_fit) {
  size_t count = count_bumps(edge_fit), fit = count ? FG_RIVAL_COLUMNS / count : 0;
  return fit < BUMP_ORDERS ? fit : BUMP_ORDERS;
}

static size_t over_each(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, double *values) {
  size_t orders = orders_of_bump(edge_fit), count = orders * count_bumps(edge_fit);
  memset(values, 0, count * sizeof *values);
  if (row->bump)
    fg_midline_legendre(row, BUMP_FIRST, 1, (int)orders,
                        values + orders * bump_index_of(edge_fit, row));
  return count;
}

static bool fill_each(const fg_edge_fit *edge_fit, size_t bumps, size_t i, double *variance) {
  static const double powers[] = {0, 1, 3};
  size_t orders = orders_of_bump(edge_fit);
  if (i >= 3 || !orders) return false;
  for (size_t b = 0; b < bumps; b++)
    fill_falling(BUMP_FIRST, BUMP_FIRST + (int)orders - 1, 1, powers[i], variance + b * orders);
  return true;
}

static bool each_variances(const fg_edge_fit *edge_fit, size_t i, double *variance) {
  return fill_each(edge_fit, count_bumps(edge_fit), i, variance);
}

static bool one_variances(const fg_edge_fit *edge_fit, size_t i, double *variance) {
  return fill_each(edge_fit, 1, i, variance);
}

/* Every second, third or fourth bump alike: of every period all phases but one of the first. */
static size_t over_pattern(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row,
                           double *values) {
  size_t count = 0;
  (void)edge_fit;
  for (int period = PERIOD_FIRST; period <= PERIOD_LAST; period++)
    for (int phase = period == PERIOD_FIRST; phase < period; phase++, count += BUMP_ORDERS) {
      memset(values + count, 0, BUMP_ORDERS * sizeof *values);
      if (row->bump && row->bump % period == phase)
        fg_midline_legendre(row, BUMP_FIRST, 1, BUMP_ORDERS, values + count);
    }
  return count;
}

static size_t orders_of_pattern(const fg_edge_fit *edge_fit) {
  (void)edge_fit;
  return BUMP_ORDERS;
}

static bool pattern_variances(const fg_edge_fit *edge_fit, size_t i, double *variance) {
  static const double powers[] = {0, 1, 3};
  (void)edge_fit;
  if (i >= 3) return false;
  fill_falling(BUMP_FIRST, BUMP_FIRST + BUMP_ORDERS - 1, 1, powers[i], variance);
  return true;
}

/* ---- one part of a rival alone ---- */

static bool alike_variances(const fg_edge_fit *edge_fit, size_t i, double *variance) {
  (void)edge_fit;
  variance[0] = variance[1] = 1;
  return i == 0;
}

static size_t two_columns(const fg_edge_fit *edge_fit) {
  (void)edge_fit;
  return 2;
}

/* All discs oval in one way, or with lobes: on foils that is a harmonic of the ring. */
static size_t two_columns_of_discs(const fg_edge_fit *edge_fit) {
  return edge_fit->discs ? 2 : 0;
}

bool fg_rival_shows(const fg_rival *rival, const fg_edge_fit *edge_fit) {
  return !edge_fit->discs || rival->glass || rival->coordinate == FG_EFFECT_NORMAL ||
         rival->coordinate == FG_EFFECT_COORDINATES;
}

const fg_effect *fg_rival_curve(fg_effect_coordinate coordinate, const char *moves) {
  for (const fg_effect *effect = fg_effect_first(); effect; effect = fg_effect_next(effect))
    if (fg_effect_is_free(effect) && effect->coordinate == coordinate &&
        (!moves || !strcmp(effect->moves, moves)))
      return effect;
  return NULL;
}

const fg_rival fg_rivals[] = {
    {.name = "scan.x.dx",
     .coordinate = FG_EFFECT_X,
     .moves = "x",
     .glass = fg_glass_x_over_x,
     .variances = fg_glass_x_variances},
    {.name = "scan.x.dy",
     .coordinate = FG_EFFECT_X,
     .moves = "y",
     .glass = fg_glass_y_over_x,
     .variances = fg_glass_x_variances},
    {.name = "scan.y.dx",
     .coordinate = FG_EFFECT_Y,
     .moves = "x",
     .glass = fg_glass_x_over_y,
     .variances = fg_glass_y_variances},
    {.name = "scan.y.dy",
     .coordinate = FG_EFFECT_Y,
     .moves = "y",
     .glass = fg_glass_y_over_y,
     .variances = fg_glass_y_variances},
    {.name = "scan.y of stretched lines",
     .coordinate = FG_EFFECT_Y,
     .moves = "x and y",
     .glass = fg_glass_stretched_lines,
     .variances = fg_glass_stretched_variances},
    {.name = "scan.y of rigid lines",
     .coordinate = FG_EFFECT_Y,
     .moves = "x and y",
     .glass = fg_glass_rigid_lines,
     .variances = fg_glass_rigid_variances},
    {.name = "scan.xy",
     .coordinate = FG_EFFECT_Y,
     .moves = "x and y",
     .glass = fg_glass_plane,
     .variances = fg_glass_plane_variances,
     .loose = true},
    {.name = "scan.xy of one map",
     .coordinate = FG_EFFECT_Y,
     .moves = "x and y",
     .glass = fg_glass_maps,
     .variances = fg_glass_map_variances,
     .stretch = fg_glass_map_columns},
    {.name = "foil.s",
     .coordinate = FG_EFFECT_FOIL,
     .columns = over_foil,
     .variances = foil_variances},
    {.name = "foil.ring",
     .coordinate = FG_EFFECT_FOIL,
     .columns = on_ring,
     .variances = ring_variances},
    {.name = "foil.ring of one harmonic",
     .coordinate = FG_EFFECT_FOIL,
     .columns = on_ring,
     .variances = alike_variances,
     .stretch = two_columns,
     .of_last = true},
    {.name = "foil.s, radial",
     .coordinate = FG_EFFECT_FOIL,
     .columns = over_foil_radial,
     .variances = foil_variances},
    {.name = "foil.ring, radial",
     .coordinate = FG_EFFECT_FOIL,
     .columns = on_ring_radial,
     .variances = ring_variances},
    {.name = "foil.ring of one harmonic, radial",
     .coordinate = FG_EFFECT_FOIL,
     .columns = on_ring_radial,
     .variances = alike_variances,
     .stretch = two_columns,
     .of_last = true},
    {.name = "bump.phi",
     .coordinate = FG_EFFECT_PHI,
     .columns = over_phi,
     .variances = phi_variances},
    {.name = "land.phi",
     .coordinate = FG_EFFECT_FOIL,
     .columns = over_lands,
     .variances = land_variances},
    {.name = "bump.each",
     .coordinate = FG_EFFECT_INDEX,
     .columns = over_each,
     .variances = each_variances,
     .loose = true},
    {.name = "bump.each of one bump",
     .coordinate = FG_EFFECT_INDEX,
     .columns = over_each,
     .variances = one_variances,
     .stretch = orders_of_bump,
     .of_last = true},
    {.name = "bump.each of a pattern",
     .coordinate = FG_EFFECT_INDEX,
     .columns = over_pattern,
     .variances = pattern_variances,
     .stretch = orders_of_pattern},
    {.name = "edge.normal",
     .coordinate = FG_EFFECT_NORMAL,
     .columns = over_direction,
     .variances = direction_variances},
    {.name = "edge.normal of one harmonic",
     .coordinate = FG_EFFECT_NORMAL,
     .columns = over_direction,
     .variances = alike_variances,
     .stretch = two_columns_of_discs,
     .of_last = true},
    {.name = "disc.form of one disc",
     .coordinate = FG_EFFECT_COORDINATES, /* no curve: it is the disc's own */
     .columns = over_disc,
     .variances = disc_variances,
     .stretch = numbers_of_disc},
    {.name = NULL},
};
