/* Level `bumps` on the page of the loop on scans: every bump's deviation from the declared
 * springback over its number, what was found of it, what is left. */
#include <math.h>
#include <string.h>

#include "core/text.h"
#include "report/plot.h"
#include "report/plot_marks.h"
#include "report/scan_loop/scan_loop_parts.h"

enum { WIDTH = 520, HEIGHT = 264 };

static const char *const response_words[FG_SCAN_LOOP_BUMP_RESPONSES] = {"bump radius",
                                                                        "bump angle"};

static void effect_words(const fg_loop_effect *effect, char *words, size_t size) {
  static const struct {
    const char *id, *words;
  } table[] = {{"part.lip_decay", "a decay from the lip"},
               {"part.stretch", "an arc length unlike the design's"},
               {"table.order_drift", "a trend over the bumps' numbers"}};
  fg_text_clip(words, size, "%s", effect->id);
  for (size_t i = 0; i < sizeof table / sizeof *table; i++)
    if (!strcmp(table[i].id, effect->id)) fg_text_clip(words, size, "%s", table[i].words);
}

/* ---- the sentence ---- */

static const char *unit_words(const char *unit) {
  return !strcmp(unit, "um") ? "µm" : !strcmp(unit, "deg") ? "°" : unit;
}

static fg_status say_claim(fg_context *ctx, size_t response, const fg_loop_claim *claim, bool first,
                           char **text) {
  const fg_scan_loop_bump_response *what = &fg_scan_loop_bump_responses[response];
  char words[120], value[64];
  effect_words(claim->candidate.effect, words, sizeof words);
  fg_scan_loop_value_words(what->scale * claim->amplitude, what->scale * claim->amplitude_u, value,
                           sizeof value);
  FG_TRY(fg_text_append(ctx, text, "%s%s in the %s (half range %s %s)",
                        first ? " Over the bumps: " : "; ", words, response_words[response], value,
                        unit_words(what->unit)));
  if (!claim->aliases) return FG_OK;
  return fg_text_append(ctx, text, ", or %s%s", claim->alias[0].name,
                        claim->aliases > 1 ? " or others" : "");
}

fg_status fg_scan_loop_bumps_sentence(fg_context *ctx, const fg_scan_loop_bumps *bumps,
                                      char **text) {
  bool first = true;
  size_t response;
  for (size_t r = 0; r < FG_SCAN_LOOP_BUMP_RESPONSES; r++)
    for (size_t m = 0; m < bumps->level[r].result.claims; m++, first = false)
      FG_TRY(say_claim(ctx, r, &bumps->level[r].result.claim[m], first, text));
  if (fg_scan_loop_bumps_curve(bumps, &response)) {
    FG_TRY(fg_text_append(ctx, text, "%sno listed effect explains how the %s varies",
                          first ? " Over the bumps: " : "; ", response_words[response]));
    first = false;
  }
  return first ? FG_OK : fg_text_append(ctx, text, ".");
}

/* ---- drawings ---- */

typedef struct view {
  const fg_scan_loop_bumps *bumps;
  const fg_scan_loop_bump_level *level;
  double scale;
  bool own_level; /* the model leaves every foil a level of its own */
} view;

static const fg_scan_loop_bump *bump_of(const view *v, size_t i) {
  return &v->bumps->bump[v->level->problem.row[i]];
}

/* Level of a foil: what the effects leave of its residuals, on average. */
static double level_of(const view *v, size_t part) {
  double sum = 0, n = 0;
  const fg_loop_problem *problem = &v->level->problem.problem;
  for (size_t i = 0; v->own_level && i < problem->rows; i++) {
    if (bump_of(v, i)->part != part) continue;
    sum += problem->residual[i] - v->level->result.effect_fit[i];
    n++;
  }
  return n > 0 ? sum / n : 0;
}

static double deviation(const view *v, size_t i, bool after) {
  double d = v->level->problem.problem.residual[i] - level_of(v, bump_of(v, i)->part);
  return v->scale * (after ? d - v->level->result.effect_fit[i] : d);
}

static double place_of(const view *v, size_t i) {
  double parts = (double)v->bumps->parts;
  return bump_of(v, i)->number +
         (parts > 1 ? 0.5 * ((double)bump_of(v, i)->part / (parts - 1) - 0.5) : 0);
}

