/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <stdio.h>
#include <string.h>

#include "cli/commands.h"

/* Kinds of foil that the built-in design can have. */
static const struct {
  const char *name;
  fg_foil_kind kind;
} kinds[] = {
    {"classical", FG_FOIL_CLASSICAL}, {"sinusoidal", FG_FOIL_SINUSOIDAL}, {"discs", FG_FOIL_DISCS}};

enum { KINDS = sizeof kinds / sizeof *kinds };

void fg_cli_write_usages(FILE *out) {
  for (size_t i = 0; i < KINDS; i++)
    fprintf(out, "%s%s", i == 0 ? "" : i + 1 < KINDS ? ", " : " or ", kinds[i].name);
}

fg_status fg_cli_apply_forming(fg_context *ctx, const char *kind, fg_design *design) {
  if (kind && !strcmp(kind, "arc"))
    return fg_fail(ctx, FG_ERR_USAGE,
                   "--form: an arc has no built-in design; state it in a file: --design F with "
                   "\"form\": \"arc\", overall_radius_mm, subtended_angle_deg, thickness_mm");
  if (kind && !strcmp(kind, "cantilever"))
    return fg_fail(ctx, FG_ERR_USAGE,
                   "--form: a cantilever has no built-in design; state it in a file: --design F "
                   "with \"form\": \"cantilever\", beam_length_mm, beam_width_mm, thickness_mm");
  if (!kind) return FG_OK;
  for (size_t i = 0; i < KINDS; i++) {
    if (strcmp(kind, kinds[i].name) != 0) continue;
    design->kind = kinds[i].kind;
    return FG_OK;
  }
  return fg_fail(ctx, FG_ERR_USAGE, "--form: '%s' is none of classical, sinusoidal, discs", kind);
}
