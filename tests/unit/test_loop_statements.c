/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One place decides what the loop on scans says: every statement of its JSON stands on its page and
 * in its text. Rendered scans, and what a loop on other data could have come to. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/spread.h"
#include "foilgauge/render.h"
#include "report/scan_loop/parts.h"
#include "scan_loop/state.h"
#include "scan_loop/verdict.h"
#include "support/test.h"

#define SCANNER                                                                                    \
  "\"scanner\":{\"dpi\":1200,\"background\":30,\"contrast\":175,\"blur_px\":1.3,\"noise\":1.2},"
#define FOIL                                                                                       \
  "{\"schema\":\"foilgauge/render/1\",\"seed\":3,\"foils\":[{\"overall_radius_mm\":20.95,"         \
  "\"radius_mm\":[3.34,3.41,3.36,3.44,3.38,3.35,3.42,3.37,3.40],\"rotate_deg\":-75}]," SCANNER     \
  "\"effects\":["
#define RING                                                                                       \
  "{\"schema\":\"foilgauge/render/1\",\"seed\":3,\"discs\":[{\"centre_mm\":[7,7],\"radius_mm\":6}" \
  "]," SCANNER "\"effects\":["
#define SCALE "{\"id\":\"scan.scale_y\",\"value\":0.002}]}"
#define FAINT "{\"id\":\"scan.scale_y\",\"value\":0.0001}]}"

typedef fg_status loop_writer(fg_context *ctx, const fg_scan_loop *loop, FILE *out);

static fg_scan_loop *run_loop(const char *spec_json, fg_foil_kind kind) {
  char path[] = "/tmp/foilgauge_statements_XXXXXX.png";
  const char *paths[] = {path};
  fg_context ctx = {0};
  fg_render_spec *spec;
  fg_scan_loop *loop = NULL;
  fg_design design;
  const fg_scan_loop_options options = {.seed = 1};
  close(mkstemps(path, 4));
  if (fg_render_parse(&ctx, "spec", spec_json, &spec) != FG_OK) fail_msg("%s", ctx.message);
  if (fg_render_scan(&ctx, spec, path, NULL) != FG_OK) fail_msg("%s", ctx.message);
  fg_render_free(spec);
  fg_design_default(&design);
  assert_ok(&ctx, fg_design_become(&ctx, kind, &design));
  const fg_scan_loop_scans scans = {paths, (bool[]){false}, 1};
  if (fg_scan_loop_run(&ctx, &scans, &design, &options, &loop) != FG_OK)
    fail_msg("%s", ctx.message);
  unlink(path);
  return loop;
}

static void write_file(const fg_scan_loop *loop, loop_writer *writer, const char *path) {
  fg_context ctx = {0};
  FILE *out = fopen(path, "w");
  assert_non_null(out);
  if (writer(&ctx, loop, out) != FG_OK) fail_msg("%s", ctx.message);
  fclose(out);
}

static void assert_consistent(fg_scan_loop *loop, const char *what) {
  static const char *const names[] = {"json", "html", "txt"};
  loop_writer *const writers[] = {fg_scan_loop_write_json, fg_scan_loop_write_html,
                                  fg_scan_loop_write_text};
  char folder[] = "/tmp/foilgauge_statements_XXXXXX", path[3][64], command[400];
  assert_non_null(mkdtemp(folder));
  fg_context ctx = {0};
  assert_ok(&ctx, fg_scan_loop_decide(&ctx, loop));
  for (int i = 0; i < 3; i++) {
    snprintf(path[i], sizeof path[i], "%s/%s", folder, names[i]);
    write_file(loop, writers[i], path[i]);
  }
  snprintf(command, sizeof command, "python3 tests/support/loop_statements.py %s %s %s", path[0],
           path[1], path[2]);
  int status = system(command);
  for (int i = 0; i < 3; i++)
    unlink(path[i]);
  rmdir(folder);
  if (WEXITSTATUS(status) == 127) skip();
  if (status != 0) fail_msg("%s: JSON, page and text do not say the same", what);
}

static const char *advice_of(const fg_scan_loop *loop, size_t i) {
  assert_true(i < loop->result.advices);
  return loop->result.advice[i];
}

