/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A rendered foil, measured in memory: the renderer's rows go straight into tiles. */
#ifndef FG_TESTS_MEASURED_RENDER_H
#define FG_TESTS_MEASURED_RENDER_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/render.h"
#include "measure/session.h"
#include "support/test.h"

typedef struct rendered {
  fg_render_spec *spec;
  const fg_render_truth *truth;
  fg_tiles tiles;
  void *strip; /* rows of the strip that is not full yet */
  size_t row_bytes;
  fg_session *session; /* NULL: tiles are kept, nothing is measured */
  int64_t blank[2];    /* rows from the first to before the second are lost: all background */
  int background;      /* of 8 bit */
} rendered;

typedef struct measured {
  rendered picture;
  fg_measurement result;
  fg_status status;
  fg_context ctx;
} measured;

static inline fg_status rendered_row(fg_context *ctx, void *user, int64_t row, const void *pixels) {
  rendered *r = user;
  size_t at = (size_t)(row % FG_TILE_PX) * r->row_bytes;
  memcpy((char *)r->strip + at, pixels, r->row_bytes);
  if (row >= r->blank[0] && row < r->blank[1])
    memset((char *)r->strip + at, r->background, r->row_bytes);
  if (row % FG_TILE_PX != FG_TILE_PX - 1 && row != r->truth->height_px - 1) return FG_OK;
  FG_TRY(fg_tiles_add_strip(ctx, &r->tiles, r->strip, (int64_t)r->row_bytes));
  return r->session ? fg_session_advance(ctx, &r->tiles, r->session) : FG_OK;
}

static inline rendered render_open(const char *json) {
  fg_context ctx = {0};
  rendered r = {0};
  if (fg_render_parse(&ctx, "spec", json, &r.spec) != FG_OK) fail_msg("%s", ctx.message);
  r.truth = fg_render_get_truth(r.spec);
  int bytes = r.truth->bits > 8 ? 2 : 1;
  r.row_bytes = (size_t)r.truth->width_px * (size_t)bytes;
  r.strip = calloc(FG_TILE_PX, r.row_bytes);
  assert_non_null(r.strip);
  assert_ok(&ctx,
            fg_tiles_create(&ctx, r.truth->width_px, r.truth->height_px, bytes, NULL, &r.tiles));
  return r;
}

static inline rendered render_tiles(const char *json) {
  fg_context ctx = {0};
  rendered r = render_open(json);
  assert_ok(&ctx, fg_render_rows(&ctx, r.spec, 0, rendered_row, &r));
  assert_ok(&ctx, fg_tiles_finish(&ctx, &r.tiles));
  return r;
}

static inline void rendered_free(rendered *r) {
  fg_render_free(r->spec);
  fg_tiles_free(&r->tiles);
  free(r->strip);
}

/* The rows go through the stages that a file's rows go through. */
static inline void measure_rows(measured *m) {
  fg_context *ctx = &m->ctx;
  rendered *r = &m->picture;
  assert_ok(ctx, fg_session_create(ctx, &m->result, 1, true, &r->session));
  assert_ok(ctx, fg_render_rows(ctx, r->spec, 0, rendered_row, r));
  assert_ok(ctx, fg_tiles_finish(ctx, &r->tiles));
  assert_ok(ctx, fg_session_advance(ctx, &r->tiles, r->session));
  m->status = fg_session_finish(ctx, r->session);
  fg_session_free(r->session);
  r->session = NULL;
}

/* Free with measured_free. NULL design: the Gen II foil. */
static inline measured measure_picture(rendered picture, const fg_design *design) {
  measured m = {.picture = picture};
  if (design)
    m.result.design = *design;
  else
    fg_design_default(&m.result.design);
  assert_ok(&m.ctx, fg_design_derive(&m.ctx, &m.result.design, &m.result.nominal));
  for (int i = 0; i < 2; i++)
    m.result.dpi[i] = m.picture.truth->dpi[i];
  measure_rows(&m);
  return m;
}

static inline measured measure_render(const char *json, const fg_design *design) {
  return measure_picture(render_open(json), design);
}

static inline void measured_free(measured *m) {
  rendered_free(&m->picture);
  fg_measurement_free(&m->result);
}

/* One foil of `bumps` bumps, with more members of the foil, and a scanner. */
__attribute__((format(printf, 5, 6))) static inline void
small_foil(char *json, size_t size, int bumps, const char *foil, const char *scanner, ...) {
  char members[2048];
  va_list arguments;
  va_start(arguments, scanner);
  vsnprintf(members, sizeof members, scanner, arguments);
  va_end(arguments);
  snprintf(
      json, size,
      "{\"schema\":\"foilgauge/render/1\",\"seed\":3,\"foils\":[{\"design\":{\"bump_count\":%d},"
      "\"overall_radius_mm\":20.95,\"radius_springback\":{\"mean\":0.02,\"sd\":0.007}%s}],"
      "\"scanner\":{%s}}",
      bumps, foil, members);
}

#endif
