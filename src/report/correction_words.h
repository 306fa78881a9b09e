/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Results of a correction, dimension by dimension: words and JSON. */
#ifndef FG_REPORT_CORRECTION_WORDS_H
#define FG_REPORT_CORRECTION_WORDS_H

#include "core/json_writer.h"
#include "foilgauge/foil.h"

enum { FG_CHOICE_WORDS = 240 };

/* "R0", "R", "h". */
const char *fg_corrected_symbol(fg_corrected dimension);
const char *fg_correction_reason_words(fg_correction_reason reason);

/* True when a correction that is not small was estimated, but the dimension was left as
 * measured. */
bool fg_choice_is_left(const fg_correction_choice *choice);

/* "R left as measured: the correction is 1.2 ± 1.9 µm and would add more error than it removes";
 * with `plain` in ASCII. Empty for a corrected dimension. */
void fg_choice_words(const char *symbol, const fg_correction_choice *choice, bool plain,
                     char words[FG_CHOICE_WORDS]);

/* Writes these words of all uncorrected dimensions as a paragraph; nothing where all were
 * corrected. */
void fg_html_choices(FILE *out, const fg_foil *foil);
void fg_html_disc_choice(FILE *out, const fg_disc *disc);

/* Writes the member `corrections` of a foil, and of a disc; nothing where nothing was corrected. */
void fg_json_choices(fg_json *json, const fg_foil *foil);
void fg_json_disc_choice(fg_json *json, const fg_disc *disc);

#endif
