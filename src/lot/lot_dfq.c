/* results.dfq: the Q-DAS ASCII transfer format. A line is a K field, its characteristic and its
 * text; lines end with CR LF. Values stand in fields of their own: K0001 the value, K0002 its
 * attribute (0: valid, 255: no value), K0004 its date and time, K0006 the batch, here the coil,
 * K0009 a text, here what the manifest says besides, K0014 the part's ident, here the foil. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/json_writer.h"
#include "core/text.h"
#include "foilgauge/words.h"
#include "lot/characteristics.h"
#include "lot/lot_date.h"
#include "lot/writers.h"

/* The manifest's column of what Q-DAS calls a batch; and what its texts hold at most. */
#define COIL_COLUMN "coil"
enum { TEXT_BYTES_MOST = 255 };

/* A control character would start another field. */
static void put_text(FILE *out, const char *text) {
  while (*text)
    if ((unsigned char)*text < 0x20 || *text == 0x7F) {
      fputc(' ', out);
      text++;
    } else {
      text += fg_utf8_put(out, text);
    }
}

static void put_number(FILE *out, const char *field, size_t number, double value) {
  char text[32];
  if (!isfinite(value)) return;
  fg_json_format(text, value);
  fprintf(out, "%s/%zu %s\r\n", field, number, text);
}

static void put_characteristic(FILE *out, size_t number, const fg_lot_words *words,
                               const fg_characteristic *one) {
  const fg_quantity *row = one->quantity->row;
  const fg_tolerance *tolerance = one->quantity->tolerance;
  fprintf(out, "K2001/%zu %zu\r\nK2002/%zu %s", number, number, number, row->words);
  if (one->number) fprintf(out, "%s%d", words->before_number, one->number);
  fprintf(out, "\r\nK2022/%zu 6\r\n", number); /* decimal places */
  put_number(out, "K2101", number, one->nominal);
  if (tolerance) put_number(out, "K2110", number, tolerance->lower);
  if (tolerance) put_number(out, "K2111", number, tolerance->upper);
  fprintf(out, "K2142/%zu %s\r\n", number, row->unit);
}

/* dd.mm.yyyy/hh:mm:ss, of the manifest's column `date`, else of the scan's file. */
static void put_date(FILE *out, const fg_lot *lot, size_t item, size_t number) {
  size_t column = fg_manifest_column(&lot->manifest, FG_LOT_DATE_COLUMN);
  double days =
      fg_date_days(column == FG_NO_COLUMN ? lot->records[item].date
                                          : fg_manifest_cell(&lot->manifest, item, column));
  char date[FG_DATE_TEXT];
  if (!isfinite(days)) return;
  fg_date_format(days, date); /* 2026-11-20T13:45 */
  fprintf(out, "K0004/%zu %.2s.%.2s.%.4s/%s:00\r\n", number, date + 8, date + 5, date,
          date[10] ? date + 11 : "00:00");
}

/* The columns that have a field of their own, and those that are the scan's and the foil's names.
 */
static bool has_field(const char *column) {
  static const char *const names[] = {"scan", "foil", FG_LOT_DATE_COLUMN, COIL_COLUMN};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (!strcmp(column, names[i])) return true;
  return false;
}

/* "die A, operator Kim": a text of at most so many bytes as the format takes. */
static void put_besides(FILE *out, const fg_manifest *manifest, size_t item, size_t number) {
  char text[TEXT_BYTES_MOST] = "";
  for (size_t i = 0; i < manifest->columns; i++) {
    const char *cell = fg_manifest_cell(manifest, item, i);
    size_t used = strlen(text);
    if (*cell && !has_field(manifest->name[i]))
      fg_text_clip(text + used, sizeof text - used, "%s%s %s", used ? ", " : "", manifest->name[i],
                   cell);
  }
  if (!text[0]) return;
  fprintf(out, "K0009/%zu ", number);
  put_text(out, text);
  fputs("\r\n", out);
}

static void put_coil(FILE *out, const fg_manifest *manifest, size_t item, size_t number) {
  size_t column = fg_manifest_column(manifest, COIL_COLUMN);
  const char *cell = column == FG_NO_COLUMN ? "" : fg_manifest_cell(manifest, item, column);
  if (!*cell) return;
  fprintf(out, "K0006/%zu ", number);
  put_text(out, cell);
  fputs("\r\n", out);
}

static void put_foil(FILE *out, const fg_lot_analysis *analysis, const fg_lot_foil *foil,
                     const fg_characteristic *list, size_t count) {
  for (size_t i = 0; i < count; i++) {
    double u, value = fg_characteristic_value(&list[i], foil->foil, &u);
    bool known = isfinite(value);
    put_number(out, "K0001", i + 1, known ? value : 0);
    fprintf(out, "K0002/%zu %d\r\n", i + 1, known ? 0 : 255);
    put_date(out, analysis->lot, foil->item, i + 1);
    put_coil(out, &analysis->lot->manifest, foil->item, i + 1);
    put_besides(out, &analysis->lot->manifest, foil->item, i + 1);
    fprintf(out, "K0014/%zu ", i + 1);
    put_text(out, fg_manifest_label(&analysis->lot->manifest, foil->item));
    if (analysis->lot->records[foil->item].foil_count > 1) fprintf(out, " #%d", foil->foil->number);
    fputs("\r\n", out);
  }
}

fg_status fg_lot_write_dfq(fg_context *ctx, const fg_lot_analysis *analysis, FILE *out) {
  fg_characteristic *list;
  size_t count;
  FG_TRY(fg_characteristics_list(ctx, analysis, &list, &count));
  fprintf(out, "K0100 %zu\r\nK1001 ", count);
  put_text(out, analysis->lot->settings.design.name);
  fputs("\r\nK1002 ", out);
  put_text(out, analysis->lot->settings.name);
  fputs("\r\n", out);
  for (size_t i = 0; i < count; i++)
    put_characteristic(out, i + 1, fg_lot_words_of(analysis), &list[i]);
  for (size_t i = 0; i < analysis->foil_count; i++)
    put_foil(out, analysis, &analysis->foils[i], list, count);
  free(list);
  return fg_stream_finish(ctx, out, "results.dfq");
}
