/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/scan_options.h"

#include <ctype.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "core/text.h"
#include "foilgauge/picture.h"

enum { WORD_BYTES = 200 };

/* When an option's value does no harm. */
typedef enum rule {
  NUMBER_IS,       /* the number in `value` */
  NUMBER_FROM,     /* that number or more */
  WORD_IS,         /* one of the words in `value`, separated by | */
  WORD_IS_NOT,     /* none of them */
  IS_NO,           /* a switch: without a value it is on */
  IS_STRAIGHT_LINE /* of scanimage's tables, as [0]0-[255]255 */
} rule;

/* Names as SANE's backends have them (saneopts.h and the backends' own), and the usual filters of
 * ImageMagick behind them. `instead`: NULL, leave it out. */
static const struct row {
  const char *option;
  rule rule;
  const char *value;
  fg_picture_finding finding;
  const char *instead;
} rows[] = {
    {"--mode", WORD_IS_NOT,
     "Lineart|Halftone|Binary|Color Lineart|Color Halftone|Black & White|Threshold",
     FG_PICTURE_FEW_LEVELS, "--mode Gray"},
    {"--depth", NUMBER_FROM, "8", FG_PICTURE_FEW_LEVELS, "--depth 16, or 8"},
    {"--format", WORD_IS_NOT, "jpeg|jpg|pdf", FG_PICTURE_BLOCK_NOISE, "--format png"},
    {"--compression", WORD_IS_NOT, "JPEG", FG_PICTURE_BLOCK_NOISE, "--compression None"},
    {"--jpeg", IS_NO, NULL, FG_PICTURE_BLOCK_NOISE, "--jpeg=no"},
    {"--gamma", NUMBER_IS, "1", FG_PICTURE_TONE_CURVE, "--gamma 1"},
    {"--gamma-value", NUMBER_IS, "1", FG_PICTURE_TONE_CURVE, "--gamma-value 1"},
    {"--analog-gamma", NUMBER_IS, "1", FG_PICTURE_TONE_CURVE, "--analog-gamma 1"},
    {"--gamma-correction", WORD_IS, "User defined|User defined (Gamma=1.0)", FG_PICTURE_TONE_CURVE,
     "--gamma-correction 'User defined (Gamma=1.0)'"},
    {"--gamma-table", IS_STRAIGHT_LINE, NULL, FG_PICTURE_TONE_CURVE,
     "--gamma-table '[0]0-[255]255'"},
    {"--color-correction", WORD_IS, "None", FG_PICTURE_TONE_CURVE, "--color-correction None"},
    {"--brightness", NUMBER_IS, "0", FG_PICTURE_TONE_CURVE, "--brightness 0, or without it"},
    {"--contrast", NUMBER_IS, "0", FG_PICTURE_TONE_CURVE, "--contrast 0, or without it"},
    {"--shadow", NUMBER_IS, "0", FG_PICTURE_CLIPPED, "--shadow 0"},
    {"--black-level", NUMBER_IS, "0", FG_PICTURE_CLIPPED, "--black-level 0"},
    {"--highlight", NUMBER_FROM, "100", FG_PICTURE_CLIPPED, "--highlight 100"},
    {"--white-level", NUMBER_FROM, "100", FG_PICTURE_CLIPPED, "--white-level 100"},
    {"--sharpness", NUMBER_IS, "0", FG_PICTURE_SHARPENED, "--sharpness 0"},
    {"--sharpen", NUMBER_IS, "0", FG_PICTURE_SHARPENED, "--sharpen 0"},
    {"--swdespeck", NUMBER_IS, "0", FG_PICTURE_CORRELATED_NOISE, NULL},
    {"--despeck", NUMBER_IS, "0", FG_PICTURE_CORRELATED_NOISE, NULL},
    {"--swdeskew", IS_NO, NULL, FG_PICTURE_CORRELATED_NOISE, "--swdeskew=no"},
    {"--preview", IS_NO, NULL, FG_PICTURE_CORRELATED_NOISE, "--preview=no"},
    {"-sharpen", IS_NO, NULL, FG_PICTURE_SHARPENED, NULL},
    {"-unsharp", IS_NO, NULL, FG_PICTURE_SHARPENED, NULL},
    {"-gamma", NUMBER_IS, "1", FG_PICTURE_TONE_CURVE, NULL},
    {"-level", IS_NO, NULL, FG_PICTURE_TONE_CURVE, NULL},
    {"-normalize", IS_NO, NULL, FG_PICTURE_TONE_CURVE, NULL},
    {"-auto-level", IS_NO, NULL, FG_PICTURE_TONE_CURVE, NULL},
    {"-contrast-stretch", IS_NO, NULL, FG_PICTURE_TONE_CURVE, NULL},
    {"-brightness-contrast", IS_NO, NULL, FG_PICTURE_TONE_CURVE, NULL},
    {"-threshold", IS_NO, NULL, FG_PICTURE_FEW_LEVELS, NULL},
    {"-monochrome", IS_NO, NULL, FG_PICTURE_FEW_LEVELS, NULL},
    {"-posterize", IS_NO, NULL, FG_PICTURE_FEW_LEVELS, NULL},
    {"-resize", IS_NO, NULL, FG_PICTURE_CORRELATED_NOISE, NULL},
    {"-resample", IS_NO, NULL, FG_PICTURE_CORRELATED_NOISE, NULL},
    {"-rotate", IS_NO, NULL, FG_PICTURE_CORRELATED_NOISE, NULL},
    {"-deskew", IS_NO, NULL, FG_PICTURE_CORRELATED_NOISE, NULL},
    {"-blur", IS_NO, NULL, FG_PICTURE_CORRELATED_NOISE, NULL},
    {"-median", IS_NO, NULL, FG_PICTURE_CORRELATED_NOISE, NULL},
    {"-despeckle", IS_NO, NULL, FG_PICTURE_CORRELATED_NOISE, NULL},
};

