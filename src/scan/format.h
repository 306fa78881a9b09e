/* What a file is that should have been a PNG. */
#ifndef FG_SCAN_FORMAT_H
#define FG_SCAN_FORMAT_H

#include <stddef.h>
#include <stdint.h>

/* NULL when `head`, the first `length` bytes of a file, begins as a PNG does (a file shorter than
 * the signature counts as one that is cut off); else what is wrong and what to do, in words that
 * follow the file's name. */
const char *fg_format_problem(const uint8_t *head, size_t length);

#endif
