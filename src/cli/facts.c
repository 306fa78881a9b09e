/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/facts.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "cli/commands.h"
#include "cli/known.h"
#include "foilgauge/compensation.h"
#include "foilgauge/die.h"
#include "foilgauge/experiment.h"
#include "foilgauge/film.h"
#include "foilgauge/load_test.h"
#include "foilgauge/measure.h"
#include "foilgauge/scan.h"
#include "foilgauge/stiffness.h"
#include "foilgauge/words.h"

const fg_exit_code fg_exit_codes[] = {
    {0, "done"},
    {0, "all measured and within tolerance, or no tolerance is stated"},
    {1, "a limit is exceeded by more than U, or a bump is missing"},
    {2, "something could not be measured"},
    {3,
     "cannot tell: a limit lies within U of a value, or nothing is known of the scanner's scale, "
     "and nothing fails; or an effect is suspected, not proven"},
    {64, "the command line is wrong"},
    {65, "a file's content is wrong"},
    {71, "out of memory: nothing is said of the input; close other programs, or give it less at a "
         "time"},
    {74, "a file cannot be read or written, or who reads standard output has gone"},
    {130, "interrupted"},
    {0, NULL},
};

/* Exit codes of commands by kind: those that judge values, those that measure scans, which may
 * fail, and the others. */
static const struct {
  const char *name;
  const char *codes; /* of those below 64; 0: done */
} exit_kinds[] = {
    {"exit_judged", "123"}, {"exit_partly", "02"}, {"exit_loop", "023"}, {"exit_done", "0"}};

bool fg_exit_codes_use(const char *kind, size_t length, const fg_exit_code *code) {
  for (size_t i = 0; i < sizeof exit_kinds / sizeof *exit_kinds; i++) {
    const char *name = exit_kinds[i].name, *codes = exit_kinds[i].codes;
    if (strlen(name) != length || strncmp(name, kind, length) != 0) continue;
    if (code->code == 0) return (strchr(codes, '0') != NULL) == (code == fg_exit_codes);
    return code->code >= 64 || strchr(codes, '0' + code->code) != NULL;
  }
  return false;
}

static void write_exit(const char *kind, FILE *out) {
  const char *between = "Exit code: ";
  for (const fg_exit_code *code = fg_exit_codes; code->words; code++)
    if (fg_exit_codes_use(kind, strlen(kind), code)) {
      fprintf(out, "%s%d %s", between, code->code, code->words);
      between = "; ";
    }
  fputc('.', out);
}

static void write_exit_judged(FILE *out) {
  write_exit("exit_judged", out);
}

static void write_exit_partly(FILE *out) {
  write_exit("exit_partly", out);
}

static void write_exit_loop(FILE *out) {
  write_exit("exit_loop", out);
}

static void write_exit_done(FILE *out) {
  write_exit("exit_done", out);
}

static void write_formats(FILE *out) {
  char names[100];
  fg_scan_format_names(" or ", names, sizeof names);
  fputs(names, out);
}

static void write_channels(FILE *out) {
  for (int channel = FG_CHANNEL_AUTO; channel <= FG_CHANNEL_LUMINANCE; channel++)
    fprintf(out, "%s%s", channel == FG_CHANNEL_AUTO ? "" : ", ",
            fg_channel_word((fg_channel)channel));
}

static void write_pages(FILE *out) {
  for (int pages = FG_LOT_PAGES_ALL; pages <= FG_LOT_PAGES_NONE; pages++)
    fprintf(out, "%s%s", pages == FG_LOT_PAGES_ALL ? "" : ", ",
            fg_lot_pages_word((fg_lot_pages)pages));
}

static void write_pixel_cap(FILE *out) {
  fprintf(out, "%g", FG_SCAN_PIXEL_CAP);
}

static void write_memory_cap(FILE *out) {
  fprintf(out, "%d", FG_MEASURE_MEMORY_CAP_MIB);
}

static void write_confidence(FILE *out) {
  fprintf(out, "%g", FG_EXPERIMENT_CONFIDENCE);
}

static void write_max_slope(FILE *out) {
  fprintf(out, "%g", FG_DIE_MAX_SLOPE_DEG);
}

static void write_max_move(FILE *out) {
  fprintf(out, "%g", FG_COMPENSATION_MAX_MOVE_PCT);
}

static void write_load_threshold(FILE *out) {
  fprintf(out, "%g", FG_LOAD_THRESHOLD_N);
}

static void write_load_u_force(FILE *out) {
  fprintf(out, "%g", FG_LOAD_U_FORCE_PCT);
}

static void write_load_u_displacement(FILE *out) {
  fprintf(out, "%g", FG_LOAD_U_DISPLACEMENT_PCT);
}

static void write_load_u_weight(FILE *out) {
  fprintf(out, "%g", FG_LOAD_U_WEIGHT_PCT);
}

static void write_load_diameter(FILE *out) {
  fprintf(out, "%g", FG_LOAD_DIAMETER_MM);
}

static void write_load_length(FILE *out) {
  fprintf(out, "%g", FG_LOAD_LENGTH_MM);
}

static void write_modulus(FILE *out) {
  fprintf(out, "%g", fg_arch_material_default().youngs_modulus_gpa);
}

