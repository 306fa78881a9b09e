/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Completion for bash: commands, their options, and files by the name of an option's argument. */
#include <argp.h>
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "cli/facts.h"
#include "manual/facts.h"
#include "manual/page.h"

/* Head of the completion, before the commands' cases: _foilgauge_words completes by words,
 * _foilgauge_files by endings (none: any). */
static const char head[] =
    "# Completion of foilgauge for bash. Written by foilgauge_manual (src/manual/).\n"
    "_foilgauge_words() {\n"
    "  mapfile -t COMPREPLY < <(compgen -W \"$1\" -- \"$word\")\n"
    "}\n"
    "_foilgauge_files() {\n"
    "  local file ending IFS=$'\\n'\n"
    "  compopt -o filenames 2>/dev/null\n"
    "  COMPREPLY=($(compgen -d -- \"$word\"))\n"
    "  for file in $(compgen -f -- \"$word\"); do\n"
    "    [ -d \"$file\" ] && continue\n"
    "    [ -z \"$1\" ] && COMPREPLY+=(\"$file\")\n"
    "    IFS=' '\n"
    "    for ending in $1; do\n"
    "      [ \"${file: -${#ending}}\" = \"$ending\" ] && COMPREPLY+=(\"$file\")\n"
    "    done\n"
    "  done\n"
    "}\n"
    "_foilgauge_folders() {\n"
    "  local IFS=$'\\n'\n"
    "  compopt -o filenames 2>/dev/null\n"
    "  COMPREPLY=($(compgen -d -- \"$word\"))\n"
    "}\n"
    "_foilgauge() {\n"
    "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}\n"
    "  local command=${COMP_WORDS[1]}\n"
    "  if [ \"$word\" = = ]; then word=; elif [ \"$before\" = = ]; then "
    "before=${COMP_WORDS[COMP_CWORD-2]}; fi\n"
    "  COMPREPLY=()\n";

static const char tail[] = "}\ncomplete -F _foilgauge foilgauge\n";

static const struct {
  const char *argument, *fact;
} words_of[] = {{"CHANNEL", "channels"}, {"FORM", "forms"}, {"PAGES", "pages"}};

/* Writes the words of a list in running text, "a, b or c", without its commas. */
static void write_words(const char *fact, FILE *out) {
  char *list = NULL, *rest = NULL;
  size_t size;
  FILE *stream = open_memstream(&list, &size);
  if (!stream) abort();
  fg_fact_find(fact, strlen(fact))->write(stream);
  if (fclose(stream) != 0) abort();
  for (char *word = strtok_r(list, ", ", &rest); word; word = strtok_r(NULL, ", ", &rest))
    if (strcmp(word, "or") != 0) fprintf(out, "%s ", word);
  free(list);
}

static bool is_folder(const char *argument) {
  return strstr(argument, "DIR") || strstr(argument, "FOLDER");
}

/* True for names of files: "FILE.json", "SCAN.png". */
static bool is_file(const char *argument) {
  return strstr(argument, "FILE") || strchr(argument, '.') || !strcmp(argument, "SCAN");
}

static void write_scans(FILE *out) {
  char *list = NULL, *rest = NULL;
  size_t size;
  FILE *stream = open_memstream(&list, &size);
  if (!stream) abort();
  fg_manual_fact("scan_endings", strlen("scan_endings"))->write(stream);
  if (fclose(stream) != 0) abort();
  fputs("_foilgauge_files '", out);
  for (char *word = strtok_r(list, ", ", &rest); word; word = strtok_r(NULL, ", ", &rest))
    fprintf(out, "%s ", word);
  fputs("'", out);
  free(list);
}

static void write_choice(const char *argument, FILE *out) {
  for (size_t i = 0; i < sizeof words_of / sizeof *words_of; i++)
    if (!strcmp(argument, words_of[i].argument)) {
      fputs("_foilgauge_words '", out);
      write_words(words_of[i].fact, out);
      fputs("'", out);
      return;
    }
  const char *ending = strrchr(argument, '.');
  bool has_ending = ending && islower((unsigned char)ending[1]);
  if (!strncmp(argument, "SCAN", 4) && !has_ending)
    write_scans(out);
  else if (is_folder(argument))
    fputs("_foilgauge_folders", out);
  else if (is_file(argument))
    fprintf(out, "_foilgauge_files '%s'", has_ending ? ending : "");
  else
    fputs(":", out);
}

static void write_values(const char *command, const struct argp *parser, FILE *out) {
  for (const struct argp_option *option = parser->options; option->name || option->doc; option++) {
    if (!option->name || !option->arg) continue;
    fprintf(out, "    %s:--%s", command, option->name);
    if (option->key > ' ' && option->key < 127) fprintf(out, "|%s:-%c", command, option->key);
    fputs(") ", out);
    write_choice(option->arg, out);
    fputs("; return ;;\n", out);
  }
}

static bool has_option(const struct argp *parser, const char *name) {
  for (const struct argp_option *option = parser->options; option->name || option->doc; option++)
    if (option->name && !strcmp(option->name, name)) return true;
  return false;
}

/* Options that an earlier usage of the command has named are left out. */
static void write_names(const fg_command *command, size_t usage, FILE *out) {
  const struct argp_option *option = command->usage[usage].parser->options;
  for (; option->name || option->doc; option++) {
    bool named = !option->name;
    for (size_t i = 0; i < usage && !named; i++)
      named = has_option(command->usage[i].parser, option->name);
    if (!named) fprintf(out, "--%s%s ", option->name, option->arg ? "=" : "");
  }
}

static void write_command(const fg_command *command, FILE *out) {
  fprintf(out, "    %s:-*) _foilgauge_words '", command->name);
  for (size_t i = 0; i < FG_COMMAND_USAGES && command->usage[i].parser; i++)
    write_names(command, i, out);
  fputs("--help'\n      [[ ${COMPREPLY[0]} == *= ]] && compopt -o nospace 2>/dev/null ;;\n", out);
  fprintf(out, "    %s:*) ", command->name);
  write_choice(command->usage[0].parser->args_doc, out);
  fputs(" ;;\n", out);
}

void fg_manual_write_completion(FILE *out) {
  fputs(head, out);
  fputs("  if [ \"$COMP_CWORD\" = 1 ] || [ \"$COMP_CWORD\" = 2 -a \"$command\" = help ]; then\n"
        "    _foilgauge_words '",
        out);
  for (const fg_command *command = fg_commands; command->name; command++)
    fprintf(out, "%s ", command->name);
  fputs("help version'\n    return\n  fi\n", out);
  for (const fg_command *command = fg_commands; command->name; command++)
    if (command->alias)
      fprintf(out, "  [ \"$command\" = %s ] && command=%s\n", command->alias, command->name);
  fputs("  case $command:$before in\n", out);
  for (const fg_command *command = fg_commands; command->name; command++)
    for (size_t i = 0; i < FG_COMMAND_USAGES && command->usage[i].parser; i++)
      write_values(command->name, command->usage[i].parser, out);
  fputs("  esac\n  case $command:$word in\n", out);
  for (const fg_command *command = fg_commands; command->name; command++)
    write_command(command, out);
  fputs("  esac\n", out);
  fputs(tail, out);
}
