/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tone curve of a driver's model as a table. */
#include <math.h>
#include <pthread.h>

#include "vision/driver_model.h"

/* Min steepness of an S: below it is a straight line. */
#define STEEPNESS_MIN 1e-3

fg_driver fg_driver_none(const double ends[2]) {
  return (fg_driver){
      .values = {[FG_DRIVER_CENTRE] = 0.5, [FG_DRIVER_RADIUS] = 1, [FG_DRIVER_HALO_PX] = 10},
      .ends = {ends[0], ends[1]}};
}

static double logistic(double x) {
  return 1 / (1 + exp(-x));
}

/* S at x, without and with its ends scaled to 0 and 1. */
static double s_curve(double k, double m, double x) {
  double low = logistic(-k * m), high = logistic(k * (1 - m));
  return k < STEEPNESS_MIN ? x : (logistic(k * (x - m)) - low) / (high - low);
}

bool fg_driver_is_linear(const fg_driver *driver) {
  return driver->values[FG_DRIVER_LN_GAMMA] == 0 &&
         driver->values[FG_DRIVER_STEEPNESS] < STEEPNESS_MIN;
}

/* Returns G. Below light 0 a power is not defined; without one the line goes on. */
double fg_driver_count(const fg_driver *driver, double light) {
  double ln_gamma = driver->values[FG_DRIVER_LN_GAMMA];
  double count = ln_gamma == 0 ? light : 255 * pow(fmax(light, 0) / 255, exp(-ln_gamma));
  double low = driver->ends[0], range = driver->ends[1] - driver->ends[0];
  return low + range * s_curve(driver->values[FG_DRIVER_STEEPNESS],
                               driver->values[FG_DRIVER_CENTRE], (count - low) / range);
}

/* ln(light / 255) at the table's places, for powers of it. */
static double ln_light[FG_DRIVER_TONE_STEPS + 2];

static void fill_ln_light(void) {
  for (int i = 0; i < FG_DRIVER_TONE_STEPS + 2; i++)
    ln_light[i] = log(fg_driver_tone_light(i) / 255);
}

/* Fills the counts before the S. */
static void fill_power(const fg_driver *driver, double *count) {
  static pthread_once_t once = PTHREAD_ONCE_INIT;
  double ln_gamma = driver->values[FG_DRIVER_LN_GAMMA], exponent = exp(-ln_gamma);
  pthread_once(&once, fill_ln_light);
  for (int i = 0; i < FG_DRIVER_TONE_STEPS + 2; i++)
    count[i] = ln_gamma == 0 ? fg_driver_tone_light(i) : 255 * exp(exponent * ln_light[i]);
}

/* Turns counts to those after the S. */
static void add_s_curve(const fg_driver *driver, double *count) {
  double k = driver->values[FG_DRIVER_STEEPNESS], m = driver->values[FG_DRIVER_CENTRE];
  double from = driver->ends[0], range = driver->ends[1] - driver->ends[0];
  double low = logistic(-k * m), high = logistic(k * (1 - m));
  if (k < STEEPNESS_MIN) return;
  for (int i = 0; i < FG_DRIVER_TONE_STEPS + 2; i++) {
    double x = (count[i] - from) / range;
    count[i] = from + range * (logistic(k * (x - m)) - low) / (high - low);
  }
}

static bool is_same_tone(const fg_driver *a, const fg_driver *b) {
  for (int i = FG_DRIVER_LN_GAMMA; i <= FG_DRIVER_CENTRE; i++)
    if (a->values[i] != b->values[i]) return false;
  return a->ends[0] == b->ends[0] && a->ends[1] == b->ends[1];
}

void fg_driver_tone_fill(const fg_driver *driver, fg_driver_tone *tone) {
  static const double dark = 32;
  if (tone->filled && is_same_tone(driver, &tone->of)) return;
  tone->filled = true;
  tone->of = *driver;
  tone->linear = fg_driver_is_linear(driver);
  if (tone->linear) return;
  fill_power(driver, tone->count);
  add_s_curve(driver, tone->count);
  for (int i = 0; i <= FG_DRIVER_TONE_STEPS; i++)
    tone->rate[i] = (tone->count[i + 1] - tone->count[i]) /
                    (fg_driver_tone_light(i + 1) - fg_driver_tone_light(i));
  tone->below = (tone->count[0] - fg_driver_count(driver, -dark)) / dark;
}

void fg_driver_tone_all(const fg_driver_tone *tone, size_t count, double *light) {
  double rate;
  for (size_t i = 0; i < count && !tone->linear; i++)
    light[i] = fg_driver_tone_at(tone, light[i], &rate);
}

double fg_driver_tone_inverse(const fg_driver_tone *tone, double count) {
  if (tone->linear) return count;
  int low = 0, high = FG_DRIVER_TONE_STEPS + 1;
  if (count < tone->count[0])
    return tone->below > 1e-3 ? (count - tone->count[0]) / tone->below : 0;
  while (high - low > 1) {
    int middle = (low + high) / 2;
    if (tone->count[middle] <= count)
      low = middle;
    else
      high = middle;
  }
  double step = tone->count[high] - tone->count[low];
  double share = step > 0 ? (count - tone->count[low]) / step : 0;
  return fg_driver_tone_light(low) +
         fmin(fmax(share, 0), 1) * (fg_driver_tone_light(high) - fg_driver_tone_light(low));
}

double fg_driver_extra_slope(const fg_driver *driver) {
  double k = driver->values[FG_DRIVER_STEEPNESS], m = driver->values[FG_DRIVER_CENTRE];
  if (k < STEEPNESS_MIN) return 0;
  return k / 4 / (logistic(k * (1 - m)) - logistic(-k * m)) - 1;
}
