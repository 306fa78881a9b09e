/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <argp.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/commands.h"
#include "cli/facts.h"
#include "cli/output_set.h"
#include "cli/values.h"
#include "foilgauge/design.h"
#include "foilgauge/design_report.h"
#include "foilgauge/stiffness.h"
#include "foilgauge/words.h"

typedef struct design_arguments {
  const char *design_path; /* NULL: built in */
  fg_output_set outputs;
  bool json, curve;
  fg_board_sheet sheet;
  fg_arch_material material;
} design_arguments;

enum {
  OPTION_JSON = 256,
  OPTION_CURVE,
  OPTION_HTML,
  OPTION_SVG,
  OPTION_SHEET,
  OPTION_MODULUS,
  OPTION_POISSON,
  OPTION_FRICTION
};

#define BOARD_PITCH_MM 5.0
#define A4_WIDTH_MM    210.0
#define A4_HEIGHT_MM   297.0

enum { OUT_DATA, OUT_HTML, OUT_SVG, OUTPUTS };

static const struct argp_option options[] = {
    {"json", OPTION_JSON, NULL, 0, "Write JSON (as -o does)", 0},
    {"curve", OPTION_CURVE, NULL, 0,
     "Write how the declared springback model changes the clearance, as CSV: bump radius error "
     "from "
     "-5 to +30 %",
     0},
    FG_CLI_DECIMAL_COMMA_ROW(0),
    {"html", OPTION_HTML, "FILE.html", 0,
     "One page to read and print, with the stiffness of a bump by three models and its map over "
     "radius and angle",
     0},
    {"svg", OPTION_SVG, "FILE.svg", 0, "Of form grid: a board to print, with its numbers, in mm",
     0},
    {"sheet", OPTION_SHEET, "WIDTHxHEIGHT", 0, "Of the board's sheet, mm (default: A4, 210x297)",
     0},
    {"youngs-modulus-gpa", OPTION_MODULUS, "E", 0,
     "Of the strip, for the stiffness (default: @youngs_modulus_gpa@)", 1},
    {"poisson-ratio", OPTION_POISSON, "NU", 0,
     "Of the strip, for the stiffness (default: @poisson_ratio@)", 1},
    {"friction", OPTION_FRICTION, "MU", 0, "Coulomb, of the bumps' feet (default: @friction@)", 1},
    {"output", 'o', "FILE", 0, "Write here (-: standard output)", 0},
    {0},
};

static const char doc[] =
    "Check a design and show what follows from it.\v"
    "DESIGN is a JSON file (\"schema\": \"foilgauge/design/1\"); without it the built-in Gen II "
    "foil is shown. The word `grid` alone is a board of dots of 5 mm pitch. Lengths belong to the "
    "design's datum line.\n\n"
    "The curve takes each bump radius through eq 5.6 and 5.7 (constant arc length, crown in place) "
    "to height and clearance. clearance_error is (C_D - C) / C_D (eq 5.9); clearance_change_pct is "
    "100 (C - C_D) / C_D, as the thesis plots it.\n\n"
    "Stiffness is per bump and mm of width (N/mm2), and over the pitch per area (N/mm3), by three "
    "models: the arch on sliding feet, Heshmat's formula and the link-spring. The page and the "
    "JSON "
    "say formula, source and what a model leaves out.\n\n"
    "@exit_done@";

static error_t parse_sheet(const char *text, fg_board_sheet *sheet, struct argp_state *state) {
  char *end, *after = NULL;
  sheet->width_mm = strtod(text, &end);
  if (end != text && *end == 'x') sheet->height_mm = strtod(end + 1, &after);
  bool whole = after && after != end + 1 && !*after;
  if (!whole || !(sheet->width_mm >= 10 && sheet->width_mm <= 2000) ||
      !(sheet->height_mm >= 10 && sheet->height_mm <= 2000))
    argp_error(state, "--sheet %s: it must be two numbers from 10 to 2000, like 210x297", text);
  return 0;
}

/* The bounds of the material are those of a recipe. */
static const fg_cli_value values[] = {
    FG_CLI_VALUE('o', design_arguments, outputs.path[OUT_DATA]),
    FG_CLI_VALUE(OPTION_JSON, design_arguments, json),
    FG_CLI_VALUE(OPTION_CURVE, design_arguments, curve),
    FG_CLI_VALUE(OPTION_HTML, design_arguments, outputs.path[OUT_HTML]),
    FG_CLI_VALUE(OPTION_SVG, design_arguments, outputs.path[OUT_SVG]),
    FG_CLI_NUMBER(OPTION_MODULUS, design_arguments, material.youngs_modulus_gpa, 1e-3, 1e4),
    FG_CLI_NUMBER(OPTION_POISSON, design_arguments, material.poisson_ratio, 0, 0.499),
    FG_CLI_NUMBER(OPTION_FRICTION, design_arguments, material.friction, 0, 10),
    FG_CLI_VALUE(FG_CLI_DECIMAL_COMMA, design_arguments, outputs.decimal_comma),
    {0},
};