static void put_bumps(const fg_plot *at, const view *v, bool after) {
  for (size_t i = 0; i < v->level->problem.problem.rows; i++) {
    const fg_scan_loop_bump *bump = bump_of(v, i);
    double x = place_of(v, i), y = deviation(v, i, after);
    double effect = v->scale * v->level->result.effect_fit[i];
    if (!after && effect != 0) fg_plot_segment(at, x - 0.3, effect, x + 0.3, effect, "effect");
    fg_plot_dot(at, x, y, v->bumps->parts > 4 ? 3 : 5, bump->aside ? "run" : "bar");
  }
}

static void put_plot(FILE *out, const view *v, const double range[4], const char *unit, bool after,
                     const char *caption) {
  fg_plot at = {out, WIDTH, 72, 510, 12, 214, range[0], range[1], range[2], range[3]};
  char title[64];
  snprintf(title, sizeof title, "off the model, %s", unit_words(unit));
  fprintf(out, "<figure><figcaption><b>%s</b></figcaption>", caption);
  fg_plot_begin(&at, HEIGHT, caption);
  fg_plot_y_axis(&at, title);
  fg_plot_x_numbers(&at);
  fg_plot_x_title(&at, v->bumps->lip ? "bump, 1 is next to the lip" : "bump");
  put_bumps(&at, v, after);
  fg_plot_end(&at);
  fputs("</figure>\n", out);
}

static void find_range(const view *v, double range[4]) {
  range[0] = range[2] = INFINITY;
  range[1] = range[3] = -INFINITY;
  for (size_t i = 0; i < v->level->problem.problem.rows; i++)
    for (int after = 0; after < 2; after++) {
      double x = place_of(v, i), y = deviation(v, i, after);
      range[0] = fmin(range[0], x - 0.6);
      range[1] = fmax(range[1], x + 0.6);
      range[2] = fmin(range[2], y);
      range[3] = fmax(range[3], y);
    }
  double margin = 0.08 * (range[3] - range[2]) + 1e-9;
  range[2] -= margin;
  range[3] += margin;
}

static void put_response(FILE *out, const fg_scan_loop_bumps *bumps, size_t r) {
  const fg_scan_loop_bump_response *what = &fg_scan_loop_bump_responses[r];
  view v = {bumps, &bumps->level[r], what->scale, r == FG_SCAN_LOOP_BUMP_RADIUS};
  const fg_loop_result *result = &v.level->result;
  bool found = result->claims || result->has_curve;
  double range[4];
  char caption[120];
  if (!v.level->judged || !v.level->problem.problem.rows) return;
  find_range(&v, range);
  fg_text_clip(caption, sizeof caption, "%s, off %s%s", response_words[r], what->model,
               found ? ": before" : "");
  put_plot(out, &v, range, what->unit, false, caption);
  fg_text_clip(caption, sizeof caption, "%s: after", response_words[r]);
  if (found) put_plot(out, &v, range, what->unit, true, caption);
}

/* ---- tables ---- */

static void put_name(FILE *out, const fg_loop_effect *effect, size_t response) {
  char words[120];
  effect_words(effect, words, sizeof words);
  fputs("<td class=\"words\">", out);
  fg_html_text(out, words);
  fprintf(out, ", %s<i>%s</i></td>", response_words[response], effect->id);
}

static void put_claim(FILE *out, const fg_scan_loop_bumps *bumps, size_t r,
                      const fg_loop_claim *claim) {
  const char *name;
  double value, u;
  char words[64];
  fputs("<tr class=\"on\">", out);
  put_name(out, claim->candidate.effect, r);
  bool tied = claim->verdict == FG_LOOP_TIED;
  fprintf(out, "<td class=\"w\"><span class=\"tag %s\">%s</span></td><td class=\"words\">",
          tied ? "tied" : "found", fg_loop_verdict_word(claim->verdict));
  for (size_t i = 0; fg_scan_loop_bumps_parameter(bumps, r, claim, i, &name, &value, &u); i++) {
    fg_scan_loop_value_words(value, u, words, sizeof words);
    fprintf(out, "%s%s = %s", i ? "<br>" : "", name, words);
  }
  for (size_t i = 0; i < claim->aliases; i++) {
    fputs(i ? ", " : "<i>or ", out);
    fg_html_text(out, claim->alias[i].name);
  }
  fprintf(out, "%s</td><td>%.2g</td></tr>\n", claim->aliases ? "</i>" : "", claim->p_value);
}

