#include "report/plot_marks.h"

#include <math.h>
#include <stdbool.h>

#include "report/measure/measure_page_parts.h"

void fg_plot_dot(const fg_plot *at, double x, double y, double radius, const char *style) {
  fprintf(at->out, "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.3g\"/>\n", style,
          fg_plot_x(at, x), fg_plot_y(at, y), radius);
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
