/* What was found, drawn: curves of the displacement over the coordinate it lives on, with the
 * parameters beside them. Effects that share a coordinate can cancel each other in part, so their
 * sum is the line that counts. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "effect/columns.h"
#include "loop/engine.h"
#include "report/plot.h"
#include "report/plot_marks.h"
#include "report/scan_loop/scan_loop_parts.h"

enum { SAMPLES = 241, WIDTH = 520, HEIGHT = 290 };

/* One line over a coordinate; U is NaN where it is not known. */
typedef struct curve {
  double x[SAMPLES], d[SAMPLES], u[SAMPLES];
} curve;

const char *fg_scan_loop_coordinate_title(fg_effect_coordinate coordinate) {
  static const char *const titles[] = {
      "scan.x: across the glass, mm", "scan.y: the carriage's way, mm",
      "foil.s: along the foil, mm", "bump.phi: place in the bump's arc, −1 to 1",
      "edge.normal: direction of the edge's outward normal, °"};
  return titles[coordinate];
}

static fg_point field_at(const fg_field *field, const fg_field_frame *frame,
                         fg_effect_coordinate along, double t) {
  fg_field_list one = {.frame = *frame, .fields = {*field}, .count = 1};
  fg_point at = {frame->centre_mm[0], frame->centre_mm[1]};
  if (along == FG_EFFECT_X)
    at.x = frame->low_mm[0] + t * (frame->high_mm[0] - frame->low_mm[0]);
  else
    at.y = frame->low_mm[1] + t * (frame->high_mm[1] - frame->low_mm[1]);
  return fg_field_at(&one, at);
}

/* Every field of the table runs over one axis of the scan: the one along which it changes. */
static fg_effect_coordinate axis_of(const fg_field *field, const fg_field_frame *frame) {
  double change[2] = {0, 0};
  for (int axis = 0; axis < 2; axis++)
    for (int i = 0; i < SAMPLES; i++) {
      fg_point a = field_at(field, frame, (fg_effect_coordinate)axis, 0);
      fg_point b = field_at(field, frame, (fg_effect_coordinate)axis, (double)i / (SAMPLES - 1));
      change[axis] = fmax(change[axis], hypot(b.x - a.x, b.y - a.y));
    }
  return change[0] > change[1] ? FG_EFFECT_X : FG_EFFECT_Y;
}

static void put_u(const fg_field *field, const fg_field_frame *frame, fg_effect_coordinate along,
                  int direction, curve *line) {
  for (int i = 0; i < SAMPLES; i++) {
    double square = 0;
    for (size_t c = 0; c < field->columns; c++) {
      fg_field one = *field;
      memset(one.amplitude_mm, 0, sizeof one.amplitude_mm);
      one.amplitude_mm[c] = field->u_amplitude_mm[c];
      fg_point d = field_at(&one, frame, along, (double)i / (SAMPLES - 1));
      square += pow(1000 * (direction ? d.y : d.x), 2);
    }
    line->u[i] = FG_COVERAGE_FACTOR * sqrt(square);
  }
}

/* Sum over the fields on one axis and direction; returns how many they are. The columns of a free
 * curve hang together, so its uncertainty is not theirs one by one. */
static size_t sum_fields(const fg_field_list *list, fg_effect_coordinate along, int direction,
                         curve *line) {
  const fg_field_frame *frame = &list->frame;
  size_t count = 0;
  int axis = along == FG_EFFECT_X ? 0 : 1;
  for (int i = 0; i < SAMPLES; i++) {
    double t = (double)i / (SAMPLES - 1);
    line->x[i] = frame->low_mm[axis] + t * (frame->high_mm[axis] - frame->low_mm[axis]);
    line->d[i] = 0;
    line->u[i] = NAN;
  }
  for (size_t f = 0; f < list->count; f++) {
    const fg_field *field = &list->fields[f];
    double size = 0;
    if (axis_of(field, frame) != along) continue;
    for (int i = 0; i < SAMPLES; i++) {
      fg_point d = field_at(field, frame, along, (double)i / (SAMPLES - 1));
      double value = 1000 * (direction ? d.y : d.x);
      line->d[i] += value;
      size = fmax(size, fabs(value));
    }
    if (!(size > 0)) continue;
    if (!count++ && !fg_effect_is_free(fg_effect_find(field->id)))
      put_u(field, frame, along, direction, line);
  }
  for (int i = 0; i < SAMPLES && count > 1; i++)
    line->u[i] = NAN;
  return count;
}

