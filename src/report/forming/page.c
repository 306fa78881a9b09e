/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pages of a forming and of a fit. */
#include <math.h>
#include <stdio.h>

#include "core/file.h"
#include "foilgauge/words.h"
#include "page/page.h"
#include "page/table.h"
#include "page/tile.h"
#include "report/forming/members.h"
#include "report/forming/plots.h"
#include "report/provenance.h"

static void put_forming_tiles(FILE *out, const fg_forming *f) {
  double sum = 0;
  for (size_t i = 0; i < f->bump_count; i++)
    sum += f->bumps[i].fitted.radius_error_pct / (double)f->bump_count;
  const fg_tile tiles[] = {
      {"Overall springback", .value = f->springback_error_pct, .decimals = 2, .unit = "%",
       .small = "100 (R0 - R) / R0: below 0 the foil opens"},
      {f->bump_count ? "Bump radius error, mean" : NULL, .value = sum, .decimals = 2, .unit = "%",
       .small = "fitted circles"},
      {"The lands alone", .value = f->strip_springback_error_pct, .decimals = 2, .unit = "%",
       .small = "as a plain strip of the overall radius"},
      {"Moment that is left", .value = f->mean_share, .decimals = 3, .unit = "",
       .small = "rho, over the strip"},
      {"Mean stress, bent", .value = f->mean_stress_mpa[FG_FORMING_BENT], .unit = "MPa",
       .small = "at the face"},
      {"Mean stress, free", .value = f->mean_stress_mpa[FG_FORMING_FREE], .unit = "MPa",
       .small = "at the face"},
  };
  fg_html_tiles(out, "tiles", tiles, sizeof tiles / sizeof *tiles);
}

static void put_notes(FILE *out, char notes[FG_FORMING_NOTES][FG_FORMING_NOTE], size_t count) {
  fputs("<ul class=\"words\">\n", out);
  for (size_t i = 0; i < count; i++) {
    fputs("<li>", out);
    fg_html_text(out, notes[i]);
    fputs("</li>\n", out);
  }
  fputs("</ul>\n", out);
}

static void put_material(FILE *out, const fg_forming_material *m) {
  fputs("<h2>Material: ", out);
  fg_html_text(out, m->name);
  fputs("</h2>\n<div class=\"scroll\"><table>\n<tr><th>constant</th><th>value</th><th "
        "class=\"w\">source</th></tr>\n",
        out);
  for (int c = 0; c < FG_FORMING_CONSTANTS; c++) {
    const fg_forming_constant_row *row = fg_forming_constant_of((fg_forming_constant)c);
    fprintf(out, "<tr><td>%s, %s</td><td>%.5g %s</td><td class=\"words\">", row->words, row->symbol,
            m->value[c], row->unit);
    fg_html_text(out, m->source[c]);
    fputs("</td></tr>\n", out);
  }
  fputs("<tr><td>yield and hardening, share</td><td>", out);
  for (size_t i = 0; i < m->curve_count; i++)
    fprintf(out, "%s%.4g at %g °C", i ? "<br>" : "", m->curve_share[i], m->curve_temperature_C[i]);
  fputs("</td><td class=\"words\">", out);
  fg_html_text(out, m->curve_source);
  fputs("</td></tr>\n</table></div>\n", out);
}

static void put_summary(FILE *out, const fg_forming *f) {
  char treatment[200], notes[FG_FORMING_NOTES][FG_FORMING_NOTE];
  fg_forming_treatment(f, treatment, sizeof treatment);
  fputs("<section>\n<header><h1>Forming of ", out);
  fg_html_text(out, f->design.name);
  fprintf(out, "</h1><p>%s; die %s%s</p></header>\n<p class=\"say\">",
          fg_foil_kind_word(f->design.kind), f->options.die ? "as measured, " : "as designed, ",
          fg_forming_shape_word(f->options.shape));
  fg_html_text(out, treatment);
  fputs(".</p>\n", out);
  put_forming_tiles(out, f);
  put_notes(out, notes, fg_forming_notes(f, notes));
  fputs("</section>\n", out);
}

