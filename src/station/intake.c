/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/intake.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "core/date.h"
#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/measure.h"
#include "foilgauge/scan.h"
#include "scan/format.h"
#include "scan/header.h"
#include "station/check.h"
#include "station/keep.h"
#include "station/lot_content.h"
#include "station/news.h"
#include "station/part_recipes.h"
#include "station/picture.h"
#include "station/scan_command.h"
#include "station/stored_name.h"

enum { HEAD_BYTES = 64, TAIL_BYTES = 12, WORDS = 1000 };

/* A file under examination. */
typedef struct intake {
  fg_inspection *station;
  const char *name; /* in the folder, any bytes */
  char *path, *stored;
  fg_station_file file;
  fg_named named;
  double arrived;
  char words[WORDS]; /* of its card */
  fg_writer writer;
  fg_order order;    /* that is open as the scan comes */
  fg_part_recipe by; /* recipe by which it is measured */
  bool scan;         /* or the beginning of one */
  bool sure;         /* that it is whole, as a look at its ends tells */
  bool later;        /* it has to be looked at again */
  bool silent;       /* nothing is new: no card */
} intake;

static bool read_ends(const char *path, uint8_t head[HEAD_BYTES], size_t *length,
                      uint8_t tail[TAIL_BYTES]) {
  int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) return false;
  ssize_t got = pread(file, head, HEAD_BYTES, 0);
  off_t end = lseek(file, 0, SEEK_END);
  bool whole = got >= 0 &&
               (end < TAIL_BYTES || pread(file, tail, TAIL_BYTES, end - TAIL_BYTES) == TAIL_BYTES);
  *length = got > 0 ? (size_t)got : 0;
  int error = errno;
  close(file);
  errno = error;
  return whole;
}

/* A PNG ends with an IEND chunk. Other formats are found to be cut off when they are read. */
static bool is_cut_off(const fg_format *format, const uint8_t tail[TAIL_BYTES], int64_t bytes) {
  static const uint8_t end[TAIL_BYTES] = {0, 0, 0, 0, 'I', 'E', 'N', 'D', 0xAE, 0x42, 0x60, 0x82};
  return format == &fg_format_png && (bytes < TAIL_BYTES || memcmp(tail, end, TAIL_BYTES) != 0);
}

/* Card by the first and last bytes of the file. FG_CARD_MEASURED: the scan seems whole, and is
 * whole if at->sure. */
static fg_card inspect_ends(intake *at) {
  uint8_t head[HEAD_BYTES], tail[TAIL_BYTES] = {0};
  size_t length;
  if (!read_ends(at->path, head, &length, tail)) {
    fg_text_clip(at->words, WORDS, "cannot be read: %s", strerror(errno));
    return FG_CARD_UNREADABLE;
  }
  if (!length) {
    fg_text_clip(at->words, WORDS, "is empty: it is looked at again when it changes");
    return FG_CARD_UNFINISHED;
  }
  const fg_format *format = fg_format_find(head, length);
  if (!format) {
    fg_format_problem(head, length, at->words, WORDS);
    return FG_CARD_FOREIGN;
  }
  at->sure = format == &fg_format_png;
  if (!is_cut_off(format, tail, at->file.bytes)) return FG_CARD_MEASURED;
  fg_text_clip(at->words, WORDS,
               "is not whole: its end is missing; it is looked at again when it changes, else scan "
               "or copy it again");
  return FG_CARD_UNFINISHED;
}

/* Refuses a file. `try_again`: it may become readable without a change to the file itself. */
static fg_status refuse_file(fg_context *ctx, intake *at, fg_card card, bool try_again) {
  fg_station_file file = at->file;
  if (try_again) file.modified_ns = -1;
  if (try_again)
    FG_TRY(
        fg_station_card_stands(ctx, &at->station->database, &file, card, at->words, &at->silent));
  if (!at->silent)
    FG_TRY(fg_station_keep_card(ctx, &at->station->database, &file, card, at->words, 0));
  at->station->outcome->refused++;
  at->station->outcome->judged.not_measured += card != FG_CARD_FOREIGN;
  return FG_OK;
}

