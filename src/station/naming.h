/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a file's name says: a pattern of text, `*` for anything and fields in braces. */
#ifndef FG_STATION_NAMING_H
#define FG_STATION_NAMING_H

#include <stdbool.h>

#include "foilgauge/status.h"

enum { FG_NAMED_TEXT = 128 };

typedef struct fg_named {
  char serial[FG_NAMED_TEXT], lot[FG_NAMED_TEXT], die[FG_NAMED_TEXT], operator_name[FG_NAMED_TEXT];
  char check[FG_NAMED_TEXT]; /* not "": the scan is one of the scanner's check */
} fg_named;

/* FG_ERR_DATA: a field that there is not, a brace that is not closed, two fields without a text
 * between them, a field twice. */
fg_status fg_naming_check(fg_context *ctx, const char *pattern);

/* Takes a file's name (without folder) apart; bytes that are no UTF-8 or a control character become
 * U+FFFD. Its ending (from the last dot) does not count. A
 * field takes as little as it can, and at least one byte. False, and the whole name as the serial
 * number, when the name is not as the pattern says. */
bool fg_naming_take(const char *pattern, const char *file, fg_named *named);

#endif
