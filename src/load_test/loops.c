/* The area of the loops and what it says of damping. */
#include <math.h>

#include "load_test/analysis.h"

/* Ends of a loop that lie nearer to each other than this share of the travel close it. */
static const double close_share = 0.05;

/* Loops give energy where their area is below zero by more than U = 2 u. */
static const double gained_reach = 2;

/* Samples about a turning point whose mean is its force. */
enum { TURN_SAMPLES = 9 };

typedef struct tally {
  double sum, squares, count;
} tally;

static void add(tally *t, double area) {
  t->sum += area;
  t->squares += area * area;
  t->count++;
}

/* A force that drifts adds to a loop that begins with the one stroke what it takes from a loop that
 * begins with the other: means of neighbours, which share a stroke, are without it. */
typedef struct loops {
  tally single, pair;
  double noise; /* variance of one loop by the samples' scatter */
} loops;

/* Area of the polygon of samples first ... last, closed; positive where energy is lost. */
static double polygon(const fg_load_sample *s, size_t first, size_t last) {
  double area = 0, f0 = s[first].force_n;
  for (size_t i = first; i <= last; i++) {
    size_t next = i < last ? i + 1 : first;
    area += ((s[i].force_n + s[next].force_n) / 2 - f0) * (s[next].x_mm - s[i].x_mm);
  }
  return area;
}

/* NaN: its ends do not meet. */
static double loop_area(const fg_load_sample *s, const fg_load_direction *direction, size_t first,
                        size_t last, double variance, loops *all) {
  if (fabs(s[last].x_mm - s[first].x_mm) > close_share * direction->travel_mm) return NAN;
  double area = polygon(s, first, last), noise = 0;
  for (size_t i = first + 1; i < last; i++)
    noise += variance * pow((s[i + 1].x_mm - s[i - 1].x_mm) / 2, 2);
  add(&all->single, area);
  all->noise = noise;
  return area;
}

static double mean_variance(const fg_load_strokes *strokes) {
  double sum = 0, count = 0;
  for (size_t i = 0; i < strokes->count; i++)
    for (size_t k = 0; k < strokes->stroke[i].count; k += 8, count++)
      sum += strokes->stroke[i].variance[k];
  return sum / count;
}

static bool follows(const fg_load_strokes *strokes, size_t i) {
  return strokes->stroke[i].last == strokes->stroke[i + 1].first &&
         strokes->stroke[i].record == strokes->stroke[i + 1].record;
}

static loops find_loops(const fg_load_sample *samples, const fg_load_strokes *strokes,
                        const fg_load_direction *direction) {
  loops all = {0};
  double variance = mean_variance(strokes), last = NAN;
  for (size_t i = 0; i + 1 < strokes->count; i++) {
    double area = follows(strokes, i) ? loop_area(samples, direction, strokes->stroke[i].first,
                                                  strokes->stroke[i + 1].last, variance, &all)
                                      : NAN;
    if (isfinite(area + last)) add(&all.pair, (area + last) / 2);
    last = area;
  }
  /* One cycle from the middle back to the middle has no turning point twice. */
  if (!(all.single.count > 0) && strokes->count)
    loop_area(samples, direction, strokes->stroke[0].first,
              strokes->stroke[strokes->count - 1].last, variance, &all);
  return all;
}

/* Variance of a stroke's share, s², by how areas scatter. A pair of loops is s_i / 2 + s_j + s_k /
 * 2 of three strokes: 3/2 s²; its neighbour shares s² of that, the next one s² / 4, and so much
 * less they scatter about their mean. */
static double stroke_variance(const loops *all) {
  const tally *t = all->pair.count > 0 ? &all->pair : &all->single;
  double n = t->count, mean = t->sum / n, own = 2;
  if (!(n > 1)) return 0;
  if (all->pair.count > 0) own = 1.5 - (2 * (n - 1) + (n - 2) / 2) / (n * (n - 1));
  return fmax(0, t->squares - n * mean * mean) / (n - 1) / own;
}

/* Mean and its standard uncertainty: an area is twice the mean of what its n strokes give, so its
 * variance is 4 s² / n. */
static double mean_area(const loops *all, double *u) {
  const tally *t = all->pair.count > 0 ? &all->pair : &all->single;
  double strokes = t->count + (all->pair.count > 0 ? 2 : 1);
  *u = sqrt(4 * fmax(stroke_variance(all), all->noise / 2) / strokes);
  return t->sum / t->count;
}

static double force_about(const fg_load_sample *s, size_t count, size_t at) {
  size_t low = at > TURN_SAMPLES / 2 ? at - TURN_SAMPLES / 2 : 0;
  size_t high = at + TURN_SAMPLES / 2 < count ? at + TURN_SAMPLES / 2 : count - 1;
  double sum = 0;
  for (size_t i = low; i <= high; i++)
    sum += s[i].force_n;
  return sum / (double)(high - low + 1);
}

/* Travel and stiffness from end to end of the whole strokes. */
static void find_secant(const fg_load_sample *samples, const fg_load_strokes *strokes,
                        fg_load_direction *direction, double *travel) {
  double way = 0, force = 0, count = 0;
  for (size_t i = 0; i < strokes->count; i++) {
    const fg_load_stroke *s = &strokes->stroke[i];
    double reach = s->high_mm - s->low_mm;
    if (reach < (1 - 2 * close_share) * direction->travel_mm) continue;
    way += reach;
    force += s->sense * (force_about(samples, direction->count, s->last) -
                         force_about(samples, direction->count, s->first));
    count++;
  }
  *travel = count > 0 ? way / count : NAN;
  direction->secant_n_mm = force / way;
}

void fg_load_find_loops(const fg_load_test *test, const fg_load_strokes *strokes,
                        fg_load_direction *direction) {
  const fg_load_sample *samples = test->samples + direction->first;
  loops all = find_loops(samples, strokes, direction);
  double travel, u_area;
  direction->area = direction->loss = direction->loss_secant = (fg_load_value){NAN, NAN, NAN};
  find_secant(samples, strokes, direction, &travel);
  if (!(all.single.count > 0)) return;
  double mean = mean_area(&all, &u_area);
  direction->area = (fg_load_value){mean, NAN, u_area};
  if (mean < -gained_reach * direction->area.u_repeat) direction->flags |= FG_LOAD_WRONG_WAY;
  double k = direction->stiffness.value, half = travel / 2;
  direction->loss.value = mean / (M_PI * k * half * half);
  direction->loss_secant.value = mean / (M_PI * direction->secant_n_mm * half * half);
}
