/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A design for the terminal, and its curve of springback as CSV. */
#include <math.h>

#include "core/file.h"
#include "foilgauge/cantilever.h"
#include "foilgauge/design_report.h"
#include "foilgauge/words.h"
#include "report/design/beam_deviations.h"
#include "report/design/parts.h"
#include "report/measure/foil_view.h"
#include "report/stiffness/table.h"

void fg_design_put_row(FILE *out, const char *words, const char *symbol, double value,
                       const char *unit) {
  fprintf(out, "  %-34s %-9s %12.6f %s\n", words, symbol, value, unit);
}

/* Knowledge beside the design, as of the strip that was made. */
void fg_design_put_known(const fg_design *design, FILE *out) {
  if (design->thickness_measured_mm > 0) {
    fg_design_put_row(out, "thickness as measured", "t", design->thickness_measured_mm, "mm");
    fg_design_put_row(out, "its standard uncertainty", "u(t)", design->u_thickness_measured_mm,
                      "mm");
  }
  if (design->tone == FG_TONE_LINEAR) fputs("  tone of the scanner: linear, as stated\n", out);
}

static void write_stated(const fg_design *design, FILE *out) {
  fg_design_put_row(out, "bump radius", "R_D", design->bumps.radius_mm, "mm");
  fg_design_put_row(out, "bump angle", "alpha_D", design->bumps.angle_deg, "deg");
  fg_design_put_row(out, "overall radius", "R0", design->overall_radius_mm, "mm");
  fg_design_put_row(out, "sleeve radius", "R_sleeve", design->bumps.sleeve_radius_mm, "mm");
  fg_design_put_row(out, "pitch", "", design->bumps.pitch_deg, "deg");
  fg_design_put_row(out, "fillet radius", "", design->bumps.fillet_radius_mm, "mm");
  fg_design_put_row(out, "thickness", "t", design->thickness_mm, "mm");
  if (design->bumps.top_foil_thickness_mm > 0)
    fg_design_put_row(out, "top foil thickness", "", design->bumps.top_foil_thickness_mm, "mm");
  fg_design_put_row(out, "rotor diameter", "D", design->bumps.rotor_diameter_mm, "mm");
  fg_design_put_known(design, out);
}

static void write_derived(const fg_nominal *nominal, FILE *out) {
  fg_design_put_row(out, "bump centre to overall centre", "X_D", nominal->centre_to_centre_mm,
                    "mm");
  fg_design_put_row(out, "half chord (eq 5.2)", "l0", nominal->half_chord_mm, "mm");
  fg_design_put_row(out, "arc length of a bump", "", nominal->arc_length_mm, "mm");
  fg_design_put_row(out, "intersection angle", "theta_D", nominal->intersection_angle_deg, "deg");
  fg_design_put_row(out, "bump height (eq 5.5)", "h_D", nominal->height_mm, "mm");
  fg_design_put_row(out, "die height (eq 5.1)", "h_b", nominal->die_height_mm, "mm");
  fg_design_put_row(out, "clearance (eq 5.8)", "C_D", nominal->clearance_mm, "mm");
}

static void write_beam(const fg_design *design, FILE *out) {
  fg_design_put_row(out, "beam length", "L", design->beams.length_mm, "mm");
  fg_design_put_row(out, "beam width", "w", design->beams.width_mm, "mm");
  fg_design_put_row(out, "thickness", "t", design->thickness_mm, "mm");
  if (design->beams.u_thickness_mm > 0)
    fg_design_put_row(out, "its standard uncertainty", "u(t)", design->beams.u_thickness_mm, "mm");
  if (design->beams.sagitta_mm > 0)
    fg_design_put_row(out, "sagitta, as bent", "sag", design->beams.sagitta_mm, "mm");
  if (design->beams.clearance_mm > 0)
    fg_design_put_row(out, "clearance", "C", design->beams.clearance_mm, "mm");
  if (design->beams.elastic_modulus_gpa > 0)
    fg_design_put_row(out, "elastic modulus", "E", design->beams.elastic_modulus_gpa, "GPa");
}

/* Writes one line; sagitta and clearance that are not known are left out of it. */
static void write_deviating(const fg_design *design, double length_pct, double width_pct,
                            FILE *out) {
  const fg_cantilever beam = fg_cantilever_deviating(design, length_pct, width_pct);
  fprintf(out, "  L %+.2f %%, w %+.2f %%: compliance %+.2f %%, sagitta %+.2f %%", length_pct,
          width_pct, beam.compliance_error_pct, beam.sagitta_error_pct);
  if (isfinite(beam.clearance_change_mm))
    fprintf(out, ", clearance %+.4f mm", beam.clearance_change_mm);
  if (isfinite(beam.clearance_change_pct)) fprintf(out, " (%+.1f %%)", beam.clearance_change_pct);
  fputc('\n', out);
}

void fg_design_table_of_beams(const fg_design_report *report, FILE *out) {
  const fg_design *design = report->design;
  const fg_cantilever beam = fg_cantilever_nominal(design);
  if (design->beams.count) fprintf(out, ", %zu beams", design->beams.count);
  fputs("\n\nstated\n", out);
  write_beam(design, out);
  fputs("\nderived\n", out);
  fg_design_put_row(out, "second moment w t^3 / 12", "I", fg_cantilever_second_moment_mm4(design),
                    "mm4");
  if (isfinite(beam.compliance_mm_per_n))
    fg_design_put_row(out, "compliance L^3 / (3 E I), eq 5.10", "S", beam.compliance_mm_per_n,
                      "mm/N");
  if (design->beams.elastic_modulus_gpa > 0 && design->beams.u_thickness_mm > 0)
    fg_design_put_row(out, "its u by that of the thickness", "u(S)", beam.u_compliance_mm_per_n,
                      "mm/N");
  fputs("\nwhat a deviation of the beams does; the last two are the thesis's\n", out);
  for (size_t i = 0; i < FG_BEAM_DEVIATIONS; i++)
    write_deviating(design, fg_beam_deviations_pct[i][0], fg_beam_deviations_pct[i][1], out);
}

