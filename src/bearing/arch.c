/* Stiffness of a bump as an arch; derived in foilgauge/bearing.h. */
#include <math.h>

#include "foilgauge/bearing.h"

static const double rad_per_deg = 3.14159265358979323846 / 180;
static const double mpa_per_gpa = 1000;

/* A moment or a compression as factors of 1, sin psi, cos psi. */
typedef double shape[3];

enum { LOAD_V, LOAD_H, LOAD_W, LOADS };

typedef struct half_loads {
  shape moment[LOADS], compression[LOADS];
} half_loads;

typedef double flexibility[LOADS][LOADS];

/* Integrals of the products of 1, sin, cos from `from` to `to`. */
static void integrate_products(double from, double to, double product[3][3]) {
  double s = sin(to) - sin(from), c = cos(from) - cos(to), length = to - from;
  double twice = (sin(2 * to) - sin(2 * from)) / 4;
  double mixed = (pow(sin(to), 2) - pow(sin(from), 2)) / 2;
  const double rows[3][3] = {
      {length, c, s}, {c, length / 2 - twice, mixed}, {s, mixed, length / 2 + twice}};
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++)
      product[i][k] = rows[i][k];
}

static double bilinear(const shape a, double product[3][3], const shape b) {
  double sum = 0;
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++)
      sum += a[i] * product[i][k] * b[k];
  return sum;
}

static void add_flexibility(const half_loads *loads, double from, double to, double slender,
                            double scale, flexibility f) {
  double product[3][3];
  integrate_products(from, to, product);
  for (int i = 0; i < LOADS; i++)
    for (int k = 0; k < LOADS; k++)
      f[i][k] +=
          scale * (bilinear(loads->moment[i], product, loads->moment[k]) +
                   slender * bilinear(loads->compression[i], product, loads->compression[k]));
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

static void compute_flexibility(const fg_arch *arch, const fg_arch_material *material, bool whole,
                                flexibility f) {
  double phi = arch->bump_angle_deg * rad_per_deg / 2, r = arch->radius_mm;
  double t = arch->thickness_mm, nu = material->poisson_ratio;
  double bending =
      material->youngs_modulus_gpa * mpa_per_gpa * t * t * t / (12 * (1 - nu) * (1 + nu));
  double slender = t * t / (12 * r * r), scale = r * r * r / bending;
  half_loads right = right_half(phi), left = left_half(phi);
  for (int i = 0; i < LOADS; i++)
    for (int k = 0; k < LOADS; k++)
      f[i][k] = 0;
  add_flexibility(&right, 0, phi, slender, scale, f);
  if (whole) add_flexibility(&left, -phi, 0, slender, scale, f);
}

static fg_status check_arch(fg_context *ctx, const fg_arch *arch,
                            const fg_arch_material *material) {
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
  FG_TRY(check_arch(ctx, arch, material));
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
  FG_TRY(check_arch(ctx, arch, material));
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

/* d ln K / d ln x by a central difference over exp(± step). */
static fg_status slope_of(fg_context *ctx, const fg_arch *arch, const fg_arch_material *material,
                          const double power[3], double *slope) {
  static const double step = 1e-4;
  double logarithm[2];
  for (int side = 0; side < 2; side++) {
    double change = side ? step : -step;
    fg_arch moved = {arch->radius_mm * exp(change * power[0]),
                     arch->bump_angle_deg * exp(change * power[1]),
                     arch->thickness_mm * exp(change * power[2])};
    fg_arch_stiffness stiffness;
    FG_TRY(fg_arch_free(ctx, &moved, material, &stiffness));
    logarithm[side] = log(stiffness.stiffness_n_mm2);
  }
  *slope = (logarithm[1] - logarithm[0]) / (2 * step);
  return FG_OK;
}

fg_status fg_arch_sensitivities(fg_context *ctx, const fg_arch *arch,
                                const fg_arch_material *material,
                                fg_arch_sensitivity *sensitivity) {
  FG_TRY(slope_of(ctx, arch, material, (const double[]){1, 0, 0}, &sensitivity->radius));
  FG_TRY(slope_of(ctx, arch, material, (const double[]){0, 1, 0}, &sensitivity->angle));
  FG_TRY(slope_of(ctx, arch, material, (const double[]){1, -1, 0},
                  &sensitivity->radius_at_arc_length));
  return slope_of(ctx, arch, material, (const double[]){0, 0, 1}, &sensitivity->thickness);
}
