/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <argp.h>
#include <math.h>

#include "cli/commands.h"
#include "cli/facts.h"
#include "cli/output_set.h"
#include "cli/values.h"
#include "foilgauge/scanner_change.h"

enum { OUT_JSON, OUT_HTML, OUT_TEXT, OUT_COUNT };
enum { OPTION_LIMIT = 256, OPTION_HTML };

typedef struct scanner_run {
  const char *model[2];
  size_t models;
  double limit_um;
  fg_output_set outputs;
  fg_scanner_change change;
} scanner_run;

static const struct argp_option options[] = {
    {"limit", OPTION_LIMIT, "UM", 0,
     "The largest allowed difference of a place of the bed; it decides the exit code", 0},
    {"output", 'o', "FILE", 0, "The report as JSON (-: standard output)", 0},
    {"html", OPTION_HTML, "FILE", 0, "The report as a page", 0},
    {0},
};

static const char doc[] =
    "Compare two models of one scanner, an older and a newer one: has it changed? Scale, ratio of "
    "axes, shear, and the largest difference over the bed, each with its U."
    "\vThe models are those of `foilgauge loop --model-out`. A change that shows is a limit that "
    "is "
    "exceeded, unless --limit says how large a difference matters.\n\n"
    "@exit_judged@";

static const fg_cli_value values[] = {
    FG_CLI_NUMBER(OPTION_LIMIT, scanner_run, limit_um, 1e-3, 1e6),
    FG_CLI_VALUE('o', scanner_run, outputs.path[OUT_JSON]),
    FG_CLI_VALUE(OPTION_HTML, scanner_run, outputs.path[OUT_HTML]),
    {0},
};

static error_t parse_scanner_option(int key, char *text, struct argp_state *state) {
  scanner_run *run = state->input;
  if (fg_cli_keep_value(values, key, text, state)) return 0;
  switch (key) {
  case ARGP_KEY_ARG:
    if (run->models == 2) argp_error(state, "two models are compared, not also '%s'", text);
    run->model[run->models++] = text;
    return 0;
  case ARGP_KEY_END:
    if (run->models != 2) argp_error(state, "give two models: OLDER NEWER");
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

const struct argp fg_scanner_parser = {options, parse_scanner_option, "OLDER NEWER", doc,
                                       NULL,    fg_cli_fill,          NULL};

static fg_status write_scanner_output(fg_context *ctx, void *user, size_t kind, FILE *out) {
  typedef fg_status writer(fg_context *, const fg_scanner_change *, FILE *);
  static writer *const writers[OUT_COUNT] = {[OUT_JSON] = fg_scanner_change_write_json,
                                             [OUT_HTML] = fg_scanner_change_write_html,
                                             [OUT_TEXT] = fg_scanner_change_write_text};
  const scanner_run *run = user;
  return writers[kind](ctx, &run->change, out);
}

static fg_status run_scanner(fg_context *ctx, scanner_run *run) {
  const fg_input inputs[] = {{run->model[0], "the older model"},
                             {run->model[1], "the newer model"}};
  fg_scanner_model *model[2] = {NULL, NULL};
  fg_status status = FG_OK;
  fg_output_set_choose_standard(&run->outputs, OUT_JSON, OUT_TEXT, false);
  FG_TRY(fg_output_set_check(ctx, &run->outputs, inputs, sizeof inputs / sizeof *inputs));
  for (size_t k = 0; k < 2; k++)
    FG_TRY_EXIT(fg_scanner_model_load(ctx, run->model[k], &model[k]));
  FG_TRY_EXIT(fg_output_set_open(ctx, &run->outputs));
  FG_TRY_EXIT(fg_scanner_compare(ctx, model[0], model[1], run->limit_um, &run->change));
  FG_TRY_EXIT(fg_output_set_write(ctx, &run->outputs, write_scanner_output, run));
exit:
  fg_scanner_model_free(model[0]);
  fg_scanner_model_free(model[1]);
  return status;
}

int fg_cmd_scanner(int argc, char **argv) {
  fg_context ctx = {0};
  scanner_run run = {.outputs.count = OUT_COUNT, .limit_um = NAN};
  fg_status status = fg_cli_parse(&ctx, &fg_scanner_parser, argc, argv, &run);
  if (status == FG_OK) status = run_scanner(&ctx, &run);
  int code = status == FG_OK ? fg_scanner_change_exit_code(&run.change) : fg_cli_fail(&ctx, status);
  fg_output_set_close(&run.outputs);
  return code;
}
