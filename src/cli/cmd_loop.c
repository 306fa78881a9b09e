/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <argp.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "cli/commands.h"
#include "cli/facts.h"
#include "cli/loop_source.h"
#include "cli/output_set.h"
#include "cli/progress.h"
#include "cli/values.h"
#include "foilgauge/file.h"
#include "foilgauge/loop_model.h"

typedef fg_status loop_writer(fg_context *ctx, const fg_loop_report *report, FILE *out);

static loop_writer *const writers[FG_LOOP_OUTPUTS] = {
    [FG_LOOP_HTML] = fg_loop_write_html,
    [FG_LOOP_MODEL] = fg_loop_write_model,
    [FG_LOOP_JSON] = fg_loop_write_json,
    [FG_LOOP_TEXT] = fg_loop_write_text,
};

typedef struct loop_arguments {
  fg_loop_source_request source;
  const char *design_path, *declared_path;
  fg_output_set outputs;
  fg_loop_table_spec spec;
  double matters, minutes, mebibytes;
  bool expected[FG_LOOP_KINDS];
  fg_loop_declaration *declared; /* owns the strings that came from --declared */
} loop_arguments;

enum {
  OPTION_TABLE = 256,
  OPTION_RESPONSE,
  OPTION_MODEL,
  OPTION_GROUP,
  OPTION_ORDER,
  OPTION_DESIGN,
  OPTION_DECLARED,
  OPTION_HOLD_OUT,
  OPTION_SEED,
  OPTION_MODEL_OUT,
  OPTION_HTML,
  OPTION_MATTERS,
  OPTION_MINUTES,
  OPTION_MEMORY,
  OPTION_LOT,
  OPTION_DOE,
  OPTION_SCANS,
  OPTION_WITHOUT,
  OPTION_DPI,
  OPTION_ALLOW_LOSSY,
  OPTION_THREADS,
  OPTION_OFFSET,
  OPTION_FORMING_MODEL,
  OPTION_EXPECT,
  OPTION_PERIOD,
  OPTION_COMPLETE,
};

/* A lot's response where none is named. */
static const char lot_response[] = FG_CLI_LOT_RESPONSE, lot_model[] = FG_CLI_LOT_MODEL;

static const struct argp_option options[] = {
    {"table", OPTION_TABLE, "DATA.csv", 0, "The measured data", 0},
    {"lot", OPTION_LOT, "DIR", 0,
     "The bumps or foils of a lot that `foilgauge lot -o DIR` measured; what its manifest says and "
     "the bump's number are candidates",
     0},
    {"doe", OPTION_DOE, "RUNS.csv", 0,
     "Runs whose scans are measured first, as `foilgauge doe --scans` does", 0},
    {"scans", OPTION_SCANS, "DIR", 0,
     "With --doe: the folder of the scans that the column `scan` names (default: that of "
     "RUNS.csv), or another column that names them",
     0},
    {"response", OPTION_RESPONSE, "COLUMN", 0,
     "What was measured; with --lot and --doe any reported quantity (--lot: @lot_response@)", 0},
    {"without", OPTION_WITHOUT, "COLUMN", 0, "Leave this column out (may be repeated)", 0},
    {"complete", OPTION_COMPLETE, NULL, 0,
     "With --table: leave out rows with an empty cell (default: columns with one, which are then "
     "no candidates)",
     0},
    {"dpi", OPTION_DPI, "N", 0, "Resolution of the scans of --doe; overrules the files", 0},
    {"allow-lossy", OPTION_ALLOW_LOSSY, NULL, 0, FG_CLI_ALLOW_LOSSY, 0},
    {"threads", OPTION_THREADS, "N", 0,
     "Threads that measure the scans of --doe (default: one per core)", 0},
    {"model", OPTION_MODEL, "FORMULA", 0,
     "The declared model: a formula ('1 + T + D + T:D + T^2'; --lot: @lot_model@), or arc_length "
     "(from the "
     "bump radius)",
     0},
    {"offset", OPTION_OFFSET, "COLUMN", 0,
     "What is predicted of the response besides the model: taken from it, and no candidate", 0},
    {"form-model", OPTION_FORMING_MODEL, "FORM.json", 0,
     "A report of `foilgauge forming -o` as the declared model: what it predicts of the response "
     "of "
     "each bump is the offset, a column `declared`; needs a column `bump` (--lot has it)",
     0},
    {"group", OPTION_GROUP, "COLUMN", 0, "Rows of a group share its level (foil)", 0},
    {"order", OPTION_ORDER, "COLUMN", 0,
     "Order of the rows, in groups of their rows (default: run, or bump)", 0},
    {"period", OPTION_PERIOD, "COLUMN=P", 0,
     "Base period that is known of a column (angle_deg=360, x_mm=2 of a screw's lead): its orders "
     "1, 2, 3 ... are tried first (may be repeated; a turn is known of angles: angle_deg)",
     0},
    {"design", OPTION_DESIGN, "FILE", 0, "The foil's design, for arc_length", 0},
    {"declared", OPTION_DECLARED, "FILE", 0,
     "JSON with response, model, group and design; options win over it", 0},
    {"hold-out", OPTION_HOLD_OUT, "SHARE", 0,
     "Whole groups that only confirm: a share or COLUMN=VALUE (default: every row takes part, and "
     "the search is repeated without each part of the rows in turn)",
     0},
    {"matters", OPTION_MATTERS, "AMPLITUDE", 0,
     "An effect this small does not matter, in the response's unit (default: one noise sd)", 0},
    {"expect", OPTION_EXPECT, "KIND", 0,
     "Kind of effect that is likely: columns, interactions, curves, order, scatter, rows or "
     "exchanges; half of the error rate is kept for it (may be repeated)",
     0},
    {"minutes", OPTION_MINUTES, "N", 0,
     "Refuse a table whose search may take longer by estimate (default: @loop_minutes@)", 0},
    {"memory", OPTION_MEMORY, "MIB", 0,
     "Refuse a table whose search may take more memory (default: @loop_mebibytes@)", 0},
    {"seed", OPTION_SEED, "N", 0,
     "Of the interval of the error ratio and of the smallest amplitudes; no verdict depends on it "
     "(default: @seed@)",
     0},
    {"output", 'o', "FILE", 0, "The report as JSON (-: standard output)", 0},
    {"model-out", OPTION_MODEL_OUT, "FILE", 0,
     "Declared model and what was found, as JSON, for `doe --model`", 0},
    {"html", OPTION_HTML, "FILE", 0, "The report as a page, with every finding drawn", 0},
    {0},
};

