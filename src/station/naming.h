/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields in file names, by a pattern of text, `*` for anything and fields in braces. */
#ifndef FG_STATION_NAMING_H
#define FG_STATION_NAMING_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/status.h"

/* FG_IDENTITY_BYTES: of a stored field, which may have the number of a foil of its bed. */
enum { FG_NAMED_TEXT = 128, FG_IDENTITY_BYTES = FG_NAMED_TEXT + 16 };

typedef struct fg_named {
  char serial[FG_NAMED_TEXT], lot[FG_NAMED_TEXT], die[FG_NAMED_TEXT], operator_name[FG_NAMED_TEXT];
  char coil[FG_NAMED_TEXT], oven[FG_NAMED_TEXT], scanner[FG_NAMED_TEXT];
  char check[FG_NAMED_TEXT]; /* not "": the scan is one of the scanner's check */
} fg_named;

/* Keeps bytes of any length, of a file's name or an ERP's cell, as a text. Where that differs, being
 * cut or having bytes replaced, eight digits of the bytes' sum keep apart what would have one name. */
void fg_named_keep(char to[FG_NAMED_TEXT], const char *text, size_t length);

/* Checks a pattern. FG_ERR_DATA: an unknown field, an open brace, two fields without text
 * between them, a field twice. */
fg_status fg_naming_check(fg_context *ctx, const char *pattern);

/* Splits a file's name (without folder) into fields; bytes that are no UTF-8 or a control
 * character become U+FFFD. Its ending (from the last dot) does not count. A field is as short as
 * it can be, and one byte at least. False, with the whole name as the serial number, when the
 * name does not match. */
bool fg_naming_split(const char *pattern, const char *file, fg_named *named);

#endif
