/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <argp.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/commands.h"
#include "cli/facts.h"
#include "cli/output_set.h"
#include "cli/values.h"
#include "foilgauge/film.h"

enum { OUT_JSON, OUT_HTML, OUT_TEXT, OUT_SPEEDS, OUT_DRAWS, OUT_ORBIT, OUT_COUNT };

typedef struct film_run {
  const char *design_path;
  fg_film_options options;
  fg_output_set outputs;
  fg_design design;
  fg_film_report report;
} film_run;

enum {
  OPTION_LOAD = 256,
  OPTION_LOAD_ANGLE,
  OPTION_SPEED,
  OPTION_MASS,
  OPTION_FOILS,
  OPTION_LENGTH,
  OPTION_CLEARANCE,
  OPTION_COMPLIANCE,
  OPTION_MODEL,
  OPTION_LOSS,
  OPTION_FRICTION,
  OPTION_MODULUS,
  OPTION_PADS,
  OPTION_BUMPS,
  OPTION_FIRST,
  OPTION_PITCH,
  OPTION_TOP,
  OPTION_TOP_FOIL,
  OPTION_VISCOSITY,
  OPTION_AMBIENT,
  OPTION_SPEEDS,
  OPTION_SHIMS,
  OPTION_DRAWS,
  OPTION_SEED,
  OPTION_JOBS,
  OPTION_TOUCHING,
  OPTION_MESH,
  OPTION_HTML,
  OPTION_TEXT,
  OPTION_SPEEDS_OUT,
  OPTION_DRAWS_OUT,
  OPTION_ORBIT,
  OPTION_BORE,
  OPTION_SENSITIVITY,
  OPTION_ORBIT_OUT,
  OPTION_WITHIN,
  OPTION_KEEP,
  OPTION_SHARD,
  OPTION_LIFT_OFF,
  OPTION_U_LIFT_OFF,
  OPTION_U_LOAD,
};

