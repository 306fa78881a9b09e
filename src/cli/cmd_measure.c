/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <argp.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/commands.h"
#include "cli/facts.h"
#include "cli/known.h"
#include "cli/output_set.h"
#include "cli/progress.h"
#include "cli/values.h"
#include "foilgauge/measure.h"
#include "foilgauge/memory.h"
#include "foilgauge/report.h"
#include "foilgauge/scan_loop.h"
#include "foilgauge/words.h"

/* Outputs of the command, in the order of writing. */
typedef enum output_kind {
  OUT_JSON,
  OUT_CSV,
  OUT_POINTS,
  OUT_OVERLAY,
  OUT_HTML,
  OUT_TABLE,
  OUT_COUNT
} output_kind;

typedef fg_status report_writer(fg_context *ctx, const fg_report *report, FILE *out);

static report_writer *const writers[OUT_COUNT] = {
    [OUT_JSON] = fg_report_write_json,     [OUT_CSV] = fg_report_write_csv,
    [OUT_POINTS] = fg_report_write_points, [OUT_OVERLAY] = fg_report_write_overlay,
    [OUT_HTML] = fg_report_write_html,     [OUT_TABLE] = fg_report_write_table,
};

typedef struct measure_arguments {
  const char *design_path, *model_path, *scanner;
  const char *kind;
  fg_cli_known known;
  fg_measure_options options;
  const char *gauges[FG_GAUGES_MAX]; /* as given */
  size_t gauge_count;
  char **scans; /* of argv */
  size_t scan_count;
} measure_arguments;

typedef struct measure_run {
  fg_scanner_model *model; /* NULL: none */
  measure_arguments arguments;
  fg_design design;
  fg_nominal nominal;
  fg_output_set outputs;
  fg_measurement *measurements;
  fg_report_scan *scans;
  char (*errors)[sizeof(((fg_context *)0)->message)];
  size_t measured;
  fg_status first_error;
} measure_run;

enum {
  OPTION_CSV = 256,
  OPTION_POINTS,
  OPTION_OVERLAY,
  OPTION_HTML,
  OPTION_DPI,
  OPTION_FORM,
  OPTION_THREADS,
  OPTION_CHANNEL,
  OPTION_ALLOW_LOSSY,
  OPTION_MAX_PIXELS,
  OPTION_MAX_MEMORY,
  OPTION_MODEL,
  OPTION_SCANNER,
  OPTION_GAUGE,
};

static const struct argp_option options[] = {
    {"design", 'd', "FILE", 0, "What the part should be (default: the Gen II foil)", 0},
    {"form", OPTION_FORM, "FORM", 0, "@forms@; overrules the design", 0},
    FG_CLI_KNOWN_ROWS(0),
    {"model", OPTION_MODEL, "FILE.json", 0,
     "Correct by what `foilgauge loop --model-out` found of this scanner", 0},
    {"scanner", OPTION_SCANNER, "NAME", 0, "Refuse a model that is of another scanner", 0},
    {"gauge", OPTION_GAUGE, "KIND:WIDTH:U", 0,
     "A gauge that lies on the glass in the same scan: leaf, pin, ring or hole, its known width "
     "and the standard uncertainty of that in mm, as leaf:0.1:0.0005; again for each; overrules "
     "the design's",
     0},
    {"dpi", OPTION_DPI, "N", 0, "Resolution of the scan; overrules the file", 0},
    {"channel", OPTION_CHANNEL, "CHANNEL", 0,
     "Of a colour scan: @channels@; auto is the one with the most contrast, which takes a second "
     "reading (default: auto)",
     0},
    {"allow-lossy", OPTION_ALLOW_LOSSY, NULL, 0, FG_CLI_ALLOW_LOSSY, 0},
    {"output", 'o', "FILE.json", 0, "Write the JSON report here (-: standard output)", 1},
    {"csv", OPTION_CSV, "FILE.csv", 0, "One line per bump", 1},
    {"points", OPTION_POINTS, "FILE.csv", 0, "Every edge point, its arc and its residual", 1},
    FG_CLI_DECIMAL_COMMA_ROW(1),
    {"overlay", OPTION_OVERLAY, "FILE.png", 0, "The scan with what was found drawn over it", 1},
    {"html", OPTION_HTML, "FILE.html", 0, "One page to read and print", 1},
    {"threads", OPTION_THREADS, "N", 0, "Threads (default: one per core)", 2},
    {"max-pixels", OPTION_MAX_PIXELS, "N", 0, "Refuse larger scans (default: @pixel_cap@)", 2},
    {"max-memory", OPTION_MAX_MEMORY, "MIB", 0,
     "Stop when the scan's rows and foils take more memory (default: @memory_cap_mib@)", 2},
    {0},
};

