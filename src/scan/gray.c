/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan/gray.h"

#include <stdbool.h>
#include <string.h>

/* Rec. 709 luminance, 0.2126 R + 0.7152 G + 0.0722 B, in 1/65536 so that equal R, G and B come out
 * unchanged; the largest 16-bit sum still fits 32 bits. */
enum { RED_WEIGHT = 13933, GREEN_WEIGHT = 46871, BLUE_WEIGHT = 4732 };
_Static_assert(RED_WEIGHT + GREEN_WEIGHT + BLUE_WEIGHT == 65536, "white must stay white");

static inline uint32_t luminance(uint32_t red, uint32_t green, uint32_t blue) {
  return (RED_WEIGHT * red + GREEN_WEIGHT * green + BLUE_WEIGHT * blue + 32768) >> 16;
}

static void convert_by_table(const fg_gray *gray, const void *samples, size_t width, void *out) {
  const uint8_t *in = samples;
  uint8_t *row = out;
  for (size_t x = 0; x < width; x++)
    row[x] = gray->table[in[x]];
}

/* Looks up one of several channels in the table. */
static void convert_one_by_table(const fg_gray *gray, const void *samples, size_t width,
                                 void *out) {
  const uint8_t *in = (const uint8_t *)samples + gray->taken;
  uint8_t *row = out;
  for (size_t x = 0; x < width; x++, in += gray->channels)
    row[x] = gray->table[*in];
}

static void copy_one_8(const fg_gray *gray, const void *samples, size_t width, void *out) {
  const uint8_t *in = (const uint8_t *)samples + gray->taken;
  uint8_t *row = out;
  for (size_t x = 0; x < width; x++, in += gray->channels)
    row[x] = *in;
}

static uint16_t spread_16(unsigned value, unsigned white) {
  if (white == 65535) return (uint16_t)value;
  return (uint16_t)(((uint64_t)value * 65535 + white / 2) / white);
}

static void copy_one_16(const fg_gray *gray, const void *samples, size_t width, void *out) {
  const uint16_t *in = (const uint16_t *)samples + gray->taken;
  for (size_t x = 0; x < width; x++, in += gray->channels) {
    uint16_t value = spread_16(*in, gray->white);
    memcpy((char *)out + 2 * x, &value, 2);
  }
}

static void invert_one_16(const fg_gray *gray, const void *samples, size_t width, void *out) {
  const uint16_t *in = (const uint16_t *)samples + gray->taken;
  for (size_t x = 0; x < width; x++, in += gray->channels) {
    uint16_t value = (uint16_t)(65535 - spread_16(*in, gray->white));
    memcpy((char *)out + 2 * x, &value, 2);
  }
}

static void mix_colours_8(const fg_gray *gray, const void *samples, size_t width, void *out) {
  const uint8_t *in = samples, *table = gray->table;
  uint8_t *row = out;
  for (size_t x = 0; x < width; x++, in += gray->channels)
    row[x] = (uint8_t)luminance(table[in[0]], table[in[1]], table[in[2]]);
}

static void mix_colours_16(const fg_gray *gray, const void *samples, size_t width, void *out) {
  const uint16_t *in = samples;
  for (size_t x = 0; x < width; x++, in += gray->channels) {
    uint16_t value = spread_16(luminance(in[0], in[1], in[2]), gray->white);
    memcpy((char *)out + 2 * x, &value, 2);
  }
}

static void fill_palette(const fg_scan_header *header, fg_channel channel, fg_gray *gray) {
  gray->table_size = header->palette_size < 256 ? header->palette_size : 256;
  for (size_t i = 0; i < gray->table_size; i++) {
    const fg_scan_colour *c = &header->palette[i];
    uint32_t values[] = {[FG_CHANNEL_LUMINANCE] = luminance(c->red, c->green, c->blue),
                         [FG_CHANNEL_RED] = c->red,
                         [FG_CHANNEL_GREEN] = c->green,
                         [FG_CHANNEL_BLUE] = c->blue};
    gray->table[i] = (uint8_t)values[channel];
  }
}

/* Fills the table: 0 to `white` over 0 to 255, or inverted. */
static void fill_spread(const fg_scan_header *header, fg_gray *gray) {
  unsigned white = header->white ? header->white : (1u << header->bit_depth) - 1;
  gray->table_size = header->white ? white + 1 : (size_t)1 << header->bit_depth;
  for (size_t i = 0; i < gray->table_size; i++) {
    uint8_t value = (uint8_t)((i * 255 + (header->white ? white / 2 : 0)) / white);
    gray->table[i] = header->inverted ? (uint8_t)(255 - value) : value;
  }
}

/* Returns true when 8-bit gray samples are gray values already. */
static bool is_gray_already(const fg_scan_header *header) {
  return header->bit_depth == 8 && !header->inverted && !header->white;
}

static fg_gray_convert *choose_8(const fg_scan_header *header, const fg_gray *gray, bool mix) {
  if (mix) return mix_colours_8;
  if (is_gray_already(header) && !header->has_palette)
    return header->channels > 1 ? copy_one_8 : NULL;
  return gray->channels > 1 ? convert_one_by_table : convert_by_table;
}

static fg_gray_convert *choose_16(const fg_scan_header *header, bool mix) {
  if (mix) return mix_colours_16;
  if (header->inverted) return invert_one_16;
  return header->channels > 1 || header->white ? copy_one_16 : NULL;
}

void fg_gray_init(const fg_scan_header *header, fg_channel channel, fg_gray *gray) {
  bool mix = header->colour && channel == FG_CHANNEL_LUMINANCE;
  *gray = (fg_gray){.channels = header->channels,
                    .bytes_per_pixel = header->bit_depth == 16 ? 2 : 1,
                    .white = header->white ? header->white : 65535};
  if (header->colour && !mix) gray->taken = (int)channel - FG_CHANNEL_RED;
  if (header->bit_depth == 16) {
    gray->convert = choose_16(header, mix);
    return;
  }
  if (header->has_palette)
    fill_palette(header, channel, gray);
  else if (mix || !is_gray_already(header))
    fill_spread(header, gray);
  gray->convert = choose_8(header, gray, mix);
}

/* Only palettes have gaps: other formats check their samples. */
size_t fg_gray_find_invalid(const fg_gray *gray, const void *samples, size_t width) {
  if (gray->table_size == 0 || gray->table_size == 256 || gray->channels > 1) return width;
  const uint8_t *in = samples;
  uint8_t largest = 0;
  for (size_t x = 0; x < width; x++)
    largest = in[x] > largest ? in[x] : largest;
  if (largest < gray->table_size) return width;
  size_t x = 0;
  while (in[x] < gray->table_size)
    x++;
  return x;
}
