/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <argp.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/commands.h"
#include "cli/die_list.h"
#include "cli/facts.h"
#include "cli/output_set.h"
#include "cli/values.h"
#include "foilgauge/die.h"
#include "foilgauge/die_report.h"
#include "foilgauge/text.h"
#include "foilgauge/words.h"

enum { OUT_JSON, OUT_HTML, OUT_TABLE, OUT_COUNT };

typedef struct die_run {
  const char *design_path, *list_path;
  fg_die_source said; /* as the options before a profile state it */
  int unused;         /* the last of those options, while no profile has followed it; else 0 */
  fg_die_sources sources;
  fg_die_options options;
  fg_output_set outputs;
  fg_status status; /* of what failed while the command line was read */
  fg_context *ctx;
  fg_die die;
} die_run;

enum {
  OPTION_HALF = 256,
  OPTION_UNIT,
  OPTION_COLUMNS,
  OPTION_TIP,
  OPTION_FIRST_BUMP,
  OPTION_REVERSED,
  OPTION_FORWARD,
  OPTION_LIST,
  OPTION_U_TIP,
  OPTION_U_SCALE,
  OPTION_MAX_SLOPE,
  OPTION_HTML,
  OPTION_TABLE,
};

static const struct argp_option options[] = {
    {NULL, 0, NULL, 0, "Of the profiles that follow:", 1},
    {"half", OPTION_HALF, "HALF", 0, "concave: its bumps are grooves; convex: ridges", 1},
    {"unit", OPTION_UNIT, "UNIT", 0, "mm, um or nm; of x and z each: mm,um", 1},
    {"columns", OPTION_COLUMNS, "X,Z", 0, "Which columns are x and z, from 1", 1},
    {"tip-um", OPTION_TIP, "R", 0,
     "Radius of the tip; 0 where the instrument has taken it off already", 1},
    {"first-bump", OPTION_FIRST_BUMP, "N", 0,
     "Lowest number of the bumps whose crown is seen (default: 1)", 1},
    {"reversed", OPTION_REVERSED, NULL, 0, "The bumps' numbers run against x", 1},
    {"forward", OPTION_FORWARD, NULL, 0, "The bumps' numbers run with x (the default)", 1},
    {NULL, 0, NULL, 0, "Of all:", 2},
    {"design", 'd', "FILE", 0, "What the foil should be (default: the Gen II foil)", 2},
    {"list", OPTION_LIST, "FILE.csv", 0,
     "Profiles from a table: columns profile (relative to it), and half, unit, columns, tip_um, "
     "first_bump, reversed (yes, no) as far as they are needed",
     2},
    {"u-tip-um", OPTION_U_TIP, "U", 0, "Standard uncertainty of the tip's radius (default: 0)", 2},
    {"u-scale-ppm", OPTION_U_SCALE, "U", 0,
     "Standard uncertainty of the instrument's scale (default: 0)", 2},
    {"max-slope", OPTION_MAX_SLOPE, "DEG", 0,
     "Steeper flanks take no part, where the tip's cone or the arm touches (default: "
     "@max_slope_deg@)",
     2},
    {"output", 'o', "FILE.json", 0, "Write the JSON report here (-: standard output)", 3},
    {"html", OPTION_HTML, "FILE.html", 0, "One page to read and print", 3},
    {"table", OPTION_TABLE, "FILE.txt", 0, "The table, as on a terminal", 3},
    {0},
};

static const char doc[] =
    "Measure a die by stylus traces of its halves, against the design of the foil that it presses."
    "\v"
    "PROFILE is the text that a profilometer exports: two columns x and z (z upwards, out of the "
    "die), after any header; tabs, semicolons, blanks or commas between them; decimal point or "
    "comma. Any number of repeats of each half, each trace across three bumps or more.\n\n"
    "What the header says counts: unit (`X [mm]; Z [um]`, `Unit: mm`), tip (`Tip radius: 2 um`), "
    "half (`concave`, `convex`); the half may stand in the file's name. What is not said must be "
    "said by an option, and what contradicts is refused: a unit is never guessed.\n\n"
    "A half is named by its bumps: the concave half has grooves on a dome and touches the strip's "
    "shaft side, the convex half has ridges in a bowl and touches its sleeve side. The tip's "
    "radius is taken off, and half of the design's thickness brings each half to the strip's "
    "midline (or the design's datum). The die is the mean of its halves: a strip is pressed "
    "between both.\n\n"
    "Tolerances of the design that name radius_mm, radius_error_pct, bump_angle_deg, "
    "bump_angle_error_pct, centre_to_centre_mm, height_mm, intersection_angle_deg, place_error_deg "
    "or overall.radius_mm judge every bump of each half.\n\n"
    "  foilgauge die --tip-um 2 --unit mm concave_*.txt convex_*.txt \\\n"
    "    --html die.html\n"
    "  foilgauge die --tip-um 2 --unit um --half concave a1.txt a2.txt \\\n"
    "    --half convex b1.txt\n\n"
    "On a terminal the results are printed as a table; elsewhere, where no file is asked for, as "
    "JSON.\n\n"
    "@exit_judged@";

