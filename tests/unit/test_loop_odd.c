/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whatever foils and discs the loop on scans gets: an error in words, or a result whose every
 * number is finite or null, with a verdict, uncertainties that are none below 0, and reports that
 * keep to their schema. Made without pictures (support/odd_scan.h). */
#include <stdio.h>

#include <cjson/cJSON.h>
#include <sys/wait.h>
#include <unistd.h>

#include "scan_loop/state.h"
#include "support/brief.h"
#include "support/odd_scan.h"
#include "support/test.h"

enum { SKIPPED = 77, FILES = 400, DRAWN = 32, BYTES = 96 };

static struct {
  char folder[64];
  size_t files, errors;
} kept;

/* ---- what must hold ---- */

static void check_numbers(const cJSON *item, const char *what) {
  if (cJSON_IsNumber(item) && !isfinite(item->valuedouble))
    fail_msg("%s: %s is not finite", what, item->string ? item->string : "an element");
  for (const cJSON *child = item->child; child; child = child->next)
    check_numbers(child, what);
}

static void check_claims(const cJSON *report, const char *what) {
  const cJSON *claim, *u;
  cJSON_ArrayForEach(claim, cJSON_GetObjectItem(report, "claims")) {
    cJSON_ArrayForEach(u, cJSON_GetObjectItem(claim, "uncertainty")) {
      if (cJSON_IsNumber(u) && !(u->valuedouble >= 0))
        fail_msg("%s: uncertainty of %s is %g", what, u->string, u->valuedouble);
    }
  }
}

static void check_verdict(const cJSON *report, const char *what) {
  static const char *const words[] = {"clean", "explained", "partly explained", "unattributed"};
  const char *verdict = cJSON_GetStringValue(cJSON_GetObjectItem(report, "verdict"));
  for (size_t i = 0; i < sizeof words / sizeof *words; i++)
    if (verdict && !strcmp(verdict, words[i])) return;
  fail_msg("%s: the verdict is %s", what, verdict ? verdict : "missing");
}

/* For the schema, which is asked once over all. */
static void keep(const char *text) {
  char path[128];
  assert_true(kept.files < FILES);
  snprintf(path, sizeof path, "%s/%zu.json", kept.folder, kept.files++);
  FILE *out = fopen(path, "w");
  assert_non_null(out);
  fputs(text, out);
  fclose(out);
}

typedef fg_status writer(fg_context *ctx, const fg_scan_loop *loop, FILE *out);

/* The text of a report; the caller frees it. */
static char *written(const fg_scan_loop *loop, writer *write) {
  fg_context ctx = {0};
  char *text = NULL;
  size_t size;
  FILE *out = open_memstream(&text, &size);
  assert_non_null(out);
  assert_ok(&ctx, write(&ctx, loop, out));
  fclose(out);
  return text;
}

static void check_reports(const fg_scan_loop *loop, const char *what) {
  char *json = written(loop, fg_scan_loop_write_json);
  cJSON *report = cJSON_Parse(json);
  if (!report) fail_msg("%s: the report is no JSON", what);
  check_numbers(report, what);
  check_verdict(report, what);
  check_claims(report, what);
  cJSON_Delete(report);
  keep(json);
  free(json);
  free(written(loop, fg_scan_loop_write_text));
  free(written(loop, fg_scan_loop_write_html));
}

/* A model is refused in words, or can be read again. */
static void check_model(const fg_scan_loop *loop, const char *what) {
  fg_context ctx = {0};
  fg_scanner_model *model = NULL;
  char *text = NULL;
  size_t size;
  FILE *out = open_memstream(&text, &size);
  assert_non_null(out);
  fg_status status = fg_scan_loop_write_model(&ctx, loop, out);
  fclose(out);
  if (status != FG_OK && !ctx.message[0]) fail_msg("%s: no words for a model refused", what);
  if (status == FG_OK && fg_scanner_model_parse(&ctx, "model", text, &model) != FG_OK)
    fail_msg("%s: %s", what, ctx.message);
  fg_scanner_model_free(model);
  free(text);
}

