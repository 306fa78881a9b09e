/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A foil's whole report: measured again from its scan with the design and the model of its first
 * measurement; or its record, where the scan is gone or has changed. */
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/sha256.h"
#include "core/text.h"
#include "foilgauge/measure.h"
#include "foilgauge/scan_loop.h"
#include "page/page.h"
#include "report/foil_html.h"
#include "station/pages.h"
#include "station/stored_foil.h"
#include "station/stored_name.h"

/* One report at a time: each takes all cores for a second, and new scans come first. */
static pthread_mutex_t measuring = PTHREAD_MUTEX_INITIALIZER;

enum { WHY_BYTES = 400 };

static fg_status apply_model(fg_context *ctx, const fg_stored_foil *stored,
                             fg_scanner_model **model, fg_measurement *measurement) {
  char warning[200];
  if (!stored->model) return FG_OK;
  FG_TRY(fg_scanner_model_parse(ctx, "the scanner's model of then", stored->model, model));
  return fg_scanner_model_apply(ctx, *model, measurement, 0, warning);
}

/* The one foil of the scan; false when the program finds another number of them than then. */
static bool leave_one(fg_measurement *shown, const fg_measurement *measurement, int number) {
  *shown = *measurement;
  for (size_t i = 0; i < measurement->foil_count; i++) {
    if (measurement->foils[i].number != number) continue;
    shown->foils = &measurement->foils[i];
    shown->foil_count = 1;
    return true;
  }
  return false;
}

/* Writes a page of a foil that was measured again. */
typedef fg_status measured_writer(fg_context *ctx, const fg_stored_foil *stored,
                                  const fg_measurement *measurement, FILE *out);

static fg_status write_picture_page(fg_context *ctx, const fg_stored_foil *stored,
                                    const fg_measurement *measurement, FILE *out) {
  fg_measurement shown;
  if (!leave_one(&shown, measurement, stored->number))
    return fg_fail(ctx, FG_ERR_DATA, "the foil was not found in it again");
  fg_html_begin(out, stored->serial);
  fputs("<section>\n<header><h1>Foil ", out);
  fg_html_name(out, stored->serial);
  fputs("</h1></header>\n<figure class=\"scroll\">", out);
  fg_status status = fg_html_picture(ctx, out, &shown, &shown.foils[0], 0);
  fputs("</figure>\n</section>\n", out);
  fg_html_end(out);
  return status;
}

static fg_status write_measured(fg_context *ctx, const fg_stored_foil *stored,
                                const fg_measurement *measurement, FILE *out) {
  fg_measurement shown;
  if (!leave_one(&shown, measurement, stored->number))
    return fg_fail(ctx, FG_ERR_DATA, "the foil was not found in it again");
  const fg_report_scan scan = {.path = shown.scan, .measurement = &shown, .name = stored->serial};
  fg_design design = stored->settings.design;
  design.model_scale = measurement->design.model_scale;
  const fg_report report = {
      .design = &design, .nominal = &shown.nominal, .scans = &scan, .scan_count = 1};
  return fg_report_write_html(ctx, &report, out);
}

/* FG_ERR_DATA, FG_ERR_IO: the scan is no longer the one that was measured; the message has the
 * reason. */
static fg_status measure_again(fg_context *ctx, const char *folder, const fg_stored_foil *stored,
                               measured_writer *write, FILE *out) {
  char *path = NULL, sum[65];
  fg_scanner_model *model = NULL;
  fg_measurement measurement;
  const fg_measure_options options = {.dpi = stored->settings.dpi,
                                      .allow_lossy = stored->settings.allow_lossy,
                                      .only_file = true,
                                      .without_plain = !stored->model};
  FG_TRY(fg_stored_name_path(ctx, folder, stored->path, &path));
  fg_status status = fg_sha256_file(ctx, path, sum);
  if (status == FG_OK && strcmp(sum, stored->sha256) != 0)
    status = fg_fail(ctx, FG_ERR_DATA, "%s is another file now", stored->path);
  if (status == FG_OK)
    status = fg_measure_scan(ctx, path, &stored->settings.design, &options, &measurement);
  free(path);
  if (status != FG_OK) return status;
  status = apply_model(ctx, stored, &model, &measurement);
  if (status == FG_OK) status = fg_measurement_calibrate(ctx, 0, &measurement);
  if (status == FG_OK) status = write(ctx, stored, &measurement, out);
  fg_measurement_free(&measurement);
  if (model) fg_scanner_model_free(model);
  return status;
}

