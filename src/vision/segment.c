#include "vision/segment.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "vision/cv_bridge.h"

/* A block belongs to an object when its excess is above this share of the typical contrast and
 * this many standard deviations of the background. */
#define MASK_SHARE  0.3f
#define MASK_SIGMAS 6.0f
/* Contrasts below this many 8-bit counts are no object. */
#define CONTRAST_LEAST 8.0f

static int compare_floats(const void *a, const void *b) {
  float x = *(const float *)a, y = *(const float *)b;
  return (x > y) - (x < y);
}

/* Median of a tile's block means. */
static float tile_median(const fg_tiles *tiles, int32_t column, int32_t row) {
  float values[FG_BLOCKS_PER_TILE * FG_BLOCKS_PER_TILE];
  for (int y = 0; y < FG_BLOCKS_PER_TILE; y++)
    memcpy(values + y * FG_BLOCKS_PER_TILE,
           tiles->blocks +
               ((size_t)row * FG_BLOCKS_PER_TILE + (size_t)y) * (size_t)tiles->block_columns +
               (size_t)column * FG_BLOCKS_PER_TILE,
           FG_BLOCKS_PER_TILE * sizeof *values);
  qsort(values, FG_BLOCKS_PER_TILE * FG_BLOCKS_PER_TILE, sizeof *values, compare_floats);
  return 0.5f * (values[31] + values[32]);
}

/* Value of the tile grid at a block's centre, bilinear between tile centres. */
static float grid_at(const float *grid, int32_t columns, int32_t rows, int32_t x, int32_t y) {
  float u = ((float)x + 0.5f) / FG_BLOCKS_PER_TILE - 0.5f;
  float v = ((float)y + 0.5f) / FG_BLOCKS_PER_TILE - 0.5f;
  u = fminf(fmaxf(u, 0.0f), (float)(columns - 1));
  v = fminf(fmaxf(v, 0.0f), (float)(rows - 1));
  int32_t i = (int32_t)u, j = (int32_t)v;
  int32_t i1 = i + 1 < columns ? i + 1 : i, j1 = j + 1 < rows ? j + 1 : j;
  float fu = u - (float)i, fv = v - (float)j;
  const float *top = grid + (size_t)j * (size_t)columns;
  const float *low = grid + (size_t)j1 * (size_t)columns;
  return (1 - fv) * ((1 - fu) * top[i] + fu * top[i1]) + fv * ((1 - fu) * low[i] + fu * low[i1]);
}

static fg_status subtract_background(fg_context *ctx, const fg_tiles *tiles,
                                     fg_segmentation *out) {
  int32_t columns = tiles->columns, rows = tiles->rows;
  float *grid = NULL;
  FG_TRY(fg_memory_allocate(ctx, (size_t)columns * (size_t)rows, sizeof *grid, (void **)&grid));
  for (int32_t r = 0; r < rows; r++)
    for (int32_t c = 0; c < columns; c++)
      grid[(size_t)r * (size_t)columns + (size_t)c] = tile_median(tiles, c, r);
  fg_status status = fg_cv_median(ctx, grid, columns, rows);
  for (int32_t y = 0; y < out->height && status == FG_OK; y++)
    for (int32_t x = 0; x < out->width; x++) {
      size_t at = (size_t)y * (size_t)out->width + (size_t)x;
      out->background[at] = grid_at(grid, columns, rows, x, y);
      out->excess[at] =
          tiles->blocks[(size_t)y * (size_t)tiles->block_columns + (size_t)x] - out->background[at];
    }
  free(grid);
  return status;
}

/* Robust sd of the background from the lower half of |excess|, on a sample of blocks. */
static fg_status estimate_noise(fg_context *ctx, fg_segmentation *out) {
  size_t count = (size_t)out->width * (size_t)out->height, stride = count / 20011 + 1, n = 0;
  float *sample = NULL;
  FG_TRY(fg_memory_allocate(ctx, count / stride + 1, sizeof *sample, (void **)&sample));
  for (size_t i = 0; i < count; i += stride) sample[n++] = fabsf(out->excess[i]);
  qsort(sample, n, sizeof *sample, compare_floats);
  out->noise = 1.4826f * sample[n / 2] + 0.02f;
  free(sample);
  return FG_OK;
}

/* Polarity by the larger sum beyond the noise, and the typical contrast: the 80th percentile of
 * the blocks beyond a quarter of the extreme. Flips the sign so that objects are positive. */
