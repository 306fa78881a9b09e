/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <argp.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/commands.h"
#include "cli/facts.h"
#include "cli/output_set.h"
#include "cli/values.h"
#include "foilgauge/load_report.h"
#include "foilgauge/memory.h"
#include "foilgauge/text.h"

enum { OUT_JSON, OUT_HTML, OUT_TEXT, OUT_CSV, OUT_TABLE, OUT_COUNT };

typedef struct stiffness_run {
  fg_load_source said; /* as the options before a file state it */
  fg_load_source *sources;
  size_t count, capacity;
  fg_load_source *break_away;
  size_t break_away_capacity;
  fg_load_options options;
  fg_output_set outputs;
  fg_status status; /* of what failed while the command line was read */
  fg_context *ctx;
  fg_load_test test;
} stiffness_run;

enum {
  OPTION_BEARING = 256,
  OPTION_AZIMUTH,
  OPTION_THRESHOLD,
  OPTION_U_FORCE,
  OPTION_U_DISPLACEMENT,
  OPTION_DIAMETER,
  OPTION_LENGTH,
  OPTION_LIMIT,
  OPTION_LOT,
  OPTION_BREAK_AWAY,
  OPTION_LEVER,
  OPTION_RIG,
  OPTION_U_RIG,
  OPTION_U_WEIGHT,
  OPTION_AZIMUTH_ZERO,
  OPTION_HTML,
  OPTION_TEXT,
  OPTION_CSV,
  OPTION_TABLE,
};

static const struct argp_option options[] = {
    {NULL, 0, NULL, 0, "Of the files that follow, where a column does not say it:", 1},
    {"bearing", OPTION_BEARING, "NAME", 0, "Name of the bearing (default: the file's name)", 1},
    {"azimuth", OPTION_AZIMUTH, "DEG", 0, "Azimuth that is pushed along", 1},
    {NULL, 0, NULL, 0, "Of all:", 2},
    {"threshold", OPTION_THRESHOLD, "N", 0,
     "The clearance lies between the places where |F| passes this (default: @load_threshold_n@ N)",
     2},
    {"u-force", OPTION_U_FORCE, "PCT", 0,
     "Standard uncertainty of the load cell's scale (default: @load_u_force_pct@ %, thesis section "
     "5.13)",
     2},
    {"u-displacement", OPTION_U_DISPLACEMENT, "PCT", 0,
     "Standard uncertainty of the displacement probe's scale (default: @load_u_displacement_pct@ "
     "%, thesis section "
     "5.13)",
     2},
    {"diameter", OPTION_DIAMETER, "MM", 0,
     "Of the bore, for friction and preload (default: @load_diameter_mm@)", 2},
    {"length", OPTION_LENGTH, "MM", 0,
     "Of the bearing, for the preload (default: @load_length_mm@)", 2},
    {"limit", OPTION_LIMIT, "NAME=LOW:HIGH", 0,
     "A limit of clearance_mm, stiffness_n_mm, loss_factor (every azimuth), radial_hysteresis_n, "
     "preload_kpa or friction_coefficient (every bearing); LOW or HIGH may be empty; may be "
     "repeated",
     2},
    {"lot", OPTION_LOT, "DIR", 0,
     "The lot that `foilgauge lot -o DIR` measured: the free travel that its foils leave a rotor, "
     "beside the gap of bearings of the same name",
     2},
    {"azimuth-zero", OPTION_AZIMUTH_ZERO, "DEG", 0,
     "Azimuth of the test where the lot's bearings have 0 degrees (default: 0)", 2},
    {NULL, 0, NULL, 0, "Break-away tests, which tell the preload:", 3},
    {"break-away", OPTION_BREAK_AWAY, "FILE.csv", 0,
     "A row per pull: dead weight (dead_weight_N), and torque (torque_N_mm) or force (force_N) at "
     "which the rotor begins to turn; may be repeated",
     3},
    {"lever", OPTION_LEVER, "MM", 0, "Radius that the force pulls at (default: half of --diameter)",
     3},
    {"rig-torque", OPTION_RIG, "NMM", 0,
     "The rig's own friction torque, N mm; not given, it counts as preload and the report says so",
     3},
    {"u-rig-torque", OPTION_U_RIG, "NMM", 0,
     "Standard uncertainty of --rig-torque, N mm (default: 0)", 3},
    {"u-weight", OPTION_U_WEIGHT, "PCT", 0,
     "Standard uncertainty of the dead weights' scale (default: @load_u_weight_pct@ %)", 3},
    {NULL, 0, NULL, 0, "Output:", 4},
    {"output", 'o', "FILE.json", 0, "Write the JSON report here (-: standard output)", 4},
    {"html", OPTION_HTML, "FILE.html", 0, "One page to read and print, with the loops", 4},
    {"text", OPTION_TEXT, "FILE.txt", 0, "The table, as on a terminal", 4},
    {"csv", OPTION_CSV, "FILE.csv", 0, "A row per bearing and azimuth, everything that was found",
     4},
    {"table-out", OPTION_TABLE, "FILE.csv", 0,
     "For `foilgauge loop --table`: the clearance (with --lot: what the gap differs from the lot's "
     "by) "
     "beside bearing, azimuth and pad",
     4},
    FG_CLI_DECIMAL_COMMA_ROW(4),
    {0},
};