static const char doc[] =
    "Measure every foil in a scan: radii, angles, heights, clearances, each with its uncertainty."
    "\vSCAN is a @formats@ file, or - for standard input. Without -o the results go to standard "
    "output: as a table on "
    "a terminal, else as JSON.\n\n"
    "@exit_judged@";

static fg_channel parse_channel(struct argp_state *state, const char *text) {
  for (int channel = FG_CHANNEL_AUTO; channel <= FG_CHANNEL_LUMINANCE; channel++)
    if (!strcmp(text, fg_channel_word((fg_channel)channel))) return (fg_channel)channel;
  argp_error(state, "--channel: '%s' is none of auto, red, green, blue, luminance", text);
  return FG_CHANNEL_AUTO;
}

static const fg_cli_value values[] = {
    FG_CLI_VALUE('d', measure_run, arguments.design_path),
    FG_CLI_VALUE('o', measure_run, outputs.path[OUT_JSON]),
    FG_CLI_VALUE(OPTION_MODEL, measure_run, arguments.model_path),
    FG_CLI_VALUE(OPTION_SCANNER, measure_run, arguments.scanner),
    FG_CLI_VALUE(OPTION_CSV, measure_run, outputs.path[OUT_CSV]),
    FG_CLI_VALUE(OPTION_POINTS, measure_run, outputs.path[OUT_POINTS]),
    FG_CLI_VALUE(OPTION_OVERLAY, measure_run, outputs.path[OUT_OVERLAY]),
    FG_CLI_VALUE(OPTION_HTML, measure_run, outputs.path[OUT_HTML]),
    FG_CLI_VALUE(OPTION_FORM, measure_run, arguments.kind),
    FG_CLI_NUMBER(OPTION_DPI, measure_run, arguments.options.dpi, 1, 1e6),
    FG_CLI_NUMBER(OPTION_THREADS, measure_run, arguments.options.threads, 1, 1024),
    FG_CLI_VALUE(OPTION_ALLOW_LOSSY, measure_run, arguments.options.allow_lossy),
    FG_CLI_VALUE(FG_CLI_DECIMAL_COMMA, measure_run, outputs.decimal_comma),
    {0},
};

static error_t parse_measure_option(int key, char *text, struct argp_state *state) {
  measure_run *run = state->input;
  measure_arguments *arguments = &run->arguments;
  if (fg_cli_keep_value(values, key, text, state)) return 0;
  switch (key) {
  case OPTION_GAUGE:
    if (arguments->gauge_count == FG_GAUGES_MAX)
      argp_error(state, "--gauge: more than %d gauges", FG_GAUGES_MAX);
    arguments->gauges[arguments->gauge_count++] = text;
    break;
  case OPTION_CHANNEL:
    arguments->options.channel = parse_channel(state, text);
    break;
  case OPTION_MAX_PIXELS:
    arguments->options.pixel_cap = (uint64_t)fg_cli_number(state, "max-pixels", text, 1, 1e15);
    break;
  case OPTION_MAX_MEMORY:
    arguments->options.memory_cap = (size_t)fg_cli_number(state, "max-memory", text, 1, 1 << 24)
                                    << 20;
    break;
  case ARGP_KEY_ARGS:
    arguments->scans = state->argv + state->next;
    arguments->scan_count = (size_t)(state->argc - state->next);
    break;
  case ARGP_KEY_NO_ARGS:
    argp_error(state, "no SCAN was given");
    break;
  default:
    return fg_cli_parse_known(state, key, text, &arguments->known) ? 0 : ARGP_ERR_UNKNOWN;
  }
  return 0;
}

/* Puts the file's name before the words that are there. */
static fg_status name_file(fg_context *ctx, const char *path, fg_status status) {
  fg_context inner = *ctx;
  if (status == FG_OK) return FG_OK;
  return fg_fail(ctx, status, "%.200s: %.800s", path, inner.message);
}

static fg_status check_arguments(fg_context *ctx, measure_run *run) {
  const measure_arguments *arguments = &run->arguments;
  size_t standard = 0;
  for (size_t i = 0; i < arguments->scan_count; i++)
    standard += fg_is_standard(arguments->scans[i]);
  if (standard > 1) return fg_fail(ctx, FG_ERR_USAGE, "-: standard input can be read only once");
  if (run->outputs.path[OUT_OVERLAY] && (arguments->scan_count > 1 || standard))
    return fg_fail(ctx, FG_ERR_USAGE,
                   "--overlay shows one scan, read again from its file: give one file");
  const fg_input others[] = {{arguments->design_path, "the design"},
                             {arguments->model_path, "the scanner's model"}};
  FG_TRY(fg_output_set_check(ctx, &run->outputs, others, sizeof others / sizeof *others));
  for (size_t i = 0; i < arguments->scan_count; i++)
    FG_TRY(
        fg_output_set_check(ctx, &run->outputs, &(fg_input){arguments->scans[i], "the scan"}, 1));
  return FG_OK;
}

