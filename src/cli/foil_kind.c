/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <stdio.h>
#include <string.h>

#include "cli/known.h"
#include "foilgauge/foil_kind.h"

void fg_cli_write_foil_kinds(FILE *out) {
  char list[200];
  fg_foil_kind_list(true, "", " or ", list, sizeof list);
  fputs(list, out);
}

/* "overall_radius_mm, subtended_angle_deg, thickness_mm" */
static void list_needed(const fg_foil_traits *traits, char *text, size_t size) {
  text[0] = 0;
  for (size_t i = 0; traits->needed[i]; i++) {
    size_t used = strlen(text);
    snprintf(text + used, size - used, "%s%s", i ? ", " : "", traits->needed[i]);
  }
}

fg_status fg_cli_apply_foil_kind(fg_context *ctx, const char *name, fg_design *design) {
  fg_foil_kind kind;
  char list[300];
  if (!name) return FG_OK;
  if (!fg_foil_kind_find(name, &kind)) {
    fg_foil_kind_list(true, "", ", ", list, sizeof list);
    return fg_fail(ctx, FG_ERR_USAGE, "--form: '%s' is none of %s", name, list);
  }
  const fg_foil_traits *traits = fg_foil_traits_of(kind);
  list_needed(traits, list, sizeof list);
  if (!traits->built_in)
    return fg_fail(ctx, FG_ERR_USAGE,
                   "--form: %s has no built-in design; state it in a file: --design F with "
                   "\"form\": \"%s\", %s",
                   traits->noun, name, list);
  return fg_design_become(ctx, kind, design);
}