/* The words without the file's path, which the card names. */
static void set_words(intake *at, const char *message) {
  size_t length = strlen(at->path);
  bool named = !strncmp(message, at->path, length) && !strncmp(message + length, ": ", 2);
  fg_text_clip(at->words, WORDS, "%s", named ? message + length + 2 : message);
}

/* The second column is true where an earlier scan shows the foil that the file's name states: the
 * file is the measured one, or a foil of that scan has the serial number, and the lot where the
 * name has one. Bytes that come again under another serial number are no measurement of that foil.
 */
static const char find_known[] =
    "SELECT path, path = ?1 OR EXISTS (SELECT 1 FROM foils WHERE scan = scans.id"
    " AND (serial = ?2 OR serial = ?2 || '.' || number) AND (?3 = '' OR lot = ?3)),"
    " (SELECT group_concat(serial, ', ') FROM foils WHERE scan = scans.id)"
    " FROM scans WHERE id = ?4";

static fg_status keep_known(fg_context *ctx, intake *at, int64_t scan) {
  fg_query query;
  fg_card card = FG_CARD_KNOWN;
  fg_station_database *database = &at->station->database;
  pthread_mutex_lock(&database->writing);
  fg_query_begin(database->writer, find_known, &query);
  fg_query_text(&query, at->file.name);
  fg_query_text(&query, at->named.serial);
  fg_query_text(&query, at->named.lot);
  fg_query_integer(&query, scan);
  if (fg_query_row(&query)) {
    card = fg_query_get_integer(&query, 1) ? FG_CARD_KNOWN : FG_CARD_DUPLICATE;
    fg_text_clip(at->words, WORDS, "is the scan that was measured before as %s",
                 fg_query_get_text(&query, 0));
    if (card == FG_CARD_DUPLICATE)
      fg_text_clip(at->words, WORDS,
                   "is, byte for byte, the scan that was measured before as %s: it shows foil %s, "
                   "and says nothing of foil %s",
                   fg_query_get_text(&query, 0), fg_query_get_text(&query, 2), at->named.serial);
  }
  fg_status status = fg_query_end(ctx, &query, "reading the scans");
  pthread_mutex_unlock(&database->writing);
  if (status == FG_OK)
    status = fg_station_keep_card(ctx, database, &at->file, card, at->words, scan);
  at->station->outcome->known += status == FG_OK;
  at->station->outcome->judged.not_measured += status == FG_OK && card == FG_CARD_DUPLICATE;
  return status;
}

/* True when the file has not changed since its inspection began; else the data read are of no
 * one scan. */
static bool is_unchanged(const intake *at) {
  struct stat now;
  return stat(at->path, &now) == 0 && now.st_size == at->file.bytes &&
         (int64_t)now.st_mtim.tv_sec * 1000000000 + now.st_mtim.tv_nsec == at->file.modified_ns;
}

