/* The only door to OpenCV (core and imgproc): plain C in, plain C out, no exception escapes. */
#ifndef FG_VISION_CV_BRIDGE_H
#define FG_VISION_CV_BRIDGE_H

#include <stdint.h>

#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One connected component of a mask. */
typedef struct fg_blob {
  int32_t x, y, width, height; /* bounding box */
  int32_t area;                /* pixels */
} fg_blob;

/* Labels the 8-connected components of a mask (0 is background): labels[y * width + x] is 0 for
 * background, else 1 + the index into *blobs. The caller frees *blobs. Sides at most 32767. */
fg_status fg_cv_label(fg_context *ctx, const uint8_t *mask, int32_t width, int32_t height,
                      int32_t *labels, fg_blob **blobs, int32_t *blob_count);

/* Median over 5 × 5 of a grid of floats, in place, borders repeated. */
fg_status fg_cv_median(fg_context *ctx, float *grid, int32_t width, int32_t height);

#ifdef __cplusplus
}
#endif
#endif
