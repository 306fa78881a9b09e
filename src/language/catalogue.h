/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Entries of a language, and how a text finds its own. */
#ifndef FG_LANGUAGE_CATALOGUE_H
#define FG_LANGUAGE_CATALOGUE_H

#include "language/language.h"

typedef struct fg_phrase {
  char *source, *target;
  size_t line;        /* of the file */
  bool has_places;    /* source names at least one */
  bool is_symbol;     /* msgctxt "symbol": a unit or a letter, which may stand among numbers */
  const char *anchor; /* longest text of the source between its places */
  size_t anchor_length, literal_length;
} fg_phrase;

struct fg_language {
  char tag[16], decimal, date[32]; /* date: for strftime, "%d.%m.%Y" */
  fg_phrase *phrases;              /* those without places by source, then those with places, the
                                      most specific first */
  size_t count, capacity, plain;   /* plain: how many have no places */
};

/* Every list of words in this folder: the build makes the table of the files *.po. */
typedef struct fg_language_list {
  const char *file; /* "de.po"; NULL ends the table */
  const char *text;
} fg_language_list;
extern const fg_language_list fg_language_lists[];

/* Reads a list of words into the language. */
fg_status fg_catalogue_read(fg_context *ctx, const char *file, const char *text,
                            fg_language *language);
void fg_catalogue_free(fg_language *language);

/* Returns the entry of this very text; NULL: none. */
const fg_phrase *fg_catalogue_find(const fg_language *language, const char *text);

/* Returns a text, without blanks at its ends, in the language; the caller frees it. NULL: it has no
 * entry. */
char *fg_phrase_translate(const fg_language *language, const char *text);

/* Reads a place "{kind2}" of a pattern; returns its length, 0: there is none. */
size_t fg_place_length(const char *pattern);

/* Returns the length of a number, or of a date with or without its time; 0: none is there. */
size_t fg_number_length(const char *text);
size_t fg_time_length(const char *text);
/* Writes a text whose numbers and dates get the language's form. */
void fg_numbers_write(const fg_language *language, const char *text, size_t length, FILE *out);

#endif
