/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loop on scans with factors on the expectations before they are seen: sizes of causes, and
 * their probabilities. Writes the report as JSON. See loop_priors.py.
 *
 * loop_priors SIZE WEIGHT DPI OUT SCAN [SCAN]: two scans are of one foil. */
#include <stdlib.h>
#include <string.h>

#include "foilgauge/design.h"
#include "foilgauge/scan_loop.h"

enum { SCANS_MAX = 2, FIRST_SCAN = 5 };

static fg_status run(fg_context *ctx, const fg_scan_loop_options *options, const char *out,
                     const char *const *paths, size_t count) {
  const bool hold_out[SCANS_MAX] = {false, false};
  fg_design design;
  fg_scan_loop *loop = NULL;
  fg_design_default(&design);
  const fg_scan_loop_scans scans = {paths, hold_out, count};
  fg_status status = fg_scan_loop_run(ctx, &scans, &design, options, &loop);
  if (status != FG_OK) return status;
  FILE *file = fopen(out, "w");
  status = file ? fg_scan_loop_write_json(ctx, loop, file) : FG_ERR_IO;
  if (file && fclose(file)) status = FG_ERR_IO;
  fg_scan_loop_free(loop);
  return status;
}

int main(int argc, char **argv) {
  fg_context ctx = {0};
  size_t count = argc > FIRST_SCAN ? (size_t)argc - FIRST_SCAN : 0;
  if (!count || count > SCANS_MAX) {
    fputs("usage: loop_priors SIZE WEIGHT DPI OUT SCAN [SCAN]\n", stderr);
    return 64;
  }
  const fg_scan_loop_options options = {.prior_size = atof(argv[1]),
                                        .prior_weight = atof(argv[2]),
                                        .dpi = atof(argv[3]),
                                        .threads = 1,
                                        .same_foil = count > 1,
                                        .seed = 1};
  fg_status status = run(&ctx, &options, argv[4], (const char *const *)argv + FIRST_SCAN, count);
  if (status != FG_OK) fprintf(stderr, "loop_priors: %s\n", ctx.message);
  return status == FG_OK ? 0 : 1;
}
