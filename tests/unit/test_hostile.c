/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bad files by the hundred: an error each time, never a crash, and never a number from a damaged
 * PNG (every one of its bytes is under a checksum). TIFF has no checksums: there a changed pixel is
 * a pixel, and the tests ask that nothing breaks and that missing parts are missed. */

#include <tiffio.h>

#include "foilgauge/measure.h"
#include "foilgauge/render.h"
#include "png_fixture.h"
#include "support/test.h"

enum { PLACES = 200 };

static const char foil_spec[] =
    "{\"schema\": \"foilgauge/render/1\", \"seed\": 3, \"foils\": [{\"rotate_deg\": -90}],"
    " \"scanner\": {\"dpi\": 1200}}";

typedef struct fixture {
  bytes png; /* of one foil */
  size_t tried;
} fixture;

static bytes load(const char *path) {
  FILE *file = fopen(path, "rb");
  bytes out = {malloc(1 << 22), 0};
  assert_non_null(file);
  out.size = fread(out.data, 1, 1 << 22, file);
  fclose(file);
  return out;
}

static int set_up(void **state) {
  static fixture f;
  fg_context ctx = {0};
  fg_render_spec *spec = NULL;
  char *path = save_bytes(NULL, 0);
  if (fg_render_parse(&ctx, "spec", foil_spec, &spec) != FG_OK ||
      fg_render_scan(&ctx, spec, path, NULL) != FG_OK) {
    fprintf(stderr, "%s\n", ctx.message);
    return 1;
  }
  f.png = load(path);
  unlink(path);
  free(path);
  fg_render_free(spec);
  *state = &f;
  return 0;
}

static int tear_down(void **state) {
  fixture *f = *state;
  printf("%zu bad inputs\n", f->tried);
  free(f->png.data);
  return f->tried >= 500 ? 0 : 1;
}

static fg_status measure(fg_context *ctx, const bytes *file) {
  char *path = save_bytes(file->data, file->size);
  fg_design design;
  fg_measurement measurement;
  fg_design_default(&design);
  fg_status status =
      fg_measure_scan(ctx, path, &design, &(fg_measure_options){.threads = 1}, &measurement);
  if (status == FG_OK) fg_measurement_free(&measurement);
  unlink(path);
  free(path);
  return status;
}

static void refuse(fixture *f, const bytes *file, const char *what, size_t at) {
  fg_context ctx = {0};
  fg_status status = measure(&ctx, file);
  f->tried++;
  if (status != FG_ERR_DATA || !ctx.message[0])
    fail_msg("%s at %zu: status %d: %s", what, at, status, ctx.message);
}

static void the_foil_itself_is_measured(void **state) {
  fg_context ctx = {0};
  if (measure(&ctx, &((fixture *)*state)->png) != FG_OK) fail_msg("%s", ctx.message);
}

static void a_png_that_is_cut_off_is_refused(void **state) {
  fixture *f = *state;
  for (size_t i = 0; i < PLACES; i++) {
    bytes cut = {f->png.data, i * (f->png.size - 1) / (PLACES - 1)};
    refuse(f, &cut, "cut off", cut.size);
  }
}

static void a_png_with_one_wrong_bit_is_refused(void **state) {
  fixture *f = *state;
  uint32_t seed = 5;
  for (size_t i = 0; i < PLACES; i++) {
    size_t at = i < 60 ? i : next_random(&seed) % f->png.size;
    uint8_t bit = (uint8_t)(1u << next_random(&seed) % 8);
    f->png.data[at] ^= bit;
    refuse(f, &f->png, "wrong bit", at);
    f->png.data[at] ^= bit;
  }
}

/* A small gray TIFF: 60 × 50, a gradient. */
static bytes make_tiff(const char *mode, uint16_t compression, bool tiled) {
  enum { W = 60, H = 50, T = 16 };
  char *path = save_bytes(NULL, 0);
  TIFF *tiff = TIFFOpen(path, mode);
  uint8_t block[W * T];
  for (size_t i = 0; i < sizeof block; i++)
    block[i] = (uint8_t)(i * 7 ^ i >> 3);
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, W);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, H);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, compression);
  TIFFSetField(tiff, TIFFTAG_XRESOLUTION, 4800.0);
  TIFFSetField(tiff, TIFFTAG_YRESOLUTION, 4800.0);
  if (tiled) {
    TIFFSetField(tiff, TIFFTAG_TILEWIDTH, T);
    TIFFSetField(tiff, TIFFTAG_TILELENGTH, T);
    for (uint32_t y = 0; y < H; y += T)
      for (uint32_t x = 0; x < W; x += T)
        TIFFWriteTile(tiff, block, x, y, 0, 0);
  } else {
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 8);
    for (uint32_t y = 0; y < H; y++)
      TIFFWriteScanline(tiff, block + y % T, y, 0);
  }
  TIFFClose(tiff);
  bytes file = load(path);
  unlink(path);
  free(path);
  return file;
}

/* Opens the scan and reads all rows of the stated size; any status is fine as long as an error has
 * words. */
