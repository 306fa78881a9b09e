/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <argp.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli/commands.h"
#include "cli/facts.h"
#include "cli/known.h"
#include "cli/output_set.h"
#include "cli/values.h"
#include "foilgauge/foil_kind.h"
#include "foilgauge/forming.h"
#include "foilgauge/grid_loop.h"
#include "foilgauge/memory.h"
#include "foilgauge/scan.h"
#include "foilgauge/scan_loop.h"

enum { SCANS_MAX = 64 };
enum {
  OPTION_DESIGN = 256,
  OPTION_FORM,
  OPTION_DPI,
  OPTION_ALLOW_LOSSY,
  OPTION_SAME,
  OPTION_SAME_PART,
  OPTION_TURNED,
  OPTION_HOLD_OUT,
  OPTION_MODEL_OUT,
  OPTION_HTML,
  OPTION_SCANNER,
  OPTION_FORMING_MODEL,
  OPTION_COLOUR_GAP,
  OPTION_SEED,
  OPTION_THREADS,
  OPTION_WITHOUT
};

typedef fg_status scan_writer(fg_context *ctx, const fg_scan_loop *loop, FILE *out);

static scan_writer *const writers[FG_LOOP_OUTPUTS] = {
    [FG_LOOP_HTML] = fg_scan_loop_write_html,
    [FG_LOOP_MODEL] = fg_scan_loop_write_model,
    [FG_LOOP_JSON] = fg_scan_loop_write_json,
    [FG_LOOP_TEXT] = fg_scan_loop_write_text,
};

typedef struct arguments {
  const char *paths[SCANS_MAX];
  bool hold_out[SCANS_MAX];
  size_t count, held_out;
  const char *design_path, *kind, *forming_model;
  fg_cli_known known;
  fg_output_set outputs;
  fg_scan_loop_options options;
  fg_grid_loop_options grid;
} arguments;

static const struct argp_option options[] = {
    {"design", OPTION_DESIGN, "FILE", 0,
     "The design of the foil or of the gauges (default: Gen II)", 0},
    {"form", OPTION_FORM, "FORM", 0, "@forms@; overrules the design", 0},
    FG_CLI_KNOWN_ROWS(0),
    {"dpi", OPTION_DPI, "N", 0, "Resolution, where the scan does not say it", 0},
    {"allow-lossy", OPTION_ALLOW_LOSSY, NULL, 0, FG_CLI_ALLOW_LOSSY, 0},
    {"same-foil", OPTION_SAME, NULL, 0,
     "The scans show the same foil, turned or shifted in between: what stays with the glass is the "
     "scanner, what turns is the part",
     0},
    {"same-part", OPTION_SAME_PART, NULL, 0,
     "The same of grids: any number of scans of one plate or board", 0},
    {"turned", OPTION_TURNED, "DEGREES", 0,
     "Of grids with --same-part: how the board lies in every scan, as 0,90,180: multiples of 90 "
     "against the first scan, clockwise as the scans show it (default: as the pictures show)",
     0},
    {"form-model", OPTION_FORMING_MODEL, "FORM.json", 0,
     "A report of `foilgauge forming -o` as the declared model of the bumps, in place of one "
     "springback for all: the radius that it predicts of each bump beside one level, and its arc "
     "length",
     0},
    {"colour-gap", OPTION_COLOUR_GAP, "RED[,BLUE]", 0,
     "Rows of the scan by which the red and the blue line of a colour sensor lie ahead of the "
     "green "
     "one; BLUE: -RED, where it is not given. What the colour lines say of an effect of the "
     "carriage then has a size",
     0},
    {"without", OPTION_WITHOUT, "EFFECTS", 0,
     "Effects that are not looked for, by name and with commas between: such as one that this "
     "scanner cannot have. What "
     "they would explain is then another's, or unattributed",
     0},
    {"hold-out", OPTION_HOLD_OUT, "SCAN", 0, "A scan that only confirms (may be repeated)", 0},
    {"output", 'o', "FILE", 0, "The report as JSON (-: standard output)", 0},
    {"model-out", OPTION_MODEL_OUT, "FILE", 0, "The scanner's model, for `measure --model`", 0},
    {"html", OPTION_HTML, "FILE", 0, "The report as a page", 0},
    {"scanner", OPTION_SCANNER, "NAME", 0, "The scanner's name, kept in the model", 0},
    {"seed", OPTION_SEED, "N", 0, "Of every random step (default: @seed@)", 0},
    {"threads", OPTION_THREADS, "N", 0, "Threads (default: all cores)", 0},
    {0},
};

