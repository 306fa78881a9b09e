/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <argp.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "cli/commands.h"
#include "cli/facts.h"
#include "cli/interrupt.h"
#include "cli/pages_options.h"
#include "cli/values.h"
#include "foilgauge/station.h"
#include "foilgauge/text.h"

enum {
  OPTION_RECIPE = 256,
  OPTION_ALLOW_LOSSY,
  OPTION_ONCE,
  OPTION_EXPORT,
  OPTION_POLL,
  OPTION_CONTEXT,
  OPTION_DIGEST,
  OPTION_DIGEST_PAGE,
  OPTION_ORDERS,
  OPTION_NAME,
  OPTION_BACKUP,
  OPTION_RESTORE,
  OPTION_HUB,
  OPTION_HUB_TOKEN_FILE
};

typedef struct station_arguments {
  const char *recipe, *design;
  const char *contexts[FG_STATION_CONTEXTS];
  bool allow_lossy;
  fg_cli_pages pages;
} station_arguments;

static const struct argp_option options[] = {
    {"recipe", OPTION_RECIPE, "FILE", 0,
     "As of `foilgauge lot`, with a member `station`: file_name, scan_command, check", 0},
    {"design", 'd', "FILE", 0, "What the part should be, with tolerances", 0},
    {"allow-lossy", OPTION_ALLOW_LOSSY, NULL, 0, FG_CLI_ALLOW_LOSSY, 0},
    {"once", OPTION_ONCE, NULL, 0, "Measure what is new, and end", 1},
    {"export", OPTION_EXPORT, "DIR", 0,
     "Write every lot of the database as a folder, as `foilgauge lot` makes them, and end", 1},
    {"digest", OPTION_DIGEST, NULL, 0,
     "Write what changed, what is suspected and what was found, and end; also beside a station "
     "that "
     "runs",
     1},
    {"digest-page", OPTION_DIGEST_PAGE, "FILE", 0, "The same, and as a page into FILE", 1},
    {"orders", OPTION_ORDERS, "PATH", 0,
     "Orders that an ERP writes: a CSV file, or a folder of them, with columns order, part, lot, "
     "die, "
     "coil, operator, pieces",
     1},
    {"context", OPTION_CONTEXT, "FILE.csv", 0,
     "Columns that say more about foils, by a column `serial` or `time` (repeatable): candidates "
     "for the causes of a trend",
     1},
    {"backup", OPTION_BACKUP, "FILE", 0,
     "Write a copy of the database, and end; also beside a station that runs", 1},
    {"restore", OPTION_RESTORE, "FILE", 0,
     "Put a backup in the place of the database, which stays beside it, and end", 1},
    {"name", OPTION_NAME, "TEXT", 0,
     "Of the station, for receivers of its parts (default: the machine's)", 1},
    {"hub", OPTION_HUB, "URL", 0, "Pass all parts on to a hub, as http://hub.example.com:8318", 1},
    {"hub-token-file", OPTION_HUB_TOKEN_FILE, "FILE", 0, "The hub's token: the first line of FILE",
     1},
    {"poll", OPTION_POLL, "S", 0,
     "Look into the folder every so many seconds (network folders, of whose files nobody tells)",
     2},
    FG_CLI_PAGES_ROWS(2, "Of the pages (default: @station_port@; 0: one that is free)"),
    FG_CLI_DECIMAL_COMMA_ROW(2),
    {0},
};

static const char doc[] =
    "Watch a folder: every scan that appears is measured, judged, kept in a database in that "
    "folder "
    "and shown in the browser."
    "\vThe address is printed when the pages can be had. The database is "
    "FOLDER/" FG_STATION_DATABASE ". Scans are never changed.\n\n"
    "@exit_judged@ So with --once and --export; else 130, by which it is ended.";

