/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Foils of a lot, from its foils.csv and its bumps.csv or beams.csv. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/memory.h"
#include "core/select.h"
#include "core/text.h"
#include "foilgauge/foil_kind.h"
#include "foilgauge/table.h"
#include "foilgauge/words.h"
#include "lot/statistics/analysis.h"
#include "lots/index.h"

/* Tolerance of a mean: lot.json has ten digits, and so have the values that the mean is computed
 * from. */
#define SAME_MEAN 1e-8

enum { TABLE_BYTES_MAX = 1 << 30, CELL = 160 };

typedef struct reading {
  fg_index *index;
  fg_index_lot *lot;
  fg_table foils, parts; /* tables of the lot's CSV files */
  size_t *foil;          /* row of foils.csv by counted foil */
  size_t *owner;         /* foil by row of `parts` */
  size_t *same;          /* by counted foil: the first scan of the same foil */
  bool repeats;          /* some foil was scanned more than once */
  size_t *slot;          /* by row of `parts`: parts of one number in scans of a foil share one */
  size_t *slot_foil, slots;
  double *sum;           /* by slot, or by foil */
  size_t *count, *known; /* number of values: as of `sum`, and by foil */
} reading;

static const fg_column *find_column(const fg_table *table, const char *name) {
  const fg_column *column;
  fg_context unused;
  return fg_table_find(&unused, table, name, &column) == FG_OK ? column : NULL;
}

static double cell_number(const fg_column *column, size_t row) {
  bool number = !column->word || column->word[row] == FG_TABLE_NOT_A_WORD;
  return number ? column->number[row].value : NAN;
}

/* Returns a cell as text; "" for a missing cell or column. */
static const char *cell_text(const fg_column *column, size_t row, char text[CELL]) {
  text[0] = '\0';
  if (!column || (column->word && column->word[row] == FG_TABLE_MISSING)) return text;
  if (!column->word || column->word[row] == FG_TABLE_NOT_A_WORD)
    snprintf(text, CELL, "%.12g", column->number[row].value);
  else
    fg_text_clip(text, CELL, "%s", column->words[column->word[row]]);
  return text;
}

/* Returns true when the flags of a cell, separated by spaces, hold this one. */
static bool has_flag_name(const fg_flag_words *words, const char *flags, unsigned flag) {
  for (; words->name; words++) {
    size_t length = strlen(words->name);
    if (words->flag != flag) continue;
    for (const char *at = flags; (at = strstr(at, words->name)); at += length)
      if ((at == flags || at[-1] == ' ') && (at[length] == ' ' || !at[length])) return true;
  }
  return false;
}

/* Lists the lines of foils.csv that count: those of foils of the design. */
static fg_status list_counted_foils(fg_context *ctx, reading *r) {
  char flags[CELL];
  void *block;
  const fg_column *number = find_column(&r->foils, "foil_number"),
                  *flag = find_column(&r->foils, "flags");
  FG_TRY(fg_memory_allocate(ctx, r->foils.rows, sizeof *r->foil, &block));
  r->foil = block;
  for (size_t row = 0; number && row < r->foils.rows; row++) {
    cell_text(flag, row, flags);
    bool measured = !has_flag_name(fg_foil_flag_words(), flags, FG_FOIL_NOT_MEASURED) &&
                    !has_flag_name(fg_foil_flag_words(), flags, FG_FOIL_NOT_THIS_DESIGN);
    if (measured && isfinite(cell_number(number, row))) r->foil[r->lot->foil_count++] = row;
  }
  return FG_OK;
}

static fg_status find_or_add_die(fg_context *ctx, fg_index *index, const char *name, size_t *die) {
  *die = FG_INDEX_NONE;
  if (!*name) return FG_OK;
  for (*die = 0; *die < index->die_count; ++*die)
    if (!strcmp(index->dies[*die].name, name)) return FG_OK;
  FG_TRY(fg_memory_reserve(ctx, index->die_count + 1, sizeof *index->dies, &index->die_capacity,
                           (void **)&index->dies));
  index->dies[index->die_count] = (fg_index_die){.name = NULL};
  FG_TRY(fg_text_print(ctx, &index->dies[index->die_count].name, "%s", name));
  index->die_count++;
  return FG_OK;
}

/* Lists the distinct words of a column: "A, B". */
static fg_status list_words(fg_context *ctx, const reading *r, const char *name, char **words) {
  const fg_column *column = find_column(&r->foils, name);
  char cell[CELL], before[CELL];
  for (size_t i = 0; column && i < r->lot->foil_count; i++) {
    bool known = !*cell_text(column, r->foil[i], cell);
    for (size_t k = 0; k < i && !known; k++)
      known = !strcmp(cell, cell_text(column, r->foil[k], before));
    if (!known) FG_TRY(fg_text_append(ctx, words, "%s%s", *words ? ", " : "", cell));
  }
  return FG_OK;
}

