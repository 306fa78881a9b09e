/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A small scan (at 400 or 600 dpi), its measurement and every report of it. An input that begins
 * like a file of pictures is the scan. Any other is a list of edits of a rendered foil of one bump:
 * short inputs reach more than single bytes of many pixels do. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/measure.h"
#include "foilgauge/render.h"
#include "foilgauge/report.h"
#include "fuzz.h"

enum { SIDE_MAX = 512, EDITS_MAX = 32, HEAD_BYTES = 32 };

static const char spec_text[] =
    "{\"schema\":\"foilgauge/render/1\",\"seed\":3,\"foils\":[{\"design\":{\"bump_count\":1,"
    "\"thickness_mm\":0.2},\"overall_radius_mm\":20.95,\"rotate_deg\":-84}],\"scanner\":{"
    "\"dpi\":400,\"noise\":1.2,\"blur_px\":0.8}}";

typedef struct picture {
  int width, height;
  uint8_t pixels[SIDE_MAX * SIDE_MAX];
} picture;

static void write_reports(const fg_measurement *measurement) {
  const fg_report_scan scan = {"scan", measurement, NULL, NULL};
  const fg_report report = {&measurement->design, &measurement->nominal, &scan, 1, NULL};
  fg_context ctx = {0};
  FILE *out = fopen("/dev/null", "w");
  if (!out) return;
  (void)fg_report_write_json(&ctx, &report, out);
  (void)fg_report_write_csv(&ctx, &report, out);
  (void)fg_report_write_table(&ctx, &report, out);
  (void)fg_report_write_html(&ctx, &report, out);
  fclose(out);
}

static fg_status keep_row(fg_context *ctx, void *user, int64_t row, const void *pixels) {
  picture *p = user;
  (void)ctx;
  memcpy(p->pixels + row * p->width, pixels, (size_t)p->width);
  return FG_OK;
}

/* The foil without edits. */
static const picture *rendered_foil(void) {
  static picture foil;
  fg_context ctx = {0};
  fg_render_spec *spec = NULL;
  if (foil.width) return &foil;
  if (fg_render_parse(&ctx, "spec", spec_text, &spec) != FG_OK) {
    fprintf(stderr, "%s\n", ctx.message);
    abort();
  }
  const fg_render_truth *truth = fg_render_get_truth(spec);
  if (truth->width_px > SIDE_MAX || truth->height_px > SIDE_MAX) abort();
  foil.width = (int)truth->width_px;
  foil.height = (int)truth->height_px;
  if (fg_render_rows(&ctx, spec, 0, keep_row, &foil) != FG_OK) abort();
  fg_render_free(spec);
  return &foil;
}

static uint8_t edited(unsigned kind, uint8_t value, uint8_t by, unsigned at) {
  switch (kind) {
  case 0:
    return by;
  case 1:
    return (uint8_t)(value + by);
  case 2: /* noise */
    return (uint8_t)(value + (at * 2654435761u >> 16) % (by / 8u + 1u));
  case 3: /* a steeper tone curve, cut at its ends */
    return (uint8_t)(value < by ? 0 : (value - by) * 3 > 255 ? 255 : (value - by) * 3);
  case 4: /* few levels */
    return (uint8_t)(value / (by + 1) * (by + 1));
  case 5:
    return (uint8_t)(255 - value);
  case 6:
    return value > by ? value : by;
  default:
    return value < by ? value : by;
  }
}

/* Edits a rectangle. */
static void edit_picture(fuzz_bytes *bytes, picture *p) {
  unsigned kind = fuzz_take(bytes) % 8;
  int x0 = fuzz_take(bytes) * p->width / 256, y0 = fuzz_take(bytes) * p->height / 256;
  int x1 = x0 + 1 + fuzz_take(bytes) * p->width / 256;
  int y1 = y0 + 1 + fuzz_take(bytes) * p->height / 256;
  uint8_t by = fuzz_take(bytes);
  for (int y = y0; y < y1 && y < p->height; y++)
    for (int x = x0; x < x1 && x < p->width; x++) {
      unsigned at = (unsigned)(y * p->width + x);
      p->pixels[at] = edited(kind, p->pixels[at], by, at);
    }
}

/* Cuts rows off below, as a picture that was not scanned to its end. */
static void cut_picture(uint8_t rows, picture *p) {
  int height = p->height - rows;
  if (height > 0) p->height = height;
}

static void choose_design(uint8_t choice, fg_design *design) {
  if (choice & 1) design->tone = FG_TONE_LINEAR;
  if (choice & 2) design->thickness_measured_mm = 0.2, design->u_thickness_measured_mm = 0.001;
  if (choice & 4)
    design->gauges[design->gauge_count++] =
        (fg_gauge){.kind = FG_GAUGE_LEAF, .width_mm = 0.2, .u_mm = 0.001};
  if (choice & 8) {
    (void)fg_design_become(NULL, FG_FOIL_ARC, design);
    design->arc.subtended_angle_deg = 20;
  }
  if (choice & 16) (void)fg_design_become(NULL, FG_FOIL_SINUSOIDAL, design);
  if (choice & 32) (void)fg_design_become(NULL, FG_FOIL_CANTILEVER, design);
  if (choice & 64) (void)fg_design_become(NULL, FG_FOIL_DISCS, design);
  if (choice & 128) (void)fg_design_become(NULL, FG_FOIL_GRID, design);
}

static const char *edited_file(fuzz_bytes *bytes) {
  static picture p;
  static uint8_t file[SIDE_MAX * SIDE_MAX + HEAD_BYTES];
  memcpy(&p, rendered_foil(), sizeof p);
  cut_picture(fuzz_take(bytes), &p);
  for (int i = 0; i < EDITS_MAX && bytes->at < bytes->end; i++)
    edit_picture(bytes, &p);
  int head = snprintf((char *)file, HEAD_BYTES, "P5\n%d %d\n255\n", p.width, p.height);
  size_t size = (size_t)p.width * (size_t)p.height;
  memcpy(file + head, p.pixels, size);
  return fuzz_file(file, (size_t)head + size);
}

static bool is_file(const uint8_t *data, size_t size) {
  static const char *const starts[] = {"P2", "P3", "P5", "P6", "II", "MM", "\x89P", "\xff\xd8"};
  for (size_t i = 0; size > 2 && i < sizeof starts / sizeof *starts; i++)
    if (!memcmp(data, starts[i], 2)) return true;
  return false;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  fg_context ctx = {0};
  fg_design design;
  fg_measurement measurement;
  fuzz_bytes bytes = {data, data + size};
  fg_design_default(&design);
  design.thickness_mm = 0.2;
  design.bumps.count = 3;
  fg_measure_options options = {
      .dpi = 600, .threads = 1, .pixel_cap = 1 << 18, .memory_cap = 64 << 20};
  const char *path;
  if (is_file(data, size)) {
    path = fuzz_file(data, size);
  } else {
    design.bumps.count = 1;
    options.dpi = 400;
    choose_design(fuzz_take(&bytes), &design);
    options.without_plain = fuzz_take(&bytes) & 1;
    path = edited_file(&bytes);
  }
  fg_status status = fg_measure_scan(&ctx, path, &design, &options, &measurement);
  if (getenv("FUZZ_TALK")) printf("%d %s\n", status, status == FG_OK ? "measured" : ctx.message);
  if (status != FG_OK) return 0;
  write_reports(&measurement);
  fg_measurement_free(&measurement);
  return 0;
}
