/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The reading of common PNGs held against libpng's: over kinds, filters, streams and chunks; and
 * over files with one wrong byte or one that is cut off. */

#include "foilgauge/scan.h"
#include "png_fixture.h"
#include "support/png_pair.h"
#include "support/test.h"

static const recipe plain = {
    .width = 61, .height = 43, .bit_depth = 8, .level = 6, .window_bits = 15, .memory_level = 8};

static const struct {
  int colour_type, bit_depth;
} kinds[] = {{0, 1}, {0, 2}, {0, 4}, {0, 8}, {0, 16}, {2, 8}, {2, 16}, {3, 1},
             {3, 2}, {3, 4}, {3, 8}, {4, 8}, {4, 16}, {6, 8}, {6, 16}};

enum { KINDS = sizeof kinds / sizeof kinds[0] };

/* Smooth with noise and with repeats, as scans are: every kind of deflate's codes occurs. */
static uint8_t *make_raw(const recipe *r, uint32_t seed) {
  size_t row = recipe_row_bytes(r), size = row * r->height;
  uint8_t *raw = malloc(size);
  for (size_t i = 0; i < size; i++) {
    uint32_t noise = next_random(&seed);
    raw[i] = (uint8_t)(i % row / 3 + i / row * 5 + (noise >> 8) % (noise % 7 ? 3 : 200));
    if (noise % 64 == 0 && i > 300) memcpy(raw + i - 40, raw + i - 300 + noise % 200, 40);
  }
  return raw;
}

static pair read_bytes(const growing *file) {
  char *path = save_bytes(file->data, file->size);
  pair p = read_both_ways(path);
  unlink(path);
  free(path);
  return p;
}

static void expect_same(const char *what, int number, const recipe *r) {
  uint8_t *raw = make_raw(r, (uint32_t)number + 1);
  growing png = make_pair_png(r, raw);
  pair p = read_bytes(&png);
  bool alone;
  const char *differs = compare_pair(&p, &alone);
  if (differs || p.ours.status != FG_OK)
    fail_msg("%s %d (type %d, %d bits, %u x %u): %s%s; libpng: %s", what, number, r->colour_type,
             r->bit_depth, r->width, r->height, differs ? differs : "", p.ours.context.message,
             p.libpng.context.message);
  if (r->bit_depth == 8 && memcmp(p.ours.rows, raw, p.ours.size)) fail_msg("%s: samples", what);
  free_pair(&p);
  free(png.data);
  free(raw);
}

static void every_colour_type_and_filter_decodes_as_libpng(void **state) {
  (void)state;
  static const uint32_t widths[] = {1, 2, 3, 5, 7, 8, 15, 16, 17, 33, 64, 301};
  for (int kind = 0; kind < KINDS; kind++)
    for (int filter = 0; filter <= PAIR_FILTER_MIXED; filter++)
      for (size_t w = 0; w < sizeof widths / sizeof widths[0]; w++) {
        in_row("widths[%zu]", w);
        recipe r = plain;
        r.colour_type = kinds[kind].colour_type;
        r.bit_depth = kinds[kind].bit_depth;
        r.filter = filter;
        r.width = widths[w];
        r.height = 11;
        if (r.colour_type == 3 && r.bit_depth < 8) r.filter = 0;
        expect_same("kind", kind * 10 + filter, &r);
      }
}

static void every_way_to_deflate(void **state) {
  (void)state;
  static const int levels[] = {0, 1, 2, 6, 9},
                   strategies[] = {Z_DEFAULT_STRATEGY, Z_FILTERED, Z_HUFFMAN_ONLY, Z_RLE, Z_FIXED};
  int number = 0;
  for (size_t l = 0; l < 5; l++)
    for (size_t s = 0; s < 5; s++)
      for (int bits = 9; bits <= 15; bits++)
        for (int memory = 1; memory <= 9; memory += 4) {
          recipe r = plain;
          r.level = levels[l];
          r.strategy = strategies[s];
          r.window_bits = bits;
          r.memory_level = memory;
          r.filter = number % 6;
          r.flush_every = (uint32_t)(number % 4) * 3;
          expect_same("deflate", number++, &r);
        }
}

/* Chunks of every small size split what stands in the stream at every place. */
static void every_split(void **state) {
  (void)state;
  for (int kind = 0; kind < 3; kind++)
    for (uint32_t size = 1; size < 60; size++) {
      recipe r = plain;
      r.idat_bytes = size;
      r.empty_every = size % 3;
      r.level = kind ? 6 : 0;
      r.strategy = kind == 2 ? Z_FIXED : Z_DEFAULT_STRATEGY;
      r.filter = PAIR_FILTER_MIXED;
      r.flush_every = 9;
      expect_same("split", (int)size, &r);
    }
}

