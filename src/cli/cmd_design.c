#include <argp.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "cli/commands.h"
#include "cli/facts.h"
#include "cli/output_set.h"
#include "foilgauge/design.h"
#include "foilgauge/report.h"
#include "report/design/design_page.h"
#include "report/measure/measure_json.h"
#include "report/words.h"

typedef struct design_arguments {
  const char *design_path; /* NULL: built in */
  fg_output_set outputs;
  bool json, curve;
  fg_arch_material material;
} design_arguments;

enum {
  OPTION_JSON = 256,
  OPTION_CURVE,
  OPTION_HTML,
  OPTION_MODULUS,
  OPTION_POISSON,
  OPTION_FRICTION
};

enum { OUT_DATA, OUT_HTML, OUTPUTS };

static const struct argp_option options[] = {
    {"json", OPTION_JSON, NULL, 0, "Write JSON (as -o does)", 0},
    {"curve", OPTION_CURVE, NULL, 0,
     "Write how the declared springback model changes the clearance, as CSV: bump radius error "
     "from "
     "-5 to +30 %",
     0},
    {"html", OPTION_HTML, "FILE.html", 0,
     "One page to read and print, with the stiffness of a bump by three models and its map over "
     "radius and angle",
     0},
    {"youngs-modulus-gpa", OPTION_MODULUS, "E", 0,
     "Of the strip, for the stiffness (default: @youngs_modulus_gpa@)", 1},
    {"poisson-ratio", OPTION_POISSON, "NU", 0, "Likewise (default: @poisson_ratio@)", 1},
    {"friction", OPTION_FRICTION, "MU", 0, "Coulomb, of the bumps' feet (default: @friction@)", 1},
    {"output", 'o', "FILE", 0, "Write here (-: standard output)", 0},
    {0},
};

static const char doc[] =
    "Check a design and show what follows from it.\v"
    "DESIGN is a JSON file (\"schema\": \"foilgauge/design/1\"); without it the built-in Gen II "
    "foil is shown. Lengths belong to the design's datum line.\n\n"
    "The curve takes each bump radius through eq 5.6 and 5.7 (constant arc length, crown in place) "
    "to height and clearance. clearance_error is (C_D - C) / C_D (eq 5.9); clearance_change_pct is "
    "100 (C - C_D) / C_D, as the thesis plots it.\n\n"
    "Stiffness is per bump and mm of width (N/mm2), and over the pitch per area (N/mm3), by three "
    "models: the arch on sliding feet, Heshmat's formula and the link-spring. The page and the "
    "JSON "
    "say formula, source and what a model leaves out.\n\n"
    "@exit_done@";