static bool is_between_words(char c) {
  return isspace((unsigned char)c) || c == ';' || c == '|' || c == '&';
}

/* Next word, as the shell makes it of quotes and backslashes, clipped. False: there is none. */
static bool read_word(const char **rest, char word[WORD_BYTES]) {
  const char *at = *rest;
  size_t length = 0;
  char quote = '\0';
  while (*at && is_between_words(*at))
    at++;
  if (!*at) return false;
  for (; *at && (quote || !is_between_words(*at)); at++) {
    if (quote ? *at == quote : *at == '\'' || *at == '"') {
      quote = quote ? '\0' : *at;
      continue;
    }
    if (*at == '\\' && quote != '\'' && at[1]) at++;
    if (length + 1 < WORD_BYTES) word[length++] = *at;
  }
  word[length] = '\0';
  *rest = at;
  return true;
}

static bool is_in_list(const char *list, const char *word) {
  size_t length = strlen(word);
  for (const char *at = list; at; at = strchr(at, '|') ? strchr(at, '|') + 1 : NULL)
    if (!strncasecmp(at, word, length) && (at[length] == '|' || !at[length])) return true;
  return false;
}

/* Two points, the first of them the origin: "[0]0-[255]255". */
static bool is_straight_line(const char *table) {
  static const char start[] = "[0]0-[", digits[] = "0123456789";
  if (strncmp(table, start, sizeof start - 1) != 0) return false;
  table += sizeof start - 1;
  table += strspn(table, digits);
  return *table++ == ']' && *table && !table[strspn(table, digits)];
}

static bool is_harmless(const struct row *row, const char *value) {
  char *end;
  double number = strtod(value, &end), limit = row->value ? strtod(row->value, NULL) : 0;
  bool is_number = end != value;
  switch (row->rule) {
  case NUMBER_IS:
    return !is_number || fabs(number - limit) < 1e-9;
  case NUMBER_FROM:
    return !is_number || number >= limit;
  case WORD_IS:
    return is_in_list(row->value, value);
  case WORD_IS_NOT:
    return !is_in_list(row->value, value);
  case IS_STRAIGHT_LINE:
    return is_straight_line(value);
  case IS_NO:
    break;
  }
  return is_in_list("no|0", value);
}

/* Row of an option, with or without its value behind "="; NULL: no option that does harm. */
static const struct row *find_row(const char *word, const char **value) {
  size_t length = strcspn(word, "=");
  *value = word[length] ? word + length + 1 : NULL;
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
    if (strlen(rows[i].option) == length && !strncmp(rows[i].option, word, length)) return &rows[i];
  return NULL;
}

static const char *find_meaning(unsigned finding) {
  for (const fg_picture_words *words = fg_picture_finding_words(); words->name; words++)
    if (words->finding == finding) return words->meaning;
  return "";
}

static void put_sentence(const struct row *row, const char *value, char *words, size_t size) {
  size_t used = strlen(words);
  bool quoted = value[strcspn(value, " ()[]")] != '\0';
  const char *quote = quoted ? "'" : "";
  fg_text_clip(words + used, size - used, "%s%s%s%s%s%s: %s %s%s.", used ? " " : "", row->option,
               value[0] ? " " : "", quote, value, quote, find_meaning(row->finding),
               row->instead ? "Write " : "Leave it out", row->instead ? row->instead : "");
}

size_t fg_scan_options_inspect(const char *command, char *words, size_t size) {
  char word[WORD_BYTES], next[WORD_BYTES];
  size_t count = 0;
  words[0] = '\0';
  while (read_word(&command, word)) {
    const char *value, *after = command;
    const struct row *row = find_row(word, &value);
    if (!row) continue;
    bool needs_value = row->rule != IS_NO;
    if (!value && needs_value) value = read_word(&after, next) ? next : "";
    if (!value) value = "";
    if (strpbrk(value, "$`") || (!*value && needs_value) || is_harmless(row, value)) continue;
    put_sentence(row, value, words, size);
    count++;
  }
  return count;
}
