/* SPDX-License-Identifier: GPL-3.0-or-later */
/* results.dfq: the Q-DAS ASCII transfer format. A line is a K field, its characteristic and its
 * text; lines end with CR LF. Values stand in fields of their own: K0001 the value, K0002 its
 * attribute (0: valid, 255: no value), K0004 its date and time, K0006 the batch, here the coil,
 * K0009 a text, here what the manifest says besides and the scan, K0014 the part's ident, here the
 * foil or the bearing: the characteristics of bearings that the manifest names follow those of
 * foils, with a value per bearing, whose text names its foils. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/file.h"
#include "core/json_writer.h"
#include "core/select.h"
#include "core/text.h"
#include "foilgauge/traceability.h"
#include "foilgauge/words.h"
#include "lot/run/date.h"
#include "report/lot/characteristics.h"
#include "report/lot/files.h"

/* Column of the manifest that Q-DAS calls batch, and the maximum of its texts. */
#define COIL_COLUMN "coil"
enum { TEXT_BYTES_MAX = 255 };

/* Replaces control characters: one would start another field. */
static void put_field_text(FILE *out, const char *text) {
  while (*text)
    if ((unsigned char)*text < 0x20 || *text == 0x7F) {
      fputc(' ', out);
      text++;
    } else {
      text += fg_utf8_put(out, text);
    }
}

static void put_value_field(FILE *out, const char *field, size_t number, double value) {
  char text[32];
  if (!isfinite(value)) return;
  fg_json_format(text, value);
  fprintf(out, "%s/%zu %s\r\n", field, number, text);
}

static void put_characteristic(FILE *out, size_t number, const fg_lot_words *words,
                               const fg_characteristic *one) {
  const fg_quantity *row = one->row;
  const fg_tolerance *tolerance = one->tolerance;
  fprintf(out, "K2001/%zu %zu\r\nK2002/%zu %s%s", number, number, number,
          one->owner == FG_QUANTITY_OF_BEARING ? "bearing: " : "", row->words);
  if (one->number) fprintf(out, "%s%d", words->before_number, one->number);
  fprintf(out, "\r\nK2022/%zu 6\r\n", number); /* decimal places */
  put_value_field(out, "K2101", number, one->nominal);
  if (tolerance) put_value_field(out, "K2110", number, tolerance->lower);
  if (tolerance) put_value_field(out, "K2111", number, tolerance->upper);
  fprintf(out, "K2142/%zu %s\r\n", number, row->unit);
}

/* Puts the date as dd.mm.yyyy/hh:mm:ss. It has no zone and is read as local time: a time with a Z
 * is UTC and is turned into that of this machine's zone. */
static void put_date_field(FILE *out, const fg_lot *lot, size_t item, size_t number) {
  const char *text = fg_lot_date_of(lot, item);
  double days = fg_date_days(text);
  char date[FG_DATE_TEXT];
  struct tm local;
  if (!isfinite(days)) return;
  time_t seconds = (time_t)llround(days * 86400);
  if (!(fg_date_is_utc(text) ? localtime_r(&seconds, &local) : gmtime_r(&seconds, &local))) return;
  strftime(date, sizeof date, "%d.%m.%Y/%H:%M:%S", &local);
  fprintf(out, "K0004/%zu %s\r\n", number, date);
}

