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
#include "foilgauge/foil_kind.h"
#include "foilgauge/forming.h"

enum { OUT_JSON, OUT_HTML, OUT_TEXT, OUT_BUMPS, OUT_STRIP, OUT_MATERIAL, OUT_COUNT };

typedef struct forming_run {
  const char *design_path, *die_path, *material_path, *schedule_path, *fit_path;
  const char *response;
  double temperature_C, hours, pressure_bar;
  fg_forming_options options;
  fg_forming_response of;
  bool of_given;
  fg_forming_constant free[FG_FORMING_FREE_MAX];
  size_t free_count;
  fg_output_set outputs;
  fg_design design;
  fg_forming_material material;
  fg_forming forming;
  fg_forming_fit fit;
} forming_run;

enum {
  OPTION_DIE = 256,
  OPTION_SHAPE,
  OPTION_MATERIAL,
  OPTION_TEMPERATURE,
  OPTION_TIME,
  OPTION_SCHEDULE,
  OPTION_PRESSURE,
  OPTION_LAYERS,
  OPTION_STEPS,
  OPTION_FIT,
  OPTION_RESPONSE,
  OPTION_OF,
  OPTION_FREE,
  OPTION_HTML,
  OPTION_TEXT,
  OPTION_BUMPS,
  OPTION_STRIP,
  OPTION_MATERIAL_OUT,
};

static const struct argp_option options[] = {
    {NULL, 0, NULL, 0, "What is done to the strip:", 1},
    {"die", OPTION_DIE, "FILE.json", 0,
     "A report of `foilgauge die -o`: its bumps and overall radius in place of the design's", 1},
    {"shape", OPTION_SHAPE, "SHAPE", 0,
     "arcs (the design's lands, fillets and bumps) or sine (of the design's height over its "
     "pitch); default: arcs",
     1},
    {"material", OPTION_MATERIAL, "FILE.json", 0,
     "Constants in place of the literature's (1.4310, annealed); --material-out writes such a file",
     1},
    {"temperature", OPTION_TEMPERATURE, "C", 0, "Held in the die at this temperature, degrees C",
     1},
    {"time", OPTION_TIME, "H", 0, "For so many hours", 1},
    {"schedule", OPTION_SCHEDULE, "FILE.csv", 0,
     "In place of --temperature and --time: columns time_h, temperature_C; straight lines between",
     1},
    {"pressure", OPTION_PRESSURE, "BAR", 0,
     "Accepted beside the other settings of a run; enters no equation (see below)", 1},
    {NULL, 0, NULL, 0, "Constants from an experiment:", 2},
    {"fit", OPTION_FIT, "RUNS.csv", 0,
     "Find constants from runs: columns temperature_C, duration_h and the response", 2},
    {"response", OPTION_RESPONSE, "COLUMN", 0, "Default: springback_error_pct", 2},
    {"of", OPTION_OF, "WHAT", 0,
     "What the response is of: strip (the lands alone) or foil (integrated with its bumps); "
     "default: strip",
     2},
    {"free", OPTION_FREE, "NAMES", 0,
     "Constants to find, by commas (default: creep_rate_per_h,creep_exponent,"
     "creep_energy_kj_per_mol)",
     2},
    {NULL, 0, NULL, 0, "Numerics:", 3},
    {"layers", OPTION_LAYERS, "N", 0, "Over half the thickness (default: 200; of a fit 40)", 3},
    {"steps", OPTION_STEPS, "N", 0, "Per stretch of a schedule (default: 200)", 3},
    {"output", 'o', "FILE.json", 0, "Write the JSON report here (-: standard output)", 4},
    {"html", OPTION_HTML, "FILE.html", 0, "One page to read and print", 4},
    {"table", OPTION_TEXT, "FILE.txt", 0, "The table, as on a terminal", 4},
    {"table-out", OPTION_BUMPS, "FILE.csv", 0,
     "The bumps; also a lot's reference curve (`lot --reference-curve`)", 4},
    {"strip-out", OPTION_STRIP, "FILE.csv", 0, "Curvature and stress along the strip", 4},
    FG_CLI_DECIMAL_COMMA_ROW(4),
    {"material-out", OPTION_MATERIAL_OUT, "FILE.json", 0,
     "The constants, with what was found, for --material", 4},
    {0},
};