static const char doc[] =
    "Judge assembled bearings by load-displacement tests: clearance, stiffness, loss factor, "
    "radial hysteresis, and how they differ over the azimuths; by break-away tests: friction "
    "coefficient and preload."
    "\v"
    "TEST is CSV (comma, semicolon or tab; decimal point or comma) with a row per sample, in the "
    "order of time, and columns named with their unit: azimuth_deg (rad), force_N (mN, kN, "
    "kgf, lbf), displacement_mm (um, m, nm, mil, in); `force [N]` will do too. Columns bearing, "
    "pad, cycle and time_s "
    "(ms, min) are read where they are there; others are named in the report and not read.\n\n"
    "Pushed and pulled: force and displacement have both signs. One cycle will do; from three on "
    "what drifts is told from what lies between the strokes, and from their scatter whether the "
    "uncertainties say enough. An azimuth that is only pushed, or that never passes the threshold, "
    "has no clearance: it is reported with the reason, exit code 2.\n\n"
    "Stiffness is the largest up to just before the turn: 1 % of the travel is left out there, or "
    "10 times the displacement's noise where that is more. A foil that hardens is stiffer beyond; "
    "the flag stiffness_at_end says so.\n\n"
    "Standard uncertainties of both instruments' scales are combined: sqrt(1.0² + 1.3²) = 1.64 % "
    "of a stiffness. They are the same for all azimuths and do not count where these are "
    "compared.\n\n"
    "Preload is the intercept of break-away friction over dead weight, less the rig's, over the "
    "slope (thesis section 6.2.2); without --break-away none is reported. A bearing column, or "
    "--bearing before --break-away, names the bearing; else it is the tests' only one.\n\n"
    "  foilgauge stiffness test.csv --threshold 5 --html stiffness.html\n"
    "  foilgauge stiffness test.csv --break-away pulls.csv --rig-torque 4 \\\n"
    "    --u-rig-torque 0.5\n"
    "  foilgauge stiffness --bearing B1 b1.csv --bearing B2 b2.csv --lot lot1 \\\n"
    "    --table-out t.csv\n"
    "  foilgauge loop --table t.csv --response difference_um --model 1\n\n"
    "On a terminal the results are printed as a table; elsewhere, where no file is asked for, as "
    "JSON.\n\n"
    "@exit_judged@";

static void keep_status(stiffness_run *run, fg_status status) {
  if (run->status == FG_OK) run->status = status;
}

static fg_status add_source(stiffness_run *run, const char *path) {
  FG_TRY(fg_memory_reserve(run->ctx, run->count + 1, sizeof *run->sources, &run->capacity,
                           (void **)&run->sources));
  run->sources[run->count] = run->said;
  run->sources[run->count++].path = path;
  return FG_OK;
}

static fg_status add_break_away(stiffness_run *run, const char *path) {
  fg_load_options *o = &run->options;
  FG_TRY(fg_memory_reserve(run->ctx, o->break_away_count + 1, sizeof *run->break_away,
                           &run->break_away_capacity, (void **)&run->break_away));
  run->break_away[o->break_away_count] = run->said;
  run->break_away[o->break_away_count++].path = path;
  o->break_away = run->break_away;
  return FG_OK;
}

