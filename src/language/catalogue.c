/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A list of words is read: GNU gettext's PO, of which msgctxt, msgid and msgstr are known. */
#include "language/catalogue.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "foilgauge/text.h"

enum { PO_TEXT_MAX = 4000 };

typedef struct po_reader {
  fg_context *ctx;
  const char *file, *at;
  size_t line;
  fg_language *language;
  char *filled; /* text that a further line of quotes continues; NULL: none yet */
  char context[40], source[PO_TEXT_MAX], target[PO_TEXT_MAX];
  size_t source_line;
  bool any; /* an entry is open */
} po_reader;

static fg_status refuse(const po_reader *po, const char *words) {
  return fg_fail(po->ctx, FG_ERR_DATA, "%s:%zu: %s", po->file, po->line, words);
}

size_t fg_place_length(const char *pattern) {
  static const char *const kinds[] = {"{number", "{time", "{name", "{words"};
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
    size_t length = strlen(kinds[i]);
    if (strncmp(pattern, kinds[i], length) != 0) continue;
    length += strspn(pattern + length, "0123456789");
    if (pattern[length] == '}') return length + 1;
  }
  return 0;
}

static void find_anchor(fg_phrase *phrase) {
  const char *from = phrase->source, *at = from;
  for (;; at++) {
    size_t place = fg_place_length(at);
    if (*at && !place) continue;
    size_t length = (size_t)(at - from);
    phrase->literal_length += length;
    if (length > phrase->anchor_length) phrase->anchor = from, phrase->anchor_length = length;
    if (!*at) return;
    phrase->has_places = true;
    from = at + place;
    at = from - 1;
  }
}

static fg_status keep_phrase(po_reader *po) {
  fg_language *language = po->language;
  FG_TRY(fg_memory_reserve(po->ctx, language->count + 1, sizeof *language->phrases,
                           &language->capacity, (void **)&language->phrases));
  fg_phrase *phrase = &language->phrases[language->count];
  *phrase = (fg_phrase){.source = strdup(po->source),
                        .target = strdup(po->target),
                        .line = po->source_line,
                        .is_symbol = !strcmp(po->context, "symbol")};
  language->count++;
  if (!phrase->source || !phrase->target) return fg_fail(po->ctx, FG_ERR_MEMORY, "out of memory");
  find_anchor(phrase);
  language->plain += !phrase->has_places;
  return FG_OK;
}

/* Copies the value of a line of the header, "Language: de". */
static void read_header_field(const char *header, const char *name, char *value, size_t size) {
  const char *at = strstr(header, name);
  if (!at) return;
  at += strlen(name);
  fg_text_clip(value, size, "%.*s", (int)strcspn(at, "\n"), at);
}

static fg_status read_list_header(po_reader *po) {
  char decimal[4] = "";
  fg_language *language = po->language;
  read_header_field(po->target, "Language: ", language->tag, sizeof language->tag);
  read_header_field(po->target, "X-Decimal: ", decimal, sizeof decimal);
  read_header_field(po->target, "X-Date: ", language->date, sizeof language->date);
  language->decimal = decimal[0];
  if (!language->tag[0] || !language->decimal || !language->date[0])
    return refuse(po, "the header needs Language, X-Decimal and X-Date");
  return FG_OK;
}

static fg_status end_entry(po_reader *po) {
  fg_status status = FG_OK;
  if (po->any && !po->source[0])
    status = read_list_header(po);
  else if (po->any && !po->target[0])
    status = refuse(po, "an entry has no msgstr");
  else if (po->any)
    status = keep_phrase(po);
  po->context[0] = po->source[0] = po->target[0] = '\0';
  po->filled = NULL;
  po->any = false;
  return status;
}

/* Appends the text between the quotes of the line. */
static fg_status read_quoted(po_reader *po, const char *line, size_t size) {
  size_t used = strlen(po->filled);
  const char *at = strchr(line, '"');
  if (!at) return refuse(po, "a text in quotes is missing");
  for (at++; *at != '"'; at++) {
    if (!*at || *at == '\n') return refuse(po, "a quote is not closed");
    if (*at == '\\') at++;
    if (used + 2 > size) return refuse(po, "the text is too long");
    po->filled[used++] = *at == 'n' && at[-1] == '\\' ? '\n' : *at;
  }
  po->filled[used] = '\0';
  return FG_OK;
}

static fg_status read_po_line(po_reader *po, const char *line) {
  size_t size = PO_TEXT_MAX;
  if (!strncmp(line, "msgctxt ", 8)) {
    FG_TRY(end_entry(po));
    po->filled = po->context;
  } else if (!strncmp(line, "msgid ", 6)) {
    if (po->filled != po->context) FG_TRY(end_entry(po));
    po->filled = po->source;
    po->source_line = po->line;
    po->any = true;
  } else if (!strncmp(line, "msgstr ", 7)) {
    po->filled = po->target;
  } else if (*line != '"') {
    return *line && *line != '#' && *line != '\n' ? refuse(po, "this is no line of a list of words")
                                                  : FG_OK;
  }
  if (!po->filled) return refuse(po, "a text without msgid");
  if (po->filled == po->context) size = sizeof po->context;
  return read_quoted(po, line, size);
}

/* Those without places come first, by source; of those with places the one with most text of its
 * own, and "{words}", which asks for more, before "{name}". */
static int compare_phrases(const void *left, const void *right) {
  const fg_phrase *a = left, *b = right;
  if (a->has_places != b->has_places) return a->has_places ? 1 : -1;
  if (!a->has_places) return strcmp(a->source, b->source);
  if (a->literal_length != b->literal_length) return a->literal_length > b->literal_length ? -1 : 1;
  bool name = strstr(a->source, "{name") != NULL;
  if (name != (strstr(b->source, "{name") != NULL)) return name ? 1 : -1;
  bool words = strstr(a->source, "{words") != NULL;
  if (words != (strstr(b->source, "{words") != NULL)) return words ? -1 : 1;
  return strcmp(a->source, b->source);
}

fg_status fg_catalogue_read(fg_context *ctx, const char *file, const char *text,
                            fg_language *language) {
  po_reader *po = calloc(1, sizeof *po);
  if (!po) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory");
  fg_status status = FG_OK;
  *po = (po_reader){.ctx = ctx, .file = file, .language = language};
  for (const char *line = text; status == FG_OK && *line;) {
    po->line++;
    status = read_po_line(po, line);
    line += strcspn(line, "\n");
    line += *line == '\n';
  }
  if (status == FG_OK) status = end_entry(po);
  if (status == FG_OK && !language->tag[0]) status = refuse(po, "there is no header");
  free(po);
  if (status == FG_OK)
    fg_sort_items(language->phrases, language->count, sizeof *language->phrases, compare_phrases);
  return status;
}

void fg_catalogue_free(fg_language *language) {
  for (size_t i = 0; i < language->count; i++) {
    free(language->phrases[i].source);
    free(language->phrases[i].target);
  }
  free(language->phrases);
  *language = (fg_language){0};
}

static int compare_source(const void *text, const void *phrase) {
  return strcmp(text, ((const fg_phrase *)phrase)->source);
}

const fg_phrase *fg_catalogue_find(const fg_language *language, const char *text) {
  if (!language->plain) return NULL;
  return bsearch(text, language->phrases, language->plain, sizeof *language->phrases,
                 compare_source);
}
