#include "scan/gray.h"

#include <string.h>

/* Rec. 709 luminance, 0.2126 R + 0.7152 G + 0.0722 B, in 1/65536 so that equal R, G and B come out
 * unchanged; the largest 16-bit sum still fits 32 bits. */
enum { RED_WEIGHT = 13933, GREEN_WEIGHT = 46871, BLUE_WEIGHT = 4732 };
_Static_assert(RED_WEIGHT + GREEN_WEIGHT + BLUE_WEIGHT == 65536, "white must stay white");

static inline uint32_t luminance(uint32_t red, uint32_t green, uint32_t blue) {
  return (RED_WEIGHT * red + GREEN_WEIGHT * green + BLUE_WEIGHT * blue + 32768) >> 16;
}

static void look_up(const fg_gray *gray, const void *samples, size_t width, void *out) {
  const uint8_t *in = samples;
  uint8_t *row = out;
  for (size_t x = 0; x < width; x++)
    row[x] = gray->table[in[x]];
}

static void drop_alpha_8(const fg_gray *gray, const void *samples, size_t width, void *out) {
  (void)gray;
  const uint8_t *in = samples;
  uint8_t *row = out;
  for (size_t x = 0; x < width; x++)
    row[x] = in[2 * x];
}

static void drop_alpha_16(const fg_gray *gray, const void *samples, size_t width, void *out) {
  (void)gray;
  const uint16_t *in = samples;
  for (size_t x = 0; x < width; x++)
    memcpy((char *)out + 2 * x, in + 2 * x, 2);
}

static void mix_colours_8(const fg_gray *gray, const void *samples, size_t width, void *out) {
  const uint8_t *in = samples;
  uint8_t *row = out;
  for (size_t x = 0; x < width; x++, in += gray->channels)
    row[x] = (uint8_t)luminance(in[0], in[1], in[2]);
}

static void mix_colours_16(const fg_gray *gray, const void *samples, size_t width, void *out) {
  const uint16_t *in = samples;
  for (size_t x = 0; x < width; x++, in += gray->channels) {
    uint16_t value = (uint16_t)luminance(in[0], in[1], in[2]);
    memcpy((char *)out + 2 * x, &value, 2);
  }
}

static void fill_palette(fg_gray *gray, const fg_gray_colour *palette, size_t size) {
  gray->table_size = size < 256 ? size : 256;
  for (size_t i = 0; i < gray->table_size; i++)
    gray->table[i] = (uint8_t)luminance(palette[i].red, palette[i].green, palette[i].blue);
}

static void fill_spread(fg_gray *gray, int bit_depth) {
  gray->table_size = (size_t)1 << bit_depth;
  for (size_t i = 0; i < gray->table_size; i++)
    gray->table[i] = (uint8_t)(i * 255 / (gray->table_size - 1));
}

void fg_gray_init(fg_gray *gray, int channels, int bit_depth, const fg_gray_colour *palette,
                  size_t palette_size) {
  static fg_gray_convert *const conversions[5][2] = {
      [2] = {drop_alpha_8, drop_alpha_16},
      [3] = {mix_colours_8, mix_colours_16},
      [4] = {mix_colours_8, mix_colours_16},
  };
  *gray = (fg_gray){.channels = channels, .bytes_per_pixel = bit_depth == 16 ? 2 : 1};
  if (palette)
    fill_palette(gray, palette, palette_size);
  else if (channels == 1 && bit_depth < 8)
    fill_spread(gray, bit_depth);
  gray->convert = gray->table_size ? look_up : conversions[channels][bit_depth == 16];
}

size_t fg_gray_find_invalid(const fg_gray *gray, const void *samples, size_t width) {
  if (gray->table_size == 0 || gray->table_size == 256) return width;
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
