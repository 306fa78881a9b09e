/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plausibility of a scanner's model. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/text.h"
#include "scan_loop/scanner_model.h"

/* Maximum amplitude, at 18 mm from the middle of the glass, where 1 mm is 5.6 %: no usable scanner
 * has such an error (the worst one measured: 0.6 %). */
#define AMPLITUDE_MAX_MM 1.0
/* A foil is some millimetres long, the largest flatbed less than a metre. */
#define REGION_MIN_MM 1.0
#define REGION_MAX_MM 2000.0
/* A step lies on the glass; the middle of a lens lies at most this many lengths of the region
 * beyond it. */
#define PLACE_BEYOND 10.0
/* No tooth of a gear or step of a motor is finer; a period longer than ten times the region is no
 * ripple. */
#define PERIOD_MIN_MM 0.01
#define GROWTH_MAX    10.0
/* All effects together: share of the region's length that they stretch, shear or bend it by. */
#define BEND_MAX 0.1
/* Range of the option --dpi. */
#define DPI_MIN 1.0
#define DPI_MAX 1e6

typedef struct range {
  double low, high;
  const char *unit;
} range;

static fg_status check_range(fg_context *ctx, const char *member, size_t index, double value,
                             range allowed) {
  char words[32];
  if (value >= allowed.low && value <= allowed.high) return FG_OK;
  fg_text_clip(words, sizeof words, isnan(value) ? "null" : "%g", value);
  return fg_fail(ctx, FG_ERR_DATA, "`%s[%zu]` is %s; %g to %g %s is allowed", member, index, words,
                 allowed.low, allowed.high, allowed.unit);
}

static fg_status check_corners(fg_context *ctx, const char *member, const double corners[4]) {
  for (size_t i = 0; i < 4; i++)
    FG_TRY(check_range(ctx, member, i, corners[i], (range){-REGION_MAX_MM, REGION_MAX_MM, "mm"}));
  for (int axis = 0; axis < 2; axis++) {
    double length = corners[2 + axis] - corners[axis];
    if (!(length >= REGION_MIN_MM && length <= REGION_MAX_MM))
      return fg_fail(ctx, FG_ERR_DATA,
                     "`%s` must be x, y of one corner and of the opposite one: it is %g mm %s; "
                     "%g to %g mm is allowed",
                     member, length, axis ? "high" : "wide", REGION_MIN_MM, REGION_MAX_MM);
  }
  return FG_OK;
}

fg_status fg_scanner_model_check_place(fg_context *ctx, const double dpi[2],
                                       const fg_field_frame *frame) {
  const double region[4] = {frame->low_mm[0], frame->low_mm[1], frame->high_mm[0],
                            frame->high_mm[1]};
  const double curve[4] = {frame->first_mm[0], frame->first_mm[1], frame->last_mm[0],
                           frame->last_mm[1]};
  for (size_t axis = 0; axis < 2; axis++)
    FG_TRY(check_range(ctx, "dpi", axis, dpi[axis], (range){DPI_MIN, DPI_MAX, "dpi"}));
  FG_TRY(check_corners(ctx, "region_mm", region));
  return check_corners(ctx, "curve_mm", curve);
}

/* Finds the allowed ranges of shape s of an effect, and of its uncertainty. */
static void shape_ranges(const fg_field_frame *frame, const fg_field *field, size_t s, range *place,
                         range *u) {
  const fg_effect *kind = fg_effect_find(field->id);
  int axis = kind->axis;
  double low = frame->low_mm[axis], high = frame->high_mm[axis], length = high - low;
  *place = (range){low - PLACE_BEYOND * length, high + PLACE_BEYOND * length, "mm"};
  if (kind->shape_is[s] == FG_EFFECT_LENGTH)
    *place = (range){PERIOD_MIN_MM, PLACE_BEYOND * length, "mm"};
  if (kind->shape_is[s] == FG_EFFECT_GROWTH) *place = (range){-GROWTH_MAX, GROWTH_MAX, "per mm"};
  *u = (range){0, PLACE_BEYOND * length, "mm"};
}

static fg_status check_field(fg_context *ctx, const char *member, size_t index,
                             const fg_field_frame *frame, const fg_field *field) {
  static const range amplitude = {-AMPLITUDE_MAX_MM, AMPLITUDE_MAX_MM, "mm"};
  static const range u_amplitude = {0, AMPLITUDE_MAX_MM, "mm"};
  char name[96], one[48];
  fg_text_clip(one, sizeof one, "%.30s[%zu]", member, index);
  for (size_t c = 0; c < field->columns; c++) {
    fg_text_clip(name, sizeof name, "%s.amplitude_mm", one);
    FG_TRY(check_range(ctx, name, c, field->amplitude_mm[c], amplitude));
    fg_text_clip(name, sizeof name, "%s.u_amplitude_mm", one);
    FG_TRY(check_range(ctx, name, c, field->u_amplitude_mm[c], u_amplitude));
  }
  for (size_t s = 0; s < field->shapes; s++) {
    range place, u;
    shape_ranges(frame, field, s, &place, &u);
    fg_text_clip(name, sizeof name, "%s.shape", one);
    FG_TRY(check_range(ctx, name, s, field->shape[s], place));
    fg_text_clip(name, sizeof name, "%s.u_shape", one);
    FG_TRY(check_range(ctx, name, s, field->u_shape[s], u));
  }
  return FG_OK;
}

fg_point fg_scanner_model_span(const fg_field_list *list, int places) {
  const fg_field_frame *f = &list->frame;
  fg_point low = {INFINITY, INFINITY}, high = {-INFINITY, -INFINITY};
  for (int i = 0; i < places * places; i++) {
    double tx = i % places / (places - 1.0), ty = i / places / (places - 1.0);
    fg_point d = fg_field_at(list, (fg_point){f->low_mm[0] + tx * (f->high_mm[0] - f->low_mm[0]),
                                              f->low_mm[1] + ty * (f->high_mm[1] - f->low_mm[1])});
    low = (fg_point){fmin(low.x, d.x), fmin(low.y, d.y)};
    high = (fg_point){fmax(high.x, d.x), fmax(high.y, d.y)};
  }
  return (fg_point){high.x - low.x, high.y - low.y};
}

/* Returns the largest difference between the displacements of two places of the region, over its
 * length. */
static double find_bend(const fg_field_list *list) {
  enum { PLACES = 9 };
  const fg_field_frame *f = &list->frame;
  fg_point span = fg_scanner_model_span(list, PLACES);
  return hypot(span.x, span.y) / fmax(f->high_mm[0] - f->low_mm[0], f->high_mm[1] - f->low_mm[1]);
}

fg_status fg_scanner_model_check_fields(fg_context *ctx, const char *member,
                                        const fg_field_list *list) {
  for (size_t i = 0; i < list->count; i++) {
    fg_context inner = {.message = ""};
    fg_status status = check_field(&inner, member, i, &list->frame, &list->fields[i]);
    if (status != FG_OK)
      return fg_fail(ctx, status, "%.400s (%s)", inner.message, list->fields[i].id);
  }
  double bend = find_bend(list);
  if (bend <= BEND_MAX) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "`%s` bends the %.0f x %.0f mm of `region_mm` by %.3g of their length; a tenth is "
                 "allowed",
                 member, list->frame.high_mm[0] - list->frame.low_mm[0],
                 list->frame.high_mm[1] - list->frame.low_mm[1], bend);
}
