/* Residual vectors on the measured edges of each scan, magnified, before and after. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/select.h"
#include "report/scan_loop/scan_loop_parts.h"

enum {
  WIDTH = 520,
  HEIGHT_MOST = 560,
  MARGIN = 44,
  FOOT = 40,
  NEEDLES_MOST = 420,
  RING_NEEDLES_MOST = 1100,
  NUMBERS_MOST = 40
};
enum { SCANS_DRAWN = 6 };
static const double needle_length = 44,
                    ring_needle_length = 16; /* of a large residual, in units of the drawing */

typedef struct vectors {
  FILE *out;
  const fg_points *points;
  const double *residual_um;
  size_t scan;
  bool rings;             /* nothing but discs: needles must stay inside and between them */
  double light;           /* weight that hardly counts */
  double longest;         /* needle of a large residual */
  size_t block;           /* rows in one needle */
  double low[2], high[2]; /* of the rows, mm */
  double scale;           /* units per mm */
  double unit_per_um;     /* of a needle */
} vectors;

double fg_scan_light(const fg_points *points) {
  double most = 0;
  for (size_t i = 0; i < points->row_count; i++)
    most = fmax(most, points->rows[i].weight);
  return 0.1 * most;
}

fg_status fg_scan_loop_residual_limit(fg_context *ctx, const fg_points *points,
                                      const double *values, double share, double *limit) {
  double *sizes = NULL;
  size_t count = 0;
  *limit = 0;
  if (!points->row_count) return FG_OK;
  double least = fg_scan_light(points);
  FG_TRY(fg_memory_allocate(ctx, points->row_count, sizeof *sizes, (void **)&sizes));
  for (size_t i = 0; i < points->row_count; i++)
    if (points->rows[i].weight > least && isfinite(values[i])) sizes[count++] = fabs(values[i]);
  if (count) *limit = fg_select(sizes, count, (size_t)((double)(count - 1) * (1 - share)));
  free(sizes);
  return FG_OK;
}

static bool is_shown(const vectors *v, size_t i) {
  return v->points->views[v->points->rows[i].view].scan == v->scan;
}

/* Neighbours on one arc: the next row starts another where a gap is wider than a few rows. */
static bool same_arc(const fg_points_row *a, const fg_points_row *b) {
  return a->view == b->view && a->group == b->group &&
         hypot(a->at.x - b->at.x, a->at.y - b->at.y) < 0.5;
}

static fg_point place(const vectors *v, fg_point mm) {
  return (fg_point){MARGIN + v->scale * (mm.x - v->low[0]), MARGIN + v->scale * (mm.y - v->low[1])};
}

static size_t arc_end(const vectors *v, size_t from) {
  const fg_points_row *rows = v->points->rows;
  size_t end = from + 1;
  while (end < v->points->row_count && same_arc(&rows[end - 1], &rows[end]))
    end++;
  return end;
}

static void put_strip(const vectors *v) {
  for (size_t k = 0; k < v->points->view_count; k++) {
    const fg_foil *foil = v->points->views[k].foil;
    if (v->points->views[k].scan != v->scan || !foil || !foil->strip.count) continue;
    size_t step = 1 + foil->strip.count / 900;
    fputs("<path class=\"strip\" d=\"", v->out);
    for (size_t i = 0; i < foil->strip.count; i += step) {
      const fg_station *s = &foil->strip.stations[i];
      fg_point p =
          place(v, (fg_point){0.5 * (s->left.x + s->right.x), 0.5 * (s->left.y + s->right.y)});
      fprintf(v->out, "%c%.1f %.1f", i ? 'L' : 'M', p.x, p.y);
    }
    fputs("\"/>\n", v->out);
  }
}

/* Mean of a block of rows: where it is, and the tip of its needle. Rows that hardly weigh have
 * none. */
