/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From coverage to pixels, row after row: light, shading, tone, noise, clipping; from the sensor's
 * grid to the picture's; the driver's tone curve, rounding. driver_rows.c has the driver's later
 * stages. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "render/random.h"
#include "render/resample.h"
#include "render/tile.h"

enum { TONE_STEPS = 65536 };

typedef struct picture {
  const fg_render_spec *spec;
  fg_sampler sampler;
  fg_tiler tiler;
  fg_band band;
  int64_t width, padded, strip_rows; /* of the sensor */
  float *coverage;                   /* padded × strip_rows */
  float *values, *noise;
  float *noise_above; /* of every channel */
  float *column_shading;
  float *tone;   /* NULL: linear */
  void *pixels;  /* strip_rows rows of `channels` values a pixel; of a resampled picture one row */
  float *sensed; /* of a resampled picture: strip_rows rows of every channel's values */
  int channels;
  fg_noise_table table;
  fg_resampler resampler; /* without rows the sensor's grid is the picture's */
  fg_driver driver;
} picture;

static fg_resampled_row finish_resampled;

static fg_status make_tone(fg_context *ctx, picture *p) {
  double gamma = p->spec->scanner.gamma;
  if (gamma == 1) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, TONE_STEPS + 2, sizeof *p->tone, (void **)&p->tone));
  for (int i = 0; i < TONE_STEPS + 2; i++)
    p->tone[i] = (float)(255 * pow((double)i / TONE_STEPS, 1 / gamma));
  return FG_OK;
}

static fg_status create_driver(fg_context *ctx, fg_render_row *row, void *user, picture *p) {
  const fg_scanner *scanner = &p->spec->scanner;
  const fg_driver_picture finished = {.width = p->spec->truth.width_px,
                                      .height = p->spec->truth.height_px,
                                      .channels = p->channels,
                                      .wide = scanner->bits == 16,
                                      .jpeg_quality = scanner->jpeg_quality};
  return fg_driver_create(ctx, &scanner->driver, &finished, row, user, &p->driver);
}

static bool is_resampled(const fg_render_spec *spec) {
  return !isnan(spec->scanner.sensor_dpi[0]);
}

static fg_status create_resampler(fg_context *ctx, picture *p) {
  const fg_render_spec *spec = p->spec;
  const fg_resampling way = {.from_px = {spec->sensor.width_px, spec->sensor.height_px},
                             .to_px = {spec->truth.width_px, spec->truth.height_px},
                             .step = {spec->pixel_mm[0] / spec->sensor.pixel_mm[0],
                                      spec->pixel_mm[1] / spec->sensor.pixel_mm[1]},
                             .bicubic = spec->scanner.bicubic,
                             .channels = p->channels};
  FG_TRY(fg_memory_allocate(ctx, (size_t)p->padded * (size_t)p->strip_rows,
                            (size_t)p->channels * sizeof *p->sensed, (void **)&p->sensed));
  return fg_resampler_create(ctx, &way, finish_resampled, p, &p->resampler);
}

/* Creates the picture's pixels, and the stages between them and the sensor's values. */
static fg_status create_finish(fg_context *ctx, picture *p) {
  size_t bytes = (p->spec->scanner.bits == 16 ? 2 : 1) * (size_t)p->channels;
  if (!is_resampled(p->spec))
    return fg_memory_allocate(ctx, (size_t)p->padded * (size_t)p->strip_rows, bytes, &p->pixels);
  FG_TRY(fg_memory_allocate(ctx, (size_t)p->spec->truth.width_px, bytes, &p->pixels));
  return create_resampler(ctx, p);
}

