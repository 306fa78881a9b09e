/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <argp.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/commands.h"
#include "cli/facts.h"
#include "cli/known.h"
#include "cli/values.h"
#include "foilgauge/compensation.h"
#include "foilgauge/file.h"
#include "foilgauge/lot.h"
#include "foilgauge/text.h"

enum {
  OPTION_RECIPE = 256,
  OPTION_PRINT_RECIPE,
  OPTION_RESUME,
  OPTION_DRY_RUN,
  OPTION_SHARD,
  OPTION_PAGES,
  OPTION_DPI,
  OPTION_ALLOW_LOSSY,
  OPTION_MODEL,
  OPTION_SCANNER,
  OPTION_NAME,
  OPTION_GROUP,
  OPTION_DIE,
  OPTION_CURVE,
  OPTION_INDEX,
  OPTION_CSV,
  OPTION_EXPECTED,
};

typedef struct lot_arguments {
  const char *recipe, *design, *model, *scanner, *folder, *name, *group, *index, *csv;
  double dpi;
  int jobs; /* -1: not given */
  bool allow_lossy, print_recipe, resume, dry_run, decimal_comma;
  fg_lot_shard shard;
  fg_lot_pages pages;
  bool flatbed;
  const char *curve;    /* reference curve; NULL: the recipe's */
  const char *expected; /* prediction of `die --target`; NULL: none */
  const char *dies[FG_LOT_DIES_MAX];
  size_t die_count;
  char **paths; /* of argv */
  size_t path_count;
} lot_arguments;

static const struct argp_option options[] = {
    {"output", 'o', "DIR", 0, "The lot's folder", 0},
    {"recipe", OPTION_RECIPE, "FILE", 0, "Settings; the options below overrule them", 0},
    {"design", 'd', "FILE", 0, "What the part should be, with tolerances", 0},
    {"model", OPTION_MODEL, "FILE.json", 0,
     "Correct every scan by what `foilgauge loop --model-out` found of this scanner", 0},
    {"scanner", OPTION_SCANNER, "NAME", 0, "Refuse a model that is of another scanner", 0},
    FG_CLI_FLATBED_ROW(0),
    {"name", OPTION_NAME, "TEXT", 0, "Of the lot (default: its folder's name)", 0},
    {"dpi", OPTION_DPI, "N", 0, "Resolution of the scans; overrules the files", 0},
    {"allow-lossy", OPTION_ALLOW_LOSSY, NULL, 0, FG_CLI_ALLOW_LOSSY, 0},
    {"group", OPTION_GROUP, "COLUMN", 0, "Compare the groups of this column of the manifest", 0},
    {"reference-curve", OPTION_CURVE, "FILE.csv", 0,
     "Draw this over the errors per bump: what a simulation or a die says; columns bump, "
     "radius_error_pct, intersection_angle_error_pct",
     0},
    {"expected", OPTION_EXPECTED, "FILE.json", 0,
     "Hold the lot against this report of `foilgauge die --target`, whose die it comes from: "
     "expected.json and expected.html in its folder",
     0},
    {"die", OPTION_DIE, "NAME=FILE.json", 0,
     "What `foilgauge die -o` measured of the die that the manifest's column `die` calls NAME: the "
     "reference of springback beside the design; once for each die",
     0},
    {"jobs", 'j', "N", 0, "Scans at a time (default: one per core)", 1},
    {"resume", OPTION_RESUME, NULL, 0, "Measure only what is missing or has changed", 1},
    {"dry-run", OPTION_DRY_RUN, NULL, 0, "Say what would be measured; touch nothing", 1},
    {"pages", OPTION_PAGES, "PAGES", 0,
     "Which scans get a page of their own, with picture and report: @pages@ (default: all)", 1},
    {"shard", OPTION_SHARD, "I/N", 0, "Only part I of N; `foilgauge merge` joins them", 1},
    {"print-recipe", OPTION_PRINT_RECIPE, NULL, 0, "Print every setting in force", 2},
    {"index", OPTION_INDEX, "FILE.html", 0,
     "Lots over time and against each other, on a page: the arguments are their folders; -o "
     "FILE.json writes the numbers",
     2},
    {"csv", OPTION_CSV, "FILE.csv", 0, "With --index: a line per lot and quantity", 2},
    FG_CLI_DECIMAL_COMMA_ROW(0),
    {0},
};

