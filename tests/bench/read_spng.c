/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cost of reading a scan with libspng, row by row, nothing kept: as read_png does it with libpng.
 *
 * Usage: read_spng SCAN.png; prints width, height and depth.
 */
#include <inttypes.h>
#include <spng.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

/* Every row of the image into a buffer of `size` bytes for one. Returns 0, or libspng's error. */
static int read_rows(spng_ctx *png, void *row, size_t size) {
  int code = spng_decode_image(png, NULL, 0, SPNG_FMT_PNG, SPNG_DECODE_PROGRESSIVE);
  while (!code)
    code = spng_decode_row(png, row, size);
  return code == SPNG_EOI ? 0 : code;
}

/* Returns 0, or libspng's error. */
static int read_scan(FILE *file) {
  struct spng_ihdr header;
  size_t image_size;
  void *row = NULL;
  spng_ctx *png = spng_ctx_new(0);
  int code = png ? spng_set_png_file(png, file) : SPNG_EMEM;
  if (!code) code = spng_get_ihdr(png, &header);
  if (!code) code = spng_decoded_image_size(png, SPNG_FMT_PNG, &image_size);
  if (!code && !(row = malloc(image_size / header.height))) code = SPNG_EMEM;
  if (!code) code = read_rows(png, row, image_size / header.height);
  if (!code) printf("%" PRIu32 " %" PRIu32 " %d\n", header.width, header.height, header.bit_depth);
  free(row);
  spng_ctx_free(png);
  return code;
}

int main(int argc, char **argv) {
  FILE *file = argc == 2 ? fopen(argv[1], "rb") : NULL;
  if (!file) {
    fputs("usage: read_spng SCAN.png\n", stderr);
    return 64;
  }
  const int code = read_scan(file);
  fclose(file);
  if (code) fprintf(stderr, "read_spng: %s\n", spng_strerror(code));
  return code ? EXIT_FAILURE : EXIT_SUCCESS;
}
