/* Segmentation: which blocks of the scan belong to objects that differ from the background.
 *
 * Works on the block means of fg_tiles. The background is the median of each tile, smoothed over
 * neighbours, so that uneven illumination does not count; polarity is what the larger part of the
 * contrast says.
 */
#ifndef FG_VISION_SEGMENT_H
#define FG_VISION_SEGMENT_H

#include <stdbool.h>

#include "vision/tiles.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_object {
  int32_t label;                   /* its value in `labels` */
  int32_t x, y, width, height;     /* bounding box in blocks */
  int32_t blocks;                  /* how many blocks */
  bool touches_border;             /* within one block of the scan's border */
} fg_object;

typedef struct fg_segmentation {
  int32_t width, height;   /* in blocks, the valid ones only */
  float *excess;           /* width × height: block mean minus background, objects positive */
  float *background;       /* width × height, 8-bit counts */
  int32_t *labels;         /* width × height: 0 background, else 1 + object of the mask */
  bool light_on_dark;
  float contrast;          /* typical excess of the objects, 8-bit counts */
  float noise;             /* sd of background block means, 8-bit counts */
  fg_object *objects;      /* large ones, in reading order of their boxes; owned */
  size_t object_count;
  size_t speck_count;      /* small ones, left alone */
} fg_segmentation;

/* Objects whose box has a diagonal of at least `least_px`. No object is not an error here. */
fg_status fg_segment(fg_context *ctx, const fg_tiles *tiles, double least_px,
                     fg_segmentation *segmentation);

void fg_segmentation_free(fg_segmentation *segmentation);

#ifdef __cplusplus
}
#endif
#endif