static fg_status close_loop(const odd_input *in, bool coarse, fg_context *ctx,
                            fg_scan_loop **loop) {
  fg_measurement measurements[ODD_SCANS] = {0};
  bool hold_out[ODD_SCANS];
  odd_measure(in, measurements);
  for (size_t i = 0; i < in->scans; i++)
    hold_out[i] = in->scan[i].hold_out;
  const fg_scan_loop_options options = {
      .threads = 1, .same_foil = in->same_foil, .coarse = coarse, .seed = 1};
  return fg_scan_loop_run_measured(ctx, measurements, hold_out, in->scans, &options, loop);
}

/* Returns the status. */
static fg_status check(const odd_input *in, bool coarse, const char *what) {
  fg_context ctx = {0};
  fg_scan_loop *loop = NULL;
  fg_status status = close_loop(in, coarse, &ctx, &loop);
  if (getenv("ODD_TALK"))
    fprintf(stderr, "%s: %s\n", what,
            status == FG_OK ? fg_loop_outcome_word(loop->verdict) : ctx.message);
  if (status == FG_OK) {
    if (loop->error_after.rms > 1.1 * loop->error_before.rms)
      fail_msg("%s: %g um before, %g um after", what, loop->error_before.rms,
               loop->error_after.rms);
    check_reports(loop, what);
    check_model(loop, what);
  } else {
    kept.errors++;
    if (!ctx.message[0]) fail_msg("%s: an error without words", what);
  }
  fg_scan_loop_free(loop);
  return status;
}

/* ---- foils ---- */

static odd_input one_foil(int bumps) {
  odd_input in = {.scans = 1};
  fg_design_default(&in.design);
  in.scan[0].foils = 1;
  in.scan[0].foil[0] = odd_plain_foil(bumps);
  in.scan[0].foil[0].step_mm = 0.05;
  return in;
}

static void foils_of_one_to_forty_bumps(void **state) {
  static const int bumps[] = {1, 2, 3, 5, 9, 20, 40};
  (void)state;
  for (size_t i = 0; i < sizeof bumps / sizeof *bumps; i += test_step(3)) {
    char what[64];
    odd_input in = one_foil(bumps[i]);
    snprintf(what, sizeof what, "%d bumps", bumps[i]);
    if (bumps[i] > 30) in.scan[0].foil[0].pitch_deg = 8.5;
    check(&in, true, what);
  }
}

static void a_plain_foil_is_clean(void **state) {
  (void)state;
  fg_context ctx = {0};
  fg_scan_loop *loop = NULL;
  odd_input in = one_foil(9);
  assert_ok(NULL, close_loop(&in, false, &ctx, &loop));
  assert_int_equal(loop->set.count, 0);
  assert_true(loop->explanations.right);
  check_reports(loop, "a plain foil");
  fg_scan_loop_free(loop);
}

static void bumps_and_lands_that_are_missing(void **state) {
  static const int missing[] = {1, 2, 0x10, 0x1e, 0xaa, 0x1fe, 0x1ff};
  (void)state;
  for (size_t i = 0; i < sizeof missing / sizeof *missing; i += test_step(3)) {
    in_row("missing[%zu]", i);
    char what[64];
    odd_input in = one_foil(9);
    in.scan[0].foil[0].missing = missing[i];
    snprintf(what, sizeof what, "bumps %x missing", (unsigned)missing[i]);
    check(&in, true, what);
  }
  for (int share = 1; share <= 10; share += 3) {
    char what[64];
    odd_input in = one_foil(5);
    in.scan[0].foil[0].chord = 0.1 * share;
    snprintf(what, sizeof what, "bumps over %d tenths of the pitch", share);
    check(&in, true, what);
  }
}

static void edges_with_faults_are_searched(void **state) {
  (void)state;
  for (unsigned fault = 1; fault <= ODD_SPIKES; fault *= 2) {
    char what[64];
    odd_input in = one_foil(5);
    in.scan[0].foil[0].faults = fault;
    snprintf(what, sizeof what, "fault %u", fault);
    check(&in, true, what);
    in.scan[0].foils = 2;
    in.scan[0].foil[1] = odd_plain_foil(5);
    in.scan[0].foil[1].y_mm = 30;
    snprintf(what, sizeof what, "fault %u beside a sound foil", fault);
    check(&in, true, what);
  }
}

