/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lot's page: bearings drawn from the foils. */
#include <math.h>
#include <stdlib.h>

#include "page/page.h"
#include "page/plot_frame.h"
#include "page/table.h"
#include "report/lot/page_parts.h"
#include "report/lot/parts_members.h"
#include "report/lot/plots.h"

enum { POINTS = 200, UM_PER_MM = 1000 };

typedef struct curve {
  fg_density density;
  bool there;
} curve;

static curve make_value_curve(const fg_assembly_result *result, size_t value) {
  curve c = {.there = false};
  fg_context unused;
  c.there = fg_density_fit(&unused, result->value[value], result->values[value],
                           FG_BANDWIDTH_SILVERMAN, &c.density) == FG_OK;
  return c;
}

static double find_height(const curve *c, double um) {
  return c->there ? fg_density_at(&c->density, um / UM_PER_MM) / UM_PER_MM : NAN;
}

static void find_value_range(const fg_assembly_result *result, size_t value, const curve *c,
                             double range[2]) {
  size_t count = result->values[value];
  if (!count) return;
  double room = c->there ? 2.5 * c->density.bandwidth : 1e-3;
  range[0] = fmin(range[0], UM_PER_MM * (result->value[value][0] - room));
  range[1] = fmax(range[1], UM_PER_MM * (result->value[value][count - 1] + room));
}

static void put_value_curve(const fg_plot *plot, const curve *c, const char *style) {
  double x[POINTS + 1], y[POINTS + 1];
  for (int i = 0; i <= POINTS; i++) {
    x[i] = plot->x_low + (plot->x_high - plot->x_low) * i / POINTS;
    y[i] = fmin(find_height(c, x[i]), plot->y_high);
  }
  if (c->there) fg_plot_line(plot, x, y, POINTS + 1, style);
}

static void put_value_limit(const fg_plot *plot, double um, const char *words) {
  if (!(um >= plot->x_low && um <= plot->x_high)) return;
  fg_plot_segment(plot, um, 0, um, plot->y_high, "limit");
  bool right = um > (plot->x_low + plot->x_high) / 2;
  fg_plot_text(plot, um + (right ? -0.01 : 0.01) * (plot->x_high - plot->x_low),
               0.93 * plot->y_high, right ? "end" : "key", words);
}

/* Limits are always in the picture. */
static void put_value_limits(const fg_plot *plot, const fg_assembly_plan *plan,
                             const fg_quantity *row) {
  for (size_t i = 0; i < plan->limits; i++) {
    const fg_assembly_limit *limit = &plan->limit[i];
    if (limit->row != row) continue;
    bool touch = limit->lower == 0 && !isfinite(limit->upper);
    put_value_limit(plot, UM_PER_MM * limit->lower, touch ? "touches" : "limit");
    put_value_limit(plot, UM_PER_MM * limit->upper, "limit");
  }
}

/* Fits the axes to both curves and to the limits of the quantity. */
static void fit_axes(const fg_lot_assembly *assembly, size_t value, curve *drawn, curve *design,
                     double x[2], double y[2]) {
  const fg_assembly_plan *plan = &assembly->plan;
  find_value_range(&assembly->drawn, value, drawn, x);
  find_value_range(&assembly->design, value, design, x);
  for (size_t i = 0; i < plan->limits; i++)
    if (plan->limit[i].row == fg_assembly_row(value)) {
      fg_range_add(x, UM_PER_MM * plan->limit[i].lower, 2);
      fg_range_add(x, UM_PER_MM * plan->limit[i].upper, 2);
    }
  for (int i = 0; i <= POINTS && drawn->there; i++)
    fg_range_add(y, 1.25 * find_height(drawn, x[0] + (x[1] - x[0]) * i / POINTS), 0);
}

