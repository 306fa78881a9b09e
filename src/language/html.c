/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A page in another language: its texts and some of its attributes are translated, all else is
 * copied. */
#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "language/catalogue.h"

enum { NAME_MAX_BYTES = 24 };

typedef struct html_walk {
  const fg_language *language;
  const char *at, *end;
  FILE *out;
  const fg_missing_words *missing;
  char kept[NAME_MAX_BYTES]; /* element whose inside stays as it is; "": none */
  int kept_depth;            /* elements of its name inside it, with it */
} html_walk;

static const struct {
  const char *name, *text;
} entities[] = {{"&amp;", "&"},   {"&lt;", "<"},  {"&gt;", ">"},
                {"&quot;", "\""}, {"&#39;", "'"}, {"&nbsp;", " "}};
/* ENCODED: the last is read alone. */
enum { ENTITIES = sizeof entities / sizeof *entities, ENCODED = ENTITIES - 1 };

static size_t find_entity(const char *html, size_t length) {
  size_t e = 0;
  for (; e < ENTITIES; e++) {
    size_t size = strlen(entities[e].name);
    if (size <= length && !memcmp(html, entities[e].name, size)) break;
  }
  return e;
}

/* Copies a text without its entities, and with one blank for each stretch of blanks; none at its
 * ends. */
static char *decode(const char *html, size_t length) {
  char *text = malloc(length + 1), *to = text;
  for (size_t i = 0, step; text && i < length; i += step) {
    size_t e = find_entity(html + i, length - i);
    step = e < ENTITIES ? strlen(entities[e].name) : 1;
    bool blank = e == ENTITIES && isspace((unsigned char)html[i]);
    if (e < ENTITIES)
      to = stpcpy(to, entities[e].text);
    else if (!blank)
      *to++ = html[i];
    else if (to > text && to[-1] != ' ')
      *to++ = ' ';
  }
  while (text && to > text && to[-1] == ' ')
    to--;
  if (text) *to = '\0';
  return text;
}

static void encode(const char *text, FILE *out) {
  for (; *text; text++) {
    size_t e = 0;
    while (e < ENCODED && entities[e].text[0] != *text)
      e++;
    if (e < ENCODED)
      fputs(entities[e].name, out);
    else
      fputc(*text, out);
  }
}

static void report_missing(const html_walk *walk, const char *text) {
  if (walk->missing) walk->missing->found(walk->missing->user, text);
}

/* Text without a letter is numbers and marks alone. */
static bool has_letter(const char *text, size_t length) {
  for (size_t i = 0; i < length; i++)
    if (isalpha((unsigned char)text[i])) return true;
  return false;
}

static void write_inner(const html_walk *walk, const char *html, size_t length) {
  char *text = decode(html, length);
  char *translated = text ? fg_phrase_translate(walk->language, text) : NULL;
  if (translated) {
    encode(translated, walk->out);
  } else {
    if (text) report_missing(walk, text);
    fwrite(html, 1, length, walk->out);
  }
  free(translated);
  free(text);
}

/* Length of a blank at the begin of a text; 0: none. */
static size_t blank_length(const char *html, size_t length) {
  static const char entity[] = "&nbsp;", fixed[] = "\xc2\xa0";
  if (length && isspace((unsigned char)*html)) return 1;
  if (length >= sizeof entity - 1 && !memcmp(html, entity, sizeof entity - 1))
    return sizeof entity - 1;
  return length >= sizeof fixed - 1 && !memcmp(html, fixed, sizeof fixed - 1) ? sizeof fixed - 1
                                                                              : 0;
}

/* Translates a text; blanks at its ends stay. */
static void write_text(const html_walk *walk, const char *html, size_t length) {
  size_t head = 0, tail = length;
  for (size_t blank; (blank = blank_length(html + head, length - head));)
    head += blank;
  while (tail > head && isspace((unsigned char)html[tail - 1]))
    tail--;
  fwrite(html, 1, head, walk->out);
  if (tail > head && has_letter(html + head, tail - head))
    write_inner(walk, html + head, tail - head);
  else
    fg_numbers_write(walk->language, html + head, tail - head, walk->out);
  fwrite(html + tail, 1, length - tail, walk->out);
}

