/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/round_end.h"

#include <gsl/gsl_cdf.h>
#include <math.h>

/* Reach of the blur, in blurs, and the light beyond it. */
#define REACH_BLURS 6.0
#define LIGHT_MIN   1e-12
/* Gauss and Legendre's nodes of 24, one half. */
enum { HALF_NODES = 12 };
static const double nodes[HALF_NODES] = {
    0.0640568928626056260, 0.1911188674736163092, 0.3150426796961633744, 0.4337935076260451385,
    0.5454214713888395357, 0.6480936519369755692, 0.7401241915785543642, 0.8200019859739029219,
    0.8864155270044010342, 0.9382745520027327585, 0.9747285559713094982, 0.9951872199970213602};
static const double node_weights[HALF_NODES] = {
    0.1279381953467521570, 0.1258374563468282961, 0.1216704729278033912, 0.1155056680537256014,
    0.1074442701159656348, 0.0976186521041138883, 0.0861901615319532759, 0.0733464814110803057,
    0.0592985849154367807, 0.0442774388174198061, 0.0285313886289336631, 0.0123412297999871995};

static double tail_of(double x) {
  return 0.5 * erfc(x * M_SQRT1_2);
}

/* Adds the light, and the shadow, of the line at t = W sin(angle) along the cut. */
static void add_line(const fg_round_end *e, double angle, double weight, double u, double v,
                     double sums[2]) {
  double t = e->half_width * sin(angle), off = (v - t) / e->blur_across;
  double h = sqrt(fmax(0, e->radius * e->radius - t * t));
  double density = exp(-0.5 * off * off) / (sqrt(2 * M_PI) * e->blur_across);
  double share = weight * density * e->half_width * cos(angle), x = (u - h) / e->blur_along;
  sums[0] += share * tail_of(x);
  sums[1] += share * tail_of(-x);
}

double fg_round_end_distance(const fg_round_end *end, double u, double v) {
  double width = end->half_width, reach = REACH_BLURS * end->blur_across;
  double from = asin(fmax(-1, fmin(1, (v - reach) / width)));
  double to = asin(fmax(-1, fmin(1, (v + reach) / width)));
  double middle = 0.5 * (from + to), half = 0.5 * (to - from), sums[2] = {0, 0};
  for (int i = 0; i < HALF_NODES; i++)
    for (int side = -1; side <= 1; side += 2)
      add_line(end, middle + side * half * nodes[i], half * node_weights[i], u, v, sums);
  sums[1] += tail_of((width - v) / end->blur_across) + tail_of((width + v) / end->blur_across);
  double light = fmax(sums[0], LIGHT_MIN), shadow = fmax(sums[1], LIGHT_MIN);
  double x = light < shadow ? -gsl_cdf_ugaussian_Qinv(light) : gsl_cdf_ugaussian_Qinv(shadow);
  return end->blur_along * x;
}