static const char doc[] =
    "Find what the residual of a declared model holds: which effect the model lacks, how sure that "
    "is, what it could be confused with, which measurement would tell.\v"
    "Verdicts: clean (the model is enough, as far as the data can tell), suspected (something may "
    "be missing, but is not proven: what it would be, and which rows would decide), explained (it "
    "is not enough; "
    "what it lacks was found and lowers the error), partly explained (more is left, or no error "
    "falls), unattributed (it is not, and what it lacks has no name here). Each comes with what to "
    "do next.\n\n"
    "Columns that the model does not use are candidates, and so are the order of the runs and the "
    "bump's number. DATA.csv has commas, semicolons or tabs between the cells, decimal points or "
    "(not between commas) decimal commas.\n\n"
    "On a terminal the results are printed as a table; elsewhere, where no file is asked for, as "
    "JSON.\n\n"
    "@exit_loop@";

/* COLUMN=P; the text, which argp owns, is cut at its last equals sign. */
static void parse_period(struct argp_state *state, char *text, fg_loop_table_spec *spec) {
  char *equals = strrchr(text, '=');
  if (!equals || equals == text)
    argp_error(state, "--period: '%s' is not COLUMN=P, as x_mm=2", text);
  if (spec->periods == FG_LOOP_PERIODS) argp_error(state, "--period: at most %d", FG_LOOP_PERIODS);
  fg_loop_known_period *known = &spec->period[spec->periods++];
  known->period = fg_cli_positive(state, "period", equals + 1);
  if (!isfinite(known->period)) argp_error(state, "--period: '%s' has no finite period", text);
  *equals = '\0';
  known->column = text;
}

static void parse_expected(struct argp_state *state, const char *text, bool *expected) {
  size_t k = 0;
  while (fg_loop_kind_words[k] && strcmp(fg_loop_kind_words[k], text) != 0)
    k++;
  if (!fg_loop_kind_words[k])
    argp_error(
        state,
        "--expect: '%s' is none of columns, interactions, curves, order, scatter, rows, exchanges",
        text);
  else
    expected[k] = true;
}

static bool is_name_of_table(const char *text) {
  const char *end = strrchr(text, '.');
  return *text != '-' && end && (!strcasecmp(end, ".csv") || !strcasecmp(end, ".tsv"));
}

static void check_source(struct argp_state *state, const fg_loop_source_request *source) {
  int given = (source->table != NULL) + (source->lot != NULL) + (source->runs != NULL);
  if (!given) argp_error(state, "--table DATA.csv is missing");
  if (given > 1) argp_error(state, "one of --table, --lot and --doe at a time");
  if (source->scans && !source->runs) argp_error(state, "--scans belongs to --doe RUNS.csv");
  if (source->complete && !source->table) argp_error(state, "--complete belongs to --table");
}

