/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `foilgauge die --target`: the next die from lots. */
#include <argp.h>
#include <stdlib.h>
#include <string.h>

#include "cli/commands.h"
#include "cli/facts.h"
#include "cli/output_set.h"
#include "cli/values.h"
#include "foilgauge/compensation.h"

enum { OUT_JSON, OUT_HTML, OUT_TABLE, OUT_DXF, OUT_CONCAVE, OUT_CONVEX, OUT_COUNT };

typedef struct next_run {
  fg_compensation_request request;
  fg_compensation_lot lots[FG_COMPENSATION_SETS];
  size_t dies_from; /* first lot that a following --die is of */
  double tip_um;
  fg_output_set outputs;
  fg_next_die next;
} next_run;

enum {
  OPTION_TARGET = 256,
  OPTION_LOT,
  OPTION_DIE,
  OPTION_PRIOR,
  OPTION_COMMON,
  OPTION_STEP,
  OPTION_MIN_RADIUS,
  OPTION_MAX_MOVE,
  OPTION_FOILS,
  OPTION_DOE,
  OPTION_DOE_MODEL,
  OPTION_RESPONSE,
  OPTION_SETTING,
  OPTION_HTML,
  OPTION_TABLE,
  OPTION_DXF,
  OPTION_CONCAVE,
  OPTION_CONVEX,
  OPTION_TIP,
};

static const struct argp_option options[] = {
    {"target", OPTION_TARGET, "DESIGN.json", 0, "The foil that the lots' mean shall be", 1},
    {"lot", OPTION_LOT, "DIR", 0,
     "A lot that `foilgauge lot -o DIR` measured; any number, the oldest first", 1},
    {"die", OPTION_DIE, "FILE.json", 0,
     "The die of the lots named since the last --die: a report of `foilgauge die -o`, or of an "
     "earlier --target as it was to be cut (default: that of the lot's recipe, of --prior, or as "
     "the lot's design says)",
     1},
    {"prior", OPTION_PRIOR, "FILE.json", 0,
     "Go on from this report of --target, or from the expected.json of a lot: its lots count "
     "without their folders",
     1},
    {"common", OPTION_COMMON, NULL, 0, "One radius and angle for all bumps", 2},
    {"step-um", OPTION_STEP, "UM", 0, "Smallest step of radii that the shop can cut", 2},
    {"min-radius-mm", OPTION_MIN_RADIUS, "MM", 0, "Smallest bump radius that the shop can cut", 2},
    {"max-move-pct", OPTION_MAX_MOVE, "PCT", 0,
     "Largest step from the present die (default: @max_move_pct@)", 2},
    {"foils", OPTION_FOILS, "N", 0, "Foils of the next lot (default: as many as in the last)", 2},
    {"doe", OPTION_DOE, "RUNS.csv", 0,
     "Choose the heat treatment together with the die: runs of an experiment, as `foilgauge doe` "
     "reads them",
     2},
    {"doe-model", OPTION_DOE_MODEL, "FORMULA", 0,
     "Of --doe: the model (default: temperature_C*duration_h)", 2},
    {"response", OPTION_RESPONSE, "COLUMN", 0,
     "Of --doe: the springback error in percent (default: springback_error_pct)", 2},
    {"setting", OPTION_SETTING, "SETTING", 0,
     "Heat treatment of the lots: 'temperature_C=650, duration_h=5'", 2},
    {"output", 'o', "FILE.json", 0, "Write the JSON report here (-: standard output)", 3},
    {"html", OPTION_HTML, "FILE.html", 0, "One page to read and print", 3},
    {"table", OPTION_TABLE, "FILE.txt", 0, "The table, as on a terminal", 3},
    {"dxf", OPTION_DXF, "FILE.dxf", 0, "The profile as arcs, mm: both halves and the datum line",
     3},
    {"trace-concave", OPTION_CONCAVE, "FILE.txt", 0,
     "The trace that a stylus should see of the concave half; `foilgauge die` reads it", 3},
    {"trace-convex", OPTION_CONVEX, "FILE.txt", 0, "The same of the convex half", 3},
    {"tip-um", OPTION_TIP, "R", 0, "Radius of the tip that would trace it (default: 2)", 3},
    {0},
};

static const char doc[] =
    "Find the next die: what to cut so that the mean of the formed foils lands on the design."
    "\v"
    "Springback is learnt from the lots: radius and arc length by the bump's number, overall "
    "radius "
    "and pitch by the foil, each as a ratio of formed to die, with its dependence on the die's own "
    "size where lots of several dies tell it. What one lot cannot tell (how lots differ, how "
    "springback changes with the radius) is in U. The report says what the next lot will show: "
    "means with intervals, the share within the target's tolerances, bearings that assemble; "
    "`foilgauge lot --expected` holds the lot against it.\n\n"
    "  foilgauge die --target my_foil.json --lot lot_a --die die_a.json \\\n"
    "    -o next.json\n"
    "  foilgauge lot scans_b -o lot_b --expected next.json\n"
    "  foilgauge die --target my_foil.json --prior lot_b/expected.json \\\n"
    "    --html next.html\n\n"
    "On a terminal the results are printed as a table; elsewhere, where no file is asked for, as "
    "JSON.\n\n"
    "@exit_done@";

static void add_next_lot(next_run *run, const char *folder, struct argp_state *state) {
  if (run->request.lot_count == FG_COMPENSATION_SETS)
    argp_error(state, "--lot: at most %d lots", FG_COMPENSATION_SETS);
  run->lots[run->request.lot_count++].folder = folder;
}

