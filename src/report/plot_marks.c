#include "report/plot_marks.h"

#include <math.h>
#include <stdbool.h>

#include "report/measure/measure_page_parts.h"

void fg_plot_dot(const fg_plot *at, double x, double y, double radius, const char *style) {
  fprintf(at->out, "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.3g\"/>\n", style,
          fg_plot_x(at, x), fg_plot_y(at, y), radius);
}

/* Outlines in units of the radius, about the centre. */
static const char *const outlines[FG_SHAPES] = {
    [FG_SHAPE_CIRCLE] = "M-1 0a1 1 0 1 0 2 0a1 1 0 1 0-2 0z",
    [FG_SHAPE_SQUARE] = "M-.9-.9h1.8v1.8h-1.8z",
    [FG_SHAPE_TRIANGLE] = "M0-1.15l1.1 1.95h-2.2z",
    [FG_SHAPE_DIAMOND] = "M0-1.25l1.1 1.25l-1.1 1.25l-1.1-1.25z",
    [FG_SHAPE_CROSS] = "M-1-1l2 2m0-2l-2 2",
};

void fg_plot_shape_at(FILE *out, double x, double y, double radius, fg_shape shape,
                      const char *style) {
  fprintf(out,
          "<path class=\"mark %s\" vector-effect=\"non-scaling-stroke\" "
          "transform=\"translate(%.1f %.1f) scale(%.3g)\" d=\"%s\"/>\n",
          style, x, y, radius, outlines[shape]);
}

void fg_plot_shape(const fg_plot *at, double x, double y, double radius, fg_shape shape,
                   const char *style) {
  if (isfinite(x) && isfinite(y))
    fg_plot_shape_at(at->out, fg_plot_x(at, x), fg_plot_y(at, y), radius, shape, style);
}

void fg_plot_line(const fg_plot *at, const double *x, const double *y, size_t count,
                  const char *style) {
  bool open = false;
  fprintf(at->out, "<path class=\"%s\" d=\"", style);
  for (size_t i = 0; i < count; i++) {
    bool known = isfinite(x[i]) && isfinite(y[i]);
    if (known)
      fprintf(at->out, "%c%.1f %.1f", open ? 'L' : 'M', fg_plot_x(at, x[i]), fg_plot_y(at, y[i]));
    open = known;
  }
  fputs("\"/>\n", at->out);
}

void fg_plot_segment(const fg_plot *at, double x1, double y1, double x2, double y2,
                     const char *style) {
  fg_plot_line(at, (const double[]){x1, x2}, (const double[]){y1, y2}, 2, style);
}

void fg_plot_text(const fg_plot *at, double x, double y, const char *style, const char *text) {
  fprintf(at->out, "<text class=\"%s\" x=\"%.1f\" y=\"%.1f\">", style, fg_plot_x(at, x),
          fg_plot_y(at, y));
  fg_html_text(at->out, text);
  fputs("</text>\n", at->out);
}
