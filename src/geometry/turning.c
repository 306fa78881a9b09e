/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/turning.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"

#define TANGENT_MM     0.12              /* the direction is taken over ± this length */
#define PROMINENCE_RAD (12 * M_PI / 180) /* smaller turns back are not turning points */
#define LIP_TURN_MIN   (45 * M_PI / 180)
#define LIP_RADIUS     0.4 /* a lip's bend is tighter than this share of the bumps' radius */
#define SHARP_RADIUS   0.5 /* and fillets are tighter than this share */
enum { STRETCHES_MAX = 512, PAIRS_MIN = 8 };

/* Returns the usable station at or next to i, in the direction of `step`; i itself where there is
 * none. */
static size_t usable_station(const fg_strip *strip, size_t i, int step) {
  for (size_t k = i; k < strip->count; k += (size_t)step)
    if (strip->stations[k].weight > 0) return k;
  return i;
}

/* Finds the direction over ± TANGENT_MM, or further where stations are not usable. The ends, which
 * are not usable either, keep the last known direction. */
static void find_directions(const fg_strip *strip, double *direction) {
  size_t reach = (size_t)(TANGENT_MM / strip->step_mm + 0.5);
  if (reach < 1) reach = 1;
  double before = 0;
  size_t first = usable_station(strip, 0, 1), last = usable_station(strip, strip->count - 1, -1);
  for (size_t i = 0; i < strip->count; i++) {
    size_t middle = i < first ? first : i > last ? last : i;
    size_t a = usable_station(strip, middle > first + reach ? middle - reach : first, -1);
    size_t b = usable_station(strip, middle + reach < last ? middle + reach : last, 1);
    fg_point p = fg_strip_middle(strip, a), q = fg_strip_middle(strip, b);
    double angle = a < b ? atan2(q.y - p.y, q.x - p.x) : before;
    if (i > 0) angle += 2 * M_PI * round((before - angle) / (2 * M_PI));
    direction[i] = before = angle;
  }
}

/* Cuts the strip at the turning points of the direction. Returns the number of turns. */
static size_t cut_turns(const fg_strip *strip, const double *direction, fg_turn *out) {
  size_t count = 0, from = 0, low = 0, high = 0;
  int rising = 0;
  for (size_t i = 1; i <= strip->count && count < STRETCHES_MAX - 1; i++) {
    bool end = i == strip->count;
    if (!end) {
      if (direction[i] > direction[high]) high = i;
      if (direction[i] < direction[low]) low = i;
    }
    size_t cut;
    if (!end && rising >= 0 && direction[i] < direction[high] - PROMINENCE_RAD) {
      cut = high;
      low = i;
      rising = -1;
    } else if (!end && rising <= 0 && direction[i] > direction[low] + PROMINENCE_RAD) {
      cut = low;
      high = i;
      rising = 1;
    } else if (end) {
      cut = strip->count - 1;
    } else {
      continue;
    }
    if (fabs(direction[cut] - direction[from]) < PROMINENCE_RAD) continue;
    if (cut > from)
      out[count++] = (fg_turn){.first = from,
                               .last = cut,
                               .turn_rad = direction[cut] - direction[from],
                               .length_mm = strip->stations[cut].s_mm - strip->stations[from].s_mm};
    from = cut;
  }
  return count;
}

/* Lower median over the turns that turn with `sign`, the two at the ends left out when there
 * are others. 0 when there are none. */
static double median_over(const fg_turn *turns, size_t count, double sign,
                          double (*get)(const fg_turn *)) {
  double values[STRETCHES_MAX];
  size_t n = 0, skip = count > 2 ? 1 : 0;
  for (size_t i = skip; i + skip < count; i++)
    if (turns[i].turn_rad * sign > PROMINENCE_RAD) values[n++] = get(&turns[i]);
  return n ? fg_select(values, n, (n - 1) / 2) : 0;
}

/* The turn's own tight part: a lip's straight leg and land belong to its turn too, so the
 * radius of the bend is judged where 80 % of the turn happens. */
static fg_turn tight_part(const fg_strip *strip, const double *direction, const fg_turn *s) {
  size_t a = s->first, b = s->last;
  double from = direction[a] + 0.1 * s->turn_rad, to = direction[a] + 0.9 * s->turn_rad;
  double sign = s->turn_rad > 0 ? 1 : -1;
  while (a < s->last && sign * (direction[a] - from) < 0)
    a++;
  while (b > a && sign * (direction[b] - to) > 0)
    b--;
  return (fg_turn){.first = a,
                   .last = b,
                   .turn_rad = 0.8 * s->turn_rad,
                   .length_mm = strip->stations[b].s_mm - strip->stations[a].s_mm};
}

static double get_radius(const fg_turn *s) {
  return s->length_mm / fabs(s->turn_rad);
}

static double get_tightest(const fg_turn *s) {
  return s->tightest_mm;
}

/* Radius where a turn of PROMINENCE_RAD has the min length: a bump's own, and of a gap that of its
 * fillets, however long the land between them is. */
static double find_tightest(const fg_strip *strip, const double *direction, const fg_turn *s) {
  double min = s->length_mm;
  double sign = s->turn_rad > 0 ? 1 : -1;
  for (size_t a = s->first, b = s->first; a <= s->last; a++) {
    while (b < s->last && sign * (direction[b] - direction[a]) < PROMINENCE_RAD)
      b++;
    if (sign * (direction[b] - direction[a]) < PROMINENCE_RAD) break;
    min = fmin(min, strip->stations[b].s_mm - strip->stations[a].s_mm);
  }
  return min / PROMINENCE_RAD;
}