static void any_noise_is_searched(void **state) {
  static const double noise[] = {0, 1e-6, 1e-3, 5, 50};
  (void)state;
  for (size_t i = 0; i < sizeof noise / sizeof *noise; i += test_step(2)) {
    in_row("noise[%zu]", i);
    char what[64];
    odd_input in = one_foil(5);
    in.scan[0].foil[0].noise_um = noise[i];
    snprintf(what, sizeof what, "noise of %g um", noise[i]);
    check(&in, true, what);
    in.scan[0].scanner.ripple_um = 8;
    in.scan[0].scanner.period_mm = 2.7;
    snprintf(what, sizeof what, "noise of %g um and a ripple", noise[i]);
    check(&in, true, what);
  }
}

static void few_rows(void **state) {
  (void)state;
  for (double step = 0.1; step < 1; step *= 1.3) {
    char what[64];
    odd_input in = one_foil(2);
    in.scan[0].foil[0].step_mm = step;
    snprintf(what, sizeof what, "stations %g mm apart", step);
    check(&in, true, what);
  }
}

static odd_input two_scans(int bumps, bool same_foil) {
  odd_input in = one_foil(bumps);
  in.scans = 2;
  in.same_foil = same_foil;
  in.scan[1] = in.scan[0];
  in.scan[1].foil[0].turn_deg = 0;
  in.scan[1].foil[0].seed = 2;
  in.scan[0].foil[1] = in.scan[1].foil[1] = odd_plain_foil(bumps);
  in.scan[0].foil[1].seed = 3;
  in.scan[1].foil[1].seed = 4;
  return in;
}

static void scans_of_one_foil_and_of_several(void **state) {
  (void)state;
  for (int same = 0; same < 2; same++) {
    odd_input in = two_scans(5, same);
    assert_ok(NULL, check(&in, true, "a foil twice, turned"));
    in.scan[1].foil[0] = in.scan[0].foil[0];
    assert_ok(NULL, check(&in, true, "a foil twice, the same edges"));
    in.scan[1].hold_out = true;
    check(&in, true, "a foil kept aside");
    in.scan[0].foil[0].faults = ODD_UNMEASURED;
    assert_int_not_equal(check(&in, true, "only a foil kept aside"), FG_OK);
    in = two_scans(5, same);
    in.scan[1].foil[0].bumps = 4;
    check(&in, true, "foils of 5 and 4 bumps");
    in.scan[1].foils = 2;
    in.scan[1].foil[1] = odd_plain_foil(3);
    check(&in, true, "one foil and two");
    in = two_scans(3, same);
    in.scan[0].foils = in.scan[1].foils = 2;
    in.scan[1].foil[0].faults = ODD_UNMEASURED;
    check(&in, true, "one of four foils not measured");
  }
}

static void scanners_far_out_of_line(void **state) {
  static const odd_scanner scanners[] = {{.scale = 0.006},
                                         {.shear = 0.006},
                                         {.scale = -5},
                                         {.step_um = 500, .step_mm = 8},
                                         {.bend_um = 4000},
                                         {.ripple_um = 200, .period_mm = 0.4},
                                         {.ripple_um = 30, .period_mm = 900}};
  (void)state;
  for (size_t i = 0; i < sizeof scanners / sizeof *scanners; i += test_step(4))
    for (int same = 0; same < 2; same++) {
      char what[64];
      odd_input in = two_scans(4, same);
      snprintf(what, sizeof what, "scanner %zu", i);
      in.scan[0].scanner = in.scan[1].scanner = scanners[i];
      check(&in, true, what);
    }
}

/* ---- discs ---- */

static odd_input plate(size_t discs, bool one_size, bool in_line) {
  odd_input in = {.scans = 1};
  fg_design_default(&in.design);
  assert_int_equal(fg_design_become(NULL, FG_FOIL_DISCS, &in.design), FG_OK);
  in.scan[0].discs = discs;
  for (size_t d = 0; d < discs; d++)
    in.scan[0].disc[d] = (odd_disc){.x_mm = 3 + 5 * (double)(d % 7),
                                    .y_mm = in_line ? 10 : 3 + 6 * (double)(d / 7),
                                    .radius_mm = one_size ? 1 : 0.5 + 0.05 * (double)d,
                                    .noise_um = 0.3,
                                    .stations = 96,
                                    .seed = d + 1};
  return in;
}