/* Returns true for columns with a field of their own, and for the names of scan and foil. */
static bool has_field(const char *column) {
  static const char *const names[] = {"foil", FG_LOT_DATE_COLUMN, COIL_COLUMN, "scan"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (!strcmp(column, names[i])) return true;
  return false;
}

static void append_words(char text[TEXT_BYTES_MAX], const char *name, const char *value) {
  size_t used = strlen(text);
  fg_text_clip(text + used, TEXT_BYTES_MAX - used, "%s%s %s", used ? ", " : "", name, value);
}

static void put_besides_field(FILE *out, const char *text, size_t number) {
  if (!*text) return;
  fprintf(out, "K0009/%zu ", number);
  put_field_text(out, text);
  fputs("\r\n", out);
}

/* Describes a foil: "die A, operator Kim, scan foil_7.png", clipped to the bytes that the format
 * takes. */
static void describe_foil(const fg_manifest *manifest, const fg_measured_part *part,
                          char text[TEXT_BYTES_MAX]) {
  size_t item = part->foil->item;
  const char *scan = fg_manifest_scan(manifest, item), *slash = strrchr(scan, '/');
  text[0] = '\0';
  for (size_t i = 0; i < manifest->columns; i++) {
    const char *cell = fg_manifest_cell(manifest, item, i);
    if (*cell && !has_field(manifest->name[i])) append_words(text, manifest->name[i], cell);
  }
  append_words(text, "scan", slash && slash[1] ? slash + 1 : scan);
}

/* Describes the pads of a bearing: "pad 1 L7-01, pad 3 L7-02". */
static void describe_bearing_pads(const fg_lot_analysis *analysis, const fg_measured_part *part,
                                  char text[TEXT_BYTES_MAX]) {
  text[0] = '\0';
  for (size_t pad = 0; pad < analysis->layout.pads; pad++) {
    const fg_lot_foil *foil = part->bearing->pad[pad];
    char name[32];
    snprintf(name, sizeof name, "pad %zu", pad + 1);
    if (foil) append_words(text, name, fg_manifest_label(&analysis->lot->manifest, foil->item));
  }
}

static void put_batch_field(FILE *out, const fg_manifest *manifest, size_t item, size_t number) {
  size_t column = fg_manifest_column(manifest, COIL_COLUMN);
  const char *cell = column == FG_NO_COLUMN ? "" : fg_manifest_cell(manifest, item, column);
  if (!*cell) return;
  fprintf(out, "K0006/%zu ", number);
  put_field_text(out, cell);
  fputs("\r\n", out);
}

static void put_ident_field(FILE *out, const fg_lot_analysis *analysis,
                            const fg_measured_part *part, size_t number) {
  const fg_lot *lot = analysis->lot;
  fprintf(out, "K0014/%zu ", number);
  put_field_text(out, part->foil ? fg_manifest_label(&lot->manifest, part->foil->item)
                                 : part->bearing->name);
  if (part->foil && lot->records[part->foil->item].foil_count > 1)
    fprintf(out, " #%d", part->foil->foil->number);
  fputs("\r\n", out);
}

static void put_part_values(FILE *out, const fg_lot_analysis *analysis,
                            const fg_measured_part *part, const fg_characteristic *list,
                            size_t count) {
  const fg_lot *lot = analysis->lot;
  char besides[TEXT_BYTES_MAX];
  if (part->foil)
    describe_foil(&lot->manifest, part, besides);
  else
    describe_bearing_pads(analysis, part, besides);
  for (size_t i = 0; i < count; i++) {
    if ((list[i].owner == FG_QUANTITY_OF_BEARING) != !part->foil) continue;
    double u, value = fg_characteristic_value(&list[i], part, &u);
    bool known = isfinite(value);
    put_value_field(out, "K0001", i + 1, known ? value : 0);
    fprintf(out, "K0002/%zu %d\r\n", i + 1, known ? 0 : 255);
    if (part->foil) put_date_field(out, lot, part->foil->item, i + 1);
    if (part->foil) put_batch_field(out, &lot->manifest, part->foil->item, i + 1);
    put_besides_field(out, besides, i + 1);
    put_ident_field(out, analysis, part, i + 1);
  }
}

static int is_of_foil(const void *a, const void *b) {
  const fg_measured_part *one = a, *other = b;
  if (!one->foil != !other->foil) return one->foil ? -1 : 1;
  if (one->foil) return (one->foil > other->foil) - (one->foil < other->foil);
  return (one->bearing > other->bearing) - (one->bearing < other->bearing);
}

/* Puts the foils in the order of the lot, then the bearings. */
static void put_all_parts(FILE *out, const fg_lot_analysis *analysis, fg_measured_part *parts,
                          size_t part_count, const fg_characteristic *list, size_t count) {
  fg_sort_items(parts, part_count, sizeof *parts, is_of_foil);
  for (size_t i = 0; i < part_count; i++)
    put_part_values(out, analysis, &parts[i], list, count);
}

fg_status fg_lot_write_dfq(fg_context *ctx, const fg_lot_analysis *analysis, FILE *out) {
  fg_characteristic *list;
  fg_measured_part *parts;
  size_t count, part_count;
  char traced[FG_TRACEABILITY_SENTENCE];
  FG_TRY(fg_characteristics_list(ctx, analysis, &list, &count));
  fg_status status = fg_measured_parts_list(ctx, analysis, &parts, &part_count);
  if (status != FG_OK) {
    free(list);
    return status;
  }
  fprintf(out, "K0100 %zu\r\nK1001 ", count);
  put_field_text(out, analysis->lot->settings.design.name);
  fputs("\r\nK1002 ", out);
  put_field_text(out, analysis->lot->settings.name);
  fputs("\r\nK1900 traced to ", out);
  fg_traceability_sentence(&analysis->lot->settings.design, traced, sizeof traced);
  put_field_text(out, traced);
  fputs("\r\n", out);
  for (size_t i = 0; i < count; i++)
    put_characteristic(out, i + 1, fg_lot_words_of(analysis), &list[i]);
  put_all_parts(out, analysis, parts, part_count, list, count);
  free(parts);
  free(list);
  return fg_stream_finish(ctx, out, "results.dfq");
}