static bool needle(const vectors *v, size_t from, size_t to, fg_point *base, fg_point *tip,
                   double *value) {
  fg_point at = {0, 0}, normal = {0, 0};
  double n = 0, sum = 0;
  for (size_t i = from; i < to; i++) {
    const fg_points_row *row = &v->points->rows[i];
    if (!(row->weight > 0) || !isfinite(v->residual_um[i])) continue;
    at.x += row->ideal.x;
    at.y += row->ideal.y;
    normal.x += row->normal.x;
    normal.y += row->normal.y;
    sum += v->residual_um[i];
    n++;
  }
  double length = hypot(normal.x, normal.y);
  if (!(n > 0) || !(length > 0)) return false;
  *value = sum / n;
  *base = place(v, (fg_point){at.x / n, at.y / n});
  if (v->points->rows[from].weight <= v->light) *value = 0;
  double reach = fmax(-1.6, fmin(1.6, *value * v->unit_per_um / v->longest)) * v->longest;
  *tip = (fg_point){base->x + reach * normal.x / length, base->y + reach * normal.y / length};
  return true;
}

typedef enum needle_part { NEEDLES_OUT, NEEDLES_IN, TIPS, BASES } needle_part;

static bool is_ring(const vectors *v, size_t from, size_t end) {
  fg_point a = v->points->rows[from].at, b = v->points->rows[end - 1].at;
  return end - from > 8 && hypot(a.x - b.x, a.y - b.y) < 0.5;
}

static void put_needles(const vectors *v, needle_part part) {
  static const char *const styles[] = {"outwards", "inwards", "tips", "bases"};
  fprintf(v->out, "<path class=\"%s\" d=\"", styles[part]);
  for (size_t i = 0, end; i < v->points->row_count; i = end) {
    end = arc_end(v, i);
    bool open = false;
    for (size_t k = i; k < end && is_shown(v, i); k += v->block) {
      fg_point base, tip;
      double value;
      if (!needle(v, k, k + v->block < end ? k + v->block : end, &base, &tip, &value)) continue;
      if (part == TIPS || part == BASES) {
        fg_point p = part == TIPS ? tip : base;
        fprintf(v->out, "%c%.1f %.1f", open ? 'L' : 'M', p.x, p.y);
        open = true;
      } else if (value != 0 && (value > 0) == (part == NEEDLES_OUT)) {
        fprintf(v->out, "M%.1f %.1fL%.1f %.1f", base.x, base.y, tip.x, tip.y);
      }
    }
    if (open && is_ring(v, i, end)) fputc('Z', v->out);
  }
  fputs("\"/>\n", v->out);
}

/* Numbers inside the bumps, away from the needles. */
static void put_numbers(const vectors *v) {
  const fg_points *points = v->points;
  size_t count = 0;
  for (size_t k = 0; k < points->view_count; k++)
    if (points->views[k].scan == v->scan) count += points->parts[points->views[k].part].bump_count;
  if (count > NUMBERS_MOST) return;
  for (size_t i = 0, end; i < points->row_count; i = end) {
    end = arc_end(v, i);
    const fg_points_row *row = &points->rows[i + (end - i) / 2];
    if (!row->bump || !is_shown(v, i)) continue;
    fg_point p = place(v, row->ideal);
    fprintf(v->out, "<text class=\"bump\" x=\"%.1f\" y=\"%.1f\">%d</text>\n",
            p.x - 22 * row->normal.x, p.y - 22 * row->normal.y + 5, row->bump);
  }
}

static void put_bar(const vectors *v, int height) {
  double um = fg_scan_loop_nice_below(88 / v->unit_per_um), length = um * v->unit_per_um;
  char words[32];
  fg_scan_loop_length_words(um, words, sizeof words);
  fprintf(v->out,
          "<path class=\"bar\" d=\"M%d %dh%.1f\"/><text class=\"start\" x=\"%.1f\" y=\"%d\">%s of "
          "residual, drawn %.0f times as large</text>\n",
          MARGIN, height - 18, length, MARGIN + length + 10, height - 13, words,
          1000 * v->unit_per_um / v->scale);
}

static double rms_of(const vectors *v) {
  double sum = 0, n = 0;
  for (size_t i = 0; i < v->points->row_count; i++)
    if (is_shown(v, i) && v->points->rows[i].weight > 0) {
      double weight = v->points->rows[i].weight;
      sum += weight * v->residual_um[i] * v->residual_um[i];
      n += weight;
    }
  return sqrt(sum / n);
}