static const struct argp_option options[] = {
    {NULL, 0, NULL, 0, "The rotor (--load and --speed are needed):", 1},
    {"load", OPTION_LOAD, "N", 0, "Force on the rotor, on this bearing", 1},
    {"speed", OPTION_SPEED, "RPM", 0, "Of the rotor", 1},
    {"load-angle", OPTION_LOAD_ANGLE, "DEG", 0,
     "Direction of the load from the first bump of pad 1, in the sense of rotation (default: "
     "@film_load_deg@)",
     1},
    {"mass", OPTION_MASS, "KG", 0, "Of the rotor, on this bearing (default: the load's by gravity)",
     1},
    {NULL, 0, NULL, 0, "The bearing:", 2},
    {"foils", OPTION_FOILS, "PATH", 0,
     "A report of `foilgauge measure` whose foils are the pads in their order: their clearances in "
     "place of the design's. Or one of `foilgauge stiffness` of this bearing: its gap and "
     "stiffness by azimuth. Or the folder of a lot: bearings are drawn from its foils",
     2},
    {"bore", OPTION_BORE, "FILE.csv", 0,
     "The bore's measured profile: columns angle_deg and radius_mm; its radius less the design's "
     "sleeve radius is added to the clearance",
     2},
    {"length", OPTION_LENGTH, "MM", 0, "Of the bearing (default: the rotor's diameter)", 2},
    {"clearance", OPTION_CLEARANCE, "UM", 0,
     "C, which the film is referred to (default: the design's C_D)", 2},
    {"compliance", OPTION_COMPLIANCE, "ALPHA", 0,
     "p_a s / (C K), 0: rigid (default: of the design's bumps, by --model)", 2},
    {"model", OPTION_MODEL, "NAME", 0,
     "Of a bump's stiffness: arch, heshmat or link_spring (default: arch)", 2},
    {"loss-factor", OPTION_LOSS, "GAMMA", 0,
     "Of the bumps, as `foilgauge stiffness` measures it (default: @film_loss_factor@, thesis "
     "table 5.6)",
     2},
    {"friction", OPTION_FRICTION, "MU", 0, "Of a bump's feet (default: @friction@)", 2},
    {"elastic-modulus", OPTION_MODULUS, "GPA", 0, "Of the foils (default: @youngs_modulus_gpa@)",
     2},
    {"pads", OPTION_PADS, "N", 0,
     "Foils around the bearing (default: @film_pads@); 0: a closed ring of bumps", 2},
    {"bumps", OPTION_BUMPS, "N", 0, "Of each pad (default: the design's)", 2},
    {"first-bump", OPTION_FIRST, "N", 0, "Of each foil, as measured (default: 1)", 2},
    {"pitch", OPTION_PITCH, "DEG", 0, "From bump to bump (default: even around the bearing)", 2},
    {"top-foil", OPTION_TOP, "KIND", 0,
     "stiff between the bumps, or sagging as a beam on them (default: stiff)", 2},
    {"top-foil-thickness", OPTION_TOP_FOIL, "MM", 0, "Of one that sags (default: the design's)", 2},
    {"viscosity", OPTION_VISCOSITY, "UPAS", 0,
     "Of the gas, micropascal seconds (default: @film_viscosity_upa_s@, air at 25 degrees C)", 2},
    {"ambient", OPTION_AMBIENT, "KPA", 0, "Pressure around (default: @film_ambient_kpa@)", 2},
    {NULL, 0, NULL, 0, "What is asked:", 3},
    {"speeds", OPTION_SPEEDS, "LOW:HIGH[:N]", 0,
     "Of the stability map, rpm (default: a quarter to four times the speed, @film_speeds@)", 3},
    {"orbit", OPTION_ORBIT, "TURNS", 0,
     "Integrate film and rotor in time over so many turns, after a small pulse of load", 3},
    {"sensitivity", OPTION_SENSITIVITY, NULL, 0,
     "Change of the critical mass with radius, angle and thickness of the bumps, their mean and "
     "their scatter",
     3},
    {"within", OPTION_WITHIN, "PERCENT", 0,
     "The tolerance on the clearance that keeps the threshold speed within PERCENT of that as "
     "designed, and the share of drawn bearings that keep it",
     3},
    {"lift-off", OPTION_LIFT_OFF, "RPM", 0,
     "Speed at which this rotor lifted off, or touched down as it coasted, under this load: by how "
     "much the clearances differ from the bearing's, for the model to do so",
     3},
    {"u-lift-off", OPTION_U_LIFT_OFF, "RPM", 0, "Standard uncertainty of --lift-off (default: 0)",
     3},
    {"u-load", OPTION_U_LOAD, "N", 0,
     "Standard uncertainty of the load, for the clearances by the lift-off speed (default: 0)", 3},
    {"shims", OPTION_SHIMS, "LOW:HIGH", 0,
     "Draw bearings as designed with random shims under their bumps, percent of the clearance: a "
     "higher shim closes it",
     3},
    {"draws", OPTION_DRAWS, "N", 0,
     "Number of drawn bearings, of shims or of a lot (default: 1000)", 3},
    {"keep", OPTION_KEEP, "FILE", 0,
     "Keep drawn bearings here as they are solved, and go on from those that are there: a run that "
     "was killed loses none; files of parts may be joined by cat",
     3},
    {"shard", OPTION_SHARD, "I/N", 0, "Only part I of N of the draws; needs --keep", 3},
    {"seed", OPTION_SEED, "N", 0, "Of the draws (default: 1)", 3},
    {"jobs", OPTION_JOBS, "N", 0, "Threads (default: one per core)", 3},
    {"touching", OPTION_TOUCHING, "UM", 0,
     "A film thinner than this touches (default: @film_touching_um@)", 3},
    {"mesh", OPTION_MESH, "BUMP,AXIAL", 0,
     "Cells per bump (even) and over half the length (default: @film_mesh_bump@,@film_mesh_axial@)",
     3},
    {NULL, 0, NULL, 0, "Output:", 4},
    {"output", 'o', "FILE.json", 0, "Write the JSON report here (-: standard output)", 4},
    {"html", OPTION_HTML, "FILE.html", 0, "One page to read and print", 4},
    {"table", OPTION_TEXT, "FILE.txt", 0, "The table, as on a terminal", 4},
    {"speeds-out", OPTION_SPEEDS_OUT, "FILE.csv", 0, "A row per speed", 4},
    {"draws-out", OPTION_DRAWS_OUT, "FILE.csv", 0, "A row per drawn bearing", 4},
    {"orbit-out", OPTION_ORBIT_OUT, "FILE.csv", 0, "Places of the orbit", 4},
    FG_CLI_DECIMAL_COMMA_ROW(4),
    {0},
};

