/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The scanner of a spec. */
#include <math.h>

#include <stdio.h>

#include "render/parse.h"

static const double MIN_BLUR_PX = 0.4; /* sampling at three per pixel smooths with 0.3 */

static fg_status read_litter(const fg_place *place, const cJSON *parent, const char *name,
                             fg_litter *litter) {
  static const fg_spec_row table[] = {
      FG_SPEC_INTEGER(fg_litter, count, 0, 1000000),
      FG_SPEC_NUMBER(fg_litter, radius_px, 0.1, 1000),
      FG_SPEC_NUMBER(fg_litter, length_px, 0, 100000),
      FG_SPEC_NUMBER(fg_litter, contrast, -255, 255),
      FG_SPEC_END,
  };
  const cJSON *object = fg_spec_member(parent, name);
  if (!object) return FG_OK;
  fg_place inner = fg_place_inside(place, name);
  return fg_members_read(&inner, object, table, litter);
}

static fg_status read_object(const fg_place *place, const cJSON *parent, const char *name,
                             const fg_spec_row *table, void *base) {
  const cJSON *object = fg_spec_member(parent, name);
  if (!object) return FG_OK;
  fg_place inner = fg_place_inside(place, name);
  return fg_members_read(&inner, object, table, base);
}

static fg_status read_shadow(const fg_place *place, const cJSON *scanner, fg_shadow *shadow) {
  static const fg_spec_row table[] = {
      FG_SPEC_NUMBER(fg_shadow, amplitude, -1, 1),
      FG_SPEC_NUMBER(fg_shadow, direction_deg, -360, 360),
      FG_SPEC_NUMBER(fg_shadow, width_deg, 1, 180),
      FG_SPEC_NUMBER(fg_shadow, length_px, 1, 100),
      FG_SPEC_NUMBER(fg_shadow, gap_px, 0, 30),
      FG_SPEC_END,
  };
  const cJSON *object = fg_spec_member(scanner, "shadow");
  if (!object) return FG_OK;
  fg_place inner = fg_place_inside(place, "shadow");
  FG_TRY(fg_members_read(&inner, object, table, shadow));
  if (!fg_spec_member(object, "amplitude"))
    return fg_member_fail(&inner, "amplitude", NULL, "say how much; negative is darker");
  return FG_OK;
}

static fg_status read_rough(const fg_place *place, const cJSON *rough, fg_scanner *scanner) {
  static const fg_spec_row table[] = {
      FG_SPEC_NUMBER(fg_scanner, one_sided_blur_px, 0, 10),
      FG_SPEC_NUMBER(fg_scanner, motion_blur_px, 0, 20),
      FG_SPEC_NUMBER(fg_scanner, edge_roughness_um, 0, 20),
      FG_SPEC_NUMBER(fg_scanner, edge_common_um, 0, 20),
      {"correlation_um", FG_SPEC_NUMBER, offsetof(fg_scanner, edge_correlation_um), 0.2, 1e5},
      FG_SPEC_OTHER("one_sided_way"),
      FG_SPEC_OTHER("correlation_form"),
      FG_SPEC_OTHER("halo"),
      FG_SPEC_OTHER("side_wall"),
      FG_SPEC_OTHER("jpeg"),
      FG_SPEC_END,
  };
  static const fg_spec_row halo[] = {
      {"fraction", FG_SPEC_NUMBER, offsetof(fg_scanner, halo_fraction), 0, 0.5},
      {"length_px", FG_SPEC_NUMBER, offsetof(fg_scanner, halo_length_px), 4, 60},
      FG_SPEC_END,
  };
  static const fg_spec_row wall[] = {
      {"amplitude", FG_SPEC_NUMBER, offsetof(fg_scanner, wall_amplitude), -1, 1},
      {"direction_deg", FG_SPEC_NUMBER, offsetof(fg_scanner, wall_direction_deg), -360, 360},
      {"length_px", FG_SPEC_NUMBER, offsetof(fg_scanner, wall_length_px), 1, 30},
      {"gap_px", FG_SPEC_NUMBER, offsetof(fg_scanner, wall_gap_px), 0, 30},
      FG_SPEC_END,
  };
  static const fg_spec_row jpeg[] = {
      {"quality", FG_SPEC_INTEGER, offsetof(fg_scanner, jpeg_quality), 1, 100},
      FG_SPEC_END,
  };
  if (!rough) return FG_OK;
  int against = 0, exponential = 0;
  FG_TRY(fg_members_read(place, rough, table, scanner));
  FG_TRY(
      fg_member_choice(place, rough, "one_sided_way", (const char *const[]){"+y", "-y"}, &against));
  FG_TRY(fg_member_choice(place, rough, "correlation_form",
                          (const char *const[]){"gaussian", "exponential"}, &exponential));
  scanner->one_sided_way = against ? -1 : 1;
  scanner->edge_exponential = exponential == 1;
  FG_TRY(read_object(place, rough, "halo", halo, scanner));
  FG_TRY(read_object(place, rough, "side_wall", wall, scanner));
  return read_object(place, rough, "jpeg", jpeg, scanner);
}

