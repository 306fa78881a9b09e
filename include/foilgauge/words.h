/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words of flags and kinds: as JSON has them, and in plain words for people. */
#ifndef FOILGAUGE_WORDS_H
#define FOILGAUGE_WORDS_H

#include "foilgauge/report.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Flags of a foil are whole sentences, items of a list on its page. Flags of bumps and beams are
 * clauses without a capital and a full stop: they stand in a cell, or after "beam 3: ". */
typedef struct fg_flag_words {
  unsigned flag;
  const char *name;  /* in JSON and CSV: released, it stays */
  const char *plain; /* for people, on pages and the terminal: may be changed */
} fg_flag_words;

/* Tables that end with a row whose name is NULL. */
const fg_flag_words *fg_foil_flag_words(void);

/* Returns the flags that people should see: a sinusoidal foil has no lip by design. */
unsigned fg_foil_flags_told(const fg_design *design, const fg_foil *foil);
const fg_flag_words *fg_bump_flag_words(void);
const fg_flag_words *fg_beam_flag_words(void);

const char *fg_foil_kind_word(fg_foil_kind kind);
const char *fg_datum_word(fg_datum datum);
/* Writes the consequence for the clearances of a strip thicker or thinner than the design's; ""
 * where they agree within U. */
void fg_thickness_words(const fg_design *design, const fg_foil *foil, char *words, size_t size);

const char *fg_orientation_word(fg_orientation orientation);
const char *fg_arc_kind_word(fg_arc_kind kind);
const char *fg_channel_word(fg_channel channel);
const char *fg_colour_state_word(fg_colour_state state);

/* Returns the decimals of a value for people: U = 2 u shows two digits, or one where that is
 * fine enough. */
int fg_report_decimals(const fg_quantity *row, double u);

#ifdef __cplusplus
}
#endif
#endif
