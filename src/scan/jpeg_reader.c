/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan/jpeg_reader.h"

#include <inttypes.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* libjpeg's header needs stdio's types before it. */
#include <jerror.h>
#include <jpeglib.h>

#include "core/memory.h"
#include "scan/jpeg_tables.h"

enum { BUFFER_BYTES = 1 << 16, SEGMENT_BYTES_MAX = 0xffff };
/* Limit of the scans of a progressive file, which has some ten. Every scan of a malicious file goes
 * through all of a large image, for a few bytes each (libjpeg-turbo's own tools have a limit, too).
 */
enum { SCANS_MAX = 100 };

struct fg_jpeg_in {
  struct jpeg_decompress_struct jpeg;
  struct jpeg_error_mgr errors;
  struct jpeg_source_mgr input;
  struct jpeg_progress_mgr progress;
  jmp_buf failed;
  fg_source *source;
  fg_jpeg_header header;
  bool created, in_image, cut_off, luminance;
  uint8_t *buffer; /* BUFFER_BYTES */
  char words[JMSG_LENGTH_MAX];
};

static void fail_with_words(j_common_ptr jpeg) {
  fg_jpeg_in *reader = jpeg->client_data;
  jpeg->err->format_message(jpeg, reader->words);
  longjmp(reader->failed, 1);
}

/* Returns true for the few of libjpeg's warnings that leave all pixels right. */
static bool is_harmless(const fg_jpeg_in *reader) {
  int code = reader->errors.msg_code;
  bool filled = code == JWRN_EXTRANEOUS_DATA;
  return (filled && (!reader->in_image || reader->errors.msg_parm.i[1] == JPEG_EOI)) ||
         code == JWRN_ADOBE_XFORM || code == JWRN_JFIF_MAJOR;
}

static void on_message(j_common_ptr jpeg, int level) {
  if (level < 0 && !is_harmless(jpeg->client_data)) fail_with_words(jpeg);
}

static void on_output(j_common_ptr jpeg) {
  (void)jpeg;
}

static void begin_source(j_decompress_ptr jpeg) {
  (void)jpeg;
}

static boolean fill_buffer(j_decompress_ptr jpeg) {
  fg_jpeg_in *reader = jpeg->client_data;
  size_t got = fg_source_read(reader->source, reader->buffer, BUFFER_BYTES);
  if (got == 0) {
    reader->cut_off = true;
    longjmp(reader->failed, 1);
  }
  reader->input.next_input_byte = reader->buffer;
  reader->input.bytes_in_buffer = got;
  return TRUE;
}

static void skip_bytes(j_decompress_ptr jpeg, long count) {
  struct jpeg_source_mgr *input = jpeg->src;
  for (; count > 0 && (size_t)count > input->bytes_in_buffer;) {
    count -= (long)input->bytes_in_buffer;
    fill_buffer(jpeg);
  }
  if (count <= 0) return;
  input->next_input_byte += count;
  input->bytes_in_buffer -= (size_t)count;
}

static void watch_scans(j_common_ptr common) {
  fg_jpeg_in *reader = common->client_data;
  if (reader->jpeg.input_scan_number <= SCANS_MAX) return;
  snprintf(reader->words, sizeof reader->words, "it has more than %d scans", SCANS_MAX);
  longjmp(reader->failed, 1);
}

/* The one setjmp: runs `step`; false when libjpeg failed. */
static bool run_libjpeg(fg_jpeg_in *reader, void (*step)(fg_jpeg_in *, void *), void *row) {
  if (setjmp(reader->failed)) return false;
  step(reader, row);
  return true;
}

static void describe_place(const fg_jpeg_in *reader, char *place, size_t size) {
  uint64_t byte = reader->source->offset - reader->input.bytes_in_buffer;
  int length = snprintf(place, size, "byte %" PRIu64, byte);
  if (length < 0 || (size_t)length >= size || !reader->in_image) return;
  unsigned row = reader->jpeg.output_scanline, rows = reader->header.height_px;
  if (row < rows)
    snprintf(place + length, size - (size_t)length, ", row %u of %u", row + 1, rows);
  else
    snprintf(place + length, size - (size_t)length, ", after the last row");
}

