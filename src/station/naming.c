/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/naming.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "core/sha256.h"
#include "core/utf8.h"

static const struct {
  const char *name;
  size_t offset;
} fields[] = {
    {"serial", offsetof(fg_named, serial)},   {"lot", offsetof(fg_named, lot)},
    {"die", offsetof(fg_named, die)},         {"operator", offsetof(fg_named, operator_name)},
    {"coil", offsetof(fg_named, coil)},       {"oven", offsetof(fg_named, oven)},
    {"scanner", offsetof(fg_named, scanner)}, {"check", offsetof(fg_named, check)},
};

enum { FIELDS = sizeof fields / sizeof *fields };

/* The field that begins at an opening brace; FIELDS when it is none. *end: behind its brace. */
static size_t find_field(const char *at, const char **end) {
  const char *close = strchr(at, '}');
  for (size_t i = 0; close && i < FIELDS; i++)
    if (strlen(fields[i].name) == (size_t)(close - at - 1) &&
        !strncmp(at + 1, fields[i].name, strlen(fields[i].name))) {
      *end = close + 1;
      return i;
    }
  return FIELDS;
}

fg_status fg_naming_check(fg_context *ctx, const char *pattern) {
  bool seen[FIELDS] = {false}, open = false; /* open: the field before may end anywhere */
  for (const char *at = pattern; *at;) {
    const char *end = at + 1;
    if (*at == '{') {
      size_t field = find_field(at, &end);
      if (field == FIELDS)
        return fg_fail(ctx, FG_ERR_DATA,
                       "file_name: '%.40s' begins no field; there are {serial}, {lot}, {die}, "
                       "{operator}, {coil}, {oven}, {scanner}, {check}",
                       at);
      if (seen[field])
        return fg_fail(ctx, FG_ERR_DATA, "file_name: {%s} is there twice", fields[field].name);
      seen[field] = true;
    }
    bool opens = *at == '{' || *at == '*';
    if (opens && open)
      return fg_fail(ctx, FG_ERR_DATA,
                     "file_name: '%.40s' has no text before it that would end the field", at);
    open = opens;
    at = end;
  }
  return pattern[0] ? FG_OK : fg_fail(ctx, FG_ERR_DATA, "file_name is empty");
}

/* Copies what people read, type and search: bytes that are no such text are replaced. Returns true
 * when the copy is the text, whole. */
static bool copy_plain(char *to, size_t size, const char *text, size_t length) {
  static const char unknown[] = "\xEF\xBF\xBD";
  size_t kept = 0;
  bool whole = true;
  for (const char *at = text, *end = text + length; at < end;) {
    size_t bytes = fg_utf8_length(at);
    bool plain = bytes && at + bytes <= end && (unsigned char)*at >= ' ' && *at != 0x7f;
    size_t needed = plain ? bytes : sizeof unknown - 1;
    whole = whole && plain && kept + needed < size;
    if (kept + needed >= size) break;
    memcpy(to + kept, plain ? at : unknown, needed);
    kept += needed;
    at += plain ? bytes : 1;
  }
  to[kept] = '\0';
  return whole;
}

void fg_named_keep(char to[FG_NAMED_TEXT], const char *text, size_t length) {
  enum { MARK_BYTES = 9 };
  char hex[65];
  struct sha256_ctx sum;
  if (copy_plain(to, FG_NAMED_TEXT, text, length)) return;
  copy_plain(to, FG_NAMED_TEXT - MARK_BYTES, text, length);
  sha256_init(&sum);
  sha256_update(&sum, length, (const uint8_t *)text);
  fg_sha256_finish(&sum, hex);
  sprintf(to + strlen(to), "~%.8s", hex);
}

static void keep_field(fg_named *named, size_t field, const char *text, size_t length) {
  fg_named_keep((char *)named + fields[field].offset, text, length);
}

/* One step of a pattern: an open place (a field or `*`, FIELDS) and the text behind it; `first` has
 * no open place before its text. */
typedef struct step {
  bool first;
  size_t field, length;
  const char *text;
} step;

/* Reads the step at `pattern`; returns the rest of the pattern. */
static const char *read_step(const char *pattern, bool first, step *taken) {
  const char *text = pattern;
  *taken = (step){.first = first, .field = FIELDS};
  if (!first) {
    text = pattern + 1;
    if (*pattern == '{') taken->field = find_field(pattern, &text);
  }
  taken->text = text;
  taken->length = strcspn(text, "{*");
  return text + taken->length;
}

/* Place of the step's text at or behind `from`: at once (first), at the end (last), else the
 * nearest place. NULL: nowhere. */
static const char *find_text(const step *at, bool last, const char *from, const char *end) {
  if ((size_t)(end - from) < at->length) return NULL;
  if (last && (!at->first || (size_t)(end - from) == at->length)) {
    const char *place = end - at->length;
    return memcmp(place, at->text, at->length) ? NULL : place;
  }
  if (last) return NULL;
  if (at->first) return memcmp(from, at->text, at->length) ? NULL : from;
  return memmem(from, (size_t)(end - from), at->text, at->length);
}

/* True where `name` up to `end` matches the pattern. Each text is searched once: where the rest
 * matches behind a later occurrence, it matches behind the nearest too, as the open place that
 * follows has any length. So no step is ever tried again, and fields are as short as they can
 * be. */
static bool match(const char *pattern, const char *name, const char *end, fg_named *named) {
  for (bool first = true; first || *pattern; first = false) {
    step at;
    pattern = read_step(pattern, first, &at);
    size_t min = at.field < FIELDS;
    if ((size_t)(end - name) < min) return false;
    const char *place = find_text(&at, !*pattern, name + min, end);
    if (!place) return false;
    if (at.field < FIELDS) keep_field(named, at.field, name, (size_t)(place - name));
    name = place + at.length;
  }
  return true;
}

bool fg_naming_split(const char *pattern, const char *file, fg_named *named) {
  const char *dot = strrchr(file, '.'), *last = dot && dot > file ? dot : file + strlen(file);
  *named = (fg_named){0};
  if (match(pattern, file, last, named)) return true;
  *named = (fg_named){0};
  keep_field(named, 0, file, (size_t)(last - file));
  return false;
}