static fg_status assign_dies(fg_context *ctx, reading *r) {
  const fg_column *column = find_column(&r->foils, "die");
  char cell[CELL];
  void *block;
  FG_TRY(fg_memory_allocate(ctx, r->lot->foil_count, sizeof *r->lot->die, &block));
  r->lot->die = block;
  for (size_t i = 0; i < r->lot->foil_count; i++)
    FG_TRY(find_or_add_die(ctx, r->index,
                           r->same[i] == i ? cell_text(column, r->foil[i], cell) : "",
                           &r->lot->die[i]));
  return list_words(ctx, r, "coil", &r->lot->coils);
}

/* Returns true for the flags of a part that does not count, as fg_lot_part_counts does. */
static bool is_damaged(const fg_index_lot *lot, const char *flags) {
  bool damaged = false;
  if (fg_foil_kind_parts(lot->design.kind) == FG_QUANTITY_OF_BUMP)
    return has_flag_name(fg_bump_flag_words(), flags, FG_BUMP_CRUSHED);
  for (unsigned flag = 1; flag <= FG_LOT_BEAM_DAMAGED; flag <<= 1)
    damaged =
        damaged || (flag & FG_LOT_BEAM_DAMAGED && has_flag_name(fg_beam_flag_words(), flags, flag));
  return damaged;
}

/* Assigns a foil to every line of `parts`, FG_INDEX_NONE to one that does not count. Both files
 * have one order. */
static fg_status assign_parts(fg_context *ctx, reading *r) {
  const fg_column *scan[2] = {find_column(&r->foils, "scan"), find_column(&r->parts, "scan")},
                  *number[2] = {find_column(&r->foils, "foil_number"),
                                find_column(&r->parts, "foil_number")},
                  *flag = find_column(&r->parts, "flags");
  char a[CELL], b[CELL];
  size_t foil = 0;
  void *block;
  FG_TRY(fg_memory_allocate(ctx, r->parts.rows, sizeof *r->owner, &block));
  r->owner = block;
  for (size_t row = 0; row < r->parts.rows; row++) {
    size_t at = foil;
    r->owner[row] = FG_INDEX_NONE;
    if (!scan[0] || !scan[1] || !number[0] || !number[1]) continue;
    while (at < r->lot->foil_count &&
           (cell_number(number[0], r->foil[at]) != cell_number(number[1], row) ||
            strcmp(cell_text(scan[0], r->foil[at], a), cell_text(scan[1], row, b)) != 0))
      at++;
    if (at == r->lot->foil_count) continue; /* its foil does not count */
    foil = at;
    if (!is_damaged(r->lot, cell_text(flag, row, a))) r->owner[row] = foil;
  }
  return FG_OK;
}

/* Foil of a scan by its cells of the columns `foil` and `bearing` and its number in the scan. */
typedef struct named_scan {
  char name[CELL], bearing[CELL];
  double number;
  size_t at;
} named_scan;

static int compare_scans(const void *a, const void *b) {
  const named_scan *p = a, *q = b;
  int order = strcmp(p->name, q->name);
  if (order == 0) order = strcmp(p->bearing, q->bearing);
  if (order == 0) order = (p->number > q->number) - (p->number < q->number);
  return order ? order : (p->at > q->at) - (p->at < q->at);
}

/* Finds the scans that show one foil: it counts once, as in the lot's own report. */
static fg_status find_same_foils(fg_context *ctx, reading *r) {
  const fg_column *name = find_column(&r->foils, "foil"),
                  *bearing = find_column(&r->foils, "bearing"),
                  *number = find_column(&r->foils, "foil_number");
  size_t foils = r->lot->foil_count, count = 0;
  named_scan *scan;
  FG_TRY(fg_memory_allocate(ctx, foils, sizeof *r->same, (void **)&r->same));
  FG_TRY(fg_memory_allocate(ctx, foils, sizeof *scan, (void **)&scan));
  for (size_t i = 0; i < foils; i++) {
    r->same[i] = i;
    scan[count] = (named_scan){.number = number ? cell_number(number, r->foil[i]) : 1, .at = i};
    cell_text(bearing, r->foil[i], scan[count].bearing);
    count += *cell_text(name, r->foil[i], scan[count].name) != '\0';
  }
  fg_sort_items(scan, count, sizeof *scan, compare_scans);
  for (size_t k = 1; k < count; k++)
    if (!strcmp(scan[k].name, scan[k - 1].name) && scan[k].number == scan[k - 1].number &&
        !strcmp(scan[k].bearing, scan[k - 1].bearing)) {
      r->same[scan[k].at] = r->same[scan[k - 1].at];
      r->repeats = true;
    }
  free(scan);
  return FG_OK;
}

