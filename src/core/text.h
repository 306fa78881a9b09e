/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text that the callee allocates, which is public. */
#ifndef FG_CORE_TEXT_H
#define FG_CORE_TEXT_H

#include "foilgauge/text.h"

/* Appends a blank and a word of a command, quoted where a shell would not take it for one word. */
fg_status fg_text_append_word(fg_context *ctx, char **text, const char *word);

#endif