/* One number for both axes, or [x, y]. */
static fg_status read_axes(const fg_place *place, const cJSON *scanner, const char *name,
                           double low, double high, double out[2]) {
  const cJSON *item = fg_spec_member(scanner, name);
  if (!item) return FG_OK;
  if (cJSON_IsArray(item)) {
    int count;
    return fg_member_numbers(place, name, item, (fg_array_limits){low, high, 2, 2}, out, &count);
  }
  FG_TRY(fg_member_number(place, name, item, low, high, &out[0]));
  out[1] = out[0];
  return FG_OK;
}

static double sensor_dpi(const fg_scanner *scanner, int axis) {
  return isnan(scanner->sensor_dpi[axis]) ? scanner->dpi[axis] : scanner->sensor_dpi[axis];
}

static fg_status read_resampling(const fg_place *place, const cJSON *object, fg_scanner *scanner) {
  const cJSON *from = fg_spec_member(object, "resampled_from_dpi");
  const cJSON *by = fg_spec_member(object, "resampled_by");
  int bicubic = 0;
  FG_TRY(read_axes(place, object, "resampled_from_dpi", 50, 20000, scanner->sensor_dpi));
  FG_TRY(fg_member_choice(place, object, "resampled_by",
                          (const char *const[]){"bilinear", "bicubic"}, &bicubic));
  scanner->bicubic = bicubic == 1;
  if (by && !from)
    return fg_member_fail(place, "resampled_by", by, "belongs to resampled_from_dpi");
  for (int axis = 0; axis < 2; axis++)
    if (sensor_dpi(scanner, axis) > scanner->dpi[axis])
      return fg_member_fail(place, "resampled_from_dpi", from,
                            "must be at most dpi: drivers make scans finer, not coarser");
  return FG_OK;
}

/* Samples are smoothed alike along both axes, by the need of the coarser one. */
static fg_status check_blur(const fg_place *place, const cJSON *object, const fg_scanner *scanner) {
  const double dpi[2] = {sensor_dpi(scanner, 0), sensor_dpi(scanner, 1)};
  double coarsest = fmin(dpi[0], dpi[1]);
  for (int axis = 0; axis < 2; axis++) {
    bool turned = scanner->blur_angle_deg != 0;
    double finest = fmax(dpi[0], dpi[1]);
    double min = MIN_BLUR_PX * (turned ? finest : dpi[axis]) / coarsest;
    char what[96];
    snprintf(what, sizeof what, "must be at least %g along %s at these resolutions", min,
             turned ? "both axes"
             : axis ? "y"
                    : "x");
    if (scanner->blur_px[axis] < min)
      return fg_member_fail(place, "blur_px", fg_spec_member(object, "blur_px"), what);
  }
  return FG_OK;
}

static fg_status check_scanner(const fg_place *place, const cJSON *object,
                               const fg_scanner *scanner) {
  if (scanner->bits != 8 && scanner->bits != 16)
    return fg_member_fail(place, "bits", fg_spec_member(object, "bits"), "must be 8 or 16");
  double strip = scanner->background + scanner->contrast;
  if (!(strip >= 0 && strip <= 255) || scanner->contrast == 0)
    return fg_member_fail(place, "contrast", fg_spec_member(object, "contrast"),
                          "background + contrast must lie within 0 and 255, contrast not 0");
  if (scanner->jpeg_quality && scanner->bits != 8)
    return fg_member_fail(place, "bits", fg_spec_member(object, "bits"),
                          "must be 8 where there is rough.jpeg");
  return FG_OK;
}