static const char doc[] =
    "Ask what foils do to the rotor: gas film, load, stiffness and damping, and the mass and speed "
    "from which on the rotor whirls."
    "\v"
    "DESIGN is a JSON file; without it the built-in Gen II foil carries the rotor. The film obeys "
    "the compressible Reynolds equation, its foils give way by their compliance, and a small whirl "
    "about the steady place gives stiffness and damping (thesis section 5.12).\n\n"
    "  foilgauge film --load 5 --speed 60000 --clearance 80 --html film.html\n"
    "  foilgauge film --load 5 --speed 60000 --foils bearing.json -o film.json\n"
    "  foilgauge film --load 5 --speed 60000 --clearance 80 --shims=-7:7 \\\n"
    "    --draws 1000\n\n"
    "On a terminal the results are printed as a table; elsewhere, where no file is asked for, as "
    "JSON.\n\n"
    "@exit_partly@";

/* Two or three numbers by a mark; returns how many. */
static int split_numbers(const char *text, char mark, double numbers[3]) {
  int count = 0;
  for (const char *c = text; count < 3; c++) {
    char *end;
    numbers[count] = strtod(c, &end);
    if (end == c || !isfinite(numbers[count])) return 0;
    count++;
    if (!*end) return count;
    if (*end != mark) return 0;
    c = end;
  }
  return 0;
}

static void read_speeds(film_run *run, struct argp_state *state, const char *text) {
  double n[3];
  int count = split_numbers(text, ':', n);
  if (count < 2 || !(n[0] > 0) || !(n[1] > n[0]))
    argp_error(state, "--speeds: '%s' is not LOW:HIGH or LOW:HIGH:N, rpm", text);
  if (count == 3 && !(n[2] >= 2 && n[2] <= FG_FILM_SPEEDS_MAX && n[2] == floor(n[2])))
    argp_error(state, "--speeds: N must be a whole number from 2 to %d", FG_FILM_SPEEDS_MAX);
  run->options.map.low_rpm = n[0];
  run->options.map.high_rpm = n[1];
  if (count == 3) run->options.map.speeds = (size_t)n[2];
}

static void read_shims(film_run *run, struct argp_state *state, const char *text) {
  double n[3];
  if (split_numbers(text, ':', n) != 2 || !(n[1] >= n[0]))
    argp_error(state, "--shims: '%s' is not LOW:HIGH, percent of the clearance", text);
  run->options.draw.shim_low_pct = n[0];
  run->options.draw.shim_high_pct = n[1];
}

static void read_mesh(film_run *run, struct argp_state *state, const char *text) {
  double n[3];
  if (split_numbers(text, ',', n) != 2 || !(n[0] >= 2 && n[0] <= 64 && fmod(n[0], 2) == 0) ||
      !(n[1] >= 2 && n[1] <= 64 && n[1] == floor(n[1])))
    argp_error(state,
               "--mesh: '%s' is not an even number of cells from 2 to 64 and one from 2 to "
               "64, as 6,8",
               text);
  run->options.cells_per_bump = (size_t)n[0];
  run->options.cells_axial = (size_t)n[1];
}

static void take_film_shard(film_run *run, fg_lot_shard shard) {
  run->options.draw.shard = shard.index;
  run->options.draw.shards = shard.count;
}

static void check_film_end(film_run *run, struct argp_state *state) {
  fg_film_options *o = &run->options;
  if (!isfinite(o->load_n) || !isfinite(o->speed_rpm))
    argp_error(state, "a film needs --load N and --speed RPM");
  bool shims = isfinite(o->draw.shim_low_pct), lot = fg_film_draws_from_lot(o);
  if (!shims && !lot && (o->draw.count || run->outputs.path[OUT_DRAWS]))
    argp_error(state,
               "--draws and --draws-out need --shims LOW:HIGH, or --foils with a lot's folder");
  if (shims && lot)
    argp_error(state, "--shims and a lot's foils: bearings are drawn of one of them");
  if ((shims || lot) && !o->draw.count) o->draw.count = 1000;
  if (o->draw.shards && !o->draw.keep) argp_error(state, "--shard needs --keep FILE");
  if (o->draw.keep && !o->draw.count)
    argp_error(state, "--keep is of drawn bearings: --shims, or a lot");
  if (o->lift_off.u_rpm > 0 && isnan(o->lift_off.rpm))
    argp_error(state, "--u-lift-off is of --lift-off RPM");
  if (o->lift_off.u_load_n > 0 && isnan(o->lift_off.rpm))
    argp_error(state, "--u-load is of --lift-off RPM");
  if (run->outputs.path[OUT_ORBIT] && !o->orbit_turns)
    argp_error(state, "--orbit-out needs --orbit TURNS");
  if (isfinite(o->compliance) && o->model)
    argp_error(state, "--compliance states what --model would find: drop one");
}

