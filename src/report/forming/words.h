/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What every report of `form` says in words. */
#ifndef FG_REPORT_FORMING_WORDS_H
#define FG_REPORT_FORMING_WORDS_H

#include "foilgauge/forming.h"

enum { FG_FORMING_NOTE = 600, FG_FORMING_NOTES = 8 };

/* What a reader must know of this run; the number of notes. */
size_t fg_forming_notes(const fg_forming *forming, char notes[FG_FORMING_NOTES][FG_FORMING_NOTE]);

/* "3.25 h at 650 degrees C", "as bent, without heat treatment", "a schedule of 12 h up to 650 ...".
 */
void fg_forming_treatment(const fg_forming *forming, char *text, size_t size);

/* How far a fit may be believed; the number of notes. */
size_t fg_forming_fit_notes(const fg_forming_fit *fit,
                            char notes[FG_FORMING_NOTES][FG_FORMING_NOTE]);

/* "2.81 to open", "at its bound: not identified": the interval of a constant. */
void fg_forming_found_words(const fg_forming_found *found, char *text, size_t size);

/* "arcs", "sine"; "bent", "heated", "free". */
const char *fg_forming_shape_word(fg_forming_shape shape);
const char *fg_forming_state_word(fg_forming_state state);

extern const char fg_forming_out_of_reach[];

#endif
