#include "vision/cv_bridge.h"

#include <cstdlib>
#include <exception>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

fg_status fg_cv_label(fg_context *ctx, const uint8_t *mask, int32_t width, int32_t height,
                      int32_t *labels, fg_blob **blobs, int32_t *blob_count) {
  *blobs = nullptr;
  *blob_count = 0;
  try {
    const cv::Mat source(height, width, CV_8U, const_cast<uint8_t *>(mask));
    cv::Mat target(height, width, CV_32S, labels), stats, centroids;
    const int count = cv::connectedComponentsWithStats(source, target, stats, centroids, 8, CV_32S);
    fg_blob *out =
        static_cast<fg_blob *>(std::calloc(count > 1 ? size_t(count) : 1, sizeof(fg_blob)));
    if (!out) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %d components", count);
    for (int i = 1; i < count; i++)
      out[i - 1] = {stats.at<int>(i, cv::CC_STAT_LEFT), stats.at<int>(i, cv::CC_STAT_TOP),
                    stats.at<int>(i, cv::CC_STAT_WIDTH), stats.at<int>(i, cv::CC_STAT_HEIGHT),
                    stats.at<int>(i, cv::CC_STAT_AREA)};
    *blobs = out;
    *blob_count = count - 1;
    return FG_OK;
  } catch (const std::exception &error) {
    return fg_fail(ctx, FG_ERR_MEMORY, "OpenCV: %s", error.what());
  }
}

fg_status fg_cv_median(fg_context *ctx, float *grid, int32_t width, int32_t height) {
  try {
    cv::Mat target(height, width, CV_32F, grid);
    cv::Mat blurred;
    cv::medianBlur(target, blurred, 5);
    blurred.copyTo(target);
    return FG_OK;
  } catch (const std::exception &error) {
    return fg_fail(ctx, FG_ERR_MEMORY, "OpenCV: %s", error.what());
  }
}
