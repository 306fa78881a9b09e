/* SPDX-License-Identifier: GPL-3.0-or-later */
/* to_jpeg SCAN OUT.jpg QUALITY [WORD...]: any scan as a JPEG of 8 bits, its resolution in the JFIF
 * header. Words: `444`, `420` colours (a warm tint) with chroma as it is or halved both ways,
 * `rgb`, `cmyk`, `progressive`, `nodpi`. Quality 0: the pixels as they are read, as a PGM. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jpeglib.h>

#include "foilgauge/scan.h"

typedef struct wishes {
  bool colour, halved, rgb, cmyk, progressive, nodpi;
} wishes;

static wishes read_wishes(int argc, char **argv) {
  wishes w = {0};
  for (int i = 4; i < argc; i++) {
    w.halved |= !strcmp(argv[i], "420");
    w.colour |= !strcmp(argv[i], "444") || !strcmp(argv[i], "420") || !strcmp(argv[i], "rgb");
    w.rgb |= !strcmp(argv[i], "rgb");
    w.cmyk |= !strcmp(argv[i], "cmyk");
    w.progressive |= !strcmp(argv[i], "progressive");
    w.nodpi |= !strcmp(argv[i], "nodpi");
  }
  return w;
}

static void set_up(struct jpeg_compress_struct *jpeg, const fg_scan_info *info, const wishes *w,
                   int quality) {
  jpeg->image_width = (JDIMENSION)info->width_px;
  jpeg->image_height = (JDIMENSION)info->height_px;
  jpeg->input_components = w->cmyk ? 4 : w->colour ? 3 : 1;
  jpeg->in_color_space = w->cmyk ? JCS_CMYK : w->colour ? JCS_RGB : JCS_GRAYSCALE;
  jpeg_set_defaults(jpeg);
  if (w->rgb) jpeg_set_colorspace(jpeg, JCS_RGB);
  jpeg_set_quality(jpeg, quality, TRUE);
  if (w->colour)
    jpeg->comp_info[0].h_samp_factor = jpeg->comp_info[0].v_samp_factor = w->halved ? 2 : 1;
  if (w->progressive) jpeg_simple_progression(jpeg);
  if (w->nodpi) return;
  jpeg->density_unit = 1;
  jpeg->X_density = (UINT16)(info->dpi[0] + 0.5);
  jpeg->Y_density = (UINT16)(info->dpi[1] + 0.5);
}

static void tint(const unsigned char *gray, int64_t width, int channels, unsigned char *row) {
  for (int64_t x = 0; x < width; x++, row += channels) {
    row[0] = gray[x];
    if (channels == 1) continue;
    row[1] = (unsigned char)(gray[x] * 15 / 16);
    row[2] = (unsigned char)(gray[x] * 3 / 4);
    if (channels == 4) row[3] = 255;
  }
}

static int write_pgm(fg_scan *scan, FILE *out) {
  const fg_scan_info *info = fg_scan_get_info(scan);
  size_t width = (size_t)info->width_px;
  unsigned char *row = malloc(width);
  fprintf(out, "P5\n%zu %lld\n255\n", width, (long long)info->height_px);
  for (int64_t y = 0; y < info->height_px; y++) {
    if (fg_scan_read_rows(NULL, scan, 1, row, info->width_px) != FG_OK) return 1;
    fwrite(row, 1, width, out);
  }
  fg_scan_close(scan);
  free(row);
  return fclose(out) == 0 ? 0 : 1;
}

int main(int argc, char **argv) {
  fg_context ctx = {.message = ""};
  fg_scan *scan = NULL;
  struct jpeg_compress_struct jpeg;
  struct jpeg_error_mgr errors;
  FILE *out = argc > 3 ? fopen(argv[2], "wb") : NULL;
  if (!out ||
      fg_scan_open(&ctx, argv[1], &(fg_scan_options){.allow_lossy = true}, &scan) != FG_OK) {
    fprintf(stderr, "to_jpeg: %s\n", ctx.message);
    return 1;
  }
  if (atoi(argv[3]) == 0) return write_pgm(scan, out);
  const fg_scan_info *info = fg_scan_get_info(scan);
  const wishes w = read_wishes(argc, argv);
  int64_t width = info->width_px, bytes = info->bytes_per_pixel;
  unsigned char *in = malloc((size_t)(width * bytes)), *row = malloc((size_t)width * 4);
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  jpeg_stdio_dest(&jpeg, out);
  set_up(&jpeg, info, &w, atoi(argv[3]));
  jpeg_start_compress(&jpeg, TRUE);
  for (int64_t y = 0; y < info->height_px; y++) {
    if (fg_scan_read_rows(&ctx, scan, 1, in, width * bytes) != FG_OK) return 1;
    for (int64_t x = 0; x < width && bytes == 2; x++)
      in[x] = (unsigned char)((((uint16_t *)(void *)in)[x] * 255u + 32767u) / 65535u);
    tint(in, width, jpeg.input_components, row);
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  fg_scan_close(scan);
  free(in);
  free(row);
  return fclose(out) == 0 ? 0 : 1;
}
