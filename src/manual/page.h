/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pages of the manual, and the completion of the shell: both of the commands' parsers. */
#ifndef FG_MANUAL_PAGE_H
#define FG_MANUAL_PAGE_H

#include <stdbool.h>
#include <stdio.h>

#include "cli/commands.h"

/* A text of src/manual/text: "# name(section) - summary", then paragraphs and sections. */
typedef struct fg_manual_text {
  char name[64], summary[200];
  char section;     /* '1', '5' */
  const char *body; /* after the title, with the facts filled in */
} fg_manual_text;

/* Writes a page; `command` is NULL for pages of no command. Returns true when every fact that it
 * names is known. */
bool fg_manual_write_page(const fg_manual_text *text, const fg_command *command, FILE *out);

void fg_manual_write_completion(FILE *out);

/* Writes the examples of a text, a command a line. */
void fg_manual_write_examples(const fg_manual_text *text, FILE *out);

#endif
