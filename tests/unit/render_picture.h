/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A render held in memory, as coverage (0 background, 1 foil), for the tests of the renderer. */
#ifndef RENDER_PICTURE_H
#define RENDER_PICTURE_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/render.h"
#include "support/test.h"

typedef struct picture {
  fg_render_spec *spec;
  const fg_render_truth *truth;
  int64_t width, height;
  double *dn; /* 8-bit scale */
} picture;

static inline fg_status keep_row(fg_context *ctx, void *user, int64_t row, const void *pixels) {
  (void)ctx;
  picture *p = user;
  for (int64_t x = 0; x < p->width; x++)
    p->dn[row * p->width + x] =
        p->truth->bits == 16 ? ((const uint16_t *)pixels)[x] / 257.0 : ((const uint8_t *)pixels)[x];
  return FG_OK;
}

static inline picture draw(int64_t strip_rows, const char *json) {
  fg_context ctx = {0};
  picture p = {0};
  fg_status status = fg_render_parse(&ctx, "spec.json", json, &p.spec);
  if (status != FG_OK) fail_msg("%s", ctx.message);
  p.truth = fg_render_get_truth(p.spec);
  p.width = p.truth->width_px;
  p.height = p.truth->height_px;
  p.dn = calloc((size_t)p.width * (size_t)p.height, sizeof *p.dn);
  assert_non_null(p.dn);
  assert_ok(&ctx, fg_render_rows(&ctx, p.spec, strip_rows, keep_row, &p));
  return p;
}

__attribute__((format(printf, 1, 2))) static picture draw_format(const char *format, ...) {
  char json[4096];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(json, sizeof json, format, arguments);
  va_end(arguments);
  return draw(0, json);
}

static inline void drop(picture *p) {
  fg_render_free(p->spec);
  free(p->dn);
}

/* All tests draw on 20 with a contrast of 200 in 16 bit without noise, unless they say so. */
#define EXACT "\"bits\":16,\"background\":20,\"contrast\":200,\"noise\":0"

static inline double coverage(const picture *p, int64_t x, int64_t y) {
  return (p->dn[y * p->width + x] - 20) / 200;
}

static const double pixel = 25.4 / 4800;

/* Centre of mass of a column, and its sum. */
static inline void column(const picture *p, int64_t x, int64_t y0, int64_t y1, double *centre,
                          double *sum) {
  *centre = *sum = 0;
  for (int64_t y = y0; y <= y1; y++) {
    *sum += coverage(p, x, y);
    *centre += coverage(p, x, y) * (double)y;
  }
  *centre /= *sum;
}

/* Column through the crown of bump `index` of an upright foil (direction -90°). */
static inline double crown(const picture *p, size_t index, double *thickness_px) {
  const fg_render_foil *foil = &p->truth->foils[0];
  const fg_render_bump *bump = &foil->bumps[index];
  double expected = bump->centre_px.y + bump->radius_mm / pixel, centre;
  column(p, llround(bump->centre_px.x), llround(expected) - 40, llround(expected) + 40, &centre,
         thickness_px);
  return centre - expected;
}

#endif
