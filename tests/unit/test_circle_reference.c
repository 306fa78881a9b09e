/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Circle fits against certified answers: NIST's reference pairs and literature sets recomputed in
 * 50-digit arithmetic. */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/circle.h"
#include "support/random.h"
#include "support/test.h"

enum { POINTS_MAX = 600 };

static FILE *open_reference(const char *name) {
  char path[200];
  snprintf(path, sizeof path, "tests/data/%s", name);
  return fopen(path, "r");
}

static size_t read_nist(int number, double points[][3], double fit[7]) {
  char name[64];
  size_t count = 0;
  snprintf(name, sizeof name, "nist_circle2d/cir2d%d.ds", number);
  FILE *file = open_reference(name);
  assert_non_null(file);
  assert_int_equal(fscanf(file, "%zu", &count), 1);
  assert_in_range(count, 3, POINTS_MAX);
  for (size_t i = 0; i < count; i++)
    for (int k = 0; k < 3; k++)
      assert_int_equal(fscanf(file, "%lf", &points[i][k]), 1);
  fclose(file);
  snprintf(name, sizeof name, "nist_circle2d/cir2d%d.fit", number);
  file = open_reference(name);
  assert_non_null(file);
  for (int k = 0; k < 7; k++)
    assert_int_equal(fscanf(file, "%lf", &fit[k]), 1);
  fclose(file);
  return count;
}

/* The file holds the diameter; the circle's plane is the one whose normal is a coordinate axis. */
static void nist_pair(int number) {
  static double space[POINTS_MAX][3];
  double answer[7], far = 0;
  size_t count = read_nist(number, space, answer);
  int normal = fabs(answer[3]) > 0.5 ? 0 : fabs(answer[4]) > 0.5 ? 1 : 2;
  int first = (normal + 1) % 3, second = (normal + 2) % 3;
  fg_point points[POINTS_MAX];
  for (size_t i = 0; i < count; i++) {
    points[i] = (fg_point){space[i][first], space[i][second]};
    far = fmax(far, fmax(fabs(points[i].x), fabs(points[i].y)));
  }
  fg_circle_fit fit;
  assert_ok(&test_context, fg_circle_fit_geometric(&test_context, points, NULL, count, NULL, &fit));
  double worst = fmax(fmax(fabs(fit.circle.x - answer[first]), fabs(fit.circle.y - answer[second])),
                      fabs(fit.circle.radius - answer[6] / 2));
  if (!(worst <= 1e-12 * far)) fail_msg("cir2d%d: off by %.2g of %.3g", number, worst, far);
}

static void all_nist_pairs(void **state) {
  (void)state;
  for (int number = 1; number <= 30; number++)
    nist_pair(number);
}

typedef struct literature_set {
  char name[128];
  fg_point points[32];
  size_t count;
  fg_circle circle;
  double sse;
} literature_set;

/* "name","x y;x y;...",a,b,R,SSE */
static bool parse_set(char *line, literature_set *set) {
  char *name = strtok(line, "\""), *comma = strtok(NULL, "\""), *points = strtok(NULL, "\"");
  char *answer = strtok(NULL, "\"");
  if (!comma || !answer) return false;
  snprintf(set->name, sizeof set->name, "%s", name);
  set->count = 0;
  for (char *end; *points; points = *end == ';' ? end + 1 : end) {
    fg_point *point = &set->points[set->count++];
    point->x = strtod(points, &end);
    point->y = strtod(end, &end);
    assert_in_range(set->count, 1, 32);
  }
  return sscanf(answer, ",%lf,%lf,%lf,%lf", &set->circle.x, &set->circle.y, &set->circle.radius,
                &set->sse) == 4;
}

static void check_set(const literature_set *set, const fg_circle *start) {
  fg_circle_fit fit;
  assert_ok(&test_context,
            fg_circle_fit_geometric(&test_context, set->points, NULL, set->count, start, &fit));
  double worst = fmax(fmax(fabs(fit.circle.x - set->circle.x), fabs(fit.circle.y - set->circle.y)),
                      fabs(fit.circle.radius - set->circle.radius));
  if (!(worst <= 2e-12 * set->circle.radius))
    fail_msg("%s: off by %.2g relative", set->name, worst / set->circle.radius);
  double sse = fit.rms * fit.rms * (double)set->count;
  assert_true(fabs(sse - set->sse) <= 1e-12 * set->sse);
}

/* Centres up to 10^6 away in any direction, radii from 10^-3 to 10^6. */
static void literature_sets_from_bad_starts(void **state) {
  (void)state;
  char line[1024];
  int sets = 0;
  uint64_t seed = 20240611;
  FILE *file = open_reference("circle_small/geometric_fits_50digit.csv");
  assert_non_null(file);
  while (fgets(line, sizeof line, file)) {
    literature_set set;
    if (line[0] != '"') continue;
    assert_true(parse_set(line, &set));
    check_set(&set, NULL);
    for (int i = 0; i < 300; i++) {
      double far = pow(10, -1 + 7 * random_uniform(&seed)),
             angle = 6.2831853 * random_uniform(&seed);
      fg_circle start = {far * cos(angle), far * sin(angle),
                         pow(10, -3 + 9 * random_uniform(&seed))};
      check_set(&set, &start);
    }
    sets++;
  }
  fclose(file);
  assert_int_equal(sets, 4);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(all_nist_pairs),
      cmocka_unit_test(literature_sets_from_bad_starts),
  };
  return cmocka_run_group_tests_name("circle reference", tests, NULL, NULL);
}
