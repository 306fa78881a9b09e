#include <malloc.h>
#include <stdio.h>
#include <string.h>

#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/stack.h"
#include "cli/standard.h"

static const fg_command commands[] = {
    {"measure", fg_cmd_measure, "measure every foil in a scan, each value with its uncertainty"},
    {"doe", fg_cmd_doe, "plan an experiment; analyse its runs or scans; the best setting"},
    {"design", fg_cmd_design, "check a design; what follows from it; its clearance curve"},
    {"loop", fg_cmd_loop, "find the effect that a declared model lacks; error before and after"},
    {"render", fg_cmd_render, "draw a scan with known truth from a spec"},
    {"lot", fg_cmd_lot, "measure and report a production lot; resume it, shard it"},
    {"die", fg_cmd_die, "stylus traces of a die against the design"},
    {"merge", fg_cmd_merge, "join the shards of a lot into one report"},
    {"station", fg_cmd_station, "watch a folder of scans, keep results, show them in a browser"},
    {NULL, NULL, NULL},
};

static void print_help(FILE *out) {
  fputs("foilgauge measures the foils of gas foil bearings from flatbed scans.\n\n"
        "Usage: foilgauge COMMAND [OPTION...]\n\nCommands:\n",
        out);
  for (const fg_command *command = commands; command->name; command++)
    fprintf(out, "  %-10s %s\n", command->name, command->summary);
  fputs("\n`foilgauge COMMAND --help` explains one command.\n", out);
}

int main(int argc, char **argv) {
  fg_standard_start();
  if (!fg_stack_reserve()) {
    fputs("foilgauge: out of memory: the stack; raise the limit of address space (ulimit -v)\n",
          stderr);
    return fg_status_exit_code(FG_ERR_MEMORY);
  }
  fg_interrupt_start();
  /* Else every thread reserves 64 MiB of address space for itself, which counts where that is
   * limited. */
  mallopt(M_ARENA_MAX, 2);
  if (argc < 2) {
    print_help(stderr);
    return fg_status_exit_code(FG_ERR_USAGE);
  }
  if (!strcmp(argv[1], "help") || !strcmp(argv[1], "--help")) {
    print_help(stdout);
    return 0;
  }
  if (!strcmp(argv[1], "version") || !strcmp(argv[1], "--version")) {
    puts("foilgauge " FOILGAUGE_VERSION);
    return 0;
  }
  for (const fg_command *command = commands; command->name; command++)
    if (!strcmp(argv[1], command->name)) return command->run(argc - 1, argv + 1);
  fprintf(stderr, "foilgauge: no command '%s'; `foilgauge help` lists them\n", argv[1]);
  return fg_status_exit_code(FG_ERR_USAGE);
}