static fg_status read_scan(fixture *f, const bytes *file) {
  fg_context ctx = {0};
  fg_scan *scan = NULL;
  char *path = save_bytes(file->data, file->size);
  const fg_scan_options options = {.pixel_cap = 1 << 20, .memory_cap = 64 << 20};
  fg_status status = fg_scan_open(&ctx, path, &options, &scan);
  if (status == FG_OK) {
    const fg_scan_info *info = fg_scan_get_info(scan);
    int64_t stride = info->width_px * info->bytes_per_pixel;
    void *row = malloc((size_t)stride);
    for (int64_t y = 0; y < info->height_px && status == FG_OK; y++)
      status = fg_scan_read_rows(&ctx, scan, 1, row, stride);
    free(row);
  }
  if (status != FG_OK && !ctx.message[0]) fail_msg("an error without words");
  if (status != FG_OK && status != FG_ERR_DATA) fail_msg("status %d: %s", status, ctx.message);
  fg_scan_close(scan);
  unlink(path);
  free(path);
  f->tried++;
  return status;
}

static const struct {
  const char *mode;
  uint16_t compression;
  bool tiled;
} layouts[] = {{"wl", COMPRESSION_NONE, false},          {"wb", COMPRESSION_NONE, true},
               {"wl", COMPRESSION_LZW, false},           {"wb8", COMPRESSION_ADOBE_DEFLATE, false},
               {"wl8", COMPRESSION_ADOBE_DEFLATE, true}, {"wl", COMPRESSION_PACKBITS, true}};

static void a_tiff_that_is_cut_off_is_refused(void **state) {
  for (size_t k = 0; k < sizeof layouts / sizeof *layouts; k++) {
    in_row("layouts[%zu]", k);
    bytes file = make_tiff(layouts[k].mode, layouts[k].compression, layouts[k].tiled);
    for (size_t i = 0; i < PLACES / 4; i++) {
      bytes cut = {file.data, i * (file.size - 1) / (PLACES / 4 - 1)};
      if (read_scan(*state, &cut) == FG_OK)
        fail_msg("cut at %zu of %zu: read", cut.size, file.size);
    }
    free(file.data);
  }
}

static void wrong_bits_in_a_tiff_break_nothing(void **state) {
  uint32_t seed = 9;
  for (size_t k = 0; k < sizeof layouts / sizeof *layouts; k++) {
    in_row("layouts[%zu]", k);
    bytes file = make_tiff(layouts[k].mode, layouts[k].compression, layouts[k].tiled);
    for (size_t i = 0; i < PLACES; i++) {
      size_t at = next_random(&seed) % file.size;
      uint8_t bit = (uint8_t)(1u << next_random(&seed) % 8);
      file.data[at] ^= bit;
      read_scan(*state, &file);
      file.data[at] ^= bit;
    }
    free(file.data);
  }
}

/* Every field of every tag of a little-endian TIFF gets values that make no sense. */
static void absurd_tags_break_nothing(void **state) {
  static const uint32_t values[] = {0,       1,          3,          0x7fff,     0xffff,
                                    0x10000, 0x7fffffff, 0x80000000, 0xfffffff0, 0xffffffff};
  bytes file = make_tiff("wl", COMPRESSION_NONE, false);
  uint32_t directory;
  memcpy(&directory, file.data + 4, 4);
  unsigned count = file.data[directory] | (unsigned)file.data[directory + 1] << 8;
  for (unsigned entry = 0; entry < count; entry++)
    for (int field = 0; field < 3; field++)
      for (size_t v = 0; v < sizeof values / sizeof *values; v++) {
        in_row("values[%zu]", v);
        uint8_t saved[12], *at = file.data + directory + 2 + 12 * entry;
        memcpy(saved, at, 12);
        memcpy(at + (field == 0 ? 2 : field == 1 ? 4 : 8), &values[v], field == 0 ? 2 : 4);
        read_scan(*state, &file);
        memcpy(at, saved, 12);
      }
  /* A directory that is its own successor: the first image is there, and read. */
  memcpy(file.data + directory + 2 + 12 * count, &directory, 4);
  assert_ok(NULL, read_scan(*state, &file));
  /* A first directory beyond the file, inside the header, in the middle of nowhere. */
  for (uint32_t place = 0; place < 12; place++) {
    uint32_t wrong = place < 8 ? place : place * 0x10000000u;
    memcpy(file.data + 4, &wrong, 4);
    if (read_scan(*state, &file) == FG_OK) fail_msg("directory at %u: read", wrong);
  }
  free(file.data);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_foil_itself_is_measured),
      cmocka_unit_test(a_png_that_is_cut_off_is_refused),
      cmocka_unit_test(a_png_with_one_wrong_bit_is_refused),
      cmocka_unit_test(a_tiff_that_is_cut_off_is_refused),
      cmocka_unit_test(wrong_bits_in_a_tiff_break_nothing),
      cmocka_unit_test(absurd_tags_break_nothing),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