static fg_status picture_create(fg_context *ctx, const fg_render_spec *spec, int64_t strip_rows,
                                picture *p) {
  p->spec = spec;
  p->width = spec->sensor.width_px;
  p->channels = spec->truth.channels;
  p->padded = (p->width + FG_TILE_PX - 1) / FG_TILE_PX * FG_TILE_PX;
  if (strip_rows < 1) strip_rows = FG_TILE_PX;
  if (strip_rows > spec->sensor.height_px) strip_rows = spec->sensor.height_px;
  p->strip_rows = (strip_rows + FG_TILE_PX - 1) / FG_TILE_PX * FG_TILE_PX;
  fg_sampler_init(spec, &p->sampler);
  FG_TRY(fg_tiler_create(ctx, &p->sampler, &p->tiler));
  FG_TRY(fg_band_create(ctx, &p->sampler, p->strip_rows, fg_tiler_reach_px(&p->tiler), &p->band));
  size_t padded = (size_t)p->padded, rows = (size_t)p->strip_rows;
  FG_TRY(fg_memory_allocate(ctx, padded * rows, sizeof(float), (void **)&p->coverage));
  FG_TRY(create_finish(ctx, p));
  FG_TRY(fg_memory_allocate(ctx, padded, sizeof(float), (void **)&p->values));
  FG_TRY(fg_memory_allocate(ctx, padded, sizeof(float), (void **)&p->noise));
  FG_TRY(fg_memory_allocate(ctx, padded * (size_t)p->channels, sizeof(float),
                            (void **)&p->noise_above));
  FG_TRY(fg_memory_allocate(ctx, padded, sizeof(float), (void **)&p->column_shading));
  FG_TRY(make_tone(ctx, p));
  const double *shading = spec->scanner.shading;
  for (int64_t x = 0; x < p->width; x++) {
    double u = 2.0 * (double)x / (double)(p->width - 1) - 1;
    p->column_shading[x] = (float)(1 + shading[0] * u + shading[2] * u * u);
  }
  fg_noise_table_fill(&p->table);
  return FG_OK;
}

static void picture_free(picture *p) {
  fg_driver_free(&p->driver);
  fg_resampler_free(&p->resampler);
  fg_tiler_free(&p->tiler);
  fg_band_free(&p->band);
  free(p->coverage);
  free(p->pixels);
  free(p->sensed);
  free(p->values);
  free(p->noise);
  free(p->noise_above);
  free(p->column_shading);
  free(p->tone);
}

static void draw_coverage(picture *p, int64_t y0) {
  memset(p->coverage, 0, (size_t)p->padded * (size_t)p->strip_rows * sizeof *p->coverage);
  for (int64_t y = 0; y < p->strip_rows && y0 + y < p->spec->sensor.height_px; y += FG_TILE_PX)
    for (int64_t x = 0; x < p->padded; x += FG_TILE_PX)
      fg_tiler_draw(&p->tiler, &p->band, x, y0 + y, p->coverage + y * p->padded + x, p->padded);
}

/* Light of one row as DN of 8 bit. The ends of the scale keep their DN whatever gamma is. */
static void expose_row(const picture *p, int line, int64_t y, const float *coverage,
                       float *values) {
  const fg_scanner *scanner = &p->spec->scanner;
  double gamma = scanner->gamma;
  double background = scanner->colour.line[line].background;
  double dark = pow(background / 255, gamma);
  double bright = pow((background + scanner->colour.line[line].contrast) / 255, gamma);
  double v = 2.0 * (double)y / (double)(p->spec->sensor.height_px - 1) - 1;
  float row_shading = (float)(scanner->shading[1] * v + scanner->shading[2] * v * v);
  float base = (float)dark, step = (float)(bright - dark);
  for (int64_t x = 0; x < p->width; x++)
    values[x] = (base + step * coverage[x]) * (p->column_shading[x] + row_shading);
  if (!p->tone) {
    for (int64_t x = 0; x < p->width; x++)
      values[x] *= 255;
    return;
  }
  for (int64_t x = 0; x < p->width; x++) {
    float place = values[x] * TONE_STEPS;
    place = place < 0 ? 0 : place > TONE_STEPS ? TONE_STEPS : place;
    int i = (int)place;
    values[x] = p->tone[i] + (place - (float)i) * (p->tone[i + 1] - p->tone[i]);
  }
}

/* Noise of variance 1. Correlated: first-order recursions along the row and down the columns, so
 * the correlation to the next pixel is `rho` both ways, and rho² diagonally. */
static void noise_row(picture *p, int line, int64_t y) {
  float rho = (float)p->spec->scanner.noise_correlation;
  float *above = p->noise_above + line * p->padded;
  fg_random random;
  fg_random_seed(&random, p->spec->seed, FG_STREAM_NOISE, (uint64_t)y + ((uint64_t)line << 40));
  fg_noise_draw(&p->table, &random, p->noise, (size_t)p->width);
  if (rho <= 0) return;
  float fresh = sqrtf(1 - rho * rho);
  for (int64_t x = 1; x < p->width; x++)
    p->noise[x] = rho * p->noise[x - 1] + fresh * p->noise[x];
  if (y > 0)
    for (int64_t x = 0; x < p->width; x++)
      p->noise[x] = rho * above[x] + fresh * p->noise[x];
  memcpy(above, p->noise, (size_t)p->width * sizeof *p->noise);
}

