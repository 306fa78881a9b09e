/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/json_read.h"

#include <ctype.h>
#include <stdbool.h>
#include <string.h>

enum { EXCERPT_MAX = 80 };

/* Each function below gets the start of its part of RFC 8259 and returns its end, or NULL where the
 * text breaks the grammar. They allocate nothing. They are stricter than cJSON, never looser: so
 * when cJSON refuses a text that they accept, memory is exhausted. */
static const char *skip_value(const char *at, int depth);

static const char *skip_space(const char *at) {
  return at + strspn(at, " \t\r\n");
}

static const char *skip_hex(const char *at, unsigned *code) {
  *code = 0;
  for (int i = 0; i < 4; i++, at++) {
    if (!isxdigit((unsigned char)*at)) return NULL;
    unsigned digit = (unsigned)(isdigit((unsigned char)*at) ? *at - '0' : (*at | 0x20) - 'a' + 10);
    *code = *code << 4 | digit;
  }
  return at;
}

/* Skips one code unit after `\u`, or a surrogate pair. */
static const char *skip_code(const char *at) {
  unsigned first, second;
  at = skip_hex(at, &first);
  if (!at || first < 0xD800 || first > 0xDFFF) return at;
  if (first >= 0xDC00 || at[0] != '\\' || at[1] != 'u') return NULL;
  at = skip_hex(at + 2, &second);
  return at && second >= 0xDC00 && second <= 0xDFFF ? at : NULL;
}

static const char *skip_string(const char *at) {
  if (*at != '"') return NULL;
  for (at++; at && *at != '"';) {
    if ((unsigned char)*at < ' ') return NULL;
    if (*at++ != '\\') continue;
    if (!*at || !strchr("\"\\/bfnrtu", *at)) return NULL;
    at = *at == 'u' ? skip_code(at + 1) : at + 1;
  }
  return at ? at + 1 : NULL;
}

static const char *skip_digits(const char *at) {
  size_t count = strspn(at, "0123456789");
  return count ? at + count : NULL;
}

static const char *skip_number(const char *at) {
  at += *at == '-';
  at = *at == '0' ? at + 1 : skip_digits(at);
  if (at && *at == '.') at = skip_digits(at + 1);
  if (!at || (*at != 'e' && *at != 'E')) return at;
  at++;
  return skip_digits(at + (*at == '+' || *at == '-'));
}

static const char *skip_list(const char *at, int depth, char close) {
  at = skip_space(at + 1);
  if (*at == close) return at + 1;
  for (;; at = skip_space(at + 1)) {
    if (close == '}') {
      at = skip_string(at);
      if (!at || *(at = skip_space(at)) != ':') return NULL;
      at = skip_space(at + 1);
    }
    at = skip_value(at, depth + 1);
    if (!at) return NULL;
    at = skip_space(at);
    if (*at == close) return at + 1;
    if (*at != ',') return NULL;
  }
}

static const char *skip_word(const char *at, const char *word) {
  size_t length = strlen(word);
  return strncmp(at, word, length) ? NULL : at + length;
}

static const char *skip_value(const char *at, int depth) {
  if (depth >= CJSON_NESTING_LIMIT) return NULL;
  switch (*at) {
  case '{':
    return skip_list(at, depth, '}');
  case '[':
    return skip_list(at, depth, ']');
  case '"':
    return skip_string(at);
  case 't':
    return skip_word(at, "true");
  case 'f':
    return skip_word(at, "false");
  case 'n':
    return skip_word(at, "null");
  default:
    return skip_number(at);
  }
}

static bool is_json(const char *text) {
  const char *end = skip_value(skip_space(text), 0);
  return end && !*skip_space(end);
}

static fg_status fail_syntax(fg_context *ctx, const char *path, const char *text, const char *at) {
  const char *start = text;
  size_t line = 1, shown = 0;
  char excerpt[EXCERPT_MAX + 1];
  if (!at || at < text) at = text;
  for (const char *c = text; c < at; c++)
    if (*c == '\n') {
      line++;
      start = c + 1;
    }
  for (const char *c = start; *c && *c != '\n' && shown < EXCERPT_MAX; c++)
    if (shown > 0 || !isspace((unsigned char)*c))
      excerpt[shown++] = iscntrl((unsigned char)*c) ? ' ' : *c;
  excerpt[shown] = '\0';
  return fg_fail(ctx, FG_ERR_DATA, "%.500s: line %zu, column %td: this is not JSON: %s", path, line,
                 at - start + 1, shown ? excerpt : "(the text ends)");
}

fg_status fg_json_read(fg_context *ctx, const char *path, const char *text, cJSON **root) {
  const char *end = NULL;
  *root = cJSON_ParseWithOpts(text, &end, true);
  if (*root) return FG_OK;
  if (is_json(text))
    return fg_fail(ctx, FG_ERR_MEMORY, "%.500s: out of memory for its JSON (%zu bytes)", path,
                   strlen(text));
  return fail_syntax(ctx, path, text, end);
}
