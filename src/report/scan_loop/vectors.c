/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Residual vectors on the measured edges of each scan, magnified, before and after. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/select.h"
#include "report/scan_loop/parts.h"

enum {
  WIDTH = 520,
  HEIGHT_MAX = 560,
  MARGIN = 44,
  NEEDLES_MAX = 420,
  RING_NEEDLES_MAX = 1100,
  NUMBERS_MAX = 40
};
enum { SCANS_DRAWN = 6 };
/* Maximum length of the scale's bar, in units of the drawing. */
static const double bar_max = 88;
/* Maximum length of noise in the drawing: a scan without effects must look calm. */
static const double noise_length = 2;
static const double needle_length = 44,
                    ring_needle_length = 16; /* of a large residual, in units of the drawing */

typedef struct vectors {
  FILE *out;
  const fg_scan_result *result;
  size_t scan;
  bool after;
  bool rings;             /* nothing but discs: needles must stay inside and between them */
  double longest;         /* needle of a large residual */
  size_t block;           /* rows in one needle */
  double low[2], high[2]; /* of the rows, mm */
  double scale;           /* units per mm */
  double unit_per_um;     /* of a needle */
  size_t drawings;
} vectors;

fg_status fg_scan_loop_residual_limit(fg_context *ctx, const fg_scan_result *result, bool after,
                                      double share, double *limit) {
  double *sizes = NULL;
  size_t count = 0;
  *limit = 0;
  if (!result->rows) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, result->rows, sizeof *sizes, (void **)&sizes));
  for (size_t i = 0; i < result->rows; i++) {
    double value = result->row[i].residual_um[after];
    if (result->row[i].weight > result->light_weight && isfinite(value))
      sizes[count++] = fabs(value);
  }
  if (count) *limit = fg_select(sizes, count, (size_t)((double)(count - 1) * (1 - share)));
  free(sizes);
  return FG_OK;
}

static bool is_row_shown(const vectors *v, size_t i) {
  return v->result->row[i].scan == v->scan;
}

static fg_point place_in_drawing(const vectors *v, fg_point mm) {
  return (fg_point){MARGIN + v->scale * (mm.x - v->low[0]), MARGIN + v->scale * (mm.y - v->low[1])};
}

static size_t arc_end(const vectors *v, size_t from) {
  const fg_scan_result_row *row = v->result->row;
  size_t end = from + 1;
  while (end < v->result->rows && row[end].arc == row[from].arc)
    end++;
  return end;
}

static void put_strip(const vectors *v) {
  for (size_t k = 0; k < v->result->views; k++) {
    const fg_foil *foil = v->result->view[k].foil;
    if (v->result->view[k].scan != v->scan || !foil || !foil->strip.count) continue;
    size_t step = 1 + foil->strip.count / 900;
    fputs("<path class=\"strip\" d=\"", v->out);
    for (size_t i = 0; i < foil->strip.count; i += step) {
      const fg_station *s = &foil->strip.stations[i];
      fg_point p = place_in_drawing(
          v, (fg_point){0.5 * (s->left.x + s->right.x), 0.5 * (s->left.y + s->right.y)});
      fprintf(v->out, "%c%.1f %.1f", i ? 'L' : 'M', p.x, p.y);
    }
    fputs("\"/>\n", v->out);
  }
}

/* Computes the mean of a block of rows: its place, and the tip of its needle. Rows of small weight
 * have none. */
static bool needle(const vectors *v, size_t from, size_t to, fg_point *base, fg_point *tip,
                   double *value) {
  fg_point at = {0, 0}, normal = {0, 0};
  double n = 0, sum = 0;
  for (size_t i = from; i < to; i++) {
    const fg_scan_result_row *row = &v->result->row[i];
    if (!(row->weight > 0) || !isfinite(row->residual_um[v->after])) continue;
    at.x += row->ideal_mm.x;
    at.y += row->ideal_mm.y;
    normal.x += row->normal.x;
    normal.y += row->normal.y;
    sum += row->residual_um[v->after];
    n++;
  }
  double length = hypot(normal.x, normal.y);
  if (!(n > 0) || !(length > 0)) return false;
  *value = sum / n;
  *base = place_in_drawing(v, (fg_point){at.x / n, at.y / n});
  if (v->result->row[from].weight <= v->result->light_weight) *value = 0;
  double reach = fmax(-1.6, fmin(1.6, *value * v->unit_per_um / v->longest)) * v->longest;
  *tip = (fg_point){base->x + reach * normal.x / length, base->y + reach * normal.y / length};
  return true;
}