static const char doc[] =
    "Measure a production lot and report it: which foils pass, how the process runs, what the "
    "deviations do to the bearing."
    "\vPATH is a folder of scans, a scan, a list (.txt, a path a line) or a manifest (.csv with a "
    "column `scan` and any others: foil, pad, bearing, die, coil, date ...). Tolerances of a "
    "bearing "
    "(circularity_mm, clearance_min_mm, clearance_centred_min_mm) judge the bearings that the "
    "columns `bearing` and `pad` say, or without them foils in a row; a foil whose cell is empty "
    "is in none. The recipe's \"assembly\": {\"bearings\": 1000, \"seed\": 1} says how many "
    "bearings are drawn from the foils, to see how many would assemble; 0 draws none.\n\n"
    "@exit_judged@ A shard is not judged: 0 or 2.";

static fg_lot_pages parse_pages(struct argp_state *state, const char *text) {
  for (int pages = FG_LOT_PAGES_ALL; pages <= FG_LOT_PAGES_NONE; pages++)
    if (!strcmp(text, fg_lot_pages_word((fg_lot_pages)pages))) return (fg_lot_pages)pages;
  argp_error(state, "--pages: '%s' is none of all, bad, none", text);
  return FG_LOT_PAGES_ALL;
}

static const fg_cli_value values[] = {
    FG_CLI_VALUE('o', lot_arguments, folder),
    FG_CLI_VALUE('d', lot_arguments, design),
    FG_CLI_NUMBER('j', lot_arguments, jobs, 1, 1024),
    FG_CLI_VALUE(OPTION_RECIPE, lot_arguments, recipe),
    FG_CLI_VALUE(OPTION_MODEL, lot_arguments, model),
    FG_CLI_VALUE(OPTION_SCANNER, lot_arguments, scanner),
    FG_CLI_VALUE(FG_CLI_FLATBED, lot_arguments, flatbed),
    FG_CLI_VALUE(OPTION_NAME, lot_arguments, name),
    FG_CLI_VALUE(OPTION_GROUP, lot_arguments, group),
    FG_CLI_VALUE(OPTION_CURVE, lot_arguments, curve),
    FG_CLI_VALUE(OPTION_EXPECTED, lot_arguments, expected),
    FG_CLI_NUMBER(OPTION_DPI, lot_arguments, dpi, 1, 1e6),
    FG_CLI_VALUE(OPTION_ALLOW_LOSSY, lot_arguments, allow_lossy),
    FG_CLI_VALUE(OPTION_RESUME, lot_arguments, resume),
    FG_CLI_VALUE(OPTION_DRY_RUN, lot_arguments, dry_run),
    FG_CLI_VALUE(OPTION_PRINT_RECIPE, lot_arguments, print_recipe),
    FG_CLI_VALUE(OPTION_INDEX, lot_arguments, index),
    FG_CLI_VALUE(OPTION_CSV, lot_arguments, csv),
    FG_CLI_VALUE(FG_CLI_DECIMAL_COMMA, lot_arguments, decimal_comma),
    {0},
};

static error_t parse_lot_option(int key, char *text, struct argp_state *state) {
  lot_arguments *arguments = state->input;
  if (fg_cli_keep_value(values, key, text, state)) return 0;
  switch (key) {
  case OPTION_DIE:
    if (!strchr(text, '=')) argp_error(state, "--die: '%s' is not NAME=FILE.json", text);
    if (arguments->die_count == FG_LOT_DIES_MAX)
      argp_error(state, "--die: at most %d dies", FG_LOT_DIES_MAX);
    arguments->dies[arguments->die_count++] = text;
    break;
  case OPTION_SHARD:
    arguments->shard = fg_cli_shard(state, text);
    break;
  case OPTION_PAGES:
    arguments->pages = parse_pages(state, text);
    break;
  case ARGP_KEY_ARGS:
    arguments->paths = state->argv + state->next;
    arguments->path_count = (size_t)(state->argc - state->next);
    break;
  case ARGP_KEY_END:
    if (!arguments->print_recipe && !arguments->path_count) argp_error(state, "no PATH was given");
    if (!arguments->print_recipe && !arguments->folder && !arguments->index)
      argp_error(state, "give the lot's folder with -o DIR");
    if (arguments->expected && (arguments->shard.count > 1 || arguments->index))
      argp_error(state, "--expected is of a whole lot; give it to `foilgauge lot --resume`");
    if (arguments->csv && !arguments->index)
      argp_error(state, "--csv belongs to --index; a lot's tables are in its folder");
    break;
  default:
    return ARGP_ERR_UNKNOWN;
  }
  return 0;
}

