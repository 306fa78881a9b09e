/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "manual/page.h"

#include <argp.h>
#include <stdlib.h>
#include <string.h>

#include "cli/facts.h"
#include "manual/roff.h"

/* Pages that are of no command. */
static const struct {
  char name[24], section;
} see_also[] = {{"foilgauge-design", '5'}, {"foilgauge-recipe", '5'}, {"foilgauge-scanning", '7'}};

/* Fills the facts of the code into a parser's text; the caller frees. */
static void fill_facts(const char *text, bool *known, char **whole) {
  size_t size;
  FILE *out = open_memstream(whole, &size);
  if (!out) abort();
  *known = fg_facts_write(text, NULL, out) && *known;
  if (fclose(out) != 0) abort();
}

static void write_escaped(const char *text, FILE *out) {
  fg_roff_escape(text, strlen(text), out);
}

static void write_synopsis_line(const char *words, const char *arguments, size_t length,
                                FILE *out) {
  fputs(".br\n.B foilgauge ", out);
  write_escaped(words, out);
  fputs("\n[\\fIOPTION\\fR...] \\fI", out);
  fg_roff_escape(arguments, length, out);
  fputs("\\fR\n", out);
}

/* One line for each of the parser's alternatives. */
static void write_synopsis(const fg_command *command, FILE *out) {
  fputs(".SH SYNOPSIS\n", out);
  for (size_t i = 0; i < FG_COMMAND_USAGES && command->usage[i].parser; i++) {
    const char *arguments = command->usage[i].parser->args_doc;
    do {
      size_t length = strcspn(arguments, "\n");
      write_synopsis_line(command->usage[i].words, arguments, length, out);
      arguments += length;
    } while (*arguments++ == '\n');
  }
}

/* Writes the paragraphs of a parser's text as those of a manual; an example is indented by two
 * blanks there. */
static bool write_paragraphs(const char *text, FILE *out) {
  char *marked = NULL;
  size_t size;
  FILE *lines = open_memstream(&marked, &size);
  if (!lines) abort();
  while (*text) {
    size_t length = strcspn(text, "\n");
    if (!strncmp(text, "  ", 2)) fputs("\n  ", lines);
    fprintf(lines, "%.*s\n", (int)length, text);
    text += length + (text[length] == '\n');
  }
  if (fclose(lines) != 0) abort();
  bool right = fg_roff_text(marked, out);
  free(marked);
  return right;
}

/* Returns the paragraph of a parser's text on exit codes, or NULL. */
static const char *find_exit(const char *text) {
  return strstr(text, "@exit_");
}

static void write_description(const fg_command_usage *usage, bool *known, FILE *out) {
  char *doc = strdup(usage->parser->doc);
  if (!doc) abort();
  char *after = strchr(doc, '\v'), *end = (char *)(uintptr_t)find_exit(doc);
  if (end) *end = '\0';
  if (after) *after = '\n';
  char *whole = NULL;
  fill_facts(doc, known, &whole);
  char *line = after ? strchr(whole, '\n') : NULL;
  if (line) *line = '\0';
  *known = write_paragraphs(whole, out) && *known;
  if (line) *known = write_paragraphs(line + 1, out) && *known;
  free(whole);
  free(doc);
}

static void write_option(const struct argp_option *option, bool *known, FILE *out) {
  bool optional = option->flags & OPTION_ARG_OPTIONAL;
  fputs(".TP\n", out);
  if (option->key > ' ' && option->key < 127) fprintf(out, "\\fB\\-%c\\fR, ", option->key);
  fputs("\\fB\\-\\-", out);
  write_escaped(option->name, out);
  fputs("\\fR", out);
  if (option->arg) {
    fputs(optional ? "[=\\fI" : "=\\fI", out);
    write_escaped(option->arg, out);
    fputs(optional ? "\\fR]" : "\\fR", out);
  }
  fputc('\n', out);
  char *words = NULL;
  fill_facts(option->doc, known, &words);
  fg_roff_inline(words, strlen(words), out);
  fputc('\n', out);
  free(words);
}

static void write_options(const fg_command *command, bool *known, FILE *out) {
  fputs(".SH OPTIONS\n", out);
  for (size_t i = 0; i < FG_COMMAND_USAGES && command->usage[i].parser; i++) {
    const fg_command_usage *usage = &command->usage[i];
    const struct argp_option *option = usage->parser->options;
    if (usage->title) fprintf(out, ".SS %s\n", usage->title);
    for (; option->name || option->doc; option++) {
      if (option->name) write_option(option, known, out);
      if (!option->name) fprintf(out, ".PP\n%s\n", option->doc);
    }
  }
  fputs(command->usage[1].parser ? ".SS Of both\n" : "", out);
  fputs(".TP\n\\fB\\-\\-help\\fR\nPrint what the command line takes, and end.\n"
        ".TP\n\\fB\\-\\-usage\\fR\nThe same in short.\n",
        out);
}

