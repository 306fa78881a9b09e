/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A text finds its entry: its own, that of a pattern with places, symbols among numbers, or those
 * of its sentences. */
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "language/catalogue.h"

/* STEPS_MAX: a text that nobody foresaw ends the search for its pattern, not the page. */
enum { PLACES_MAX = 12, DEPTH_MAX = 16, STEPS_MAX = 20000 };

/* Search for the entry of a text, and its effort so far. */
typedef struct search {
  const fg_language *language;
  int depth, steps;
} search;

typedef struct place {
  const char *name; /* "{words2}" in the pattern */
  size_t name_length;
  const char *text; /* what stands there */
  size_t length;
  char *translated; /* of {words}; owned */
} place;

typedef struct matching {
  search *search;
  place places[PLACES_MAX];
  size_t count;
} matching;

static char *translate(search *at, const char *text);

static char *translate_part(search *at, const char *text, size_t length) {
  char *part = strndup(text, length);
  char *translated = part ? translate(at, part) : NULL;
  free(part);
  return translated;
}

static bool is_kind(const place *at, const char *kind) {
  return !strncmp(at->name, kind, strlen(kind));
}

static void forget_words(matching *m) {
  for (size_t i = 0; i < m->count; i++) {
    free(m->places[i].translated);
    m->places[i].translated = NULL;
  }
}

static bool translate_words(matching *m) {
  for (size_t i = 0; i < m->count; i++) {
    place *at = &m->places[i];
    if (!is_kind(at, "{words")) continue;
    at->translated = translate_part(m->search, at->text, at->length);
    if (at->translated) continue;
    forget_words(m);
    return false;
  }
  return true;
}

static bool match(matching *m, const char *pattern, const char *text);

static bool match_number(matching *m, place *at, const char *rest) {
  at->length = is_kind(at, "{number") ? fg_number_length(at->text) : fg_time_length(at->text);
  return at->length && match(m, rest, at->text + at->length);
}

static bool match_any(matching *m, size_t own, const char *rest) {
  place *at = &m->places[own];
  size_t whole = strlen(at->text);
  bool name = is_kind(at, "{name");
  for (at->length = *rest || name ? 1 : whole; at->length && at->length <= whole; at->length++) {
    if (--m->search->steps < 0) return false;
    /* A name ends with its sentence. */
    if (name && !strncmp(at->text + at->length - 1, ". ", 2)) return false;
    m->count = own + 1;
    if (match(m, rest, at->text + at->length)) return true;
  }
  return false;
}

static bool match_place(matching *m, const char *pattern, size_t length, const char *text) {
  size_t own = m->count;
  if (own == PLACES_MAX) return false;
  place *at = &m->places[m->count++];
  *at = (place){.name = pattern, .name_length = length, .text = text};
  bool number = is_kind(at, "{number") || is_kind(at, "{time");
  if (number ? match_number(m, at, pattern + length) : match_any(m, own, pattern + length))
    return true;
  m->count = own;
  return false;
}

static bool match(matching *m, const char *pattern, const char *text) {
  for (;; pattern++, text++) {
    size_t length = *pattern == '{' ? fg_place_length(pattern) : 0;
    if (length) return match_place(m, pattern, length, text);
    if (!*pattern) return !*text && translate_words(m);
    if (*pattern != *text) return false;
  }
}

static const place *find_named_place(const matching *m, const char *name, size_t length) {
  for (size_t i = 0; i < m->count; i++)
    if (m->places[i].name_length == length && !strncmp(m->places[i].name, name, length))
      return &m->places[i];
  return NULL;
}

static void write_place_of(const matching *m, const place *at, FILE *out) {
  if (at->translated)
    fputs(at->translated, out);
  else if (is_kind(at, "{name"))
    fwrite(at->text, 1, at->length, out);
  else
    fg_numbers_write(m->search->language, at->text, at->length, out);
}

static char *fill_target(const matching *m, const char *target) {
  char *text = NULL;
  size_t size;
  FILE *out = fg_stream_open(&text, &size);
  if (!out) return NULL;
  while (*target) {
    size_t length = *target == '{' ? fg_place_length(target) : 0;
    const place *at = length ? find_named_place(m, target, length) : NULL;
    if (at)
      write_place_of(m, at, out);
    else
      fputc(*target, out);
    target += at ? length : 1;
  }
  fg_stream_keep(out, &text);
  return text;
}

static bool may_match(const fg_phrase *phrase, const char *text, size_t length) {
  if (*phrase->source != '{' && *phrase->source != *text) return false;
  return memmem(text, length, phrase->anchor, phrase->anchor_length) != NULL;
}