fg_status fg_spec_read_scanner(const fg_place *place, const cJSON *object, fg_scanner *scanner) {
  static const fg_spec_row table[] = {
      FG_SPEC_INTEGER(fg_scanner, bits, 8, 16),
      FG_SPEC_NUMBER(fg_scanner, background, 0, 255),
      FG_SPEC_NUMBER(fg_scanner, contrast, -255, 255),
      FG_SPEC_NUMBER(fg_scanner, gamma, 0.2, 5),
      FG_SPEC_OTHER("blur_px"),
      FG_SPEC_NUMBER(fg_scanner, blur_angle_deg, -180, 180),
      FG_SPEC_NUMBER(fg_scanner, noise, 0, 100),
      FG_SPEC_NUMBER(fg_scanner, noise_correlation, 0, 0.95),
      FG_SPEC_NUMBER(fg_scanner, clip_white, 1, 255),
      FG_SPEC_OTHER("dpi"),
      FG_SPEC_OTHER("resampled_from_dpi"),
      FG_SPEC_OTHER("resampled_by"),
      FG_SPEC_OTHER("shading"),
      FG_SPEC_OTHER("dust"),
      FG_SPEC_OTHER("specks"),
      FG_SPEC_OTHER("scratches"),
      FG_SPEC_OTHER("rough"),
      FG_SPEC_OTHER("rows_lost"),
      FG_SPEC_OTHER("stitches"),
      FG_SPEC_OTHER("chip_seams"),
      FG_SPEC_OTHER("colour_lines"),
      FG_SPEC_OTHER("shadow"),
      FG_SPEC_OTHER("tone_curve"),
      FG_SPEC_OTHER("tone_bits"),
      FG_SPEC_OTHER("unsharp_mask"),
      FG_SPEC_OTHER("levels"),
      FG_SPEC_OTHER("threshold"),
      FG_SPEC_END,
  };
  static const fg_spec_row shading[] = {
      {"x", FG_SPEC_NUMBER, offsetof(fg_scanner, shading), -0.5, 0.5},
      {"y", FG_SPEC_NUMBER, offsetof(fg_scanner, shading) + sizeof(double), -0.5, 0.5},
      {"quadratic", FG_SPEC_NUMBER, offsetof(fg_scanner, shading) + 2 * sizeof(double), -0.5, 0.5},
      FG_SPEC_END,
  };
  if (!object)
    return fg_colour_lines_read(place, NULL, scanner->background, scanner->contrast,
                                &scanner->colour);
  FG_TRY(fg_members_read(place, object, table, scanner));
  FG_TRY(read_axes(place, object, "dpi", 50, 20000, scanner->dpi));
  FG_TRY(read_axes(place, object, "blur_px", MIN_BLUR_PX, 10, scanner->blur_px));
  FG_TRY(read_resampling(place, object, scanner));
  FG_TRY(check_blur(place, object, scanner));
  FG_TRY(fg_jumps_read(place, object, &scanner->jumps));
  FG_TRY(read_object(place, object, "shading", shading, scanner));
  FG_TRY(read_litter(place, object, "dust", &scanner->dust));
  FG_TRY(read_litter(place, object, "specks", &scanner->specks));
  FG_TRY(read_litter(place, object, "scratches", &scanner->scratches));
  FG_TRY(read_shadow(place, object, &scanner->shadow));
  fg_place rough = fg_place_inside(place, "rough");
  FG_TRY(read_rough(&rough, fg_spec_member(object, "rough"), scanner));
  FG_TRY(check_scanner(place, object, scanner));
  FG_TRY(fg_driver_read(place, object, scanner->bits, &scanner->driver));
  return fg_colour_lines_read(place, object, scanner->background, scanner->contrast,
                              &scanner->colour);
}

fg_scanner fg_spec_default_scanner(void) {
  return (fg_scanner){
      .dpi = {4800, 4800},
      .sensor_dpi = {NAN, NAN},
      .bits = 8,
      .background = 30,
      .contrast = 175,
      .gamma = 1,
      .blur_px = {1.2, 1.2},
      .one_sided_way = 1,
      .noise = 1,
      .clip_white = NAN,
      .dust = {.radius_px = 4, .contrast = 60},
      .specks = {.radius_px = 12, .contrast = 120},
      .scratches = {.radius_px = 0.8, .length_px = 300, .contrast = 25},
      .edge_correlation_um = 50,
      .halo_length_px = 15,
      .wall_length_px = 15,
      .shadow = {.width_deg = 90, .length_px = 15},
      .driver = {.unsharp = {.radius_px = 1}, .threshold = NAN},
  };
}