static void put_in_slot(reading *r, size_t row, size_t slot) {
  r->slot[row] = slot;
  if (slot == r->slots) r->slot_foil[r->slots++] = r->same[r->owner[row]];
}

/* Puts every row into a slot of its own, rows of one number in scans of one foil into one. */
static fg_status find_slots(fg_context *ctx, reading *r) {
  bool bumps = fg_foil_kind_parts(r->lot->design.kind) == FG_QUANTITY_OF_BUMP;
  const fg_column *number = find_column(&r->parts, bumps ? "bump" : "beam");
  size_t rows = r->parts.rows, numbers = 1, *slot_of = NULL;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *r->slot, (void **)&r->slot));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *r->slot_foil, (void **)&r->slot_foil));
  for (size_t row = 0; number && row < rows; row++)
    if (cell_number(number, row) >= (double)numbers) numbers = (size_t)cell_number(number, row) + 1;
  if (r->repeats)
    FG_TRY(
        fg_memory_allocate(ctx, r->lot->foil_count, numbers * sizeof *slot_of, (void **)&slot_of));
  for (size_t row = 0; row < rows; row++) {
    if (r->owner[row] == FG_INDEX_NONE) continue;
    double n = number && r->repeats ? cell_number(number, row) : NAN;
    size_t *key = n >= 0 ? &slot_of[r->same[r->owner[row]] * numbers + (size_t)n] : NULL;
    put_in_slot(r, row, key && *key ? *key - 1 : r->slots);
    if (key) *key = r->slot[row] + 1;
  }
  free(slot_of);
  return FG_OK;
}

/* Adds the values of a column up by slot, or by foil; returns their number and adds their sum. */
static size_t add_values_of_column(reading *r, const fg_column *column, bool of_part, double *sum) {
  size_t lines = of_part ? r->parts.rows : r->lot->foil_count, known = 0;
  size_t slots = of_part ? r->slots : r->lot->foil_count;
  for (size_t s = 0; s < slots; s++) {
    r->sum[s] = 0;
    r->count[s] = 0;
  }
  for (size_t i = 0; column && i < lines; i++) {
    double value = cell_number(column, of_part ? i : r->foil[i]);
    if ((of_part && r->owner[i] == FG_INDEX_NONE) || !isfinite(value)) continue;
    size_t slot = of_part ? r->slot[i] : r->same[i];
    r->sum[slot] += value;
    r->count[slot]++;
    *sum += value;
    known++;
  }
  return known;
}

/* Reads the value of every foil, or the mean of its parts; *mean is the mean of all values. An
 * earlier version of the program counted scans: its mean is that of all lines. */
static fg_status read_stat(fg_context *ctx, reading *r, fg_index_stat *stat, double *mean) {
  bool of_part = fg_owner_is_part(stat->owner);
  const fg_table *table = of_part ? &r->parts : &r->foils;
  size_t foils = r->lot->foil_count, slots = of_part ? r->slots : foils, known = 0;
  double sum = 0, all = 0;
  FG_TRY(fg_memory_allocate(ctx, foils, sizeof *stat->foil, (void **)&stat->foil));
  memset(r->known, 0, foils * sizeof *r->known);
  size_t lines = add_values_of_column(r, find_column(table, stat->row->name), of_part, &all);
  for (size_t s = 0; s < slots; s++) {
    if (!r->count[s]) continue;
    size_t foil = of_part ? r->slot_foil[s] : s;
    double value = r->sum[s] / (double)r->count[s];
    stat->foil[foil] += value;
    r->known[foil]++;
    sum += value;
    known++;
  }
  for (size_t i = 0; i < foils; i++)
    stat->foil[i] = r->known[i] ? stat->foil[i] / (double)r->known[i] : NAN;
  *mean = known && known == stat->count   ? sum / (double)known
          : lines && lines == stat->count ? all / (double)lines
                                          : NAN;
  return FG_OK;
}