static const fg_cli_value values[] = {
    FG_CLI_VALUE(OPTION_TABLE, loop_arguments, source.table),
    FG_CLI_VALUE(OPTION_LOT, loop_arguments, source.lot),
    FG_CLI_VALUE(OPTION_DOE, loop_arguments, source.runs),
    FG_CLI_VALUE(OPTION_SCANS, loop_arguments, source.scans),
    FG_CLI_VALUE(OPTION_RESPONSE, loop_arguments, spec.response),
    FG_CLI_VALUE(OPTION_MODEL, loop_arguments, spec.model),
    FG_CLI_VALUE(OPTION_GROUP, loop_arguments, spec.group),
    FG_CLI_VALUE(OPTION_ORDER, loop_arguments, spec.order),
    FG_CLI_VALUE(OPTION_OFFSET, loop_arguments, spec.offset),
    FG_CLI_VALUE(OPTION_FORMING_MODEL, loop_arguments, source.forming_model),
    FG_CLI_VALUE(OPTION_DESIGN, loop_arguments, design_path),
    FG_CLI_VALUE(OPTION_DECLARED, loop_arguments, declared_path),
    FG_CLI_VALUE(OPTION_HOLD_OUT, loop_arguments, spec.hold_out),
    FG_CLI_VALUE(OPTION_MODEL_OUT, loop_arguments, outputs.path[FG_LOOP_MODEL]),
    FG_CLI_VALUE(OPTION_HTML, loop_arguments, outputs.path[FG_LOOP_HTML]),
    FG_CLI_VALUE('o', loop_arguments, outputs.path[FG_LOOP_JSON]),
    FG_CLI_NUMBER(OPTION_DPI, loop_arguments, source.dpi, 1, 1e6),
    FG_CLI_VALUE(OPTION_ALLOW_LOSSY, loop_arguments, source.allow_lossy),
    FG_CLI_VALUE(OPTION_COMPLETE, loop_arguments, source.complete),
    FG_CLI_NUMBER(OPTION_THREADS, loop_arguments, source.threads, 1, 1024),
    {0},
};

