/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/stiffness/table.h"

#include <math.h>

#include "page/page.h"

fg_stiffness_case fg_stiffness_case_of(const fg_design *design, const fg_arch_material *material) {
  fg_stiffness_case bump = {.title = "as designed",
                            .name = "design",
                            .arch =
                                fg_design_arch(design, design->thickness_mm,
                                               design->bumps.radius_mm, design->bumps.angle_deg)};
  fg_stiffness_compare(&bump.arch, material, bump.lines);
  return bump;
}

void fg_json_sensitivity(fg_json *json, const char *name, const fg_arch_sensitivity *sensitivity) {
  fg_json_object(json, name);
  fg_json_line(json);
  fg_json_number(json, "radius", sensitivity->radius);
  fg_json_number(json, "angle", sensitivity->angle);
  fg_json_number(json, "radius_at_arc_length", sensitivity->radius_at_arc_length);
  fg_json_number(json, "thickness", sensitivity->thickness);
  fg_json_object_end(json);
  fg_json_line_end(json);
}

void fg_json_stiffness_model(fg_json *json, int model) {
  const fg_stiffness_model *row = &fg_stiffness_models()[model];
  fg_json_string(json, "id", row->id);
  fg_json_string(json, "formula", row->formula);
  fg_json_string(json, "source", row->source);
}

void fg_json_stiffness_case(fg_json *json, const fg_stiffness_case *bump, int model,
                            double pitch_mm) {
  const fg_stiffness_line *line = &bump->lines[model];
  fg_json_object(json, bump->name);
  fg_json_number(json, "stiffness_n_mm2", line->stiffness_n_mm2);
  fg_json_number(json, "per_area_n_mm3", line->stiffness_n_mm2 / pitch_mm);
  fg_json_number(json, "over_arch", line->stiffness_n_mm2 / bump->lines[0].stiffness_n_mm2);
  fg_json_sensitivity(json, "sensitivity", &line->sensitivity);
  fg_json_string(json, "reserve", *line->words ? line->words : NULL);
  fg_json_object_end(json);
}

static void put_stiffness_number(FILE *out, double value, int digits, bool sign) {
  if (isfinite(value))
    fprintf(out, "<td>%s%.*g</td>", value < 0 ? "−" : sign ? "+" : "", digits, fabs(value));
  else
    fputs("<td>–</td>", out);
}

static void put_slope(FILE *out, double value) {
  if (isfinite(value))
    fprintf(out, "<td>%s%.2f</td>", value < 0 ? "−" : "+", fabs(value));
  else
    fputs("<td>–</td>", out);
}

static void put_stiffness_row(FILE *out, const char *title, const fg_stiffness_case *bump,
                              int model, double pitch_mm) {
  const fg_stiffness_line *line = &bump->lines[model];
  const fg_arch_sensitivity *slope = &line->sensitivity;
  fprintf(out, "<tr><td>%s</td><td class=\"w\">%s</td>", title, bump->title);
  put_stiffness_number(out, line->stiffness_n_mm2, 4, false);
  put_stiffness_number(out, line->stiffness_n_mm2 / pitch_mm, 3, false);
  put_stiffness_number(out, line->stiffness_n_mm2 / bump->lines[0].stiffness_n_mm2, 3, false);
  put_slope(out, slope->radius);
  put_slope(out, slope->angle);
  put_slope(out, slope->radius_at_arc_length);
  put_slope(out, slope->thickness);
  fputs("</tr>\n", out);
}

static void put_sources(FILE *out, const fg_stiffness_case *bump) {
  fputs("<dl class=\"facts\" style=\"margin-top:14px\">\n", out);
  for (int i = 0; i < FG_STIFFNESS_MODELS; i++) {
    const fg_stiffness_model *model = &fg_stiffness_models()[i];
    fprintf(out, "<dt>%s</dt><dd>%s<br>%s.", model->title, model->formula, model->source);
    if (*bump->lines[i].words) {
      fputs("<br><b>", out);
      fg_html_text(out, bump->lines[i].words);
      fputs("</b>", out);
    }
    fputs("</dd>\n", out);
  }
  fputs("<dt>Iordanoff</dt><dd>", out);
  fg_html_text(out, fg_stiffness_absent_note());
  fputs("</dd>\n</dl>\n", out);
}

void fg_html_stiffness_table(FILE *out, const fg_stiffness_case *cases, size_t count,
                             double pitch_mm) {
  fputs("<div class=\"scroll\"><table><thead><tr><th rowspan=\"2\">model</th><th rowspan=\"2\" "
        "class=\"w\">bump</th><th rowspan=\"2\">K per mm<br>of width,<br>N/mm²</th><th "
        "rowspan=\"2\">per area,<br>N/mm³</th><th rowspan=\"2\">over<br>the arch</th><th "
        "colspan=\"4\" class=\"group\">% of stiffness per % "
        "of</th></tr>\n<tr><th>radius<br>alone</th><th>angle<br>"
        "alone</th><th>radius, arc<br>length kept</th><th>thickness</th></tr></thead>\n<tbody>\n",
        out);
  for (int model = 0; model < FG_STIFFNESS_MODELS; model++)
    for (size_t i = 0; i < count; i++)
      put_stiffness_row(out, i ? "" : fg_stiffness_models()[model].title, &cases[i], model,
                        pitch_mm);
  fputs("</tbody></table></div>\n", out);
  put_sources(out, &cases[count - 1]);
}

static void put_stiffness_text(FILE *out, int width, const char *format, double value)
    __attribute__((format(printf, 3, 0)));

static void put_stiffness_text(FILE *out, int width, const char *format, double value) {
  char number[32] = "-";
  if (isfinite(value)) snprintf(number, sizeof number, format, value);
  fprintf(out, " %*s", width, number);
}

void fg_text_stiffness_table(FILE *out, const fg_stiffness_case *bump, double pitch_mm) {
  fputs("\nstiffness of a bump, per mm of width; % per % of radius, angle, radius at constant arc "
        "length, thickness\n",
        out);
  fprintf(out, "  %-26s %10s %10s %8s %8s %8s %8s\n", "", "N/mm2", "N/mm3", "R", "alpha", "R, arc",
          "t");
  for (int i = 0; i < FG_STIFFNESS_MODELS; i++) {
    const fg_stiffness_line *line = &bump->lines[i];
    const fg_arch_sensitivity *slope = &line->sensitivity;
    const double slopes[] = {slope->radius, slope->angle, slope->radius_at_arc_length,
                             slope->thickness};
    fprintf(out, "  %-26s", fg_stiffness_models()[i].title);
    put_stiffness_text(out, 10, "%.4g", line->stiffness_n_mm2);
    put_stiffness_text(out, 10, "%.4g", line->stiffness_n_mm2 / pitch_mm);
    for (size_t k = 0; k < sizeof slopes / sizeof *slopes; k++)
      put_stiffness_text(out, 8, "%+.2f", slopes[k]);
    fputs("\n", out);
    if (*line->words) fprintf(out, "    %s\n", line->words);
  }
}
