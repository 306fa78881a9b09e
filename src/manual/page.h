/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pages of the manual, and the completion of the shell: both of the commands' parsers. */
#ifndef FG_MANUAL_PAGE_H
#define FG_MANUAL_PAGE_H

#include <stdbool.h>
#include <stdio.h>

#include "cli/commands.h"

/* A text of src/manual/text: "# name(section) - what it is", then paragraphs and sections. */
typedef struct fg_manual_text {
  char name[64], summary[200];
  char section;     /* '1', '5' */
  const char *body; /* what follows the title, with what the code knows put in */
} fg_manual_text;

/* `command` is NULL for pages that are of none. Whether all is known that is named in it. */
bool fg_manual_write_page(const fg_manual_text *text, const fg_command *command, FILE *out);

void fg_manual_write_completion(FILE *out);

/* The examples of a text, a command a line. */
void fg_manual_write_examples(const fg_manual_text *text, FILE *out);

#endif
