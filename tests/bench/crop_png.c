/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cuts pieces out of a large gray PNG, reading it once: pixels and resolution stay as they are.
 *
 * Usage: crop_png BED.png < LIST; each line of LIST: x y width height PIECE.png
 */
#include <png.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

enum { PIECES_MAX = 256 };

typedef struct piece {
  uint32_t x, y, width, height;
  char path[1024];
  FILE *file;
  png_structp png;
  png_infop info;
} piece;

typedef struct bed {
  png_structp png;
  png_infop info;
  uint32_t width, height;
  int depth;
} bed;

static void stop(const char *words, const char *name) {
  fprintf(stderr, "crop_png: %s: %s\n", name, words);
  exit(EXIT_FAILURE);
}

static void on_error(png_structp png, png_const_charp words) {
  (void)png;
  stop(words, "libpng");
}

static bed open_bed(const char *path) {
  bed b = {0};
  FILE *file = fopen(path, "rb");
  if (!file) stop("cannot be opened", path);
  b.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, on_error, NULL);
  b.info = png_create_info_struct(b.png);
  png_init_io(b.png, file);
  png_read_info(b.png, b.info);
  b.width = png_get_image_width(b.png, b.info);
  b.height = png_get_image_height(b.png, b.info);
  b.depth = png_get_bit_depth(b.png, b.info);
  if (png_get_color_type(b.png, b.info) != PNG_COLOR_TYPE_GRAY) stop("is not gray", path);
  return b;
}

static void open_piece(const bed *b, piece *p) {
  p->file = fopen(p->path, "wb");
  if (!p->file) stop("cannot be written", p->path);
  p->png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, on_error, NULL);
  p->info = png_create_info_struct(p->png);
  png_init_io(p->png, p->file);
  png_set_compression_level(p->png, 1);
  png_set_IHDR(p->png, p->info, p->width, p->height, b->depth, PNG_COLOR_TYPE_GRAY,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  uint32_t x = 0, y = 0;
  int unit = 0;
  if (png_get_pHYs(b->png, b->info, &x, &y, &unit)) png_set_pHYs(p->png, p->info, x, y, unit);
  png_write_info(p->png, p->info);
}

static void close_piece(piece *p) {
  png_write_end(p->png, NULL);
  png_destroy_write_struct(&p->png, &p->info);
  if (fclose(p->file)) stop("cannot be written", p->path);
}

static void write_row(const bed *b, piece *p, uint32_t y, unsigned char *row) {
  if (y < p->y || y >= p->y + p->height) return;
  if (y == p->y) open_piece(b, p);
  png_write_row(p->png, row + (size_t)p->x * (size_t)b->depth / 8);
  if (y + 1 == p->y + p->height) close_piece(p);
}

int main(int argc, char **argv) {
  static piece pieces[PIECES_MAX];
  if (argc != 2) stop("BED.png < LIST", "usage");
  bed b = open_bed(argv[1]);
  size_t count = 0;
  for (piece *p = pieces; count < PIECES_MAX && scanf("%u %u %u %u %1023s", &p->x, &p->y, &p->width,
                                                      &p->height, p->path) == 5;
       count++, p++)
    if (p->x + p->width > b.width || p->y + p->height > b.height) stop("lies outside", p->path);
  unsigned char *row = malloc(png_get_rowbytes(b.png, b.info));
  if (!row) stop("out of memory", argv[1]);
  for (uint32_t y = 0; y < b.height; y++) {
    png_read_row(b.png, row, NULL);
    for (size_t i = 0; i < count; i++)
      write_row(&b, &pieces[i], y, row);
  }
  free(row);
  return 0;
}