static fg_status set_text(fg_context *ctx, const char *option, const char *text, char *target,
                          size_t size) {
  if (!text) return FG_OK;
  if (strlen(text) >= size)
    return fg_fail(ctx, FG_ERR_USAGE, "--%s: at most %zu bytes", option, size - 1);
  strcpy(target, text);
  return FG_OK;
}

static fg_status read_die_options(fg_context *ctx, const lot_arguments *arguments,
                                  fg_lot_settings *settings) {
  if (arguments->die_count) settings->die_count = 0; /* they overrule the recipe's */
  for (size_t i = 0; i < arguments->die_count; i++) {
    char name[sizeof settings->dies[0].name];
    const char *equals = strchr(arguments->dies[i], '=');
    size_t length = (size_t)(equals - arguments->dies[i]);
    if (length >= sizeof name)
      return fg_fail(ctx, FG_ERR_USAGE, "--die: the name has more than %zu bytes", sizeof name - 1);
    memcpy(name, arguments->dies[i], length);
    name[length] = '\0';
    FG_TRY(fg_lot_settings_add_die(ctx, name, equals + 1, settings));
  }
  return FG_OK;
}

static fg_status load_settings(fg_context *ctx, const lot_arguments *arguments,
                               fg_lot_settings *settings) {
  fg_lot_settings_default(settings);
  if (arguments->recipe) FG_TRY(fg_lot_settings_load(ctx, arguments->recipe, settings));
  if (arguments->design) FG_TRY(fg_lot_settings_load_design(ctx, arguments->design, settings));
  const char *model = arguments->model ? arguments->model : settings->model;
  if (arguments->scanner && !model[0])
    return fg_fail(ctx, FG_ERR_USAGE, "--scanner says which scanner --model must be of: give one");
  if (arguments->model || arguments->scanner)
    FG_TRY(fg_lot_settings_load_model(ctx, model, arguments->scanner, settings));
  FG_TRY(fg_cli_apply_flatbed(ctx, arguments->flatbed, &settings->design));
  FG_TRY(read_die_options(ctx, arguments, settings));
  if (arguments->curve) FG_TRY(fg_lot_settings_load_curve(ctx, arguments->curve, settings));
  if (arguments->jobs > 0) settings->jobs = (unsigned)arguments->jobs;
  if (arguments->dpi > 0) settings->dpi = arguments->dpi;
  settings->allow_lossy |= arguments->allow_lossy;
  FG_TRY(set_text(ctx, "name", arguments->name, settings->name, sizeof settings->name));
  FG_TRY(set_text(ctx, "group", arguments->group, settings->group_column,
                  sizeof settings->group_column));
  fg_cli_note_scale(&settings->design);
  return fg_lot_settings_check(ctx, settings);
}

static void format_duration(double seconds, char *text, size_t size) {
  if (seconds < 90)
    snprintf(text, size, "%.0f s", ceil(seconds));
  else if (seconds < 5400)
    snprintf(text, size, "%.0f min", seconds / 60);
  else
    snprintf(text, size, "%.1f h", seconds / 3600);
}

/* The line is drawn over itself on a terminal; a scan that fails gets a line of its own anywhere.
 */
static void show_progress(void *user, const fg_lot_progress *progress) {
  const bool *terminal = user;
  char left[32] = "?";
  if (progress->error && *terminal) dprintf(STDERR_FILENO, "\r\033[K");
  if (progress->error) fprintf(stderr, "foilgauge: %s\n", progress->error);
  if (!*terminal) return;
  if (isfinite(progress->seconds_left)) format_duration(progress->seconds_left, left, sizeof left);
  dprintf(STDERR_FILENO, "\r\033[K%zu of %zu scans (%.0f %%), %.1f a second, %s left%s",
          progress->done, progress->total, 100 * (double)progress->done / (double)progress->total,
          (double)progress->done / fmax(progress->seconds, 1e-3), left,
          progress->done == progress->total ? "\n" : "");
}

static void print_bearings(const fg_lot_outcome *outcome) {
  const size_t bearings = outcome->bearings.count, *by = outcome->bearings.by_verdict;
  fprintf(stderr, "%zu bearing%s: %zu pass, %zu fail, %zu cannot be told, %zu not measured%s\n",
          bearings, fg_plural(bearings), by[FG_VERDICT_PASS], by[FG_VERDICT_FAIL],
          by[FG_VERDICT_UNDECIDED], by[FG_VERDICT_NOT_MEASURED],
          bearings ? ""
                   : ": the design's tolerances of a bearing judge nothing, the foils make none");
}

