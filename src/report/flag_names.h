/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names of flags and of a picture's findings, as JSON and CSV list them. */
#ifndef FG_REPORT_FLAG_NAMES_H
#define FG_REPORT_FLAG_NAMES_H

#include <stdio.h>

#include "core/json_writer.h"
#include "foilgauge/words.h"

/* For FG_TEXTS_BY: name `i`, "" where it is not among the flags, NULL behind the last. */
const char *fg_flag_name_at(const fg_flag_words *words, unsigned flags, unsigned findings,
                            size_t i);

/* Writes the names separated by blanks. */
void fg_flag_names(const fg_flag_words *words, unsigned flags, unsigned findings, char *text,
                   size_t size);

/* For its `choice_at`: every flag of a foil or a disc, the picture's findings among them; of a
 * bump; of a beam; every finding. */
const char *fg_foil_flag_choice(size_t i);
const char *fg_disc_flag_choice(size_t i);
const char *fg_bump_flag_choice(size_t i);
const char *fg_beam_flag_choice(size_t i);
const char *fg_finding_choice(size_t i);

/* Writes elements of an array that the caller has begun: flags of `words`, then picture
 * findings. */
void fg_json_flag_names(fg_json *json, const fg_flag_words *words, unsigned flags,
                        unsigned findings);

/* Writes a comma and one cell with the same names, separated by blanks. */
void fg_csv_put_flags(FILE *out, const fg_flag_words *words, unsigned flags, unsigned findings);

#endif
