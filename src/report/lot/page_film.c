/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A lot's page: the gas film of bearings drawn from its foils, and the rotor's threshold. */
#include <math.h>

#include "page/page.h"
#include "page/table.h"
#include "report/film/members.h"
#include "report/lot/page_parts.h"

static void put_film_conditions(FILE *out, const fg_film_report *film) {
  char drawn[200];
  fg_film_draws_words(film, drawn, sizeof drawn);
  fprintf(out,
          "<p class=\"note\">%.4g N, %.0f rpm, a rotor of %.4g kg on the bearing; C %.4g µm, "
          "compliance %.3g, loss factor %.3g.</p>\n<p class=\"note\">",
          film->options.load_n, film->options.speed_rpm, film->options.rotor_mass_kg,
          film->clearance_um, film->compliance, film->options.loss_factor);
  fg_html_text(out, drawn);
  fputs("</p>\n", out);
}

static void put_film_statements(FILE *out, const fg_film_report *film) {
  char tolerance[FG_FILM_NOTE];
  const fg_film_draws *draws = &film->draws;
  fg_film_tolerance_words(film, tolerance, sizeof tolerance);
  fputs("<ul class=\"said\">\n", out);
  if (isfinite(film->tolerance.threshold_rpm))
    fprintf(out,
            "<li>Of the bearings drawn from this lot %.0f %% (95 %%: %.0f to %.0f %%) keep the "
            "threshold speed within %g %% of that as designed, and %.0f %% do not fall below it by "
            "more.</li>\n",
            100 * draws->within.share, 100 * draws->within.low, 100 * draws->within.high,
            film->options.within_pct, 100 * draws->not_lower.share);
  fputs("<li>", out);
  fg_html_text(out, tolerance);
  fputs("</li>\n</ul>\n", out);
}

void fg_lot_put_film(FILE *out, const fg_lot_analysis *analysis) {
  const fg_film_report *film = analysis->film;
  if (!film && !analysis->film_why[0]) return;
  fputs("<section class=\"part\">\n<h1>The rotor on bearings of this lot</h1>\n", out);
  if (!film) {
    fputs("<p>No film was found: ", out);
    fg_html_text(out, analysis->film_why);
    fputs(".</p>\n</section>\n", out);
    return;
  }
  put_film_statements(out, film);
  put_film_conditions(out, film);
  fg_html_table(out, &fg_film_share_members, &(fg_subject){.object = &film->draws, .whole = film},
                fg_film_share_at);
  const double *q = film->draws.quantile;
  fprintf(out,
          "<p class=\"note\">Critical mass over that as designed, of those solved: %.3g at 5 %%, "
          "%.3g in the middle, %.3g at 95 %%. The clearances are those measured: their u is in the "
          "scatter, too.</p>\n</section>\n",
          q[0], q[2], q[4]);
}