static void plates(void **state) {
  static const size_t counts[] = {1, 2, 3, 7, ODD_DISCS};
  (void)state;
  for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
    for (int kind = 0; kind < (counts[i] == ODD_DISCS ? 1 : 4); kind += (int)test_step(3)) {
      char what[64];
      odd_input in = plate(counts[i], kind & 1, kind & 2);
      snprintf(what, sizeof what, "%zu discs of kind %d", counts[i], kind);
      in.scan[0].scanner.scale = 0.001;
      check(&in, true, what);
    }
}

static void discs_with_faults_are_searched(void **state) {
  (void)state;
  for (unsigned fault = 1; fault <= ODD_SPIKES; fault *= 2) {
    char what[64];
    odd_input in = plate(4, false, false);
    in.scan[0].disc[1].faults = fault;
    snprintf(what, sizeof what, "a disc with fault %u", fault);
    check(&in, true, what);
    for (size_t d = 0; d < 4; d++)
      in.scan[0].disc[d].faults = fault;
    snprintf(what, sizeof what, "discs with fault %u", fault);
    check(&in, true, what);
  }
  odd_input in = plate(5, false, false);
  for (size_t d = 0; d < 5; d++)
    in.scan[0].disc[d].noise_um = 0;
  check(&in, true, "discs without noise");
  in.design.discs.count = 2;
  in.design.discs.diameters_mm[0] = in.design.discs.diameters_mm[1] = 1;
  check(&in, true, "discs without noise, two diameters known");
  in = plate(3, true, true);
  for (size_t d = 0; d < 3; d++)
    in.scan[0].disc[d].x_mm = 9;
  check(&in, true, "one disc three times");
}

static void foils_and_discs_do_not_mix(void **state) {
  (void)state;
  odd_input in = plate(3, false, false);
  fg_design_default(&in.design);
  in.scan[0].foils = 1;
  in.scan[0].foil[0] = odd_plain_foil(3);
  assert_status(NULL, check(&in, true, "a foil and discs"), FG_ERR_DATA);
}

/* ---- anything ---- */

static void drawn_from_bytes(void **state) {
  (void)state;
  for (uint64_t draw = 1; draw <= DRAWN; draw += test_step(8)) {
    static odd_input in;
    uint8_t bytes[BYTES];
    char what[64];
    uint64_t seed = draw;
    for (size_t i = 0; i < BYTES; i++)
      bytes[i] = (uint8_t)(256 * random_uniform(&seed));
    odd_read(bytes, BYTES, &in);
    snprintf(what, sizeof what, "draw %zu", (size_t)draw);
    check(&in, true, what);
  }
}

static void reports_keep_to_their_schema(void **state) {
  char command[512];
  (void)state;
  print_message("%zu results, %zu errors in words\n", kept.files, kept.errors);
  assert_true(kept.files > 60);
  snprintf(
      command, sizeof command,
      "python3 tests/support/validate_schema.py reports/schema loop_scan.schema.json %s/*.json",
      kept.folder);
  int status = system(command);
  assert_true(WIFEXITED(status));
  if (WEXITSTATUS(status) == SKIPPED || WEXITSTATUS(status) == 127) skip();
  assert_int_equal(WEXITSTATUS(status), 0);
}

static int open_folder(void **state) {
  (void)state;
  snprintf(kept.folder, sizeof kept.folder, "/tmp/foilgauge-odd-XXXXXX");
  return mkdtemp(kept.folder) ? 0 : -1;
}

static int remove_folder(void **state) {
  char path[128];
  (void)state;
  for (size_t i = 0; i < kept.files; i++) {
    snprintf(path, sizeof path, "%s/%zu.json", kept.folder, i);
    unlink(path);
  }
  return rmdir(kept.folder);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(foils_of_one_to_forty_bumps),
      cmocka_unit_test(a_plain_foil_is_clean),
      cmocka_unit_test(bumps_and_lands_that_are_missing),
      cmocka_unit_test(edges_with_faults_are_searched),
      cmocka_unit_test(any_noise_is_searched),
      cmocka_unit_test(few_rows),
      cmocka_unit_test(scans_of_one_foil_and_of_several),
      cmocka_unit_test(scanners_far_out_of_line),
      cmocka_unit_test(plates),
      cmocka_unit_test(discs_with_faults_are_searched),
      cmocka_unit_test(foils_and_discs_do_not_mix),
      cmocka_unit_test(drawn_from_bytes),
      cmocka_unit_test(reports_keep_to_their_schema),
  };
  return cmocka_run_group_tests(tests, open_folder, remove_folder);
}
