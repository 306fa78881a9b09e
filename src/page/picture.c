/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "page/picture.h"

#include <math.h>
#include <png.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "foilgauge/scan.h"

/* Weights along one axis: source pixel i covers [i, i + 1) × reduction of the picture, so its
 * value goes to one picture pixel or is shared between two. */
typedef struct share {
  int32_t first; /* picture pixel */
  float weight;  /* its share, in picture px; the rest goes to first + 1 */
  float rest;
} share;

typedef struct reducer {
  fg_scan *scan;
  const int64_t *box;
  void *row;
  float *line;    /* one row, reduced along x */
  share *columns; /* box[2] entries */
  float *sums[2]; /* two picture rows that are being filled */
} reducer;

static share share_of(int64_t index, double reduction, int32_t limit) {
  double begin = (double)index * reduction, end = begin + reduction;
  int32_t first = (int32_t)begin;
  double split = fmin(end, first + 1.0);
  double rest = first + 1 < limit ? end - split : 0;
  return (share){first, (float)(split - begin), (float)rest};
}

static void reduce_line(const reducer *work, int bytes, int32_t width) {
  memset(work->line, 0, ((size_t)width + 1) * sizeof *work->line);
  for (int64_t x = 0; x < work->box[2]; x++) {
    int64_t at = x + work->box[0];
    float gray = bytes == 2 ? (float)((const uint16_t *)work->row)[at] / 257.0f
                            : (float)((const uint8_t *)work->row)[at];
    const share *to = &work->columns[x];
    work->line[to->first] += gray * to->weight;
    work->line[to->first + 1] += gray * to->rest;
  }
}

static void finish_row(const reducer *work, fg_picture *picture, int32_t y) {
  for (int32_t x = 0; x < picture->width; x++) {
    float gray = work->sums[0][x] + 0.5f;
    picture->gray[(size_t)y * (size_t)picture->width + (size_t)x] =
        gray > 255 ? 255 : (uint8_t)gray;
  }
}

static void add_line(reducer *work, fg_picture *picture, int32_t *row, share to) {
  if (to.first != *row) {
    finish_row(work, picture, *row);
    float *done = work->sums[0];
    work->sums[0] = work->sums[1];
    work->sums[1] = done;
    memset(done, 0, (size_t)picture->width * sizeof *done);
    *row = to.first;
  }
  for (int32_t x = 0; x < picture->width; x++) {
    work->sums[0][x] += work->line[x] * to.weight;
    work->sums[1][x] += work->line[x] * to.rest;
  }
}

static fg_status reduce_rows(fg_context *ctx, reducer *work, fg_picture *picture) {
  const fg_scan_info *info = fg_scan_get_info(work->scan);
  int64_t stride = info->width_px * info->bytes_per_pixel;
  int32_t row = 0;
  for (int64_t y = 0; y < work->box[1] + work->box[3]; y++) {
    FG_TRY(fg_scan_read_rows(ctx, work->scan, 1, work->row, stride));
    if (y < work->box[1]) continue;
    reduce_line(work, info->bytes_per_pixel, picture->width);
    add_line(work, picture, &row,
             share_of(y - work->box[1], picture->reduction[1], picture->height));
  }
  finish_row(work, picture, row);
  return FG_OK;
}

static fg_status allocate_reducer(fg_context *ctx, reducer *work, fg_picture *picture) {
  const fg_scan_info *info = fg_scan_get_info(work->scan);
  size_t width = (size_t)picture->width, columns = (size_t)work->box[2];
  void *block;
  FG_TRY(fg_memory_allocate(ctx, width, (size_t)picture->height, &block));
  picture->gray = block;
  FG_TRY(
      fg_memory_allocate(ctx, (size_t)info->width_px, (size_t)info->bytes_per_pixel, &work->row));
  FG_TRY(fg_memory_allocate(ctx, width + 1, sizeof *work->line, &block));
  work->line = block;
  FG_TRY(fg_memory_allocate(ctx, columns, sizeof *work->columns, &block));
  work->columns = block;
  for (int i = 0; i < 2; i++) {
    FG_TRY(fg_memory_allocate(ctx, width, sizeof *work->sums[i], &block));
    work->sums[i] = block;
  }
  for (size_t x = 0; x < columns; x++)
    work->columns[x] = share_of((int64_t)x, picture->reduction[0], picture->width);
  return FG_OK;
}