static error_t parse_design_option(int key, char *text, struct argp_state *state) {
  design_arguments *arguments = state->input;
  if (fg_cli_keep_value(values, key, text, state)) return 0;
  switch (key) {
  case OPTION_SHEET:
    return parse_sheet(text, &arguments->sheet, state);
  case ARGP_KEY_ARG:
    if (arguments->design_path) argp_error(state, "one DESIGN at a time, not also '%s'", text);
    arguments->design_path = text;
    break;
  case ARGP_KEY_END:
    if (arguments->json && arguments->curve) argp_error(state, "--curve is CSV; drop --json");
    break;
  default:
    return ARGP_ERR_UNKNOWN;
  }
  return 0;
}

typedef struct design_view {
  const design_arguments *arguments;
  fg_design design;
  fg_nominal nominal;
} design_view;

static fg_status write_view(fg_context *ctx, void *user, size_t kind, FILE *out) {
  const design_view *view = user;
  const fg_design_report report = {&view->design, &view->nominal, &view->arguments->material,
                                   view->arguments->design_path};
  if (kind == OUT_HTML) return fg_design_write_html(ctx, &report, out);
  if (kind == OUT_SVG)
    return fg_design_write_board(ctx, &view->design, &view->arguments->sheet, out);
  if (view->arguments->curve) return fg_design_write_curve(ctx, &report, out);
  return view->arguments->json ? fg_design_write_json(ctx, &report, out)
                               : fg_design_write_table(ctx, &report, out);
}

/* The design of a path, or of the word `grid` where no such file is. */
static fg_status load_shown_design(fg_context *ctx, const design_arguments *arguments,
                                   fg_design *design) {
  const char *path = arguments->design_path;
  fg_design_default(design);
  if (!path) return FG_OK;
  if (strcmp(path, "grid") != 0 || access(path, F_OK) == 0)
    return fg_design_load(ctx, path, design);
  FG_TRY(fg_design_become(ctx, FG_FOIL_GRID, design));
  snprintf(design->name, sizeof design->name, "board");
  design->grid.pitch_mm = BOARD_PITCH_MM;
  return FG_OK;
}

static fg_status show_design(fg_context *ctx, design_arguments *arguments) {
  design_view view = {.arguments = arguments};
  const fg_input input = {arguments->design_path, "the design"};
  if (arguments->outputs.path[OUT_DATA])
    arguments->json = true;
  else if (arguments->json || arguments->curve || !fg_output_set_has_standard(&arguments->outputs))
    arguments->outputs.path[OUT_DATA] = "-";
  FG_TRY(fg_output_set_check(ctx, &arguments->outputs, &input, 1));
  FG_TRY(load_shown_design(ctx, arguments, &view.design));
  FG_TRY(fg_design_derive(ctx, &view.design, &view.nominal));
  if (arguments->curve && !fg_foil_kind_has_bumps(view.design.kind))
    return fg_fail(ctx, FG_ERR_DATA, "%s: form \"%s\" has no bumps, so there is no curve",
                   arguments->design_path, fg_foil_kind_word(view.design.kind));
  if (arguments->outputs.path[OUT_HTML] && !fg_foil_kind_has_bumps(view.design.kind))
    return fg_fail(ctx, FG_ERR_DATA, "%s: form \"%s\" has no bumps, so there is no page of them",
                   arguments->design_path, fg_foil_kind_word(view.design.kind));
  if (arguments->curve) arguments->outputs.csv = 1u << OUT_DATA;
  FG_TRY(fg_output_set_open(ctx, &arguments->outputs));
  return fg_output_set_write(ctx, &arguments->outputs, write_view, &view);
}

const struct argp fg_design_parser = {options, parse_design_option, "[DESIGN]", doc,
                                      NULL,    fg_cli_fill,         NULL};

int fg_cmd_design(int argc, char **argv) {
  fg_context ctx = {0};
  design_arguments arguments = {.outputs.count = OUTPUTS,
                                .sheet = {A4_WIDTH_MM, A4_HEIGHT_MM},
                                .material = fg_arch_material_default()};
  fg_status parsed = fg_cli_parse(&ctx, &fg_design_parser, argc, argv, &arguments);
  if (parsed != FG_OK) return fg_cli_fail(&ctx, parsed);
  fg_status status = show_design(&ctx, &arguments);
  fg_output_set_close(&arguments.outputs);
  return status == FG_OK ? 0 : fg_cli_fail(&ctx, status);
}