/* Sensor's numbers: with noise, clipped to its range. */
static void sense_row(picture *p, int line, int64_t y, float *values) {
  const fg_scanner *scanner = &p->spec->scanner;
  float top = isnan(scanner->clip_white) ? 255.0F : (float)scanner->clip_white;
  float sd = (float)scanner->noise;
  if (scanner->noise > 0) noise_row(p, line, y);
  for (int64_t x = 0; x < p->width; x++) {
    float value = values[x] + sd * p->noise[x];
    values[x] = value < 0 ? 0 : value > top ? top : value;
  }
}

/* Values of one channel through the tone curve into rounded pixels. */
static void quantise_row(const picture *p, int line, const float *values, int64_t width,
                         void *pixels) {
  const fg_tone_curve *tone = &p->spec->scanner.driver.tone;
  bool wide = p->spec->scanner.bits == 16;
  uint8_t *narrow_out = (uint8_t *)pixels + line;
  uint16_t *wide_out = (uint16_t *)pixels + line;
  for (int64_t x = 0; x < width; x++) {
    float value = tone->count ? fg_tone_curve_value(tone, values[x]) : values[x];
    if (wide)
      wide_out[x * p->channels] = (uint16_t)(value * 257 + 0.5F);
    else
      narrow_out[x * p->channels] = (uint8_t)(value + 0.5F);
  }
}

static fg_status finish_resampled(fg_context *ctx, void *user, float *values) {
  picture *p = user;
  int64_t width = p->spec->truth.width_px;
  for (int line = 0; line < p->channels; line++)
    quantise_row(p, line, values + line * width, width, p->pixels);
  return fg_driver_add_row(ctx, &p->driver, p->pixels);
}

static size_t row_bytes(const picture *p) {
  return (size_t)p->padded * (size_t)p->channels * (p->spec->scanner.bits == 16 ? 2 : 1);
}

/* Draws one channel of the strip's rows. Noise of a colour scan is each line's own. */
static void draw_channel(picture *p, int line, int64_t y0, int64_t rows) {
  if (p->spec->scanner.colour.stated) fg_sampler_use_line(&p->sampler, line);
  draw_coverage(p, y0);
  for (int64_t y = 0; y < rows; y++) {
    float *values = p->sensed ? p->sensed + (y * p->channels + line) * p->padded : p->values;
    expose_row(p, line, y0 + y, p->coverage + y * p->padded, values);
    sense_row(p, line, y0 + y, values);
    if (!p->sensed)
      quantise_row(p, line, values, p->width, (char *)p->pixels + (size_t)y * row_bytes(p));
  }
}

static fg_status draw_strip(fg_context *ctx, picture *p, int64_t y0) {
  int64_t rows = p->spec->sensor.height_px - y0;
  if (rows > p->strip_rows) rows = p->strip_rows;
  FG_TRY(fg_band_fill(ctx, &p->sampler, y0, fg_tiler_reach_px(&p->tiler), &p->band));
  for (int line = 0; line < p->channels; line++)
    draw_channel(p, line, y0, rows);
  for (int64_t y = 0; y < rows; y++)
    if (p->sensed)
      FG_TRY(fg_resampler_add_row(ctx, &p->resampler, p->sensed + y * p->channels * p->padded,
                                  p->padded));
    else
      FG_TRY(fg_driver_add_row(ctx, &p->driver, (char *)p->pixels + (size_t)y * row_bytes(p)));
  return FG_OK;
}

fg_status fg_render_rows(fg_context *ctx, const fg_render_spec *spec, int64_t strip_rows,
                         fg_render_row *row, void *user) {
  picture *p = NULL;
  fg_status status = FG_OK;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *p, (void **)&p));
  FG_TRY_EXIT(picture_create(ctx, spec, strip_rows, p));
  FG_TRY_EXIT(create_driver(ctx, row, user, p));
  for (int64_t y = 0; y < spec->sensor.height_px; y += p->strip_rows)
    FG_TRY_EXIT(draw_strip(ctx, p, y));
exit:
  picture_free(p);
  free(p);
  return status;
}
