/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/known.h"

#include <argp.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/traceability.h"

static void read_tone(struct argp_state *state, const char *text, fg_cli_known *known) {
  bool linear = !strcmp(text, "linear");
  if (!linear && strcmp(text, "unknown") != 0)
    argp_error(state, "--tone: '%s' is none of linear, unknown", text);
  known->tone_given = true;
  known->tone = linear ? FG_TONE_LINEAR : FG_TONE_UNKNOWN;
}

/* Skips "±", "+-" or ":" behind a value. NULL: there is none. */
static const char *skip_separator(const char *text) {
  static const char *const separators[] = {"±", "+-", ":"};
  for (size_t i = 0; i < sizeof separators / sizeof *separators; i++)
    if (!strncmp(text, separators[i], strlen(separators[i]))) return text + strlen(separators[i]);
  return NULL;
}

static void read_thickness(struct argp_state *state, const char *text, fg_cli_known *known) {
  char *end;
  known->thickness_mm = strtod(text, &end);
  const char *rest = end == text ? NULL : skip_separator(end);
  if (rest) known->u_thickness_mm = strtod(rest, &end);
  if (!rest || end == rest || *end || !isfinite(known->thickness_mm) ||
      !(known->thickness_mm > 0) || !isfinite(known->u_thickness_mm) ||
      !(known->u_thickness_mm > 0))
    argp_error(state,
               "--thickness-measured: '%s' is no thickness with its standard uncertainty, both "
               "above 0 and in mm, as 0.1003±0.0005 or 0.1003:0.0005",
               text);
}

bool fg_cli_parse_known(struct argp_state *state, int key, const char *text, fg_cli_known *known) {
  if (key == FG_CLI_TONE)
    read_tone(state, text, known);
  else if (key == FG_CLI_THICKNESS)
    read_thickness(state, text, known);
  else if (key == FG_CLI_FLATBED)
    known->flatbed = true;
  else
    return false;
  return true;
}

/* A calibration that the design states is better known. */
fg_status fg_cli_apply_flatbed(fg_context *ctx, bool flatbed, fg_design *design) {
  if (!flatbed) return FG_OK;
  if (design->calibration.stated)
    return fg_fail(ctx, FG_ERR_USAGE,
                   "--flatbed is for a scanner of which nothing is known: the design states a "
                   "calibration");
  design->calibration = fg_calibration_of_flatbed();
  return FG_OK;
}

void fg_cli_note_scale(const fg_design *design) {
  if (design->tolerance_count && !fg_design_may_judge(design))
    fprintf(
        stderr,
        "foilgauge: note: nothing is known of the scanner's scale, and no limit is judged. %s\n",
        fg_traceability_cure);
}

void fg_cli_apply_known(const fg_cli_known *known, fg_design *design) {
  if (known->tone_given) {
    if (design->tone == FG_TONE_LINEAR && known->tone == FG_TONE_UNKNOWN)
      fputs("foilgauge: note: --tone overrules the design's tone, linear\n", stderr);
    design->tone = known->tone;
  }
  if (!(known->thickness_mm > 0)) return;
  double stated = design->thickness_measured_mm;
  if (stated > 0 &&
      (stated != known->thickness_mm || design->u_thickness_measured_mm != known->u_thickness_mm))
    fprintf(stderr,
            "foilgauge: note: --thickness-measured %g overrules the design's thickness_measured, "
            "%g mm\n",
            known->thickness_mm, stated);
  design->thickness_measured_mm = known->thickness_mm;
  design->u_thickness_measured_mm = known->u_thickness_mm;
}