/* Part of a turn on radii below `limit_mm`. */
static double sharp_turn(const fg_strip *strip, const double *direction, const fg_turn *s,
                         double limit_mm) {
  double sum = 0;
  for (size_t i = s->first; i < s->last; i++) {
    double turn = fabs(direction[i + 1] - direction[i]);
    if (turn * limit_mm > strip->stations[i + 1].s_mm - strip->stations[i].s_mm) sum += turn;
  }
  return sum;
}

/* Finds the bumps' sense. A bump and the gap beside it turn by a pitch or more round the overall
 * circle, in the sense that bumps do not have; the median holds when a bump is crushed. With few
 * bumps the lip biases it, and the fillets mark the gaps. */
static double find_sense(const fg_turn *turns, size_t count) {
  double sums[STRETCHES_MAX];
  size_t n = 0;
  for (size_t i = 1; i + 2 < count; i++)
    sums[n++] = turns[i].turn_rad + turns[i + 1].turn_rad;
  if (n >= PAIRS_MIN) return fg_select(sums, n, n / 2) < 0 ? 1 : -1;
  double up = median_over(turns, count, 1, get_tightest);
  return up > median_over(turns, count, -1, get_tightest) ? 1 : -1;
}

/* Middle of a lip's bend: the place where a turn has made half a right angle from one of
 * its ends. */
static size_t bend_middle(const double *direction, const fg_turn *s, bool from_last) {
  size_t at = from_last ? s->last : s->first, from = at;
  while (at != (from_last ? s->first : s->last) &&
         fabs(direction[at] - direction[from]) < LIP_TURN_MIN)
    at += from_last ? (size_t)-1 : 1;
  return at;
}

static double get_sharp(const fg_turn *s) {
  return s->sharp_rad;
}

/* Finds a lip that is bent towards the shaft. It turns as the gaps do and is one with the first of
 * them, which then has a right angle more of sharp turn than the one fillet of its own. */
static void find_lip_in_gaps(const double *direction, const fg_turn *all, size_t count,
                             fg_turning *out) {
  const fg_turn *first = &all[0], *last = &all[count - 1];
  if (out->lip_first || out->lip_last || out->bump_count < 2) return;
  double limit = 0.5 * median_over(all, count, -out->sense, get_sharp) + LIP_TURN_MIN;
  out->lip_first = first->turn_rad * out->sense < 0 && first->sharp_rad > limit;
  out->lip_last = last->turn_rad * out->sense < 0 && last->sharp_rad > limit;
  if (out->lip_first) out->lip_end[0] = bend_middle(direction, first, false);
  if (out->lip_last) out->lip_end[1] = bend_middle(direction, last, true);
}

/* Returns true for a lip: a tight bend in the bumps' sense, the first or last of its kind. */
static bool is_lip(const fg_turn *s, double typical_radius) {
  return fabs(s->turn_rad) > LIP_TURN_MIN && get_radius(s) < typical_radius;
}

static void pick_bumps(const fg_strip *strip, const double *direction, const fg_turn *all,
                       size_t count, fg_turning *out) {
  size_t n = 0;
  double radii[STRETCHES_MAX];
  fg_turn *bumps = out->bumps;
  for (size_t i = 0; i < count; i++)
    if (all[i].turn_rad * out->sense > PROMINENCE_RAD) {
      radii[n] = all[i].bend_radius_mm;
      bumps[n++] = all[i];
    }
  if (!n) return;
  double sorted[STRETCHES_MAX];
  memcpy(sorted, radii, n * sizeof *radii);
  double limit = LIP_RADIUS * fg_select(sorted, n, n / 2);
  fg_turn first = tight_part(strip, direction, &bumps[0]);
  fg_turn last = tight_part(strip, direction, &bumps[n - 1]);
  out->lip_first = n > 1 && is_lip(&first, limit);
  out->lip_last = n > 1 && is_lip(&last, limit);
  out->lip_end[0] = first.last;
  out->lip_end[1] = last.first;
  size_t skip = out->lip_first ? 1 : 0, drop = out->lip_last ? 1 : 0;
  out->bump_count = n > skip + drop ? n - skip - drop : 0;
  memmove(bumps, bumps + skip, out->bump_count * sizeof *bumps);
}

fg_status fg_turning_find(fg_context *ctx, const fg_strip *strip, fg_turning *turning) {
  memset(turning, 0, sizeof *turning);
  double *direction = NULL;
  fg_turn *turns = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, strip->count, sizeof *direction, (void **)&direction));
  FG_TRY_EXIT(fg_memory_allocate(ctx, STRETCHES_MAX, sizeof *turns, (void **)&turns));
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, STRETCHES_MAX, sizeof *turning->bumps, (void **)&turning->bumps));
  if (strip->count < 8) goto exit;
  find_directions(strip, direction);
  size_t count = cut_turns(strip, direction, turns);
  for (size_t i = 0; i < count; i++) {
    fg_turn tight = tight_part(strip, direction, &turns[i]);
    turns[i].bend_radius_mm = get_radius(&tight);
    turns[i].tightest_mm = find_tightest(strip, direction, &turns[i]);
  }
  turning->sense = find_sense(turns, count);
  double sharp = SHARP_RADIUS * median_over(turns, count, turning->sense, get_tightest);
  for (size_t i = 0; i < count; i++)
    turns[i].sharp_rad = sharp_turn(strip, direction, &turns[i], sharp);
  pick_bumps(strip, direction, turns, count, turning);
  if (count) find_lip_in_gaps(direction, turns, count, turning);
exit:
  free(direction);
  free(turns);
  if (status != FG_OK) fg_turning_free(turning);
  return status;
}

void fg_turning_free(fg_turning *turning) {
  if (!turning) return;
  free(turning->bumps);
  memset(turning, 0, sizeof *turning);
}
