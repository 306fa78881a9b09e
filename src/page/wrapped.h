/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text wrapped to the width of a terminal. */
#ifndef FG_PAGE_WRAPPED_H
#define FG_PAGE_WRAPPED_H

#include <stdio.h>

/* Writes text in lines of a terminal that is not too narrow: the first line starts with `first`,
 * the others with `indent`. A word longer than a line gets a line of its own. */
void fg_write_wrapped(FILE *out, const char *first, const char *indent, const char *text);

#endif