/* `kind` begins behind an @ and ends with one. */
static void write_exit_codes(const char *kind, FILE *out) {
  size_t length = strcspn(kind, "@");
  for (const fg_exit_code *code = fg_exit_codes; code->words; code++)
    if (fg_exit_codes_use(kind, length, code))
      fprintf(out, ".TP\n%d\n%s\n", code->code, code->words);
}

static void write_exit_status(const fg_command *command, bool *known, FILE *out) {
  const char *last = NULL;
  fputs(".SH EXIT STATUS\n", out);
  for (size_t i = 0; i < FG_COMMAND_USAGES && command->usage[i].parser; i++) {
    const char *found = find_exit(command->usage[i].parser->doc);
    if (!found || (last && !strncmp(found, last, strcspn(found + 1, "@")))) continue;
    if (command->usage[i].title) fprintf(out, ".SS %s\n", command->usage[i].title);
    write_exit_codes(found + 1, out);
    char *rest = NULL;
    fill_facts(found + 2 + strcspn(found + 1, "@"), known, &rest);
    if (*rest) fputs(".PP\n", out);
    *known = write_paragraphs(rest, out) && *known;
    free(rest);
    last = found;
  }
}

static void write_reference(const char *name, size_t length, char section, bool first, FILE *out) {
  fputs(first ? "\\fB" : ",\n\\fB", out);
  fg_roff_escape(name, length, out);
  fprintf(out, "\\fR(%c)", section);
}

/* Lists every page but this one. */
static void write_see_also(const char *self, char section, FILE *out) {
  static const char program[] = "foilgauge";
  bool first = strcmp(self, program) == 0;
  fputs(".SH SEE ALSO\n", out);
  if (!first) write_reference(program, strlen(program), '1', true, out);
  for (const fg_command *command = fg_commands; command->name; command++) {
    char name[80];
    snprintf(name, sizeof name, "%s-%s", program, command->name);
    if (section == '1' && !strcmp(self, name)) continue;
    write_reference(name, strlen(name), '1', first, out);
    first = false;
  }
  for (size_t i = 0; i < sizeof see_also / sizeof *see_also; i++)
    if (section != see_also[i].section || strcmp(self, see_also[i].name) != 0)
      write_reference(see_also[i].name, strlen(see_also[i].name), see_also[i].section, false, out);
  fputc('\n', out);
}

static void write_head(const fg_manual_text *text, FILE *out) {
  fputs(".\\\" Written by foilgauge_manual (src/manual/).\n.nr HY 0\n.ss 12 0\n.TH \"", out);
  for (const char *c = text->name; *c; c++)
    fputc(*c >= 'a' && *c <= 'z' ? *c - 32 : *c, out);
  fprintf(out, "\" \"%c\" \"\" \"foilgauge %s\" \"foilgauge\"\n.ad l\n.SH NAME\n", text->section,
          FOILGAUGE_VERSION);
  write_escaped(text->name, out);
  fputs(" \\- ", out);
  write_escaped(text->summary, out);
  fputc('\n', out);
}

static bool write_part(const char *from, const char *to, FILE *out) {
  char *part = strndup(from, (size_t)(to - from));
  if (!part) abort();
  bool right = fg_roff_text(part, out);
  free(part);
  return right;
}

bool fg_manual_write_page(const fg_manual_text *text, const fg_command *command, FILE *out) {
  bool known = true, several = command && command->usage[1].parser;
  const char *body = text->body, *end = body + strlen(body);
  const char *sections = strstr(body, "\n## ");
  const char *examples = strstr(body, "\n## Examples\n");
  if (!sections) sections = end;
  if (!examples) examples = end;
  write_head(text, out);
  if (command) write_synopsis(command, out);
  fputs(".SH DESCRIPTION\n", out);
  if (several) known = write_part(body, sections, out) && known;
  for (size_t i = 0; command && i < FG_COMMAND_USAGES && command->usage[i].parser; i++) {
    if (command->usage[i].title) fprintf(out, ".SS %s\n", command->usage[i].title);
    write_description(&command->usage[i], &known, out);
  }
  if (!several) known = write_part(body, sections, out) && known;
  if (command) write_options(command, &known, out);
  known = write_part(sections, examples, out) && known;
  if (command) write_exit_status(command, &known, out);
  known = write_part(examples, end, out) && known;
  write_see_also(text->name, text->section, out);
  return known;
}

void fg_manual_write_examples(const fg_manual_text *text, FILE *out) {
  const char *at = strstr(text->body, "\n## Examples\n");
  const char *end = at ? strstr(at + 4, "\n## ") : NULL;
  for (at = at ? at + 1 : NULL; at && *at && (!end || at < end);) {
    size_t length = strcspn(at, "\n");
    if (length > 4 && !strncmp(at, "    ", 4)) {
      bool goes_on = at[length - 1] == '\\';
      fprintf(out, "%.*s%s", (int)(length - 4 - goes_on), at + 4, goes_on ? " " : "\n");
    }
    at += length + (at[length] == '\n');
  }
}
