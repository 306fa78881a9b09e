#include <argp.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/commands.h"
#include "core/file.h"
#include "foilgauge/scan.h"
#include "foilgauge/scan_loop.h"

enum { SCANS_MOST = 64 };
enum {
  OPTION_DESIGN = 256,
  OPTION_FORM,
  OPTION_DPI,
  OPTION_SAME,
  OPTION_HOLD_OUT,
  OPTION_MODEL_OUT,
  OPTION_HTML,
  OPTION_SCANNER,
  OPTION_SEED,
  OPTION_THREADS
};

typedef struct arguments {
  const char *paths[SCANS_MOST];
  bool hold_out[SCANS_MOST];
  size_t count, kept_aside;
  const char *design_path, *form, *output_path, *model_path, *page_path;
  fg_scan_loop_options options;
} arguments;

static const struct argp_option options[] = {
    {"design", OPTION_DESIGN, "FILE", 0,
     "The design of the foil or of the gauges (default: Gen II)", 0},
    {"form", OPTION_FORM, "FORM", 0, "classical, sinusoidal or discs; overrules the design", 0},
    {"dpi", OPTION_DPI, "N", 0, "Resolution, where the scan does not say it", 0},
    {"same-foil", OPTION_SAME, NULL, 0,
     "The scans show the same foil, turned or shifted in between: what stays with the glass is the "
     "scanner, what turns is the part",
     0},
    {"hold-out", OPTION_HOLD_OUT, "SCAN", 0, "A scan that only confirms (may be repeated)", 0},
    {"output", 'o', "FILE", 0, "The report as JSON (-: standard output)", 0},
    {"model-out", OPTION_MODEL_OUT, "FILE", 0, "The scanner's model, for `measure --model`", 0},
    {"html", OPTION_HTML, "FILE", 0, "The report as a page", 0},
    {"scanner", OPTION_SCANNER, "NAME", 0, "Its name, kept in the model", 0},
    {"seed", OPTION_SEED, "N", 0, "Of every random step (default 1)", 0},
    {"threads", OPTION_THREADS, "N", 0, "Threads (default: all cores)", 0},
    {0},
};

static const char doc[] =
    "Find what the scanner or the foil does that the geometry lacks: a wrong scale, a shear, a "
    "ripple or step of the carriage, an optical distortion, an oval or spiral foil, flattened or "
    "skewed bumps, or a curve that is none of these; correct the dimensions.\v"
    "One scan detects almost everything and tells almost nothing smooth apart: the report names "
    "the class and the range of every dimension over it. A second scan of the foil, turned by "
    "about "
    "90 degrees, with --same-foil, names one.\n\n"
    "With a design of form \"discs\" (or --form discs) the scan shows round holes or discs: a "
    "plate "
    "of gauges tells the scanner's errors, known diameters_mm in the design its absolute scale.\n\n"
    "With --table DATA.csv the loop is closed on a table: `foilgauge loop --table X --help`.\n\n"
    "Exit code: 0 done; 64 usage; 65 bad data; 74 input or output.";

static void add_scan(struct argp_state *state, const char *path, bool aside) {
  arguments *a = state->input;
  for (size_t i = 0; i < a->count; i++)
    if (!strcmp(a->paths[i], path)) argp_error(state, "%s is given twice", path);
  if (a->count == SCANS_MOST) argp_error(state, "more than %d scans", SCANS_MOST);
  a->hold_out[a->count] = aside;
  a->kept_aside += aside;
  a->paths[a->count++] = path;
}

static double parse_number(struct argp_state *state, const char *name, const char *text) {
  char *end;
  double value = strtod(text, &end);
  if (*end || end == text || !(value > 0))
    argp_error(state, "--%s %s: a number above 0", name, text);
  return value;
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  arguments *a = state->input;
  switch (key) {
  case OPTION_DESIGN:
    a->design_path = text;
    return 0;
  case OPTION_FORM:
    a->form = text;
    return 0;
  case OPTION_DPI:
    a->options.dpi = parse_number(state, "dpi", text);
    return 0;
  case OPTION_SAME:
    a->options.same_foil = true;
    return 0;
  case OPTION_HOLD_OUT:
    add_scan(state, text, true);
    return 0;
  case OPTION_MODEL_OUT:
    a->model_path = text;
    return 0;
  case OPTION_HTML:
    a->page_path = text;
    return 0;
  case OPTION_SCANNER:
    if (!*text || strlen(text) >= FG_SCANNER_NAME)
      argp_error(state, "--scanner: a name of 1 to %d bytes", FG_SCANNER_NAME - 1);
    a->options.scanner = text;
    return 0;
  case OPTION_SEED:
    a->options.seed = (uint64_t)parse_number(state, "seed", text);
    return 0;
  case OPTION_THREADS:
    a->options.threads = (unsigned)parse_number(state, "threads", text);
    return 0;
  case 'o':
    a->output_path = text;
    return 0;
  case ARGP_KEY_ARG:
    add_scan(state, text, false);
    return 0;
  case ARGP_KEY_END:
    if (a->count == a->kept_aside) argp_error(state, "give a scan, or --table DATA.csv");
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

typedef fg_status scan_writer(fg_context *ctx, const fg_scan_loop *loop, FILE *out);

static fg_status write_file(fg_context *ctx, const char *path, const fg_scan_loop *loop,
                            scan_writer *writer) {
  fg_output output;
  FG_TRY(fg_output_open(ctx, path, &output));
  fg_status status = writer(ctx, loop, output.stream);
  if (status == FG_OK) status = fg_output_commit(ctx, &output);
  fg_output_discard(&output);
  return status;
}

static fg_status write_all(fg_context *ctx, const arguments *a, const fg_scan_loop *loop) {
  if (a->model_path) FG_TRY(write_file(ctx, a->model_path, loop, fg_scan_loop_write_model));
  if (a->page_path) FG_TRY(write_file(ctx, a->page_path, loop, fg_scan_loop_write_html));
  if (a->output_path) return write_file(ctx, a->output_path, loop, fg_scan_loop_write_json);
  if (isatty(STDOUT_FILENO)) return write_file(ctx, "-", loop, fg_scan_loop_write_text);
  return a->model_path || a->page_path ? FG_OK
                                       : write_file(ctx, "-", loop, fg_scan_loop_write_json);
}

static fg_status run(fg_context *ctx, const arguments *a) {
  fg_design design;
  fg_scan_loop *loop = NULL;
  fg_design_default(&design);
  if (a->design_path) FG_TRY(fg_design_load(ctx, a->design_path, &design));
  FG_TRY(fg_cli_apply_form(ctx, a->form, &design));
  if (design.form == FG_FORM_DISCS && a->options.same_foil)
    return fg_fail(ctx, FG_ERR_USAGE,
                   "--same-foil is for foils: a disc does not show how far it was turned");
  FG_TRY(fg_scan_loop_run(ctx, a->paths, a->hold_out, a->count, &design, &a->options, &loop));
  fg_status status = write_all(ctx, a, loop);
  fg_scan_loop_free(loop);
  return status;
}

int fg_cmd_loop_scan(int argc, char **argv) {
  static const struct argp parser = {options, parse_option, "SCAN...", doc, NULL, NULL, NULL};
  fg_context ctx = {0};
  arguments a = {.options = {.seed = 1}};
  argv[0] = (char[]){"foilgauge loop"};
  /* in order: reports list the scans as they are given, those kept aside between the others */
  argp_parse(&parser, argc, argv, ARGP_IN_ORDER, NULL, &a);
  fg_status status = run(&ctx, &a);
  return status == FG_OK ? 0 : fg_cli_fail(&ctx, status);
}
