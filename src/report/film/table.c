/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A film for the terminal. */
#include <math.h>

#include "core/file.h"
#include "report/film/members.h"

enum { LINE = 96 };

/* Writes words broken between words. */
static void put_note(FILE *out, const char *text) {
  int column = 0;
  fputs("\n  ", out);
  for (const char *c = text; *c; c++) {
    bool turn = *c == ' ' && column > LINE - 14;
    fputs(turn ? "\n  " : (char[]){*c, '\0'}, out);
    column = turn ? 0 : column + 1;
  }
  fputc('\n', out);
}

static void put_conditions(FILE *out, const fg_film_report *r) {
  const fg_film_options *o = &r->options;
  fprintf(out, "design %s; %.4g N towards %g degrees, %.6g rpm, rotor %.4g kg\n", r->design.name,
          o->load_n, o->load_deg, o->speed_rpm, o->rotor_mass_kg);
  fprintf(out, "D %.4g mm, L %.4g mm, C %.4g um; compliance %.4g, loss factor %.3g\n\n",
          r->diameter_mm, r->length_mm, r->clearance_um, r->compliance, o->loss_factor);
}

static void put_modes(FILE *out, const fg_film_report *r) {
  if (!r->modes) return;
  fputs("\nwhirls of the rotor on its film\n", out);
  fg_members_terminal(out, "  ", &fg_film_mode_members, &(fg_subject){.object = r, .whole = r},
                      fg_film_mode_at);
}

static void put_sensitivities(FILE *out, const fg_film_report *r) {
  if (!r->sensitivities) return;
  fputs("\nper percent of the design's bumps, and where they scatter by one percent\n", out);
  fg_members_terminal(out, "  ", &fg_film_sensitivity_members,
                      &(fg_subject){.object = r, .whole = r}, fg_film_sensitivity_at);
}

static void put_draws(FILE *out, const fg_film_report *r) {
  const fg_film_draws *d = &r->draws;
  char words[200];
  if (!d->count) return;
  fg_film_draws_words(r, words, sizeof words);
  fprintf(out, "\n%s\n", words);
  fg_members_terminal(out, "  ", &fg_film_share_members, &(fg_subject){.object = d, .whole = r},
                      fg_film_share_at);
  fg_film_quantile_words(d, words, sizeof words);
  fprintf(out, "\n  critical mass over the perfect bearing's: %s\n", words);
}

static void put_orbit(FILE *out, const fg_film_report *r) {
  char words[200];
  if (!r->orbit.count) return;
  fg_film_orbit_words(&r->orbit, words, sizeof words);
  fprintf(out, "\n  orbit in time: %s; %s\n", fg_film_fate_words[r->orbit.fate], words);
}

fg_status fg_film_write_text(fg_context *ctx, const fg_film_report *r, FILE *out) {
  char notes[FG_FILM_NOTES][FG_FILM_NOTE];
  put_conditions(out, r);
  fg_members_terminal(out, "  ", &fg_film_result_members, &(fg_subject){.object = r, .whole = r},
                      fg_film_bearing_at);
  put_modes(out, r);
  if (isfinite(r->threshold_rpm))
    fprintf(out, "\n  threshold speed  %.0f rpm (by eigenvalues %.0f)\n", r->threshold_rpm,
            r->threshold_eigen_rpm);
  if (isfinite(r->load_capacity_n))
    fprintf(out, "  load capacity    %.4g N at this speed\n", r->load_capacity_n);
  if (isfinite(r->lift_off_rpm))
    fprintf(out, "  lift-off         %.0f rpm under this load\n", r->lift_off_rpm);
  put_orbit(out, r);
  put_sensitivities(out, r);
  put_draws(out, r);
  size_t count = fg_film_notes(r, notes);
  for (size_t i = 0; i < count; i++)
    put_note(out, notes[i]);
  return fg_stream_finish(ctx, out, "the table");
}