static bool row_place(const fg_points_row *row, fg_effect_coordinate coordinate, double *x) {
  double degrees = 180 / M_PI;
  *x = coordinate == FG_EFFECT_PHI      ? row->phi
       : coordinate == FG_EFFECT_NORMAL ? row->normal_rad * degrees
                                        : row->psi * degrees;
  return coordinate != FG_EFFECT_PHI || row->bump;
}

/* Rows look along the normal of their own arc, which on a bump points to the shaft; over the foil
 * the deviation is told outwards, in the direction that the effect's form moves it. */
static double share_of(const fg_points_row *row, fg_effect_coordinate coordinate,
                       const char *form) {
  double along = row->radial.x * row->normal.x + row->radial.y * row->normal.y;
  if (coordinate != FG_EFFECT_FOIL) return 1;
  return form && !strcmp(form, "radial") ? along : along < 0 ? -1 : 1;
}

/* Sum of the part's effects on one coordinate, from their columns at the rows, in bins. */
static fg_status sum_parts(fg_context *ctx, const fg_scan_loop *loop,
                           fg_effect_coordinate coordinate, curve *line, size_t *count) {
  const fg_points *points = &loop->points;
  size_t rows = points->row_count;
  double *columns = NULL, n[SAMPLES] = {0}, low = INFINITY, high = -INFINITY, x;
  *count = 0;
  memset(line, 0, sizeof *line);
  for (size_t i = 0; i < rows; i++) {
    if (!row_place(&points->rows[i], coordinate, &x)) continue;
    low = fmin(low, x);
    high = fmax(high, x);
  }
  if (!(high > low)) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, rows, FG_EFFECT_COLUMNS_MAX * sizeof *columns, (void **)&columns));
  for (size_t e = 0; e < loop->set.count; e++) {
    const fg_effect_found *effect = &loop->set.effects[e];
    if (effect->kind->glass || effect->kind->coordinate != coordinate) continue;
    size_t filled = fg_effect_columns(points, effect->kind, effect->shape, columns);
    *count += filled > 0;
    for (size_t i = 0; i < rows; i++) {
      if (!row_place(&points->rows[i], coordinate, &x)) continue;
      double share = share_of(&points->rows[i], coordinate, effect->kind->form);
      size_t bin = (size_t)fmin(SAMPLES - 1, (x - low) / (high - low) * SAMPLES);
      for (size_t c = 0; c < filled; c++)
        line->d[bin] += effect->coefficient_um[c] * columns[c * rows + i] / share;
      n[bin] += *count == 1 && filled;
    }
  }
  for (int i = 0; i < SAMPLES; i++) {
    line->x[i] = low + (i + 0.5) * (high - low) / SAMPLES;
    line->d[i] /= n[i];
    line->u[i] = NAN;
  }
  free(columns);
  return FG_OK;
}

/* A free curve says nothing of what circles take over: the bump's own, or the overall circle with
 * its centre. */
static void take_circles(fg_effect_coordinate coordinate, curve *line) {
  double columns[3 * SAMPLES], basis[3 * SAMPLES], d[SAMPLES];
  size_t n = 0, at[SAMPLES];
  for (size_t i = 0; i < SAMPLES; i++)
    if (isfinite(line->d[i])) at[n++] = i;
  for (size_t k = 0; k < n; k++) {
    double x = line->x[at[k]], angle = x * M_PI / 180;
    columns[k] = 1;
    columns[n + k] = coordinate == FG_EFFECT_PHI ? x : cos(angle);
    columns[2 * n + k] = coordinate == FG_EFFECT_PHI ? x * x : sin(angle);
    d[k] = line->d[at[k]];
  }
  size_t rank = fg_engine_orthonormal(n, NULL, 0, columns, 3, basis, NULL);
  fg_engine_project_out(n, basis, rank, d);
  for (size_t k = 0; k < n; k++)
    line->d[at[k]] = d[k];
}