static fg_status apply_gauges(fg_context *ctx, const measure_arguments *arguments,
                              fg_design *design) {
  if (!arguments->gauge_count) return FG_OK;
  design->gauge_count = 0;
  for (size_t i = 0; i < arguments->gauge_count; i++)
    FG_TRY(fg_gauge_parse(ctx, arguments->gauges[i], &design->gauges[design->gauge_count++]));
  return FG_OK;
}

static fg_status load_design(fg_context *ctx, measure_run *run) {
  fg_design_default(&run->design);
  if (run->arguments.design_path)
    FG_TRY(fg_design_load(ctx, run->arguments.design_path, &run->design));
  FG_TRY(fg_cli_apply_foil_kind(ctx, run->arguments.kind, &run->design));
  fg_cli_apply_known(&run->arguments.known, &run->design);
  FG_TRY(fg_cli_apply_flatbed(ctx, run->arguments.known.flatbed, &run->design));
  FG_TRY(apply_gauges(ctx, &run->arguments, &run->design));
  FG_TRY(fg_design_check(ctx, &run->design));
  FG_TRY(fg_design_derive(ctx, &run->design, &run->nominal));
  const char *path = run->arguments.design_path;
  return name_file(ctx, path ? path : "the built-in design",
                   fg_report_check_tolerances(ctx, &run->design));
}

static fg_status allocate_scans(fg_context *ctx, measure_run *run) {
  size_t count = run->arguments.scan_count;
  void *block;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *run->measurements, &block));
  run->measurements = block;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *run->scans, &block));
  run->scans = block;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *run->errors, &block));
  run->errors = block;
  return FG_OK;
}

/* Notes the oddities of a scan. The report's note has the names of the picture's findings alone.
 */
static void note_oddities(const char *path, const fg_measurement *m) {
  static const char of_picture[] = "state of the picture:";
  if (m->warning[0] && strncmp(m->warning, of_picture, sizeof of_picture - 1) != 0)
    fprintf(stderr, "foilgauge: note: %s: %s\n", path, m->warning);
  fg_cli_note_picture(path, m->picture.findings);
}

/* Notes foils that could not be measured on standard error: the report may go to a file. */
static void note_failures(const fg_measurement *measurement) {
  for (size_t i = 0; i < measurement->foil_count; i++) {
    const fg_foil *foil = &measurement->foils[i];
    if (!fg_foil_is_measured(foil))
      fprintf(stderr, "foilgauge: %s: foil %d could not be measured: %s\n", measurement->scan,
              foil->number, foil->error);
  }
}

/* Corrects by the scanner's model, where one is given. */
static fg_status apply_model(fg_context *ctx, const measure_run *run, fg_measurement *m) {
  char warning[200];
  if (!run->model) return FG_OK;
  FG_TRY(fg_scanner_model_apply(ctx, run->model, m, run->arguments.options.threads, warning));
  if (warning[0]) fprintf(stderr, "foilgauge: note: %s\n", warning);
  if (m->tone_note[0] && strncmp(m->warning, m->tone_note, sizeof m->tone_note - 1) != 0)
    fprintf(stderr, "foilgauge: %s: note: %s\n", m->scan, m->tone_note);
  return FG_OK;
}

/* Measures one scan. A scan that fails is reported; only an error that ends the run is returned. */
static fg_status measure_one(fg_context *ctx, measure_run *run, size_t index) {
  fg_measure_options options_of_scan = run->arguments.options;
  fg_progress progress;
  const char *path = run->arguments.scans[index];
  fg_report_scan *scan = &run->scans[index];
  fg_progress_begin(&progress, path);
  options_of_scan.without_plain = !fg_scanner_model_has_level(run->model);
  options_of_scan.progress = fg_progress_show;
  options_of_scan.progress_user = &progress;
  fg_status status =
      fg_measure_scan(ctx, path, &run->design, &options_of_scan, &run->measurements[index]);
  fg_progress_end(&progress);
  if (status == FG_OK) {
    status = apply_model(ctx, run, &run->measurements[index]);
    if (status == FG_OK)
      status =
          fg_measurement_calibrate(ctx, run->arguments.options.threads, &run->measurements[index]);
    if (status != FG_OK) fg_measurement_free(&run->measurements[index]);
  }
  scan->path = path;
  if (status == FG_OK) {
    scan->measurement = &run->measurements[index];
    note_oddities(path, &run->measurements[index]);
    note_failures(&run->measurements[index]);
    run->measured++;
    return FG_OK;
  }
  if (status == FG_ERR_INTERRUPTED || status == FG_ERR_MEMORY) return status;
  memcpy(run->errors[index], ctx->message, sizeof ctx->message);
  scan->error = run->errors[index];
  if (run->first_error == FG_OK) run->first_error = status;
  if (run->arguments.scan_count > 1) fg_cli_fail(ctx, status);
  return FG_OK;
}

