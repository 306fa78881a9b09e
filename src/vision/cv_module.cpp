/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/cv_module.h"

#include <cstdlib>
#include <exception>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

static fg_status copy_contours(fg_context *ctx, const std::vector<std::vector<cv::Point>> &found,
                               fg_contours *out) {
  size_t points = 0;
  for (const auto &contour : found)
    points += contour.size();
  out->xy = static_cast<int32_t *>(std::calloc(points + 1, 2 * sizeof(int32_t)));
  out->starts = static_cast<size_t *>(std::calloc(found.size() + 1, sizeof(size_t)));
  if (!out->xy || !out->starts) {
    std::free(out->xy);
    std::free(out->starts);
    *out = {};
    return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %zu points of contours", points);
  }
  int32_t *to = out->xy;
  for (const auto &contour : found) {
    for (const cv::Point &point : contour) {
      *to++ = point.x;
      *to++ = point.y;
    }
    out->starts[++out->count] = size_t(to - out->xy) / 2;
  }
  return FG_OK;
}

static fg_status contours(fg_context *ctx, const uint8_t *picture, int32_t width, int32_t height,
                          double level, int32_t min, fg_contours *out) {
  *out = {};
  try {
    cv::setNumThreads(0);
    const cv::Mat source(height, width, CV_8U, const_cast<uint8_t *>(picture));
    const cv::Mat mask = source > level;
    std::vector<std::vector<cv::Point>> all, large;
    cv::findContours(mask, all, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
    for (auto &contour : all) {
      const cv::Rect box = cv::boundingRect(contour);
      if (box.width >= min && box.height >= min) large.push_back(std::move(contour));
    }
    return copy_contours(ctx, large, out);
  } catch (const std::exception &error) {
    return fg_fail(ctx, FG_ERR_MEMORY, "OpenCV: %s", error.what());
  }
}

static cv::Scalar colour_of(uint32_t colour) {
  return cv::Scalar(colour >> 16 & 255, colour >> 8 & 255, colour & 255);
}

static fg_status draw_line(fg_context *ctx, fg_rgb *rgb, const double *xy_px, size_t count,
                           uint32_t colour, int32_t thickness_px) {
  try {
    const int shift = 4; /* sixteenths of a pixel */
    cv::Mat image(rgb->height, rgb->width, CV_8UC3, rgb->pixels);
    std::vector<cv::Point> points;
    points.reserve(count);
    for (size_t i = 0; i < count; i++)
      points.emplace_back(cv::saturate_cast<int>(xy_px[2 * i] * (1 << shift)),
                          cv::saturate_cast<int>(xy_px[2 * i + 1] * (1 << shift)));
    cv::polylines(image, points, false, colour_of(colour), thickness_px, cv::LINE_AA, shift);
    return FG_OK;
  } catch (const std::exception &error) {
    return fg_fail(ctx, FG_ERR_MEMORY, "OpenCV: %s", error.what());
  }
}

static fg_status draw_text(fg_context *ctx, fg_rgb *rgb, const char *text, const double at_px[2],
                           const fg_text_style *style) {
  try {
    const int font = cv::FONT_HERSHEY_SIMPLEX, thickness = style->thickness_px;
    cv::Mat image(rgb->height, rgb->width, CV_8UC3, rgb->pixels);
    /* One scale for the rim and the text: it depends on the thickness. */
    const double scale = cv::getFontScaleFromHeight(font, int(style->height_px), thickness);
    const cv::Size size = cv::getTextSize(text, font, scale, thickness, nullptr);
    const cv::Point at(cv::saturate_cast<int>(at_px[0] - style->anchor * size.width),
                       cv::saturate_cast<int>(at_px[1]));
    if (style->rim_px > 0)
      cv::putText(image, text, at, font, scale, colour_of(0x101418), thickness + 2 * style->rim_px,
                  cv::LINE_AA);
    cv::putText(image, text, at, font, scale, colour_of(style->colour), thickness, cv::LINE_AA);
    return FG_OK;
  } catch (const std::exception &error) {
    return fg_fail(ctx, FG_ERR_MEMORY, "OpenCV: %s", error.what());
  }
}

/* The only exported symbol. */
extern "C" __attribute__((visibility("default")))
const fg_cv_functions fg_cv_module = {FOILGAUGE_VERSION, contours, draw_line, draw_text};