static error_t parse_loop_table_option(int key, char *text, struct argp_state *state) {
  loop_arguments *arguments = state->input;
  if (fg_cli_keep_value(values, key, text, state)) return 0;
  switch (key) {
  case OPTION_MATTERS:
    arguments->matters = fg_cli_positive(state, "matters", text);
    return 0;
  case OPTION_EXPECT:
    parse_expected(state, text, arguments->expected);
    return 0;
  case OPTION_MINUTES:
    arguments->minutes = fg_cli_positive(state, "minutes", text);
    return 0;
  case OPTION_MEMORY:
    arguments->mebibytes = fg_cli_positive(state, "memory", text);
    return 0;
  case OPTION_PERIOD:
    parse_period(state, text, &arguments->spec);
    return 0;
  case OPTION_SEED:
    arguments->spec.seed = fg_cli_seed(state, text);
    return 0;
  case OPTION_WITHOUT:
    if (arguments->source.withouts == FG_LOOP_WITHOUTS)
      argp_error(state, "--without: at most %d", FG_LOOP_WITHOUTS);
    arguments->source.without[arguments->source.withouts++] = text;
    return 0;
  case ARGP_KEY_ARG:
    if (arguments->source.table || !is_name_of_table(text))
      argp_error(state, "%s: give the data by --table, --lot or --doe", text);
    arguments->source.table = text;
    return 0;
  case ARGP_KEY_END:
    check_source(state, &arguments->source);
    if (arguments->source.forming_model && arguments->spec.offset)
      argp_error(state, "--form-model is the offset: drop --offset");
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

static fg_status read_declared(fg_context *ctx, loop_arguments *arguments, fg_design *design) {
  if (arguments->declared_path)
    FG_TRY(fg_loop_declaration_load(ctx, arguments->declared_path, &arguments->spec, design,
                                    &arguments->declared));
  if (arguments->design_path) FG_TRY(fg_design_load(ctx, arguments->design_path, design));
  if (arguments->source.lot && !arguments->spec.response) arguments->spec.response = lot_response;
  if (arguments->source.lot && !arguments->spec.model) arguments->spec.model = lot_model;
  if (!arguments->spec.response)
    return fg_fail(ctx, FG_ERR_USAGE, "which column was measured? --response COLUMN");
  if (!arguments->spec.model)
    return fg_fail(ctx, FG_ERR_USAGE, "which model is declared? --model FORMULA, or arc_length");
  return FG_OK;
}

static fg_status write_loop_table_output(fg_context *ctx, void *user, size_t kind, FILE *out) {
  return writers[kind](ctx, user, out);
}

static fg_status check_outputs(fg_context *ctx, loop_arguments *arguments) {
  const fg_input inputs[] = {{arguments->declared_path, "the declared model"},
                             {arguments->design_path, "the design"}};
  fg_loop_outputs_choose(&arguments->outputs);
  FG_TRY(fg_loop_source_check(ctx, &arguments->source, &arguments->outputs));
  return fg_output_set_check(ctx, &arguments->outputs, inputs, sizeof inputs / sizeof *inputs);
}

static void show_progress(void *user, size_t found, double share) {
  fg_progress *progress = user;
  snprintf(progress->name, sizeof progress->name, "%zu found, next", found);
  fg_progress_show(progress, (int64_t)(1000 * share), 1000);
}

static fg_status search_table(fg_context *ctx, const loop_arguments *arguments, const char *path,
                              const fg_loop_problem *problem, fg_loop_result *result) {
  fg_progress progress;
  fg_loop_options how = {.effects = fg_loop_table_effects(),
                         .seed = arguments->spec.seed,
                         .matters = arguments->matters,
                         .minutes = arguments->minutes,
                         .mebibytes = arguments->mebibytes,
                         .progress = show_progress,
                         .progress_user = &progress};
  memcpy(how.expected, arguments->expected, sizeof how.expected);
  fg_progress_begin(&progress, path);
  fg_status status = fg_loop_run(ctx, problem, &how, result);
  fg_progress_end(&progress);
  return status;
}

static fg_status run_loop(fg_context *ctx, loop_arguments *arguments, int *code) {
  fg_status status = FG_OK;
  fg_loop_source source = {0};
  fg_design design;
  fg_loop_table_problem problem = {0};
  fg_loop_result result = {0};
  fg_loop_table_spec *spec = &arguments->spec;
  fg_design_default(&design);
  FG_TRY_EXIT(check_outputs(ctx, arguments));
  FG_TRY_EXIT(read_declared(ctx, arguments, &design));
  spec->design = &design;
  arguments->source.has_design =
      arguments->design_path || fg_loop_declaration_has_design(arguments->declared);
  FG_TRY_EXIT(
      fg_loop_source_read(ctx, &arguments->source, &arguments->outputs, spec, &design, &source));
  FG_TRY_EXIT(fg_output_set_open(ctx, &arguments->outputs));
  FG_TRY_EXIT(fg_loop_table_problem_build(ctx, source.table, spec, &problem));
  FG_TRY_EXIT(search_table(ctx, arguments, source.path, &problem.problem, &result));
  fg_loop_report report = {.path = source.path,
                           .sha256 = source.sha256,
                           .spec = spec,
                           .problem = &problem,
                           .result = &result,
                           .seed = spec->seed,
                           .input = source.input,
                           .inputs = source.inputs,
                           .row_name = source.row_name,
                           .said = source.said};
  FG_TRY_EXIT(fg_output_set_write(ctx, &arguments->outputs, write_loop_table_output, &report));
exit:
  *code = source.failed ? 2 : result.verdict == FG_LOOP_SUSPECTED ? 3 : 0;
  fg_output_set_close(&arguments->outputs);
  fg_loop_result_free(&result);
  fg_loop_table_problem_free(&problem);
  fg_loop_source_free(&source);
  fg_loop_declaration_free(arguments->declared);
  return status;
}

/* The loop on a table, or on scans (cmd_loop_scan.c). */
static bool is_about_a_table(int argc, char **argv) {
  static const char *const words[] = {"--table",    "--lot",      "--doe",
                                      "--response", "--declared", "--offset"};
  for (int i = 1; i < argc; i++)
    for (size_t w = 0; w < sizeof words / sizeof *words; w++)
      if (!strncmp(argv[i], words[w], strlen(words[w]))) return true;
  return argc > 1 && is_name_of_table(argv[1]);
}

const struct argp fg_loop_table_parser = {options,
                                          parse_loop_table_option,
                                          "--table DATA.csv\n--lot DIR\n--doe RUNS.csv",
                                          doc,
                                          NULL,
                                          fg_cli_fill,
                                          NULL};

int fg_cmd_loop(int argc, char **argv) {
  if (!is_about_a_table(argc, argv)) return fg_cmd_loop_scan(argc, argv);
  fg_context ctx = {0};
  loop_arguments arguments = {.spec = {.seed = FG_CLI_SEED},
                              .outputs.count = FG_LOOP_OUTPUTS,
                              .minutes = FG_CLI_LOOP_MINUTES,
                              .mebibytes = FG_CLI_LOOP_MEBIBYTES};
  fg_status status = fg_cli_parse(&ctx, &fg_loop_table_parser, argc, argv, &arguments);
  if (status != FG_OK) return fg_cli_fail(&ctx, status);
  int code = 0;
  status = run_loop(&ctx, &arguments, &code);
  return status == FG_OK ? code : fg_cli_fail(&ctx, status);
}