/* Options whose text is kept as it is. */
static const fg_cli_value values[] = {
    FG_CLI_VALUE('d', station_arguments, design),
    FG_CLI_VALUE(OPTION_RECIPE, station_arguments, recipe),
    FG_CLI_VALUE(OPTION_EXPORT, station_arguments, pages.request.export_path),
    FG_CLI_VALUE(OPTION_DIGEST_PAGE, station_arguments, pages.request.digest_page),
    FG_CLI_VALUE(OPTION_ORDERS, station_arguments, pages.request.orders),
    FG_CLI_VALUE(OPTION_NAME, station_arguments, pages.request.name),
    FG_CLI_VALUE(OPTION_BACKUP, station_arguments, pages.request.backup_path),
    FG_CLI_VALUE(OPTION_RESTORE, station_arguments, pages.request.restore_path),
    FG_CLI_VALUE(OPTION_HUB, station_arguments, pages.request.hub),
    FG_CLI_VALUE(OPTION_HUB_TOKEN_FILE, station_arguments, pages.request.hub_token_file),
    FG_CLI_VALUE(OPTION_ALLOW_LOSSY, station_arguments, allow_lossy),
    FG_CLI_VALUE(OPTION_ONCE, station_arguments, pages.request.once),
    FG_CLI_NUMBER(OPTION_POLL, station_arguments, pages.request.poll_s, 0.1, 3600),
    FG_CLI_VALUE(OPTION_DIGEST, station_arguments, pages.request.digest),
    FG_CLI_VALUE(FG_CLI_DECIMAL_COMMA, station_arguments, pages.request.decimal_comma),
    {0},
};

static error_t parse_station_option(int key, char *text, struct argp_state *state) {
  station_arguments *arguments = state->input;
  fg_station_request *request = &arguments->pages.request;
  if (fg_cli_keep_value(values, key, text, state)) return 0;
  switch (key) {
  case OPTION_CONTEXT:
    if (request->context_count == FG_STATION_CONTEXTS)
      argp_error(state, "--context: at most %d files", FG_STATION_CONTEXTS);
    arguments->contexts[request->context_count++] = text;
    break;
  case ARGP_KEY_ARG:
    if (request->folder) argp_error(state, "one FOLDER at a time, not also '%s'", text);
    request->folder = text;
    break;
  case ARGP_KEY_END:
    request->digest |= request->digest_page != NULL;
    if (!request->folder) argp_error(state, "no FOLDER was given");
    return fg_cli_pages_option(key, text, state, &arguments->pages);
  default:
    return fg_cli_pages_option(key, text, state, &arguments->pages);
  }
  return 0;
}

/* A line per file, whatever bytes its name has: a line break in a name would pass for a line of the
 * program. */
static void print_file(void *user, const char *file, const char *words) {
  char line[4096];
  (void)user;
  fg_text_clip(line, sizeof line, "%s%s%s", file, words[0] ? " " : "", words);
  for (char *at = line; *at; at++)
    if (*at == '\n' || *at == '\t') *at = ' ';
  fprintf(stderr, "foilgauge: %s\n", line);
}

const struct argp fg_station_parser = {options, parse_station_option, "FOLDER", doc,
                                       NULL,    fg_cli_fill,          NULL};

int fg_cmd_station(int argc, char **argv) {
  static fg_station_settings settings;
  fg_context ctx = {0};
  station_arguments arguments = {.pages.request = {.port = FG_CLI_STATION_PORT}};
  fg_station_outcome outcome;
  fg_status status = fg_cli_parse(&ctx, &fg_station_parser, argc, argv, &arguments);
  if (status != FG_OK) return fg_cli_fail(&ctx, status);
  status = fg_station_settings_load(&ctx, arguments.recipe, arguments.design, &settings);
  if (status != FG_OK) return fg_cli_fail(&ctx, status);
  status = fg_cli_pages_end(&ctx, &arguments.pages);
  if (status != FG_OK) return fg_cli_fail(&ctx, status);
  fg_station_request *request = &arguments.pages.request;
  request->contexts = arguments.contexts;
  settings.lot.allow_lossy |= arguments.allow_lossy;
  request->settings = &settings;
  request->looked_at = print_file;
  if (!request->export_path && !request->backup_path && !request->restore_path)
    request->end_descriptor = fg_interrupt_defer();
  status = fg_station_run(&ctx, request, &outcome);
  if (status != FG_OK) return fg_cli_fail(&ctx, status);
  if (request->digest || request->backup_path || request->restore_path) return 0;
  if (request->export_path) return fg_outcome_exit_code(&outcome.judged);
  if (!request->once) return 0;
  fprintf(stderr, "foilgauge: %zu measured, %zu known, %zu refused\n", outcome.measured,
          outcome.known, outcome.refused);
  return fg_outcome_exit_code(&outcome.judged);
}
