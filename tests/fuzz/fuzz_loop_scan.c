/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From bytes to a few small foils and discs (support/odd_scan.h), through rows, search and
 * correction to every report, the scanner's model and back. */
#include <stdio.h>

#include "../support/odd_scan.h"
#include "foilgauge/scan_loop.h"
#include "fuzz.h"
#include "scan_loop/state.h"

/* A written model must be read again. */
static void check_model(const fg_scan_loop *loop) {
  fg_context ctx = {0};
  char *text = NULL;
  size_t size = 0;
  fg_scanner_model *model = NULL;
  FILE *out = open_memstream(&text, &size);
  if (!out) return;
  fg_status status = fg_scan_loop_write_model(&ctx, loop, out);
  fclose(out);
  if (status == FG_OK && fg_scanner_model_parse(&ctx, "model", text, &model) != FG_OK) {
    fprintf(stderr, "%s\n%s\n", ctx.message, text);
    abort();
  }
  fg_scanner_model_free(model);
  free(text);
}

static void write_reports(const fg_scan_loop *loop) {
  fg_context ctx = {0};
  FILE *out = fopen("/dev/null", "w");
  if (!out) return;
  (void)fg_scan_loop_write_json(&ctx, loop, out);
  (void)fg_scan_loop_write_text(&ctx, loop, out);
  (void)fg_scan_loop_write_html(&ctx, loop, out);
  fclose(out);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static odd_input input;
  fg_context ctx = {0};
  fg_measurement measurements[ODD_SCANS] = {0};
  bool hold_out[ODD_SCANS];
  fg_scan_loop *loop = NULL;
  odd_read(data, size, &input);
  odd_measure(&input, measurements);
  for (size_t i = 0; i < input.scans; i++)
    hold_out[i] = input.scan[i].hold_out;
  const fg_scan_loop_options options = {
      .threads = 1, .same_foil = input.same_foil, .coarse = true, .seed = 1};
  if (fg_scan_loop_run_measured(&ctx, measurements, hold_out, input.scans, &options, &loop) !=
      FG_OK) {
    if (getenv("ODD_TALK")) puts(ctx.message);
    return 0;
  }
  if (getenv("ODD_TALK")) fg_scan_loop_write_text(&ctx, loop, stdout);
  write_reports(loop);
  check_model(loop);
  fg_scan_loop_free(loop);
  return 0;
}
