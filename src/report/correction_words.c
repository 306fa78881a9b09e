/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/correction_words.h"

#include <math.h>

#include "core/file.h"
#include "core/text.h"
#include "foilgauge/report.h"
#include "page/page.h"
#include "report/quantity_members.h"
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

bool fg_correction_is_left_out(const fg_correction_choice *choice) {
  return choice->reason > FG_CORRECTION_SMALL && !choice->moved;
}

void fg_choice_words(const char *symbol, const fg_correction_choice *choice, bool plain,
                     char words[FG_CHOICE_WORDS]) {
  char size[80] = "";
  double um = 1000 * choice->move_mm, expanded = FG_COVERAGE_FACTOR * 1000 * choice->u_move_mm;
  words[0] = 0;
  if (!fg_correction_is_left_out(choice)) return;
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

static const char *find_choice_quantity(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return dimensions[subject->index].name;
}

static const char *quantity_choice(size_t i) {
  return i < FG_CORRECTED ? dimensions[i].name : NULL;
}

static const char *find_choice_reason(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return fg_correction_reason_words(((const fg_correction_choice *)subject->object)->reason);
}

static const char *reason_choice(size_t i) {
  return i < FG_CORRECTION_LOST ? fg_correction_reason_words((fg_correction_reason)(i + 1)) : NULL;
}

static const fg_member choice_rows[] = {
    {FG_TEXT_BY("quantity", find_choice_quantity), .choice_at = quantity_choice,
     .options = FG_MEMBER_NEVER_NULL, .words = "dimension of a foil's bumps or of the discs"},
    {FG_FLAG("moved", fg_correction_choice, moved), .words = "it was corrected"},
    {FG_NUMBER_U("move_mm", fg_correction_choice, move_mm, u_move_mm),
     .words = "of the overall radius with its sign; of bumps and discs the root mean square; u_ "
              "with how far explanations lie from it"},
    {FG_TEXT_BY("reason", find_choice_reason), .choice_at = reason_choice,
     .options = FG_MEMBER_NEVER_NULL, .words = "why it was moved or left: the correction ..."},
};
const fg_members fg_choice_members = FG_MEMBERS_OF_FILE(choice_rows, "choice", "measure");

static bool find_choice(const fg_correction_choice *choice, fg_subject *element) {
  element->object = choice->reason == FG_CORRECTION_NONE ? NULL : choice;
  return true;
}

bool fg_foil_choice_at(const fg_subject *list, size_t i, fg_subject *element) {
  return i < FG_CORRECTED && find_choice(&((const fg_foil *)list->object)->choice[i], element);
}

bool fg_foil_has_choices(const fg_subject *subject) {
  const fg_foil *foil = subject->object;
  bool any = false;
  for (int k = 0; k < FG_CORRECTED; k++)
    any = any || foil->choice[k].reason != FG_CORRECTION_NONE;
  return any;
}

bool fg_disc_choice_at(const fg_subject *list, size_t i, fg_subject *element) {
  element->index = FG_CORRECTED_RADIUS;
  return i == 0 && find_choice(&((const fg_disc *)list->object)->choice, element);
}

bool fg_disc_has_choice(const fg_subject *subject) {
  return ((const fg_disc *)subject->object)->choice.reason != FG_CORRECTION_NONE;
}

static const fg_member correction_rows[] = {{FG_SAME_BY(fg_correction_quantity_at)}};
const fg_members fg_correction_members =
    FG_MEMBERS_OF_FILE(correction_rows, "correction", "measure");

bool fg_foil_is_corrected(const fg_subject *subject) {
  return isfinite(((const fg_foil *)subject->object)->correction.overall_radius_mm);
}