/* Notes how many of a kind there are, and the first. */
static void note_finding(const fg_lot_finding *finding, const char *before, const char *thing,
                         const char *after) {
  if (finding->count)
    fprintf(stderr, "foilgauge: note: %s%zu %s%s%s%s\n", before, finding->count, thing,
            fg_plural(finding->count), after, finding->first);
}

/* Notes on the manifest and the scans that every report of a lot has. */
static void print_report_notes(const fg_lot_notes *notes) {
  const fg_lot_finding *dates = &notes->invalid_dates;
  if (dates->count)
    fprintf(stderr,
            "foilgauge: note: the manifest's column date: %zu cell%s without a date, the first is "
            "'%s' (2024-05-31 or 31.05.2024 would be one): the lot is dated by the times of its "
            "scans' files\n",
            dates->count, fg_plural(dates->count), dates->first);
  note_finding(&notes->repeated, "the same scan under another name, counted once: ", "scan",
               "; the first: ");
}

int fg_cli_lot_summary(const fg_lot_outcome *outcome, const char *folder) {
  const size_t *by = outcome->foils.by_verdict, foils = outcome->foils.count;
  const size_t scans = outcome->scans.count, failed = outcome->scans.failed;
  print_report_notes(&outcome->notes);
  fprintf(stderr, "%zu foil%s of %zu scan%s: %zu pass, %zu fail, %zu cannot be told", foils,
          fg_plural(foils), scans, fg_plural(scans), by[FG_VERDICT_PASS], by[FG_VERDICT_FAIL],
          by[FG_VERDICT_UNDECIDED]);
  if (by[FG_VERDICT_NONE]) fprintf(stderr, ", %zu without tolerances", by[FG_VERDICT_NONE]);
  if (by[FG_VERDICT_NOT_MEASURED] || failed)
    fprintf(stderr, "; not measured: %zu foil%s, %zu scan%s", by[FG_VERDICT_NOT_MEASURED],
            fg_plural(by[FG_VERDICT_NOT_MEASURED]), failed, fg_plural(failed));
  if (by[FG_VERDICT_PASS] || by[FG_VERDICT_FAIL])
    fprintf(stderr, "\nTraced to: %s", outcome->traced);
  fputc('\n', stderr);
  if (outcome->bearings_judged) print_bearings(outcome);
  for (size_t i = 0; i < sizeof outcome->assembly / sizeof *outcome->assembly; i++)
    if (outcome->assembly[i][0]) fprintf(stderr, "%s\n", outcome->assembly[i]);
  fprintf(stderr, "%s/index.html\n", folder);
  return fg_outcome_exit_code(&outcome->judged);
}

static void print_plan(const fg_lot_scans *scans) {
  const fg_lot_finding *missing = &scans->missing;
  printf("%zu scan%s, %zu to measure, %zu kept", scans->count, fg_plural(scans->count),
         scans->to_measure, scans->kept);
  if (scans->redrawn) printf(", %zu of them for their pages", scans->redrawn);
  if (missing->count)
    printf(", %zu missing: %s%s", missing->count, missing->count > 1 ? "the first is " : "",
           missing->first);
  putchar('\n');
}

static int print_shard(const lot_arguments *arguments, const fg_lot_scans *scans) {
  fprintf(stderr, "shard %zu/%zu: %zu scan%s measured, %zu kept, %zu could not be measured\n",
          arguments->shard.index, arguments->shard.count, scans->measured,
          fg_plural(scans->measured), scans->kept, scans->failed);
  return scans->failed ? 2 : 0;
}

static fg_status print_recipe(fg_context *ctx, const fg_lot_settings *settings) {
  char *text;
  fg_output output;
  FG_TRY(fg_lot_settings_format(ctx, settings, true, &text));
  fg_status status = fg_output_open(ctx, "-", &output);
  if (status == FG_OK) {
    fputs(text, output.stream);
    status = fg_output_commit(ctx, &output);
  }
  free(text);
  return status;
}

static void print_lines(const char *words, const char *text) {
  for (; text && *text; text += strcspn(text, "\n"), text += *text == '\n')
    fprintf(stderr, "%s%.*s\n", words, (int)strcspn(text, "\n"), text);
}

/* Exit code 2: a lot could not be read. */
static fg_status make_index(fg_context *ctx, const lot_arguments *arguments, int *code) {
  fg_lot_index_outcome outcome;
  const fg_lot_index_request request = {.folders = (const char *const *)arguments->paths,
                                        .count = arguments->path_count,
                                        .page = arguments->index,
                                        .json = arguments->folder,
                                        .csv = arguments->csv,
                                        .decimal_comma = arguments->decimal_comma};
  FG_TRY(fg_lot_index(ctx, &request, &outcome));
  print_lines("foilgauge: note: ", outcome.notes);
  print_lines("", outcome.summary);
  fprintf(stderr, "%zu lot%s", outcome.lots, fg_plural(outcome.lots));
  if (outcome.not_read) fprintf(stderr, ", %zu could not be read", outcome.not_read);
  fprintf(stderr, "\n%s\n", arguments->index);
  *code = outcome.not_read ? 2 : 0;
  fg_lot_index_outcome_free(&outcome);
  return FG_OK;
}

