/* SPDX-License-Identifier: GPL-3.0-or-later */
/* JPEG of every kind that scanners write comes out as the picture that went in, within its loss;
 * the quality is that which it was made with; odd, wrong and hostile files are reported. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <jpeglib.h>

#include "foilgauge/scan.h"
#include "png_fixture.h"
#include "support/test.h"

enum { WIDTH = 93, HEIGHT = 70 };

typedef struct kind {
  const char *label;
  J_COLOR_SPACE in, kept; /* of the samples; in the file, 0: libjpeg's choice */
  int quality, halved, progressive, scans, unit;
  int dpi[2];
  const uint8_t *exif; /* as in APP1, without its identifier */
  size_t exif_bytes;
} kind;

static const kind plain = {"gray", JCS_GRAYSCALE, 0, 90, 0, 0, 0, 1, {600, 600}, NULL, 0};

/* Smooth: chroma that is halved loses little of it. */
static int gray_at(int x, int y) {
  return 40 + x + y;
}

static int channels_of(const kind *k) {
  return k->in == JCS_GRAYSCALE ? 1 : k->in == JCS_CMYK ? 4 : 3;
}

static void fill_row(const kind *k, int y, uint8_t *row) {
  for (int x = 0; x < WIDTH; x++)
    for (int c = 0; c < channels_of(k); c++)
      *row++ = (uint8_t)(gray_at(x, y) - (c == 2 ? 25 : 0));
}

/* More scans than anybody writes: one coefficient and one bit each. */
static void script_scans(struct jpeg_compress_struct *jpeg, jpeg_scan_info *scans, int count) {
  scans[0] = (jpeg_scan_info){1, {0}, 0, 0, 0, 0};
  for (int i = 1; i < count; i++) {
    int band = (i - 1) / 4 + 1, bit = 3 - (i - 1) % 4;
    scans[i] = (jpeg_scan_info){1, {0}, band, band, bit == 3 ? 0 : bit + 1, bit};
  }
  jpeg->scan_info = scans;
  jpeg->num_scans = count;
}

static void put_exif(struct jpeg_compress_struct *jpeg, const kind *k) {
  uint8_t marker[200] = "Exif\0";
  memcpy(marker + 6, k->exif, k->exif_bytes);
  jpeg_write_marker(jpeg, JPEG_APP0 + 1, marker, (unsigned)k->exif_bytes + 6);
}