static bool is_translated_attribute(const char *name, size_t length) {
  static const char *const names[] = {"title",     "placeholder", "aria-label",
                                      "alt",       "label",       "data-words",
                                      "data-name", "data-at",     "aria-description"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (strlen(names[i]) == length && !strncasecmp(names[i], name, length)) return true;
  return false;
}

/* Returns the end of the tag at `html`, behind its '>'. */
static const char *find_tag_end(const char *html, const char *end) {
  char quote = '\0';
  for (html++; html < end; html++) {
    if (quote ? *html == quote : *html == '"' || *html == '\'')
      quote = quote ? '\0' : *html;
    else if (!quote && *html == '>')
      return html + 1;
  }
  return end;
}

typedef struct attribute {
  const char *name, *value; /* value: behind the quote; NULL: none in quotes */
  size_t name_length, value_length;
} attribute;

/* Reads the next attribute from `*at` on; false: the tag has no more. */
static bool next_attribute(const char **at, const char *end, attribute *found) {
  const char *name = *at;
  while (name < end && (isspace((unsigned char)*name) || *name == '/' || *name == '>'))
    name++;
  const char *behind = name;
  while (behind < end && !isspace((unsigned char)*behind) && !strchr("=>/", *behind))
    behind++;
  if (behind == name) return false;
  *found = (attribute){.name = name, .name_length = (size_t)(behind - name)};
  *at = behind;
  if (behind + 1 >= end || *behind != '=' || !strchr("\"'", behind[1])) return true;
  const char *close = memchr(behind + 2, behind[1], (size_t)(end - behind - 2));
  if (!close) return true;
  found->value = behind + 2;
  found->value_length = (size_t)(close - found->value);
  *at = close + 1;
  return true;
}

static bool is_attribute(const attribute *at, const char *name, const char *value) {
  return at->name_length == strlen(name) && !strncasecmp(at->name, name, at->name_length) &&
         at->value && at->value_length == strlen(value) &&
         !strncmp(at->value, value, at->value_length);
}

static void write_attributes(html_walk *walk, const char *name, const char *tag_end) {
  const char *at = walk->at, *copied = walk->at;
  attribute found;
  bool keeps = !strcasecmp(name, "script") || !strcasecmp(name, "style");
  while (next_attribute(&at, tag_end, &found)) {
    if (!found.value) continue;
    keeps = keeps || is_attribute(&found, "translate", "no");
    bool language = !strcasecmp(name, "html") && is_attribute(&found, "lang", "en");
    if (!language && !is_translated_attribute(found.name, found.name_length)) continue;
    fwrite(copied, 1, (size_t)(found.value - copied), walk->out);
    if (language)
      fputs(walk->language->tag, walk->out);
    else
      write_text(walk, found.value, found.value_length);
    copied = found.value + found.value_length;
  }
  fwrite(copied, 1, (size_t)(tag_end - copied), walk->out);
  walk->at = tag_end;
  if (!keeps || tag_end[-2] == '/') return;
  snprintf(walk->kept, sizeof walk->kept, "%s", name);
  walk->kept_depth = 1;
}

static void copy_to(html_walk *walk, const char *to) {
  fwrite(walk->at, 1, (size_t)(to - walk->at), walk->out);
  walk->at = to;
}

/* Counts elements inside one that is kept, until its own end. */
static void pass_kept(html_walk *walk, const char *name, bool closes, const char *tag_end) {
  if (!strcasecmp(name, walk->kept)) walk->kept_depth += closes ? -1 : 1;
  if (!walk->kept_depth) walk->kept[0] = '\0';
  copy_to(walk, tag_end);
}

static void write_tag(html_walk *walk) {
  char name[NAME_MAX_BYTES];
  const char *from = walk->at + 1, *tag_end = find_tag_end(walk->at, walk->end);
  bool closes = from < walk->end && *from == '/';
  size_t length = 0;
  from += closes;
  while (from + length < tag_end && isalnum((unsigned char)from[length]))
    length++;
  snprintf(name, sizeof name, "%.*s", (int)(length < sizeof name ? length : 0), from);
  if (walk->kept[0]) {
    pass_kept(walk, name, closes, tag_end);
  } else if (closes || !length) {
    copy_to(walk, tag_end);
  } else {
    copy_to(walk, from + length);
    write_attributes(walk, name, tag_end);
  }
}

/* Finds the next tag; in a script or a style sheet the one that ends it. */
static const char *find_next_tag(const html_walk *walk) {
  char end_tag[NAME_MAX_BYTES + 2];
  bool raw = !strcasecmp(walk->kept, "script") || !strcasecmp(walk->kept, "style");
  snprintf(end_tag, sizeof end_tag, raw ? "</%s" : "<", walk->kept);
  return memmem(walk->at, (size_t)(walk->end - walk->at), end_tag, strlen(end_tag));
}

void fg_language_write_html(const fg_language *language, const char *html, size_t size, FILE *out,
                            const fg_missing_words *missing) {
  html_walk walk = {
      .language = language, .at = html, .end = html + size, .out = out, .missing = missing};
  while (walk.at < walk.end) {
    const char *tag = find_next_tag(&walk), *to = tag ? tag : walk.end;
    if (walk.kept[0])
      copy_to(&walk, to);
    else
      write_text(&walk, walk.at, (size_t)(to - walk.at));
    walk.at = to;
    if (tag) write_tag(&walk);
  }
}

void fg_language_write_text(const fg_language *language, const char *text, FILE *out,
                            const fg_missing_words *missing) {
  size_t head = strspn(text, " "), tail = strlen(text);
  char *translated = fg_phrase_translate(language, text + head);
  if (!translated && missing) missing->found(missing->user, text + head);
  fwrite(text, 1, head < tail ? head : tail, out);
  fputs(translated ? translated : text + head, out);
  free(translated);
}