/* Gaps of a few bins are bridged, wider ones stay: no edge looks that way. */
static void bridge(curve *line) {
  enum { WIDEST = 12 };
  size_t last = SAMPLES;
  for (size_t i = 0; i < SAMPLES; i++) {
    if (!isfinite(line->d[i])) continue;
    for (size_t k = last + 1; last < SAMPLES && i - last <= WIDEST && k < i; k++)
      line->d[k] =
          line->d[last] + (line->d[i] - line->d[last]) * (double)(k - last) / (double)(i - last);
    last = i;
  }
}

/* Where the foils' edges lie: beyond, a curve is not held by data. */
static void put_reach(const fg_plot *at, const fg_points *points, int axis) {
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < points->row_count; i++) {
    double x = axis ? points->rows[i].at.y : points->rows[i].at.x;
    low = fmin(low, x);
    high = fmax(high, x);
  }
  if (!(high > low)) return;
  fprintf(at->out,
          "<rect class=\"beyond\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>\n",
          at->left, at->top, at->right - at->left, at->bottom - at->top);
  fprintf(at->out, "<rect class=\"reach\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>\n",
          fg_plot_x(at, low), at->top, fg_plot_x(at, high) - fg_plot_x(at, low),
          at->bottom - at->top);
}

static void put_band(const fg_plot *at, const curve *line) {
  size_t count = SAMPLES;
  if (!isfinite(line->u[0])) return;
  fputs("<path class=\"ci shape\" d=\"", at->out);
  for (size_t i = 0; i < count; i++)
    fprintf(at->out, "%c%.1f %.1f", i ? 'L' : 'M', fg_plot_x(at, line->x[i]),
            fg_plot_y(at, line->d[i] + line->u[i]));
  for (size_t i = count; i-- > 0;)
    fprintf(at->out, "L%.1f %.1f", fg_plot_x(at, line->x[i]),
            fg_plot_y(at, line->d[i] - line->u[i]));
  fputs("Z\"/>\n", at->out);
}

static void put_curve(FILE *out, const fg_scan_loop *loop, fg_effect_coordinate coordinate,
                      const char *moves, const char *caption, curve *line) {
  double low = 0, high = 0, widest = 0;
  bridge(line);
  for (size_t i = 0; i < SAMPLES; i++) {
    if (!isfinite(line->d[i])) continue;
    double u = isfinite(line->u[i]) ? line->u[i] : 0;
    widest = fmax(widest, u);
    low = fmin(low, line->d[i] - u);
    high = fmax(high, line->d[i] + u);
  }
  double margin = 0.08 * (high - low) + 1e-6;
  fg_plot at = {out,          WIDTH,        72, 508, 14, 240, line->x[0], line->x[SAMPLES - 1],
                low - margin, high + margin};
  char title[64];
  snprintf(title, sizeof title, "%s, µm", moves);
  fputs("<figure>", out);
  fg_plot_begin(&at, HEIGHT, title);
  if (coordinate <= FG_EFFECT_Y) put_reach(&at, &loop->points, coordinate == FG_EFFECT_Y);
  fg_plot_y_axis(&at, title);
  fg_plot_x_numbers(&at);
  fg_plot_x_title(&at, coordinate == FG_EFFECT_FOIL ? "angle from the foil's middle about O, °"
                                                    : fg_scan_loop_coordinate_title(coordinate));
  put_band(&at, line);
  fg_plot_line(&at, line->x, line->d, SAMPLES, "effect");
  fg_plot_end(&at);
  fputs("<figcaption>", out);
  fputs(caption, out);
  if (widest > 0) {
    fg_scan_loop_length_words(widest, title, sizeof title);
    fprintf(out, "; band: U = 2u, at most %s", title);
  }
  fputs(".</figcaption></figure>\n", out);
}

static const char *along(const fg_effect *kind) {
  return !strcmp(kind->form, "radial") ? "radius" : "normal";
}

