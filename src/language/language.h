/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pages in another language than English.
 *
 * Pages, reports and the database are written in English. A language is one list of words, a file
 * `language/TAG.po` of GNU gettext's form: `msgid` is the English text between two tags (or in an
 * attribute that is read: a title, a label), `msgstr` what stands there instead. Places of a text
 * that vary are named in braces, `{kind}` or `{kind2}`:
 *
 *   {number}  "3.21": gets the language's decimal sign
 *   {time}    "2026-03-01 14:02:33" or its date alone: gets the language's order
 *   {name}    a serial number, a file: stays as it is
 *   {words}   a text that has an entry of its own
 *
 * Where no whole text fits, its sentences are looked up one by one. An element with
 * `translate="no"` (HTML's own word for it) stays as it is: names that people gave. The entry with
 * an empty `msgid` holds the header. */
#ifndef FG_LANGUAGE_LANGUAGE_H
#define FG_LANGUAGE_LANGUAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "foilgauge/status.h"

typedef struct fg_language fg_language;
typedef struct fg_languages fg_languages;

/* Reads all lists of words. FG_ERR_DATA: the file and line that is not as it must be. */
fg_status fg_languages_open(fg_context *ctx, fg_languages **languages);
void fg_languages_close(fg_languages *languages); /* accepts NULL */

/* Returns the language that a recipe names (""; NULL: none), else the one that the browser prefers
 * (its header Accept-Language; NULL: none). NULL: English, which needs no list. */
const fg_language *fg_languages_choose(const fg_languages *languages, const char *recipe,
                                       const char *accepted);

bool fg_language_is_known(const char *tag); /* "en" too */

const char *fg_language_tag(const fg_language *language); /* "de" */
char fg_language_decimal(const fg_language *language);    /* ',' */

/* Called with every text that has no entry. */
typedef struct fg_missing_words {
  void (*found)(void *user, const char *text);
  void *user;
} fg_missing_words;

/* Writes a page, or a text without markup, in the language; what has no entry stays English.
 * `missing` may be NULL. */
void fg_language_write_html(const fg_language *language, const char *html, size_t size, FILE *out,
                            const fg_missing_words *missing);
void fg_language_write_text(const fg_language *language, const char *text, FILE *out,
                            const fg_missing_words *missing);

#endif
