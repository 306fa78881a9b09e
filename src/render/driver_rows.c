/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The driver's work on rounded numbers, row after row. A row is finished once all input of its
 * unsharp mask and its JPEG block is there, so strips of any height give the same picture. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "render/driver.h"

enum { JPEG_ROWS = 16 };                /* two blocks, or one of colours */
static const double KERNEL_REACH = 4.5; /* sd; beyond it are 7e-6 of a Gaussian */

static size_t row_values(const fg_driver *driver) {
  return (size_t)driver->picture.width * (size_t)driver->picture.channels;
}

static float top_value(const fg_driver *driver) {
  return driver->picture.wide ? 65535.0F : 255.0F;
}

static fg_status create_unsharp(fg_context *ctx, fg_driver *driver) {
  double radius = driver->settings->unsharp.radius_px, sum = 0;
  size_t values = row_values(driver);
  driver->taps = (int)ceil(KERNEL_REACH * radius);
  driver->kept = 2 * driver->taps + 1;
  size_t kept = (size_t)driver->kept;
  FG_TRY(fg_memory_allocate(ctx, kept, sizeof(float), (void **)&driver->kernel));
  FG_TRY(fg_memory_allocate(ctx, (size_t)driver->picture.width + kept, sizeof(float),
                            (void **)&driver->line));
  FG_TRY(fg_memory_allocate(ctx, kept * values, sizeof(float), (void **)&driver->numbers));
  FG_TRY(fg_memory_allocate(ctx, kept * values, sizeof(float), (void **)&driver->smoothed));
  FG_TRY(fg_memory_allocate(ctx, values, sizeof(float), (void **)&driver->blurred));
  FG_TRY(fg_memory_allocate(ctx, values, sizeof(uint16_t), &driver->sharpened));
  for (int k = -driver->taps; k <= driver->taps; k++)
    sum += exp(-0.5 * k * k / (radius * radius));
  for (int k = -driver->taps; k <= driver->taps; k++)
    driver->kernel[k + driver->taps] = (float)(exp(-0.5 * k * k / (radius * radius)) / sum);
  return FG_OK;
}

fg_status fg_driver_create(fg_context *ctx, const fg_driver_settings *settings,
                           const fg_driver_picture *picture, fg_render_row *row, void *user,
                           fg_driver *driver) {
  *driver = (fg_driver){.settings = settings, .picture = *picture, .row = row, .user = user};
  if (settings->unsharp.amount_pct > 0) FG_TRY(create_unsharp(ctx, driver));
  if (!picture->jpeg_quality) return FG_OK;
  fg_jpeg_init(picture->jpeg_quality, &driver->jpeg);
  return fg_memory_allocate(ctx, JPEG_ROWS, row_values(driver), (void **)&driver->block);
}

void fg_driver_free(fg_driver *driver) {
  void *blocks[] = {driver->kernel,  driver->line,      driver->numbers, driver->smoothed,
                    driver->blurred, driver->sharpened, driver->block};
  for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
    free(blocks[i]);
  *driver = (fg_driver){0};
}

/* Compresses the JPEG blocks that a row completes. */
static fg_status compress_block(fg_context *ctx, fg_driver *driver, const void *pixels) {
  size_t bytes = row_values(driver);
  int64_t last = driver->given % JPEG_ROWS, first = driver->given - last;
  memcpy(driver->block + (size_t)last * bytes, pixels, bytes);
  driver->given++;
  if (last + 1 < JPEG_ROWS && driver->given < driver->picture.height) return FG_OK;
  (driver->picture.channels == 1 ? fg_jpeg_squeeze : fg_jpeg_squeeze_colours)(
      &driver->jpeg, driver->block, driver->picture.width, last + 1, (int64_t)bytes);
  for (int64_t y = 0; y <= last; y++)
    FG_TRY(driver->row(ctx, driver->user, first + y, driver->block + (size_t)y * bytes));
  return FG_OK;
}

/* The nearest of the levels, which divide the scale evenly; of two by the threshold. */
static float nearest_level(const fg_driver *driver, float value) {
  float top = top_value(driver), steps = (float)(driver->settings->levels - 1);
  if (isfinite(driver->settings->threshold))
    return value >= (float)driver->settings->threshold * (top / 255) ? top : 0;
  return floorf(floorf(value * steps / top + 0.5F) * top / steps + 0.5F);
}