/* Holds the reported lot against its prediction. */
static fg_status hold_expected(fg_context *ctx, const lot_arguments *arguments) {
  fg_expected_check check;
  char sentence[1000];
  FG_TRY(fg_expected_check_run(ctx, arguments->expected, arguments->folder, &check));
  fg_expected_check_sentence(&check, sentence, sizeof sentence);
  fg_status status = fg_expected_check_write(ctx, &check);
  if (status == FG_OK)
    fprintf(stderr, "%s\n%s%s%s/expected.html\n", sentence, check.loop_sentence,
            check.loop_sentence[0] ? "\n" : "", arguments->folder);
  fg_expected_check_free(&check);
  return status;
}

/* Notes on the inputs and on the earlier results of a run. */
static void print_run_notes(const fg_lot_notes *notes) {
  note_finding(&notes->named_again, "there twice and counted once: ", "scan", "; the first is ");
  note_finding(&notes->empty_folders, "passed over: ", "folder",
               " with the name of a scan, and no scan in it; the first is ");
  if (notes->damaged_lines)
    fprintf(
        stderr,
        "foilgauge: note: results.jsonl: %zu line%s damaged or not whole, the first is line %zu: "
        "what they said is measured again\n",
        notes->damaged_lines, fg_plural(notes->damaged_lines), notes->first_damaged_line);
  if (notes->earlier_version)
    fprintf(stderr, "foilgauge: note: results.jsonl is of an earlier version, whose records hold "
                    "other values or no checksum: all scans are measured again\n");
  if (notes->beyond_model)
    fprintf(
        stderr,
        "foilgauge: note: beyond the region that the scanner's model was found in: %zu scan%s\n",
        notes->beyond_model, fg_plural(notes->beyond_model));
  note_finding(&notes->undrawn_pages, "", "page", " could not be drawn; the first: ");
}

static fg_status run_lot(fg_context *ctx, const lot_arguments *arguments, int *code) {
  fg_lot_settings settings;
  fg_lot_outcome outcome;
  bool terminal = isatty(STDERR_FILENO);
  const char *const *paths = (const char *const *)arguments->paths;
  if (arguments->index) return make_index(ctx, arguments, code);
  FG_TRY(load_settings(ctx, arguments, &settings));
  if (arguments->expected) FG_TRY(fg_expected_check_file(ctx, arguments->expected));
  if (arguments->print_recipe) return print_recipe(ctx, &settings);
  const fg_lot_request request = {.settings = &settings,
                                  .paths = paths,
                                  .path_count = arguments->path_count,
                                  .folder = arguments->folder,
                                  .recipe = arguments->recipe,
                                  .design = arguments->design,
                                  .resume = arguments->resume,
                                  .dry_run = arguments->dry_run,
                                  .decimal_comma = arguments->decimal_comma,
                                  .shard = arguments->shard,
                                  .pages = arguments->pages,
                                  .listener = show_progress,
                                  .user = &terminal};
  FG_TRY(fg_lot_run(ctx, &request, &outcome));
  print_run_notes(&outcome.notes);
  if (arguments->expected && !arguments->dry_run) FG_TRY(hold_expected(ctx, arguments));
  if (arguments->dry_run)
    print_plan(&outcome.scans);
  else
    *code = arguments->shard.count > 1 ? print_shard(arguments, &outcome.scans)
                                       : fg_cli_lot_summary(&outcome, arguments->folder);
  return FG_OK;
}

const struct argp fg_lot_parser = {options, parse_lot_option, "PATH...", doc,
                                   NULL,    fg_cli_fill,      NULL};

int fg_cmd_lot(int argc, char **argv) {
  fg_context ctx = {0};
  lot_arguments arguments = {.jobs = -1, .shard = {1, 1}};
  int code = 0;
  fg_status status = fg_cli_parse(&ctx, &fg_lot_parser, argc, argv, &arguments);
  if (status != FG_OK) return fg_cli_fail(&ctx, status);
  status = run_lot(&ctx, &arguments, &code);
  return status == FG_OK ? code : fg_cli_fail(&ctx, status);
}