static fg_status fail_jpeg(fg_context *ctx, const fg_jpeg_in *reader) {
  const char *name = reader->source->name;
  int code = reader->errors.msg_code;
  char place[96];
  describe_place(reader, place, sizeof place);
  FG_TRY(fg_source_check(ctx, reader->source, reader->cut_off, place));
  if (code == JERR_OUT_OF_MEMORY)
    return fg_fail(ctx, FG_ERR_MEMORY, "%s: out of memory (%s)", name, place);
  if (code == JERR_BAD_PRECISION || code == JERR_SOF_UNSUPPORTED || code == JERR_NOTIMPL)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: is a JPEG of a kind that is not read (%s); save it as 8-bit gray or RGB, "
                   "to PNG or TIFF",
                   name, reader->words);
  return fg_fail(ctx, FG_ERR_DATA, "%s: is a damaged JPEG: %s (%s); copy or scan it again", name,
                 reader->words, place);
}

static void create_libjpeg(fg_jpeg_in *reader, void *unused) {
  (void)unused;
  struct jpeg_decompress_struct *jpeg = &reader->jpeg;
  jpeg_create_decompress(jpeg);
  reader->created = true;
  jpeg->client_data = reader;
  reader->input = (struct jpeg_source_mgr){.init_source = begin_source,
                                           .fill_input_buffer = fill_buffer,
                                           .skip_input_data = skip_bytes,
                                           .resync_to_restart = jpeg_resync_to_restart,
                                           .term_source = begin_source};
  jpeg->src = &reader->input;
  reader->progress.progress_monitor = watch_scans;
  jpeg->progress = &reader->progress;
}

static void read_exif(fg_jpeg_in *reader) {
  reader->header.exif = (fg_exif){.dpi = {0}};
  fg_exif_read(NULL, 0, &reader->header.exif);
  for (jpeg_saved_marker_ptr m = reader->jpeg.marker_list; m; m = m->next) {
    fg_exif found;
    fg_exif_read(m->data, m->data_length, &found);
    if (found.orientation || found.dpi[0] > 0) reader->header.exif = found;
  }
}

/* Memory of whole images: every coefficient, two bytes each. */
static void count_blocks(fg_jpeg_in *reader) {
  const struct jpeg_decompress_struct *jpeg = &reader->jpeg;
  fg_jpeg_header *header = &reader->header;
  for (int i = 0; i < jpeg->num_components; i++) {
    const jpeg_component_info *part = &jpeg->comp_info[i];
    /* libjpeg rounds up to whole blocks of the largest channel. */
    uint64_t wide = (uint64_t)part->width_in_blocks + (unsigned)part->h_samp_factor;
    uint64_t high = (uint64_t)part->height_in_blocks + (unsigned)part->v_samp_factor;
    header->memory_bytes += wide * high * DCTSIZE2 * sizeof(JCOEF);
    header->blocks += (uint64_t)part->width_in_blocks * part->height_in_blocks;
  }
  if (!header->whole) header->memory_bytes = 0;
}

static void find_quality(fg_jpeg_in *reader) {
  const JQUANT_TBL *table = NULL;
  const jpeg_component_info *first = reader->jpeg.comp_info;
  uint16_t zigzag[64];
  if (first->quant_tbl_no >= 0 && first->quant_tbl_no < NUM_QUANT_TBLS)
    table = reader->jpeg.quant_tbl_ptrs[first->quant_tbl_no];
  if (!table) {
    snprintf(reader->words, sizeof reader->words, "it has no quantization table");
    longjmp(reader->failed, 1);
  }
  fg_jpeg_to_zigzag(table->quantval, zigzag);
  reader->header.quality = fg_jpeg_quality_of(zigzag);
}

