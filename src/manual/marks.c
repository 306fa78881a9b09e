/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "manual/marks.h"

#include <stdlib.h>
#include <string.h>

#include "cli/facts.h"
#include "manual/documents.h"
#include "manual/facts.h"

static const char begin[] = "<!--@", middle[] = "@-->", end[] = "<!--@-->";

/* Returns the document whose members are asked for: "members_of_load_test". */
static const fg_document *find_document(const char *name, size_t length) {
  static const char prefix[] = "members_of_";
  size_t start = sizeof prefix - 1;
  if (length < start || strncmp(name, prefix, start) != 0) return NULL;
  for (const fg_document *const *each = fg_documents; *each; each++)
    if (strlen((*each)->file) == length - start &&
        !strncmp((*each)->file, name + start, length - start))
      return *each;
  return NULL;
}

/* Returns the fact as the code states it; the caller frees. NULL: the fact is not known. */
static char *text_of_fact(const char *name, size_t length) {
  const fg_document *document = find_document(name, length);
  const fg_fact *fact = fg_fact_find(name, length);
  char *text = NULL;
  size_t size;
  if (!fact) fact = fg_manual_fact(name, length);
  if (!fact && !document) return NULL;
  FILE *out = open_memstream(&text, &size);
  if (!out) abort();
  if (document)
    fg_document_write_list(document, out);
  else
    fact->write(out);
  if (fclose(out) != 0) abort();
  return text;
}

/* Writes the fact. False where the shown text differs from it; only a table may differ. */
static bool put_fact(const char *fact, const char *shown, size_t length, FILE *out) {
  bool table = strchr(fact, '\n') != NULL;
  fputs(fact, out);
  return table || (strlen(fact) == length && !strncmp(fact, shown, length));
}

static bool fill_one(const char **at, char wrong[200], FILE *out) {
  const char *name = *at + sizeof begin - 1;
  const char *name_end = strstr(name, middle);
  const char *shown = name_end ? name_end + sizeof middle - 1 : NULL;
  const char *shown_end = shown ? strstr(shown, end) : NULL;
  if (!shown_end) {
    snprintf(wrong, 200, "a mark <!--@ without its end");
    return false;
  }
  char *fact = text_of_fact(name, (size_t)(name_end - name));
  if (!fact)
    snprintf(wrong, 200, "@%.*s@ is not known", (int)(name_end - name), name);
  else if (!put_fact(fact, shown, (size_t)(shown_end - shown), out))
    snprintf(wrong, 200, "@%.*s@ reads '%.*s', the code says '%.60s'", (int)(name_end - name), name,
             (int)(shown_end - shown), shown, fact);
  free(fact);
  *at = shown_end + sizeof end - 1;
  return !*wrong;
}

bool fg_manual_fill(const char *text, char wrong[200], FILE *out) {
  *wrong = '\0';
  while (*text) {
    if (strncmp(text, begin, sizeof begin - 1) != 0)
      fputc(*text++, out);
    else if (!fill_one(&text, wrong, out))
      return false;
  }
  return true;
}
