#include "report/design/design_page.h"

#include <math.h>

#include "report/measure/measure_page_parts.h"

void fg_design_page_fill(const fg_design *design, const fg_nominal *nominal,
                         const fg_arch_material *material, fg_design_page *page) {
  *page = (fg_design_page){.design = design, .nominal = nominal, .material = material};
  page->bump =
      (fg_stiffness_case){.title = "as designed",
                          .name = "design",
                          .arch = fg_design_arch(design, design->thickness_mm,
                                                 design->bump_radius_mm, design->bump_angle_deg)};
  fg_stiffness_compare(&page->bump.arch, material, page->bump.lines);
}

static void write_material(fg_json *json, const fg_arch_material *material) {
  fg_json_object(json, "material");
  fg_json_line(json);
  fg_json_number(json, "youngs_modulus_gpa", material->youngs_modulus_gpa);
  fg_json_number(json, "poisson_ratio", material->poisson_ratio);
  fg_json_number(json, "friction", material->friction);
  fg_json_object_end(json);
  fg_json_line_end(json);
}

void fg_json_design_stiffness(fg_json *json, const fg_design_page *page) {
  const fg_stiffness_map map = fg_stiffness_map_around(page->design, page->material);
  double pitch_mm = fg_design_pitch_mm(page->design);
  fg_json_object(json, "stiffness");
  write_material(json, page->material);
  fg_json_number(json, "pitch_mm", pitch_mm);
  fg_json_string(json, "note", fg_stiffness_form_note(page->design->form));
  fg_json_array(json, "models");
  for (int i = 0; i < FG_STIFFNESS_MODELS; i++) {
    fg_json_object(json, NULL);
    fg_json_stiffness_model(json, i);
    fg_json_stiffness_case(json, &page->bump, i, pitch_mm);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
  fg_json_stiffness_map(json, "map", &map);
  fg_json_object_end(json);
}

static void put_tile(FILE *out, const char *title, double value, const char *unit,
                     const char *where) {
  fprintf(out, "<div><dt>%s</dt><dd>%s%.5g %s<small>%s</small></dd></div>\n", title,
          value < 0 ? "−" : "", fabs(value), unit, where);
}

static void put_tiles(FILE *out, const fg_design_page *page) {
  const fg_design *design = page->design;
  fputs("<dl class=\"tiles\">\n", out);
  put_tile(out, "bump radius", design->bump_radius_mm, "mm", "R<sub>D</sub>, stated");
  put_tile(out, "bump angle", design->bump_angle_deg, "°", "α<sub>D</sub>, stated");
  put_tile(out, "overall radius", design->overall_radius_mm, "mm", "stated");
  put_tile(out, "thickness", design->thickness_mm, "mm", "stated");
  put_tile(out, "bump height", page->nominal->height_mm, "mm", "h<sub>D</sub>, eq 5.5");
  put_tile(out, "arc length of a bump", page->nominal->arc_length_mm, "mm",
           "α<sub>D</sub> R<sub>D</sub>");
  put_tile(out, "intersection angle", page->nominal->intersection_angle_deg, "°", "θ<sub>D</sub>");
  put_tile(out, "clearance", 1000 * page->nominal->clearance_mm, "µm", "C<sub>D</sub>, eq 5.8");
  fputs("</dl>\n", out);
}

void fg_html_design_page(FILE *out, const fg_design_page *page) {
  const fg_stiffness_map map = fg_stiffness_map_around(page->design, page->material);
  const char *note = fg_stiffness_form_note(page->design->form);
  double along = page->bump.lines[0].sensitivity.radius_at_arc_length;
  fg_html_begin(out, page->design->name);
  fputs("<section>\n<header><h1>Design ", out);
  fg_html_text(out, page->design->name);
  fputs("</h1></header>\n", out);
  put_tiles(out, page);
  fputs("<h2>Stiffness of a bump</h2>\n", out);
  if (note) fprintf(out, "<p>%s</p>\n", note);
  fg_html_stiffness_table(out, &page->bump, 1, fg_design_pitch_mm(page->design));
  fprintf(
      out,
      "<p class=\"note\">E %.4g GPa, Poisson's ratio %.3g, friction %.3g; pitch s %.4g mm along "
      "the sleeve. A percent more thickness is worth three of stiffness in every model.</p>\n",
      page->material->youngs_modulus_gpa, page->material->poisson_ratio, page->material->friction,
      fg_design_pitch_mm(page->design));
  fputs("</section>\n<section>\n<h1>What springback does to it</h1>\n<figure>", out);
  fg_stiffness_plot_map(out, &map, NULL, NULL);
  fputs("<figcaption>Stiffness of the arch over the design's: orange stiffer, blue softer; dashed: "
        "as designed. The thick orange line is springback at constant arc length",
        out);
  if (isfinite(along))
    fprintf(out, ", along which a percent of radius is worth %s%.2g&nbsp;%% of stiffness at first",
            along < 0 ? "−" : "+", fabs(along));
  fputs(".</figcaption></figure>\n</section>\n", out);
  fg_html_end(out);
}
