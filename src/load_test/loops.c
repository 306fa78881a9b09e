/* The area of the loops and what it says of damping. */
#include <math.h>

#include "load_test/analysis.h"

/* Ends of a loop that lie nearer to each other than this share of the travel close it. */
static const double close_share = 0.05;

/* Loops give energy where their area is below zero by more than U = 2 u. */
static const double gained_reach = 2;

/* Samples about a turning point whose mean is its force. */
enum { TURN_SAMPLES = 9 };

typedef struct loops {
  double sum, squares, count; /* of their areas */
  double noise;               /* variance of one by the samples' scatter */
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

static void add_loop(const fg_load_sample *s, const fg_load_direction *direction, size_t first,
                     size_t last, double variance, loops *all) {
  if (fabs(s[last].x_mm - s[first].x_mm) > close_share * direction->travel_mm) return;
  double area = polygon(s, first, last), noise = 0;
  for (size_t i = first + 1; i < last; i++)
    noise += variance * pow((s[i + 1].x_mm - s[i - 1].x_mm) / 2, 2);
  all->sum += area;
  all->squares += area * area;
  all->count++;
  all->noise = noise;
}

static double mean_variance(const fg_load_strokes *strokes) {
  double sum = 0, count = 0;
  for (size_t i = 0; i < strokes->count; i++)
    for (size_t k = 0; k < strokes->stroke[i].count; k += 8, count++)
      sum += strokes->stroke[i].variance[k];
  return sum / count;
}

static loops find_loops(const fg_load_sample *samples, const fg_load_strokes *strokes,
                        const fg_load_direction *direction) {
  loops all = {0};
  double variance = mean_variance(strokes);
  for (size_t i = 0; i + 1 < strokes->count; i++)
    if (strokes->stroke[i].last == strokes->stroke[i + 1].first &&
        strokes->stroke[i].record == strokes->stroke[i + 1].record)
      add_loop(samples, direction, strokes->stroke[i].first, strokes->stroke[i + 1].last, variance,
               &all);
  /* One cycle from the middle back to the middle has no turning point twice. */
  if (!all.count && strokes->count)
    add_loop(samples, direction, strokes->stroke[0].first, strokes->stroke[strokes->count - 1].last,
             variance, &all);
  return all;
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
    double reach = s->x[s->count - 1] - s->x[0];
    if (reach < (1 - 2 * close_share) * direction->travel_mm) continue;
    way += reach;
    force += s->sense * (force_about(samples, direction->count, s->last) -
                         force_about(samples, direction->count, s->first));
    count++;
  }
  *travel = count ? way / count : NAN;
  direction->secant_n_mm = force / way;
}

void fg_load_find_loops(const fg_load_test *test, const fg_load_strokes *strokes,
                        fg_load_direction *direction) {
  const fg_load_sample *samples = test->samples + direction->first;
  loops all = find_loops(samples, strokes, direction);
  double travel, n = all.count, mean = all.sum / n;
  direction->area = direction->loss = direction->loss_secant = (fg_load_value){NAN, NAN, NAN};
  find_secant(samples, strokes, direction, &travel);
  if (!(n > 0)) return;
  /* Loops that follow each other share a stroke. */
  double apart = (n + 1) / 2;
  double scatter = n > 1 ? fmax(0, (all.squares - n * mean * mean) / (n - 1)) / apart : 0;
  direction->area = (fg_load_value){mean, NAN, sqrt(fmax(scatter, all.noise / apart))};
  if (mean < -gained_reach * direction->area.u_repeat) direction->flags |= FG_LOAD_WRONG_WAY;
  double k = direction->stiffness.value, half = travel / 2;
  double u = hypot(direction->area.u_repeat / mean, direction->stiffness.u_repeat / k);
  double loss = mean / (M_PI * k * half * half);
  direction->loss = (fg_load_value){loss, fabs(loss) * u, fabs(loss) * u};
  loss = mean / (M_PI * direction->secant_n_mm * half * half);
  u = direction->area.u_repeat / fabs(mean);
  direction->loss_secant = (fg_load_value){loss, fabs(loss) * u, fabs(loss) * u};
}
