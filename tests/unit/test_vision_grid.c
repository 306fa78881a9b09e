/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Grids of cells against the plainest way to the same answer. */
#include "support/measured_render.h"

#include "support/random.h"
#include "support/test.h"
#include "vision/grid.h"

enum { WIDTH = 37, HEIGHT = 29, ROUNDS = 60 };

/* Spreads one cell's label over all that is connected with it. */
static void flood(const uint8_t *mask, int x, int y, int32_t label, int32_t *labels) {
  if (x < 0 || y < 0 || x >= WIDTH || y >= HEIGHT) return;
  if (!mask[y * WIDTH + x] || labels[y * WIDTH + x]) return;
  labels[y * WIDTH + x] = label;
  for (int v = y - 1; v <= y + 1; v++)
    for (int u = x - 1; u <= x + 1; u++)
      flood(mask, u, v, label, labels);
}

static void check_blob(const int32_t *labels, int32_t label, const fg_blob *blob) {
  int low[2] = {WIDTH, HEIGHT}, high[2] = {-1, -1}, area = 0;
  for (int y = 0; y < HEIGHT; y++)
    for (int x = 0; x < WIDTH; x++) {
      if (labels[y * WIDTH + x] != label) continue;
      low[0] = x < low[0] ? x : low[0];
      low[1] = y < low[1] ? y : low[1];
      high[0] = x > high[0] ? x : high[0];
      high[1] = y > high[1] ? y : high[1];
      area++;
    }
  assert_int_equal(blob->x, low[0]);
  assert_int_equal(blob->y, low[1]);
  assert_int_equal(blob->width, high[0] - low[0] + 1);
  assert_int_equal(blob->height, high[1] - low[1] + 1);
  assert_int_equal(blob->area, area);
}

/* From a few cells to nearly all of them, which make spirals, combs and rings. */
static void labels_are_those_of_a_flood(void **state) {
  (void)state;
  uint64_t seed = 5;
  for (int round = 0; round < ROUNDS; round++) {
    fg_context ctx = {0};
    uint8_t mask[WIDTH * HEIGHT];
    int32_t labels[WIDTH * HEIGHT], wanted[WIDTH * HEIGHT] = {0}, count = 0, found;
    fg_blob *blobs;
    for (int i = 0; i < WIDTH * HEIGHT; i++)
      mask[i] = random_uniform(&seed) < 0.15 + 0.7 * round / ROUNDS;
    for (int i = 0; i < WIDTH * HEIGHT; i++)
      if (mask[i] && !wanted[i]) flood(mask, i % WIDTH, i / WIDTH, ++count, wanted);
    assert_ok(&ctx, fg_grid_label(&ctx, mask, WIDTH, HEIGHT, labels, &blobs, &found));
    assert_int_equal(found, count);
    assert_memory_equal(labels, wanted, sizeof labels);
    for (int32_t i = 0; i < count; i++)
      check_blob(labels, i + 1, &blobs[i]);
    free(blobs);
  }
}

static int compare(const void *a, const void *b) {
  float x = *(const float *)a, y = *(const float *)b;
  return (x > y) - (x < y);
}

static int held(int value, int high) {
  return value < 0 ? 0 : value > high ? high : value;
}

static float sorted_median(const float *grid, int x, int y) {
  float values[25];
  size_t known = 0;
  for (int i = 0; i < 25; i++) {
    float value = grid[held(y - 2 + i / 5, HEIGHT - 1) * WIDTH + held(x - 2 + i % 5, WIDTH - 1)];
    if (!isnan(value)) values[known++] = value;
  }
  qsort(values, known, sizeof *values, compare);
  return known ? values[known / 2] : NAN;
}

static void medians_ignore_unknown_cells(void **state) {
  (void)state;
  uint64_t seed = 6;
  fg_context ctx = {0};
  for (int round = 0; round < 4; round++) {
    float grid[WIDTH * HEIGHT], before[WIDTH * HEIGHT];
    for (int i = 0; i < WIDTH * HEIGHT; i++)
      grid[i] = random_uniform(&seed) < 0.3 * round ? NAN : (float)random_gaussian(&seed);
    memcpy(before, grid, sizeof before);
    assert_ok(&ctx, fg_grid_median(&ctx, grid, WIDTH, HEIGHT));
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
      float wanted = sorted_median(before, i % WIDTH, i / WIDTH);
      if (!isnan(wanted)) assert_true(grid[i] == wanted);
      assert_true(grid[i] == grid[i]);
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(labels_are_those_of_a_flood),
      cmocka_unit_test(medians_ignore_unknown_cells),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