static fg_status check_same(fg_context *ctx, const fg_measurement *measurement,
                            const fg_scan *scan) {
  const fg_scan_info *info = fg_scan_get_info(scan);
  if (info->width_px == measurement->file.width_px &&
      info->height_px == measurement->file.height_px)
    return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA, "%s: it changed while it was measured; measure again",
                 measurement->scan);
}

static void choose_size(const int64_t box[4], int32_t width_max, double pixels_max,
                        fg_picture *picture) {
  double width = (double)box[2], height = (double)box[3];
  double reduction = fmin(1, fmin(width_max / width, sqrt(pixels_max / (width * height))));
  picture->width = (int32_t)fmax(1, floor(width * reduction));
  picture->height = (int32_t)fmax(1, floor(height * reduction));
  /* The picture's size is rounded to whole pixels; the reduction follows from it, so that all
   * weights add up to 1. */
  picture->reduction[0] = picture->width / width;
  picture->reduction[1] = picture->height / height;
  picture->origin_px[0] = box[0];
  picture->origin_px[1] = box[1];
}

fg_status fg_picture_load(fg_context *ctx, const fg_measurement *measurement,
                          const int64_t box_px[4], int32_t width_max, double pixels_max,
                          fg_picture *picture) {
  const fg_scan_options options = {
      .dpi = measurement->dpi[0],
      .averaged = {measurement->file.averaged[0], measurement->file.averaged[1]},
      .pixel_cap = UINT64_MAX,
      .channel = measurement->file.channel,
      .allow_lossy = true,
      .unsummed = true};
  reducer work = {.box = box_px};
  fg_status status = FG_OK;
  *picture = (fg_picture){0};
  choose_size(box_px, width_max, pixels_max, picture);
  FG_TRY_EXIT(fg_scan_open(ctx, measurement->scan, &options, &work.scan));
  FG_TRY_EXIT(check_same(ctx, measurement, work.scan));
  FG_TRY_EXIT(allocate_reducer(ctx, &work, picture));
  FG_TRY_EXIT(reduce_rows(ctx, &work, picture));
exit:
  fg_scan_close(work.scan);
  free(work.row);
  free(work.line);
  free(work.columns);
  free(work.sums[0]);
  free(work.sums[1]);
  if (status != FG_OK) fg_picture_free(picture);
  return status;
}

void fg_picture_free(fg_picture *picture) {
  free(picture->gray);
  *picture = (fg_picture){0};
}

/* libpng's simplified interface returns errors, where the full one would longjmp. */
fg_status fg_png_encode(fg_context *ctx, const uint8_t *pixels, int32_t width, int32_t height,
                        int channels, uint8_t **png, size_t *size) {
  png_image image = {.version = PNG_IMAGE_VERSION,
                     .width = (png_uint_32)width,
                     .height = (png_uint_32)height,
                     .format = channels == 3 ? PNG_FORMAT_RGB : PNG_FORMAT_GRAY,
                     .flags = PNG_IMAGE_FLAG_FAST};
  png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(image);
  void *block;
  *png = NULL;
  FG_TRY(fg_memory_allocate(ctx, bytes, 1, &block));
  if (!png_image_write_to_memory(&image, block, &bytes, 0, pixels, 0, NULL)) {
    free(block);
    return fg_fail(ctx, FG_ERR_MEMORY, "a picture could not be written as PNG: %s", image.message);
  }
  *png = block;
  *size = bytes;
  return FG_OK;
}