static void keep_status(die_run *run, fg_status status) {
  if (run->status == FG_OK) run->status = status;
}

/* Options behind the last profile would apply to none. */
static void check_end(const die_run *run, const struct argp_state *state) {
  if (!run->sources.count && !run->list_path) argp_error(state, "no PROFILE was given");
  if (!run->unused || run->list_path) return;
  const struct argp_option *option = options;
  while (option->key != run->unused)
    option++;
  argp_error(state,
             "--%s counts for the profiles that follow it, and none does: put it before them",
             option->name);
}

static const fg_cli_value values[] = {
    FG_CLI_NUMBER(OPTION_TIP, die_run, said.tip_um, 0, 1e5),
    FG_CLI_NUMBER(OPTION_FIRST_BUMP, die_run, said.first_bump, 1, 1000),
    FG_CLI_VALUE(OPTION_LIST, die_run, list_path),
    FG_CLI_NUMBER(OPTION_U_TIP, die_run, options.u_tip_um, 0, 1e4),
    FG_CLI_NUMBER(OPTION_U_SCALE, die_run, options.u_scale_ppm, 0, 1e5),
    FG_CLI_NUMBER(OPTION_MAX_SLOPE, die_run, options.max_slope_deg, 20, 89),
    FG_CLI_VALUE('d', die_run, design_path),
    FG_CLI_VALUE('o', die_run, outputs.path[OUT_JSON]),
    FG_CLI_VALUE(OPTION_HTML, die_run, outputs.path[OUT_HTML]),
    FG_CLI_VALUE(OPTION_TABLE, die_run, outputs.path[OUT_TABLE]),
    {0},
};

static error_t parse_die_option(int key, char *text, struct argp_state *state) {
  die_run *run = state->input;
  if (key >= OPTION_HALF && key <= OPTION_FORWARD) run->unused = key;
  if (fg_cli_keep_value(values, key, text, state)) return 0;
  switch (key) {
  case OPTION_HALF:
    if (!fg_die_read_half(text, &run->said.half))
      argp_error(state, "--half: '%s' is neither concave nor convex", text);
    break;
  case OPTION_UNIT:
    if (!fg_die_read_units(text, run->said.unit))
      argp_error(state, "--unit: '%s' is not mm, um or nm, nor two of them (mm,um)", text);
    break;
  case OPTION_COLUMNS:
    if (!fg_die_read_columns(text, run->said.column))
      argp_error(state, "--columns: '%s' is not two different numbers from 1: 1,3", text);
    break;
  case OPTION_REVERSED:
  case OPTION_FORWARD:
    run->said.reversed = key == OPTION_REVERSED;
    break;
  case ARGP_KEY_ARG:
    run->said.path = text;
    run->unused = 0;
    keep_status(run, fg_die_sources_add(run->ctx, &run->sources, &run->said));
    break;
  case ARGP_KEY_END:
    check_end(run, state);
    break;
  default:
    return ARGP_ERR_UNKNOWN;
  }
  return 0;
}

static fg_status write_die_output(fg_context *ctx, void *user, size_t kind, FILE *out) {
  const die_run *run = user;
  if (kind == OUT_JSON) return fg_die_write_json(ctx, &run->die, out);
  return kind == OUT_HTML ? fg_die_write_html(ctx, &run->die, out)
                          : fg_die_write_table(ctx, &run->die, out);
}

