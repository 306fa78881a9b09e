/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan/png_stream.h"

#include <isa-l/crc.h>
#include <isa-l/igzip_lib.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

enum { INPUT_BYTES = 1 << 16, CRC_BYTES = 4, ZLIB_HEAD_BYTES = 2 };

typedef struct problem {
  bool found;
  const char *words; /* NULL: cut off */
} problem;

struct fg_png_stream {
  fg_source *source;
  /* The run of IDAT chunks: */
  uint32_t chunk_left, crc;
  bool run_ended;
  uint8_t next_head[FG_PNG_CHUNK_HEAD_BYTES]; /* of the chunk that ended it */
  problem input_problem;                      /* valid when all input before it is decompressed */
  /* Their content: */
  struct inflate_state *state;
  bool begun, ended;
  problem problem;
  uint8_t *input;
};

static uint32_t read_32(const uint8_t *at) {
  return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

static bool is_idat(const uint8_t *head) {
  return !memcmp(head + 4, "IDAT", 4);
}

static void begin_chunk(fg_png_stream *stream, const uint8_t *head) {
  stream->chunk_left = read_32(head);
  stream->crc = crc32_gzip_refl(0, head + 4, 4);
}

static bool fail_input(fg_png_stream *stream, const char *words) {
  if (!stream->input_problem.found) stream->input_problem = (problem){true, words};
  return false;
}

static bool fail_stream(fg_png_stream *stream, const char *words) {
  if (!stream->problem.found) stream->problem = (problem){true, words};
  return false;
}

/* Ends a chunk: reads its checksum and the head of the next chunk. */
static bool end_chunk(fg_png_stream *stream) {
  uint8_t bytes[CRC_BYTES + FG_PNG_CHUNK_HEAD_BYTES];
  size_t got = fg_source_read(stream->source, bytes, sizeof bytes);
  if (got >= CRC_BYTES && read_32(bytes) != stream->crc) return fail_input(stream, "CRC error");
  if (got < sizeof bytes) return fail_input(stream, NULL);
  const uint8_t *head = bytes + CRC_BYTES;
  if (is_idat(head)) {
    if (head[0] & 0x80) return fail_input(stream, "PNG unsigned integer out of range");
    begin_chunk(stream, head);
    return true;
  }
  memcpy(stream->next_head, head, sizeof stream->next_head);
  stream->run_ended = true;
  return false;
}

/* Reads at most `wanted` bytes of the chunks' data; fewer at the end of the run or before an error.
 */
static size_t receive_data(fg_png_stream *stream, uint8_t *out, size_t wanted) {
  size_t done = 0;
  while (done < wanted && !stream->run_ended && !stream->input_problem.found) {
    size_t part = wanted - done < stream->chunk_left ? wanted - done : stream->chunk_left;
    size_t got = fg_source_read(stream->source, out + done, part);
    stream->crc = crc32_gzip_refl(stream->crc, out + done, got);
    stream->chunk_left -= (uint32_t)got;
    done += got;
    if (got < part)
      fail_input(stream, NULL);
    else if (stream->chunk_left == 0)
      end_chunk(stream);
  }
  return done;
}

/* RFC 1950: method, window and their check. */
static bool begin_stream(fg_png_stream *stream) {
  uint8_t head[ZLIB_HEAD_BYTES];
  if (receive_data(stream, head, sizeof head) < sizeof head) {
    if (stream->input_problem.found) return fail_stream(stream, stream->input_problem.words);
    return fail_stream(stream, "Not enough image data");
  }
  if ((head[0] * 256u + head[1]) % 31) return fail_stream(stream, "incorrect header check");
  if ((head[0] & 0xf) != 8) return fail_stream(stream, "unknown compression method");
  if (head[0] >> 4 > 7) return fail_stream(stream, "invalid window size");
  if (head[1] & 0x20) return fail_stream(stream, "missing LZ dictionary");
  isal_inflate_init(stream->state);
  stream->state->crc_flag = ISAL_ZLIB_NO_HDR_VER;
  stream->state->hist_bits = (head[0] >> 4) + 8u;
  stream->begun = true;
  return true;
}

static const char *explain_inflate(int code) {
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

/* Error of a stream that needs more input than there is. */
static bool fail_for_want(fg_png_stream *stream) {
  if (stream->input_problem.found) return fail_stream(stream, stream->input_problem.words);
  return fail_stream(stream,
                     stream->run_ended ? "Not enough image data" : "invalid compressed data");
}

size_t fg_png_stream_read(fg_png_stream *stream, uint8_t *out, size_t wanted) {
  struct inflate_state *state = stream->state;
  if (!stream->begun && !begin_stream(stream)) return 0;
  state->next_out = out;
  state->avail_out = (uint32_t)wanted;
  while (state->avail_out > 0 && !stream->ended && !stream->problem.found) {
    if (state->avail_in == 0) {
      state->next_in = stream->input;
      state->avail_in = (uint32_t)receive_data(stream, stream->input, INPUT_BYTES);
    }
    uint32_t given = state->avail_in, room = state->avail_out;
    int code = isal_inflate(state);
    stream->ended = code == ISAL_DECOMP_OK && state->block_state == ISAL_BLOCK_FINISH;
    if (code != ISAL_DECOMP_OK)
      fail_stream(stream, explain_inflate(code));
    else if (!stream->ended && state->avail_in == given && state->avail_out == room)
      fail_for_want(stream);
  }
  return wanted - state->avail_out;
}

bool fg_png_stream_finish(fg_png_stream *stream, uint8_t head[FG_PNG_CHUNK_HEAD_BYTES]) {
  uint8_t beyond;
  if (fg_png_stream_read(stream, &beyond, 1) > 0) return fail_stream(stream, "Too much image data");
  if (!stream->ended || stream->problem.found) return false;
  while (receive_data(stream, stream->input, INPUT_BYTES) > 0)
    continue;
  if (stream->input_problem.found) return fail_stream(stream, stream->input_problem.words);
  memcpy(head, stream->next_head, FG_PNG_CHUNK_HEAD_BYTES);
  return true;
}

const char *fg_png_stream_problem(const fg_png_stream *stream) {
  return stream->problem.found ? stream->problem.words : "Not enough image data";
}

fg_status fg_png_stream_open(fg_context *ctx, fg_source *source,
                             const uint8_t head[FG_PNG_CHUNK_HEAD_BYTES], fg_png_stream **out) {
  fg_png_stream *stream = NULL;
  fg_status status = FG_OK;
  *out = NULL;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *stream, (void **)&stream));
  stream->source = source;
  FG_TRY_EXIT(fg_memory_allocate(ctx, 1, sizeof *stream->state, (void **)&stream->state));
  FG_TRY_EXIT(fg_memory_allocate(ctx, INPUT_BYTES, 1, (void **)&stream->input));
  begin_chunk(stream, head);
  if (stream->chunk_left == 0) end_chunk(stream);
  *out = stream;
exit:
  if (status != FG_OK) fg_png_stream_close(stream);
  return status;
}

void fg_png_stream_close(fg_png_stream *stream) {
  if (!stream) return;
  free(stream->state);
  free(stream->input);
  free(stream);
}