/* One side of LOW:HIGH; nothing is no limit. */
static bool read_side(const char *text, size_t length, double none, double *value) {
  char *end;
  *value = none;
  if (!length) return true;
  *value = strtod(text, &end);
  return end == text + length && isfinite(*value);
}

static void read_limit(stiffness_run *run, struct argp_state *state, const char *text) {
  fg_tolerance limit = {0};
  const char *equals = strchr(text, '='), *colon = equals ? strchr(equals, ':') : NULL;
  int q = 0;
  if (!colon) argp_error(state, "--limit: '%s' is not NAME=LOW:HIGH", text);
  size_t length = (size_t)(equals - text);
  while (q < FG_LOAD_QUANTITIES &&
         (strlen(fg_load_quantity_name((fg_load_quantity)q)) != length ||
          strncmp(text, fg_load_quantity_name((fg_load_quantity)q), length) != 0))
    q++;
  if (q == FG_LOAD_QUANTITIES)
    argp_error(state,
               "--limit: '%.*s' is none of clearance_mm, stiffness_n_mm, loss_factor, preload_kpa, "
               "radial_hysteresis_n, friction_coefficient",
               (int)length, text);
  memcpy(limit.quantity, fg_load_quantity_name((fg_load_quantity)q), length);
  if (!read_side(equals + 1, (size_t)(colon - equals - 1), -INFINITY, &limit.lower) ||
      !read_side(colon + 1, strlen(colon + 1), INFINITY, &limit.upper) ||
      !(limit.lower <= limit.upper) || (isinf(limit.lower) && isinf(limit.upper)))
    argp_error(state, "--limit: '%s' has no limits LOW:HIGH, numbers of which one may be left out",
               text);
  if (run->options.limit_count == FG_LOAD_LIMITS_MAX)
    argp_error(state, "--limit: more than %d", FG_LOAD_LIMITS_MAX);
  run->options.limits[run->options.limit_count++] = limit;
}

static void check_arguments(const stiffness_run *run, struct argp_state *state) {
  const fg_load_options *o = &run->options;
  if (!run->count && !o->break_away_count) argp_error(state, "no TEST was given");
  if (isfinite(o->rig_n_mm) && !o->break_away_count)
    argp_error(state, "--rig-torque says something of a --break-away test, and there is none");
  if (o->u_rig_n_mm > 0 && !isfinite(o->rig_n_mm))
    argp_error(state, "--u-rig-torque without --rig-torque");
}

static const fg_cli_value values[] = {
    FG_CLI_VALUE('o', stiffness_run, outputs.path[OUT_JSON]),
    FG_CLI_VALUE(OPTION_HTML, stiffness_run, outputs.path[OUT_HTML]),
    FG_CLI_VALUE(OPTION_TEXT, stiffness_run, outputs.path[OUT_TEXT]),
    FG_CLI_VALUE(OPTION_CSV, stiffness_run, outputs.path[OUT_CSV]),
    FG_CLI_VALUE(OPTION_TABLE, stiffness_run, outputs.path[OUT_TABLE]),
    FG_CLI_NUMBER(OPTION_LEVER, stiffness_run, options.lever_mm, 1e-3, 1e6),
    FG_CLI_NUMBER(OPTION_RIG, stiffness_run, options.rig_n_mm, 0, 1e12),
    FG_CLI_NUMBER(OPTION_U_RIG, stiffness_run, options.u_rig_n_mm, 0, 1e12),
    FG_CLI_NUMBER(OPTION_U_WEIGHT, stiffness_run, options.u_weight_pct, 0, 100),
    FG_CLI_VALUE(OPTION_BEARING, stiffness_run, said.bearing),
    FG_CLI_NUMBER(OPTION_AZIMUTH, stiffness_run, said.azimuth_deg, -720, 720),
    FG_CLI_NUMBER(OPTION_THRESHOLD, stiffness_run, options.threshold_n, 1e-6, 1e6),
    FG_CLI_NUMBER(OPTION_U_FORCE, stiffness_run, options.u_force_pct, 0, 100),
    FG_CLI_NUMBER(OPTION_U_DISPLACEMENT, stiffness_run, options.u_displacement_pct, 0, 100),
    FG_CLI_NUMBER(OPTION_DIAMETER, stiffness_run, options.diameter_mm, 1e-3, 1e6),
    FG_CLI_NUMBER(OPTION_LENGTH, stiffness_run, options.length_mm, 1e-3, 1e6),
    FG_CLI_NUMBER(OPTION_AZIMUTH_ZERO, stiffness_run, options.azimuth_zero_deg, -720, 720),
    FG_CLI_VALUE(OPTION_LOT, stiffness_run, options.lot),
    FG_CLI_VALUE(FG_CLI_DECIMAL_COMMA, stiffness_run, outputs.decimal_comma),
    {0},
};

