/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The next die in words and as a table for the terminal. */
#include <math.h>

#include "compensation/members.h"
#include "core/file.h"
#include "foilgauge/words.h"

const char *fg_formed_words(fg_formed formed) {
  static const char *const words[FG_FORMED] = {"bump radius", "bump arc length", "overall radius",
                                               "pitch of the bumps"};
  return words[formed];
}

/* Mean error of the radius, or of the overall radius of a plain strip, percent of the target's. */
static double last_error_pct(const fg_next_die *next) {
  const fg_formed_set *last = &next->law->set[next->law->sets - 1];
  fg_formed formed = next->die.bumps ? FG_FORMED_RADIUS : FG_FORMED_OVERALL;
  double target = next->die.bumps ? next->target.bumps.radius_mm : next->target.overall_radius_mm;
  double sum = 0;
  for (size_t i = 0; i < last->of[formed].places; i++) {
    const fg_formed_place *place = &last->of[formed].place[i];
    sum += 100 * (place->die * exp(place->log_ratio) / target - 1);
  }
  return sum / (double)last->of[formed].places;
}

static double mean_radius(const fg_die_dimensions *die) {
  double sum = 0;
  for (size_t i = 0; i < die->bumps; i++)
    sum += die->bump[i].radius_mm / (double)die->bumps;
  return die->bumps ? sum : die->overall_radius_mm;
}

static double expected_u_pct(const fg_next_die *next) {
  const fg_expected_value *value =
      next->die.bumps ? &next->expected.bump[0].radius_mm : &next->expected.overall_radius_mm;
  return 200 * value->u / value->value;
}

void fg_next_die_sentence(const fg_next_die *next, char *text, size_t size) {
  double now = mean_radius(&next->present), then = mean_radius(&next->die);
  snprintf(
      text, size,
      "Cut %s of %.4f mm where %.4f mm is now (%+.2f %%): the last foils are off the target by "
      "%+.2f %%, the next are expected on it, U %.2f %%%s.",
      next->die.bumps ? "bump radii" : "the mandrel with a radius", then, now,
      100 * (then / now - 1), last_error_pct(next), expected_u_pct(next),
      next->die.bumps ? " of a bump" : "");
}

static void put_whole(const fg_next_die *next, FILE *out) {
  const fg_die_dimensions *die = &next->die, *now = &next->present;
  const fg_expected_value *overall = &next->expected.overall_radius_mm;
  fprintf(out, "overall radius %.4f mm, U %.4f (now %.4f); the next lot's mean: %.4f to %.4f mm\n",
          die->overall_radius_mm, 2 * die->u_overall_radius_mm, now->overall_radius_mm,
          overall->low, overall->high);
  if (die->bumps)
    fprintf(out, "pitch %.4f deg, U %.4f (now %.4f)\n", die->pitch_deg, 2 * die->u_pitch_deg,
            now->pitch_deg);
}

static void put_expected_shares(const fg_next_die *next, const fg_subject *list, FILE *out) {
  const fg_expected_lot *expected = &next->expected;
  if (expected->tolerances) {
    fputs("\nfoils within the target's tolerances\n", out);
    fg_members_terminal(out, "  ", &fg_expected_share_members, list, fg_expected_share_at);
    fprintf(out, "  all of them: %.1f %%, %.1f to %.1f\n", 100 * expected->share,
            100 * expected->share_low, 100 * expected->share_high);
  }
  if (isfinite(expected->assembled))
    fprintf(out, "bearings that a rotor fits into: %.1f %%, %.1f to %.1f\n",
            100 * expected->assembled, 100 * expected->assembled_low,
            100 * expected->assembled_high);
}

void fg_setting_sentence(const fg_next_die *next, char *text, size_t size) {
  const fg_setting_trade *own = &next->setting[0], *best = &next->setting[next->chosen];
  if (next->chosen == 0)
    snprintf(
        text, size,
        "Keep the heat treatment (%s): no other lets the next lot be foretold better, u %.2f %%.",
        own->text, own->u_next_pct);
  else
    snprintf(text, size,
             "At %s springback is %.2f of that at %s: with a die of %.4f mm the next lot's mean is "
             "known to u = %.2f %%, in place of %.2f %%.",
             best->text, best->share, own->text,
             next->die.bumps ? best->radius_mm : best->overall_radius_mm, best->u_next_pct,
             own->u_next_pct);
}

static void put_settings(const fg_next_die *next, const fg_subject *list, FILE *out) {
  char sentence[600];
  if (!next->settings) return;
  fg_setting_sentence(next, sentence, sizeof sentence);
  fprintf(out, "\ndie and heat treatment: %s\n", sentence);
  fg_members_terminal(out, "  ", &fg_setting_trade_members, list, fg_setting_trade_at);
}

fg_status fg_next_die_write_table(fg_context *ctx, const fg_next_die *next, FILE *out) {
  char sentence[FG_MEMBER_TEXT_MAX];
  const fg_subject list = {.object = next, .whole = next};
  fg_next_die_sentence(next, sentence, sizeof sentence);
  fprintf(out, "next die for %s, lengths of the strip's %s line\n%s\n\n", next->target.name,
          fg_datum_word(next->target.datum), sentence);
  if (next->die.bumps) {
    fg_members_terminal(out, "  ", &fg_next_bump_members, &list, fg_next_bump_at);
    fputc('\n', out);
  }
  put_whole(next, out);
  put_expected_shares(next, &list, out);
  put_settings(next, &list, out);
  fputs("\nspringback learnt\n", out);
  fg_members_terminal(out, "  ", &fg_formed_law_members, &list, fg_formed_law_at);
  fputs("\nfrom\n", out);
  fg_members_terminal(out, "  ", &fg_formed_set_members, &list, fg_formed_set_at);
  for (size_t i = 0; i < next->notes; i++)
    fprintf(out, "note: %s\n", next->note[i]);
  fprintf(out, "\nU = 2 u; the next lot: %zu foil%s\n", next->expected.foils,
          next->expected.foils == 1 ? "" : "s");
  return fg_stream_finish(ctx, out, "the table");
}
