/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names of flags and of a picture's findings, as JSON and CSV list them. */
#ifndef FG_REPORT_FLAG_NAMES_H
#define FG_REPORT_FLAG_NAMES_H

#include <stdio.h>

#include "core/json_writer.h"
#include "foilgauge/words.h"

/* Writes elements of an array that the caller has begun: flags of `words`, then picture
 * findings. */
void fg_json_flag_names(fg_json *json, const fg_flag_words *words, unsigned flags,
                        unsigned findings);

/* Returns name `i`, "" where it is not among the flags, NULL behind the last. With all bits set it
 * lists what can be named. */
const char *fg_flag_name_at(const fg_flag_words *words, unsigned flags, unsigned findings,
                            size_t i);

/* Writes the names separated by blanks. */
void fg_flag_names(const fg_flag_words *words, unsigned flags, unsigned findings, char *text,
                   size_t size);

/* Writes a comma and one cell with the same names, separated by blanks. */
void fg_csv_put_flags(FILE *out, const fg_flag_words *words, unsigned flags, unsigned findings);

#endif
