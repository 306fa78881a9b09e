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

static fg_status find_background(fg_context *ctx, const fg_tiles *tiles, fg_segmentation *out) {
  size_t count = (size_t)tiles->columns * (size_t)tiles->rows;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *out->grid, (void **)&out->grid));
  memcpy(out->grid, tiles->medians, count * sizeof *out->grid);
  return fg_cv_median(ctx, out->grid, tiles->columns, tiles->rows);
}

/* Robust sd of the background: the median of |excess| on a sample of blocks. */
static fg_status estimate_noise(fg_context *ctx, fg_segmentation *out) {
  size_t count = (size_t)out->width * (size_t)out->height, stride = count / 4001 + 1, n = 0;
  float *sample = NULL;
  FG_TRY(fg_memory_allocate(ctx, count / stride + 1, sizeof *sample, (void **)&sample));
  for (size_t i = 0; i < count; i += stride)
    sample[n++] = fabsf(fg_segmentation_excess(out, (int32_t)(i % (size_t)out->width),
                                               (int32_t)(i / (size_t)out->width)));
  qsort(sample, n, sizeof *sample, compare_floats);
  out->noise = 1.4826f * sample[n / 2] + 0.02f;
  free(sample);
  return FG_OK;
}

/* Calls for every block of every tile that stands out. Others are background as they are. */
typedef void visit_block(fg_segmentation *out, int32_t x, int32_t y, float excess, void *data);

static void visit_wanted(fg_segmentation *out, visit_block *visit, void *data) {
  const fg_tiles *tiles = out->tiles;
  for (int32_t r = 0; r < tiles->rows; r++)
    for (int32_t c = 0; c < tiles->columns; c++) {
      if (!tiles->wanted[(size_t)r * (size_t)tiles->columns + (size_t)c]) continue;
      for (int32_t y = r * FG_BLOCKS_PER_TILE; y < (r + 1) * FG_BLOCKS_PER_TILE; y++)
        for (int32_t x = c * FG_BLOCKS_PER_TILE; x < (c + 1) * FG_BLOCKS_PER_TILE; x++)
          if (x < out->width && y < out->height)
            visit(out, x, y, fg_segmentation_excess(out, x, y), data);
    }
}

/* Blocks beyond the noise: sums of both signs and a histogram of either's excess in counts. */
typedef struct tally {
  float limit;
  double light, dark;
  size_t light_counts[256], dark_counts[256];
} tally;

static void tally_block(fg_segmentation *out, int32_t x, int32_t y, float excess, void *data) {
  (void)out;
  (void)x;
  (void)y;
  tally *t = data;
  int bin = (int)fminf(fabsf(excess), 255);
  if (excess > t->limit) {
    t->light += excess;
    t->light_counts[bin]++;
  } else if (excess < -t->limit) {
    t->dark -= excess;
    t->dark_counts[bin]++;
  }
}

/* Polarity by the larger sum beyond the noise; the typical contrast is the 80th percentile of
 * those blocks. */
static void find_polarity(fg_segmentation *out) {
  tally t = {.limit = fmaxf(MASK_SIGMAS * out->noise, 0.5f * CONTRAST_LEAST)};
  out->light_on_dark = true;
  visit_wanted(out, tally_block, &t);
  out->light_on_dark = t.light >= t.dark;
  const size_t *counts = out->light_on_dark ? t.light_counts : t.dark_counts;
  size_t total = 0, below = 0;
  int bin = 0;
  for (int i = 0; i < 256; i++) total += counts[i];
  while (bin < 255 && below + counts[bin] <= total * 4 / 5) below += counts[bin++];
  out->contrast = total ? (float)bin + 0.5f : 0;
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

typedef struct mask {
  uint8_t *cells;
  float limit;
} mask;

static void mark_block(fg_segmentation *out, int32_t x, int32_t y, float excess, void *data) {
  mask *m = data;
  m->cells[(size_t)y * (size_t)out->width + (size_t)x] = excess > m->limit;
}

static fg_status label_objects(fg_context *ctx, double least_px, fg_segmentation *out) {
  size_t count = (size_t)out->width * (size_t)out->height;
  mask m = {.limit = fmaxf(MASK_SIGMAS * out->noise, MASK_SHARE * out->contrast)};
  fg_blob *blobs = NULL;
  int32_t blob_count = 0;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, 1, (void **)&m.cells));
  if (out->contrast >= CONTRAST_LEAST) visit_wanted(out, mark_block, &m);
  FG_TRY_EXIT(
      fg_cv_label(ctx, m.cells, out->width, out->height, out->labels, &blobs, &blob_count));
  FG_TRY_EXIT(collect_objects(ctx, blobs, blob_count, least_px, out));
exit:
  free(m.cells);
  free(blobs);
  return status;
}

fg_status fg_segment(fg_context *ctx, const fg_tiles *tiles, double least_px,
                     fg_segmentation *out) {
  memset(out, 0, sizeof *out);
  out->tiles = tiles;
  out->light_on_dark = true;
  out->width = (int32_t)((tiles->width_px + FG_BLOCK_PX - 1) / FG_BLOCK_PX);
  out->height = (int32_t)((tiles->height_px + FG_BLOCK_PX - 1) / FG_BLOCK_PX);
  size_t count = (size_t)out->width * (size_t)out->height;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof(int32_t), (void **)&out->labels));
  FG_TRY_EXIT(find_background(ctx, tiles, out));
  FG_TRY_EXIT(estimate_noise(ctx, out));
  find_polarity(out);
  FG_TRY_EXIT(label_objects(ctx, least_px, out));
exit:
  if (status != FG_OK) fg_segmentation_free(out);
  return status;
}

void fg_segmentation_free(fg_segmentation *segmentation) {
  if (!segmentation) return;
  free(segmentation->grid);
  free(segmentation->labels);
  free(segmentation->objects);
  memset(segmentation, 0, sizeof *segmentation);
}