/* The ranges tell other units: metres, pascals, bars. */
static const fg_cli_value values[] = {
    FG_CLI_NUMBER(OPTION_LOAD, film_run, options.load_n, 1e-6, 1e6),
    FG_CLI_NUMBER(OPTION_LOAD_ANGLE, film_run, options.load_deg, -720, 720),
    FG_CLI_NUMBER(OPTION_SPEED, film_run, options.speed_rpm, 1, 2e6),
    FG_CLI_NUMBER(OPTION_MASS, film_run, options.rotor_mass_kg, 1e-9, 1e5),
    FG_CLI_NUMBER(OPTION_LENGTH, film_run, options.length_mm, 0.1, 5000),
    FG_CLI_NUMBER(OPTION_CLEARANCE, film_run, options.clearance_um, 1, 5000),
    FG_CLI_NUMBER(OPTION_COMPLIANCE, film_run, options.compliance, 0, 1e6),
    FG_CLI_NUMBER(OPTION_LOSS, film_run, options.loss_factor, 0, 10),
    FG_CLI_NUMBER(OPTION_FRICTION, film_run, options.material.friction, 0, 10),
    FG_CLI_NUMBER(OPTION_MODULUS, film_run, options.material.youngs_modulus_gpa, 1, 1000),
    FG_CLI_NUMBER(OPTION_PITCH, film_run, options.pitch_deg, 1e-3, 360),
    FG_CLI_NUMBER(OPTION_TOP_FOIL, film_run, options.top_foil_mm, 1e-3, 10),
    FG_CLI_NUMBER(OPTION_VISCOSITY, film_run, options.viscosity_upa_s, 1, 1000),
    FG_CLI_NUMBER(OPTION_AMBIENT, film_run, options.ambient_kpa, 5, 50000),
    FG_CLI_NUMBER(OPTION_WITHIN, film_run, options.within_pct, 0.1, 100),
    FG_CLI_NUMBER(OPTION_LIFT_OFF, film_run, options.lift_off.rpm, 1, 2e6),
    FG_CLI_NUMBER(OPTION_U_LIFT_OFF, film_run, options.lift_off.u_rpm, 0, 2e6),
    FG_CLI_NUMBER(OPTION_U_LOAD, film_run, options.lift_off.u_load_n, 0, 1e6),
    FG_CLI_NUMBER(OPTION_TOUCHING, film_run, options.touching_um, 0, 1000),
    FG_CLI_NUMBER(OPTION_PADS, film_run, options.pads, 0, FG_BEARING_BUMPS_MAX),
    FG_CLI_NUMBER(OPTION_BUMPS, film_run, options.bumps_per_pad, 1, FG_BEARING_BUMPS_MAX),
    FG_CLI_NUMBER(OPTION_FIRST, film_run, options.first_bump, 1, 1000),
    FG_CLI_NUMBER(OPTION_DRAWS, film_run, options.draw.count, 1, 1e7),
    FG_CLI_NUMBER(OPTION_ORBIT, film_run, options.orbit_turns, 4, FG_FILM_TURNS_MAX),
    FG_CLI_NUMBER(OPTION_SEED, film_run, options.seed, 0, 9007199254740992.0),
    FG_CLI_NUMBER(OPTION_JOBS, film_run, options.jobs, 1, 4096),
    FG_CLI_VALUE('o', film_run, outputs.path[OUT_JSON]),
    FG_CLI_VALUE(OPTION_HTML, film_run, outputs.path[OUT_HTML]),
    FG_CLI_VALUE(OPTION_TEXT, film_run, outputs.path[OUT_TEXT]),
    FG_CLI_VALUE(OPTION_SPEEDS_OUT, film_run, outputs.path[OUT_SPEEDS]),
    FG_CLI_VALUE(OPTION_DRAWS_OUT, film_run, outputs.path[OUT_DRAWS]),
    FG_CLI_VALUE(OPTION_ORBIT_OUT, film_run, outputs.path[OUT_ORBIT]),
    FG_CLI_VALUE(OPTION_FOILS, film_run, options.foils),
    FG_CLI_VALUE(OPTION_BORE, film_run, options.bore),
    FG_CLI_VALUE(OPTION_KEEP, film_run, options.draw.keep),
    FG_CLI_VALUE(OPTION_MODEL, film_run, options.model),
    FG_CLI_VALUE(OPTION_SENSITIVITY, film_run, options.sensitivity),
    FG_CLI_VALUE(FG_CLI_DECIMAL_COMMA, film_run, outputs.decimal_comma),
    {0},
};