static void write_poisson(FILE *out) {
  fprintf(out, "%g", fg_arch_material_default().poisson_ratio);
}

static void write_friction(FILE *out) {
  fprintf(out, "%g", fg_arch_material_default().friction);
}

#define FILM_FACT(name, format, field)                                                             \
  static void write_film_##name(FILE *out) {                                                       \
    fprintf(out, format, fg_film_options_default().field);                                         \
  }
FILM_FACT(load_deg, "%g", load_deg)
FILM_FACT(loss_factor, "%g", loss_factor)
FILM_FACT(pads, "%zu", pads)
FILM_FACT(viscosity, "%g", viscosity_upa_s)
FILM_FACT(ambient, "%g", ambient_kpa)
FILM_FACT(speeds, "%zu", map.speeds)
FILM_FACT(touching, "%g", touching_um)
FILM_FACT(mesh_bump, "%zu", cells_per_bump)
FILM_FACT(mesh_axial, "%zu", cells_axial)

static void write_port(FILE *out) {
  fprintf(out, "%d", FG_CLI_STATION_PORT);
}

static void write_hub_port(FILE *out) {
  fprintf(out, "%d", FG_CLI_HUB_PORT);
}

static void write_minutes(FILE *out) {
  fprintf(out, "%d", FG_CLI_LOOP_MINUTES);
}

static void write_mebibytes(FILE *out) {
  fprintf(out, "%d", FG_CLI_LOOP_MEBIBYTES);
}

static void write_seed(FILE *out) {
  fprintf(out, "%d", FG_CLI_SEED);
}

static void write_lot_response(FILE *out) {
  fputs(FG_CLI_LOT_RESPONSE, out);
}

static void write_lot_model(FILE *out) {
  fputs(FG_CLI_LOT_MODEL, out);
}

static const fg_fact facts[] = {
    {"exit_judged", write_exit_judged},
    {"exit_partly", write_exit_partly},
    {"exit_loop", write_exit_loop},
    {"exit_done", write_exit_done},
    {"formats", write_formats},
    {"forms", fg_cli_write_foil_kinds},
    {"channels", write_channels},
    {"pages", write_pages},
    {"pixel_cap", write_pixel_cap},
    {"memory_cap_mib", write_memory_cap},
    {"confidence", write_confidence},
    {"max_slope_deg", write_max_slope},
    {"max_move_pct", write_max_move},
    {"load_threshold_n", write_load_threshold},
    {"load_u_force_pct", write_load_u_force},
    {"load_u_displacement_pct", write_load_u_displacement},
    {"load_u_weight_pct", write_load_u_weight},
    {"load_diameter_mm", write_load_diameter},
    {"load_length_mm", write_load_length},
    {"youngs_modulus_gpa", write_modulus},
    {"poisson_ratio", write_poisson},
    {"friction", write_friction},
    {"film_load_deg", write_film_load_deg},
    {"film_loss_factor", write_film_loss_factor},
    {"film_pads", write_film_pads},
    {"film_viscosity_upa_s", write_film_viscosity},
    {"film_ambient_kpa", write_film_ambient},
    {"film_speeds", write_film_speeds},
    {"film_touching_um", write_film_touching},
    {"film_mesh_bump", write_film_mesh_bump},
    {"film_mesh_axial", write_film_mesh_axial},
    {"station_port", write_port},
    {"hub_port", write_hub_port},
    {"loop_minutes", write_minutes},
    {"loop_mebibytes", write_mebibytes},
    {"seed", write_seed},
    {"lot_response", write_lot_response},
    {"lot_model", write_lot_model},
};

const fg_fact *fg_fact_find(const char *name, size_t length) {
  for (size_t i = 0; i < sizeof facts / sizeof *facts; i++)
    if (strlen(facts[i].name) == length && !strncmp(facts[i].name, name, length)) return &facts[i];
  return NULL;
}

/* Returns the length of a name between two @, of which the first is before `text`; 0: none. */
static size_t name_length(const char *text) {
  size_t length = 0;
  while (islower((unsigned char)text[length]) || text[length] == '_')
    length++;
  return text[length] == '@' ? length : 0;
}

bool fg_facts_write(const char *text, const fg_fact *(*more)(const char *, size_t), FILE *out) {
  bool known = true;
  while (*text) {
    size_t length = *text == '@' ? name_length(text + 1) : 0;
    const fg_fact *fact = length ? fg_fact_find(text + 1, length) : NULL;
    if (length && !fact && more) fact = more(text + 1, length);
    if (fact) fact->write(out);
    if (length && !fact) known = false;
    if (!fact) fputc(*text, out);
    text += fact ? length + 2 : 1;
  }
  return known;
}

char *fg_cli_fill(int key, const char *text, void *input) {
  char *whole = NULL;
  size_t size;
  (void)key;
  (void)input;
  if (!text || !strchr(text, '@')) return (char *)(uintptr_t)text;
  FILE *out = open_memstream(&whole, &size);
  if (!out) return (char *)(uintptr_t)text;
  fg_facts_write(text, NULL, out);
  return fclose(out) == 0 && whole ? whole : (char *)(uintptr_t)text;
}