typedef enum needle_part { NEEDLES_OUT, NEEDLES_IN, TIPS, BASES } needle_part;

static bool is_ring(const vectors *v, size_t from, size_t end) {
  fg_point a = v->result->row[from].at_mm, b = v->result->row[end - 1].at_mm;
  return end - from > 8 && hypot(a.x - b.x, a.y - b.y) < 0.5;
}

static void put_needles(const vectors *v, needle_part part) {
  static const char *const styles[] = {"outwards", "inwards", "tips", "bases"};
  fprintf(v->out, "<path class=\"%s\" d=\"", styles[part]);
  for (size_t i = 0, end; i < v->result->rows; i = end) {
    end = arc_end(v, i);
    bool open = false;
    for (size_t k = i; k < end && is_row_shown(v, i); k += v->block) {
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

/* Returns the end of a bump's rows, over the gaps that lost edges leave in its arc. */
static size_t bump_end(const vectors *v, size_t from) {
  const fg_scan_result_row *row = v->result->row;
  size_t end = arc_end(v, from);
  while (row[from].bump && end < v->result->rows && row[end].bump == row[from].bump &&
         row[end].scan == row[from].scan)
    end = arc_end(v, end);
  return end;
}

/* Numbers inside the bumps, away from the needles. */
static void put_bump_numbers(const vectors *v) {
  const fg_scan_result *result = v->result;
  size_t count = 0;
  for (size_t k = 0; k < result->views; k++)
    if (result->view[k].scan == v->scan) count += result->view[k].bumps;
  if (count > NUMBERS_MAX) return;
  for (size_t i = 0, end; i < result->rows; i = end) {
    end = bump_end(v, i);
    const fg_scan_result_row *row = &result->row[i + (end - i) / 2];
    if (!row->bump || !is_row_shown(v, i)) continue;
    fg_point p = place_in_drawing(v, row->ideal_mm);
    fprintf(v->out, "<text class=\"bump\" x=\"%.1f\" y=\"%.1f\">%d</text>\n",
            p.x - 22 * row->normal.x, p.y - 22 * row->normal.y + 5, row->bump);
  }
}

/* Writes the scale of all drawings, once. */
static void put_scale(const vectors *v) {
  double um = fg_scan_loop_nice_below(bar_max / v->unit_per_um), length = um * v->unit_per_um;
  char words[32];
  fg_scan_loop_length_words(um, words, sizeof words);
  fprintf(v->out,
          "<div class=\"scroll\"><svg class=\"plot scale\" viewBox=\"0 0 1060 24\" role=\"img\" "
          "aria-label=\"The scale\">"
          "<path class=\"bar\" d=\"M%d 12h%.1f\"/><text class=\"start\" x=\"%.1f\" y=\"17\">%s of "
          "residual, drawn %.0f times as large%s</text></svg></div>\n",
          MARGIN, length, MARGIN + length + 10, words, 1000 * v->unit_per_um / v->scale,
          v->drawings > 1 ? ", in every drawing" : "");
}

static double rms_of(const vectors *v) {
  double sum = 0, n = 0;
  for (size_t i = 0; i < v->result->rows; i++) {
    const fg_scan_result_row *row = &v->result->row[i];
    if (!is_row_shown(v, i) || !(row->weight > 0)) continue;
    sum += row->weight * row->residual_um[v->after] * row->residual_um[v->after];
    n += row->weight;
  }
  return sqrt(sum / n);
}

static void put_figure(const vectors *v, const char *when) {
  int height = (int)(2 * MARGIN + v->scale * (v->high[1] - v->low[1]));
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
  put_bump_numbers(v);
  fputs("</svg></figure>\n", v->out);
}

static void find_box(vectors *v) {
  size_t count = 0;
  for (int axis = 0; axis < 2; axis++) {
    v->low[axis] = INFINITY;
    v->high[axis] = -INFINITY;
  }
  for (size_t i = 0; i < v->result->rows; i++) {
    const fg_scan_result_row *row = &v->result->row[i];
    if (!is_row_shown(v, i)) continue;
    count++;
    v->low[0] = fmin(v->low[0], row->at_mm.x);
    v->low[1] = fmin(v->low[1], row->at_mm.y);
    v->high[0] = fmax(v->high[0], row->at_mm.x);
    v->high[1] = fmax(v->high[1], row->at_mm.y);
  }
  v->block = 1 + count / (v->rings ? RING_NEEDLES_MAX : NEEDLES_MAX);
  v->scale = fmin((WIDTH - 2.0 * MARGIN) / (v->high[0] - v->low[0]),
                  (HEIGHT_MAX - 2.0 * MARGIN) / (v->high[1] - v->low[1]));
}

static void put_scan_vectors(vectors *v) {
  const fg_scan_result_scan *scan = &v->result->scan[v->scan];
  if (v->result->scans > 1) {
    fputs("<h3>", v->out);
    fg_html_text(v->out, scan->before->scan);
    fputs(scan->hold_out ? " (kept aside: it only confirms)</h3>" : "</h3>", v->out);
  }
  fputs("<div class=\"two\">\n", v->out);
  v->after = false;
  put_figure(v, v->result->corrected ? "Before" : "As measured");
  v->after = true;
  if (v->result->corrected) put_figure(v, "After");
  fputs("</div>\n", v->out);
}

/* Returns the scale: a large residual gets the maximum length; when it is not far above the noise,
 * the noise determines the scale. */
static double needle_per_um(const vectors *v, double limit_um) {
  double per_um = v->longest / limit_um, noise_um = v->result->noise_floor_um;
  bool clean = !v->result->corrected;
  return clean && noise_um > 0 ? fmin(per_um, noise_length / noise_um) : per_um;
}

/* All drawings have one scale, so that they compare. */
static void put_scans(FILE *out, const fg_scan_result *result, double limit_um) {
  double scale = INFINITY;
  vectors v = {.out = out, .result = result, .rings = true};
  for (size_t k = 0; k < result->views; k++)
    if (result->view[k].bumps) v.rings = false;
  v.longest = v.rings ? ring_needle_length : needle_length;
  for (int drawn = 0; drawn < 2; drawn++)
    for (v.scan = 0; v.scan < result->scans && v.scan < SCANS_DRAWN; v.scan++) {
      find_box(&v);
      if (!(v.high[0] > v.low[0]) || !(v.high[1] > v.low[1])) continue;
      scale = fmin(scale, v.scale);
      v.scale = scale;
      v.unit_per_um =
          fg_scan_loop_nice_below(1000 * needle_per_um(&v, limit_um) / scale) * scale / 1000;
      if (drawn) {
        v.drawings += v.result->corrected ? 2 : 1;
        put_scan_vectors(&v);
      }
    }
  if (v.drawings) put_scale(&v);
}

/* Residuals larger than all but this share of them may leave the drawing's scale. */
#define BEYOND_SHARE 0.01

fg_status fg_scan_loop_page_vectors(fg_context *ctx, FILE *out, const fg_scan_result *result) {
  double limit = 0;
  FG_TRY(fg_scan_loop_residual_limit(ctx, result, false, BEYOND_SHARE, &limit));
  if (!(limit > 0)) return FG_OK;
  fprintf(out,
          "<section><h2 class=\"first\">Where the edges leave their circles</h2>\n"
          "<p class=\"note\">Every arc, and how far the measured edges lie from %s: "
          "<span class=\"key outkey\">outside</span> or <span class=\"key inkey\">inside</span> of "
          "the circle.</p>\n",
          result->same_foil && result->scans > 1
              ? "the one set of circles that was fitted to all scans of the foil"
              : "the circles that were fitted to them");
  put_scans(out, result, limit);
  if (result->scans > SCANS_DRAWN)
    fprintf(out, "<p class=\"note\">%zu more scans are not drawn.</p>\n",
            result->scans - SCANS_DRAWN);
  fputs("</section>\n", out);
  return FG_OK;
}
