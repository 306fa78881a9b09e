/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/measure/picture_report.h"

#include <math.h>

#include "foilgauge/picture.h"
#include "page/page.h"
#include "report/flag_names.h"
#include "report/measure/drawing.h"

static double value_of(const fg_picture_state *state, const fg_picture_member *member) {
  return *(const double *)((const char *)state + member->offset);
}

/* A value of the state. */
static bool picture_row_at(size_t i, fg_member *row) {
  const fg_picture_member *member = fg_picture_members();
  for (; member->name && i > 0; i--)
    member++;
  *row = (fg_member){.name = member->name,
                     .kind = FG_MEMBER_NUMBER,
                     .offset = member->offset,
                     .words = member->words};
  return member->name != NULL;
}

static bool find_finding(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_picture_words *words = &fg_picture_finding_words()[i];
  const fg_picture_state *state = list->object;
  element->object = state->findings & words->finding ? words : NULL;
  return words->name != NULL;
}

static const fg_member finding_rows[] = {
    {FG_STRING("finding", fg_picture_words, name), .choice_at = fg_finding_choice,
     .options = FG_MEMBER_NEVER_NULL},
    {FG_STRING("meaning", fg_picture_words, meaning), .options = FG_MEMBER_NEVER_NULL},
    {FG_STRING("cure", fg_picture_words, cure), .options = FG_MEMBER_NEVER_NULL},
    {FG_STRING("sane", fg_picture_words, sane), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "options of scanimage"},
    {FG_STRING("twain", fg_picture_words, twain), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "capabilities"},
    {FG_STRING("wia", fg_picture_words, wia), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "properties"},
};
static const fg_members finding_members = FG_MEMBERS(finding_rows);

static const fg_member picture_rows[] = {
    {FG_SAME_BY(picture_row_at)},
    {FG_LIST_BY("findings", find_finding, &finding_members),
     .words = "what spoils lengths, with the settings that cause it"},
};
const fg_members fg_picture_state_members = FG_MEMBERS_OF_FILE(picture_rows, "picture", "measure");

void fg_text_picture_state(FILE *out, const fg_measurement *measurement) {
  for (const fg_picture_words *words = fg_picture_finding_words(); words->name; words++)
    if (measurement->picture.findings & words->finding)
      fprintf(out, "picture: %s: %s %s\n", words->name, words->meaning, words->cure);
}

/* Writes the driver's setting by the names that drivers have for it. */
static void put_settings(FILE *out, const fg_picture_words *words) {
  const char *const names[] = {"SANE", "TWAIN", "WIA"};
  const char *const settings[] = {words->sane, words->twain, words->wia};
  const char *before =
      "<br><span class=\"note\" translate=\"no\">"; /* options, as drivers spell them */
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
