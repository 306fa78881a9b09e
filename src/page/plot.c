/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "page/plot.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "page/page.h"

enum { TICKS_WANTED = 5 };
/* Width from which on a plot's letters would be too small on a telephone. */
enum { BROAD = 700 };

double fg_plot_x(const fg_plot *at, double x) {
  return at->left + (x - at->x_low) / (at->x_high - at->x_low) * (at->right - at->left);
}

double fg_plot_y(const fg_plot *at, double y) {
  return at->bottom - (y - at->y_low) / (at->y_high - at->y_low) * (at->bottom - at->top);
}

double fg_plot_inside(const fg_plot *plot, double y) {
  return fmin(plot->y_high, fmax(plot->y_low, y));
}

double fg_plot_nice_step(double span) {
  double raw = span / TICKS_WANTED, power = pow(10, floor(log10(raw))), share = raw / power;
  return power * (share < 1.5 ? 1 : share < 3.5 ? 2 : share < 7.5 ? 5 : 10);
}

void fg_plot_begin(const fg_plot *at, int height, const char *label) {
  fprintf(at->out, "<svg class=\"plot\"%s viewBox=\"0 0 %d %d\" role=\"img\" aria-label=\"",
          at->width >= BROAD ? " data-broad" : "", at->width, height);
  fg_html_text(at->out, label);
  fputs("\">\n", at->out);
}

void fg_plot_end(const fg_plot *at) {
  fputs("</svg>\n", at->out);
}

/* Decimals are those that neighbouring ticks need to differ, the same for all: 20.7299, 20.7300. */
static void size_text(char text[32], double value, double step) {
  enum { MIN_DIGITS = 4, MAX_DIGITS = 9, DECIMALS_MAX = 6 };
  double size = fabs(value), decimals = fmax(0, ceil(-log10(step) - 1e-9));
  if (decimals <= DECIMALS_MAX && size < 1e6) {
    snprintf(text, 32, "%.*f", (int)decimals, size < step * 1e-6 ? 0 : value);
    return;
  }
  double clean = size < step * 1e-6 ? 0 : value;
  int digits = clean != 0 ? (int)ceil(log10(size / step * (1 + 1e-9))) + 1 : MIN_DIGITS;
  digits = digits < MIN_DIGITS ? MIN_DIGITS : digits > MAX_DIGITS ? MAX_DIGITS : digits;
  snprintf(text, 32, "%.*g", digits, clean);
}

static void tick_text(char text[40], double value, double step) {
  char size[32];
  bool negative = value < 0 && fabs(value) >= step * 1e-6;
  size_text(size, fabs(value), step);
  snprintf(text, 40, "%s%s", negative ? "−" : "", size);
}

/* Returns the ticks' letter size in px, smaller where the longest would reach into the title; 0:
 * the style's size. */
static double tick_size(const fg_plot *at, double step) {
  const double wide_px = 8.9, size_px = 14,
               title_px = 22; /* of a digit of that size; of the title */
  size_t longest = 1;
  for (double y = ceil(at->y_low / step) * step; y <= at->y_high + step * 1e-6; y += step) {
    char number[40];
    tick_text(number, y, step);
    size_t letters = strlen(number) - (y < 0 ? strlen("−") - 1 : 0);
    if (letters > longest && letters < sizeof number) longest = letters;
  }
  double room = at->left - 8 - title_px, share = room / (wide_px * (double)longest);
  return share < 1 ? fmax(9, size_px * share) : 0;
}

void fg_plot_y_axis(const fg_plot *at, const char *title) {
  double step = fg_plot_nice_step(at->y_high - at->y_low), size_px = tick_size(at, step);
  char size[40] = "";
  if (size_px > 0) snprintf(size, sizeof size, " style=\"font-size:%.1fpx\"", size_px);
  for (double y = ceil(at->y_low / step) * step; y <= at->y_high + step * 1e-6; y += step) {
    char number[40];
    double clean = fabs(y) < step * 1e-6 ? 0 : y;
    tick_text(number, clean, step);
    fprintf(at->out,
            "<path class=\"%s\" d=\"M%.1f %.1fH%.1f\"/><text class=\"y\"%s x=\"%.1f\" "
            "y=\"%.1f\">%s</text>\n",
            clean == 0 ? "zero" : "grid", at->left, fg_plot_y(at, clean), at->right, size,
            at->left - 8, fg_plot_y(at, clean) + 5, number);
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

void fg_plot_x_number(const fg_plot *plot, int number) {
  char text[16];
  snprintf(text, sizeof text, "%d", number);
  fg_plot_x_label(plot, fg_plot_x(plot, number), text);
}

static void put_x_numbers(const fg_plot *at, double step) {
  char text[40];
  for (double x = ceil(at->x_low / step) * step; x <= at->x_high + step * 1e-6; x += step) {
    tick_text(text, x, step);
    fg_plot_x_label(at, fg_plot_x(at, x), text);
  }
}

void fg_plot_x_numbers(const fg_plot *at) {
  put_x_numbers(at, fg_plot_nice_step(at->x_high - at->x_low));
}

void fg_plot_x_counts(const fg_plot *at) {
  put_x_numbers(at, fmax(1, fg_plot_nice_step(at->x_high - at->x_low)));
}

void fg_plot_x_title(const fg_plot *at, const char *title) {
  fprintf(at->out, "<text class=\"title\" x=\"%.1f\" y=\"%.1f\">", (at->left + at->right) / 2,
          at->bottom + 40);
  fg_html_text(at->out, title);
  fputs("</text>\n", at->out);
}