/* Larger than the blocks that input and rows are read in. */
static void more_than_a_block(void **state) {
  (void)state;
  for (int kind = 0; kind < 8; kind++) {
    recipe r = plain;
    r.width = 3001;
    r.height = 150;
    r.level = kind % 2 ? 1 : 0;
    r.colour_type = kind & 2 ? 6 : 0;
    r.idat_bytes = kind & 4 ? 8192 : 0;
    r.filter = PAIR_FILTER_MIXED;
    expect_same("block", kind, &r);
  }
}

static void seal_all(growing *file) {
  bytes view = {file->data, file->size};
  for (size_t at = 8; at + 12 <= file->size; at += 12 + get_32(file->data + at)) {
    if (get_32(file->data + at) > file->size - at - 12) return;
    seal_chunk(&view, at);
  }
}

/* Number of files (0 or 1) that our reader alone refuses; a file that our reader accepts, libpng
 * accepts. */
static int count_alone(const growing *file, const char *what, size_t at) {
  pair p = read_bytes(file);
  bool alone;
  const char *differs = compare_pair(&p, &alone);
  if (differs) fail_msg("%s %zu: %s (%s)", what, at, differs, p.libpng.context.message);
  free_pair(&p);
  return alone;
}

static growing make_small(int number) {
  recipe r = plain;
  r.width = 9;
  r.height = 7;
  r.filter = PAIR_FILTER_MIXED;
  r.idat_bytes = number % 2 ? 0 : 30;
  r.strategy = number == 2 ? Z_FIXED : Z_DEFAULT_STRATEGY;
  r.level = number == 3 ? 0 : 9;
  uint8_t *raw = make_raw(&r, 5);
  growing png = make_pair_png(&r, raw);
  free(raw);
  return png;
}

/* Each byte, with the checksums of chunks as they were and put right. */
static void no_wrong_byte_is_taken_otherwise(void **state) {
  (void)state;
  static const uint8_t flips[] = {0x01, 0x80};
  int alone = 0;
  for (int number = 0; number < 4; number++) {
    growing png = make_small(number), bent = {0};
    for (size_t at = 0; at < png.size; at++)
      for (size_t i = 0; i < 2 * sizeof flips; i++) {
        bent.size = 0;
        grow(&bent, png.data, png.size);
        bent.data[at] ^= flips[i / 2];
        if (i % 2) seal_all(&bent);
        alone += count_alone(&bent, "byte", at);
      }
    free(bent.data);
    free(png.data);
  }
  assert_int_equal(alone, 0);
}

/* The stream's first two bytes declare another window than the data were compressed with. */
static void declare_window(growing *png, int bits) {
  for (size_t at = 8; at + 12 <= png->size; at += 12 + get_32(png->data + at)) {
    if (memcmp(png->data + at + 4, "IDAT", 4)) continue;
    uint8_t *head = png->data + at + 8;
    head[0] = (uint8_t)((bits - 8) << 4 | 8);
    head[1] = (uint8_t)(head[1] & 0xC0);
    head[1] = (uint8_t)(head[1] | (31 - (head[0] * 256 + head[1]) % 31) % 31);
    break;
  }
  seal_all(png);
}

/* Distances beyond the window are refused exactly where libpng refuses them. */
static void windows_are_believed_as_libpng_does(void **state) {
  (void)state;
  int refused = 0;
  for (int number = 0; number < 100; number++) {
    recipe r = plain;
    r.width = 40 + (uint32_t)number;
    r.height = 20 + (uint32_t)number % 17;
    r.filter = number % 6;
    r.level = 9;
    r.idat_bytes = number % 3 ? 0 : 50;
    uint8_t *raw = make_raw(&r, (uint32_t)number);
    growing png = make_pair_png(&r, raw);
    for (int bits = 8; bits <= 15; bits++) {
      declare_window(&png, bits);
      assert_int_equal(count_alone(&png, "window", (size_t)(number * 100 + bits)), 0);
      pair p = read_bytes(&png);
      assert_int_equal(p.ours.status, p.libpng.status);
      refused += p.ours.status != FG_OK;
      free_pair(&p);
    }
    free(png.data);
    free(raw);
  }
  assert_in_range(refused, 50, 700); /* some of each kind */
}

/* So large that it is decompressed on a thread of its own. */
static growing make_large(void) {
  recipe r = plain;
  r.width = 1500;
  r.height = 1000;
  r.level = 1;
  r.idat_bytes = 100000;
  uint8_t *raw = make_raw(&r, 9);
  growing png = make_pair_png(&r, raw);
  free(raw);
  return png;
}

static void damage_of_a_large_image_is_told(void **state) {
  (void)state;
  growing png = make_large();
  for (size_t at = 200; at < png.size; at += png.size / 9) {
    png.data[at] ^= 0x10;
    growing cut = {png.data, at, 0};
    assert_int_equal(count_alone(&png, "large", at), 0);
    png.data[at] ^= 0x10;
    pair p = read_bytes(&cut);
    assert_status(NULL, p.ours.status, FG_ERR_DATA);
    assert_status(NULL, p.libpng.status, FG_ERR_DATA);
    assert_has(p.ours.context.message, "is cut off (chunk IDAT");
    free_pair(&p);
  }
  free(png.data);
}