static const char doc[] =
    "Ask what a die gives after heat treatment: springback by a beam model of forming."
    "\v"
    "A flat strip is bent to the die's curvature, elastic-plastic in plane strain, relaxed in the "
    "die by Norton's law with an Arrhenius temperature, and released: kappa_f = kappa_d - rho M / "
    "(E' I). The free strip is integrated, and its circles are fitted as `measure` fits them: "
    "radius and angle error of every bump, overall springback, curvature and stress along the "
    "strip. Without --temperature and --time, or --schedule, it is released as it was bent.\n\n"
    "DESIGN is a JSON file; without it the built-in Gen II foil is formed. The constants are the "
    "literature's with their sources and scatter (in the report); trends may be believed, sizes "
    "only after --fit.\n\n"
    "Out of reach is what needs contact and friction: where the die touches while it closes, "
    "whether the pressure closes it, bumps that differ by their place; with its bumps the "
    "classical foil closes where measured ones open. A pressure on both faces is "
    "hydrostatic in plane strain: it neither yields nor creeps.\n\n"
    "On a terminal the results are printed as a table; elsewhere, where no file is asked for, as "
    "JSON.\n\n"
    "@exit_done@";

static void parse_free(struct argp_state *state, forming_run *run, const char *text) {
  run->free_count = 0;
  while (*text) {
    size_t length = strcspn(text, ",");
    int c = 0;
    for (; c < FG_FORMING_CONSTANTS; c++) {
      const char *name = fg_forming_constant_of((fg_forming_constant)c)->name;
      if (strlen(name) == length && !strncmp(name, text, length)) break;
    }
    if (c == FG_FORMING_CONSTANTS)
      argp_error(state, "--free: '%.*s' is no constant of a material", (int)length, text);
    if (run->free_count == FG_FORMING_FREE_MAX)
      argp_error(state, "--free: at most %d constants", FG_FORMING_FREE_MAX);
    run->free[run->free_count++] = (fg_forming_constant)c;
    text += length + (text[length] == ',');
  }
  if (!run->free_count) argp_error(state, "--free: name a constant of the material at least");
}

static void check_end(const forming_run *run, struct argp_state *state) {
  bool temperature = isfinite(run->temperature_C), hours = isfinite(run->hours);
  bool treated = temperature || hours || run->schedule_path;
  if (temperature != hours) argp_error(state, "--temperature and --time belong together");
  if (temperature && run->schedule_path)
    argp_error(state, "--schedule says temperature and time already");
  if (run->fit_path && (treated || run->die_path || run->outputs.path[OUT_BUMPS] ||
                        run->outputs.path[OUT_STRIP] || isfinite(run->pressure_bar)))
    argp_error(state, "--fit takes temperature and time from its runs, and the design's die: drop "
                      "--temperature, --time, --schedule, --pressure, --die, --table-out, "
                      "--strip-out");
  if (!run->fit_path && (run->response || run->of_given || run->free_count))
    argp_error(state, "--response, --of and --free belong to --fit RUNS.csv");
}

