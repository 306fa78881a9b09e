/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stiffness of a bump as an arch; derived in foilgauge/bearing.h. */
#include <math.h>

#include "bearing/arch.h"

static const double rad_per_deg = 3.14159265358979323846 / 180;
static const double mpa_per_gpa = 1000;

/* A moment or a compression as factors of 1, sin psi, cos psi. */
typedef double shape[3];

enum { LOAD_V, LOAD_H, LOAD_W, LOADS };

typedef struct half_loads {
  shape moment[LOADS], compression[LOADS];
} half_loads;

typedef double flexibility[LOADS][LOADS];

/* Gauss-Legendre rule of ten points. The integrands are products of sines and cosines over at most
 * a quarter turn: exact to rounding, also for a flat arc, where closed forms are differences of
 * nearly equal numbers. */
enum { NODES = 10 };

static const double half_node[NODES / 2] = {0.1488743389816312, 0.4333953941292472,
                                            0.6794095682990244, 0.8650633666889845,
                                            0.9739065285171717};
static const double half_weight[NODES / 2] = {0.2955242247147529, 0.2692667193099963,
                                              0.2190863625159820, 0.1494513491505806,
                                              0.0666713443086881};

static double value_of(const shape a, double sine, double cosine) {
  return a[0] + a[1] * sine + a[2] * cosine;
}

static void add_node(const half_loads *loads, double psi, double slender, double weight,
                     flexibility f) {
  double sine = sin(psi), cosine = cos(psi), m[LOADS], n[LOADS];
  for (int i = 0; i < LOADS; i++) {
    m[i] = value_of(loads->moment[i], sine, cosine);
    n[i] = value_of(loads->compression[i], sine, cosine);
  }
  for (int i = 0; i < LOADS; i++)
    for (int k = 0; k < LOADS; k++)
      f[i][k] += weight * (m[i] * m[k] + slender * n[i] * n[k]);
}

static void add_flexibility(const half_loads *loads, double from, double to, double slender,
                            double scale, flexibility f) {
  double middle = (from + to) / 2, half = (to - from) / 2;
  for (int i = 0; i < NODES / 2; i++)
    for (int side = -1; side <= 1; side += 2)
      add_node(loads, middle + side * half * half_node[i], slender, scale * half * half_weight[i],
               f);
}

static half_loads right_half(double phi) {
  return (half_loads){.moment = {{sin(phi), -1, 0}, {cos(phi), 0, -1}, {0, 0, 0}},
                      .compression = {{0, 1, 0}, {0, 0, 1}, {0, 0, 0}}};
}

static half_loads left_half(double phi) {
  half_loads loads = right_half(phi);
  loads.moment[LOAD_W][1] = 1;
  loads.compression[LOAD_W][1] = -1;
  return loads;
}

double fg_arch_half_angle(const fg_arch *arch) {
  return arch->bump_angle_deg * rad_per_deg / 2;
}

double fg_arch_bending(const fg_arch *arch, const fg_arch_material *material) {
  double t = arch->thickness_mm, nu = material->poisson_ratio;
  return material->youngs_modulus_gpa * mpa_per_gpa * t * t * t / (12 * (1 - nu) * (1 + nu));
}

static void compute_flexibility(const fg_arch *arch, const fg_arch_material *material, bool whole,
                                flexibility f) {
  double phi = fg_arch_half_angle(arch), r = arch->radius_mm, t = arch->thickness_mm;
  double slender = t * t / (12 * r * r), scale = r * r * r / fg_arch_bending(arch, material);
  half_loads right = right_half(phi), left = left_half(phi);
  for (int i = 0; i < LOADS; i++)
    for (int k = 0; k < LOADS; k++)
      f[i][k] = 0;
  add_flexibility(&right, 0, phi, slender, scale, f);
  if (whole) add_flexibility(&left, -phi, 0, slender, scale, f);
}

