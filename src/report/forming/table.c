/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A forming, and a fit, for the terminal. */
#include <math.h>

#include "core/file.h"
#include "foilgauge/words.h"
#include "report/forming/members.h"

enum { LINE = 100 };

static void put_column(FILE *out, double value, int width, int decimals, const char *after) {
  if (isfinite(value))
    fprintf(out, "%*.*f%s", width, decimals, value, after);
  else
    fprintf(out, "%*s%s", width, "-", after);
}

/* Words broken between words. */
static void put_words(FILE *out, const char *text) {
  int column = 0;
  fputs("\n  ", out);
  for (const char *c = text; *c; c++) {
    bool turn = *c == ' ' && column > LINE - 16;
    fputs(turn ? "\n  " : (char[]){*c, '\0'}, out);
    column = turn ? 0 : column + 1;
  }
  fputc('\n', out);
}

fg_status fg_forming_write_text(fg_context *ctx, const fg_forming *f, FILE *out) {
  char notes[FG_FORMING_NOTES][FG_FORMING_NOTE], treatment[200];
  fg_forming_treatment(f, treatment, sizeof treatment);
  fprintf(out, "design %s, form %s; die %s%s; %s\n%s\n\n", f->design.name,
          fg_foil_kind_word(f->design.kind), f->options.die ? "as measured, " : "",
          fg_forming_shape_word(f->options.shape), treatment, f->material.name);
  fputs("  overall radius, strip integrated  ", out);
  put_column(out, f->overall_radius_mm, 10, 4, " mm   ");
  put_column(out, f->springback_error_pct, 8, 2, " %\n");
  fputs("  the lands alone, a plain strip    ", out);
  put_column(out, f->strip_radius_mm, 10, 4, " mm   ");
  put_column(out, f->strip_springback_error_pct, 8, 2, " %\n");
  fprintf(out, "  moment that is left (rho)         %10.4f\n", f->mean_share);
  fprintf(out, "  stress at the face, mean          %10.0f MPa bent, %.0f heated, %.0f free\n",
          f->mean_stress_mpa[0], f->mean_stress_mpa[1], f->mean_stress_mpa[2]);
  if (f->bump_count) {
    fputc('\n', out);
    fg_members_terminal(out, "  ", &fg_forming_bump_members, &(fg_subject){.object = f, .whole = f},
                        fg_forming_bump_at);
  }
  size_t count = fg_forming_notes(f, notes);
  for (size_t i = 0; i < count; i++)
    put_words(out, notes[i]);
  return fg_stream_finish(ctx, out, "the table");
}

static void put_found(FILE *out, const fg_forming_fit *fit) {
  char words[80];
  for (size_t k = 0; k < fit->free; k++) {
    const fg_forming_found *found = &fit->found[k];
    const fg_forming_constant_row *row = fg_forming_constant_of(found->constant);
    fg_forming_found_words(found, words, sizeof words);
    fprintf(out, "  %-24s %12.5g %-8s %s%s\n", row->name, found->value, row->unit,
            found->at_bound ? "" : "95 %: ", words);
  }
}

fg_status fg_forming_fit_write_text(fg_context *ctx, const fg_forming_fit *fit, FILE *out) {
  char notes[FG_FORMING_NOTES][FG_FORMING_NOTE];
  fprintf(out, "%zu runs, %s of %s\n\n", fit->runs, fit->response_name,
          fit->response == FG_FORMING_OF_FOIL ? "the whole foil" : "a plain strip");
  put_found(out, fit);
  fputc('\n', out);
  fg_members_terminal(out, "  ", &fg_forming_run_members,
                      &(fg_subject){.object = fit, .whole = fit}, fg_forming_run_at);
  size_t count = fg_forming_fit_notes(fit, notes);
  for (size_t i = 0; i < count; i++)
    put_words(out, notes[i]);
  return fg_stream_finish(ctx, out, "the table");
}