static fg_status read_ratios(fg_context *ctx, reading *r) {
  fg_index_lot *lot = r->lot;
  double unused = 0;
  FG_TRY(fg_memory_allocate(ctx, r->slots, sizeof *lot->ratio, (void **)&lot->ratio));
  FG_TRY(fg_memory_allocate(ctx, r->slots, sizeof *lot->ratio_foil, (void **)&lot->ratio_foil));
  add_values_of_column(r, find_column(&r->parts, "radius_mm"), true, &unused);
  for (size_t s = 0; s < r->slots; s++) {
    if (!r->count[s]) continue;
    lot->ratio_foil[lot->ratios] = r->slot_foil[s];
    lot->ratio[lot->ratios++] = r->sum[s] / (double)r->count[s] / lot->design.bumps.radius_mm;
  }
  return FG_OK;
}

static const char *parts_file_name(const fg_index_lot *lot) {
  return fg_foil_traits_of(lot->design.kind)->parts_file;
}

/* Checks the files against lot.json: another run may have written one of them. */
static fg_status read_stats(fg_context *ctx, reading *r) {
  fg_index_lot *lot = r->lot;
  size_t max = r->slots > lot->foil_count ? r->slots : lot->foil_count;
  FG_TRY(fg_memory_allocate(ctx, max, sizeof *r->sum, (void **)&r->sum));
  FG_TRY(fg_memory_allocate(ctx, max, sizeof *r->count, (void **)&r->count));
  FG_TRY(fg_memory_allocate(ctx, lot->foil_count, sizeof *r->known, (void **)&r->known));
  for (size_t i = 0; i < lot->stat_count; i++) {
    double mean;
    fg_index_stat *stat = &lot->stats[i];
    FG_TRY(read_stat(ctx, r, stat, &mean));
    if (stat->count == 0 || fabs(mean - stat->mean) <= SAME_MEAN * fmax(fabs(stat->max), 1e-3))
      continue;
    return fg_text_print(ctx, &lot->foils_unknown,
                         "%s: foils.csv and %s hold other values of %s than lot.json; write "
                         "them again with `foilgauge lot %s/manifest.csv -o %s --recipe "
                         "%s/recipe.json --resume`",
                         lot->folder, parts_file_name(lot), stat->row->name, lot->folder,
                         lot->folder, lot->folder);
  }
  return read_ratios(ctx, r);
}

/* Reads a table; one without rows is a lot without foils. */
static fg_status read_lot_csv(fg_context *ctx, fg_index_lot *lot, const char *name,
                              fg_table *table) {
  char *path, *text = NULL;
  fg_context inner = {.message = ""};
  FG_TRY(fg_lot_path(ctx, lot->folder, name, &path));
  fg_status status = fg_file_read_text(&inner, path, TABLE_BYTES_MAX, &text);
  bool lines = status == FG_OK && strchr(text, '\n') && strchr(text, '\n')[1];
  if (lines) status = fg_table_parse(&inner, path, text, strlen(text), table);
  if (status == FG_ERR_MEMORY)
    fg_fail(ctx, status, "%s", inner.message);
  else if (status != FG_OK)
    status = fg_text_print(ctx, &lot->foils_unknown, "%s", inner.message);
  free(text);
  free(path);
  return status;
}

/* Drops the foils of a lot that are not known one by one. */
static void drop_foils(fg_index_lot *lot) {
  for (size_t i = 0; i < lot->stat_count; i++) {
    free(lot->stats[i].foil);
    lot->stats[i].foil = NULL;
  }
  lot->foil_count = lot->ratios = 0;
}

fg_status fg_index_read_foils(fg_context *ctx, fg_index *index, fg_index_lot *lot) {
  reading r = {.index = index, .lot = lot};
  fg_status status = FG_OK;
  FG_TRY_EXIT(read_lot_csv(ctx, lot, "foils.csv", &r.foils));
  if (!lot->foils_unknown) FG_TRY_EXIT(read_lot_csv(ctx, lot, parts_file_name(lot), &r.parts));
  if (lot->foils_unknown) goto exit;
  FG_TRY_EXIT(list_counted_foils(ctx, &r));
  FG_TRY_EXIT(assign_parts(ctx, &r));
  FG_TRY_EXIT(find_same_foils(ctx, &r));
  FG_TRY_EXIT(find_slots(ctx, &r));
  FG_TRY_EXIT(read_stats(ctx, &r));
  if (!lot->foils_unknown) FG_TRY_EXIT(assign_dies(ctx, &r));
exit:
  if (lot->foils_unknown) drop_foils(lot);
  fg_table_free(&r.foils);
  fg_table_free(&r.parts);
  free(r.foil);
  free(r.owner);
  free(r.same);
  free(r.slot);
  free(r.slot_foil);
  free(r.sum);
  free(r.count);
  free(r.known);
  return status;
}