void fg_lot_plot_assembly(FILE *out, const fg_lot_analysis *analysis, size_t value) {
  const fg_lot_assembly *assembly = &analysis->assembly;
  const fg_quantity *row = fg_assembly_row(value);
  curve drawn = make_value_curve(&assembly->drawn, value),
        design = make_value_curve(&assembly->design, value);
  double x[2] = {INFINITY, -INFINITY}, y[2] = {0, 0};
  char title[160];
  fit_axes(assembly, value, &drawn, &design, x, y);
  if (drawn.there && y[1] > 0) {
    snprintf(title, sizeof title, "%s, µm", row->words);
    fg_plot plot =
        fg_plot_frame_begin(out, &(fg_plot_frame){title, .height = 280, .left = 92, .x = x, .y = y,
                                                  .y_title = "density", .x_title = title});
    put_value_curve(&plot, &design, "hypothesis");
    put_value_curve(&plot, &drawn, "curve");
    put_value_limits(&plot, &assembly->plan, row);
    double middle = UM_PER_MM * assembly->design.quantile[value][FG_ASSEMBLY_QUANTILES / 2];
    bool right = middle > (plot.x_low + plot.x_high) / 2;
    if (design.there)
      fg_plot_text(&plot, middle + (right ? -0.03 : 0.03) * (plot.x_high - plot.x_low),
                   0.8 * plot.y_high, right ? "end" : "key", "at design");
    fg_plot_end(&plot);
  }
  if (drawn.there) fg_density_free(&drawn.density);
  if (design.there) fg_density_free(&design.density);
}

/* Line of the table of shares. */
typedef struct share_line {
  fg_assembly_share drawn; /* first: its members are columns */
  double design;
  const fg_assembly_limit *limit; /* NULL: all that are asked */
} share_line;

static void limit_words(const fg_assembly_limit *limit, char *text, size_t size) {
  bool low = isfinite(limit->lower), high = isfinite(limit->upper);
  int used = snprintf(text, size, "%s", limit->row->words);
  if (low && used > 0 && (size_t)used < size)
    used += snprintf(text + used, size - (size_t)used, " ≥ %.4g", UM_PER_MM * limit->lower);
  if (high && used > 0 && (size_t)used < size)
    used += snprintf(text + used, size - (size_t)used, "%s ≤ %.4g", low ? " and" : "",
                     UM_PER_MM * limit->upper);
  if (used > 0 && (size_t)used < size)
    snprintf(text + used, size - (size_t)used, " µm%s", limit->asked ? "" : " (told, not asked)");
}

static const char *find_share_words(const fg_subject *subject, char *buffer) {
  const share_line *line = subject->object;
  if (!line->limit) return "assemble: all that is asked";
  limit_words(line->limit, buffer, FG_MEMBER_TEXT_MAX);
  return buffer;
}

static const fg_member share_line_rows[] = {
    {FG_TEXT_BY("of", find_share_words),
     .page = {.rank = 1, .heading = "share of the bearings drawn, %", .words = true}},
    {FG_SAME(&fg_lot_assembly_share_members)},
    {FG_NUMBER("design", share_line, design),
     .page = {.rank = 3, .heading = "at design", .decimals = 1, .scale = 100}},
};

static const char *look_at_share_line(const fg_subject *element) {
  return ((const share_line *)element->object)->limit ? NULL : "on";
}

static const fg_members share_line_members =
    FG_MEMBERS_LOOKED_AT(share_line_rows, look_at_share_line);

static bool find_share_line(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_lot_analysis *analysis = list->whole;
  element->object = (const share_line *)list->object + i;
  return i <= analysis->assembly.plan.limits;
}

static void put_share_table(FILE *out, const fg_lot_analysis *analysis) {
  const fg_assembly_plan *plan = &analysis->assembly.plan;
  const fg_assembly_result *drawn = &analysis->assembly.drawn, *design = &analysis->assembly.design;
  share_line lines[FG_ASSEMBLY_LIMITS_MAX + 1] = {
      {drawn->assembled, design->assembled.share, NULL}};
  for (size_t i = 0; i < plan->limits; i++)
    lines[i + 1] = (share_line){drawn->within[i], design->within[i].share, &plan->limit[i]};
  fg_html_table(out, &share_line_members, &(fg_subject){.object = lines, .whole = analysis},
                find_share_line);
}

