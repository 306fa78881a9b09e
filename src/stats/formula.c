/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text forms of a parsed formula and of its terms. */
#include "foilgauge/formula.h"

#include <stdlib.h>

#include "core/text.h"

void fg_formula_free(fg_formula *formula) {
  if (!formula) return;
  for (size_t i = 0; i < formula->variables; i++) {
    free(formula->variable[i].column);
    free(formula->variable[i].name);
  }
  free(formula->term);
  free(formula->response);
  *formula = (fg_formula){0};
}

fg_status fg_formula_term_name(fg_context *ctx, const fg_formula *formula, const fg_term *term,
                               char **name) {
  *name = NULL;
  for (size_t i = 0; i < formula->variables; i++) {
    if (!term->power[i]) continue;
    FG_TRY(fg_text_append(ctx, name, "%s%s", *name ? ":" : "", formula->variable[i].name));
    if (term->power[i] > 1) FG_TRY(fg_text_append(ctx, name, "^%u", (unsigned)term->power[i]));
  }
  return *name ? FG_OK : fg_text_append(ctx, name, "(constant)");
}

fg_status fg_formula_format(fg_context *ctx, const fg_formula *formula, char **text) {
  *text = NULL;
  FG_TRY(fg_text_append(ctx, text, formula->constant ? "1" : "0"));
  for (size_t i = 0; i < formula->terms; i++) {
    char *name = NULL;
    fg_status status = fg_formula_term_name(ctx, formula, &formula->term[i], &name);
    if (status == FG_OK) status = fg_text_append(ctx, text, " + %s", name);
    free(name);
    FG_TRY(status);
  }
  return FG_OK;
}
