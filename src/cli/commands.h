/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The program's commands, a row of a table each (commands.c), and the parts that they share
 * (command.c, foil_kind.c, facts.c). */
#ifndef FG_CLI_COMMANDS_H
#define FG_CLI_COMMANDS_H

#include <stdio.h>

#include "foilgauge/lot.h"
#include "foilgauge/status.h"

struct argp;
struct argp_state;

/* argv[0] is "foilgauge" and the command's name. Returns the exit code (facts.c lists them). */
typedef int fg_command_run(int argc, char **argv);

/* One way to call a command. Its parser is the one source of its options: for the command line,
 * --help, the manual page and the shell's completion (src/manual/). */
typedef struct fg_command_usage {
  const char *words; /* after "foilgauge": "doe plan" */
  const struct argp *parser;
  const char *title; /* over its options, where a command has more than one usage; else NULL */
} fg_command_usage;

enum { FG_COMMAND_USAGES = 2 };

typedef struct fg_command {
  const char *name;
  const char *alias; /* an earlier name, which still calls the command; or NULL */
  fg_command_run *run;
  const char *summary; /* one line for `foilgauge help` */
  fg_command_usage usage[FG_COMMAND_USAGES];
} fg_command;

extern const fg_command fg_commands[]; /* ends with a row without a name */

fg_command_run fg_cmd_measure;
fg_command_run fg_cmd_doe;
fg_command_run fg_cmd_doe_plan; /* `doe plan`: writes a run sheet */
fg_command_run fg_cmd_design;
fg_command_run fg_cmd_forming;
fg_command_run fg_cmd_render;
fg_command_run fg_cmd_loop;
fg_command_run fg_cmd_loop_scan; /* `loop` without --table */
fg_command_run fg_cmd_lot;
fg_command_run fg_cmd_merge;
fg_command_run fg_cmd_die;
fg_command_run fg_cmd_die_next; /* `die --target` */
fg_command_run fg_cmd_stiffness;
fg_command_run fg_cmd_film;
fg_command_run fg_cmd_scanner;
fg_command_run fg_cmd_station;
fg_command_run fg_cmd_hub;

extern const struct argp fg_forming_parser, fg_film_parser, fg_scanner_parser;
extern const struct argp fg_measure_parser, fg_doe_parser, fg_doe_plan_parser, fg_design_parser,
    fg_render_parser, fg_loop_parser, fg_loop_table_parser, fg_lot_parser, fg_merge_parser,
    fg_die_parser, fg_die_next_parser, fg_stiffness_parser, fg_station_parser, fg_hub_parser;

/* Reads the command line into `input`. A wrong one ends the program (argp, exit code 64), and so
 * does --help, wherever it stands; FG_ERR_MEMORY when argp has no memory, which it says by its
 * return value alone. */
fg_status fg_cli_parse(fg_context *ctx, const struct argp *parser, int argc, char **argv,
                       void *input);

/* Reads the command line with options and arguments in the order in which they stand. */
fg_status fg_cli_parse_in_order(fg_context *ctx, const struct argp *parser, int argc, char **argv,
                                void *input);

/* Returns the number of an option --name; anything else or out of range ends the program (64). */
double fg_cli_number(struct argp_state *state, const char *name, const char *text, double lowest,
                     double highest);

/* Returns the number of an option that must be above 0; infinity is one. Anything else ends the
 * program (64). */
double fg_cli_positive(struct argp_state *state, const char *name, const char *text);

/* True for the second of two words; another text ends the program (64). */
bool fg_cli_is_second(struct argp_state *state, const char *name, const char *text,
                      const char *first, const char *second);

/* Returns the number of --seed, a whole one; anything else ends the program (64). */
uint64_t fg_cli_seed(struct argp_state *state, const char *text);

enum { FG_CLI_SHARDS_MAX = 1000000000 };
/* Reads "I/N", a part of N parts, of --shard; ends the program where it is none. */
fg_lot_shard fg_cli_shard(struct argp_state *state, const char *text);

/* Prints "foilgauge: <message>" on standard error and returns the status' exit code. */
int fg_cli_fail(const fg_context *ctx, fg_status status);

/* Notes a scan's findings (fg_picture_finding) on standard error, each with its meaning. */
void fg_cli_note_picture(const char *scan, unsigned findings);

/* Writes the outcome of a lot on standard error; returns the exit code. */
int fg_cli_lot_summary(const fg_lot_outcome *outcome, const char *folder);

/* Row and key of the option --decimal-comma, for every command that writes CSV. */
enum { FG_CLI_DECIMAL_COMMA = 0x7001 };
#define FG_CLI_DECIMAL_COMMA_ROW(group)                                                            \
  {                                                                                                \
    "decimal-comma", FG_CLI_DECIMAL_COMMA, NULL, 0,                                                \
        "Write CSV with semicolons, decimal commas and a byte order mark, as spreadsheets of "     \
        "countries "                                                                               \
        "with a decimal comma read it",                                                            \
        group                                                                                      \
  }

#define FG_CLI_ALLOW_LOSSY                                                                         \
  "Take scans that JPEG has compressed with loss, with the wider uncertainties that belong to "    \
  "them"

#endif