static void assert_summary_says(const fg_scan_loop *loop, const char *words) {
  char *summary = NULL;
  assert_ok(&test_context, fg_scan_loop_sentence(&test_context, &loop->result, &summary));
  assert_has(summary, words);
  free(summary);
}

static void statements_on_a_foil_agree(void **state) {
  (void)state;
  fg_scan_loop *loop = run_loop(FOIL FAINT, FG_FOIL_CLASSICAL);
  assert_consistent(loop, "a tie on one scan");
  assert_int_equal(loop->result.advices, 1);
  assert_has(advice_of(loop, 0), "--same-foil");
  loop->scale_tied = true;
  assert_consistent(loop, "a scale that the edges cannot see");
  assert_has(advice_of(loop, 1), "gauge of known diameter");
  loop->options.same_foil = true;
  assert_consistent(loop, "a tie on several scans of a foil");
  assert_has(advice_of(loop, 0), "another foil");
  loop->explanations.count = 1;
  loop->scale_tied = loop->tied = false;
  assert_consistent(loop, "no tie");
  assert_int_equal(loop->result.advices, 0);
  assert_ok(&test_context, fg_scan_loop_bumps_note(&test_context, &loop->bumps, "a <note> & more"));
  loop->error_before.held_out_rms = 1.5;
  loop->error_after.held_out_rms = 0.2;
  assert_consistent(loop, "a note, and a scan kept aside");
  assert_summary_says(loop, " falls from 1.5 µm to 0.2 µm.");
  loop->error_after.held_out_rms = 1.5001;
  assert_consistent(loop, "an error that does not change");
  assert_summary_says(loop, " it stays at 1.5 µm.");
  fg_scan_loop_free(loop);
}

static void statements_on_a_clean_foil_agree(void **state) {
  (void)state;
  fg_scan_loop *loop = run_loop(FOIL "]}", FG_FOIL_CLASSICAL);
  assert_int_equal(loop->verdict, FG_LOOP_CLEAN);
  assert_consistent(loop, "a clean scan");
  assert_int_equal(loop->result.advices, 0);
  fg_scan_loop_free(loop);
}

/* A disc does not show how far it was turned: no advice to turn one. */
static void statements_on_a_ring_agree(void **state) {
  (void)state;
  fg_scan_loop *loop = run_loop(RING SCALE, FG_FOIL_DISCS);
  assert_consistent(loop, "a tie in a ring");
  assert_int_equal(loop->result.advices, 1);
  assert_has(advice_of(loop, 0), "plate of several gauges");
  fg_search_bars *bars = &loop->explanations.barred;
  fg_search_barred *barred = &bars->each[bars->count++];
  *barred = (fg_search_barred){
      .effect = fg_effect_find("scan.row_step"), .would_explain = 0.3, .share = 0.8};
  barred->smallest_um = NAN;
  assert_consistent(loop, "an effect that is not confirmed");
  const fg_scan_result_unclaimed *last = &loop->result.unclaimed[loop->result.unclaimeds - 1];
  assert_true(last->barred);
  assert_int_equal(last->verdict, FG_LOOP_INCONCLUSIVE);
  fg_scan_loop_free(loop);
}

/* Errors have one definition on tables and on scans. */
static void sizes_are_summed_up_in_one_way(void **state) {
  (void)state;
  double even[] = {4, 1, 3, 2}, hundred[100];
  fg_spread spread = fg_spread_of(even, 4);
  assert_true(fabs(spread.robust_sd - 1.4826 * 2.5) < 1e-12);
  for (int i = 0; i < 100; i++)
    hundred[i] = (37 * i) % 100;
  spread = fg_spread_of(hundred, 100);
  assert_true(fabs(spread.robust_sd - 1.4826 * 49.5) < 1e-12);
  assert_true(spread.p95 == 94 && spread.maximum == 99);
  spread = fg_spread_of(hundred, 0);
  assert_true(isnan(spread.robust_sd) && isnan(spread.p95) && isnan(spread.maximum));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(statements_on_a_foil_agree),
      cmocka_unit_test(statements_on_a_clean_foil_agree),
      cmocka_unit_test(statements_on_a_ring_agree),
      cmocka_unit_test(sizes_are_summed_up_in_one_way),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
