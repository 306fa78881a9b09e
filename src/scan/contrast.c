/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan/contrast.h"

enum {
  ROW_STEP = 8, /* a strip is some 20 pixels thick at 4800 dpi */
  RUN_PX = 64,
  RANGE_MIN = 24, /* in 8-bit counts */
};

static unsigned sample_at(const fg_scan_header *header, const void *samples, size_t x,
                          int channel) {
  size_t at = x * (size_t)header->channels + (size_t)channel;
  if (header->has_palette) {
    uint8_t index = ((const uint8_t *)samples)[x * (size_t)header->channels];
    const fg_scan_colour *c = &header->palette[index];
    return channel == 0 ? c->red : channel == 1 ? c->green : c->blue;
  }
  if (header->bit_depth == 16) return ((const uint16_t *)samples)[at] >> 8;
  return ((const uint8_t *)samples)[at];
}

static unsigned range_of_run(const fg_scan_header *header, const void *samples, size_t from,
                             int channel) {
  unsigned low = UINT32_MAX, high = 0;
  for (size_t x = from; x < from + RUN_PX && x < header->width_px; x++) {
    unsigned value = sample_at(header, samples, x, channel);
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return high - low;
}

void fg_contrast_add_row(fg_contrast *contrast, int64_t row, const void *samples) {
  if (row % ROW_STEP) return;
  for (size_t x = 0; x < contrast->header->width_px; x += RUN_PX)
    for (int channel = 0; channel < 3; channel++) {
      unsigned range = range_of_run(contrast->header, samples, x, channel);
      if (range >= RANGE_MIN) contrast->sums[channel] += range;
    }
}

fg_channel fg_contrast_best(const fg_contrast *contrast) {
  const uint64_t *sums = contrast->sums;
  if (sums[0] > sums[1] && sums[0] >= sums[2]) return FG_CHANNEL_RED;
  return sums[2] > sums[1] ? FG_CHANNEL_BLUE : FG_CHANNEL_GREEN;
}
