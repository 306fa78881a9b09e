/* The picture's grid, and where its points really lie. */
#include <math.h>
#include <string.h>

#include "report/scan_loop/scan_loop_parts.h"

enum { WIDTH = 520, MARGIN = 34, LINES_MOST = 140, SAMPLES = 60 };

typedef struct deformation {
  FILE *out;
  const fg_field_list *fields;
  double scale;     /* units of the drawing per mm */
  double magnified; /* how much larger displacements are drawn */
} deformation;

static double largest(const fg_field_list *fields) {
  const fg_field_frame *f = &fields->frame;
  double size = 0;
  for (int i = 0; i <= SAMPLES; i++)
    for (int k = 0; k <= SAMPLES; k++) {
      fg_point at = {f->low_mm[0] + (f->high_mm[0] - f->low_mm[0]) * i / SAMPLES,
                     f->low_mm[1] + (f->high_mm[1] - f->low_mm[1]) * k / SAMPLES};
      fg_point d = fg_field_at(fields, at);
      size = fmax(size, hypot(d.x, d.y));
    }
  return size;
}

/* How far a point may be drawn off its place: within its cell, and without a ripple's lines passing
 * each other. */
static double reach(const fg_scan_loop *loop, double cell) {
  double most = 0.6 * cell;
  for (size_t e = 0; e < loop->set.count; e++)
    if (loop->set.effects[e].kind->numbers == FG_EFFECT_WAVE)
      most = fmin(most, 0.13 * loop->set.effects[e].shape[0]);
  return most;
}

/* Lines of a grid one cell apart; a ripple needs several lines in each period to be seen. */
static int lines_along(const fg_scan_loop *loop, int axis, double range, double cell) {
  double lines = range / cell;
  for (size_t e = 0; axis == 1 && e < loop->set.count; e++)
    if (loop->set.effects[e].kind->numbers == FG_EFFECT_WAVE)
      lines = fmax(lines, 6 * range / loop->set.effects[e].shape[0]);
  return (int)fmin(LINES_MOST, fmax(4, ceil(lines)));
}

static void put_line(const deformation *d, int axis, double across, const char *style,
                     double magnified) {
  const fg_field_frame *f = &d->fields->frame;
  int along = 1 - axis, samples = magnified > 0 ? SAMPLES : 1;
  fprintf(d->out, "<path class=\"%s\" d=\"", style);
  for (int i = 0; i <= samples; i++) {
    double at[2];
    at[axis] = across;
    at[along] = f->low_mm[along] + (f->high_mm[along] - f->low_mm[along]) * i / samples;
    fg_point move = fg_field_at(d->fields, (fg_point){at[0], at[1]});
    fprintf(d->out, "%c%.1f %.1f", i ? 'L' : 'M',
            MARGIN + d->scale * (at[0] - f->low_mm[0] + magnified * move.x),
            MARGIN + d->scale * (at[1] - f->low_mm[1] + magnified * move.y));
  }
  fputs("\"/>\n", d->out);
}

static void put_lines(const deformation *d, const fg_scan_loop *loop, double cell) {
  const fg_field_frame *f = &d->fields->frame;
  for (int moved = 0; moved < 2; moved++)
    for (int axis = 0; axis < 2; axis++) {
      double range = f->high_mm[axis] - f->low_mm[axis];
      int count = lines_along(loop, axis, range, cell);
      for (int i = 0; i <= count; i++)
        put_line(d, axis, f->low_mm[axis] + range * i / count, moved ? "moved" : "still",
                 moved ? d->magnified : 0);
    }
}

static void put_foils(const deformation *d, const fg_points *points) {
  const fg_field_frame *f = &d->fields->frame;
  fputs("<path class=\"dots\" d=\"", d->out);
  for (size_t i = 0; i < points->row_count; i += 1 + points->row_count / 800)
    fprintf(d->out, "M%.0f %.0fh0", MARGIN + d->scale * (points->rows[i].at.x - f->low_mm[0]),
            MARGIN + d->scale * (points->rows[i].at.y - f->low_mm[1]));
  fputs("\"/>\n", d->out);
}

void fg_scan_loop_page_grid(FILE *out, const fg_scan_loop *loop) {
  fg_field_list fields;
  fg_effect_set_fields(&loop->points, &loop->set, &fields);
  const fg_field_frame *f = &fields.frame;
  double width = f->high_mm[0] - f->low_mm[0], height = f->high_mm[1] - f->low_mm[1];
  double size = largest(&fields), cell = fmax(width, height) / 14;
  if (!(size > 0) || !(width > 0) || !(height > 0)) return;
  deformation d = {out, &fields, (WIDTH - 2.0 * MARGIN) / fmax(width, height), 0};
  d.magnified = fg_scan_loop_nice_below(reach(loop, cell) / size);
  double bar = fg_scan_loop_nice_below(1.5 * cell * 1000 / d.magnified);
  int tall = (int)(2 * MARGIN + d.scale * height + 34);
  char words[32];
  fprintf(out,
          "<figure><svg class=\"plot\" viewBox=\"0 0 %d %d\" role=\"img\" aria-label=\"The grid of "
          "the picture, and where its points really lie\">\n",
          WIDTH, tall);
  put_lines(&d, loop, cell);
  put_foils(&d, &loop->points);
  fg_scan_loop_length_words(bar, words, sizeof words);
  fprintf(out,
          "<path class=\"bar\" d=\"M%d %dh%.1f\"/><text class=\"start\" x=\"%.1f\" "
          "y=\"%d\">%s of displacement, drawn %.4g times as large</text></svg>",
          MARGIN, tall - 16, d.scale * d.magnified * bar / 1000,
          MARGIN + d.scale * d.magnified * bar / 1000 + 10, tall - 11, words, d.magnified);
  fprintf(out,
          "<figcaption>Grey: a grid on the picture, %.3g by %.3g mm. Orange: where its points "
          "really lie. Dots: the edges that were measured.</figcaption></figure>\n",
          width, height);
}
