/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/scan_loop/bumps.h"

#include <math.h>

static void text_claim(const fg_scan_result_response *response,
                       const fg_scan_result_bump_claim *claim, FILE *out) {
  fprintf(out, "  %s %s of %s over the bumps:", claim->verdict == FG_LOOP_TIED ? "tied " : "found",
          claim->id, response->name);
  for (size_t i = 0; i < claim->parameters; i++)
    fprintf(out, " %s %.4g +- %.2g", claim->parameter_name[i], claim->parameter[i],
            2 * claim->parameter_u[i]);
  for (size_t i = 0; i < claim->ties; i++)
    fprintf(out, "%s %s", i ? "," : " (or", claim->tied[i].name);
  fputs(claim->ties ? ")\n" : "\n", out);
}

void fg_text_bumps(const fg_scan_result_bumps *bumps, FILE *out) {
  if (bumps->declared_path)
    fprintf(out,
            "  bumps: declared is what %s (foilgauge forming) predicts of each by its number\n",
            bumps->declared_path);
  for (size_t r = 0; r < FG_SCAN_RESULT_RESPONSES; r++) {
    const fg_scan_result_response *one = &bumps->response[r];
    for (size_t m = 0; m < one->claims; m++)
      text_claim(one, &one->claim[m], out);
    if (one->judged)
      fprintf(out, "  bumps: %s about %s: %.3g %s before, %.3g %s after\n", one->name, one->model,
              one->error.rms[0], one->unit, one->error.rms[1], one->unit);
    if (isfinite(one->level))
      fprintf(out, "  bumps: %s measured minus declared is %+.3g +- %.2g %s on average\n",
              one->name, one->level, 2 * one->u_level, one->unit);
  }
  if (bumps->curve)
    fprintf(out, "  unattributed, over the bump's number: %s\n", bumps->curve->name);
}

static void text_rejected(const fg_scan_result_response *response,
                          const fg_scan_result_bump_unclaimed *one, FILE *out) {
  fprintf(out, "  %s: %s of %s over the bumps", fg_loop_verdict_word(one->verdict), one->id,
          response->name);
  if (isfinite(one->smallest))
    fprintf(out, ", would have shown from %.3g %s", one->smallest, response->unit);
  fputc('\n', out);
}

void fg_text_bumps_rejected(const fg_scan_result_bumps *bumps, FILE *out) {
  for (size_t r = 0; r < FG_SCAN_RESULT_RESPONSES; r++)
    for (size_t k = 0; k < bumps->response[r].unclaimeds; k++)
      text_rejected(&bumps->response[r], &bumps->response[r].unclaimed[k], out);
}
