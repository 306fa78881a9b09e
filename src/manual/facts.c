/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "manual/facts.h"

#include <stddef.h>
#include <string.h>

#include "cli/commands.h"
#include "foilgauge/control.h"
#include "foilgauge/picture.h"
#include "foilgauge/quantity.h"
#include "lot/statistics/analysis.h"
#include "scan/format.h"

static void write_commands(FILE *out) {
  fputs("| command | what it does |\n|---|---|\n", out);
  for (const fg_command *command = fg_commands; command->name; command++)
    fprintf(out, "| `foilgauge-%s`(1) | %s |\n", command->name, command->summary);
}

static void write_exit_codes(FILE *out) {
  fputs("| code | meaning |\n|---|---|\n", out);
  fprintf(out, "| 0 | %s; of commands that judge: %s |\n", fg_exit_codes[0].words,
          fg_exit_codes[1].words);
  for (const fg_exit_code *code = fg_exit_codes + 2; code->words; code++)
    fprintf(out, "| %d | %s |\n", code->code, code->words);
}

static void write_endings(FILE *out) {
  char text[200];
  fg_format_list_endings(text, sizeof text);
  fputs(text, out);
}

static void write_quantities(fg_quantity_owner owner, const char *prefix, FILE *out) {
  size_t count;
  const fg_quantity *rows = fg_quantities(owner, &count);
  fputs("| quantity | what it is |\n|---|---|\n", out);
  for (size_t i = 0; i < count; i++) {
    const char *name = owner == FG_QUANTITY_OF_BEARING ? rows[i].tolerance : rows[i].name;
    if (!name || rows[i].kind == FG_QUANTITY_PAIR) continue;
    fprintf(out, "| `%s%s` | %s |\n", prefix, name, rows[i].words);
  }
}

static void write_quantities_of_bump(FILE *out) {
  write_quantities(FG_QUANTITY_OF_BUMP, "", out);
}

static void write_quantities_of_beam(FILE *out) {
  write_quantities(FG_QUANTITY_OF_BEAM, "", out);
}

static void write_quantities_of_foil(FILE *out) {
  write_quantities(FG_QUANTITY_OF_FOIL, "", out);
}

static void write_quantities_of_bearing(FILE *out) {
  write_quantities(FG_QUANTITY_OF_BEARING, "", out);
}

static void write_quantities_of_disc(FILE *out) {
  write_quantities(FG_QUANTITY_OF_DISC, "", out);
}

static void write_run_rules(FILE *out) {
  fputs("| rule | signals |\n|---|---|\n", out);
  for (unsigned rule = 1; rule <= FG_RUN_RULES; rule++)
    fprintf(out, "| %u | %s |\n", rule, fg_run_rule_words(rule));
}

static void write_picture_findings(FILE *out) {
  fputs("| finding | what it means, and what to change |\n|---|---|\n", out);
  for (const fg_picture_words *words = fg_picture_finding_words(); words->name; words++)
    fprintf(out, "| `%s` | %s %s |\n", words->name, words->meaning, words->cure);
}

/* Writes the settings of one scanner interface, where it has any for a finding. */
static void write_settings(size_t offset, FILE *out) {
  fputs("| finding | settings |\n|---|---|\n", out);
  for (const fg_picture_words *words = fg_picture_finding_words(); words->name; words++) {
    const char *settings = *(const char *const *)((const char *)words + offset);
    if (settings[0]) fprintf(out, "| `%s` | %s |\n", words->name, settings);
  }
}

static void write_sane_settings(FILE *out) {
  write_settings(offsetof(fg_picture_words, sane), out);
}

static void write_twain_settings(FILE *out) {
  write_settings(offsetof(fg_picture_words, twain), out);
}

static void write_wia_settings(FILE *out) {
  write_settings(offsetof(fg_picture_words, wia), out);
}

static void write_picture_members(FILE *out) {
  fputs("| member of `picture` | what it is |\n|---|---|\n", out);
  for (const fg_picture_member *member = fg_picture_members(); member->name; member++)
    fprintf(out, "| `%s` | %s%s%s |\n", member->name, member->words, member->unit[0] ? ", " : "",
            member->unit);
}

static void write_lot_chart_level(FILE *out) {
  fputs(FG_LOT_CHART_LEVEL_TEXT, out);
}

static const fg_fact facts[] = {
    {"quantities_of_bump", write_quantities_of_bump},
    {"quantities_of_beam", write_quantities_of_beam},
    {"quantities_of_foil", write_quantities_of_foil},
    {"quantities_of_bearing", write_quantities_of_bearing},
    {"quantities_of_disc", write_quantities_of_disc},
    {"run_rules", write_run_rules},
    {"picture_findings", write_picture_findings},
    {"sane_settings", write_sane_settings},
    {"twain_settings", write_twain_settings},
    {"wia_settings", write_wia_settings},
    {"picture_members", write_picture_members},
    {"commands", write_commands},
    {"exit_codes", write_exit_codes},
    {"lot_chart_level", write_lot_chart_level},
    {"scan_endings", write_endings},
};

const fg_fact *fg_manual_fact(const char *name, size_t length) {
  for (size_t i = 0; i < sizeof facts / sizeof *facts; i++)
    if (strlen(facts[i].name) == length && !strncmp(facts[i].name, name, length)) return &facts[i];
  return NULL;
}
