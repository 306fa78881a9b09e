/* SPDX-License-Identifier: GPL-3.0-or-later */
/* foilgauge doe: reads a table of runs, finds the factors that matter and the best setting. */
#include <argp.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/commands.h"
#include "cli/doe_kept_plan.h"
#include "cli/facts.h"
#include "cli/runs.h"
#include "cli/values.h"
#include "foilgauge/loop_model.h"
#include "foilgauge/loop_table.h"
#include "foilgauge/memory.h"
#include "foilgauge/plan.h"
#include "foilgauge/text.h"

/* Outputs of the command. */
typedef enum output_kind { OUT_JSON, OUT_HTML, OUT_TABLE, OUT_COUNT } output_kind;

typedef fg_status report_writer(fg_context *ctx, const fg_experiment_report *report, FILE *out);

static report_writer *const writers[OUT_COUNT] = {
    [OUT_JSON] = fg_experiment_write_json,
    [OUT_HTML] = fg_experiment_write_html,
    [OUT_TABLE] = fg_experiment_write_table,
};

enum { CODINGS = FG_FORMULA_VARIABLES, SETTINGS = 20 };

typedef struct doe_arguments {
  const char *data, *scans, *design_path;
  fg_experiment_options options;
  fg_coding coding[CODINGS];
  const char *constraint[FG_REGION_PLANES], *at[SETTINGS];
  fg_rounding round[CODINGS];
  const char *plan_path; /* NULL: beside the table, if it is there */
  double dpi;
  bool allow_lossy;
  unsigned threads;
} doe_arguments;

typedef struct doe_run {
  fg_loop_model *loop_model; /* NULL: --model is a formula */
  doe_arguments arguments;
  fg_output_set outputs;
  const char *model_path;
  char sha256[65], model_sha256[65];
  fg_loop_takings takings;
  fg_subtracted_effect *subtracted;
  fg_table sheet;
  fg_design design; /* of the scans */
  fg_run_sheet measured;
  char *said; /* how dates were read */
  char *u_name;
  fg_doe_plan plan;
  fg_experiment experiment;
} doe_run;

enum {
  OPTION_RESPONSE = 256,
  OPTION_MODEL,
  OPTION_CODE,
  OPTION_SIGN,
  OPTION_BLOCK,
  OPTION_WHOLE_PLOT,
  OPTION_UNCERTAINTY,
  OPTION_SCANS,
  OPTION_DPI,
  OPTION_ALLOW_LOSSY,
  OPTION_THREADS,
  OPTION_CONSTRAINT,
  OPTION_AT,
  OPTION_GOAL,
  OPTION_CONFIDENCE,
  OPTION_HTML,
  OPTION_ROUND,
  OPTION_PLAN
};

