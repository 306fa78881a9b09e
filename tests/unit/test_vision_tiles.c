/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tiles and segmentation: kept pixels are exactly those of the scan, and nothing depends on the
 * way. */
#include "support/measured_render.h"

#include "core/select.h"
#include "support/random.h"
#include "support/test.h"
#include "vision/segment.h"

enum { WIDTH = 700, HEIGHT = 500 };

typedef struct scene {
  uint16_t pixels[HEIGHT][WIDTH]; /* on the 16-bit scale */
} scene;

/* A bright disc on a noisy background that gets brighter along x; sign -1: dark on light. */
static void paint(scene *s, double sign, double shade, double noise) {
  uint64_t seed = 11;
  double base = sign > 0 ? 30 : 220;
  for (int y = 0; y < HEIGHT; y++)
    for (int x = 0; x < WIDTH; x++) {
      double value = base + shade * x / WIDTH + noise * random_gaussian(&seed);
      if (hypot(x - 350, y - 230) < 60) value += sign * 120;
      s->pixels[y][x] = (uint16_t)lround(fmin(fmax(value, 0), 255) * 257);
    }
}

static fg_tiles fill(const scene *s, int bytes, bool strip_by_strip) {
  fg_context ctx = {0};
  fg_tiles tiles;
  static uint8_t rows[HEIGHT][WIDTH * 2 + 6];
  for (int y = 0; y < HEIGHT; y++)
    for (int x = 0; x < WIDTH; x++)
      if (bytes == 2)
        memcpy(&rows[y][2 * x], &s->pixels[y][x], 2);
      else
        rows[y][x] = (uint8_t)(s->pixels[y][x] / 257);
  assert_ok(&ctx, fg_tiles_create(&ctx, WIDTH, HEIGHT, bytes, NULL, &tiles));
  for (int strip = 0; strip * FG_TILE_PX < HEIGHT; strip++) {
    if (strip_by_strip) {
      assert_ok(&ctx, fg_tiles_add_strip(&ctx, &tiles, rows[strip * FG_TILE_PX], sizeof rows[0]));
      continue;
    }
    char *to = fg_tiles_strip(&tiles, strip);
    for (int y = 0; y < fg_tiles_strip_rows(&tiles, strip); y++)
      memcpy(to + y * WIDTH * bytes, rows[strip * FG_TILE_PX + y], (size_t)(WIDTH * bytes));
    assert_ok(&ctx, fg_tiles_accept_strip(&ctx, &tiles));
  }
  assert_ok(&ctx, fg_tiles_finish(&ctx, &tiles));
  return tiles;
}

static size_t kept(const fg_tiles *tiles) {
  size_t count = 0;
  for (int32_t i = 0; i < tiles->columns * tiles->rows; i++)
    count += tiles->tiles[i] != NULL;
  return count;
}

static void kept_pixels_are_the_scans_own(void **state) {
  (void)state;
  static scene s;
  paint(&s, 1, 0, 1);
  for (int bytes = 1; bytes <= 2; bytes++) {
    fg_tiles tiles = fill(&s, bytes, true);
    for (int y = 0; y < HEIGHT; y++)
      for (int x = 0; x < WIDTH; x++) {
        float value = fg_tiles_pixel(&tiles, x, y);
        float scan = bytes == 2 ? (float)s.pixels[y][x] / 257.0f : (float)(s.pixels[y][x] / 257);
        bool near_disc = hypot(x - 350, y - 230) < 60 + 16;
        if (near_disc && !isfinite(value)) fail_msg("(%d, %d) of the disc was not kept", x, y);
        if (isfinite(value)) assert_near(value, scan, 1e-4);
      }
    assert_true(isnan(fg_tiles_pixel(&tiles, -1, 0)) && isnan(fg_tiles_pixel(&tiles, 0, HEIGHT)));
    /* A disc of 2 tiles across with its neighbours, not the bed. */
    assert_in_range(kept(&tiles), 9, 36);
    fg_tiles_free(&tiles);
  }
}

static void tiles_do_not_depend_on_how_rows_arrive(void **state) {
  (void)state;
  static scene s;
  paint(&s, -1, 20, 1.5);
  for (int bytes = 1; bytes <= 2; bytes++) {
    fg_tiles a = fill(&s, bytes, true), b = fill(&s, bytes, false);
    size_t size = sizeof(fg_tile) + (size_t)(FG_TILE_PX * FG_TILE_PX * bytes);
    for (int32_t i = 0; i < a.columns * a.rows; i++) {
      assert_int_equal(!a.tiles[i], !b.tiles[i]);
      if (a.tiles[i]) assert_memory_equal(a.tiles[i], b.tiles[i], size);
    }
    fg_tiles_free(&a);
    fg_tiles_free(&b);
  }
}