static void apply_levels(const fg_driver *driver, void *pixels) {
  size_t values = row_values(driver);
  uint8_t *narrow = pixels;
  uint16_t *wide = pixels;
  for (size_t i = 0; driver->picture.wide && i < values; i++)
    wide[i] = (uint16_t)nearest_level(driver, wide[i]);
  for (size_t i = 0; !driver->picture.wide && i < values; i++)
    narrow[i] = (uint8_t)nearest_level(driver, narrow[i]);
}

static fg_status finish_row(fg_context *ctx, fg_driver *driver, void *pixels) {
  if (driver->settings->levels) apply_levels(driver, pixels);
  if (driver->block) return compress_block(ctx, driver, pixels);
  return driver->row(ctx, driver->user, driver->given++, pixels);
}

/* Stores a row and its blur along x in the rings. Beyond the picture the outermost pixels repeat.
 */
static void keep_row(fg_driver *driver, const void *pixels) {
  int64_t width = driver->picture.width, channels = driver->picture.channels;
  int64_t slot = driver->taken % driver->kept * width * channels;
  int taps = driver->taps;
  for (int64_t c = 0; c < channels; c++) {
    float *numbers = driver->numbers + slot + c * width;
    float *smoothed = driver->smoothed + slot + c * width;
    for (int64_t x = 0; x < width; x++)
      numbers[x] = driver->picture.wide ? ((const uint16_t *)pixels)[x * channels + c]
                                        : ((const uint8_t *)pixels)[x * channels + c];
    for (int64_t x = -taps; x < width + taps; x++)
      driver->line[x + taps] = numbers[x < 0 ? 0 : x >= width ? width - 1 : x];
    memset(smoothed, 0, (size_t)width * sizeof *smoothed);
    for (int k = 0; k <= 2 * taps; k++) {
      const float weight = driver->kernel[k], *from = driver->line + k;
      for (int64_t x = 0; x < width; x++)
        smoothed[x] += weight * from[x];
    }
  }
  driver->taken++;
}

static void blur_row(fg_driver *driver, int64_t y) {
  size_t values = row_values(driver);
  memset(driver->blurred, 0, values * sizeof *driver->blurred);
  for (int k = -driver->taps; k <= driver->taps; k++) {
    int64_t from = y + k, last = driver->picture.height - 1;
    from = from < 0 ? 0 : from > last ? last : from;
    const float weight = driver->kernel[k + driver->taps];
    const float *smoothed = driver->smoothed + (size_t)(from % driver->kept) * values;
    for (size_t i = 0; i < values; i++)
      driver->blurred[i] += weight * smoothed[i];
  }
}

static float sharpen_value(const fg_unsharp_mask *mask, float value, float blurred, float top) {
  float difference = value - blurred;
  if (fabsf(difference) < (float)mask->threshold * (top / 255)) return value;
  float out = floorf(value + (float)(mask->amount_pct / 100) * difference + 0.5F);
  return out < 0 ? 0 : out > top ? top : out;
}

static void sharpen_row(fg_driver *driver, int64_t y) {
  int64_t width = driver->picture.width, channels = driver->picture.channels;
  const float *numbers = driver->numbers + y % driver->kept * width * channels;
  float top = top_value(driver);
  blur_row(driver, y);
  for (int64_t c = 0; c < channels; c++)
    for (int64_t x = 0; x < width; x++) {
      int64_t i = c * width + x;
      float value = sharpen_value(&driver->settings->unsharp, numbers[i], driver->blurred[i], top);
      if (driver->picture.wide)
        ((uint16_t *)driver->sharpened)[x * channels + c] = (uint16_t)value;
      else
        ((uint8_t *)driver->sharpened)[x * channels + c] = (uint8_t)value;
    }
}

fg_status fg_driver_add_row(fg_context *ctx, fg_driver *driver, void *pixels) {
  if (!driver->kernel) return finish_row(ctx, driver, pixels);
  keep_row(driver, pixels);
  int64_t behind = driver->taken < driver->picture.height ? driver->taps : 0;
  for (int64_t y = driver->given; y < driver->taken - behind; y++) {
    sharpen_row(driver, y);
    FG_TRY(finish_row(ctx, driver, driver->sharpened));
  }
  return FG_OK;
}