static error_t parse_stiffness_option(int key, char *text, struct argp_state *state) {
  stiffness_run *run = state->input;
  if (fg_cli_keep_value(values, key, text, state)) return 0;
  switch (key) {
  case OPTION_BREAK_AWAY:
    keep_status(run, add_break_away(run, text));
    break;
  case OPTION_LIMIT:
    read_limit(run, state, text);
    break;
  case ARGP_KEY_ARG:
    keep_status(run, add_source(run, text));
    break;
  case ARGP_KEY_END:
    check_arguments(run, state);
    break;
  default:
    return ARGP_ERR_UNKNOWN;
  }
  return 0;
}

static fg_status write_stiffness_output(fg_context *ctx, void *user, size_t kind, FILE *out) {
  typedef fg_status writer(fg_context *, const fg_load_test *, FILE *);
  static writer *const writers[OUT_COUNT] = {
      [OUT_JSON] = fg_load_write_json,   [OUT_HTML] = fg_load_write_html,
      [OUT_TEXT] = fg_load_write_text,   [OUT_CSV] = fg_load_write_csv,
      [OUT_TABLE] = fg_load_write_table,
  };
  const stiffness_run *run = user;
  return writers[kind](ctx, &run->test, out);
}

static fg_status check_lot(fg_context *ctx, stiffness_run *run) {
  char *path;
  if (!run->options.lot) return FG_OK;
  FG_TRY(fg_text_print(ctx, &path, "%s/lot.json", run->options.lot));
  fg_status status = fg_output_set_check(ctx, &run->outputs, &(fg_input){path, "the lot"}, 1);
  free(path);
  return status;
}

static fg_status measure_tests(fg_context *ctx, stiffness_run *run, int *code) {
  fg_report_outcome outcome;
  FG_TRY(run->status);
  fg_output_set_choose_standard(&run->outputs, OUT_JSON, OUT_TEXT, false);
  for (size_t i = 0; i < run->count; i++)
    FG_TRY(
        fg_output_set_check(ctx, &run->outputs, &(fg_input){run->sources[i].path, "the test"}, 1));
  for (size_t i = 0; i < run->options.break_away_count; i++)
    FG_TRY(fg_output_set_check(ctx, &run->outputs,
                               &(fg_input){run->break_away[i].path, "the break-away test"}, 1));
  FG_TRY(check_lot(ctx, run));
  FG_TRY(fg_output_set_open(ctx, &run->outputs));
  FG_TRY(fg_load_test_measure(ctx, &run->options, run->sources, run->count, &run->test));
  fg_load_judge(&run->test, &outcome, NULL, 0);
  *code = fg_outcome_exit_code(&outcome);
  return fg_output_set_write(ctx, &run->outputs, write_stiffness_output, run);
}

const struct argp fg_stiffness_parser = {
    options, parse_stiffness_option, "TEST...", doc, NULL, fg_cli_fill, NULL};

int fg_cmd_stiffness(int argc, char **argv) {
  fg_context ctx = {0};
  stiffness_run run = {.outputs.count = OUT_COUNT,
                       .outputs.csv = 1u << OUT_CSV | 1u << OUT_TABLE,
                       .said.azimuth_deg = NAN,
                       .options = fg_load_options_default(),
                       .ctx = &ctx};
  int code = 0;
  /* In order: an option counts for the files behind it. */
  fg_status parsed = fg_cli_parse_in_order(&ctx, &fg_stiffness_parser, argc, argv, &run);
  if (parsed != FG_OK) run.status = parsed;
  fg_status status = measure_tests(&ctx, &run, &code);
  fg_output_set_close(&run.outputs);
  free(run.sources);
  free(run.break_away);
  fg_load_test_free(&run.test);
  return status == FG_OK ? code : fg_cli_fail(&ctx, status);
}
