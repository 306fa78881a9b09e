/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan/format.h"

#include <stdbool.h>
#include <string.h>
#include <strings.h>

#include "core/text.h"

static const fg_format *const readable[] = {&fg_format_png, &fg_format_tiff, &fg_format_pnm,
                                            &fg_format_jpeg};

enum { READABLE = sizeof readable / sizeof readable[0] };

#define CONVERT "convert it to PNG or TIFF without loss, or scan to PNG"

static const struct {
  const char *magic;
  size_t offset, length;
  const char *problem;
} others[] = {
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

fg_status fg_format_refuse_lossy(fg_context *ctx, const char *name, const char *compression) {
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: is compressed with loss (%s), which moves edges; scan again to PNG or TIFF, "
                 "or take it as it is, with wider uncertainties: \"allow_lossy\": true in a "
                 "recipe, or the option --allow-lossy of measure, lot and loop",
                 name, compression);
}

static bool is_text(const uint8_t *head, size_t length) {
  for (size_t i = 0; i < length; i++) {
    bool space = head[i] >= '\t' && head[i] <= '\r';
    if (!space && (head[i] < ' ' || head[i] == 0x7f)) return false;
  }
  return true;
}

const fg_format *const *fg_formats(size_t *count) {
  *count = READABLE;
  return readable;
}

const fg_format *fg_format_find(const uint8_t *head, size_t length) {
  for (size_t i = 0; i < READABLE && length > 0; i++)
    if (readable[i]->matches(head, length)) return readable[i];
  return NULL;
}

bool fg_format_has_name(const char *name) {
  const char *dot = strrchr(name, '.');
  for (size_t i = 0; dot && i < READABLE; i++)
    for (const char *const *ending = readable[i]->endings; *ending; ending++)
      if (!strcasecmp(dot, *ending)) return true;
  return false;
}

static void append_word(char *text, size_t size, const char *separator, const char *word) {
  size_t used = strlen(text);
  fg_text_clip(text + used, size - used, "%s%s", used ? separator : "", word);
}

void fg_format_list_endings(char *text, size_t size) {
  text[0] = '\0';
  for (size_t i = 0; i < READABLE; i++)
    for (const char *const *ending = readable[i]->endings; *ending; ending++)
      append_word(text, size, ", ", *ending);
}

void fg_scan_format_names(const char *before_last, char *text, size_t size) {
  text[0] = '\0';
  for (size_t i = 0; i < READABLE; i++)
    append_word(text, size, i + 1 < READABLE ? ", " : before_last, readable[i]->name);
}

static const char *known_problem(const uint8_t *head, size_t length) {
  if (length == 0) return "is empty; scan or copy it again";
  for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
    if (length >= others[i].offset + others[i].length &&
        !memcmp(head + others[i].offset, others[i].magic, others[i].length))
      return others[i].problem;
  return is_text(head, length) ? "is a text, not a scan; check the name" : NULL;
}

void fg_format_problem(const uint8_t *head, size_t length, char *text, size_t size) {
  const char *known = known_problem(head, length);
  char names[100];
  fg_scan_format_names(", ", names, sizeof names);
  if (known)
    fg_text_clip(text, size, "%s", known);
  else
    fg_text_clip(text, size, "is not a scan that can be read (%s); scan to PNG, or check the name",
                 names);
}