static fg_status find_polarity(fg_context *ctx, fg_segmentation *out) {
  size_t count = (size_t)out->width * (size_t)out->height, n = 0;
  float limit = fmaxf(MASK_SIGMAS * out->noise, 0.5f * CONTRAST_LEAST);
  double light = 0, dark = 0;
  for (size_t i = 0; i < count; i++) {
    if (out->excess[i] > limit) light += out->excess[i];
    if (out->excess[i] < -limit) dark -= out->excess[i];
  }
  out->light_on_dark = light >= dark;
  if (!out->light_on_dark)
    for (size_t i = 0; i < count; i++) out->excess[i] = -out->excess[i];
  for (size_t i = 0; i < count; i++) n += out->excess[i] > limit;
  float *sample = NULL;
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *sample, (void **)&sample));
  n = 0;
  for (size_t i = 0; i < count; i++)
    if (out->excess[i] > limit) sample[n++] = out->excess[i];
  if (n) qsort(sample, n, sizeof *sample, compare_floats);
  out->contrast = n ? sample[n * 4 / 5] : 0;
  free(sample);
  return FG_OK;
}

static int compare_objects(const void *a, const void *b) {
  const fg_object *x = a, *y = b;
  if (x->y != y->y) return (x->y > y->y) - (x->y < y->y);
  return (x->x > y->x) - (x->x < y->x);
}

static fg_status collect_objects(fg_context *ctx, const fg_blob *blobs, int32_t blob_count,
                                 double least_px, fg_segmentation *out) {
  FG_TRY(fg_memory_allocate(ctx, (size_t)blob_count, sizeof *out->objects,
                            (void **)&out->objects));
  for (int32_t i = 0; i < blob_count; i++) {
    const fg_blob *b = &blobs[i];
    if (hypot((double)b->width, (double)b->height) * FG_BLOCK_PX < least_px) {
      out->speck_count++;
      continue;
    }
    out->objects[out->object_count++] = (fg_object){
        .label = i + 1, .x = b->x, .y = b->y, .width = b->width, .height = b->height,
        .blocks = b->area,
        .touches_border = b->x <= 0 || b->y <= 0 || b->x + b->width >= out->width ||
                          b->y + b->height >= out->height};
  }
  if (out->object_count)
    qsort(out->objects, out->object_count, sizeof *out->objects, compare_objects);
  return FG_OK;
}

static fg_status label_objects(fg_context *ctx, double least_px, fg_segmentation *out) {
  size_t count = (size_t)out->width * (size_t)out->height;
  float limit = fmaxf(MASK_SIGMAS * out->noise, MASK_SHARE * out->contrast);
  uint8_t *mask = NULL;
  fg_blob *blobs = NULL;
  int32_t blob_count = 0;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, 1, (void **)&mask));
  if (out->contrast >= CONTRAST_LEAST)
    for (size_t i = 0; i < count; i++) mask[i] = out->excess[i] > limit;
  FG_TRY_EXIT(fg_cv_label(ctx, mask, out->width, out->height, out->labels, &blobs, &blob_count));
  FG_TRY_EXIT(collect_objects(ctx, blobs, blob_count, least_px, out));
exit:
  free(mask);
  free(blobs);
  return status;
}

fg_status fg_segment(fg_context *ctx, const fg_tiles *tiles, double least_px,
                     fg_segmentation *out) {
  memset(out, 0, sizeof *out);
  out->width = (int32_t)((tiles->width_px + FG_BLOCK_PX - 1) / FG_BLOCK_PX);
  out->height = (int32_t)((tiles->height_px + FG_BLOCK_PX - 1) / FG_BLOCK_PX);
  size_t count = (size_t)out->width * (size_t)out->height;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof(float), (void **)&out->excess));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof(float), (void **)&out->background));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof(int32_t), (void **)&out->labels));
  FG_TRY_EXIT(subtract_background(ctx, tiles, out));
  FG_TRY_EXIT(estimate_noise(ctx, out));
  FG_TRY_EXIT(find_polarity(ctx, out));
  FG_TRY_EXIT(label_objects(ctx, least_px, out));
exit:
  if (status != FG_OK) fg_segmentation_free(out);
  return status;
}

void fg_segmentation_free(fg_segmentation *segmentation) {
  if (!segmentation) return;
  free(segmentation->excess);
  free(segmentation->background);
  free(segmentation->labels);
  free(segmentation->objects);
  memset(segmentation, 0, sizeof *segmentation);
}
