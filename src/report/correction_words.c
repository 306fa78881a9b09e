/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/correction_words.h"

#include <math.h>

#include "core/file.h"
#include "core/text.h"
#include "foilgauge/report.h"
#include "page/page.h"
#include "report/value_words.h"

static const struct {
  const char *symbol, *name;
} dimensions[FG_CORRECTED] = {
    [FG_CORRECTED_OVERALL_RADIUS] = {"R0", "overall_radius_mm"},
    [FG_CORRECTED_RADIUS] = {"R", "radius_mm"},
    [FG_CORRECTED_HEIGHT] = {"h", "height_mm"},
};

const char *fg_corrected_symbol(fg_corrected dimension) {
  return dimensions[dimension].symbol;
}

const char *fg_correction_reason_words(fg_correction_reason reason) {
  switch (reason) {
  case FG_CORRECTION_HELPS:
    return "removes more error than it adds";
  case FG_CORRECTION_SMALL:
    return "is far below the value's own uncertainty";
  case FG_CORRECTION_DOUBTFUL:
    return "would add more error than it removes";
  case FG_CORRECTION_TIED:
    return "differs between explanations that the data cannot tell apart";
  case FG_CORRECTION_LOST:
    return "would leave other bumps than were measured";
  case FG_CORRECTION_NONE:
    break;
  }
  return "";
}

bool fg_choice_is_left(const fg_correction_choice *choice) {
  return choice->reason > FG_CORRECTION_SMALL && !choice->moved;
}

void fg_choice_words(const char *symbol, const fg_correction_choice *choice, bool plain,
                     char words[FG_CHOICE_WORDS]) {
  char size[80] = "";
  double um = 1000 * choice->move_mm, expanded = FG_COVERAGE_FACTOR * 1000 * choice->u_move_mm;
  words[0] = 0;
  if (!fg_choice_is_left(choice)) return;
  if (isfinite(um) && isfinite(expanded)) {
    int decimals = expanded > 0 ? (int)fmin(6, fmax(0, 1 - floor(log10(expanded)))) : 3;
    fg_text_clip(size, sizeof size, "%s%.*f %s %.*f %s ", "is ", decimals, um, plain ? "+-" : "±",
                 decimals, expanded, plain ? "um" : "µm");
  }
  fg_text_clip(words, FG_CHOICE_WORDS, "%s left as measured: the correction %s%s%s", symbol, size,
               size[0] ? "and " : "", fg_correction_reason_words(choice->reason));
}

static void put_left(FILE *out, const char *symbol, const fg_correction_choice *choice,
                     bool *opened) {
  char words[FG_CHOICE_WORDS];
  fg_choice_words(symbol, choice, false, words);
  if (!words[0]) return;
  fputs(*opened ? ". " : "<p class=\"corrected\">", out);
  *opened = true;
  fg_html_text(out, words);
}

void fg_html_choices(FILE *out, const fg_foil *foil) {
  bool opened = false;
  for (int k = 0; k < FG_CORRECTED; k++)
    put_left(out, dimensions[k].symbol, &foil->choice[k], &opened);
  if (opened)
    fputs(" (± is U = 2u, over the bumps rms). X, angles and clearances follow from R0, R and h as "
          "they stand here.</p>\n",
          out);
}

void fg_html_disc_choice(FILE *out, const fg_disc *disc) {
  bool opened = false;
  put_left(out, "The radii of the discs are", &disc->choice, &opened);
  if (opened) fputs(" (± is U = 2u, rms over the discs).</p>\n", out);
}

static void write_choice(fg_json *json, const char *name, const fg_correction_choice *choice) {
  fg_json_object(json, NULL);
  fg_json_line(json);
  fg_json_string(json, "quantity", name);
  fg_json_bool(json, "moved", choice->moved);
  fg_json_number(json, "move_mm", choice->move_mm);
  fg_json_number(json, "u_move_mm", choice->u_move_mm);
  fg_json_string(json, "reason", fg_correction_reason_words(choice->reason));
  fg_json_object_end(json);
  fg_json_line_end(json);
}

void fg_json_choices(fg_json *json, const fg_foil *foil) {
  bool any = false;
  for (int k = 0; k < FG_CORRECTED; k++)
    any = any || foil->choice[k].reason != FG_CORRECTION_NONE;
  if (!any) return;
  fg_json_array(json, "corrections");
  for (int k = 0; k < FG_CORRECTED; k++)
    if (foil->choice[k].reason != FG_CORRECTION_NONE)
      write_choice(json, dimensions[k].name, &foil->choice[k]);
  fg_json_array_end(json);
}

void fg_json_disc_choice(fg_json *json, const fg_disc *disc) {
  if (disc->choice.reason == FG_CORRECTION_NONE) return;
  fg_json_array(json, "corrections");
  write_choice(json, "radius_mm", &disc->choice);
  fg_json_array_end(json);
}
