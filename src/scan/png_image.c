#include "scan/png_image.h"

#include <isa-l/crc.h>
#include <isa-l/igzip_lib.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "scan/png_unfilter.h"

/* Input and a block of rows stay in the processor's second cache together. */
enum { INPUT_BYTES = 1 << 16, BLOCK_BYTES = 1 << 17, CRC_BYTES = 4, ZLIB_HEAD_BYTES = 2 };

/* What ends the reading; the rows before it are handed out first. */
typedef struct problem {
  bool found;
  const char *words; /* NULL: cut off */
} problem;

struct fg_png_image {
  fg_source *source;
  fg_png_image_layout layout;
  /* The run of IDAT chunks: */
  uint32_t chunk_left, crc;
  bool run_ended;
  uint8_t next_head[FG_PNG_CHUNK_HEAD_BYTES]; /* of the chunk that ended it */
  problem input_problem;
  /* The compressed stream: */
  struct inflate_state *state;
  bool stream_begun, stream_ended;
  problem problem;
  uint8_t *input;
  /* Rows: */
  uint8_t *block, *above;
  size_t block_rows, filled_rows, taken_rows; /* of the block */
  uint32_t rows_left;                         /* that are not in the block yet */
};

static uint32_t read_32(const uint8_t *at) {
  return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

static bool is_idat(const uint8_t *head) {
  return !memcmp(head + 4, "IDAT", 4);
}

static void begin_chunk(fg_png_image *image, const uint8_t *head) {
  image->chunk_left = read_32(head);
  image->crc = crc32_gzip_refl(0, head + 4, 4);
}

static bool fail_input(fg_png_image *image, const char *words) {
  if (!image->input_problem.found) image->input_problem = (problem){true, words};
  return false;
}

static bool fail(fg_png_image *image, const char *words) {
  if (!image->problem.found) image->problem = (problem){true, words};
  return false;
}

/* Behind a chunk's data: its checksum and the head of the next chunk. */
static bool end_chunk(fg_png_image *image) {
  uint8_t bytes[CRC_BYTES + FG_PNG_CHUNK_HEAD_BYTES];
  size_t got = fg_source_read(image->source, bytes, sizeof bytes);
  if (got >= CRC_BYTES && read_32(bytes) != image->crc) return fail_input(image, "CRC error");
  if (got < sizeof bytes) return fail_input(image, NULL);
  const uint8_t *head = bytes + CRC_BYTES;
  if (is_idat(head)) {
    if (head[0] & 0x80) return fail_input(image, "PNG unsigned integer out of range");
    begin_chunk(image, head);
    return true;
  }
  memcpy(image->next_head, head, sizeof image->next_head);
  image->run_ended = true;
  return false;
}

/* At most `wanted` bytes of the chunks' data; fewer at the end of the run or before what is wrong
 * with it. */
static size_t receive(fg_png_image *image, uint8_t *out, size_t wanted) {
  size_t done = 0;
  while (done < wanted && !image->run_ended && !image->input_problem.found) {
    size_t part = wanted - done < image->chunk_left ? wanted - done : image->chunk_left;
    size_t got = fg_source_read(image->source, out + done, part);
    image->crc = crc32_gzip_refl(image->crc, out + done, got);
    image->chunk_left -= (uint32_t)got;
    done += got;
    if (got < part)
      fail_input(image, NULL);
    else if (image->chunk_left == 0)
      end_chunk(image);
  }
  return done;
}

/* RFC 1950: method, window and their check. */
static bool begin_stream(fg_png_image *image) {
  uint8_t head[ZLIB_HEAD_BYTES];
  if (receive(image, head, sizeof head) < sizeof head) {
    if (image->input_problem.found) return fail(image, image->input_problem.words);
    return fail(image, "Not enough image data");
  }
  if ((head[0] * 256u + head[1]) % 31) return fail(image, "incorrect header check");
  if ((head[0] & 0xf) != 8) return fail(image, "unknown compression method");
  if (head[0] >> 4 > 7) return fail(image, "invalid window size");
  if (head[1] & 0x20) return fail(image, "missing LZ dictionary");
  isal_inflate_init(image->state);
  image->state->crc_flag = ISAL_ZLIB_NO_HDR_VER;
  image->state->hist_bits = (head[0] >> 4) + 8u;
  image->stream_begun = true;
  return true;
}

static const char *explain(int code) {
  switch (code) {
  case ISAL_INVALID_BLOCK:
    return "invalid block of compressed data";
  case ISAL_INVALID_LOOKBACK:
    return "invalid distance too far back";
  case ISAL_INCORRECT_CHECKSUM:
    return "incorrect data check";
  default:
    return "invalid compressed data";
  }
}

/* What stopped a stream that wants more input than there is. */
static bool fail_for_want(fg_png_image *image) {
  if (image->input_problem.found) return fail(image, image->input_problem.words);
  return fail(image, image->run_ended ? "Not enough image data" : "invalid compressed data");
}

/* Decompresses at most `wanted` bytes; fewer at the end of the stream or before what is wrong. */
static size_t inflate_bytes(fg_png_image *image, uint8_t *out, size_t wanted) {
  struct inflate_state *state = image->state;
  if (!image->stream_begun && !begin_stream(image)) return 0;
  state->next_out = out;
  state->avail_out = (uint32_t)wanted;
  while (state->avail_out > 0 && !image->stream_ended && !image->problem.found) {
    if (state->avail_in == 0) {
      state->next_in = image->input;
      state->avail_in = (uint32_t)receive(image, image->input, INPUT_BYTES);
    }
    uint32_t given = state->avail_in, room = state->avail_out;
    int code = isal_inflate(state);
    image->stream_ended = code == ISAL_DECOMP_OK && state->block_state == ISAL_BLOCK_FINISH;
    if (code != ISAL_DECOMP_OK)
      fail(image, explain(code));
    else if (!image->stream_ended && state->avail_in == given && state->avail_out == room)
      fail_for_want(image);
  }
  return wanted - state->avail_out;
}

/* The next rows of the block, still filtered. */
static bool fill_block(fg_png_image *image) {
  size_t line = image->layout.row_bytes + 1;
  if (image->filled_rows)
    memcpy(image->above, image->block + (image->filled_rows - 1) * line + 1, line - 1);
  size_t rows = image->rows_left < image->block_rows ? image->rows_left : image->block_rows;
  image->filled_rows = inflate_bytes(image, image->block, rows * line) / line;
  image->taken_rows = 0;
  image->rows_left -= (uint32_t)image->filled_rows;
  if (image->filled_rows > 0) return true;
  return fail(image, "Not enough image data");
}

const uint8_t *fg_png_image_next(fg_png_image *image) {
  size_t size = image->layout.row_bytes;
  if (image->taken_rows == image->filled_rows && !fill_block(image)) return NULL;
  uint8_t *line = image->block + image->taken_rows * (size + 1);
  const uint8_t *above = image->taken_rows ? line - size : image->above;
  if (!fg_png_unfilter(line[0], image->layout.pixel_bytes, above, line + 1, size)) {
    image->problem = (problem){true, "bad adaptive filter value"};
    return NULL;
  }
  image->taken_rows++;
  return line + 1;
}

/* The stream must end where the rows do; bytes behind it do no harm. */
static bool end_stream(fg_png_image *image) {
  uint8_t beyond;
  if (inflate_bytes(image, &beyond, 1) > 0) return fail(image, "Too much image data");
  return image->stream_ended && !image->problem.found;
}

bool fg_png_image_finish(fg_png_image *image, uint8_t head[FG_PNG_CHUNK_HEAD_BYTES]) {
  if (!end_stream(image)) return false;
  while (receive(image, image->input, INPUT_BYTES) > 0)
    continue;
  if (image->input_problem.found) return fail(image, image->input_problem.words);
  memcpy(head, image->next_head, FG_PNG_CHUNK_HEAD_BYTES);
  return true;
}

const char *fg_png_image_problem(const fg_png_image *image) {
  return image->problem.words;
}

static fg_status allocate(fg_context *ctx, fg_png_image *image) {
  size_t line = image->layout.row_bytes + 1;
  image->block_rows = BLOCK_BYTES / line > 0 ? BLOCK_BYTES / line : 1;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *image->state, (void **)&image->state));
  FG_TRY(fg_memory_allocate(ctx, INPUT_BYTES, 1, (void **)&image->input));
  FG_TRY(fg_memory_allocate(ctx, image->block_rows, line, (void **)&image->block));
  return fg_memory_allocate(ctx, line, 1, (void **)&image->above);
}

fg_status fg_png_image_create(fg_context *ctx, fg_source *source,
                              const uint8_t head[FG_PNG_CHUNK_HEAD_BYTES],
                              const fg_png_image_layout *layout, fg_png_image **out) {
  fg_png_image *image = NULL;
  *out = NULL;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *image, (void **)&image));
  image->source = source;
  image->layout = *layout;
  image->rows_left = layout->height_px;
  fg_status status = allocate(ctx, image);
  if (status != FG_OK) {
    fg_png_image_free(image);
    return status;
  }
  begin_chunk(image, head);
  if (image->chunk_left == 0) end_chunk(image);
  *out = image;
  return FG_OK;
}

void fg_png_image_free(fg_png_image *image) {
  if (!image) return;
  free(image->state);
  free(image->input);
  free(image->block);
  free(image->above);
  free(image);
}
