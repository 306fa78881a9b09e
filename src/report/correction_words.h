/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Results of a correction, dimension by dimension: words and members. */
#ifndef FG_REPORT_CORRECTION_WORDS_H
#define FG_REPORT_CORRECTION_WORDS_H

#include "core/member.h"
#include "foilgauge/foil.h"

enum { FG_CHOICE_WORDS = 240 };

/* "R0", "R", "h". */
const char *fg_corrected_symbol(fg_corrected dimension);
const char *fg_correction_reason_words(fg_correction_reason reason);

/* True when a correction that is not small was estimated, but the dimension was left as
 * measured. */
bool fg_correction_is_left_out(const fg_correction_choice *choice);

/* "R left as measured: the correction is 1.2 ± 1.9 µm and would add more error than it removes";
 * with `plain` in ASCII. Empty for a corrected dimension. */
void fg_choice_words(const char *symbol, const fg_correction_choice *choice, bool plain,
                     char words[FG_CHOICE_WORDS]);

/* Writes these words of all uncorrected dimensions as a paragraph; nothing where all were
 * corrected. */
void fg_html_choices(FILE *out, const fg_foil *foil);
void fg_html_disc_choice(FILE *out, const fg_disc *disc);

/* Row "corrections" of an fg_foil or an fg_disc: FG_CHOICES(fg_foil_choice_at,
 * fg_foil_has_choices).
 */
extern const fg_members fg_choice_members;
bool fg_foil_choice_at(const fg_subject *list, size_t i, fg_subject *element);
bool fg_foil_has_choices(const fg_subject *subject);
bool fg_disc_choice_at(const fg_subject *list, size_t i, fg_subject *element);
bool fg_disc_has_choice(const fg_subject *subject);
#define FG_CHOICES(choice_at, has_choices)                                                         \
  FG_LIST_BY("corrections", choice_at, &fg_choice_members),                                        \
      .present = (has_choices), .options = FG_MEMBER_ON_LINE, .words = FG_CHOICES_WORDS
#define FG_CHOICES_WORDS                                                                           \
  "what a scanner's model or a loop would correct, dimension by dimension, over all bumps of a "   \
  "foil or all discs of a scan: a dimension is moved only where that lowers the expected error, "  \
  "and else left as measured"

/* Rows of an fg_correction, and the presence of that of a foil. Definition "correction" of
 * measure. */
extern const fg_members fg_correction_members;
bool fg_foil_is_corrected(const fg_subject *subject);
#define FG_CORRECTION_WORDS_OF_MODEL                                                               \
  "what the scanner's model did: corrected minus as scanned, of the bumps the largest; u_ is "     \
  "what "                                                                                          \
  "it added, in squares, to the u_ of that value"

#endif
