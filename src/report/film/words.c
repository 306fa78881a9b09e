/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Notes of a film's report: its result in words, and its limits. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "report/film/members.h"

/* Verdict on a rotor that passes no threshold among the speeds. */
static const char *find_verdict_of_map(const fg_film_report *r) {
  size_t known = 0, unstable = 0;
  for (size_t i = 0; i < r->speed_count; i++) {
    if (r->by_speed[i].outcome == FG_FILM_UNSOLVED) continue;
    known++;
    unstable += !fg_film_is_stable(&r->by_speed[i], r->options.rotor_mass_kg);
  }
  if (!known) return "has no film";
  if (unstable == known) return "is unstable at all speeds that have a film";
  return unstable ? "does not pass from stable to unstable"
                  : "is stable at all speeds that have a film";
}

static void note_threshold(const fg_film_report *r, char *note) {
  const fg_film_options *o = &r->options;
  if (fg_film_whirls_from_lift_off(r))
    snprintf(note, FG_FILM_NOTE,
             "The rotor of %.4g kg on this bearing whirls as soon as it has lifted off (%.0f rpm), "
             "under this load.",
             o->rotor_mass_kg, r->lift_off_rpm);
  else if (isfinite(r->threshold_rpm))
    snprintf(note, FG_FILM_NOTE,
             "The rotor of %.4g kg on this bearing whirls from %.0f rpm on, under this load.",
             o->rotor_mass_kg, r->threshold_rpm);
  else
    snprintf(note, FG_FILM_NOTE, "Between %.0f and %.0f rpm the rotor of %.4g kg %s.",
             o->map.low_rpm, o->map.high_rpm, o->rotor_mass_kg, find_verdict_of_map(r));
}

void fg_film_orbit_words(const fg_film_orbit *orbit, char *text, size_t size) {
  if (isnan(orbit->growth_per_turn))
    snprintf(text, size,
             "too few whirls in these turns to tell its growth: more --orbit TURNS may");
  else
    snprintf(text, size, "amplitude times %.4g a turn, whirl at %.3g of the speed",
             exp(orbit->growth_per_turn), orbit->whirl_ratio);
}

void fg_film_quantile_words(const fg_film_draws *d, char *text, size_t size) {
  static const char *const where[FG_FILM_QUANTILES] = {"at 5 %", "at 25 %", "median", "at 75 %",
                                                       "at 95 %"};
  size_t used = 0;
  text[0] = '\0';
  bool known = d->solved.count && !isnan(d->quantile[0]);
  if (!known)
    snprintf(text, size, "%s",
             d->solved.count ? "the bearing as designed has none, at any mass" : "none is solved");
  for (size_t k = 0; known && k < FG_FILM_QUANTILES && used < size; k++) {
    const char *mark = k ? ", " : "";
    int more = isfinite(d->quantile[k]) && d->quantile[k] > 0
                   ? snprintf(text + used, size - used, "%s%s %.3g", mark, where[k], d->quantile[k])
                   : snprintf(text + used, size - used, "%s%s %s at every mass", mark, where[k],
                              d->quantile[k] > 0 ? "stable" : "unstable");
    used += more > 0 ? (size_t)more : 0;
  }
}

/* Behind the words on draws: those that are not there. */
static void add_missing_draws(const fg_film_draws *d, char *text, size_t size) {
  size_t used = strlen(text);
  if (d->count < d->asked)
    snprintf(text + used, size - used, "; %zu more are asked for, and not here",
             d->asked - d->count);
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
             d->count, r->options.draw.shim_low_pct, r->options.draw.shim_high_pct,
             (unsigned long long)r->options.seed);
  add_missing_draws(d, text, size);
}

/* "3.1 um (8 %)"; the widest or none of those that were tried. */
static void put_tolerance(const fg_film_report *r, double um, char *text, size_t size) {
  if (isinf(um))
    snprintf(text, size, "more than %.3g um", FG_FILM_WIDEST_SHARE * r->clearance_um);
  else if (um == 0)
    snprintf(text, size, "nothing that was tried");
  else
    snprintf(text, size, "%.2g um (%.2g %%)", um, 100 * um / r->clearance_um);
}

void fg_film_tolerance_words(const fg_film_report *r, char *text, size_t size) {
  char each[60], lower[60], closer[60], wider[60];
  const fg_film_tolerance *t = &r->tolerance;
  if (isnan(t->threshold_rpm)) {
    snprintf(text, size,
             "No tolerance on the clearance is told: as designed the rotor has no threshold speed "
             "between %.0f and %.0f rpm.",
             r->options.map.low_rpm, r->options.map.high_rpm);
    return;
  }
  put_tolerance(r, t->each_um, each, sizeof each);
  put_tolerance(r, t->each_not_lower_um, lower, sizeof lower);
  put_tolerance(r, t->alike_um[0], closer, sizeof closer);
  put_tolerance(r, t->alike_um[1], wider, sizeof wider);
  snprintf(text, size,
           "The threshold speed (%.0f rpm as designed) stays within %g %% in 95 of 100 bearings "
           "whose clearance keeps ± %s at every bump by itself, and falls by no more than that "
           "with ± %s. All bumps alike may be closer by %s or wider by %s.",
           t->threshold_rpm, r->options.within_pct, each, lower, closer, wider);
}