static char *translate_pattern(search *at, const char *text) {
  const fg_language *language = at->language;
  size_t length = strlen(text);
  for (size_t i = language->plain; i < language->count; i++) {
    const fg_phrase *phrase = &language->phrases[i];
    matching m = {.search = at};
    if (!may_match(phrase, text, length) || !match(&m, phrase->source, text)) continue;
    char *filled = fill_target(&m, phrase->target);
    forget_words(&m);
    return filled;
  }
  return NULL;
}

static bool has_letter(const char *text, size_t length) {
  for (size_t i = 0; i < length; i++)
    if (isalpha((unsigned char)text[i])) return true;
  return false;
}

static bool is_symbol(const fg_language *language, const char *text, size_t length) {
  char word[40];
  if (!has_letter(text, length)) return true;
  if (length >= sizeof word) return false;
  memcpy(word, text, length);
  word[length] = '\0';
  const fg_phrase *phrase = fg_catalogue_find(language, word);
  return phrase && phrase->is_symbol;
}

/* "3.21 ± 0.01 mm": every word is a symbol, or has no letter. */
static bool are_symbols(const fg_language *language, const char *text) {
  static const char edge[] = " ,;:()[]<>=/|*+";
  while (*text) {
    text += strspn(text, edge);
    size_t time = fg_time_length(text), number = fg_number_length(text);
    if (time || (number && !isalnum((unsigned char)text[number]))) text += time ? time : number;
    size_t length = strcspn(text, edge);
    if (!is_symbol(language, text, length)) return false;
    text += length;
  }
  return true;
}

static char *translate_numbers(const fg_language *language, const char *text) {
  char *written = NULL;
  size_t size;
  FILE *out = fg_stream_open(&written, &size);
  if (!out) return NULL;
  fg_numbers_write(language, text, strlen(text), out);
  fg_stream_keep(out, &written);
  return written;
}

static char *join_parts(char *first, const char *between, char *second) {
  char *joined = NULL;
  if (first && second && asprintf(&joined, "%s%s%s", first, between, second) < 0) joined = NULL;
  free(first);
  free(second);
  return joined;
}

/* Both parts of a text must be known. Sentences are tried before clauses, and these before items of
 * a list. */
static char *translate_sentences(search *at, const char *text) {
  static const char *const ends[] = {".!?", ":;", ","};
  for (size_t e = 0; e < sizeof ends / sizeof *ends; e++)
    for (const char *end = text; (end = strpbrk(end, ends[e])); end++) {
      if (end[1] != ' ' || !end[2]) continue;
      if (--at->steps < 0) return NULL;
      char *first = translate_part(at, text, (size_t)(end - text) + 1);
      char *both = first ? join_parts(first, " ", translate(at, end + 2)) : NULL;
      if (both) return both;
    }
  return NULL;
}

/* "lot 7," and "(lot 7)," have the entry of "lot 7". */
static char *translate_inside(search *at, const char *text, const char *marks) {
  size_t head = strspn(text, marks), length = strlen(text);
  while (length > head && strchr(marks, text[length - 1]))
    length--;
  bool sentences = strstr(text + head, ". ") != NULL; /* tried already, each with its own mark */
  if ((!head && (!text[length] || sentences)) || length == head) return NULL;
  char *inside = translate_part(at, text + head, length - head);
  return inside ? join_parts(join_parts(strndup(text, head), "", inside), "", strdup(text + length))
                : NULL;
}

static char *translate_inside_marks(search *at, const char *text) {
  char *translated = translate_inside(at, text, " ,;:.");
  return translated ? translated : translate_inside(at, text, " ,;:.()");
}

static char *translate_deeper(search *at, const char *text) {
  char *translated = NULL;
  if (at->depth == DEPTH_MAX || at->steps < 0) return NULL;
  at->depth++;
  translated = translate_pattern(at, text);
  if (!translated) translated = translate_sentences(at, text);
  if (!translated) translated = translate_inside_marks(at, text);
  at->depth--;
  return translated;
}

static char *translate(search *at, const char *text) {
  const fg_phrase *phrase = fg_catalogue_find(at->language, text);
  if (phrase) return strdup(phrase->target);
  if (are_symbols(at->language, text)) return translate_numbers(at->language, text);
  return translate_deeper(at, text);
}

char *fg_phrase_translate(const fg_language *language, const char *text) {
  search at = {.language = language, .steps = STEPS_MAX};
  return translate(&at, text);
}
