/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/stored_name.h"

#include <stdbool.h>
#include <string.h>

#include "core/memory.h"
#include "core/utf8.h"

static const char digits[] = "0123456789ABCDEF";

/* Length of the first character of `text` if it is stored as it is; 0: its first byte is stored by
 * its number. C1 are the control characters of two bytes, C2 80 to C2 9F. */
static size_t count_plain(const char *text) {
  const unsigned char *at = (const unsigned char *)text;
  size_t length = fg_utf8_length(text);
  bool control = at[0] < ' ' || at[0] == 0x7F || (length == 2 && at[0] == 0xC2 && at[1] < 0xA0);
  return control ? 0 : length;
}

fg_status fg_stored_name(fg_context *ctx, const char *name, char **stored) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, 3 * strlen(name) + 1, 1, &block));
  char *to = *stored = block;
  while (*name) {
    size_t plain = count_plain(name), taken = plain ? plain : 1;
    if (plain) {
      memcpy(to, name, plain);
      to += plain;
    } else {
      *to++ = '/';
      *to++ = digits[(unsigned char)*name >> 4];
      *to++ = digits[*name & 15];
    }
    name += taken;
  }
  *to = '\0';
  return FG_OK;
}

static int digit_of(char c) {
  const char *at = c ? strchr(digits, c) : NULL;
  return at ? (int)(at - digits) : -1;
}

fg_status fg_stored_name_path(fg_context *ctx, const char *folder, const char *stored,
                              char **path) {
  void *block;
  size_t length = strlen(folder);
  FG_TRY(fg_memory_allocate(ctx, length + strlen(stored) + 2, 1, &block));
  char *to = *path = block;
  memcpy(to, folder, length);
  to += length;
  *to++ = '/';
  while (*stored) {
    int high = *stored == '/' ? digit_of(stored[1]) : -1;
    int low = high >= 0 ? digit_of(stored[2]) : -1;
    bool number = low >= 0 && (high || low);
    char byte = *stored;
    if (number) byte = (char)(high << 4 | low);
    *to++ = byte;
    stored += number ? 3 : 1;
  }
  *to = '\0';
  return FG_OK;
}