static const fg_cli_value values[] = {
    FG_CLI_VALUE(OPTION_DIE, forming_run, die_path),
    FG_CLI_VALUE(OPTION_MATERIAL, forming_run, material_path),
    FG_CLI_VALUE(OPTION_SCHEDULE, forming_run, schedule_path),
    FG_CLI_VALUE(OPTION_FIT, forming_run, fit_path),
    FG_CLI_VALUE(OPTION_RESPONSE, forming_run, response),
    FG_CLI_VALUE('o', forming_run, outputs.path[OUT_JSON]),
    FG_CLI_VALUE(OPTION_HTML, forming_run, outputs.path[OUT_HTML]),
    FG_CLI_VALUE(OPTION_TEXT, forming_run, outputs.path[OUT_TEXT]),
    FG_CLI_VALUE(OPTION_BUMPS, forming_run, outputs.path[OUT_BUMPS]),
    FG_CLI_VALUE(OPTION_STRIP, forming_run, outputs.path[OUT_STRIP]),
    FG_CLI_VALUE(OPTION_MATERIAL_OUT, forming_run, outputs.path[OUT_MATERIAL]),
    FG_CLI_VALUE(FG_CLI_DECIMAL_COMMA, forming_run, outputs.decimal_comma),
    FG_CLI_NUMBER(OPTION_TEMPERATURE, forming_run, temperature_C, -273, 3000),
    FG_CLI_NUMBER(OPTION_TIME, forming_run, hours, 0, 1e6),
    FG_CLI_NUMBER(OPTION_PRESSURE, forming_run, pressure_bar, 0, 1e5),
    FG_CLI_NUMBER(OPTION_LAYERS, forming_run, options.layers, 1, 100000),
    FG_CLI_NUMBER(OPTION_STEPS, forming_run, options.steps, 1, 100000),
    {0},
};