static bytes write_jpeg(const kind *k) {
  struct jpeg_compress_struct jpeg;
  struct jpeg_error_mgr errors;
  static jpeg_scan_info scans[300];
  unsigned char *file = NULL;
  unsigned long size = 0;
  uint8_t row[WIDTH * 4], *rows[] = {row};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  jpeg_mem_dest(&jpeg, &file, &size);
  jpeg.image_width = WIDTH;
  jpeg.image_height = HEIGHT;
  jpeg.input_components = channels_of(k);
  jpeg.in_color_space = k->in;
  jpeg_set_defaults(&jpeg);
  if (k->kept) jpeg_set_colorspace(&jpeg, k->kept);
  jpeg_set_quality(&jpeg, k->quality, TRUE);
  if (k->halved) jpeg.comp_info[0].h_samp_factor = jpeg.comp_info[0].v_samp_factor = 2;
  if (k->in == JCS_RGB && !k->halved)
    jpeg.comp_info[0].h_samp_factor = jpeg.comp_info[0].v_samp_factor = 1;
  if (k->progressive) jpeg_simple_progression(&jpeg);
  if (k->scans) script_scans(&jpeg, scans, k->scans);
  jpeg.density_unit = (UINT8)k->unit;
  jpeg.X_density = (UINT16)k->dpi[0];
  jpeg.Y_density = (UINT16)k->dpi[1];
  jpeg_start_compress(&jpeg, TRUE);
  if (k->exif) put_exif(&jpeg, k);
  for (int y = 0; y < HEIGHT; y++) {
    fill_row(k, y, row);
    jpeg_write_scanlines(&jpeg, rows, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  return (bytes){file, size};
}

typedef struct reading {
  fg_scan_info info;
  double worst; /* of gray values against what went in */
} reading;

/* Value of fill_row in a channel. */
static double expected(const kind *k, fg_channel channel, int x, int y) {
  double blue = channels_of(k) == 3 ? 25 : 0;
  return gray_at(x, y) - (channel == FG_CHANNEL_BLUE  ? blue
                          : channel == FG_CHANNEL_RED ? 0
                                                      : 0.114 * blue);
}

static fg_status read_file(fg_context *ctx, const char *path, const kind *k,
                           const fg_scan_options *options, reading *r) {
  fg_scan *scan = NULL;
  uint8_t row[WIDTH];
  FG_TRY(fg_scan_open(ctx, path, options, &scan));
  r->info = *fg_scan_get_info(scan);
  r->worst = 0;
  fg_status status = r->info.width_px == WIDTH ? FG_OK : FG_ERR_DATA;
  for (int y = 0; y < r->info.height_px && status == FG_OK; y++) {
    status = fg_scan_read_rows(ctx, scan, 1, row, sizeof row);
    for (int x = 0; x < WIDTH && status == FG_OK; x++) {
      double off = row[x] - expected(k, r->info.channel, x, y);
      r->worst = off * off > r->worst * r->worst ? off : r->worst;
    }
  }
  fg_scan_close(scan);
  return status;
}

static fg_status read_bytes(fg_context *ctx, const bytes *file, const kind *k,
                            const fg_scan_options *options, reading *r) {
  char *path = save_bytes(file->data, file->size);
  fg_status status = read_file(ctx, path, k, options, r);
  if (status != FG_OK && ctx->message[0] && !strstr(ctx->message, path))
    fail_msg("no path: %s", ctx->message);
  unlink(path);
  free(path);
  return status;
}

static const fg_scan_options allowed = {.allow_lossy = true};

static fg_status read_kind(fg_context *ctx, const kind *k, const fg_scan_options *options,
                           reading *r) {
  bytes file = write_jpeg(k);
  fg_status status = read_bytes(ctx, &file, k, options, r);
  free(file.data);
  return status;
}

static void every_supported_jpeg_is_read(void **state) {
  (void)state;
  static const kind kinds[] = {
      {"gray", JCS_GRAYSCALE, 0, 95, 0, 0, 0, 1, {600, 600}, NULL, 0},
      {"gray, progressive", JCS_GRAYSCALE, 0, 95, 0, 1, 0, 1, {600, 600}, NULL, 0},
      {"4:4:4", JCS_RGB, 0, 95, 0, 0, 0, 1, {600, 600}, NULL, 0},
      {"4:2:0", JCS_RGB, 0, 95, 1, 0, 0, 1, {600, 600}, NULL, 0},
      {"4:2:0, progressive", JCS_RGB, 0, 95, 1, 1, 0, 1, {600, 600}, NULL, 0},
      {"RGB", JCS_RGB, JCS_RGB, 95, 0, 0, 0, 1, {600, 600}, NULL, 0},
  };
  static const fg_channel channels[] = {FG_CHANNEL_AUTO, FG_CHANNEL_RED, FG_CHANNEL_BLUE,
                                        FG_CHANNEL_LUMINANCE};
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
    for (size_t c = 0; c < sizeof channels / sizeof *channels; c++) {
      in_row("channels[%zu]", c);
      fg_context ctx = {0};
      reading r;
      fg_scan_options options = {.allow_lossy = true, .channel = channels[c], .dpi = 600};
      fg_status status = read_kind(&ctx, &kinds[i], &options, &r);
      if (status != FG_OK) fail_msg("%s: %s", kinds[i].label, ctx.message);
      assert_int_equal(r.info.jpeg_quality, 95);
      assert_string_equal(r.info.format, "JPEG");
      assert_int_equal(r.info.colour, kinds[i].in == JCS_RGB);
      if (r.worst > 4 || r.worst < -4) fail_msg("%s: off by %g", kinds[i].label, r.worst);
    }
}

static void nobody_gets_loss_unasked(void **state) {
  (void)state;
  fg_context ctx = {0};
  reading r;
  assert_status(&ctx, read_kind(&ctx, &plain, NULL, &r), FG_ERR_DATA);
  assert_has(ctx.message, "--allow-lossy");
  assert_has(ctx.message, "\"allow_lossy\": true");
}

static void the_tables_tell_the_quality(void **state) {
  (void)state;
  for (int quality = 1; quality <= 100; quality += quality < 70 ? 7 : 1) {
    fg_context ctx = {0};
    reading r;
    kind k = plain;
    k.quality = quality;
    assert_ok(&ctx, read_kind(&ctx, &k, &allowed, &r));
    assert_int_equal(r.info.jpeg_quality, quality < 100 ? quality : 99);
  }
}

/* Entries of a directory: XResolution, YResolution 2400/1, the unit, the orientation. */
#define EXIF_OF(unit, orientation)                                                                 \
  "II*\0\x08\0\0\0\x04\0"                                                                          \
  "\x12\x01\x03\0\x01\0\0\0" orientation "\0\0\0"                                                  \
  "\x1a\x01\x05\0\x01\0\0\0\x3e\0\0\0"                                                             \
  "\x1b\x01\x05\0\x01\0\0\0\x3e\0\0\0"                                                             \
  "\x28\x01\x03\0\x01\0\0\0" unit "\0\0\0\0\0\0\0"                                                 \
  "\x60\x09\0\0\x01\0\0\0"

static void resolution_comes_from_jfif_or_exif(void **state) {
  (void)state;
  static const uint8_t inches[] = EXIF_OF("\x02", "\x01"), turned[] = EXIF_OF("\x02", "\x06");
  static const uint8_t centimetres[] = EXIF_OF("\x03", "\x01"), none[] = EXIF_OF("\x01", "\x01");
  static const uint8_t wrong[] = "II*\0\xff\xff\0\0", big[] = "MM\0*\0\0\0\x08\xff\xff";
  static const struct {
    int unit, dpi;
    const uint8_t *exif;
    size_t exif_bytes;
    double expected; /* 0: an error that says --dpi */
    const char *says;
  } cases[] = {
      {1, 600, NULL, 0, 600, ""},
      {2, 945, NULL, 0, 2400, "whole dots per cm, 2400.3 × 2400.3 dpi"},
      {2, 472, NULL, 0, 1200, "1200 × 1200 were taken"},
      {2, 944, NULL, 0, 2400, "whole dots per cm"}, /* cut off, not rounded */
      {2, 400, NULL, 0, 1016, ""},                  /* 40 dots per mm */
      {0, 1, NULL, 0, 0, "no density"},
      {1, 2400, inches, sizeof inches - 1, 2400, ""},
      {1, 72, inches, sizeof inches - 1, 0, "contradict"},
      {0, 1, inches, sizeof inches - 1, 2400, ""},
      {0, 1, turned, sizeof turned - 1, 2400, "orientation tag (6)"},
      {0, 1, centimetres, sizeof centimetres - 1, 6096, ""},
      {0, 1, none, sizeof none - 1, 0, "no density"},
      {0, 1, inches, 40, 0, "no density"},
      {0, 1, wrong, sizeof wrong - 1, 0, "no density"},
      {0, 1, big, sizeof big - 1, 0, "no density"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    in_row("cases[%zu]", i);
    fg_context ctx = {0};
    reading r;
    kind k = plain;
    k.unit = cases[i].unit;
    k.dpi[0] = k.dpi[1] = cases[i].dpi;
    k.exif = cases[i].exif;
    k.exif_bytes = cases[i].exif_bytes;
    fg_status status = read_kind(&ctx, &k, &allowed, &r);
    assert_int_equal(status, cases[i].expected > 0 ? FG_OK : FG_ERR_DATA);
    const char *words = status == FG_OK ? r.info.warning : ctx.message;
    if (!strstr(words, cases[i].says)) fail_msg("case %zu: %s", i, words);
    if (status != FG_OK) assert_has(words, "--dpi");
    if (status == FG_OK) assert_float_equal(r.info.dpi[1], cases[i].expected, 0.02);
  }
}

static void expect(const char *label, const bytes *file, const fg_scan_options *options,
                   const char *says) {
  fg_context ctx = {0};
  reading r;
  fg_status status = read_bytes(&ctx, file, &plain, options, &r);
  if (status != FG_ERR_DATA) fail_msg("%s: status %d: %s", label, status, ctx.message);
  if (!strstr(ctx.message, says)) fail_msg("%s: no '%s': %s", label, says, ctx.message);
}

/* At every byte, as far as to the end of the image. */
static void cut_off_is_said_wherever_it_is(void **state) {
  (void)state;
  for (int progressive = 0; progressive <= 1; progressive++) {
    kind k = plain;
    k.progressive = progressive;
    bytes file = write_jpeg(&k);
    for (size_t size = 3; size < file.size; size += size < 700 ? 1 : 37)
      expect("cut off", &(bytes){file.data, size}, &allowed, "is cut off");
    expect("but the end", &(bytes){file.data, file.size - 2}, &allowed, "is cut off");
    free(file.data);
  }
}

/* JPEG has no checksum: some damage cannot be seen. Damage that is seen must be reported, and
 * nothing may break. */
static void no_byte_breaks_it(void **state) {
  (void)state;
  bytes file = write_jpeg(&plain);
  size_t seen = 0, tried = 0;
  for (size_t at = 0; at < file.size; at += at < 700 ? 1 : 11, tried++) {
    fg_context ctx = {0};
    reading r;
    file.data[at] ^= 0x55;
    fg_status status = read_bytes(&ctx, &file, &plain, &allowed, &r);
    assert_true(status == FG_OK || status == FG_ERR_DATA);
    seen += status != FG_OK;
    file.data[at] ^= 0x55;
  }
  assert_true(10 * seen > tried);
  free(file.data);
}

static void unsupported_jpegs_are_named(void **state) {
  (void)state;
  kind k = plain;
  k.in = JCS_CMYK;
  bytes file = write_jpeg(&k);
  expect("CMYK", &file, &allowed, "CMYK");
  free(file.data);
  file = write_jpeg(&plain);
  uint8_t *frame = memmem(file.data, file.size, "\xff\xc0", 2);
  frame[4] = 12; /* bits of a sample */
  expect("12 bits", &file, &allowed, "of a kind that is not read");
  frame[4] = 8;
  frame[1] = 0xc3; /* without loss */
  expect("lossless", &file, &allowed, "of a kind that is not read");
  frame[1] = 0xc0;
  uint8_t *tables = memmem(file.data, file.size, "\xff\xdb", 2);
  tables[1] = 0xfe; /* a comment */
  expect("no table", &file, &allowed, "quantization table");
  free(file.data);
}

/* Few bytes that would take much memory or time. */
static void hostile_jpegs_are_refused(void **state) {
  (void)state;
  bytes file = write_jpeg(&plain);
  uint8_t *frame = memmem(file.data, file.size, "\xff\xc0", 2);
  frame[5] = frame[7] = 0xff; /* libjpeg's own limit */
  frame[6] = frame[8] = 0xdc;
  expect("huge", &file, &allowed, "more than the 4000000000");
  frame[5] = frame[7] = 0x3f;
  expect("more than its bytes hold", &file, &allowed, "cannot hold");
  free(file.data);
  file = write_jpeg(&plain);
  expect("--max-pixels", &file, &(fg_scan_options){.allow_lossy = true, .pixel_cap = 1000},
         "more than the 1000");
  free(file.data);
  kind k = plain;
  k.progressive = 1;
  file = write_jpeg(&k);
  expect("--max-memory", &file, &(fg_scan_options){.allow_lossy = true, .memory_cap = 10000},
         "--max-memory");
  free(file.data);
  k.scans = 150;
  file = write_jpeg(&k);
  expect("scans", &file, &allowed, "more than 100 scans");
  free(file.data);
}

/* Of RGB the channel must be found, by a second reading. */
static void a_jpeg_is_read_from_a_pipe(void **state) {
  (void)state;
  kind k = plain;
  k.in = k.kept = JCS_RGB;
  bytes file = write_jpeg(&k);
  int ends[2];
  char path[32];
  fg_context ctx = {0};
  reading r;
  assert_int_equal(pipe(ends), 0);
  assert_true(file.size < 60000);
  assert_int_equal(write(ends[1], file.data, file.size), file.size);
  close(ends[1]);
  snprintf(path, sizeof path, "/proc/self/fd/%d", ends[0]);
  fg_status status =
      read_file(&ctx, path, &k, &(fg_scan_options){.allow_lossy = true, .dpi = 600}, &r);
  if (status != FG_OK) fail_msg("%s", ctx.message);
  close(ends[0]);
  free(file.data);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_supported_jpeg_is_read),
      cmocka_unit_test(nobody_gets_loss_unasked),
      cmocka_unit_test(the_tables_tell_the_quality),
      cmocka_unit_test(resolution_comes_from_jfif_or_exif),
      cmocka_unit_test(cut_off_is_said_wherever_it_is),
      cmocka_unit_test(no_byte_breaks_it),
      cmocka_unit_test(unsupported_jpegs_are_named),
      cmocka_unit_test(hostile_jpegs_are_refused),
      cmocka_unit_test(a_jpeg_is_read_from_a_pipe),
  };
  return cmocka_run_group_tests_name("scan_jpeg", tests, NULL, NULL);
}