static void put_figure(const vectors *v, const char *when) {
  int height = (int)(2 * MARGIN + v->scale * (v->high[1] - v->low[1])) + FOOT;
  char rms[32];
  fg_scan_loop_length_words(rms_of(v), rms, sizeof rms);
  fprintf(v->out,
          "<figure><figcaption><b>%s</b>: %s rms</figcaption><svg class=\"plot vectors\" "
          "viewBox=\"0 0 %d %d\" role=\"img\" "
          "aria-label=\"Residual vectors %s\">\n",
          when, rms, WIDTH, height, when);
  put_strip(v);
  for (int part = NEEDLES_OUT; part <= BASES; part++)
    put_needles(v, (needle_part)part);
  put_numbers(v);
  put_bar(v, height);
  fputs("</svg></figure>\n", v->out);
}

static void find_box(vectors *v) {
  size_t count = 0;
  for (int axis = 0; axis < 2; axis++) {
    v->low[axis] = INFINITY;
    v->high[axis] = -INFINITY;
  }
  for (size_t i = 0; i < v->points->row_count; i++) {
    const fg_points_row *row = &v->points->rows[i];
    if (!is_shown(v, i)) continue;
    count++;
    v->low[0] = fmin(v->low[0], row->at.x);
    v->low[1] = fmin(v->low[1], row->at.y);
    v->high[0] = fmax(v->high[0], row->at.x);
    v->high[1] = fmax(v->high[1], row->at.y);
  }
  v->block = 1 + count / (v->rings ? RING_NEEDLES_MOST : NEEDLES_MOST);
  v->scale = fmin((WIDTH - 2.0 * MARGIN) / (v->high[0] - v->low[0]),
                  (HEIGHT_MOST - 2.0 * MARGIN) / (v->high[1] - v->low[1]));
}

static void put_scan(const fg_scan_loop *loop, vectors *v) {
  if (loop->scan_count > 1) {
    fputs("<h3>", v->out);
    fg_html_text(v->out, loop->before[v->scan].scan);
    fputs(loop->hold_out[v->scan] ? " (kept aside: it only confirms)</h3>" : "</h3>", v->out);
  }
  fputs("<div class=\"two\">\n", v->out);
  v->residual_um = loop->residual_before;
  put_figure(v, loop->set.count ? "Before" : "As measured");
  if (loop->set.count) {
    v->residual_um = loop->residual_after;
    put_figure(v, "After");
  }
  fputs("</div>\n", v->out);
}

/* All drawings have one scale, so that they compare. */
static void put_scans(FILE *out, const fg_scan_loop *loop, double limit_um) {
  double scale = INFINITY;
  vectors v = {.out = out, .points = &loop->points, .rings = true};
  for (size_t k = 0; k < v.points->part_count; k++)
    if (v.points->parts[k].bump_count) v.rings = false;
  v.light = fg_scan_light(v.points);
  v.longest = v.rings ? ring_needle_length : needle_length;
  for (int drawn = 0; drawn < 2; drawn++)
    for (v.scan = 0; v.scan < loop->scan_count && v.scan < SCANS_DRAWN; v.scan++) {
      find_box(&v);
      if (!(v.high[0] > v.low[0]) || !(v.high[1] > v.low[1])) continue;
      scale = fmin(scale, v.scale);
      v.scale = scale;
      v.unit_per_um = fg_scan_loop_nice_below(1000 * v.longest / limit_um / scale) * scale / 1000;
      if (drawn) put_scan(loop, &v);
    }
}

fg_status fg_scan_loop_page_vectors(fg_context *ctx, FILE *out, const fg_scan_loop *loop) {
  double limit = 0;
  FG_TRY(fg_scan_loop_residual_limit(ctx, &loop->points, loop->residual_before, 0.01, &limit));
  if (!(limit > 0)) return FG_OK;
  fprintf(out,
          "<section><h2 class=\"first\">Where the edges leave their circles</h2>\n"
          "<p class=\"note\">Every arc, and how far the measured edges lie from %s: "
          "<span class=\"key outkey\">outside</span> or <span class=\"key inkey\">inside</span> of "
          "the circle. All drawings have one scale.</p>\n",
          loop->options.same_foil && loop->scan_count > 1
              ? "the one set of circles that was fitted to all scans of the foil"
              : "the circles that were fitted to them");
  put_scans(out, loop, limit);
  if (loop->scan_count > SCANS_DRAWN)
    fprintf(out, "<p class=\"note\">%zu more scans are not drawn.</p>\n",
            loop->scan_count - SCANS_DRAWN);
  fputs("</section>\n", out);
  return FG_OK;
}