fg_status fg_arch_check(fg_context *ctx, const fg_arch *arch, const fg_arch_material *material) {
  if (!(arch->radius_mm > 0 && arch->thickness_mm > 0 && arch->thickness_mm < arch->radius_mm &&
        isfinite(arch->radius_mm)))
    return fg_fail(ctx, FG_ERR_DATA, "an arch of radius %g mm and thickness %g mm has no stiffness",
                   arch->radius_mm, arch->thickness_mm);
  if (!(arch->bump_angle_deg > 0 && arch->bump_angle_deg < 180))
    return fg_fail(ctx, FG_ERR_DATA, "a bump angle of %g degrees; it must lie between 0 and 180",
                   arch->bump_angle_deg);
  if (!(material->youngs_modulus_gpa > 0 && material->poisson_ratio >= 0 &&
        material->poisson_ratio < 0.5 && material->friction >= 0))
    return fg_fail(ctx, FG_ERR_DATA,
                   "Young's modulus %g GPa, Poisson's ratio %g, friction %g: the first must be "
                   "above 0, the second from 0 to 0.5, the third not negative",
                   material->youngs_modulus_gpa, material->poisson_ratio, material->friction);
  return FG_OK;
}

fg_status fg_arch_free(fg_context *ctx, const fg_arch *arch, const fg_arch_material *material,
                       fg_arch_stiffness *stiffness) {
  flexibility f;
  FG_TRY(fg_arch_check(ctx, arch, material));
  compute_flexibility(arch, material, false, f);
  double holding = -f[LOAD_V][LOAD_H] / f[LOAD_H][LOAD_H], mu = material->friction;
  bool stuck = mu >= holding;
  double h = stuck ? holding : mu;
  *stiffness = (fg_arch_stiffness){
      .stiffness_n_mm2 = 2 / (f[LOAD_V][LOAD_V] + f[LOAD_V][LOAD_H] * h),
      .unloading_n_mm2 = stuck ? NAN : 2 / (f[LOAD_V][LOAD_V] - f[LOAD_V][LOAD_H] * mu),
      .foot_n_mm2 = 1 / f[LOAD_H][LOAD_H],
      .foot_share = 0.5,
      .stuck = stuck};
  return FG_OK;
}

/* V of the sliding foot per W, with H = ratio × V. */
static double sliding_share(flexibility f, double ratio) {
  return -f[LOAD_V][LOAD_W] / (f[LOAD_V][LOAD_V] + ratio * f[LOAD_V][LOAD_H]);
}

static double welded_stiffness(flexibility f, double v, double h) {
  return 1 / (f[LOAD_W][LOAD_W] + f[LOAD_W][LOAD_V] * v + f[LOAD_W][LOAD_H] * h);
}

fg_status fg_arch_welded(fg_context *ctx, const fg_arch *arch, const fg_arch_material *material,
                         fg_arch_stiffness *stiffness) {
  flexibility f;
  FG_TRY(fg_arch_check(ctx, arch, material));
  compute_flexibility(arch, material, true, f);
  double mu = material->friction;
  double determinant =
      f[LOAD_V][LOAD_V] * f[LOAD_H][LOAD_H] - f[LOAD_V][LOAD_H] * f[LOAD_V][LOAD_H];
  double v = (-f[LOAD_V][LOAD_W] * f[LOAD_H][LOAD_H] + f[LOAD_V][LOAD_H] * f[LOAD_H][LOAD_W]) /
             determinant;
  double h = (-f[LOAD_V][LOAD_V] * f[LOAD_H][LOAD_W] + f[LOAD_V][LOAD_H] * f[LOAD_V][LOAD_W]) /
             determinant;
  bool stuck = fabs(h) <= mu * v;
  if (!stuck) {
    double ratio = h > 0 ? mu : -mu;
    v = sliding_share(f, ratio);
    h = ratio * v;
  }
  double back = h > 0 ? -mu : mu, v_back = sliding_share(f, back);
  *stiffness = (fg_arch_stiffness){.stiffness_n_mm2 = welded_stiffness(f, v, h),
                                   .unloading_n_mm2 =
                                       stuck ? NAN : welded_stiffness(f, v_back, back * v_back),
                                   .foot_n_mm2 = 1 / f[LOAD_H][LOAD_H],
                                   .foot_share = v,
                                   .stuck = stuck};
  return FG_OK;
}