static void append_card_words(char *words, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static void append_card_words(char *words, const char *format, ...) {
  char more[WORDS];
  va_list values;
  size_t used = strlen(words);
  va_start(values, format);
  vsnprintf(more, sizeof more, format, values);
  va_end(values);
  fg_text_clip(words + used, WORDS - used, "%s%s", used ? "; " : "", more);
}

/* Adds to the card's words that the scan is lossy, or that foils may be missing. */
static void note_file(const fg_measurement *measurement, char *words) {
  if (measurement->file.jpeg_quality)
    append_card_words(words,
                      "compressed with loss (JPEG, quality %d): uncertainties are wider for it",
                      measurement->file.jpeg_quality);
  if (strstr(measurement->warning, FG_SCAN_MORE_IMAGES))
    append_card_words(words, "it holds more than one image: only the first was measured");
}

static fg_status keep_new(fg_context *ctx, intake *at, const fg_measurement *measurement) {
  fg_inspection *station = at->station;
  fg_report_outcome outcome;
  int64_t scan;
  char why[WORDS];
  bool withheld = fg_station_check_withholds(station, &at->by.lot->design, why, sizeof why);
  bool by_button = fg_station_is_scanned(at->name);
  FG_TRY(fg_order_apply(ctx, station, &at->order, by_button, &at->named));
  FG_TRY(fg_station_lot_note(ctx, &station->database, at->named.lot, at->words, WORDS));
  note_file(measurement, at->words);
  const fg_station_scan kept = {.file = at->file,
                                .source = by_button ? "scanner" : "folder",
                                .named = &at->named,
                                .order = at->order.id,
                                .settings = at->by.lot,
                                .setup = at->by.setup,
                                .measurement = measurement,
                                .seconds = fg_clock_seconds() - at->arrived,
                                .withheld = withheld ? why : NULL,
                                .note = at->words};
  FG_TRY(fg_station_keep_scan(ctx, &station->database, &kept, &scan, &outcome));
  fg_outcome_add(&station->outcome->judged, &outcome);
  station->outcome->measured++;
  /* The verdict first, the picture when it is drawn. */
  fg_station_end_stage(station, at->file.name);
  return fg_station_keep_pictures(ctx, &station->database, scan, measurement);
}

static fg_status keep_measurement(fg_context *ctx, intake *at, const fg_measurement *measurement) {
  int64_t known;
  FG_TRY(fg_station_find_scan(ctx, &at->station->database, measurement->sha256, &known));
  if (known) return keep_known(ctx, at, known);
  return keep_new(ctx, at, measurement);
}

fg_status fg_station_correct(fg_context *ctx, const fg_scanner_model *model, unsigned threads,
                             fg_measurement *measurement) {
  char warning[200];
  fg_status status = FG_OK;
  if (model) status = fg_scanner_model_apply(ctx, model, measurement, threads, warning);
  if (status == FG_OK) status = fg_measurement_calibrate(ctx, threads, measurement);
  if (status != FG_OK) fg_measurement_free(measurement);
  return status;
}

/* True where all rows can be read: then a failure is not due to a missing end. */
static bool is_readable(const char *path) {
  const double any_dpi = 1200;
  const fg_scan_options options = {
      .dpi = any_dpi, .channel = FG_CHANNEL_RED, .allow_lossy = true, .only_file = true};
  fg_scan *scan;
  fg_context ctx;
  void *row = NULL;
  if (fg_scan_open(&ctx, path, &options, &scan) != FG_OK) return false;
  const fg_scan_info *info = fg_scan_get_info(scan);
  int64_t stride = info->width_px * info->bytes_per_pixel, rows = info->height_px;
  fg_status status = fg_memory_allocate(&ctx, 1, (size_t)stride, &row);
  while (status == FG_OK && rows-- > 0)
    status = fg_scan_read_rows(&ctx, scan, 1, row, stride);
  free(row);
  fg_scan_close(scan);
  return status == FG_OK;
}

/* Memory that ran out is the station's trouble, not the scan's. */
static fg_status measure_file(fg_context *ctx, intake *at) {
  FG_TRY(fg_order_of_scan(ctx, at->station, &at->order));
  at->by = fg_part_recipe_of(at->station, &at->order);
  const fg_lot_settings *settings = at->by.lot;
  const fg_measure_options options = {.dpi = settings->dpi,
                                      .allow_lossy = settings->allow_lossy,
                                      .only_file = true,
                                      .without_plain = !fg_scanner_model_has_level(at->by.model)};
  fg_context inner = {.message = ""};
  fg_measurement measurement;
  fg_status failure = fg_measure_scan(&inner, at->path, &settings->design, &options, &measurement);
  if (failure == FG_OK) failure = fg_station_correct(&inner, at->by.model, 0, &measurement);
  if (failure == FG_ERR_MEMORY) return fg_fail(ctx, failure, "%s", inner.message);
  at->later = !is_unchanged(at) || (failure == FG_ERR_DATA && !at->sure &&
                                    at->writer != FG_WRITER_GONE && !is_readable(at->path));
  if (at->later) {
    if (failure == FG_OK) fg_measurement_free(&measurement);
    return FG_OK;
  }
  if (failure != FG_OK) {
    set_words(at, inner.message);
    return refuse_file(ctx, at, FG_CARD_UNREADABLE, failure == FG_ERR_IO);
  }
  fg_status status = keep_measurement(ctx, at, &measurement);
  fg_measurement_free(&measurement);
  return status;
}

/* True for a check, by its name and either pattern; fills the name's other fields. */
static bool is_check(const fg_inspection *station, intake *at) {
  const fg_station_settings *settings = station->settings;
  fg_named as_check;
  bool called = settings->check.design[0] &&
                (fg_station_is_scanned_check(at->name) ||
                 fg_naming_split(settings->check.file_name, at->name, &as_check));
  bool fits = fg_naming_split(settings->file_name, at->name, &at->named);
  return called || (fits && at->named.check[0]);
}

static void report_file(const intake *at) {
  const fg_station_request *request = at->station->request;
  if (request->looked_at) request->looked_at(request->user, at->file.name, at->words);
  fg_station_notify(at->station);
}

/* Somebody writes to it. */
static fg_status leave(intake *at) {
  at->later = true;
  if (!at->station->request->once) return FG_OK;
  fg_text_clip(at->words, WORDS, "is being written: it is left for the next time");
  at->station->outcome->refused++;
  at->station->outcome->judged.not_measured++;
  report_file(at);
  return FG_OK;
}

static fg_status handle_card(fg_context *ctx, intake *at, fg_card card) {
  fg_inspection *station = at->station;
  bool check = is_check(station, at);
  if (card != FG_CARD_MEASURED) return refuse_file(ctx, at, card, card == FG_CARD_UNREADABLE);
  fg_station_set_stage(station, FG_STAGE_MEASURING, at->file.name);
  if (check) return fg_station_measure_check(ctx, station, at->path, &at->file, at->words, WORDS);
  return measure_file(ctx, at);
}

/* True where more of the file may come, given the card by its ends. */
static bool is_awaited(const intake *at, fg_card card) {
  if (card == FG_CARD_MEASURED) return at->writer == FG_WRITER_WRITES && !at->sure;
  if (card == FG_CARD_UNFINISHED) return at->writer != FG_WRITER_GONE;
  return at->writer == FG_WRITER_WRITES;
}

/* A file that the station itself reads may lie beside the scans. */
static bool is_own_input(const fg_station_request *request, const struct stat *file) {
  struct stat own;
  for (size_t i = 0; i <= request->context_count; i++) {
    const char *path = i < request->context_count ? request->contexts[i] : request->orders;
    if (path && stat(path, &own) == 0 && own.st_dev == file->st_dev && own.st_ino == file->st_ino)
      return true;
  }
  return false;
}

static fg_status inspect_scan(fg_context *ctx, intake *at) {
  struct stat now;
  bool done;
  if (stat(at->path, &now) != 0 || !S_ISREG(now.st_mode)) return FG_OK; /* gone, or no file */
  if (is_own_input(at->station->request, &now)) return FG_OK;
  at->file.bytes = now.st_size;
  at->file.modified_ns = (int64_t)now.st_mtim.tv_sec * 1000000000 + now.st_mtim.tv_nsec;
  FG_TRY(fg_station_file_is_done(ctx, &at->station->database, &at->file, &done));
  if (done) return FG_OK;
  fg_card card = inspect_ends(at);
  at->scan = card == FG_CARD_MEASURED || card == FG_CARD_UNFINISHED;
  at->later = is_awaited(at, card);
  if (at->later) return FG_OK;
  FG_TRY(handle_card(ctx, at, card));
  if (at->later) return leave(at);
  if (!at->silent || at->station->request->once) report_file(at);
  return FG_OK;
}

/* Pages show a stage of the file until it has a card. */
static void set_stage(const intake *at) {
  if (at->later && at->scan)
    fg_station_set_stage(at->station, FG_STAGE_RECEIVING, at->file.name);
  else
    fg_station_end_stage(at->station, at->file.name);
}

fg_status fg_station_inspect_file(fg_context *ctx, fg_inspection *station, const char *name,
                                  fg_writer writer, bool *later) {
  intake at = {.station = station, .name = name, .writer = writer, .arrived = fg_clock_seconds()};
  *later = false;
  FG_TRY(fg_stored_name(ctx, name, &at.stored));
  at.file.name = at.stored;
  fg_status status = fg_text_print(ctx, &at.path, "%s/%s", station->request->folder, name);
  if (status == FG_OK) status = inspect_scan(ctx, &at);
  set_stage(&at);
  *later = at.later;
  free(at.path);
  free(at.stored);
  return status;
}
