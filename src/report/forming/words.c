/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/forming/words.h"

#include <math.h>
#include <string.h>

#include "core/text.h"
#include "foilgauge/foil_kind.h"

const char fg_forming_out_of_reach[] =
    "Out of reach of this model: what needs contact and friction (thesis figures 5.14 to 5.16): "
    "where the die touches while it closes, whether the pressure closes it, bumps that differ by "
    "their place along the strip. A pressure on both faces is hydrostatic in plane strain: it "
    "neither yields nor creeps, and enters no equation here.";

const char *fg_forming_shape_word(fg_forming_shape shape) {
  return shape == FG_FORMING_SINE ? "sine" : "arcs";
}

void fg_forming_treatment(const fg_forming *forming, char *text, size_t size) {
  const fg_forming_schedule *s = &forming->schedule;
  double hottest = -INFINITY;
  for (size_t i = 0; i < s->count; i++)
    hottest = fmax(hottest, s->temperature_C[i]);
  if (!s->count)
    fg_text_clip(text, size, "as bent, without heat treatment");
  else if (s->count == 2 && s->temperature_C[0] == s->temperature_C[1])
    fg_text_clip(text, size, "%g h at %g °C in the die", s->time_h[1] - s->time_h[0], hottest);
  else
    fg_text_clip(text, size, "a schedule of %g h, up to %g °C, in the die",
                 s->time_h[s->count - 1] - s->time_h[0], hottest);
}

/* True when a constant of the material is the literature's. */
static bool is_default(const fg_forming_material *material, fg_forming_constant c) {
  return !strcmp(material->source[c], fg_forming_constant_of(c)->source);
}

static size_t note_material(const fg_forming *forming, char *note) {
  size_t n = 0;
  for (int c = 0; c < FG_FORMING_CONSTANTS; c++)
    n += is_default(&forming->material, (fg_forming_constant)c);
  if (!n) return 0;
  fg_text_clip(
      note, FG_FORMING_NOTE,
      "%zu of %d constants are the literature's, not this strip's: yield stress and creep "
      "rate scatter by factors, so the size of a springback is a guess until forming --fit has "
      "runs to find them from. Of the lands alone hotter and longer is less; of the whole "
      "foil, a small difference of lands and bumps, not always.",
      n, FG_FORMING_CONSTANTS);
  return 1;
}

/* Bumps bend the other way than lands and fillets: when they open, the foil closes. */
static size_t note_closing(const fg_forming *forming, char *note) {
  char lands[60] = "springs back to no circle";
  if (!forming->bump_count || !(forming->springback_error_pct > 0)) return 0;
  if (isfinite(forming->strip_springback_error_pct))
    fg_text_clip(lands, sizeof lands, "it says %+.2f %%", forming->strip_springback_error_pct);
  fg_text_clip(note, FG_FORMING_NOTE,
               "The free foil closes: its bumps, which bend the other way, are longer than lands "
               "and fillets together, and each loses about the same curvature. The thesis's foils "
               "opened (-2.4 to -20.8 %%): what makes them open is not in this model. Of the lands "
               "alone, a plain strip, %s.",
               lands);
  return 1;
}

static size_t note_circles(const fg_forming *forming, char *note) {
  if (forming->fitted || !forming->bump_count) return 0;
  fg_text_clip(note, FG_FORMING_NOTE,
               "`measure` would not find the circles of all bumps on this strip%s%s: radii by the "
               "curvature stand, fitted values are missing.",
               forming->foil.error[0] ? ": " : "", forming->foil.error);
  return 1;
}

size_t fg_forming_notes(const fg_forming *forming, char notes[FG_FORMING_NOTES][FG_FORMING_NOTE]) {
  size_t n = note_material(forming, notes[0]);
  n += note_closing(forming, notes[n]);
  n += note_circles(forming, notes[n]);
  if (forming->yields_back)
    fg_text_clip(notes[n++], FG_FORMING_NOTE,
                 "On release some layers would yield backwards: the release is taken as elastic, "
                 "which says too much springback.");
  fg_text_clip(notes[n++], FG_FORMING_NOTE, "%s", fg_forming_out_of_reach);
  return n;
}

/* ---- a fit ---- */

/* Names of constants, joined by commas. */
static void add_name(char *list, size_t size, const fg_forming_found *found) {
  size_t used = strlen(list);
  fg_text_clip(list + used, size - used, "%s%s", used ? ", " : "",
               fg_forming_constant_of(found->constant)->name);
}

