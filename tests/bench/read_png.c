/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cost of reading a scan: libpng alone, row by row, nothing kept. The baseline for the time
 * and memory that measuring takes.
 *
 * Usage: read_png SCAN.png; prints width, height and depth.
 */
#include <inttypes.h>
#include <png.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

/* The rows of an image that is not interlaced, each into the same buffer. */
static void read_rows(png_structp png, png_infop info, unsigned char *row) {
  const uint32_t height = png_get_image_height(png, info);
  for (uint32_t y = 0; y < height; y++)
    png_read_row(png, row, NULL);
  png_read_end(png, NULL);
}

static int read_scan(FILE *file) {
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
  png_infop info = png ? png_create_info_struct(png) : NULL;
  unsigned char *volatile row = NULL;
  volatile int code = EXIT_FAILURE;
  if (!info || setjmp(png_jmpbuf(png))) goto exit;
  png_init_io(png, file);
  png_read_info(png, info);
  if (png_get_interlace_type(png, info) != PNG_INTERLACE_NONE) goto exit;
  row = malloc(png_get_rowbytes(png, info));
  if (!row) goto exit;
  read_rows(png, info, row);
  printf("%" PRIu32 " %" PRIu32 " %d\n", png_get_image_width(png, info),
         png_get_image_height(png, info), png_get_bit_depth(png, info));
  code = EXIT_SUCCESS;
exit:
  free(row);
  png_destroy_read_struct(&png, &info, NULL);
  return code;
}

int main(int argc, char **argv) {
  FILE *file = argc == 2 ? fopen(argv[1], "rb") : NULL;
  if (!file) {
    fputs("usage: read_png SCAN.png\n", stderr);
    return 64;
  }
  const int code = read_scan(file);
  fclose(file);
  return code;
}