static void put_rejected(size_t r, const fg_loop_rejected *one, void *user) {
  FILE *out = user;
  const fg_scan_loop_bump_response *what = &fg_scan_loop_bump_responses[r];
  fputs("<tr>", out);
  put_name(out, one->candidate.effect, r);
  fprintf(out, "<td class=\"w\"><span class=\"tag %s\">%s</span></td><td class=\"w\">",
          one->verdict == FG_LOOP_ABSENT ? "absent" : "open", fg_loop_verdict_word(one->verdict));
  if (isfinite(one->smallest_detectable))
    fprintf(out, "would have shown from %.3g %s", what->scale * one->smallest_detectable,
            unit_words(what->unit));
  else
    fputs("–", out);
  fprintf(out, "</td><td>%.2g</td></tr>\n", one->p_value);
}

static void put_candidates(FILE *out, const fg_scan_loop_bumps *bumps) {
  fputs(
      "<div class=\"scroll\"><table><tr><th>effect over the bumps</th><th class=\"w\">verdict</th>"
      "<th class=\"w\">size, ± U = 2u</th><th>p</th></tr>\n",
      out);
  for (size_t r = 0; r < FG_SCAN_LOOP_BUMP_RESPONSES; r++)
    for (size_t m = 0; m < bumps->level[r].result.claims; m++)
      put_claim(out, bumps, r, &bumps->level[r].result.claim[m]);
  fg_scan_loop_bumps_rejected(bumps, put_rejected, out);
  fputs("</table></div>\n", out);
}

static void put_error(FILE *out, const char *name, const char *model, const char *unit,
                      const fg_scan_loop_bump_error *e, double scale) {
  if (!isfinite(e->rms[0])) return;
  fprintf(out, "<tr><td>%s, %s</td><td class=\"w\">%s</td><td>%.3g</td><td>%.3g</td>", name,
          unit_words(unit), model, scale * e->rms[0], scale * e->rms[1]);
  if (isfinite(e->held_out_rms[0]))
    fprintf(out, "<td>%.3g</td><td>%.3g</td></tr>\n", scale * e->held_out_rms[0],
            scale * e->held_out_rms[1]);
  else
    fputs("<td>–</td><td>–</td></tr>\n", out);
}

static void put_errors(FILE *out, const fg_scan_loop_bumps *bumps) {
  fputs(
      "<div class=\"scroll\"><table><tr><th>rms about the declared model</th><th class=\"w\">model"
      "</th><th>before</th><th>after</th><th>kept aside, before</th><th>after</th></tr>\n",
      out);
  for (size_t r = 0; r < FG_SCAN_LOOP_BUMP_RESPONSES; r++)
    put_error(out, response_words[r], fg_scan_loop_bump_responses[r].model,
              fg_scan_loop_bump_responses[r].unit, &bumps->level[r].error,
              fg_scan_loop_bump_responses[r].scale);
  put_error(out, "height", "follows from both", "um", &bumps->height, 1000);
  fputs("</table></div>\n", out);
}

void fg_scan_loop_page_bumps(FILE *out, const fg_scan_loop_bumps *bumps) {
  bool judged = false;
  for (size_t r = 0; r < FG_SCAN_LOOP_BUMP_RESPONSES; r++)
    judged |= bumps->level[r].judged;
  if (!bumps->count && !bumps->notes) return;
  fputs("<section><h2 class=\"first\">The bumps against the declared springback</h2>\n", out);
  if (judged) {
    fputs("<p class=\"note\">The bumps as corrected. Dots: bumps, rings: kept aside. Orange: what "
          "was "
          "found.</p>\n<div class=\"two\">\n",
          out);
    for (size_t r = 0; r < FG_SCAN_LOOP_BUMP_RESPONSES; r++)
      put_response(out, bumps, r);
    fputs("</div>\n", out);
  }
  if (bumps->count) put_candidates(out, bumps);
  if (judged) put_errors(out, bumps);
  for (size_t i = 0; i < bumps->notes; i++) {
    fputs("<p class=\"note\">", out);
    fg_html_text(out, bumps->note[i]);
    fputs("</p>\n", out);
  }
  fputs("</section>\n", out);
}