static error_t parse_forming_option(int key, char *text, struct argp_state *state) {
  forming_run *run = state->input;
  if (fg_cli_keep_value(values, key, text, state)) return 0;
  switch (key) {
  case OPTION_SHAPE:
    run->options.shape =
        fg_cli_is_second(state, "shape", text, "arcs", "sine") ? FG_FORMING_SINE : FG_FORMING_ARCS;
    return 0;
  case OPTION_OF:
    run->of_given = true;
    run->of = fg_cli_is_second(state, "of", text, "strip", "foil") ? FG_FORMING_OF_FOIL
                                                                   : FG_FORMING_OF_STRIP;
    return 0;
  case OPTION_FREE:
    parse_free(state, run, text);
    return 0;
  case ARGP_KEY_ARG:
    if (run->design_path) argp_error(state, "one DESIGN at a time, not also '%s'", text);
    run->design_path = text;
    return 0;
  case ARGP_KEY_END:
    check_end(run, state);
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

static fg_status write_forming_output(fg_context *ctx, void *user, size_t kind, FILE *out) {
  const forming_run *run = user;
  typedef fg_status writer(fg_context *, const fg_forming *, FILE *);
  static writer *const writers[] = {
      [OUT_JSON] = fg_forming_write_json,   [OUT_HTML] = fg_forming_write_html,
      [OUT_TEXT] = fg_forming_write_text,   [OUT_BUMPS] = fg_forming_write_bumps,
      [OUT_STRIP] = fg_forming_write_strip,
  };
  if (kind == OUT_MATERIAL) return fg_forming_write_material(ctx, &run->material, out);
  return writers[kind](ctx, &run->forming, out);
}

static fg_status write_fit(fg_context *ctx, void *user, size_t kind, FILE *out) {
  const forming_run *run = user;
  if (kind == OUT_MATERIAL) return fg_forming_write_material(ctx, &run->fit.material, out);
  if (kind == OUT_HTML) return fg_forming_fit_write_html(ctx, &run->fit, out);
  return kind == OUT_JSON ? fg_forming_fit_write_json(ctx, &run->fit, out)
                          : fg_forming_fit_write_text(ctx, &run->fit, out);
}

static fg_status load_forming_inputs(fg_context *ctx, forming_run *run) {
  const fg_input inputs[] = {{run->design_path, "the design"},
                             {run->die_path, "the die"},
                             {run->material_path, "the material"},
                             {run->schedule_path, "the schedule"},
                             {run->fit_path, "the table of runs"}};
  fg_output_set_choose_standard(&run->outputs, OUT_JSON, OUT_TEXT, false);
  FG_TRY(fg_output_set_check(ctx, &run->outputs, inputs, sizeof inputs / sizeof *inputs));
  fg_design_default(&run->design);
  if (run->design_path) FG_TRY(fg_design_load(ctx, run->design_path, &run->design));
  const char *why_not = fg_foil_traits_of(run->design.kind)->why_no_forming;
  if (why_not) return fg_fail(ctx, FG_ERR_DATA, "%s: %s", run->design_path, why_not);
  fg_forming_material_default(&run->material);
  if (run->material_path) FG_TRY(fg_forming_material_load(ctx, run->material_path, &run->material));
  return FG_OK;
}

static fg_status fit_runs(fg_context *ctx, forming_run *run) {
  static const fg_forming_constant creep[] = {FG_FORMING_CREEP_RATE, FG_FORMING_CREEP_EXPONENT,
                                              FG_FORMING_CREEP_ENERGY};
  fg_table table = {0};
  char sha256[65];
  bool given = run->free_count > 0;
  const fg_forming_fit_request request = {.design = &run->design,
                                          .material = &run->material,
                                          .column = run->response,
                                          .sha256 = sha256,
                                          .response = run->of,
                                          .options = run->options,
                                          .free = given ? run->free : creep,
                                          .free_count = given ? run->free_count : 3};
  FG_TRY(fg_table_load(ctx, run->fit_path, &table, sha256));
  fg_status status = fg_forming_fit_runs(ctx, &table, &request, &run->fit);
  fg_table_free(&table);
  FG_TRY(status);
  return fg_output_set_write(ctx, &run->outputs, write_fit, run);
}

static fg_status forming_strip(fg_context *ctx, forming_run *run) {
  fg_forming_schedule schedule = {0};
  fg_forming_die die;
  if (run->die_path) {
    if (run->options.shape == FG_FORMING_SINE || !fg_foil_kind_has_bumps(run->design.kind))
      return fg_fail(ctx, FG_ERR_USAGE, "--die needs bumps of arcs: drop --shape sine");
    FG_TRY(fg_forming_die_load(ctx, run->die_path, &run->design, &die));
    run->options.die = &die;
  }
  if (run->schedule_path)
    FG_TRY(fg_forming_schedule_load(ctx, run->schedule_path, &schedule));
  else if (isfinite(run->temperature_C))
    FG_TRY(fg_forming_schedule_hold(ctx, run->temperature_C, run->hours, &schedule));
  fg_status status =
      fg_forming_run(ctx, &run->design, &run->material, &schedule, &run->options, &run->forming);
  fg_forming_schedule_free(&schedule);
  FG_TRY(status);
  return fg_output_set_write(ctx, &run->outputs, write_forming_output, run);
}

static fg_status run_forming(fg_context *ctx, forming_run *run) {
  FG_TRY(load_forming_inputs(ctx, run));
  FG_TRY(fg_output_set_open(ctx, &run->outputs));
  return run->fit_path ? fit_runs(ctx, run) : forming_strip(ctx, run);
}

const struct argp fg_forming_parser = {options, parse_forming_option, "[DESIGN]", doc,
                                       NULL,    fg_cli_fill,          NULL};

int fg_cmd_forming(int argc, char **argv) {
  fg_context ctx = {0};
  forming_run run = {.outputs.count = OUT_COUNT,
                     .outputs.csv = 1u << OUT_BUMPS | 1u << OUT_STRIP,
                     .temperature_C = NAN,
                     .hours = NAN,
                     .pressure_bar = NAN};
  fg_status status = fg_cli_parse(&ctx, &fg_forming_parser, argc, argv, &run);
  if (status == FG_OK) status = run_forming(&ctx, &run);
  fg_output_set_close(&run.outputs);
  fg_forming_free(&run.forming);
  fg_forming_fit_free(&run.fit);
  return status == FG_OK ? 0 : fg_cli_fail(&ctx, status);
}
