/* Where a text stops being JSON. */
#ifndef FG_CORE_JSON_SYNTAX_H
#define FG_CORE_JSON_SYNTAX_H

#include "foilgauge/status.h"

/* FG_ERR_DATA with the line and column of `at` in `text` (NULL: its begin), and that line: it
 * mostly names the member. */
fg_status fg_json_fail_syntax(fg_context *ctx, const char *path, const char *text, const char *at);

#endif