static fg_status measure_all(fg_context *ctx, measure_run *run) {
  FG_TRY(allocate_scans(ctx, run));
  for (size_t i = 0; i < run->arguments.scan_count; i++)
    FG_TRY(measure_one(ctx, run, i));
  if (run->measured > 0) return FG_OK;
  if (run->arguments.scan_count == 1) return run->first_error; /* ctx has its words */
  return fg_fail(ctx, run->first_error, "none of %zu scans could be measured",
                 run->arguments.scan_count);
}

static fg_status write_measure_output(fg_context *ctx, void *user, size_t kind, FILE *out) {
  const measure_run *run = user;
  const fg_report report = {&run->design, &run->nominal, run->scans, run->arguments.scan_count,
                            NULL};
  return writers[kind](ctx, &report, out);
}

static fg_status outcome_code(fg_context *ctx, const measure_run *run, int *code) {
  const fg_report report = {&run->design, &run->nominal, run->scans, run->arguments.scan_count,
                            NULL};
  fg_report_outcome outcome;
  FG_TRY(fg_report_judge(ctx, &report, &outcome));
  *code = fg_outcome_exit_code(&outcome);
  return FG_OK;
}

static void free_run(measure_run *run) {
  fg_scanner_model_free(run->model);
  fg_output_set_close(&run->outputs);
  for (size_t i = 0; run->scans && i < run->arguments.scan_count; i++)
    if (run->scans[i].measurement) fg_measurement_free(&run->measurements[i]);
  free(run->measurements);
  free(run->scans);
  free(run->errors);
}

static fg_status load_model(fg_context *ctx, measure_run *run) {
  const char *path = run->arguments.model_path;
  if (!path && run->arguments.scanner)
    return fg_fail(ctx, FG_ERR_USAGE, "--scanner says which scanner --model must be of: give one");
  if (!path) return FG_OK;
  FG_TRY(fg_scanner_model_load(ctx, path, &run->model));
  FG_TRY(fg_scanner_model_check_scanner(ctx, run->model, path, run->arguments.scanner));
  fg_scanner_model_trace(run->model, &run->design);
  if (fg_scanner_model_is_tied(run->model))
    fprintf(stderr,
            "foilgauge: note: %s: other explanations did as well, or nearly, when the model was "
            "found; every "
            "u_ is wider by what they would have changed\n",
            path);
  return FG_OK;
}

static void note_not_judged(const fg_design *design) {
  char names[400];
  if (fg_report_of_bearing(design, names, sizeof names))
    fprintf(stderr,
            "foilgauge: note: not judged here: %s: a scan has no bearing; `foilgauge lot` judges "
            "its bearings by it\n",
            names);
}

static fg_status measure_scans(fg_context *ctx, measure_run *run, int *code) {
  fg_output_set_choose_standard(&run->outputs, OUT_JSON, OUT_TABLE, true);
  FG_TRY(check_arguments(ctx, run));
  FG_TRY(load_design(ctx, run));
  note_not_judged(&run->design);
  FG_TRY(load_model(ctx, run));
  fg_cli_note_scale(&run->design);
  FG_TRY(fg_output_set_open(ctx, &run->outputs));
  FG_TRY(measure_all(ctx, run));
  FG_TRY(outcome_code(ctx, run, code)); /* first: it can fail, and files that are written stay */
  return fg_output_set_write(ctx, &run->outputs, write_measure_output, run);
}

const struct argp fg_measure_parser = {options, parse_measure_option, "SCAN...", doc,
                                       NULL,    fg_cli_fill,          NULL};

int fg_cmd_measure(int argc, char **argv) {
  fg_context ctx = {0};
  measure_run run = {.outputs.count = OUT_COUNT, .outputs.csv = 1u << OUT_CSV | 1u << OUT_POINTS};
  int code = 0;
  fg_status parsed = fg_cli_parse(&ctx, &fg_measure_parser, argc, argv, &run);
  if (parsed != FG_OK) return fg_cli_fail(&ctx, parsed);
  fg_status status = measure_scans(&ctx, &run, &code);
  free_run(&run);
  return status == FG_OK ? code : fg_cli_fail(&ctx, status);
}
