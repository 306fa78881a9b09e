/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scans that are said to show one foil: two foils are told from one, and what a scanner or a part
 * does to one foil is no other foil. Made without pictures (support/odd_scan.h). */
#include <stdio.h>

#include "scan_loop/state.h"
#include "support/brief.h"
#include "support/odd_scan.h"
#include "support/test.h"

/* One foil of six bumps on two scans, turned by `turn_deg` in between. */
static odd_input pair(double turn_deg, uint64_t seed) {
  odd_input in = {.scans = 2, .same_foil = true};
  fg_design_default(&in.design);
  in.scan[0].foils = 1;
  in.scan[0].foil[0] = odd_plain_foil(6);
  in.scan[0].foil[0].step_mm = 0.05;
  in.scan[0].foil[0].seed = 2 * seed;
  in.scan[1] = in.scan[0];
  in.scan[1].foil[0].turn_deg += turn_deg;
  in.scan[1].foil[0].seed = 2 * seed + 1;
  return in;
}

static fg_status close_loop(const odd_input *in, fg_context *ctx) {
  static const bool none[ODD_SCANS] = {false};
  fg_measurement measurements[ODD_SCANS] = {0};
  fg_scan_loop *loop = NULL;
  const fg_scan_loop_options options = {.threads = 1, .same_foil = true, .seed = 1};
  odd_measure(in, measurements);
  fg_status status = fg_scan_loop_run_measured(ctx, measurements, none, in->scans, &options, &loop);
  fg_scan_loop_free(loop);
  return status;
}

/* Radii differ by up to 20 um, the uncertainty of one is far below. */
static void two_clean_foils_are_not_one(void **state) {
  (void)state;
  fg_context ctx = {0};
  odd_input in = pair(90, 1);
  in.scan[1].foil[0].spread += 0.006;
  assert_status(NULL, close_loop(&in, &ctx), FG_ERR_DATA);
  assert_has(ctx.message, "not of one foil");
  assert_has(ctx.message, "bump ");
}

static void one_foil_is_one_whatever_is_done_to_it(void **state) {
  static const odd_scanner scanners[] = {{.scale = 0.006}, {.ripple_um = 7, .period_mm = 2.7}};
  (void)state;
  for (size_t i = 0; i < sizeof scanners / sizeof *scanners; i += test_step(2)) {
    fg_context ctx = {0};
    odd_input in = pair(90, i + 1);
    in.scan[0].scanner = in.scan[1].scanner = scanners[i];
    if (close_loop(&in, &ctx) != FG_OK) fail_msg("scanner %zu: %s", i, ctx.message);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(two_clean_foils_are_not_one),
      cmocka_unit_test(one_foil_is_one_whatever_is_done_to_it),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
