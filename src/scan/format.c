#include "scan/format.h"

#include <stdbool.h>
#include <string.h>
#include <strings.h>

#include "core/text.h"

static const fg_format *const readable[] = {&fg_format_png, &fg_format_tiff, &fg_format_pnm};

#define CONVERT "convert it to PNG or TIFF without loss, or scan to PNG"

static const struct {
  const char *magic;
  size_t offset, length;
  const char *problem;
} formats[] = {
    {"\xff\xd8\xff", 0, 3,
     "is a JPEG, which is not read: its compression moves edges; scan again, to PNG or TIFF"},
    {"GIF8", 0, 4, "is a GIF, which is not read; " CONVERT},
    {"BM", 0, 2, "is a BMP, which is not read; " CONVERT},
    {"%PDF", 0, 4, "is a PDF, which is not read; scan again, to PNG"},
    {"WEBP", 8, 4, "is a WebP, which is not read; scan again, to PNG"},
    {"jP  ", 4, 4, "is a JPEG 2000, which is not read; scan again, to PNG"},
    {"\x8aMNG", 0, 4, "is an MNG, which is not read; " CONVERT},
    {"\x8bJNG", 0, 4, "is a JNG, which is not read; scan again, to PNG"},
    {"\x1f\x8b", 0, 2, "is compressed with gzip; unpack it first"},
    {"PK\3\4", 0, 4, "is a ZIP archive; unpack it first"},
    {"P1", 0, 2, "is a PNM as text, which is not read; save it as binary (P4, P5, P6)"},
    {"P2", 0, 2, "is a PNM as text, which is not read; save it as binary (P4, P5, P6)"},
    {"P3", 0, 2, "is a PNM as text, which is not read; save it as binary (P4, P5, P6)"},
    {"P7", 0, 2, "is a PAM, which is not read; " CONVERT},
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

const fg_format *fg_format_find(const uint8_t *head, size_t length) {
  for (size_t i = 0; i < sizeof readable / sizeof readable[0] && length > 0; i++)
    if (readable[i]->matches(head, length)) return readable[i];
  return NULL;
}

bool fg_format_has_name(const char *name) {
  const char *dot = strrchr(name, '.');
  for (size_t i = 0; dot && i < sizeof readable / sizeof readable[0]; i++)
    for (const char *const *ending = readable[i]->endings; *ending; ending++)
      if (!strcasecmp(dot, *ending)) return true;
  return false;
}

void fg_format_list_endings(char *text, size_t size) {
  size_t used = 0;
  text[0] = '\0';
  for (size_t i = 0; i < sizeof readable / sizeof readable[0]; i++)
    for (const char *const *ending = readable[i]->endings; *ending; ending++) {
      fg_text_clip(text + used, size - used, "%s%s", used ? ", " : "", *ending);
      used = strlen(text);
    }
}

const char *fg_format_problem(const uint8_t *head, size_t length) {
  if (length == 0) return "is empty; scan or copy it again";
  for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++)
    if (length >= formats[i].offset + formats[i].length &&
        !memcmp(head + formats[i].offset, formats[i].magic, formats[i].length))
      return formats[i].problem;
  if (is_text(head, length)) return "is a text, not a scan; check the name";
  return "is not a scan that can be read (PNG, TIFF, PNM); scan to PNG, or check the name";
}
