#include "scan/format.h"

#include <stdbool.h>
#include <string.h>

static const uint8_t png_signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

#define CONVERT "convert it to PNG without loss, or scan to PNG"

static const struct {
  const char *magic;
  size_t offset, length;
  const char *problem;
} formats[] = {
    {"\xff\xd8\xff", 0, 3,
     "is a JPEG, not a PNG; JPEG's compression moves edges: scan again, to PNG"},
    {"II*\0", 0, 4, "is a TIFF, not a PNG; " CONVERT},
    {"MM\0*", 0, 4, "is a TIFF, not a PNG; " CONVERT},
    {"II+\0", 0, 4, "is a BigTIFF, not a PNG; " CONVERT},
    {"MM\0+", 0, 4, "is a BigTIFF, not a PNG; " CONVERT},
    {"GIF8", 0, 4, "is a GIF, not a PNG; " CONVERT},
    {"BM", 0, 2, "is a BMP, not a PNG; " CONVERT},
    {"%PDF", 0, 4, "is a PDF, not a PNG; scan again, to PNG"},
    {"WEBP", 8, 4, "is a WebP, not a PNG; scan again, to PNG"},
    {"jP  ", 4, 4, "is a JPEG 2000, not a PNG; scan again, to PNG"},
    {"\x8aMNG", 0, 4, "is an MNG, not a PNG; " CONVERT},
    {"\x8bJNG", 0, 4, "is a JNG, not a PNG; scan again, to PNG"},
    {"\x1f\x8b", 0, 2, "is compressed with gzip; unpack it first"},
    {"PK\3\4", 0, 4, "is a ZIP archive; unpack it first"},
    {"PNG", 1, 3,
     "has a damaged PNG signature, as after a transfer in text mode; copy it again in binary mode"},
};

static bool is_text(const uint8_t *head, size_t length) {
  for (size_t i = 0; i < length; i++) {
    bool space = head[i] >= '\t' && head[i] <= '\r';
    if (!space && (head[i] < ' ' || head[i] == 0x7f)) return false;
  }
  return true;
}

const char *fg_format_problem(const uint8_t *head, size_t length) {
  size_t signature_length = length < sizeof png_signature ? length : sizeof png_signature;
  if (length == 0) return "is empty; scan or copy it again";
  if (!memcmp(head, png_signature, signature_length)) return NULL;
  for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++)
    if (length >= formats[i].offset + formats[i].length &&
        !memcmp(head + formats[i].offset, formats[i].magic, formats[i].length))
      return formats[i].problem;
  if (is_text(head, length)) return "is a text, not a PNG scan; check the name";
  return "is not a PNG; scan to PNG, or check the name";
}
