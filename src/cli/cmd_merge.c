#include <argp.h>

#include "cli/commands.h"
#include "foilgauge/lot.h"

typedef struct merge_arguments {
  const char *folder;
  char **folders; /* of argv */
  size_t count;
} merge_arguments;

static const struct argp_option options[] = {
    {"output", 'o', "DIR", 0, "The folder of the whole lot", 0},
    {0},
};

static const char doc[] =
    "Join the shards of a lot and report it as if it had been measured in one run."
    "\vEvery shard must be there, once, complete, and made with the same recipe, manifest and "
    "version. The report and the exit code are those of one run, whatever the number of shards.\n\n"
    "Exit code: 0 all measured and within tolerance, or none is stated; 1 a limit is exceeded by "
    "more than U (of foils or of bearings), or a bump is missing; 2 something could not be "
    "measured; 3 cannot tell: a limit "
    "lies within U of a value, none is exceeded; 64 usage; 65 bad data; 74 input or output.";

static error_t parse_option(int key, char *text, struct argp_state *state) {
  merge_arguments *arguments = state->input;
  switch (key) {
  case 'o':
    arguments->folder = text;
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

int fg_cmd_merge(int argc, char **argv) {
  static const struct argp parser = {options, parse_option, "DIR...", doc, NULL, NULL, NULL};
  fg_context ctx = {0};
  merge_arguments arguments = {0};
  fg_lot_outcome outcome;
  argv[0] = (char[]){"foilgauge merge"};
  argp_parse(&parser, argc, argv, 0, NULL, &arguments);
  fg_status status = fg_lot_merge(&ctx, (const char *const *)arguments.folders, arguments.count,
                                  arguments.folder, &outcome);
  return status == FG_OK ? fg_cli_lot_summary(&outcome, arguments.folder)
                         : fg_cli_fail(&ctx, status);
}