static void note_other_film(const fg_film_report *r, char *note) {
  const fg_film_result *other = &r->other_film;
  const char *word = fg_film_stability_word(r, other);
  snprintf(
      note, FG_FILM_NOTE,
      "Another film is there at this load and speed: e / C %.3g in place of %.3g, thinnest %.3g um "
      "in place of %.3g; the rotor is %s on it. Which one it takes hangs on where it comes "
      "from.",
      other->eccentricity, r->actual.eccentricity, other->min_film_um, r->actual.min_film_um,
      word ? word : "not judged");
}

/* Says where the rotor passes to another film, on the way to the limits. */
static void note_film_ends(const fg_film_report *r, char *note) {
  char load[60] = "", speed[60] = "";
  if (isfinite(r->film_ends_n))
    snprintf(load, sizeof load, "at %.3g N as the load rises", r->film_ends_n);
  if (isfinite(r->film_ends_rpm))
    snprintf(speed, sizeof speed, "at %.0f rpm as the rotor slows down", r->film_ends_rpm);
  const char *both = *load && *speed ? ", and " : "";
  snprintf(note, FG_FILM_NOTE,
           "This film ends %s%s%s; the rotor passes to another film, which reaches to %s.", load,
           both, speed,
           *both   ? "load capacity and lift-off"
           : *load ? "the load capacity"
                   : "lift-off");
}

static void note_uncertainty(const fg_film_report *r, char *note) {
  const fg_film_uncertainty *u = &r->uncertainty;
  snprintf(
      note, FG_FILM_NOTE,
      "The clearances' u makes U (2 u) of the thinnest film %.2g um, of the eccentricity %.2g, "
      "of the critical mass %.2g kg (%zu draws, %zu solved).",
      2 * u->min_film_um, 2 * u->eccentricity, 2 * u->critical_mass_kg, u->draws, u->solved.count);
}

static void note_lift_off(const fg_film_report *r, char *note) {
  const fg_film_lift_off *l = &r->lift_off;
  if (isnan(l->shift_um)) {
    snprintf(note, FG_FILM_NOTE,
             "No clearance within 0.6 of C of this bearing's lifts off at %.0f rpm under %.4g N.",
             l->rpm, r->options.load_n);
    return;
  }
  snprintf(note, FG_FILM_NOTE,
           "Measured lift-off at %.0f rpm (model: %.0f): of clearances %.2g ± %.2g um %s, "
           "%.4g um in the mean. It %s the bearing's clearance as stated (U %.2g um).",
           l->rpm, l->predicted_rpm, fabs(l->shift_um), 2 * l->u_shift_um,
           l->shift_um < 0 ? "closer" : "wider", l->clearance_um,
           l->agrees ? "agrees with" : "contradicts", 2 * l->u_bearing_um);
}

size_t fg_film_notes(const fg_film_report *r, char notes[FG_FILM_NOTES][FG_FILM_NOTE]) {
  const fg_film_options *o = &r->options;
  size_t count = 0;
  if (r->actual.outcome == FG_FILM_UNSOLVED)
    snprintf(notes[count++], FG_FILM_NOTE,
             "No steady film was found under these foils: at %.4g N and %.6g rpm the rotor rests "
             "on them, or the load is carried where the model ends.",
             o->load_n, o->speed_rpm);
  else
    note_threshold(r, notes[count++]);
  if (r->actual.outcome == FG_FILM_TOUCHING)
    snprintf(notes[count++], FG_FILM_NOTE,
             "The film is thinner than %.3g um: surfaces touch, and what is said of stability "
             "does not hold.",
             o->touching_um);
  if (r->has_other_film) note_other_film(r, notes[count++]);
  if (isfinite(r->film_ends_n) || isfinite(r->film_ends_rpm)) note_film_ends(r, notes[count++]);
  if (r->uncertainty.draws) note_uncertainty(r, notes[count++]);
  if (r->lift_off.asked) note_lift_off(r, notes[count++]);
  if (r->tolerance.asked) fg_film_tolerance_words(r, notes[count++], FG_FILM_NOTE);
  if (o->pads == 0)
    snprintf(notes[count++], FG_FILM_NOTE,
             "A closed ring without edges of pads: no such bearing "
             "of foils is built; it serves comparisons.");
  snprintf(notes[count++], FG_FILM_NOTE,
           "Model: isothermal gas, a top foil that does not bend along the axis and does not lift "
           "off its bumps, parallel axes, no slip of the gas at the walls, a rigid rotor.");
  return count;
}
