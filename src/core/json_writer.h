/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A small streaming JSON writer: nothing written is held in memory.
 *
 * `name` is the member's name inside an object and NULL inside an array. Deterministic: ten
 * significant digits (`exact`: as many as reading the same number again takes), always a decimal
 * point; NaN and infinities are null. Strings become valid UTF-8 (a stray byte is written as \xE4).
 * Errors stay in the stream: the caller checks ferror at the end.
 */
#ifndef FG_CORE_JSON_WRITER_H
#define FG_CORE_JSON_WRITER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "core/utf8.h"

typedef struct fg_json {
  FILE *out;
  int depth;
  int line_depth;   /* > 0: members stay on one line */
  bool has_members; /* of the innermost open object or array */
  bool exact;       /* the following numbers lose no digit */
} fg_json;

void fg_json_begin(fg_json *json, FILE *out);
void fg_json_end(fg_json *json); /* writes the last newline */

void fg_json_object(fg_json *json, const char *name);
void fg_json_object_end(fg_json *json);
void fg_json_array(fg_json *json, const char *name);
void fg_json_array_end(fg_json *json);

/* Everything between the two calls stays on one line. */
void fg_json_line(fg_json *json);
void fg_json_line_end(fg_json *json);

void fg_json_number(fg_json *json, const char *name, double value);
void fg_json_integer(fg_json *json, const char *name, int64_t value);
void fg_json_bool(fg_json *json, const char *name, bool value);
void fg_json_string(fg_json *json, const char *name, const char *text); /* NULL: null */

/* Writes the begin of every report: the schema's name and this version. */
void fg_json_head(fg_json *json, const char *schema);

/* Writes an array of numbers on one line. */
void fg_json_numbers(fg_json *json, const char *name, const double *values, size_t count);

/* Writes a number under its name with a word before it: "u_" and "radius_mm". */
void fg_json_of(fg_json *json, const char *before, const char *name, double value);

/* Writes the digits of a number as in JSON, or "null". */
void fg_json_format(char text[32], double value);

#endif
