#include <stdio.h>
#include <string.h>

#include "cli/commands.h"

/* Forms whose design can be the built-in one. */
static const struct {
  const char *name;
  fg_form form;
} forms[] = {
    {"classical", FG_FORM_CLASSICAL}, {"sinusoidal", FG_FORM_SINUSOIDAL}, {"discs", FG_FORM_DISCS}};

enum { FORMS = sizeof forms / sizeof *forms };

void fg_cli_write_forms(FILE *out) {
  for (size_t i = 0; i < FORMS; i++)
    fprintf(out, "%s%s", i == 0 ? "" : i + 1 < FORMS ? ", " : " or ", forms[i].name);
}

fg_status fg_cli_apply_form(fg_context *ctx, const char *form, fg_design *design) {
  if (form && !strcmp(form, "arc"))
    return fg_fail(ctx, FG_ERR_USAGE,
                   "--form: an arc has no built-in design; state it in a file: --design F with "
                   "\"form\": \"arc\", overall_radius_mm, subtended_angle_deg, thickness_mm");
  if (form && !strcmp(form, "cantilever"))
    return fg_fail(ctx, FG_ERR_USAGE,
                   "--form: a cantilever has no built-in design; state it in a file: --design F "
                   "with \"form\": \"cantilever\", beam_length_mm, beam_width_mm, thickness_mm");
  if (!form) return FG_OK;
  for (size_t i = 0; i < FORMS; i++) {
    if (strcmp(form, forms[i].name) != 0) continue;
    design->form = forms[i].form;
    return FG_OK;
  }
  return fg_fail(ctx, FG_ERR_USAGE, "--form: '%s' is none of classical, sinusoidal, discs", form);
}
