#include "manual/facts.h"

#include <string.h>

#include "cli/commands.h"
#include "scan/format.h"

static void write_commands(FILE *out) {
  fputs("| command | what it does |\n|---|---|\n", out);
  for (const fg_command *command = fg_commands; command->name; command++)
    fprintf(out, "| `foilgauge-%s`(1) | %s |\n", command->name, command->summary);
}

static void write_exit_codes(FILE *out) {
  fputs("| code | meaning |\n|---|---|\n", out);
  for (const fg_exit_code *code = fg_exit_codes; code->words; code++)
    fprintf(out, "| %d | %s |\n", code->code, code->words);
}

static void write_endings(FILE *out) {
  char text[200];
  fg_format_list_endings(text, sizeof text);
  fputs(text, out);
}

static const fg_fact facts[] = {
    {"commands", write_commands},
    {"exit_codes", write_exit_codes},
    {"scan_endings", write_endings},
};

const fg_fact *fg_manual_fact(const char *name, size_t length) {
  for (size_t i = 0; i < sizeof facts / sizeof *facts; i++)
    if (strlen(facts[i].name) == length && !strncmp(facts[i].name, name, length)) return &facts[i];
  return NULL;
}