static const struct argp_option options[] = {
    {"response", OPTION_RESPONSE, "NAME", 0,
     "The column to explain; with --scans, the quantity to measure", 0},
    {"model", OPTION_MODEL, "FORMULA", 0,
     "As in R: 'T + D + T:D + T^2'; T*D is T + D + T:D; or the file that `loop --model-out` wrote",
     0},
    {"code", OPTION_CODE, "NAME=LOW:HIGH", 0,
     "Code a factor so that LOW is -1 and HIGH +1 (default: lowest and highest of the data); "
     "'--code none' leaves the others in real units",
     0},
    {"sign", OPTION_SIGN, "SIGN", 0,
     "magnitude models |response|, as the thesis does with springback errors; as-is keeps the "
     "sign; auto (default): magnitude for a springback error whose values have one sign",
     0},
    {"block", OPTION_BLOCK, "COL", 0, "Column that names blocks (days, sheets of metal)", 0},
    {"whole-plot", OPTION_WHOLE_PLOT, "COL", 0,
     "Column that names whole plots: runs that shared a setting (one oven load)", 0},
    {"confidence", OPTION_CONFIDENCE, "P", 0, "Of the intervals (default: @confidence@)", 0},
    {"scans", OPTION_SCANS, "COL", 0, "Measure the scans that this column names (several: a;b)", 1},
    {"uncertainty", OPTION_UNCERTAINTY, "COL", 0,
     "Column with the standard uncertainty of a response typed by hand", 1},
    {"design", 'd', "FILE", 0, "What the foils should be (default: the Gen II foil)", 1},
    {"dpi", OPTION_DPI, "N", 0, "Resolution of the scans; overrules the files", 1},
    {"allow-lossy", OPTION_ALLOW_LOSSY, NULL, 0, FG_CLI_ALLOW_LOSSY, 1},
    {"threads", OPTION_THREADS, "N", 0, "Threads (default: one per core)", 1},
    {"goal", OPTION_GOAL, "GOAL", 0, "lowest (default), highest, or a number to aim at", 2},
    {"constraint", OPTION_CONSTRAINT, "LIMIT", 0,
     "Keep the best setting within: 'temperature_C <= 700', '2*a + b >= 3'; may be repeated", 2},
    {"at", OPTION_AT, "SETTING", 0,
     "Also what the model expects at this setting, 'temperature_C=650, duration_h=4', and where "
     "along each factor it would be better; may be repeated",
     2},
    {"round", OPTION_ROUND, "NAME=STEP", 0,
     "Also the best setting with this factor at a multiple of STEP, as the oven can be set; once "
     "for each factor (default: as planned)",
     2},
    {"plan", OPTION_PLAN, "RUNS.plan.json", 0,
     "What `doe plan -o RUNS.csv` wrote beside the run sheet: factors are coded by its limits "
     "(default: that of DATA.csv, where it is there)",
     2},
    {"output", 'o', "FILE.json", 0, "Write the JSON report here (-: standard output)", 3},
    {"html", OPTION_HTML, "FILE.html", 0, "One page to read and print", 3},
    {0},
};

static const char doc[] =
    "Analyse a designed experiment: effects with their errors, analysis of variance, the best "
    "setting. `foilgauge doe plan --help` plans one.\v"
    "DATA.csv holds a run per row; the first row names the columns; commas, semicolons or tabs "
    "between the cells, decimal points or (not between commas) decimal commas. - is standard "
    "input. Without -o the results go to standard output: as a table on a terminal, else as "
    "JSON.\n\n"
    "@exit_partly@";

static void parse_code(struct argp_state *state, const char *text, doe_arguments *a) {
  fg_context ctx = {0};
  if (!strcmp(text, "none")) {
    a->options.uncoded = true;
    return;
  }
  if (a->options.codings == CODINGS) argp_error(state, "--code: at most %d", CODINGS);
  if (fg_coding_parse(&ctx, text, &a->coding[a->options.codings]) != FG_OK)
    argp_error(state, "--code: %s", ctx.message);
  for (size_t i = 0; i < a->options.codings; i++)
    if (!strcmp(a->coding[i].name, a->coding[a->options.codings].name))
      argp_error(state, "--code: '%s' is coded twice", a->coding[i].name);
  a->options.codings++;
}

static void parse_sign(struct argp_state *state, const char *text, doe_arguments *a) {
  static const char *const words[] = {"auto", "as-is", "magnitude"};
  for (int i = 0; i < 3; i++)
    if (!strcmp(text, words[i])) {
      a->options.sign = (fg_experiment_sign)i;
      return;
    }
  argp_error(state, "--sign: '%s' is none of magnitude, as-is, auto", text);
}

static void parse_goal(struct argp_state *state, const char *text, doe_arguments *a) {
  a->options.goal = FG_GOAL_LOWEST;
  if (!strcmp(text, "lowest")) return;
  a->options.goal = FG_GOAL_HIGHEST;
  if (!strcmp(text, "highest")) return;
  a->options.goal = FG_GOAL_TARGET;
  a->options.target = fg_cli_number(state, "goal", text, -1e300, 1e300);
}

static void parse_constraint(struct argp_state *state, const char *text, doe_arguments *a) {
  if (a->options.constraints == FG_REGION_PLANES)
    argp_error(state, "--constraint: at most %d", FG_REGION_PLANES);
  a->constraint[a->options.constraints++] = text;
}