/* A scan may be closed, or summed, at any row. */
static void a_large_image_may_be_left(void **state) {
  (void)state;
  growing png = make_large();
  char *path = save_bytes(png.data, png.size), whole[65] = "", left[65] = "";
  fg_context ctx = {0};
  uint8_t *rows = malloc(1500 * 1000);
  for (int64_t count = 0; count <= 1000; count += 125) {
    fg_scan *scan = NULL;
    assert_ok(&ctx, fg_scan_open(&ctx, path, &(fg_scan_options){.dpi = 600}, &scan));
    assert_ok(&ctx, fg_scan_read_rows(&ctx, scan, count, rows, 1500));
    if (count % 2 == 0) assert_ok(&ctx, fg_scan_sha256(&ctx, scan, left));
    if (count == 0) memcpy(whole, left, sizeof whole);
    assert_string_equal(left, whole);
    fg_scan_close(scan);
  }
  free(rows);
  unlink(path);
  free(path);
  free(png.data);
}

static void no_cut_is_taken(void **state) {
  (void)state;
  growing png = make_small(0);
  for (size_t size = 8; size < png.size; size++) {
    growing part = {png.data, size, 0};
    pair p = read_bytes(&part);
    if (p.ours.status == FG_OK || p.libpng.status == FG_OK) fail_msg("%zu bytes pass", size);
    free_pair(&p);
  }
  free(png.data);
}

/* Repeats from a row above, in streams that declare windows of every size: of those that are too
 * small, libpng refuses what reaches beyond. */
static void a_reach_beyond_the_window_is_refused(void **state) {
  (void)state;
  recipe r = plain;
  r.width = 3000;
  r.level = 9;
  uint8_t *raw = make_raw(&r, 4);
  for (uint32_t y = 1; y < r.height; y++)
    memcpy(raw + y * r.width, raw, r.width);
  for (uint8_t bits = 8; bits <= 15; bits++) {
    growing png = make_pair_png(&r, raw);
    bytes view = {png.data, png.size};
    uint8_t *head = png.data + 33 + 8;
    head[0] = (uint8_t)((bits - 8) << 4 | 8);
    head[1] = (uint8_t)(31 - head[0] * 256 % 31);
    seal_chunk(&view, 33);
    pair p = read_bytes(&png);
    assert_int_equal(p.libpng.status, bits < 12 ? FG_ERR_DATA : FG_OK);
    assert_int_equal(p.ours.status, p.libpng.status);
    free_pair(&p);
    free(png.data);
  }
  free(raw);
}

/* A stream that is sound up to its end, with rows missing, rows too many, or no such filter. */
static void wrong_rows_are_refused(void **state) {
  (void)state;
  recipe r = plain;
  uint8_t *raw = make_raw(&r, 3);
  for (int delta = -1; delta <= 1; delta++) {
    growing png = make_pair_png(&r, raw);
    bytes view = {png.data, png.size};
    put_32(png.data + 20, r.height + (uint32_t)delta);
    seal_chunk(&view, 8);
    pair p = read_bytes(&png);
    if ((p.ours.status == FG_OK) != (delta == 0)) fail_msg("%d rows: taken", delta);
    assert_int_equal(p.ours.status, p.libpng.status);
    free_pair(&p);
    free(png.data);
  }
  uint8_t *lines = filter_rows(&r, raw);
  lines[10 * (recipe_row_bytes(&r) + 1)] = 5;
  growing stream = deflate_rows(&r, lines), png = make_pair_png(&r, raw);
  png.size = 8 + 25;
  grow_chunk(&png, "IDAT", stream.data, (uint32_t)stream.size);
  grow_chunk(&png, "IEND", NULL, 0);
  pair p = read_bytes(&png);
  assert_status(NULL, p.ours.status, FG_ERR_DATA);
  assert_status(NULL, p.libpng.status, FG_ERR_DATA);
  assert_has(p.ours.context.message, "filter");
  assert_has(p.ours.context.message, "row 11 of");
  free_pair(&p);
  free(png.data);
  free(stream.data);
  free(lines);
  free(raw);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_colour_type_and_filter_decodes_as_libpng),
      cmocka_unit_test(every_way_to_deflate),
      cmocka_unit_test(every_split),
      cmocka_unit_test(more_than_a_block),
      cmocka_unit_test(no_wrong_byte_is_taken_otherwise),
      cmocka_unit_test(windows_are_believed_as_libpng_does),
      cmocka_unit_test(damage_of_a_large_image_is_told),
      cmocka_unit_test(a_large_image_may_be_left),
      cmocka_unit_test(no_cut_is_taken),
      cmocka_unit_test(a_reach_beyond_the_window_is_refused),
      cmocka_unit_test(wrong_rows_are_refused),
  };
  return cmocka_run_group_tests_name("png_differential", tests, NULL, NULL);
}