static const char doc[] =
    "Find what the scanner or the foil does that the geometry lacks: a wrong scale, a shear, a "
    "ripple or step of the carriage, an optical distortion, an oval or spiral foil, flattened or "
    "skewed bumps, a strip that is thicker at one end, or a curve that is none of these; correct "
    "the dimensions.\v"
    "One scan detects almost everything and tells almost nothing smooth apart: the report names "
    "the class and the range of every dimension over it. A second scan of the foil, turned by "
    "about "
    "90 degrees, with --same-foil, names one.\n\n"
    "With a design of form \"discs\" (or --form discs) the scan shows round holes or discs: a "
    "plate "
    "of gauges tells the scanner's errors, known diameters_mm in the design its absolute scale.\n\n"
    "With --table DATA.csv the loop is closed on a table, with --lot DIR on what a lot measured, "
    "with "
    "--doe RUNS.csv on an experiment's scans: `foilgauge loop --table --help`.\n\n"
    "On a terminal the results are printed as a table; elsewhere, where no file is asked for, as "
    "JSON.\n\n"
    "@exit_partly@";

static void add_scan(struct argp_state *state, const char *path, bool held_out) {
  arguments *a = state->input;
  for (size_t i = 0; i < a->count; i++)
    if (!strcmp(a->paths[i], path)) argp_error(state, "%s is given twice", path);
  if (a->count == SCANS_MAX) argp_error(state, "at most %d scans", SCANS_MAX);
  a->hold_out[a->count] = held_out;
  a->held_out += held_out;
  a->paths[a->count++] = path;
}

/* Lines of a sensor lie some rows apart, to a few hundred. */
#define GAP_MAX_PX 1000.0

static void parse_gaps(struct argp_state *state, const char *text, double gap_px[2]) {
  char *end;
  gap_px[0] = strtod(text, &end);
  bool fine = end != text;
  gap_px[1] = -gap_px[0];
  if (fine && *end == ',') {
    const char *next = end + 1;
    gap_px[1] = strtod(next, &end);
    fine = end != next;
  }
  for (int i = 0; i < 2; i++)
    fine = fine && fabs(gap_px[i]) <= GAP_MAX_PX;
  if (!fine || *end || (gap_px[0] == 0 && gap_px[1] == 0))
    argp_error(state,
               "--colour-gap: '%s' is not one or two numbers of rows from -%g to %g, not both 0",
               text, GAP_MAX_PX, GAP_MAX_PX);
}

static void parse_turns(struct argp_state *state, const char *text, int turns[FG_GRID_SCANS]) {
  const char *at = text;
  for (size_t i = 0; i < FG_GRID_SCANS; i++) {
    char *end;
    long degrees = strtol(at, &end, 10);
    if (end == at || degrees % 90 || (*end && *end != ','))
      argp_error(state, "--turned: '%s' is not a multiple of 90 for each scan, as 0,90", text);
    turns[i] = (int)(((degrees / 90) % 4 + 4) % 4);
    if (!*end) return;
    at = end + 1;
  }
}

static const fg_cli_value values[] = {
    FG_CLI_VALUE(OPTION_DESIGN, arguments, design_path),
    FG_CLI_VALUE(OPTION_FORM, arguments, kind),
    FG_CLI_VALUE(OPTION_FORMING_MODEL, arguments, forming_model),
    FG_CLI_VALUE(OPTION_ALLOW_LOSSY, arguments, options.allow_lossy),
    FG_CLI_VALUE(OPTION_SAME, arguments, options.same_foil),
    FG_CLI_VALUE(OPTION_WITHOUT, arguments, options.without),
    FG_CLI_NUMBER(OPTION_DPI, arguments, options.dpi, 1, 1e6),
    FG_CLI_NUMBER(OPTION_THREADS, arguments, options.threads, 1, 1024),
    FG_CLI_VALUE(OPTION_SAME_PART, arguments, grid.same_part),
    FG_CLI_VALUE(OPTION_MODEL_OUT, arguments, outputs.path[FG_LOOP_MODEL]),
    FG_CLI_VALUE(OPTION_HTML, arguments, outputs.path[FG_LOOP_HTML]),
    FG_CLI_VALUE('o', arguments, outputs.path[FG_LOOP_JSON]),
    {0},
};