static void parse_at(struct argp_state *state, const char *text, doe_arguments *a) {
  if (a->options.ats == SETTINGS) argp_error(state, "--at: at most %d", SETTINGS);
  a->at[a->options.ats++] = text;
}

static void parse_round(struct argp_state *state, const char *text, doe_arguments *a) {
  fg_context ctx = {0};
  if (a->options.rounds == CODINGS) argp_error(state, "--round: at most %d", CODINGS);
  if (fg_rounding_parse(&ctx, text, &a->round[a->options.rounds]) != FG_OK)
    argp_error(state, "--round: %s", ctx.message);
  a->options.rounds++;
}

/* Options whose text is kept as it is. */
static const fg_cli_value values[] = {
    FG_CLI_VALUE(OPTION_RESPONSE, doe_run, arguments.options.response),
    FG_CLI_VALUE(OPTION_MODEL, doe_run, arguments.options.formula),
    FG_CLI_VALUE(OPTION_BLOCK, doe_run, arguments.options.block),
    FG_CLI_VALUE(OPTION_WHOLE_PLOT, doe_run, arguments.options.whole_plot),
    FG_CLI_VALUE(OPTION_UNCERTAINTY, doe_run, arguments.options.uncertainty),
    FG_CLI_VALUE(OPTION_SCANS, doe_run, arguments.scans),
    FG_CLI_VALUE('d', doe_run, arguments.design_path),
    FG_CLI_VALUE('o', doe_run, outputs.path[OUT_JSON]),
    FG_CLI_VALUE(OPTION_HTML, doe_run, outputs.path[OUT_HTML]),
    FG_CLI_VALUE(OPTION_PLAN, doe_run, arguments.plan_path),
    FG_CLI_NUMBER(OPTION_CONFIDENCE, doe_run, arguments.options.confidence, 0.5, 0.9999),
    FG_CLI_NUMBER(OPTION_DPI, doe_run, arguments.dpi, 1, 1e6),
    FG_CLI_VALUE(OPTION_ALLOW_LOSSY, doe_run, arguments.allow_lossy),
    FG_CLI_NUMBER(OPTION_THREADS, doe_run, arguments.threads, 1, 1024),
    {0},
};

static void check_arguments(struct argp_state *state, const doe_arguments *a) {
  if (!a->data) argp_error(state, "no DATA.csv was given");
  if (!a->options.formula) argp_error(state, "no --model was given");
  if (a->scans && !a->options.response)
    argp_error(state, "--scans needs --response: the quantity to measure");
  if (a->scans && a->options.uncertainty)
    argp_error(state, "--scans brings its own uncertainty: drop --uncertainty");
}

static error_t parse_doe_option(int key, char *text, struct argp_state *state) {
  doe_run *run = state->input;
  doe_arguments *a = &run->arguments;
  if (fg_cli_keep_value(values, key, text, state)) return 0;
  switch (key) {
  case OPTION_CODE:
    parse_code(state, text, a);
    break;
  case OPTION_SIGN:
    parse_sign(state, text, a);
    break;
  case OPTION_GOAL:
    parse_goal(state, text, a);
    break;
  case OPTION_CONSTRAINT:
    parse_constraint(state, text, a);
    break;
  case OPTION_AT:
    parse_at(state, text, a);
    break;
  case OPTION_ROUND:
    parse_round(state, text, a);
    break;
  case ARGP_KEY_ARG:
    if (a->data) argp_error(state, "one DATA.csv at a time, not also '%s'", text);
    a->data = text;
    break;
  case ARGP_KEY_END:
    check_arguments(state, a);
    break;
  default:
    return ARGP_ERR_UNKNOWN;
  }
  return 0;
}

/* --model may be a formula, or name what `foilgauge loop --model-out` wrote. */
static bool is_model_file(const char *model) {
  size_t length = model ? strlen(model) : 0;
  return length >= 5 && !strcmp(model + length - 5, ".json");
}