static void read_header(fg_jpeg_in *reader, void *unused) {
  (void)unused;
  struct jpeg_decompress_struct *jpeg = &reader->jpeg;
  fg_jpeg_header *header = &reader->header;
  jpeg_save_markers(jpeg, JPEG_APP0 + 1, SEGMENT_BYTES_MAX);
  jpeg_read_header(jpeg, TRUE);
  header->width_px = jpeg->image_width;
  header->height_px = jpeg->image_height;
  header->colour = jpeg->jpeg_color_space == JCS_YCbCr || jpeg->jpeg_color_space == JCS_RGB;
  header->has_luminance =
      jpeg->jpeg_color_space == JCS_YCbCr || jpeg->jpeg_color_space == JCS_GRAYSCALE;
  header->whole = jpeg_has_multiple_scans(jpeg);
  header->arithmetic = jpeg->arith_code;
  header->has_density = jpeg->saw_JFIF_marker;
  header->density_unit = jpeg->density_unit;
  header->density[0] = jpeg->X_density;
  header->density[1] = jpeg->Y_density;
  count_blocks(reader);
  read_exif(reader);
  find_quality(reader);
}

static fg_status open_reader(fg_context *ctx, fg_jpeg_in *reader) {
  void *buffer;
  FG_TRY(fg_memory_allocate(ctx, BUFFER_BYTES, 1, &buffer));
  reader->buffer = buffer;
  reader->jpeg.err = jpeg_std_error(&reader->errors);
  reader->jpeg.client_data = reader;
  reader->errors.error_exit = fail_with_words;
  reader->errors.emit_message = on_message;
  reader->errors.output_message = on_output;
  if (!run_libjpeg(reader, create_libjpeg, NULL) || !run_libjpeg(reader, read_header, NULL))
    return fail_jpeg(ctx, reader);
  if (reader->header.colour || reader->header.has_luminance) return FG_OK;
  return fg_fail(
      ctx, FG_ERR_DATA,
      "%s: is a JPEG of %d channels for print (CMYK) or of unknown meaning, which is not "
      "read; save it as 8-bit gray or RGB",
      reader->source->name, reader->jpeg.num_components);
}

fg_status fg_jpeg_open(fg_context *ctx, fg_source *source, fg_jpeg_in **jpeg) {
  void *block;
  *jpeg = NULL;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof **jpeg, &block));
  fg_jpeg_in *reader = block;
  reader->source = source;
  fg_status status = open_reader(ctx, reader);
  if (status == FG_OK)
    *jpeg = reader;
  else
    fg_jpeg_close(reader);
  return status;
}

const fg_jpeg_header *fg_jpeg_get_header(const fg_jpeg_in *jpeg) {
  return &jpeg->header;
}

/* Starts without smoothing, which would invent the missing part of a cut-off progressive file. */
static void start_libjpeg(fg_jpeg_in *reader, void *unused) {
  (void)unused;
  struct jpeg_decompress_struct *jpeg = &reader->jpeg;
  jpeg->out_color_space = reader->luminance ? JCS_GRAYSCALE : JCS_RGB;
  jpeg->do_block_smoothing = FALSE;
  jpeg_start_decompress(jpeg);
}

fg_status fg_jpeg_start(fg_context *ctx, fg_jpeg_in *jpeg, bool luminance) {
  jpeg->luminance = luminance;
  jpeg->in_image = true;
  return run_libjpeg(jpeg, start_libjpeg, NULL) ? FG_OK : fail_jpeg(ctx, jpeg);
}

static void read_libjpeg_row(fg_jpeg_in *reader, void *samples) {
  JSAMPROW row = samples;
  jpeg_read_scanlines(&reader->jpeg, &row, 1);
}

fg_status fg_jpeg_read_row(fg_context *ctx, fg_jpeg_in *jpeg, void *samples) {
  return run_libjpeg(jpeg, read_libjpeg_row, samples) ? FG_OK : fail_jpeg(ctx, jpeg);
}

static void finish_libjpeg(fg_jpeg_in *reader, void *unused) {
  (void)unused;
  jpeg_finish_decompress(&reader->jpeg);
}

fg_status fg_jpeg_finish(fg_context *ctx, fg_jpeg_in *jpeg) {
  return run_libjpeg(jpeg, finish_libjpeg, NULL) ? FG_OK : fail_jpeg(ctx, jpeg);
}

void fg_jpeg_close(fg_jpeg_in *jpeg) {
  if (!jpeg) return;
  if (jpeg->created) jpeg_destroy_decompress(&jpeg->jpeg);
  free(jpeg->buffer);
  free(jpeg);
}