static error_t parse_option(int key, char *text, struct argp_state *state) {
  arguments *a = state->input;
  if (fg_cli_keep_value(values, key, text, state)) return 0;
  switch (key) {
  case OPTION_HOLD_OUT:
    add_scan(state, text, true);
    return 0;
  case OPTION_SCANNER:
    if (!*text || strlen(text) >= FG_SCANNER_NAME)
      argp_error(state, "--scanner: the name must have 1 to %d bytes", FG_SCANNER_NAME - 1);
    a->options.scanner = text;
    return 0;
  case OPTION_SEED:
    a->options.seed = fg_cli_seed(state, text);
    return 0;
  case OPTION_TURNED:
    parse_turns(state, text, a->grid.turns);
    return 0;
  case OPTION_COLOUR_GAP:
    parse_gaps(state, text, a->options.colour_gap_px);
    return 0;
  case ARGP_KEY_ARG:
    add_scan(state, text, false);
    return 0;
  case ARGP_KEY_END:
    if (a->count == a->held_out)
      argp_error(state, "give a scan, or --table DATA.csv, --lot DIR, --doe RUNS.csv");
    return 0;
  default:
    return fg_cli_parse_known(state, key, text, &a->known) ? 0 : ARGP_ERR_UNKNOWN;
  }
}

static fg_status write_output(fg_context *ctx, void *user, size_t kind, FILE *out) {
  return writers[kind](ctx, user, out);
}

static fg_status check_outputs(fg_context *ctx, arguments *a) {
  const fg_input files[] = {{a->design_path, "the design"}, {a->forming_model, "the forming"}};
  fg_loop_outputs_choose(&a->outputs);
  FG_TRY(fg_output_set_check(ctx, &a->outputs, files, sizeof files / sizeof *files));
  for (size_t i = 0; i < a->count; i++)
    FG_TRY(fg_output_set_check(ctx, &a->outputs, &(fg_input){a->paths[i], "the scan"}, 1));
  return FG_OK;
}

/* The model's age is its scans', not its file's: a loop that is run again writes the same bytes.
 * SOURCE_DATE_EPOCH, where it is set, overrules it. */
static int64_t find_date(const arguments *a) {
  const char *epoch = getenv("SOURCE_DATE_EPOCH");
  char *end;
  int64_t newest = epoch ? strtoll(epoch, &end, 10) : 0;
  if (epoch && *epoch && !*end && newest >= 0) return newest;
  newest = 0;
  for (size_t i = 0; i < a->count; i++) {
    struct stat about;
    if (stat(a->paths[i], &about) == 0 && S_ISREG(about.st_mode) && about.st_mtime > newest)
      newest = about.st_mtime;
  }
  return newest;
}

/* A scanner without faults has a model too: it states the search, and its scans. */
static void note_empty_model(const arguments *a, const fg_scan_result *result) {
  const char *path = a->outputs.path[FG_LOOP_MODEL];
  if (path && fg_scanner_model_is_empty(result->model))
    fprintf(stderr,
            "foilgauge: note: %s: nothing was found of the scanner: the model says so, and with it "
            "`measure --model` leaves every value as it is\n",
            path);
}

static void note_pictures(const fg_scan_result *result) {
  for (size_t i = 0; i < result->scans; i++)
    fg_cli_note_picture(result->scan[i].before->scan, result->scan[i].before->picture.findings);
}

static fg_status check_design(fg_context *ctx, const arguments *a, const fg_design *design) {
  const fg_foil_traits *kind = fg_foil_traits_of(design->kind);
  if (a->grid.same_part)
    return fg_fail(ctx, FG_ERR_USAGE, "--same-part is for grids; of foils it is --same-foil");
  if (!kind->is_foil && a->options.same_foil)
    return fg_fail(ctx, FG_ERR_USAGE,
                   "--same-foil is for foils: a disc does not show how far it was turned");
  if (!kind->is_foil && a->forming_model)
    return fg_fail(ctx, FG_ERR_USAGE, "--form-model is of the bumps of foils: discs have none");
  if (kind->why_no_loop)
    return fg_fail(ctx, FG_ERR_USAGE, "%s: %s", a->design_path, kind->why_no_loop);
  return FG_OK;
}

static fg_status read_forming(fg_context *ctx, const char *path,
                              fg_forming_prediction **prediction) {
  if (!path) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof **prediction, (void **)prediction));
  return fg_forming_prediction_load(ctx, path, *prediction);
}

