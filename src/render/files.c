/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A render as a PNG file, row by row, and its truth beside it. */
#include <math.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>

#include <png.h>

#include "core/file.h"
#include "foilgauge/render.h"

typedef struct png_out {
  fg_context *ctx;
  fg_output file;
  png_structp png;
  png_infop info;
  jmp_buf failed;
  fg_status status; /* of the call that failed */
} png_out;

/* libpng and zlib have no code for exhausted memory, only words: "insufficient memory", "Out of
 * memory". */
static void on_error(png_structp png, png_const_charp words) {
  png_out *out = png_get_error_ptr(png);
  out->status = strcasestr(words, "memory") ? FG_ERR_MEMORY : FG_ERR_IO;
  fg_fail(out->ctx, out->status, "%s: cannot be written: %s",
          out->file.path ? out->file.path : "standard output", words);
  longjmp(out->failed, 1);
}

static void on_warning(png_structp png, png_const_charp words) {
  (void)png;
  (void)words;
}

static void write_header(png_out *out, const fg_render_truth *truth) {
  png_init_io(out->png, out->file.stream);
  png_set_IHDR(out->png, out->info, (png_uint_32)truth->width_px, (png_uint_32)truth->height_px,
               truth->bits, truth->channels == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_pHYs(out->png, out->info, (png_uint_32)lround(truth->dpi[0] / 0.0254),
               (png_uint_32)lround(truth->dpi[1] / 0.0254), PNG_RESOLUTION_METER);
  /* Noise does not repeat: only the frequencies of single values compress. */
  png_set_filter(out->png, PNG_FILTER_TYPE_BASE, PNG_FILTER_NONE);
  png_set_compression_level(out->png, 1);
  png_set_compression_strategy(out->png, 2 /* Z_HUFFMAN_ONLY */);
  png_set_compression_buffer_size(out->png, (size_t)1 << 18);
  png_write_info(out->png, out->info);
  if (truth->bits == 16) png_set_swap(out->png);
}

static fg_status put_header(png_out *out, const fg_render_truth *truth) {
  if (setjmp(out->failed)) return out->status;
  write_header(out, truth);
  return FG_OK;
}

static fg_status write_png_row(fg_context *ctx, void *user, int64_t row, const void *pixels) {
  (void)ctx;
  (void)row;
  png_out *out = user;
  if (setjmp(out->failed)) return out->status;
  png_write_row(out->png, (png_const_bytep)pixels);
  return FG_OK;
}

static fg_status put_end(png_out *out) {
  if (setjmp(out->failed)) return out->status;
  png_write_end(out->png, NULL);
  return FG_OK;
}

static fg_status write_png(fg_context *ctx, const fg_render_spec *spec, png_out *out) {
  out->png = png_create_write_struct(PNG_LIBPNG_VER_STRING, out, on_error, on_warning);
  out->info = out->png ? png_create_info_struct(out->png) : NULL;
  if (!out->info) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory for libpng");
  FG_TRY(put_header(out, fg_render_get_truth(spec)));
  FG_TRY(fg_render_rows(ctx, spec, 0, write_png_row, out));
  return put_end(out);
}

static fg_status write_truth(fg_context *ctx, const fg_render_spec *spec, fg_output *out) {
  char *json = NULL;
  FG_TRY(fg_render_truth_json(ctx, spec, &json));
  fprintf(out->stream, "%s\n", json);
  free(json);
  return FG_OK;
}

fg_status fg_render_scan(fg_context *ctx, const fg_render_spec *spec, const char *scan_path,
                         const char *truth_path) {
  png_out scan = {.ctx = ctx};
  fg_output truth = {0};
  fg_status status = FG_OK;
  FG_TRY(fg_output_open(ctx, scan_path, &scan.file));
  FG_TRY_EXIT(truth_path ? fg_output_open(ctx, truth_path, &truth) : FG_OK);
  FG_TRY_EXIT(fg_output_flush(ctx, &scan.file, write_png(ctx, spec, &scan)));
  if (truth_path) FG_TRY_EXIT(fg_output_flush(ctx, &truth, write_truth(ctx, spec, &truth)));
  FG_TRY_EXIT(fg_output_commit(ctx, &scan.file));
  FG_TRY_EXIT(truth_path ? fg_output_commit(ctx, &truth) : FG_OK);
exit:
  png_destroy_write_struct(&scan.png, &scan.info);
  fg_output_discard(&scan.file);
  if (truth_path) fg_output_discard(&truth);
  return status;
}
