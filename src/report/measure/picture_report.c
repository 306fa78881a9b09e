/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/measure/picture_report.h"

#include <math.h>

#include "foilgauge/picture.h"
#include "page/page.h"
#include "report/measure/drawing.h"

static double value_of(const fg_picture_state *state, const fg_picture_member *member) {
  return *(const double *)((const char *)state + member->offset);
}

static void write_finding(fg_json *json, const fg_picture_words *words) {
  fg_json_object(json, NULL);
  fg_json_string(json, "finding", words->name);
  fg_json_string(json, "meaning", words->meaning);
  fg_json_string(json, "cure", words->cure);
  fg_json_string(json, "sane", words->sane[0] ? words->sane : NULL);
  fg_json_string(json, "twain", words->twain[0] ? words->twain : NULL);
  fg_json_string(json, "wia", words->wia[0] ? words->wia : NULL);
  fg_json_object_end(json);
}

void fg_json_picture_state(fg_json *json, const fg_measurement *measurement) {
  const fg_picture_state *state = &measurement->picture;
  fg_json_object(json, "picture");
  for (const fg_picture_member *member = fg_picture_members(); member->name; member++)
    fg_json_number(json, member->name, value_of(state, member));
  fg_json_array(json, "findings");
  for (const fg_picture_words *words = fg_picture_finding_words(); words->name; words++)
    if (state->findings & words->finding) write_finding(json, words);
  fg_json_array_end(json);
  fg_json_object_end(json);
}

void fg_text_picture_state(FILE *out, const fg_measurement *measurement) {
  for (const fg_picture_words *words = fg_picture_finding_words(); words->name; words++)
    if (measurement->picture.findings & words->finding)
      fprintf(out, "picture: %s: %s %s\n", words->name, words->meaning, words->cure);
}

/* Writes the driver's setting by the names that drivers have for it. */
static void put_settings(FILE *out, const fg_picture_words *words) {
  const char *const names[] = {"SANE", "TWAIN", "WIA"};
  const char *const settings[] = {words->sane, words->twain, words->wia};
  const char *before = "<br><span class=\"note\">";
  for (int i = 0; i < 3; i++) {
    if (!settings[i][0]) continue;
    fprintf(out, "%s%s: ", before, names[i]);
    fg_html_text(out, settings[i]);
    before = " · ";
  }
  if (before[0] == ' ') fputs("</span>", out);
}

static void put_findings(FILE *out, const fg_picture_state *state) {
  fputs("<ul class=\"flags\">\n", out);
  for (const fg_picture_words *words = fg_picture_finding_words(); words->name; words++) {
    if (!(state->findings & words->finding)) continue;
    fprintf(out, "<li><b>%s</b> %s", words->meaning, words->cure);
    put_settings(out, words);
    fputs("</li>\n", out);
  }
  fputs("</ul>\n", out);
}

void fg_html_picture_state(FILE *out, const fg_measurement *measurement) {
  const fg_picture_state *state = &measurement->picture;
  fputs("<h2>State of the picture</h2>\n", out);
  if (state->findings)
    put_findings(out, state);
  else
    fputs("<p class=\"note\">Nothing was found that a scanner's driver or the light has done to "
          "the picture.</p>\n",
          out);
  fputs("<details>\n<summary>What was measured of it</summary>\n<table>\n<tbody>\n", out);
  for (const fg_picture_member *member = fg_picture_members(); member->name; member++) {
    double value = value_of(state, member);
    if (!isfinite(value)) continue;
    fprintf(out, "<tr><td class=\"words\">%s</td><td>%.*f</td><td>%s</td></tr>\n", member->words,
            member->decimals, value, member->unit);
  }
  fputs("</tbody>\n</table>\n</details>\n", out);
}
