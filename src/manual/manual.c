/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes the manual's pages, the completion of the shell and the JSON schemas: foilgauge_manual
 * FOLDER TEXT...
 *
 * FOLDER/man/<page>.<section>, FOLDER/completion/foilgauge, FOLDER/schema/<file>.schema.json,
 * FOLDER/man/examples (a command a line: the tests run them). A command without a text, a text of
 * no command that names a section 1 page, and a name that no fact has are errors. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli/commands.h"
#include "cli/facts.h"
#include "core/file.h"
#include "manual/documents.h"
#include "manual/marks.h"
#include "manual/page.h"

enum { TEXT_BYTES_MAX = 1 << 20, PAGES_MAX = 64 };

typedef struct manual {
  const char *folder;
  char name[PAGES_MAX][80]; /* pages that were written */
  size_t pages;
  FILE *examples;
} manual;

static int complain(const char *path, const char *what) {
  fprintf(stderr, "foilgauge_manual: %s: %s\n", path, what);
  return 1;
}

static FILE *create_output(const char *folder, const char *name) {
  char path[4096];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *out = fopen(path, "w");
  if (!out) complain(path, strerror(errno));
  return out;
}

static const fg_command *command_of(const fg_manual_text *text) {
  static const char prefix[] = "foilgauge-";
  const fg_command *command = fg_commands;
  if (text->section != '1' || strncmp(text->name, prefix, sizeof prefix - 1) != 0) return NULL;
  while (command->name && strcmp(command->name, text->name + sizeof prefix - 1) != 0)
    command++;
  return command;
}

/* A link of the alias' name to the command's page, as packages of Debian have it. */
static int link_alias(const manual *all, const fg_command *command) {
  char page[80], link[4096];
  if (!command || !command->alias) return 0;
  snprintf(page, sizeof page, "foilgauge-%s.1", command->name);
  snprintf(link, sizeof link, "%s/man/foilgauge-%s.1", all->folder, command->alias);
  if (unlink(link) != 0 && errno != ENOENT) return complain(link, strerror(errno));
  return symlink(page, link) == 0 ? 0 : complain(link, strerror(errno));
}

static int write_manual_page(manual *all, const char *path, const fg_manual_text *text) {
  char name[80], place[100];
  const fg_command *command = command_of(text);
  if (command && !command->name) return complain(path, "there is no such command");
  if (all->pages == PAGES_MAX) return complain(path, "too many pages");
  snprintf(name, sizeof name, "%.64s.%c", text->name, text->section);
  strcpy(all->name[all->pages++], name);
  snprintf(place, sizeof place, "man/%s", name);
  FILE *out = create_output(all->folder, place);
  if (!out) return 1;
  bool known = fg_manual_write_page(text, command, out);
  fprintf(all->examples, "# %s\n", name);
  fg_manual_write_examples(text, all->examples);
  if (fclose(out) != 0) return complain(name, "cannot be written");
  if (link_alias(all, command) != 0) return 1;
  return known ? 0
               : complain(path, "a @name@ of the command's help is not known, or a row of a table "
                                "has more cells than its head: a bar of the text is \\|");
}

static int read_page(manual *all, const char *path) {
  fg_context ctx = {0};
  fg_manual_text text = {0};
  char *raw, *whole = NULL;
  size_t size;
  char wrong[200];
  int skip = 0;
  if (fg_file_read_text(&ctx, path, TEXT_BYTES_MAX, &raw) != FG_OK)
    return complain(path, ctx.message);
  FILE *filled = open_memstream(&whole, &size);
  if (!filled) abort();
  bool known = fg_manual_fill(raw, wrong, filled);
  if (fclose(filled) != 0) abort();
  free(raw);
  bool titled = sscanf(whole, "# %63[^(](%c) - %199[^\n]%n", text.name, &text.section, text.summary,
                       &skip) == 3;
  text.body = whole + skip;
  const fg_command *command = titled ? command_of(&text) : NULL;
  bool same = !command || !command->name || !strcmp(command->summary, text.summary);
  int failed = !known    ? complain(path, wrong)
               : !titled ? complain(path, "does not begin with `# name(section) - summary`")
               : !same   ? complain(path, "its title says something else than `foilgauge help`")
                         : write_manual_page(all, path, &text);
  free(whole);
  return failed;
}

static int miss_commands(const manual *all) {
  int failed = 0;
  for (const fg_command *command = fg_commands; command->name; command++) {
    char name[80];
    size_t i = 0;
    snprintf(name, sizeof name, "foilgauge-%s.1", command->name);
    while (i < all->pages && strcmp(all->name[i], name) != 0)
      i++;
    if (i == all->pages) failed = complain(name, "the command has no text in src/manual/text");
  }
  return failed;
}

static int write_schemas(const manual *all) {
  int failed = 0;
  for (size_t i = 0; fg_documents[i]; i++) {
    char name[100];
    snprintf(name, sizeof name, "schema/%.60s.schema.json", fg_documents[i]->file);
    FILE *out = create_output(all->folder, name);
    if (!out) return 1;
    fg_document_write_schema(fg_documents[i], out);
    if (fclose(out) != 0) failed = complain(name, "cannot be written");
  }
  return failed;
}

int main(int argc, char **argv) {
  static const char *const folders[] = {"", "/man", "/completion", "/schema"};
  manual all = {0};
  int failed = 0;
  if (argc < 3) return complain("usage", "foilgauge_manual FOLDER TEXT...");
  all.folder = argv[1];
  for (size_t i = 0; i < sizeof folders / sizeof *folders; i++) {
    char path[4096];
    snprintf(path, sizeof path, "%s%s", argv[1], folders[i]);
    if (mkdir(path, 0777) != 0 && errno != EEXIST) return complain(path, strerror(errno));
  }
  FILE *completion = create_output(all.folder, "completion/foilgauge");
  all.examples = create_output(all.folder, "man/examples");
  if (!completion || !all.examples) return 1;
  for (int i = 2; i < argc; i++)
    failed |= read_page(&all, argv[i]);
  failed |= miss_commands(&all);
  failed |= write_schemas(&all);
  fg_manual_write_completion(completion);
  failed |= fclose(completion) != 0 || fclose(all.examples) != 0;
  return failed;
}
