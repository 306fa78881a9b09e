/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text for a terminal. */
#ifndef FG_PAGE_WRAPPED_H
#define FG_PAGE_WRAPPED_H

#include <stdio.h>

/* Lines of a terminal that is not too narrow: the first one starts with `first`, the others with
 * `indent`. Words that are longer than a line stand alone. */
void fg_write_wrapped(FILE *out, const char *first, const char *indent, const char *text);

#endif
