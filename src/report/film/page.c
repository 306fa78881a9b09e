/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The page of a film. */
#include <math.h>
#include <stdio.h>

#include "core/file.h"
#include "page/page.h"
#include "page/table.h"
#include "page/tile.h"
#include "report/film/members.h"
#include "report/film/plots.h"
#include "report/provenance.h"

/* The verdict on the rotor. It is open where another film is there, on which it is unstable. */
static fg_tile rotor_tile(const fg_film_report *r) {
  const fg_film_result *at = &r->actual;
  double mass_kg = r->options.rotor_mass_kg;
  bool known = !isnan(at->critical_mass_kg), stable = fg_film_is_stable(at, mass_kg);
  bool open = stable && r->has_other_film && !fg_film_is_stable(&r->other_film, mass_kg);
  return (fg_tile){"Rotor",
                   .text = !known   ? "–"
                           : stable ? "stable"
                                    : "unstable",
                   .small = open                   ? "on this film; on the other it whirls"
                            : fg_film_is_alike(at) ? "at every mass, at this speed"
                                                   : "of the stated mass, at this speed",
                   .look = !known || open ? FG_TILE_OPEN
                           : stable       ? FG_TILE_GOOD
                                          : FG_TILE_BAD};
}

static void put_film_tiles(FILE *out, const fg_film_report *r) {
  const fg_film_result *at = &r->actual;
  bool always = isinf(at->critical_mass_kg);
  const fg_tile tiles[] = {
      rotor_tile(r),
      {always ? NULL : "Critical mass", .value = at->critical_mass_kg, .digits = 4, .unit = "kg",
       .small = "on this bearing"},
      {"Threshold speed", .value = r->threshold_rpm, .unit = "rpm",
       .small = fg_film_whirls_from_lift_off(r) ? "below lift-off: it whirls as soon as it flies"
                                                : "of this rotor under this load",
       .unknown = "none among the speeds"},
      {"Thinnest film", .value = at->min_film_um, .digits = 3, .unit = "µm", .small = "under load"},
      {"Eccentricity", .value = at->eccentricity, .digits = 3, .small = "over the clearance"},
      {"Load capacity", .value = r->load_capacity_n, .digits = 3, .unit = "N",
       .small = "at this speed, for a film that does not touch"},
      {"Lift-off", .value = r->lift_off_rpm, .unit = "rpm", .small = "under this load"},
      {"Loss", .value = at->power_w, .digits = 3, .unit = "W", .small = "of the film's shear"},
  };
  fg_html_tiles(out, "tiles", tiles, sizeof tiles / sizeof *tiles);
}

static void put_summary(FILE *out, const fg_film_report *r) {
  char notes[FG_FILM_NOTES][FG_FILM_NOTE];
  const fg_film_options *o = &r->options;
  fputs("<section>\n<header><h1>Gas film of ", out);
  fg_html_text(out, r->design.name);
  fprintf(out,
          "</h1><p>%.4g N towards %g°, %.0f rpm, rotor %.4g kg; D %.4g mm, L %.4g mm, C %.4g µm, "
          "compliance %.4g, loss factor %.3g</p></header>\n",
          o->load_n, o->load_deg, o->speed_rpm, o->rotor_mass_kg, r->diameter_mm, r->length_mm,
          r->clearance_um, r->compliance, o->loss_factor);
  put_film_tiles(out, r);
  fputs("<ul class=\"words\">\n", out);
  size_t count = fg_film_notes(r, notes);
  for (size_t i = 0; i < count; i++) {
    fputs("<li>", out);
    fg_html_text(out, notes[i]);
    fputs("</li>\n", out);
  }
  fputs("</ul>\n", out);
  fg_html_table(out, &fg_film_result_members, &(fg_subject){.object = r, .whole = r},
                fg_film_bearing_at);
  fputs("</section>\n", out);
}

static void put_field(FILE *out, const fg_film_report *r) {
  fputs("<section>\n<h2 class=\"first\">The film</h2>\n<figure>", out);
  fg_film_plot_field(out, r);
  fprintf(out,
          "<figcaption>Pressure of the unwrapped film: white is ambient, red above it, blue below; "
          "the highest is %.4g kPa.</figcaption></figure>\n<figure>",
          r->actual.max_pressure_kpa);
  fg_film_plot_thickness(out, r);
  fputs("<figcaption>Film, clearance and the foil's deflection.</figcaption></figure>\n"
        "</section>\n",
        out);
}

