/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Notes of a film's report: its result in words, and its limits. */
#include <math.h>
#include <stdio.h>

#include "report/film/members.h"

static void note_threshold(const fg_film_report *r, char *note) {
  const fg_film_options *o = &r->options;
  if (isfinite(r->threshold_rpm))
    snprintf(note, FG_FILM_NOTE,
             "The rotor of %.4g kg on this bearing whirls from %.0f rpm on, under this load.",
             o->rotor_mass_kg, r->threshold_rpm);
  else
    snprintf(
        note, FG_FILM_NOTE,
        "Between %.0f and %.0f rpm the rotor of %.4g kg does not pass from stable to unstable.",
        o->speed_low_rpm, o->speed_high_rpm, o->rotor_mass_kg);
}

void fg_film_draws_words(const fg_film_report *r, char *text, size_t size) {
  const fg_film_draws *d = &r->draws;
  if (d->foils)
    snprintf(text, size,
             "%zu bearings of %zu different foils each, drawn from %zu (%zu left out), seed %llu",
             d->count, r->options.pads ? r->options.pads : 1, d->foils, d->left_out,
             (unsigned long long)r->options.seed);
  else
    snprintf(text, size,
             "%zu bearings, shims of %g to %g %% of the clearance under every bump, seed %llu",
             d->count, r->options.shim_low_pct, r->options.shim_high_pct,
             (unsigned long long)r->options.seed);
}

size_t fg_film_notes(const fg_film_report *r, char notes[FG_FILM_NOTES][FG_FILM_NOTE]) {
  const fg_film_options *o = &r->options;
  size_t count = 0;
  if (r->at.outcome == FG_FILM_UNSOLVED)
    snprintf(notes[count++], FG_FILM_NOTE,
             "No steady film was found under these foils: at %.4g N and %.4g rpm the rotor rests "
             "on them, or the load is carried where the model ends.",
             o->load_n, o->speed_rpm);
  else
    note_threshold(r, notes[count++]);
  if (r->at.outcome == FG_FILM_TOUCHING)
    snprintf(notes[count++], FG_FILM_NOTE,
             "The film is thinner than %.3g um: surfaces touch, and what is said of stability "
             "does not hold.",
             o->touching_um);
  if (o->pads == 0)
    snprintf(notes[count++], FG_FILM_NOTE,
             "A closed ring without edges of pads: no such bearing "
             "of foils is built; it serves comparisons.");
  snprintf(notes[count++], FG_FILM_NOTE,
           "Model: isothermal gas, a top foil that does not bend along the axis and does not lift "
           "off its bumps, parallel axes, no slip of the gas at the walls, a rigid rotor.");
  return count;
}
