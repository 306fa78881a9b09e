/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <argp.h>
#include <stdio.h>
#include <string.h>

#include "cli/commands.h"
#include "cli/facts.h"
#include "cli/interrupt.h"
#include "cli/pages_options.h"
#include "foilgauge/station.h"

enum { OPTION_DATABASE = 256, OPTION_CSV };

typedef struct hub_arguments {
  const char *database;
  fg_cli_pages pages;
} hub_arguments;

static const struct argp_option options[] = {
    {"database", OPTION_DATABASE, "FILE|URL", 0,
     "A file of SQLite (default: foilgauge-hub.sqlite), or postgresql://USER@HOST/NAME", 0},
    {"csv", OPTION_CSV, "FILE", 0, "Write the newest 100,000 parts as CSV, and end", 0},
    FG_CLI_PAGES_ROWS(1, "Of the pages (default: @hub_port@; 0: one that is free)"),
    {0},
};

static const char doc[] =
    "Show the parts of several stations: each is started with --hub and the address that this "
    "prints.\vEach station keeps its own database; a hub that is gone gets what it has missed when "
    "it is back.\n\n@exit_done@ So with --csv; else 130, by which it is ended.";

static error_t parse_hub_option(int key, char *text, struct argp_state *state) {
  hub_arguments *arguments = state->input;
  if (key == OPTION_DATABASE) {
    arguments->database = text;
    return 0;
  }
  if (key == OPTION_CSV) {
    arguments->pages.request.export_path = text;
    return 0;
  }
  if (key == ARGP_KEY_ARG) argp_error(state, "a hub takes no FILE: give --database");
  return fg_cli_pages_option(key, text, state, &arguments->pages);
}

const struct argp fg_hub_parser = {options, parse_hub_option, "", doc, NULL, fg_cli_fill, NULL};

int fg_cmd_hub(int argc, char **argv) {
  fg_context ctx = {0};
  hub_arguments arguments = {.database = "foilgauge-hub.sqlite",
                             .pages.request = {.port = FG_CLI_HUB_PORT}};
  fg_status status = fg_cli_parse(&ctx, &fg_hub_parser, argc, argv, &arguments);
  if (status == FG_OK) status = fg_cli_pages_end(&ctx, &arguments.pages);
  if (status != FG_OK) return fg_cli_fail(&ctx, status);
  arguments.pages.request.end_descriptor = fg_interrupt_defer();
  status = fg_hub_run(&ctx, arguments.database, &arguments.pages.request);
  return status == FG_OK ? 0 : fg_cli_fail(&ctx, status);
}
