/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/utf8.h"

#include <string.h>

/* The Unicode standard's table 3-7: the first byte decides the range of the second. */
size_t fg_utf8_length(const char *text) {
  static const struct {
    unsigned char first_low, first_high, second_low, second_high;
    size_t length;
  } sequences[] = {
      {0xC2, 0xDF, 0x80, 0xBF, 2}, {0xE0, 0xE0, 0xA0, 0xBF, 3}, {0xE1, 0xEC, 0x80, 0xBF, 3},
      {0xED, 0xED, 0x80, 0x9F, 3}, {0xEE, 0xEF, 0x80, 0xBF, 3}, {0xF0, 0xF0, 0x90, 0xBF, 4},
      {0xF1, 0xF3, 0x80, 0xBF, 4}, {0xF4, 0xF4, 0x80, 0x8F, 4},
  };
  const unsigned char *at = (const unsigned char *)text;
  if (at[0] < 0x80) return 1;
  for (size_t i = 0; i < sizeof sequences / sizeof sequences[0]; i++) {
    if (at[0] < sequences[i].first_low || at[0] > sequences[i].first_high) continue;
    if (at[1] < sequences[i].second_low || at[1] > sequences[i].second_high) return 0;
    for (size_t k = 2; k < sequences[i].length; k++)
      if (at[k] < 0x80 || at[k] > 0xBF) return 0;
    return sequences[i].length;
  }
  return 0;
}

bool fg_utf8_is_valid(const char *text) {
  size_t length = 1;
  while (*text && length) {
    length = fg_utf8_length(text);
    text += length;
  }
  return length > 0;
}

size_t fg_utf8_put(FILE *out, const char *text) {
  if ((unsigned char)*text < 0x80) {
    fputc(*text, out);
    return 1;
  }
  size_t length = fg_utf8_length(text);
  if (length)
    fwrite(text, 1, length, out);
  else
    fprintf(out, "\\x%02X", (unsigned char)*text);
  return length ? length : 1;
}

/* Length of a character by its first byte. */
static size_t promised_length(unsigned char first) {
  return first < 0xC2 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : first < 0xF5 ? 4 : 1;
}

/* C0, DEL, and C1 in UTF-8: a terminal would obey them. */
static bool is_obeyed(const char *text, size_t length) {
  unsigned char first = (unsigned char)text[0], second = (unsigned char)text[length > 1];
  if (length == 1) return (first < 0x20 && first != '\n' && first != '\t') || first == 0x7F;
  return length == 2 && first == 0xC2 && second < 0xA0;
}

size_t fg_utf8_make_visible(const char *bytes, size_t size, bool last, char *visible,
                            size_t *length) {
  static const char digits[] = "0123456789ABCDEF";
  size_t at = 0;
  *length = 0;
  while (at < size) {
    char next[5] = {0};
    memcpy(next, bytes + at, size - at < 4 ? size - at : 4);
    if (!last && promised_length((unsigned char)next[0]) > size - at) break;
    size_t taken = next[0] ? fg_utf8_length(next) : 1;
    bool plain = taken > 0 && !is_obeyed(next, taken);
    if (!taken) taken = 1;
    for (size_t i = 0; i < taken; i++) {
      unsigned char byte = (unsigned char)next[i];
      if (!plain) {
        memcpy(visible + *length, "\\x", 2);
        visible[*length + 2] = digits[byte >> 4];
        visible[*length + 3] = digits[byte & 15];
        *length += 4;
      } else {
        visible[(*length)++] = next[i];
      }
    }
    at += taken;
  }
  return at;
}

size_t fg_utf8_count(const char *text) {
  size_t count = 0;
  for (; *text; text++)
    count += ((unsigned char)*text & 0xC0) != 0x80; /* not a continuation byte */
  return count;
}