static fg_status check_outputs(fg_context *ctx, doe_run *run) {
  const doe_arguments *a = &run->arguments;
  const fg_input inputs[] = {
      {a->data, "the table of runs"},
      {a->design_path, "the design"},
      {is_model_file(a->options.formula) ? a->options.formula : NULL, "the loop's model"}};
  return fg_output_set_check(ctx, &run->outputs, inputs, sizeof inputs / sizeof *inputs);
}

/* Missing columns are reported before the scans are measured. */
static fg_status check_columns(fg_context *ctx, const doe_run *run) {
  const fg_experiment_options *how = &run->arguments.options;
  const fg_column *column;
  if (how->block) FG_TRY(fg_table_find(ctx, &run->sheet, how->block, &column));
  return how->whole_plot ? fg_table_find(ctx, &run->sheet, how->whole_plot, &column) : FG_OK;
}

static fg_status measure_scans(fg_context *ctx, doe_run *run) {
  doe_arguments *a = &run->arguments;
  FG_TRY(check_columns(ctx, run));
  fg_design_default(&run->design);
  if (a->design_path) FG_TRY(fg_design_load(ctx, a->design_path, &run->design));
  const fg_runs_scans how = {
      .sheet_path = a->data,
      .column = a->scans,
      .quantity = a->options.response,
      .design = &run->design,
      .measure = {.dpi = a->dpi, .threads = a->threads, .allow_lossy = a->allow_lossy},
      .outputs = &run->outputs};
  FG_TRY(fg_runs_measure(ctx, &run->sheet, &how, &run->measured));
  FG_TRY(fg_text_print(ctx, &run->u_name, "u_%s", a->options.response));
  const fg_column *column;
  if (fg_table_find(NULL, &run->measured.table, run->u_name, &column) == FG_OK)
    a->options.uncertainty = run->u_name;
  return FG_OK;
}

static fg_status write_doe_output(fg_context *ctx, void *user, size_t kind, FILE *out) {
  const doe_run *run = user;
  const fg_experiment_report report = {.experiment = &run->experiment,
                                       .path = run->arguments.data,
                                       .sha256 = run->sha256,
                                       .scans_column = run->arguments.scans,
                                       .design_path = run->arguments.design_path,
                                       .design = run->measured.scans ? &run->design : NULL,
                                       .u_calibration = run->measured.u_calibration,
                                       .model_path = run->loop_model ? run->model_path : NULL,
                                       .model_sha256 = run->model_sha256,
                                       .scan = run->measured.scan,
                                       .scans = run->measured.scans,
                                       .row = run->measured.row,
                                       .plan_path = run->plan.path,
                                       .plan_note = run->plan.note[0] ? run->plan.note : NULL};
  return writers[kind](ctx, &report, out);
}

static fg_status describe_subtracted(fg_context *ctx, doe_run *run) {
  const fg_loop_takings *takings = &run->takings;
  fg_experiment_options *how = &run->arguments.options;
  FG_TRY(
      fg_memory_allocate(ctx, takings->count, sizeof *run->subtracted, (void **)&run->subtracted));
  for (size_t i = 0; i < takings->count; i++) {
    const fg_loop_taken *from = &takings->one[i];
    fg_subtracted_effect *to = &run->subtracted[i];
    *to = (fg_subtracted_effect){.amplitude = from->amplitude,
                                 .u_amplitude = from->u_amplitude,
                                 .parameters = from->parameters,
                                 .low = from->low,
                                 .high = from->high,
                                 .applied = from->applied};
    fg_text_clip(to->id, sizeof to->id, "%s", from->id);
    fg_text_clip(to->words, sizeof to->words, "%s", from->words);
    fg_text_clip(to->sentence, sizeof to->sentence, "%s", from->sentence);
    for (int k = 0; k < 2; k++)
      fg_text_clip(to->column[k], sizeof to->column[k], "%s", from->column[k]);
  }
  how->subtracted = run->subtracted;
  how->subtracted_count = takings->count;
  how->subtracted_sum = takings->change;
  return FG_OK;
}