static fg_status write_facts(fg_context *ctx, const fg_stored_foil *stored, FILE *out) {
  fputs("<h2>Where it comes from</h2>\n<dl class=\"facts\">\n<dt>Scan file</dt><dd>", out);
  fg_html_name(out, stored->path);
  fputs("</dd>\n<dt>Measured</dt><dd>", out);
  fg_page_time(out, stored->at);
  fputs("</dd>\n<dt>SHA-256</dt><dd>", out);
  fg_html_name(out, stored->sha256);
  fputs("</dd>\n", out);
  FG_TRY(fg_stored_foil_write_provenance(ctx, stored, out));
  fputs("</dl>\n", out);
  return FG_OK;
}

static fg_status write_record(fg_context *ctx, const fg_stored_foil *stored, const char *why,
                              FILE *out) {
  fg_html_begin(out, stored->serial);
  fputs("<section>\n<header><h1>Foil ", out);
  fg_html_name(out, stored->serial);
  fputs("</h1>", out);
  if (stored->foil) FG_TRY(fg_stored_foil_write_verdict(ctx, stored, out));
  fputs("</header>\n<p class=\"corrected\"><b>From the record.</b> It cannot be measured again: ",
        out);
  fg_html_text(out, why);
  fputs(". The values are those that were kept when it was measured; the picture and the residuals "
        "are not kept.</p>\n",
        out);
  fg_stored_foil_write_tables(stored, out);
  FG_TRY(write_facts(ctx, stored, out));
  fputs("</section>\n", out);
  fg_html_end(out);
  return FG_OK;
}

/* Writes into memory first: a report that fails half-way is not shown. */
static fg_status try_again(fg_context *ctx, const char *folder, const fg_stored_foil *stored,
                           measured_writer *write, FILE *out, char why[WHY_BYTES]) {
  char *page = NULL;
  size_t size = 0;
  FILE *into = fg_stream_open(&page, &size);
  if (!into) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a report");
  fg_status status = measure_again(ctx, folder, stored, write, into);
  if (!fg_stream_keep(into, &page) && status == FG_OK)
    status = fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a report");
  if (status == FG_OK)
    fwrite(page, 1, size, out);
  else
    fg_text_clip(why, WHY_BYTES, "%s", ctx->message);
  free(page);
  return status;
}

static fg_status write_again(fg_context *ctx, const char *folder, const fg_stored_foil *stored,
                             measured_writer *write, FILE *out) {
  char why[WHY_BYTES];
  if (pthread_mutex_trylock(&measuring) != 0)
    return fg_fail(ctx, FG_ERR_INTERRUPTED,
                   "Another report is being measured: load this page again in a moment.");
  fg_status status = stored->readable ? try_again(ctx, folder, stored, write, out, why)
                                      : fg_fail(ctx, FG_ERR_DATA, "%s", stored->problem);
  pthread_mutex_unlock(&measuring);
  if (status == FG_OK || status == FG_ERR_MEMORY) return status;
  if (!stored->readable) fg_text_clip(why, WHY_BYTES, "%s", stored->problem);
  return write_record(ctx, stored, why, out);
}

static fg_status write_foil_again(fg_context *ctx, fg_inspection *station,
                                  const fg_request *request, measured_writer *write, FILE *out) {
  fg_stored_foil *stored;
  pthread_mutex_lock(&station->database.reading);
  fg_status status =
      fg_stored_foil_load(ctx, station->database.reader, fg_request_get(request, "foil"), &stored);
  pthread_mutex_unlock(&station->database.reading);
  if (status != FG_OK) return status;
  status = write_again(ctx, station->request->folder, stored, write, out);
  fg_stored_foil_free(stored);
  return status;
}

/* The reader may be another one by the time that it is ours. */
fg_status fg_page_report(fg_context *ctx, fg_inspection *station, sqlite3 *reader,
                         const fg_request *request, FILE *out) {
  (void)reader;
  return write_foil_again(ctx, station, request, write_measured, out);
}

fg_status fg_page_picture(fg_context *ctx, fg_inspection *station, sqlite3 *reader,
                          const fg_request *request, FILE *out) {
  (void)reader;
  return write_foil_again(ctx, station, request, write_picture_page, out);
}