/* The rotor's whirls, and both thresholds beside each other. */
static void put_modes(FILE *out, const fg_film_report *r) {
  fputs("<p>Whirls of the rotor on its film by itself, at the stated speed: those with a "
        "logarithmic decrement below 0 grow.",
        out);
  if (isfinite(r->threshold_rpm) && isfinite(r->threshold_eigen_rpm))
    fprintf(out,
            " The least stable one passes 0 at %.0f rpm; the critical mass passes the rotor's at "
            "%.0f rpm.",
            r->threshold_eigen_rpm, r->threshold_rpm);
  fputs(r->modes ? "</p>\n" : " There is none.</p>\n", out);
  fg_html_table(out, &fg_film_mode_members, &(fg_subject){.object = r, .whole = r},
                fg_film_mode_at);
}

static void put_stability(FILE *out, const fg_film_report *r) {
  fputs("<section>\n<h2 class=\"first\">The rotor</h2>\n", out);
  put_modes(out, r);
  fputs("<figure>", out);
  fg_film_plot_stability(out, r);
  fputs("<figcaption>Critical mass over speed, under the same load: heavier rotors whirl. Dashed: "
        "the rotor's mass. The curve breaks off where the rotor passes to another "
        "film.</figcaption></figure>\n<figure>",
        out);
  fg_film_plot_coefficients(out, r, false);
  fputs("</figure>\n<figure>", out);
  fg_film_plot_coefficients(out, r, true);
  fputs("<figcaption>Stiffness and damping of the film over the frequency of whirl, at the stated "
        "speed.</figcaption></figure>\n",
        out);
  fg_html_table(out, &fg_film_result_members, &(fg_subject){.object = r->by_speed, .whole = r},
                fg_film_speed_at);
  fputs("</section>\n", out);
}

static void put_sensitivities(FILE *out, const fg_film_report *r) {
  if (!r->sensitivities) return;
  fputs("<section>\n<h2 class=\"first\">Worth of the bumps' shape</h2>\n<p>Per percent of all "
        "bumps alike; and the critical mass over the perfect bearing's where bumps scatter by one "
        "percent.</p>\n",
        out);
  fg_html_table(out, &fg_film_sensitivity_members, &(fg_subject){.object = r, .whole = r},
                fg_film_sensitivity_at);
  fputs("</section>\n", out);
}

static void put_orbit(FILE *out, const fg_film_report *r) {
  char words[200];
  if (!r->orbit.count) return;
  fg_film_orbit_words(&r->orbit, words, sizeof words);
  fprintf(out, "<section>\n<h2 class=\"first\">The orbit in time: %s</h2>\n<figure>",
          fg_film_fate_words[r->orbit.fate]);
  fg_film_plot_orbit(out, r);
  fprintf(out,
          "<figcaption>%.0f turns of the rotor after a pulse of 2 %% of the load; the dot is its "
          "steady place: %s.</figcaption></figure>\n</section>\n",
          r->orbit.point[r->orbit.count - 1].turn, words);
}

static void put_draws(FILE *out, const fg_film_report *r) {
  const fg_film_draws *d = &r->draws;
  char words[200];
  if (!d->count) return;
  fg_film_draws_words(r, words, sizeof words);
  fprintf(out, "<section>\n<h2 class=\"first\">Drawn bearings</h2>\n<p>%s.</p>\n", words);
  fg_html_table(out, &fg_film_share_members, &(fg_subject){.object = d, .whole = r},
                fg_film_share_at);
  fg_film_quantile_words(d, words, sizeof words);
  fprintf(out, "<p>Critical mass over the perfect bearing's: %s.</p>\n</section>\n", words);
}

fg_status fg_film_write_html(fg_context *ctx, const fg_film_report *r, FILE *out) {
  char title[120];
  fg_provenance from = {.design = &r->design};
  snprintf(title, sizeof title, "Gas film of %s", r->design.name);
  fg_html_begin(out, title);
  put_summary(out, r);
  if (r->columns) put_field(out, r);
  if (r->speed_count) put_stability(out, r);
  put_orbit(out, r);
  put_sensitivities(out, r);
  put_draws(out, r);
  if (r->options.foils && !r->draws.foils) fg_provenance_include_file(&from, r->options.foils);
  if (r->options.bore) fg_provenance_include_file(&from, r->options.bore);
  FG_TRY(fg_html_provenance_section(ctx, out, &from));
  fg_html_end(out);
  return fg_stream_finish(ctx, out, "the page");
}