/* Moments are numbers, as they are to the loop: a trend, and no level in every row. */
static fg_status count_times(fg_context *ctx, doe_run *run, fg_table *table) {
  fg_loop_table_spec spec = {0};
  FG_TRY(fg_loop_table_count_times(ctx, table, &spec, &run->said));
  run->arguments.options.reading = run->said;
  return FG_OK;
}

/* The effects of a model file are taken out of the response, and its formula is the one to analyse.
 */
static fg_status apply_loop_model(fg_context *ctx, doe_run *run, fg_table *table) {
  const char *name = run->model_path = run->arguments.options.formula;
  if (!is_model_file(name)) return FG_OK;
  FG_TRY(fg_loop_model_load(ctx, name, &run->loop_model));
  FG_TRY(fg_sha256_file(ctx, name, run->model_sha256));
  const char *response = fg_loop_model_response(run->loop_model);
  if (run->arguments.options.response && strcmp(run->arguments.options.response, response) != 0)
    return fg_fail(ctx, FG_ERR_DATA, "%s: a model of the response '%s', not of '%s'", name,
                   response, run->arguments.options.response);
  FG_TRY(fg_loop_model_take(ctx, run->loop_model, table, &run->takings));
  run->arguments.options.formula = fg_loop_model_formula(run->loop_model);
  return describe_subtracted(ctx, run);
}

static fg_status analyse(fg_context *ctx, doe_run *run) {
  doe_arguments *a = &run->arguments;
  a->options.coding = a->coding;
  a->options.constraint = a->constraint;
  a->options.at = a->at;
  a->options.round = a->round;
  fg_output_set_choose_standard(&run->outputs, OUT_JSON, OUT_TABLE, true);
  FG_TRY(check_outputs(ctx, run));
  FG_TRY(fg_table_load(ctx, a->data, &run->sheet, run->sha256));
  FG_TRY(fg_output_set_open(ctx, &run->outputs));
  if (a->scans) FG_TRY(measure_scans(ctx, run));
  fg_table *runs = a->scans ? &run->measured.table : &run->sheet;
  FG_TRY(count_times(ctx, run, runs));
  FG_TRY(apply_loop_model(ctx, run, runs));
  const fg_doe_plan_request plan = {a->plan_path, a->data,   &run->sheet,
                                    &a->options,  a->coding, a->round};
  FG_TRY(fg_doe_plan_find(ctx, &plan, &run->plan));
  FG_TRY(fg_experiment_analyse(ctx, runs, &a->options, &run->experiment));
  return fg_output_set_write(ctx, &run->outputs, write_doe_output, run);
}

static void free_run(doe_run *run) {
  fg_output_set_close(&run->outputs);
  fg_experiment_free(&run->experiment);
  fg_run_sheet_free(&run->measured);
  fg_loop_model_free(run->loop_model);
  fg_loop_takings_free(&run->takings);
  free(run->subtracted);
  fg_table_free(&run->sheet);
  free(run->u_name);
  free(run->said);
  fg_doe_plan_free(&run->plan);
}

const struct argp fg_doe_parser = {options, parse_doe_option, "DATA.csv", doc,
                                   NULL,    fg_cli_fill,      NULL};

int fg_cmd_doe(int argc, char **argv) {
  if (argc > 1 && !strcmp(argv[1], "plan")) {
    argv[1] = (char[]){"foilgauge doe plan"};
    return fg_cmd_doe_plan(argc - 1, argv + 1);
  }
  fg_context ctx = {0};
  doe_run run = {.outputs.count = OUT_COUNT};
  fg_status status = fg_cli_parse(&ctx, &fg_doe_parser, argc, argv, &run);
  if (status != FG_OK) return fg_cli_fail(&ctx, status);
  status = analyse(&ctx, &run);
  int code = run.measured.failed ? 2 : 0;
  free_run(&run);
  return status == FG_OK ? code : fg_cli_fail(&ctx, status);
}
