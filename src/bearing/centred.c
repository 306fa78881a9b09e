/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rotor position with the largest minimum clearance: maximise m, m <= c_i - a x_i - b y_i for all
 * i.
 *
 * A linear programme in (m, a, b). Its dual has the solution: weights w >= 0 on three places with
 * sum w = 1, sum w x = sum w y = 0, so that m = sum w c for any a and b. Start: three places that
 * surround the axis. Step: the place that the rotor overlaps most enters, and the one leaves that
 * keeps the weights positive, until none is overlapped (dual simplex). */
#include <math.h>

#include "bearing/places.h"

/* Tolerances of directions (unit vectors) and of clearances in mm: far below the measurement's. */
static const double tiny = 1e-9, overlap_mm = 1e-12;

/* Exchanges are a handful; where equal clearances let them turn in a circle all triples are tried.
 */
enum { EXCHANGES_MAX = 200 };

double fg_places_shifted(const fg_places *p, size_t i, double a, double b) {
  return p->clearance[i] - a * p->x[i] - b * p->y[i];
}

/* Returns true when every half plane holds a crown: else a rotor could move away without limit. */
static bool surrounded(const fg_places *p) {
  for (size_t i = 0; i < p->count; i++) {
    bool left = false, right = false;
    for (size_t j = 0; j < p->count && !(left && right); j++) {
      double cross = p->x[i] * p->y[j] - p->y[i] * p->x[j];
      left = left || cross > tiny;
      right = right || cross < -tiny;
    }
    if (!left || !right) return false;
  }
  return true;
}

/* `target` as a sum of the directions (1, x, y) of three places. */
static bool weigh_places(const fg_places *p, const size_t at[3], const double target[3],
                         double w[3]) {
  double a[3][3];
  for (int i = 0; i < 3; i++) {
    a[0][i] = 1;
    a[1][i] = p->x[at[i]];
    a[2][i] = p->y[at[i]];
  }
  return fg_places_solve(a, target, w);
}

static bool surround(const fg_places *p, const size_t at[3], double w[3]) {
  static const double axis[3] = {1, 0, 0};
  return weigh_places(p, at, axis, w) && w[0] >= -tiny && w[1] >= -tiny && w[2] >= -tiny;
}

/* Rotor (m, a, b) that touches three crowns alike. */
static bool touch_three(const fg_places *p, const size_t at[3], double rotor[3]) {
  double a[3][3], b[3];
  for (int i = 0; i < 3; i++) {
    a[i][0] = 1;
    a[i][1] = p->x[at[i]];
    a[i][2] = p->y[at[i]];
    b[i] = p->clearance[at[i]];
  }
  return fg_places_solve(a, b, rotor);
}

static bool find_start(const fg_places *p, size_t at[3], double w[3]) {
  for (size_t i = 0; i < p->count; i++)
    for (size_t j = i + 1; j < p->count; j++)
      for (size_t k = j + 1; k < p->count; k++) {
        at[0] = i, at[1] = j, at[2] = k;
        if (surround(p, at, w)) return true;
      }
  return false;
}

/* The places nearest to thirds of a turn from the first; of all triples where these do not. */
static bool find_start_places(const fg_places *p, size_t at[3], double w[3]) {
  static const double third[2][2] = {{-0.5, 0.8660254037844386}, {-0.5, -0.8660254037844386}};
  at[0] = at[1] = at[2] = 0;
  for (int side = 0; side < 2; side++) {
    double x = third[side][0] * p->x[0] - third[side][1] * p->y[0];
    double y = third[side][1] * p->x[0] + third[side][0] * p->y[0], nearest = -2;
    for (size_t i = 1; i < p->count; i++) {
      double along = x * p->x[i] + y * p->y[i];
      if (!(along > nearest)) continue;
      nearest = along;
      at[side + 1] = i;
    }
  }
  return surround(p, at, w) || find_start(p, at, w);
}

static size_t most_overlapped(const fg_places *p, const double rotor[3], double *room) {
  size_t at = 0;
  *room = INFINITY;
  for (size_t i = 0; i < p->count; i++) {
    double left = fg_places_shifted(p, i, rotor[1], rotor[2]) - rotor[0];
    if (!(left < *room)) continue;
    *room = left;
    at = i;
  }
  return at;
}

/* Returns the place of the three that leaves for `next`: the first whose weight would reach zero.
 */
static int leaving(const fg_places *p, const size_t at[3], const double w[3], size_t next) {
  const double direction[3] = {1, p->x[next], p->y[next]};
  double v[3], min = INFINITY;
  int out = -1;
  if (!weigh_places(p, at, direction, v)) return -1;
  for (int i = 0; i < 3; i++) {
    if (!(v[i] > tiny) || !(w[i] / v[i] < min)) continue;
    min = w[i] / v[i];
    out = i;
  }
  return out;
}

static bool exchange(const fg_places *p, size_t at[3], double rotor[3]) {
  double w[3], room;
  if (!find_start_places(p, at, w)) return false;
  for (int i = 0; i < EXCHANGES_MAX; i++) {
    if (!touch_three(p, at, rotor)) return false;
    size_t next = most_overlapped(p, rotor, &room);
    if (room >= -overlap_mm) return true;
    int out = leaving(p, at, w, next);
    if (out < 0) return false;
    at[out] = next;
    if (!surround(p, at, w)) return false;
  }
  return false;
}

/* Finds, of all rotor positions that touch three crowns equally, the one with the largest
 * clearance. */
static bool try_all(const fg_places *p, size_t touched[3], double best[3]) {
  double max = -INFINITY, rotor[3], room;
  for (size_t i = 0; i < p->count; i++)
    for (size_t j = i + 1; j < p->count; j++)
      for (size_t k = j + 1; k < p->count; k++) {
        const size_t at[3] = {i, j, k};
        if (!touch_three(p, at, rotor)) continue;
        most_overlapped(p, rotor, &room);
        if (!(rotor[0] + room > max)) continue;
        max = rotor[0] + room;
        for (int n = 0; n < 3; n++) {
          touched[n] = at[n];
          best[n] = rotor[n];
        }
        best[0] = max;
      }
  return isfinite(max);
}

bool fg_places_centre(const fg_places *p, size_t touched[3], fg_bearing_clearance *result) {
  double rotor[3];
  result->centred_min_mm = result->centred_at_mm[0] = result->centred_at_mm[1] = NAN;
  if (!surrounded(p) || !(exchange(p, touched, rotor) || try_all(p, touched, rotor))) return false;
  result->centred_min_mm = rotor[0];
  result->centred_at_mm[0] = rotor[1];
  result->centred_at_mm[1] = rotor[2];
  return true;
}
