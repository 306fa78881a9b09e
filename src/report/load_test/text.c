/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Load-displacement tests for the terminal. */
#include <math.h>

#include "core/file.h"
#include "foilgauge/load_report.h"
#include "report/load_test/members.h"
#include "report/verdict_members.h"

static void put_break_away(FILE *out, const fg_load_test *test, const fg_load_bearing *b) {
  char flags[1200];
  const fg_break_away *a = &b->break_away;
  if (!a->pulls) return;
  fprintf(out, "  break-away: %zu pull%s at %zu dead weight%s of %g to %g N\n", a->pulls,
          a->pulls == 1 ? "" : "s", a->weights, a->weights == 1 ? "" : "s", a->weight_low_n,
          a->weight_high_n);
  if (isfinite(a->friction.value))
    fprintf(out, "  friction coefficient %.4f, U %.4f; without a weight %.3f N, U %.3f\n",
            a->friction.value, 2 * a->friction.u, a->intercept_n.value, 2 * a->intercept_n.u);
  if (isfinite(b->preload_n.value))
    fprintf(out, "  preload %.2f N, U %.2f: %.3f kPa, U %.3f, over pi %g x %g mm\n",
            b->preload_n.value, 2 * b->preload_n.u, b->preload_kpa.value, 2 * b->preload_kpa.u,
            test->options.diameter_mm, test->options.length_mm);
  fg_break_away_flag_words(a->flags, true, flags, sizeof flags);
  if (flags[0]) fprintf(out, "  %s\n", flags);
}

static void put_bearing(FILE *out, const fg_load_test *test, size_t bearing) {
  const fg_load_bearing *b = &test->bearings[bearing];
  fprintf(out, "\nbearing %s", b->name);
  if (b->directions)
    fprintf(out, ", %zu azimuth%s\n", b->directions, b->directions == 1 ? "" : "s");
  else
    fputs(", break-away test alone\n", out);
  if (b->directions) {
    const fg_subject list = fg_load_bearing_subject(test, bearing);
    fg_members_terminal(out, "  ", &fg_load_direction_members, &list, fg_load_direction_of_bearing);
  }
  if (b->measured > 1)
    fprintf(out, "  clearance %.2f to %.2f um, mean %.2f, U %.2f\n", 1000 * b->min.value,
            1000 * b->max.value, 1000 * b->mean_mm, 2000 * b->u_mean_mm);
  if (b->axis == FG_LOAD_AXIS_KNOWN)
    fprintf(out, "  smallest along the axis %.1f and %.1f degrees, U %.1f\n", b->min_at_deg,
            b->min_at_deg + 180, 2 * b->u_min_at_deg);
  else if (b->measured > 1)
    fprintf(out, "  no axis of the smallest clearance: %s\n", fg_load_axis_words(b->axis));
  if (isfinite(b->noise_n)) {
    fprintf(out, "  noise of a sample %.3g N and %.2g um", b->noise_n, 1000 * b->noise_mm);
    if (b->step_mm > b->noise_mm)
      fprintf(out, ", which was recorded in steps of %.3g um", 1000 * b->step_mm);
    fputc('\n', out);
  }
  if (isfinite(b->hysteresis_n.value))
    fprintf(out, "  radial hysteresis %.3f N, U %.3f, and %.4f |F|\n", b->hysteresis_n.value,
            2 * b->hysteresis_n.u, b->slope);
  put_break_away(out, test, b);
}

fg_status fg_load_write_text(fg_context *ctx, const fg_load_test *test, FILE *out) {
  char words[300];
  fg_report_outcome outcome;
  fg_load_judge(test, &outcome, words, sizeof words);
  fprintf(out, "%s: %s\n", fg_verdict_phrase(outcome.verdict), words);
  for (size_t i = 0; i < test->bearing_count; i++)
    put_bearing(out, test, i);
  fprintf(
      out,
      "\nU = 2 u; instruments %g %% of force and %g %% of displacement, together %.2f %% of a "
      "stiffness; K: largest stiffness up to 1 %% of the travel (10 times the noise) before the "
      "turn, a foil that hardens is stiffer beyond; loss of the test: loop area / (pi K X2), "
      "secant: of the loop's ends; foil: energy lost in its compression / (2 pi elastic work)\n",
      test->options.u_force_pct, test->options.u_displacement_pct,
      hypot(test->options.u_force_pct, test->options.u_displacement_pct));
  for (size_t i = 0; i < test->file_count; i++)
    if (test->files[i].not_read)
      fprintf(out, "%s: not read: %s\n", test->files[i].path, test->files[i].not_read);
  return fg_stream_finish(ctx, out, "the table");
}
