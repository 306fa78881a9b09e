/* The program's commands: a row of a table each (main.c); what they do alike (command.c, form.c).
 */
#ifndef FG_CLI_COMMANDS_H
#define FG_CLI_COMMANDS_H

#include "foilgauge/lot.h"
#include "foilgauge/status.h"

/* argv[0] is the command's name. Returns the exit code (0 to 3, 64, 65, 74, 130: README). */
typedef int fg_command_run(int argc, char **argv);

typedef struct fg_command {
  const char *name;
  fg_command_run *run;
  const char *summary; /* one line for `foilgauge help` */
} fg_command;

fg_command_run fg_cmd_measure;
fg_command_run fg_cmd_doe;
fg_command_run fg_cmd_design;
fg_command_run fg_cmd_render;
fg_command_run fg_cmd_loop;
fg_command_run fg_cmd_loop_scan; /* `loop` without --table */
fg_command_run fg_cmd_lot;
fg_command_run fg_cmd_merge;
fg_command_run fg_cmd_die;
fg_command_run fg_cmd_station;

struct argp;
struct argp_state;

/* Reads the command line into `input`. A wrong one ends the program (argp, exit code 64);
 * FG_ERR_MEMORY when argp has no memory, which it says by its return value alone. */
fg_status fg_cli_parse(fg_context *ctx, const struct argp *parser, int argc, char **argv,
                       void *input);

/* The number of an option --name; one that is none or out of range ends the program (64). */
double fg_cli_number(struct argp_state *state, const char *name, const char *text, double lowest,
                     double highest);

/* Prints "foilgauge: <message>" on standard error and returns the status' exit code. */
int fg_cli_fail(const fg_context *ctx, fg_status status);

/* Says on standard error what a lot came to; returns the exit code. */
int fg_cli_lot_summary(const fg_lot_outcome *outcome, const char *folder);

/* --form: overrules the design's; NULL leaves it. */
fg_status fg_cli_apply_form(fg_context *ctx, const char *form, fg_design *design);

#endif