/* Segments the first island. */
static fg_segmentation segment(fg_tiles *tiles, double min_px, fg_island *island) {
  fg_context ctx = {0};
  fg_islands *islands = NULL;
  fg_segmentation seg;
  assert_ok(&ctx, fg_islands_create(&ctx, tiles, &islands));
  assert_ok(&ctx, fg_islands_advance(&ctx, islands));
  assert_true(fg_islands_next(islands, island));
  assert_ok(&ctx, fg_segment(&ctx, tiles, island, min_px, &seg));
  fg_islands_free(islands);
  return seg;
}

static void polarity_and_contrast_are_found_under_shading(void **state) {
  (void)state;
  static scene s;
  const double shades[] = {0, 40, -25};
  for (int sign = -1; sign <= 1; sign += 2)
    for (size_t i = 0; i < 3; i++) {
      paint(&s, sign, sign > 0 ? shades[i] + 25 : shades[i] - 40, 1);
      fg_tiles tiles = fill(&s, 1, true);
      fg_island island;
      fg_segmentation seg = segment(&tiles, 60, &island);
      assert_int_equal(seg.light_on_dark, sign > 0);
      assert_near(seg.contrast, 120, 8);
      assert_int_equal(seg.object_count, 1);
      const fg_object *o = &seg.objects[0];
      assert_near((o->x + 0.5 * o->width) * FG_BLOCK_PX, 350, 8);
      assert_near((o->y + 0.5 * o->height) * FG_BLOCK_PX, 230, 8);
      assert_near(o->width * FG_BLOCK_PX, 120, 17);
      assert_false(o->touches_border);
      fg_segmentation_free(&seg);
      fg_island_free(&island);
      fg_tiles_free(&tiles);
    }
}

static void small_islands_are_specks(void **state) {
  (void)state;
  static scene s;
  paint(&s, 1, 0, 1);
  fg_tiles tiles = fill(&s, 1, true);
  fg_island island;
  fg_segmentation seg = segment(&tiles, 400, &island);
  assert_int_equal(seg.object_count, 0);
  assert_int_equal(seg.speck_count, 1);
  fg_segmentation_free(&seg);
  fg_island_free(&island);
  fg_tiles_free(&tiles);
}

/* Dust, specks and scratches beside a foil change neither its polarity nor how many foils. */
static void dust_is_no_foil(void **state) {
  (void)state;
  const char *polarity[] = {"\"background\":30,\"contrast\":175",
                            "\"background\":230,\"contrast\":-175"};
  for (int i = 0; i < 2; i++) {
    char json[4096];
    small_foil(json, sizeof json, 3, "",
               "%s,\"dpi\":2400,\"shading\":{\"x\":0.05,\"y\":-0.05,\"quadratic\":-0.05},"
               "\"dust\":{\"count\":60,\"radius_px\":3,\"contrast\":80},"
               "\"specks\":{\"count\":10,\"radius_px\":9,\"contrast\":100},"
               "\"scratches\":{\"count\":6,\"length_px\":200,\"radius_px\":0.8,\"contrast\":50}",
               polarity[i]);
    measured m = measure_render(json, NULL);
    assert_ok(NULL, m.status);
    assert_int_equal(m.result.light_on_dark, i == 0);
    assert_int_equal(m.result.foil_count, 1);
    assert_int_equal(m.result.foils[0].bump_count, 3);
    measured_free(&m);
  }
}

/* A tile's median is that of the sorted blocks, also where many are alike. */
static void test_few_values_are_selected_like_many(void **state) {
  enum { COUNT = 64 };
  (void)state;
  for (int kinds = 1; kinds <= 512; kinds *= 2)
    for (int k = 0; k < COUNT; k++) {
      float values[COUNT], copy[COUNT];
      for (int i = 0; i < COUNT; i++)
        values[i] = copy[i] = (float)(i * 7919 % 521 % kinds);
      assert_true(fg_select_of_few(values, COUNT, k) == fg_select_float(copy, COUNT, (size_t)k));
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_few_values_are_selected_like_many),
      cmocka_unit_test(kept_pixels_are_the_scans_own),
      cmocka_unit_test(tiles_do_not_depend_on_how_rows_arrive),
      cmocka_unit_test(polarity_and_contrast_are_found_under_shading),
      cmocka_unit_test(small_islands_are_specks),
      cmocka_unit_test(dust_is_no_foil),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