_Static_assert((int)SCANS_MAX == (int)FG_GRID_SCANS, "every scan may be held out");

typedef fg_status grid_writer(fg_context *ctx, const fg_grid_loop *loop, FILE *out);

static fg_status write_grid_output(fg_context *ctx, void *user, size_t kind, FILE *out) {
  static grid_writer *const each[FG_LOOP_OUTPUTS] = {
      [FG_LOOP_HTML] = fg_grid_loop_write_html,
      [FG_LOOP_MODEL] = fg_grid_loop_write_model,
      [FG_LOOP_JSON] = fg_grid_loop_write_json,
      [FG_LOOP_TEXT] = fg_grid_loop_write_text,
  };
  return each[kind](ctx, user, out);
}

static fg_status run_grids(fg_context *ctx, arguments *a, const fg_design *design) {
  fg_grid_loop *loop = NULL;
  if (a->forming_model)
    return fg_fail(ctx, FG_ERR_USAGE, "--form-model is of the bumps of foils: grids have none");
  a->grid.dpi = a->options.dpi;
  a->grid.allow_lossy = a->options.allow_lossy;
  a->grid.threads = a->options.threads;
  a->grid.same_part |= a->options.same_foil;
  a->grid.scanner = a->options.scanner;
  a->grid.date = find_date(a);
  memcpy(a->grid.hold_out, a->hold_out, sizeof a->hold_out);
  FG_TRY(fg_output_set_open(ctx, &a->outputs));
  fg_status status = fg_grid_loop_run(ctx, a->paths, a->count, design, &a->grid, &loop);
  if (status == FG_OK) status = fg_output_set_write(ctx, &a->outputs, write_grid_output, loop);
  fg_grid_loop_free(loop);
  return status;
}

static fg_status run(fg_context *ctx, arguments *a, int *code) {
  fg_design design;
  fg_scan_loop *loop = NULL;
  fg_forming_prediction *prediction = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(check_outputs(ctx, a));
  fg_design_default(&design);
  if (a->design_path) FG_TRY_EXIT(fg_design_load(ctx, a->design_path, &design));
  FG_TRY_EXIT(fg_cli_apply_foil_kind(ctx, a->kind, &design));
  fg_cli_apply_known(&a->known, &design);
  FG_TRY_EXIT(fg_cli_apply_flatbed(ctx, a->known.flatbed, &design));
  FG_TRY_EXIT(fg_design_check(ctx, &design));
  if (fg_foil_traits_of(design.kind)->is_grid) return run_grids(ctx, a, &design);
  FG_TRY_EXIT(check_design(ctx, a, &design));
  FG_TRY_EXIT(read_forming(ctx, a->forming_model, &prediction));
  FG_TRY_EXIT(fg_output_set_open(ctx, &a->outputs));
  a->options.date = find_date(a);
  a->options.forming = prediction;
  const fg_scan_loop_scans scans = {a->paths, a->hold_out, a->count};
  FG_TRY_EXIT(fg_scan_loop_run(ctx, &scans, &design, &a->options, &loop));
  *code = fg_scan_loop_result(loop)->left_out ? 2 : 0;
  note_pictures(fg_scan_loop_result(loop));
  FG_TRY_EXIT(fg_output_set_write(ctx, &a->outputs, write_output, loop));
  note_empty_model(a, fg_scan_loop_result(loop));
exit:
  fg_scan_loop_free(loop);
  free(prediction);
  return status;
}

const struct argp fg_loop_parser = {options, parse_option, "SCAN...", doc, NULL, fg_cli_fill, NULL};

int fg_cmd_loop_scan(int argc, char **argv) {
  fg_context ctx = {0};
  arguments a = {.options = {.seed = FG_CLI_SEED}, .outputs.count = FG_LOOP_OUTPUTS};
  for (size_t i = 0; i < FG_GRID_SCANS; i++)
    a.grid.turns[i] = -1;
  /* in order: reports list the scans as they are given, held-out scans among the others */
  fg_status status = fg_cli_parse_in_order(&ctx, &fg_loop_parser, argc, argv, &a);
  if (status != FG_OK) return fg_cli_fail(&ctx, status);
  int code = 0;
  status = run(&ctx, &a, &code);
  fg_output_set_close(&a.outputs);
  return status == FG_OK ? code : fg_cli_fail(&ctx, status);
}