static error_t parse_film_option(int key, char *text, struct argp_state *state) {
  film_run *run = state->input;
  if (fg_cli_keep_value(values, key, text, state)) return 0;
  switch (key) {
  case OPTION_SHARD:
    take_film_shard(run, fg_cli_shard(state, text));
    return 0;
  case OPTION_TOP:
    run->options.top_foil = fg_cli_is_second(state, "top-foil", text, "stiff", "sagging")
                                ? FG_FILM_TOP_FOIL_SAGGING
                                : FG_FILM_TOP_FOIL_STIFF;
    return 0;
  case OPTION_SPEEDS:
    read_speeds(run, state, text);
    return 0;
  case OPTION_SHIMS:
    read_shims(run, state, text);
    return 0;
  case OPTION_MESH:
    read_mesh(run, state, text);
    return 0;
  case ARGP_KEY_ARG:
    if (run->design_path) argp_error(state, "one DESIGN at a time, not also '%s'", text);
    run->design_path = text;
    return 0;
  case ARGP_KEY_END:
    check_film_end(run, state);
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

static fg_status write_film_output(fg_context *ctx, void *user, size_t kind, FILE *out) {
  typedef fg_status writer(fg_context *, const fg_film_report *, FILE *);
  static writer *const writers[OUT_COUNT] = {
      [OUT_JSON] = fg_film_write_json,   [OUT_HTML] = fg_film_write_html,
      [OUT_TEXT] = fg_film_write_text,   [OUT_SPEEDS] = fg_film_write_speeds,
      [OUT_DRAWS] = fg_film_write_draws, [OUT_ORBIT] = fg_film_write_orbit,
  };
  const film_run *run = user;
  return writers[kind](ctx, &run->report, out);
}

static fg_status run_film(fg_context *ctx, film_run *run) {
  const fg_input inputs[] = {{run->design_path, "the design"},
                             {run->options.foils, "the foils"},
                             {run->options.bore, "the bore"}};
  fg_output_set_choose_standard(&run->outputs, OUT_JSON, OUT_TEXT, false);
  FG_TRY(fg_output_set_check(ctx, &run->outputs, inputs, sizeof inputs / sizeof *inputs));
  fg_design_default(&run->design);
  if (run->design_path) FG_TRY(fg_design_load(ctx, run->design_path, &run->design));
  FG_TRY(fg_output_set_open(ctx, &run->outputs));
  FG_TRY(fg_film_run(ctx, &run->design, &run->options, &run->report));
  return fg_output_set_write(ctx, &run->outputs, write_film_output, run);
}

const struct argp fg_film_parser = {options, parse_film_option, "[DESIGN]", doc,
                                    NULL,    fg_cli_fill,       NULL};

int fg_cmd_film(int argc, char **argv) {
  fg_context ctx = {0};
  film_run run = {.outputs.count = OUT_COUNT,
                  .outputs.csv = 1u << OUT_SPEEDS | 1u << OUT_DRAWS | 1u << OUT_ORBIT,
                  .options = fg_film_options_default()};
  fg_status status = fg_cli_parse(&ctx, &fg_film_parser, argc, argv, &run);
  if (status == FG_OK) status = run_film(&ctx, &run);
  int code = status == FG_OK ? fg_film_exit_code(&run.report) : fg_cli_fail(&ctx, status);
  fg_output_set_close(&run.outputs);
  fg_film_report_free(&run.report);
  return code;
}