static void put_parameters(FILE *out, const fg_scan_loop *loop) {
  fputs("<div class=\"scroll\"><table><tr><th>effect</th><th class=\"w\">equation</th>"
        "<th class=\"w\">parameters, ± U = 2u</th></tr>\n",
        out);
  for (size_t e = 0; e < loop->set.count; e++) {
    const fg_effect_found *effect = &loop->set.effects[e];
    char words[120];
    fg_scan_loop_parameter p;
    fputs("<tr><td class=\"words\">", out);
    fg_html_text(out, effect->kind->words);
    fputs("<i>", out);
    fg_html_text(out, effect->kind->id);
    if (effect->kind->form) fprintf(out, ", along the %s", along(effect->kind));
    fprintf(out, "</i></td><td class=\"words\">%s</td><td class=\"words\">",
            effect->kind->equation);
    for (size_t i = 0; fg_effect_found_parameter(effect, i, &p); i++) {
      fg_scan_loop_value_words(p.value, p.u, words, sizeof words);
      fprintf(out, "%s<span class=\"nobreak\">%s = %s %s</span>", i ? "<br>" : "", p.name, words,
              p.unit);
    }
    if (fg_effect_is_free(effect->kind)) fputs("the curve itself", out);
    fputs("</td></tr>\n", out);
  }
  fputs(
      "</table></div>\n<p class=\"note\">x, y: of scale and shear from the middle of the picture, "
      "else from its top left. ψ: about O from the foil's middle.</p>\n",
      out);
}

static bool has_free(const fg_scan_loop *loop, fg_effect_coordinate coordinate) {
  for (size_t e = 0; e < loop->set.count; e++) {
    const fg_effect_found *effect = &loop->set.effects[e];
    if (fg_effect_is_free(effect->kind) && !effect->kind->glass &&
        effect->kind->coordinate == coordinate)
      return true;
  }
  return false;
}

static fg_status put_part(fg_context *ctx, FILE *out, const fg_scan_loop *loop,
                          fg_effect_coordinate coordinate) {
  static const char *const captions[2][3] = {
      {"Deviation of the foil, outwards from O positive",
       "Deviation of every bump from its circle, away from its centre positive",
       "What the direction of the edge does, outwards positive"},
      {"Deviation of the foil from its best circle, outwards positive",
       "Deviation of every bump from its best circle, away from its centre positive",
       "What the direction of the edge does, outwards positive"}};
  curve line;
  size_t count;
  FG_TRY(sum_parts(ctx, loop, coordinate, &line, &count));
  if (!count) return FG_OK;
  bool free_curve = has_free(loop, coordinate);
  if (free_curve && coordinate != FG_EFFECT_NORMAL) take_circles(coordinate, &line);
  put_curve(out, loop, coordinate, "deviation", captions[free_curve][coordinate - FG_EFFECT_FOIL],
            &line);
  return FG_OK;
}

fg_status fg_scan_loop_page_effects(fg_context *ctx, FILE *out, const fg_scan_loop *loop) {
  fg_field_list fields;
  fg_effect_set_fields(&loop->points, &loop->set, &fields);
  curve line;
  if (!loop->set.count) return FG_OK;
  fputs("<section><h2 class=\"first\">What was found, drawn</h2>\n", out);
  put_parameters(out, loop);
  fputs("<div class=\"two\">\n", out);
  if (fields.count) fg_scan_loop_page_grid(out, loop);
  for (int axis = 0; axis < 2; axis++)
    for (int direction = 0; direction < 2; direction++)
      if (sum_fields(&fields, (fg_effect_coordinate)axis, direction, &line))
        put_curve(out, loop, (fg_effect_coordinate)axis,
                  direction ? "displacement in y" : "displacement in x",
                  "What must be added to the picture's coordinate. White: where edges lie that "
                  "were measured",
                  &line);
  for (int c = FG_EFFECT_FOIL; c <= FG_EFFECT_NORMAL; c++)
    FG_TRY(put_part(ctx, out, loop, (fg_effect_coordinate)c));
  fputs("</div></section>\n", out);
  return FG_OK;
}