static error_t parse_number(const char *name, const char *text, double low, double high,
                            double *value, struct argp_state *state) {
  char *end;
  *value = strtod(text, &end);
  if (end == text || *end || !(*value >= low && *value <= high))
    argp_error(state, "--%s %s: it must be a number from %g to %g", name, text, low, high);
  return 0;
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  design_arguments *arguments = state->input;
  switch (key) {
  case 'o':
    arguments->outputs.path[OUT_DATA] = text;
    break;
  case OPTION_JSON:
    arguments->json = true;
    break;
  case OPTION_CURVE:
    arguments->curve = true;
    break;
  case OPTION_HTML:
    arguments->outputs.path[OUT_HTML] = text;
    break;
  /* The bounds are those of a recipe. */
  case OPTION_MODULUS:
    return parse_number("youngs-modulus-gpa", text, 1e-3, 1e4,
                        &arguments->material.youngs_modulus_gpa, state);
  case OPTION_POISSON:
    return parse_number("poisson-ratio", text, 0, 0.499, &arguments->material.poisson_ratio, state);
  case OPTION_FRICTION:
    return parse_number("friction", text, 0, 10, &arguments->material.friction, state);
  case ARGP_KEY_ARG:
    if (arguments->design_path) argp_error(state, "more than one DESIGN: %s", text);
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
  fg_design_page page; /* of a form with bumps */
} design_view;

static void write_json(const design_view *view, FILE *out) {
  const fg_design *design = &view->design;
  fg_json json;
  fg_json_begin(&json, out);
  fg_json_object(&json, NULL);
  fg_json_head(&json, "foilgauge/nominal/1");
  fg_json_design(&json, "design", design);
  if (fg_form_has_bumps(design->form)) fg_json_nominal(&json, "nominal", &view->nominal);
  if (fg_form_has_bumps(design->form)) fg_json_design_stiffness(&json, &view->page);
  if (design->form == FG_FORM_ARC) {
    fg_json_object(&json, "nominal");
    fg_json_number(&json, "arc_length_mm", view->nominal.arc_length_mm);
    fg_json_object_end(&json);
  }
  fg_json_object_end(&json);
  fg_json_end(&json);
}

static void write_row(FILE *out, const char *words, const char *symbol, double value,
                      const char *unit) {
  fprintf(out, "  %-34s %-9s %12.6f %s\n", words, symbol, value, unit);
}

static void write_stated(const fg_design *design, FILE *out) {
  write_row(out, "bump radius", "R_D", design->bump_radius_mm, "mm");
  write_row(out, "bump angle", "alpha_D", design->bump_angle_deg, "deg");
  write_row(out, "overall radius", "R0", design->overall_radius_mm, "mm");
  write_row(out, "sleeve radius", "R_sleeve", design->sleeve_radius_mm, "mm");
  write_row(out, "pitch", "", design->pitch_deg, "deg");
  write_row(out, "fillet radius", "", design->fillet_radius_mm, "mm");
  write_row(out, "thickness", "t", design->thickness_mm, "mm");
  if (design->top_foil_thickness_mm > 0)
    write_row(out, "top foil thickness", "", design->top_foil_thickness_mm, "mm");
  write_row(out, "rotor diameter", "D", design->rotor_diameter_mm, "mm");
}

static void write_derived(const fg_nominal *nominal, FILE *out) {
  write_row(out, "bump centre to overall centre", "X_D", nominal->centre_to_centre_mm, "mm");
  write_row(out, "half chord (eq 5.2)", "l0", nominal->half_chord_mm, "mm");
  write_row(out, "arc length of a bump", "", nominal->arc_length_mm, "mm");
  write_row(out, "intersection angle", "theta_D", nominal->intersection_angle_deg, "deg");
  write_row(out, "bump height (eq 5.5)", "h_D", nominal->height_mm, "mm");
  write_row(out, "die height (eq 5.1)", "h_b", nominal->die_height_mm, "mm");
  write_row(out, "clearance (eq 5.8)", "C_D", nominal->clearance_mm, "mm");
}

static void write_arc(const fg_design *design, const fg_nominal *nominal, FILE *out) {
  fprintf(out, ", datum %s\n\nstated\n", fg_datum_word(design->datum));
  write_row(out, "overall radius", "R0", design->overall_radius_mm, "mm");
  write_row(out, "subtended angle", "", design->subtended_angle_deg, "deg");
  write_row(out, "thickness", "t", design->thickness_mm, "mm");
  fputs("\nderived\n", out);
  write_row(out, "arc length", "", nominal->arc_length_mm, "mm");
}

static void write_table(const design_view *view, FILE *out) {
  const fg_design *design = &view->design;
  fprintf(out, "design %s, form %s", design->name, fg_form_word(design->form));
  if (design->form == FG_FORM_DISCS) {
    fprintf(out, "\n  %zu known diameters\n", design->diameter_count);
    for (size_t i = 0; i < design->diameter_count; i++)
      write_row(out, "diameter", "", design->diameters_mm[i], "mm");
  } else if (design->form == FG_FORM_ARC) {
    write_arc(design, &view->nominal, out);
  } else {
    fprintf(out, ", datum %s", fg_datum_word(design->datum));
    if (design->bump_count) fprintf(out, ", %zu bumps", design->bump_count);
    fputs("\n\nstated\n", out);
    write_stated(design, out);
    fputs("\nderived\n", out);
    write_derived(&view->nominal, out);
  }
  if (fg_form_has_bumps(design->form))
    fg_text_stiffness_table(out, &view->page.bump, fg_design_pitch_mm(design));
  for (size_t i = 0; i < design->tolerance_count; i++) {
    const fg_tolerance *t = &design->tolerances[i];
    fprintf(out, "%s  %-34s ", i ? "" : "\ntolerances\n", t->quantity);
    if (isinf(t->lower))
      fprintf(out, "at most %g\n", t->upper);
    else if (isinf(t->upper))
      fprintf(out, "at least %g\n", t->lower);
    else
      fprintf(out, "from %g to %g\n", t->lower, t->upper);
  }
}

enum { CURVE_FROM_PCT = -5, CURVE_TO_PCT = 30 };

static void write_curve(const fg_design *design, const fg_nominal *nominal, FILE *out) {
  double nominal_mm = nominal->clearance_mm;
  fputs("radius_error_pct,radius_mm,bump_angle_model_deg,height_model_mm,clearance_mm,"
        "clearance_error,clearance_change_pct\n",
        out);
  for (int percent = CURVE_FROM_PCT; percent <= CURVE_TO_PCT; percent++) {
    fg_springback model;
    double radius_mm = design->bump_radius_mm * (100 + percent) / 100;
    fg_design_springback(design, nominal, radius_mm, &model);
    fprintf(out, "%d,%.6f,%.6f,%.6f,%.6f,%.6f,%.4f\n", percent, radius_mm, model.bump_angle_deg,
            model.height_mm, model.clearance_mm, (nominal_mm - model.clearance_mm) / nominal_mm,
            100 * (model.clearance_mm - nominal_mm) / nominal_mm);
  }
}

static fg_status write_view(fg_context *ctx, void *user, size_t kind, FILE *out) {
  const design_view *view = user;
  (void)ctx;
  if (kind == OUT_HTML)
    fg_html_design_page(out, &view->page);
  else if (view->arguments->curve)
    write_curve(&view->design, &view->nominal, out);
  else if (view->arguments->json)
    write_json(view, out);
  else
    write_table(view, out);
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
  fg_design_default(&view.design);
  if (arguments->design_path) FG_TRY(fg_design_load(ctx, arguments->design_path, &view.design));
  FG_TRY(fg_design_derive(ctx, &view.design, &view.nominal));
  if (arguments->curve && !fg_form_has_bumps(view.design.form))
    return fg_fail(ctx, FG_ERR_DATA, "%s: form \"%s\" has no bumps, so there is no curve",
                   arguments->design_path, fg_form_word(view.design.form));
  if (fg_form_has_bumps(view.design.form))
    fg_design_page_fill(&view.design, &view.nominal, &arguments->material, &view.page);
  else if (arguments->outputs.path[OUT_HTML])
    return fg_fail(ctx, FG_ERR_DATA, "%s: form \"%s\" has no bumps, so there is no page of them",
                   arguments->design_path, fg_form_word(view.design.form));
  FG_TRY(fg_output_set_open(ctx, &arguments->outputs));
  return fg_output_set_write(ctx, &arguments->outputs, write_view, &view);
}

const struct argp fg_design_parser = {options, parse_option, "[DESIGN]", doc,
                                      NULL,    fg_cli_fill,  NULL};

int fg_cmd_design(int argc, char **argv) {
  fg_context ctx = {0};
  design_arguments arguments = {.outputs.count = OUTPUTS, .material = fg_arch_material_default()};
  fg_status parsed = fg_cli_parse(&ctx, &fg_design_parser, argc, argv, &arguments);
  if (parsed != FG_OK) return fg_cli_fail(&ctx, parsed);
  fg_status status = show_design(&ctx, &arguments);
  fg_output_set_close(&arguments.outputs);
  return status == FG_OK ? 0 : fg_cli_fail(&ctx, status);
}