static void name_lots_die(next_run *run, const char *path, struct argp_state *state) {
  if (run->dies_from == run->request.lot_count)
    argp_error(state, "--die names the die of the lots before it: put --lot first");
  while (run->dies_from < run->request.lot_count)
    run->lots[run->dies_from++].die = path;
}

/* Options whose text is kept as it is. */
static const fg_cli_value values[] = {
    FG_CLI_VALUE(OPTION_TARGET, next_run, request.target),
    FG_CLI_VALUE(OPTION_PRIOR, next_run, request.prior),
    FG_CLI_VALUE(OPTION_DOE, next_run, request.experiment.runs),
    FG_CLI_VALUE(OPTION_DOE_MODEL, next_run, request.experiment.formula),
    FG_CLI_VALUE(OPTION_RESPONSE, next_run, request.experiment.response),
    FG_CLI_VALUE(OPTION_SETTING, next_run, request.experiment.setting),
    FG_CLI_VALUE('o', next_run, outputs.path[OUT_JSON]),
    FG_CLI_VALUE(OPTION_HTML, next_run, outputs.path[OUT_HTML]),
    FG_CLI_VALUE(OPTION_TABLE, next_run, outputs.path[OUT_TABLE]),
    FG_CLI_VALUE(OPTION_DXF, next_run, outputs.path[OUT_DXF]),
    FG_CLI_VALUE(OPTION_CONCAVE, next_run, outputs.path[OUT_CONCAVE]),
    FG_CLI_VALUE(OPTION_CONVEX, next_run, outputs.path[OUT_CONVEX]),
    FG_CLI_VALUE(OPTION_COMMON, next_run, request.common),
    FG_CLI_NUMBER(OPTION_STEP, next_run, request.step_um, 0, 1000),
    FG_CLI_NUMBER(OPTION_MIN_RADIUS, next_run, request.min_radius_mm, 0, 1e3),
    FG_CLI_NUMBER(OPTION_MAX_MOVE, next_run, request.max_move_pct, 0.01, 100),
    FG_CLI_NUMBER(OPTION_FOILS, next_run, request.foils, 1, 1e6),
    FG_CLI_NUMBER(OPTION_TIP, next_run, tip_um, 0, 1000),
    {0},
};

static void check_next_end(const next_run *run, const struct argp_state *state) {
  if (!run->request.lot_count && !run->request.prior)
    argp_error(state, "a die is found from lots: name one with --lot");
  if (!run->request.experiment.runs != !run->request.experiment.setting)
    argp_error(state, "--doe needs the --setting of the lots, and --setting the runs of --doe");
}

static error_t parse_next_option(int key, char *text, struct argp_state *state) {
  next_run *run = state->input;
  if (fg_cli_keep_value(values, key, text, state)) return 0;
  switch (key) {
  case OPTION_LOT:
    add_next_lot(run, text, state);
    break;
  case OPTION_DIE:
    name_lots_die(run, text, state);
    break;
  case ARGP_KEY_ARG:
    argp_error(state, "'%s': a lot's folder is named with --lot", text);
    break;
  case ARGP_KEY_END:
    check_next_end(run, state);
    break;
  default:
    return ARGP_ERR_UNKNOWN;
  }
  return 0;
}

static fg_status write_next_output(fg_context *ctx, void *user, size_t kind, FILE *out) {
  const next_run *run = user;
  switch (kind) {
  case OUT_JSON:
    return fg_next_die_write_json(ctx, &run->next, out);
  case OUT_HTML:
    return fg_next_die_write_html(ctx, &run->next, out);
  case OUT_TABLE:
    return fg_next_die_write_table(ctx, &run->next, out);
  case OUT_DXF:
    return fg_next_die_write_dxf(ctx, &run->next, out);
  default:
    return fg_next_die_write_trace(ctx, &run->next, kind == OUT_CONVEX, run->tip_um, out);
  }
}

static fg_status find_next_die(fg_context *ctx, next_run *run) {
  const fg_input inputs[] = {{run->request.target, "the target"},
                             {run->request.prior, "the earlier report"},
                             {run->request.experiment.runs, "the runs"}};
  fg_output_set_choose_standard(&run->outputs, OUT_JSON, OUT_TABLE, false);
  FG_TRY(fg_output_set_check(ctx, &run->outputs, inputs, sizeof inputs / sizeof *inputs));
  for (size_t i = 0; i < run->request.lot_count; i++)
    FG_TRY(fg_output_set_check(ctx, &run->outputs, &(fg_input){run->lots[i].die, "a die"}, 1));
  FG_TRY(fg_output_set_open(ctx, &run->outputs));
  run->request.lots = run->lots;
  FG_TRY(fg_next_die_find(ctx, &run->request, &run->next));
  for (size_t i = 0; i < run->next.notes; i++)
    fprintf(stderr, "foilgauge: note: %s\n", run->next.note[i]);
  return fg_output_set_write(ctx, &run->outputs, write_next_output, run);
}

const struct argp fg_die_next_parser = {options, parse_next_option, "",  doc,
                                        NULL,    fg_cli_fill,       NULL};

int fg_cmd_die_next(int argc, char **argv) {
  fg_context ctx = {0};
  next_run run = {.outputs.count = OUT_COUNT,
                  .tip_um = 2,
                  .request.experiment = {.response = "springback_error_pct",
                                         .formula = "temperature_C*duration_h"}};
  fg_status status = fg_cli_parse_in_order(&ctx, &fg_die_next_parser, argc, argv, &run);
  if (status == FG_OK) status = find_next_die(&ctx, &run);
  fg_output_set_close(&run.outputs);
  fg_next_die_free(&run.next);
  return status == FG_OK ? 0 : fg_cli_fail(&ctx, status);
}