static void put_quantiles(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_assembly *assembly = &analysis->assembly;
  fputs("<div class=\"scroll\"><table><thead><tr><th>µm</th><th>bearings</th>", out);
  for (size_t k = 0; k < FG_ASSEMBLY_QUANTILES; k++)
    fprintf(out, "<th>%.0f %%</th>", 100 * fg_assembly_probability[k]);
  fputs("</tr></thead>\n<tbody>\n", out);
  for (size_t i = 0; i < FG_ASSEMBLY_VALUES; i++)
    for (int of_design = 0; of_design < 2; of_design++) {
      const fg_assembly_result *result = of_design ? &assembly->design : &assembly->drawn;
      if (!result->values[i]) continue;
      fprintf(out, "<tr><td class=\"words\">%s</td><td class=\"words\">%s</td>",
              of_design ? "" : fg_assembly_row(i)->words, of_design ? "at design" : "drawn");
      for (size_t k = 0; k < FG_ASSEMBLY_QUANTILES; k++) {
        fputs("<td>", out);
        fg_lot_put_number(out, round(10 * UM_PER_MM * result->quantile[i][k]) / 10, 4);
        fputs("</td>", out);
      }
      fputs("</tr>\n", out);
    }
  fputs("</tbody></table></div>\n", out);
}

static bool find_change(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_lot_assembly *assembly = list->object;
  element->object = &assembly->change[i];
  return i < assembly->changes;
}

static void put_change_table(FILE *out, const fg_lot_assembly *assembly) {
  if (assembly->changes)
    fg_html_table(out, &fg_lot_change_members, &(fg_subject){.object = assembly}, find_change);
}

static void put_left_out(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_assembly *assembly = &analysis->assembly;
  size_t left = analysis->foil_count - assembly->stock.foils;
  const char *separator = "";
  if (!left) return;
  fprintf(out, "<p class=\"note\">Not drawn from, %zu of %zu foils: ", left, analysis->foil_count);
  for (int why = FG_LOT_IN_STOCK + 1; why < FG_LOT_LEFT_OUT; why++) {
    if (!assembly->left_out[why]) continue;
    fprintf(out, "%s%s, %zu", separator, fg_lot_left_out_words((fg_lot_left_out)why),
            assembly->left_out[why]);
    separator = "; ";
  }
  fputs(". Which: lot.json.</p>\n", out);
}

static void put_meaning(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_assembly *assembly = &analysis->assembly;
  fprintf(
      out,
      "<p class=\"note\">A bearing takes %zu different foils, whole ones, which go back after it; "
      "seed %llu. By number of draws: what %zu draws leave open (Clopper and Pearson, %.3g %%). By "
      "number of foils: these are %zu of those that the process makes (the interval of as many "
      "independent bearings as these foils are worth, which foils drawn anew tell; where all "
      "bearings or none are within, as of %zu without a common foil). By measurement: "
      "value ± U inside the limit, and not outside. At design: every clearance anywhere within ± "
      "%.3g %% of the design&#39;s %.4g µm. A change is the same lot, drawn again.%s</p>\n",
      assembly->plan.layout.pads, (unsigned long long)assembly->plan.seed, assembly->plan.bearings,
      100 * assembly->plan.confidence, assembly->stock.foils,
      assembly->stock.foils / assembly->plan.layout.pads, assembly->deviation_pct,
      UM_PER_MM * assembly->clearance_mm,
      assembly->centred ? ""
                        : " The crowns leave half of the bearing open: the rotor has no place of "
                          "most room, and is asked to be free on the sleeve&#39;s axis.");
}

void fg_lot_put_assembly(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_assembly *assembly = &analysis->assembly;
  if (!assembly->asked) return;
  fputs("<section class=\"part\">\n<h1>How many bearings of this lot assemble</h1>\n<ul "
        "class=\"said\">\n",
        out);
  for (size_t i = 0; i < sizeof assembly->statement / sizeof *assembly->statement; i++) {
    if (!assembly->statement[i][0]) continue;
    fputs("<li>", out);
    fg_html_text(out, assembly->statement[i]);
    fputs("</li>\n", out);
  }
  fputs("</ul>\n", out);
  fprintf(out, "<p class=\"note\">%s</p>\n", fg_assembly_scope);
  put_left_out(out, analysis);
  if (!assembly->why[0]) {
    put_share_table(out, analysis);
    for (size_t i = 0; i < FG_ASSEMBLY_VALUES; i++) {
      if (!assembly->drawn.values[i]) continue;
      fputs("<figure>", out);
      fg_lot_plot_assembly(out, analysis, i);
      fputs("</figure>\n", out);
    }
    fputs("<p class=\"note\">Solid: the bearings drawn; dashed: at design; red: limits.</p>\n",
          out);
    put_change_table(out, assembly);
    put_quantiles(out, analysis);
    put_meaning(out, analysis);
  }
  fputs("</section>\n", out);
}
