/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Error and power of a lot's comparison of groups, over lots with known truth. Writes a table in
 * Markdown. build/bench/lot_groups [LOTS] >reports/lot_groups.md */
#include "foilgauge/distribution.h"
#include "support/group_lots.h"

static const char *const test_words[FG_LOT_GROUP_TESTS] = {"means", "F", "Levene", "within"};

typedef struct scenario {
  const char *words;
  group_kind kind;
  bool fixed; /* one lot, relabelled */
} scenario;

static const scenario null_lots[] = {
    {"new lots, 7 and 7 foils", {7, 0.02, 0, 0, 0, 1}, false},
    {"new lots, 7 and 7 foils, places differ, 0 to 3 bumps missing",
     {7, 0.02, 0.01, 3, 0, 1},
     false},
    {"new lots, 4 and 10 foils, places differ, 0 to 3 bumps missing",
     {4, 0.02, 0.01, 3, 0, 1},
     false},
    {"new lots, foils alike: all scatter is of bumps", {7, 0, 0, 0, 0, 1}, false},
    {"one lot relabelled, 7 and 7 foils", {7, 0.02, 0, 0, 0, 1}, true},
    {"one lot relabelled, places differ, 0 to 3 bumps missing", {7, 0.02, 0.01, 3, 0, 1}, true},
    {"one lot relabelled, one foil five times as far out", {7, 0.02, 0, 0, 0, 5}, true},
};

typedef struct score {
  size_t below[FG_LOT_GROUP_TESTS], family, bumps, foil_means, holm_means;
} score;

/* As if bumps were independent, and Student's t of the plain means of foils. */
static void score_plain(const group_lot *g, score *s) {
  double value[GROUP_FOILS * GROUP_BUMPS], mean[GROUP_FOILS] = {0};
  size_t count = 0, first = 0;
  fg_comparison c;
  for (size_t i = 0; i < GROUP_FOILS; i++) {
    const fg_foil *foil = &g->lot.records[i].foils[0];
    if (i == g->first) first = count;
    for (size_t k = 0; k < foil->bump_count; k++) {
      value[count++] = foil->bumps[k].radius_mm;
      mean[i] += foil->bumps[k].radius_mm / (double)foil->bump_count;
    }
  }
  assert_ok(&test_context,
            fg_comparison_compute(&test_context, (fg_sample){value, first},
                                  (fg_sample){value + first, count - first}, 0.95, &c));
  s->bumps += c.p_means < 0.05;
  const fg_sample a = {mean, g->first}, b = {mean + g->first, GROUP_FOILS - g->first};
  assert_ok(&test_context, fg_comparison_compute(&test_context, a, b, 0.95, &c));
  double pooled = 0, centre[2] = {0, 0}, n[2] = {(double)a.count, (double)b.count};
  for (size_t i = 0; i < GROUP_FOILS; i++)
    centre[i >= g->first] += mean[i] / n[i >= g->first];
  for (size_t i = 0; i < GROUP_FOILS; i++)
    pooled += pow(mean[i] - centre[i >= g->first], 2) / (GROUP_FOILS - 2);
  double t = (centre[0] - centre[1]) / sqrt(pooled * (1 / n[0] + 1 / n[1]));
  s->foil_means += fg_distribution_t_two_sided(t, GROUP_FOILS - 2) < 0.05;
}

static score run(const scenario *one, size_t lots, uint64_t seed) {
  fg_design design;
  group_lot g;
  score s = {0};
  fg_design_default(&design);
  group_lot_make(&design, one->kind.first, &g);
  for (size_t i = 0; i < lots; i++) {
    if (one->fixed && i)
      group_lot_relabel(&seed, &g);
    else
      group_lot_draw(&one->kind, &seed, &g);
    const fg_lot_difference *radius = group_lot_compare(&g);
    for (size_t t = 0; t < FG_LOT_GROUP_TESTS; t++)
      s.below[t] += radius->p[t] < 0.05;
    s.holm_means += radius->p_holm[FG_LOT_TEST_MEANS] < 0.05;
    s.family += g.analysis.group_tests_differ > 0;
    score_plain(&g, &s);
  }
  group_lot_free(&g);
  return s;
}

static double percent(size_t part, size_t all) {
  return 100 * (double)part / (double)all;
}

static void write_null(size_t lots) {
  printf("## No difference: how often p < 0.05, %%\n\n| lots of 14 foils, 9 bumps |");
  for (size_t t = 0; t < FG_LOT_GROUP_TESTS; t++)
    printf(" %s |", test_words[t]);
  printf(
      " any test of the page, Holm | bumps as if independent |\n|---|---|---|---|---|---|---|\n");
  for (size_t i = 0; i < sizeof null_lots / sizeof *null_lots; i++) {
    score s = run(&null_lots[i], lots, 100 + i);
    printf("| %s |", null_lots[i].words);
    for (size_t t = 0; t < FG_LOT_GROUP_TESTS; t++)
      printf(" %.1f |", percent(s.below[t], lots));
    printf(" %.1f | %.1f |\n", percent(s.family, lots), percent(s.bumps, lots));
    fflush(stdout);
  }
}

static void write_power(size_t lots) {
  static const double shifts[] = {0.5, 1, 1.5, 2, 3};
  printf(
      "\n## A difference between the groups: how often it is found, %%\n\n| planted, sd of foils | "
      "bumps missing | means, p < 0.05 | Student's t of plain foil means | means, Holm over the "
      "page |\n|---|---|---|---|---|\n");
  for (size_t k = 0; k < sizeof shifts / sizeof *shifts; k++)
    for (size_t missing = 0; missing <= 3; missing += 3) {
      const scenario one = {"", {7, 0.02, missing ? 0.01 : 0, missing, 0.02 * shifts[k], 1}, false};
      score s = run(&one, lots, 200 + 10 * k + missing);
      printf("| %.1f | %s | %.1f | %.1f | %.1f |\n", shifts[k], missing ? "0 to 3" : "none",
             percent(s.below[FG_LOT_TEST_MEANS], lots), percent(s.foil_means, lots),
             percent(s.holm_means, lots));
      fflush(stdout);
    }
}

int main(int count, char **words) {
  size_t lots = count > 1 ? strtoul(words[1], NULL, 10) : 3000;
  printf(
      "# Groups of a lot: error and power\n\n`build/bench/lot_groups %zu >reports/lot_groups.md`: "
      "lots of known truth, radius of the bumps. Foils differ by 0.02 mm (sd), bumps within a "
      "foil by %.2f mm, places by 0.01 mm from one to the next where they differ.\n\n",
      lots, group_bump_sd_mm);
  printf("Means: Welch's test of the foils' levels. F and Levene: of the foils' levels, by "
         "relabelling. Within: the spread of bumps within a foil. The last column is what a test "
         "of the bumps, taken as independent, would say of the same lots.\n\n");
  write_null(lots);
  write_power(lots);
  return 0;
}
