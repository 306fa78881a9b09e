/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sentences that every report of `forming` has. */
#ifndef FG_REPORT_FORMING_WORDS_H
#define FG_REPORT_FORMING_WORDS_H

#include "foilgauge/forming.h"

enum { FG_FORMING_NOTE = 600, FG_FORMING_NOTES = 8 };

/* Writes the caveats of this run; returns their number. */
size_t fg_forming_notes(const fg_forming *forming, char notes[FG_FORMING_NOTES][FG_FORMING_NOTE]);

/* Describes the heat treatment: "3.25 h at 650 degrees C", "as bent, without heat treatment", "a
 * schedule of 12 h up to 650 ...". */
void fg_forming_treatment(const fg_forming *forming, char *text, size_t size);

/* Writes the caveats of a fit; returns their number. */
size_t fg_forming_fit_notes(const fg_forming_fit *fit,
                            char notes[FG_FORMING_NOTES][FG_FORMING_NOTE]);

/* Describes the interval of a constant: "2.81 to open", "at its bound: not identified". */
void fg_forming_found_words(const fg_forming_found *found, char *text, size_t size);

/* Returns the word of a shape: "arcs", "sine". */
const char *fg_forming_shape_word(fg_forming_shape shape);

extern const char fg_forming_out_of_reach[];

#endif