static fg_status load_die_design(fg_context *ctx, die_run *run, fg_design *design) {
  const fg_input others[] = {{run->design_path, "the design"}, {run->list_path, "the list"}};
  FG_TRY(run->status);
  fg_output_set_choose_standard(&run->outputs, OUT_JSON, OUT_TABLE, false);
  FG_TRY(fg_output_set_check(ctx, &run->outputs, others, sizeof others / sizeof *others));
  if (run->list_path) FG_TRY(fg_die_list_load(ctx, run->list_path, &run->said, &run->sources));
  for (size_t i = 0; i < run->sources.count; i++)
    FG_TRY(fg_output_set_check(ctx, &run->outputs,
                               &(fg_input){run->sources.source[i].path, "the profile"}, 1));
  fg_design_default(design);
  if (run->design_path) FG_TRY(fg_design_load(ctx, run->design_path, design));
  if (!fg_foil_kind_has_bumps(design->kind))
    return fg_fail(ctx, FG_ERR_DATA, "%s: form \"%s\" has no bumps; a die is measured by its bumps",
                   run->design_path, fg_foil_kind_word(design->kind));
  return FG_OK;
}

/* A bump that one trace lost and another measured. */
static void note_lost_by_trace(const fg_die *die) {
  for (size_t i = 0; i < die->trace_count; i++) {
    const fg_die_trace *trace = &die->traces[i];
    const fg_die_side *side = &die->half[trace->half];
    for (size_t b = 0; b < side->bump_count; b++)
      if (fg_die_is_lost(trace, side->bumps[b].number))
        fprintf(stderr,
                "foilgauge: note: %s: bump %d is lost to dust or a lost contact; its values are of "
                "the other traces\n",
                trace->path, side->bumps[b].number);
  }
}

static void note_unseen(const fg_die *die) {
  char numbers[200];
  for (int h = 0; h < FG_DIE_HALVES; h++) {
    fg_die_half half = (fg_die_half)h;
    size_t count = fg_die_unseen(die, half, FG_DIE_LOST, numbers, sizeof numbers);
    if (count)
      fprintf(stderr,
              "foilgauge: note: %s half: lost to dust or a lost contact: bump%s %s: traced, but no "
              "circle in any trace; clean the die and trace it again\n",
              fg_die_half_word(half), fg_plural(count), numbers);
    count = fg_die_unseen(die, half, FG_DIE_UNTRACED, numbers, sizeof numbers);
    if (count)
      fprintf(stderr, "foilgauge: note: %s half: bump%s %s: no trace shows %s whole\n",
              fg_die_half_word(half), fg_plural(count), numbers, count == 1 ? "it" : "them");
  }
  note_lost_by_trace(die);
}

static fg_status measure_die(fg_context *ctx, die_run *run, int *code) {
  fg_design design;
  fg_report_outcome outcome;
  FG_TRY(load_die_design(ctx, run, &design));
  FG_TRY(fg_output_set_open(ctx, &run->outputs));
  FG_TRY(fg_die_measure(ctx, &design, &run->options, run->sources.source, run->sources.count,
                        &run->die));
  note_unseen(&run->die);
  fg_die_judge(&run->die, &outcome, NULL, 0);
  *code = fg_outcome_exit_code(&outcome);
  return fg_output_set_write(ctx, &run->outputs, write_die_output, run);
}

const struct argp fg_die_parser = {
    options, parse_die_option, "[PROFILE...]", doc, NULL, fg_cli_fill, NULL};

/* Traces of a die, or the next die from lots (cmd_die_next.c). */
static bool is_about_lots(int argc, char **argv) {
  static const char *const words[] = {"--target", "--lot", "--prior"};
  for (int i = 1; i < argc; i++)
    for (size_t w = 0; w < sizeof words / sizeof *words; w++)
      if (!strncmp(argv[i], words[w], strlen(words[w]))) return true;
  return false;
}

int fg_cmd_die(int argc, char **argv) {
  if (is_about_lots(argc, argv)) return fg_cmd_die_next(argc, argv);
  fg_context ctx = {0};
  die_run run = {.outputs.count = OUT_COUNT,
                 .said.tip_um = NAN,
                 .options.max_slope_deg = FG_DIE_MAX_SLOPE_DEG,
                 .ctx = &ctx};
  int code = 0;
  /* In order: an option counts for the profiles behind it. */
  fg_status parsed = fg_cli_parse_in_order(&ctx, &fg_die_parser, argc, argv, &run);
  if (parsed != FG_OK) run.status = parsed;
  fg_status status = measure_die(&ctx, &run, &code);
  fg_output_set_close(&run.outputs);
  fg_die_sources_free(&run.sources);
  fg_die_free(&run.die);
  return status == FG_OK ? code : fg_cli_fail(&ctx, status);
}