static size_t note_bounds(const fg_forming_fit *fit, char *note) {
  char names[200] = "";
  for (size_t k = 0; k < fit->free; k++)
    if (fit->found[k].at_bound) add_name(names, sizeof names, &fit->found[k]);
  if (!names[0]) return 0;
  fg_text_clip(note, FG_FORMING_NOTE,
               "At its bound: not identified: %s. The fit wanted beyond what such a constant may "
               "be, and its value there says nothing: find fewer constants (--free), or check "
               "units and signs of the runs.",
               names);
  return 1;
}

void fg_forming_found_words(const fg_forming_found *found, char *text, size_t size) {
  char end[2][32];
  if (found->at_bound) {
    fg_text_clip(text, size, "at its bound: not identified");
    return;
  }
  for (int side = 0; side < 2; side++)
    if (isfinite(found->interval[side]))
      fg_text_clip(end[side], sizeof end[side], "%.3g", found->interval[side]);
    else
      fg_text_clip(end[side], sizeof end[side], "open");
  fg_text_clip(text, size, "%s to %s", end[0], end[1]);
}

static size_t note_open(const fg_forming_fit *fit, char *note) {
  char open[200] = "";
  double worst = 0;
  for (size_t k = 0; k < fit->free; k++) {
    const fg_forming_found *found = &fit->found[k];
    if (!found->at_bound && !fg_forming_identified(found)) add_name(open, sizeof open, found);
    for (size_t j = 0; j < k; j++)
      worst = fmax(worst, fabs(fit->correlation[k][j]));
  }
  if (!open[0] && !(worst > 0.9)) return 0;
  char together[120] = "";
  if (worst > 0.9)
    fg_text_clip(together, sizeof together,
                 "The constants go together (correlation up to %.3f): their combination is known, "
                 "none of them alone.",
                 worst);
  fg_text_clip(note, FG_FORMING_NOTE, "%s%s%s%s",
               open[0] ? "Not identified, the interval has an open end: " : "", open,
               open[0] ? ". " : "", together);
  return 1;
}

/* A plain strip only opens. */
static size_t note_sign(const fg_forming_fit *fit, char *note) {
  double sum = 0;
  for (size_t i = 0; i < fit->runs; i++)
    sum += fit->run[i].measured;
  if (fit->response != FG_FORMING_OF_STRIP || !(sum > 0)) return 0;
  fg_text_clip(
      note, FG_FORMING_NOTE,
      "The runs' %s is above 0 on average, and a plain strip only opens: is it 100 (R0 - R) "
      "/ R0, which is below 0 where a foil opens?",
      fit->response_name);
  return 1;
}

size_t fg_forming_fit_notes(const fg_forming_fit *fit,
                            char notes[FG_FORMING_NOTES][FG_FORMING_NOTE]) {
  size_t n = 0;
  char surface[80] = "; a quadratic surface these runs do not carry";
  char missed[60] = "";
  const fg_forming_errors *m = &fit->model, *q = &fit->surface;
  if (isfinite(q->residual_sd)) {
    fg_text_clip(surface, sizeof surface, ", a quadratic surface %.2f (%zu)", q->residual_sd,
                 q->parameters);
    if (isfinite(q->left_out_rms))
      fg_text_clip(missed, sizeof missed, ", the surface %.2f", q->left_out_rms);
    else
      fg_text_clip(missed, sizeof missed, ", without which the surface is none");
  }
  fg_text_clip(
      notes[n++], FG_FORMING_NOTE,
      "The beam model leaves %.2f points (residual sd, %zu constant%s)%s. On held-out runs "
      "it errs by %.2f points (rms, each run left out in turn)%s.%s",
      m->residual_sd, m->parameters, fg_plural(m->parameters), surface, m->left_out_rms, missed,
      m->left_out_rms > 2 * m->residual_sd
          ? " It may be believed between these runs and not beyond: without its outermost "
            "run it does not find it again."
          : "");
  if (isfinite(fit->repeat_sd))
    fg_text_clip(
        notes[n++], FG_FORMING_NOTE,
        "Runs of the same temperature and duration differ by %.2f points (sd, %zu degree%s "
        "of freedom): no model of these two leaves less.",
        fit->repeat_sd, fit->repeats, fg_plural(fit->repeats));
  n += note_sign(fit, notes[n]);
  n += note_bounds(fit, notes[n]);
  n += note_open(fit, notes[n]);
  if (fit->response == FG_FORMING_OF_STRIP && fg_foil_traits_of(fit->design.kind)->has_bumps)
    fg_text_clip(notes[n++], FG_FORMING_NOTE,
                 "The response is taken as that of the lands alone, a plain strip of the overall "
                 "radius. Integrated with its bumps the beam's foil closes where measured ones "
                 "open (--of foil fits that).");
  return n;
}
