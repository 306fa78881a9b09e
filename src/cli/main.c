/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <argp.h>
#include <stdio.h>
#include <string.h>

#include "cli/commands.h"
#include "cli/heap.h"
#include "cli/interrupt.h"
#include "cli/standard.h"

static void print_help(FILE *out) {
  fputs("foilgauge measures the foils of gas foil bearings from flatbed scans.\n\n"
        "Usage: foilgauge COMMAND [OPTION...]\n\nCommands:\n",
        out);
  for (const fg_command *command = fg_commands; command->name; command++)
    fprintf(out, "  %-10s %s\n", command->name, command->summary);
  fputs("\n`foilgauge help COMMAND` explains one command, `man foilgauge-COMMAND` all about it.\n",
        out);
}

static const fg_command *find_command(const char *name) {
  for (const fg_command *command = fg_commands; command->name; command++)
    if (!strcmp(command->name, name) || (command->alias && !strcmp(command->alias, name)))
      return command;
  return NULL;
}

static int no_command(const char *name) {
  fprintf(stderr, "foilgauge: no command '%s'; `foilgauge help` lists them\n", name);
  return fg_status_exit_code(FG_ERR_USAGE);
}

static void help_usage(const fg_command_usage *usage) {
  char words[64];
  snprintf(words, sizeof words, "foilgauge %s", usage->words);
  argp_help(usage->parser, stdout, ARGP_HELP_STD_HELP, words);
}

/* Prints the help of one usage that has words of its own: `help doe plan`. */
static int help_part(const fg_command *command, const char *part) {
  char words[64];
  snprintf(words, sizeof words, "%s %s", command->name, part);
  for (size_t i = 0; i < FG_COMMAND_USAGES && command->usage[i].parser; i++)
    if (!strcmp(command->usage[i].words, words)) {
      help_usage(&command->usage[i]);
      return 0;
    }
  return no_command(words);
}

/* Prints the text of `foilgauge COMMAND --help` for every usage. */
static int help_command(const char *name, const char *part) {
  const fg_command *command = find_command(name);
  if (!command) return no_command(name);
  if (part) return help_part(command, part);
  for (size_t i = 0; i < FG_COMMAND_USAGES && command->usage[i].parser; i++) {
    const fg_command_usage *usage = &command->usage[i];
    if (usage->title) printf("%s%s\n\n", i ? "\n\n" : "", usage->title);
    help_usage(usage);
  }
  return 0;
}

static int run_command(int argc, char **argv) {
  char words[64];
  const fg_command *command = find_command(argv[0]);
  if (!command) return no_command(argv[0]);
  snprintf(words, sizeof words, "foilgauge %s", command->name);
  argv[0] = words;
  return command->run(argc, argv);
}

int main(int argc, char **argv) {
  fg_standard_start();
  if (!fg_stack_reserve()) {
    fputs("foilgauge: out of memory: the stack; raise the limit of address space (ulimit -v)\n",
          stderr);
    return fg_status_exit_code(FG_ERR_MEMORY);
  }
  fg_interrupt_start();
  fg_heap_start();
  if (argc < 2) {
    print_help(stderr);
    return fg_status_exit_code(FG_ERR_USAGE);
  }
  if (!strcmp(argv[1], "help") || !strcmp(argv[1], "--help")) {
    if (argc > 2) return help_command(argv[2], argc > 3 ? argv[3] : NULL);
    print_help(stdout);
    return 0;
  }
  if (!strcmp(argv[1], "version") || !strcmp(argv[1], "--version")) {
    puts("foilgauge " FOILGAUGE_VERSION);
    return 0;
  }
  return run_command(argc - 1, argv + 1);
}
