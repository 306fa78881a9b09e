#include "report/plot.h"

#include <math.h>

#include "report/measure/measure_page_parts.h"

enum { TICKS_WANTED = 5 };

double fg_plot_x(const fg_plot *at, double x) {
  return at->left + (x - at->x_low) / (at->x_high - at->x_low) * (at->right - at->left);
}

double fg_plot_y(const fg_plot *at, double y) {
  return at->bottom - (y - at->y_low) / (at->y_high - at->y_low) * (at->bottom - at->top);
}

double fg_plot_nice_step(double span) {
  double raw = span / TICKS_WANTED, power = pow(10, floor(log10(raw))), share = raw / power;
  return power * (share < 1.5 ? 1 : share < 3.5 ? 2 : share < 7.5 ? 5 : 10);
}

void fg_plot_begin(const fg_plot *at, int height, const char *label) {
  fprintf(at->out, "<svg class=\"plot\" viewBox=\"0 0 %d %d\" role=\"img\" aria-label=\"",
          at->width, height);
  fg_html_text(at->out, label);
  fputs("\">\n", at->out);
}

void fg_plot_end(const fg_plot *at) {
  fputs("</svg>\n", at->out);
}

void fg_plot_y_axis(const fg_plot *at, const char *title) {
  double step = fg_plot_nice_step(at->y_high - at->y_low);
  for (double y = ceil(at->y_low / step) * step; y <= at->y_high + step * 1e-6; y += step) {
    double clean = fabs(y) < step * 1e-6 ? 0 : y;
    fprintf(at->out,
            "<path class=\"%s\" d=\"M%.1f %.1fH%.1f\"/><text class=\"y\" x=\"%.1f\" "
            "y=\"%.1f\">%.4g</text>\n",
            clean == 0 ? "zero" : "grid", at->left, fg_plot_y(at, clean), at->right, at->left - 8,
            fg_plot_y(at, clean) + 5, clean);
  }
  fprintf(at->out, "<text class=\"title\" transform=\"translate(16 %.1f) rotate(-90)\">",
          (at->top + at->bottom) / 2);
  fg_html_text(at->out, title);
  fputs("</text>\n", at->out);
}

void fg_plot_x_label(const fg_plot *at, double x, const char *text) {
  fprintf(at->out, "<text class=\"x\" x=\"%.1f\" y=\"%.1f\">", x, at->bottom + 20);
  fg_html_text(at->out, text);
  fputs("</text>\n", at->out);
}

void fg_plot_x_numbers(const fg_plot *at) {
  double step = fg_plot_nice_step(at->x_high - at->x_low);
  char text[32];
  for (double x = ceil(at->x_low / step) * step; x <= at->x_high + step * 1e-6; x += step) {
    snprintf(text, sizeof text, "%.4g", fabs(x) < step * 1e-6 ? 0 : x);
    fg_plot_x_label(at, fg_plot_x(at, x), text);
  }
}

void fg_plot_x_title(const fg_plot *at, const char *title) {
  fprintf(at->out, "<text class=\"title\" x=\"%.1f\" y=\"%.1f\">", (at->left + at->right) / 2,
          at->bottom + 40);
  fg_html_text(at->out, title);
  fputs("</text>\n", at->out);
}
