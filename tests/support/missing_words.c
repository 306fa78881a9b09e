/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints the texts of pages that a language has no words for, each once with the number of its
 * pages. Usage: missing_words TAG PAGE.html... */
#include <stdlib.h>
#include <string.h>

#include "foilgauge/file.h"
#include "language/language.h"

typedef struct list {
  char **text;
  size_t count;
} list;

static void add(void *user, const char *text) {
  list *found = user;
  for (size_t i = 0; i < found->count; i++)
    if (!strcmp(found->text[i], text)) return;
  char **grown = realloc(found->text, (found->count + 1) * sizeof *grown);
  if (!grown) return;
  found->text = grown;
  found->text[found->count++] = strdup(text);
  puts(text);
}

static int read_page(const fg_language *language, const char *path, list *found) {
  const fg_missing_words missing = {add, found};
  char *text = NULL;
  size_t size = 0, got;
  char block[65536];
  FILE *file = fopen(path, "r"), *whole = open_memstream(&text, &size),
       *out = fopen("/dev/null", "w");
  if (!file || !whole || !out) return 1;
  while ((got = fread(block, 1, sizeof block, file)))
    fwrite(block, 1, got, whole);
  fclose(whole);
  fg_language_write_html(language, text, size, out, &missing);
  free(text);
  fclose(out);
  fclose(file);
  return 0;
}

int main(int argc, char **argv) {
  fg_context ctx = {.message = ""};
  fg_languages *languages;
  list found = {0};
  if (argc < 3 || fg_languages_open(&ctx, &languages) != FG_OK) {
    fprintf(stderr, "%s\n", ctx.message);
    return 2;
  }
  const fg_language *language = fg_languages_choose(languages, argv[1], NULL);
  int failed = language == NULL;
  for (int i = 2; i < argc && !failed; i++)
    failed = read_page(language, argv[i], &found);
  fg_languages_close(languages);
  for (size_t i = 0; i < found.count; i++)
    free(found.text[i]);
  free(found.text);
  return failed ? 2 : found.count ? 1 : 0;
}