static void put_strip(FILE *out, const fg_forming *f) {
  fputs("<section>\n<h2 class=\"first\">Along the strip</h2>\n<figure>", out);
  fg_forming_plot_curvature(out, f);
  fputs("<figcaption>Curvature of the midline; above 0 it bends as the lands do. Fillets reach "
        "beyond the plot.</figcaption></figure>\n<figure>",
        out);
  fg_forming_plot_stress(out, f);
  fputs("<figcaption>Stress along the strip in the fibre that a curvature above 0 stretches; what "
        "is left when free has no moment.</figcaption></figure>\n</section>\n",
        out);
}

/* Files that were read beside the design, each with the row that it has. */
typedef struct origin {
  const char *title;
  const fg_forming_file *file;
} origin;

static fg_status put_origin(fg_context *ctx, FILE *out, const fg_design *design,
                            const origin *origins, size_t count) {
  fg_provenance from = {.design = design};
  for (size_t i = 0; i < count; i++)
    if (origins[i].file->path[0]) fg_provenance_include_file(&from, origins[i].file->path);
  fputs("<section>\n<h2 class=\"first\">Where it comes from</h2>\n<dl class=\"facts\">\n", out);
  FG_TRY(fg_html_provenance(ctx, out, &from));
  for (size_t i = 0; i < count; i++) {
    const fg_forming_file *file = origins[i].file;
    if (!file->path[0]) continue;
    fprintf(out, "<dt>%s</dt><dd>", origins[i].title);
    fg_html_text(out, file->path);
    if (file->sha256[0]) fprintf(out, ", SHA-256 %.12s…", file->sha256);
    fputs("</dd>\n", out);
  }
  fputs("</dl>\n</section>\n", out);
  return FG_OK;
}

fg_status fg_forming_write_html(fg_context *ctx, const fg_forming *forming, FILE *out) {
  char title[120];
  snprintf(title, sizeof title, "Forming of %s", forming->design.name);
  fg_html_begin(out, title);
  put_summary(out, forming);
  put_strip(out, forming);
  fputs("<section>\n", out);
  if (forming->bump_count) {
    fputs("<h2 class=\"first\">The bumps</h2>\n<figure>", out);
    fg_forming_plot_errors(out, forming);
    fputs("<figcaption>Errors against the design of the free strip's circles, fitted as "
          "<code>measure</code> fits them.</figcaption></figure>\n",
          out);
    fg_html_table(out, &fg_forming_bump_members, &(fg_subject){.object = forming, .whole = forming},
                  fg_forming_bump_at);
  }
  put_material(out, &forming->material);
  fprintf(out,
          "<p class=\"note\">Bent flat to kappa_d in plane strain, %zu layers over half the "
          "thickness; Norton creep; released elastically: kappa_f = kappa_d - rho M / (E' "
          "I).</p>\n</section>\n",
          forming->options.layers);
  const origin origins[] = {{"Material", &forming->material.file},
                            {"Schedule", &forming->schedule.file},
                            {"Die", &forming->die.file}};
  FG_TRY(put_origin(ctx, out, &forming->design, origins, sizeof origins / sizeof *origins));
  fg_html_end(out);
  return fg_stream_finish(ctx, out, "the page");
}

/* ---- a fit ---- */

fg_status fg_forming_fit_write_html(fg_context *ctx, const fg_forming_fit *fit, FILE *out) {
  char notes[FG_FORMING_NOTES][FG_FORMING_NOTE];
  fg_html_begin(out, "Constants of forming");
  fprintf(out, "<section>\n<header><h1>Constants of forming</h1><p>from %zu runs</p></header>\n",
          fit->runs);
  put_notes(out, notes, fg_forming_fit_notes(fit, notes));
  const fg_subject all = {.object = fit, .whole = fit};
  fg_html_table(out, &fg_forming_found_members, &all, fg_forming_found_at);
  fputs("<figure>", out);
  fg_forming_plot_fit(out, fit);
  fputs("<figcaption>Each run as the model has it, and as it has it from the other runs "
        "alone.</figcaption></figure>\n",
        out);
  fg_html_table(out, &fg_forming_run_members, &all, fg_forming_run_at);
  fputs("</section>\n<section>\n", out);
  put_material(out, &fit->material);
  fputs("</section>\n", out);
  const origin origins[] = {{"Runs", &fit->file}, {"Material", &fit->material.file}};
  FG_TRY(put_origin(ctx, out, &fit->design, origins, sizeof origins / sizeof *origins));
  fg_html_end(out);
  return fg_stream_finish(ctx, out, "the page");
}
