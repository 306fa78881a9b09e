/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <argp.h>

#include "cli/commands.h"
#include "cli/facts.h"
#include "foilgauge/lot.h"

typedef struct merge_arguments {
  const char *folder;
  char **folders; /* of argv */
  size_t count;
  bool decimal_comma;
} merge_arguments;

static const struct argp_option options[] = {
    {"output", 'o', "DIR", 0, "The folder of the whole lot", 0},
    FG_CLI_DECIMAL_COMMA_ROW(0),
    {0},
};

static const char doc[] =
    "Join the shards of a lot and report it as if it had been measured in one run."
    "\vEvery shard must be there, once, complete, and made with the same recipe, manifest and "
    "version. The report and the exit code are those of one run, whatever the number of shards.\n\n"
    "@exit_judged@";

static error_t parse_merge_option(int key, char *text, struct argp_state *state) {
  merge_arguments *arguments = state->input;
  switch (key) {
  case 'o':
    arguments->folder = text;
    break;
  case FG_CLI_DECIMAL_COMMA:
    arguments->decimal_comma = true;
    break;
  case ARGP_KEY_ARGS:
    arguments->folders = state->argv + state->next;
    arguments->count = (size_t)(state->argc - state->next);
    break;
  case ARGP_KEY_END:
    if (!arguments->count) argp_error(state, "no DIR was given");
    if (!arguments->folder) argp_error(state, "give the folder of the whole lot with -o DIR");
    break;
  default:
    return ARGP_ERR_UNKNOWN;
  }
  return 0;
}

const struct argp fg_merge_parser = {options, parse_merge_option, "DIR...", doc,
                                     NULL,    fg_cli_fill,        NULL};

int fg_cmd_merge(int argc, char **argv) {
  fg_context ctx = {0};
  merge_arguments arguments = {0};
  fg_lot_outcome outcome;
  fg_status status = fg_cli_parse(&ctx, &fg_merge_parser, argc, argv, &arguments);
  if (status != FG_OK) return fg_cli_fail(&ctx, status);
  status = fg_lot_merge(&ctx, (const char *const *)arguments.folders, arguments.count,
                        arguments.folder, arguments.decimal_comma, &outcome);
  return status == FG_OK ? fg_cli_lot_summary(&outcome, arguments.folder)
                         : fg_cli_fail(&ctx, status);
}