static void write_tolerances(const fg_design *design, FILE *out) {
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

static void write_calibration(const fg_calibration *c, FILE *out) {
  fputs("\ncalibration\n", out);
  if (!c->stated) {
    if (c->not_needed[0])
      fprintf(out, "  not needed: %s\n", c->not_needed);
    else
      fputs("  none is stated: U of what is measured holds statistics only, and no value is held "
            "against a limit\n",
            out);
    return;
  }
  const fg_calibration_budget terms = fg_calibration_terms(c);
  const double k = 100 * FG_COVERAGE_FACTOR;
  if (c->certificate[0] || c->date[0])
    fprintf(out, "  %s%s%s\n", c->certificate, c->certificate[0] && c->date[0] ? " of " : "",
            c->date);
  if (c->scale_by_model)
    fputs("  scale                               that of the scanner's model\n", out);
  else
    fprintf(out, "  scale, U = 2 u                      x %.3g %%, y %.3g %%%s\n",
            k * terms.scale[0], k * terms.scale[1], c->per_axis ? "" : " (one error of both)");
  if (c->has_temperature) {
    fprintf(out, "  scanned at                          %g C, U %.3g K: %.3g %% of a length\n",
            c->temperature_c, FG_COVERAGE_FACTOR * c->u_temperature_k, k * terms.temperature);
    fprintf(out, "  expansion                           %.4g 1/K, U %.2g: %.3g %% of a length\n",
            c->expansion_per_k, FG_COVERAGE_FACTOR * c->u_expansion_per_k, k * terms.expansion);
    fprintf(out, "  a length at 20 C over one scanned   %.7f\n", fg_calibration_factor(c));
  } else {
    fputs("  the part is taken to be at 20 C\n", out);
  }
  fprintf(out, "  together, of a length               x %.3g %%, y %.3g %%\n", k * terms.length[0],
          k * terms.length[1]);
}

void fg_design_table_of_grid(const fg_design_report *report, FILE *out) {
  const fg_design_grid *grid = &report->design->grid;
  fprintf(out, "\n  grid of %s\n", fg_mark_kind_word(grid->marks));
  if (grid->pitch_mm > 0) fg_design_put_row(out, "pitch", "", grid->pitch_mm, "mm");
}

void fg_design_table_of_discs(const fg_design_report *report, FILE *out) {
  const fg_design *design = report->design;
  fprintf(out, "\n  %zu known diameters\n", design->discs.count);
  for (size_t i = 0; i < design->discs.count; i++)
    fg_design_put_row(out, "diameter", "", design->discs.diameters_mm[i], "mm");
}

void fg_design_table_of_bumps(const fg_design_report *report, FILE *out) {
  const fg_design *design = report->design;
  const fg_stiffness_of_design stiffness = fg_stiffness_find_of_design(design, report->material);
  fprintf(out, ", datum %s", fg_datum_word(design->datum));
  if (design->bumps.count) fprintf(out, ", %zu bumps", design->bumps.count);
  fputs("\n\nstated\n", out);
  write_stated(design, out);
  fputs("\nderived\n", out);
  write_derived(report->nominal, out);
  fg_text_stiffness_table(out, &stiffness.bump);
}

fg_status fg_design_write_table(fg_context *ctx, const fg_design_report *report, FILE *out) {
  const fg_design *design = report->design;
  fprintf(out, "design %s, form %s", design->name, fg_foil_kind_word(design->kind));
  fg_foil_view_of(design->kind)->design_table(report, out);
  write_tolerances(design, out);
  write_calibration(&design->calibration, out);
  return fg_stream_finish(ctx, out, "the design");
}

enum { CURVE_FROM_PCT = -5, CURVE_TO_PCT = 30 };

fg_status fg_design_write_curve(fg_context *ctx, const fg_design_report *report, FILE *out) {
  const fg_design *design = report->design;
  double nominal_mm = report->nominal->clearance_mm;
  if (!fg_foil_kind_has_bumps(design->kind))
    return fg_fail(ctx, FG_ERR_DATA, "form \"%s\" has no bumps, so there is no curve",
                   fg_foil_kind_word(design->kind));
  fputs("radius_error_pct,radius_mm,bump_angle_model_deg,height_model_mm,clearance_mm,"
        "clearance_error,clearance_change_pct\n",
        out);
  for (int percent = CURVE_FROM_PCT; percent <= CURVE_TO_PCT; percent++) {
    fg_springback model;
    double radius_mm = design->bumps.radius_mm * (100 + percent) / 100;
    fg_design_springback(design, report->nominal, radius_mm, &model);
    fprintf(out, "%d,%.6f,%.6f,%.6f,%.6f,%.6f,%.4f\n", percent, radius_mm, model.bump_angle_deg,
            model.height_mm, model.clearance_mm, (nominal_mm - model.clearance_mm) / nominal_mm,
            100 * (model.clearance_mm - nominal_mm) / nominal_mm);
  }
  return fg_stream_finish(ctx, out, "the curve");
}
