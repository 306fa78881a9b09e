/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/text.h"
#include "foilgauge/measure.h"
#include "foilgauge/scan_loop.h"
#include "foilgauge/traceability.h"
#include "station/check_fit.h"
#include "station/check_state.h"
#include "station/keep.h"
#include "station/news.h"
#include "station/pages.h"

#define MS_PER_HOUR INT64_C(3600000)

enum { CHANGES_BYTES = 600, JUDGED_BYTES = 400 };

/* A check of the plate, before it is kept. */
typedef struct check_result {
  const fg_station_file *file;
  const char *sha256, *words;
  fg_check_fit fit;
  fg_check_state state;
  bool baseline; /* there is none for its resolution: it becomes one */
  char changes[CHANGES_BYTES];
} check_result;

static fg_status insert_check(fg_context *ctx, sqlite3 *writer, const check_result *check) {
  const fg_check_fit *fit = &check->fit;
  fg_query query;
  fg_query_begin(
      writer,
      "INSERT OR IGNORE INTO checks (at, path, sha256, discs, scale_x, u_scale_x, scale_y,"
      " u_scale_y, shear, u_shear, verdict, words, baseline, changes)"
      " VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
      &query);
  fg_query_integer(&query, fg_station_now());
  fg_query_text(&query, check->file->name);
  fg_query_text(&query, check->sha256);
  fg_query_integer(&query, (int64_t)fit->discs);
  fg_query_number(&query, fit->scale[0]);
  fg_query_number(&query, fit->u_scale[0]);
  fg_query_number(&query, fit->scale[1]);
  fg_query_number(&query, fit->u_scale[1]);
  fg_query_number(&query, fit->shear);
  fg_query_number(&query, fit->u_shear);
  fg_query_text(&query, fit->passes ? "pass" : "fail");
  fg_query_text(&query, check->words);
  fg_query_integer(&query, check->baseline);
  fg_query_text(&query, check->changes);
  fg_query_row(&query);
  return fg_query_end(ctx, &query, "keeping a check");
}

/* Keeps the state of a check; the same bytes again are no second check. */
static fg_status insert_state(fg_context *ctx, sqlite3 *writer, const check_result *check) {
  if (!fg_sqlite.changes(writer)) return FG_OK;
  return fg_check_state_keep(ctx, writer, fg_sqlite.last_insert_rowid(writer), &check->state);
}

static fg_status keep_check(fg_context *ctx, fg_inspection *station, const check_result *check) {
  fg_station_database *database = &station->database;
  FG_TRY(fg_station_database_begin(ctx, database));
  fg_status status = insert_check(ctx, database->writer, check);
  if (status == FG_OK) status = insert_state(ctx, database->writer, check);
  if (status == FG_OK)
    status = fg_station_insert_card(ctx, database, check->file, FG_CARD_CHECK, check->words, 0);
  return fg_station_database_end(ctx, database, status);
}

static fg_status keep_refused_check(fg_context *ctx, fg_inspection *station,
                                    const fg_station_file *file, const char *words) {
  station->outcome->refused++;
  station->outcome->judged.not_measured++;
  return fg_station_keep_card(ctx, &station->database, file, FG_CARD_UNREADABLE, words, 0);
}

static void put_state_words(const check_result *check, int64_t baseline_at, char *words,
                            size_t size) {
  size_t used = strlen(words);
  time_t seconds = (time_t)(baseline_at / 1000);
  struct tm local;
  char day[16] = "?";
  if (localtime_r(&seconds, &local)) strftime(day, sizeof day, "%Y-%m-%d", &local);
  if (check->changes[0]) {
    char judged[JUDGED_BYTES];
    fg_text_clip(judged, sizeof judged, "%s", words);
    fg_text_clip(words, size, "CHANGED since the baseline of %s: %s; %s", day, check->changes,
                 judged);
  } else if (check->baseline)
    fg_text_clip(words + used, size - used, "; the baseline of %s",
                 check->fit.is_grid ? "scale, shear and blur" : "tone, sharpening and blur");
  else if (baseline_at)
    fg_text_clip(words + used, size - used, "; %s as in the baseline of %s",
                 check->fit.is_grid ? "scale, shear and blur" : "tone, sharpening and blur", day);
}

/* A grid is held against its pitch through the recipe's model, as foils are measured. */
static fg_status fit_check(fg_context *ctx, const fg_inspection *station, fg_measurement *m,
                           fg_check_fit *fit) {
  char warning[200];
  if (!m->grid) return fg_check_fit_plate(ctx, &station->check_design, m, fit);
  if (station->model) FG_TRY(fg_scanner_model_apply(ctx, station->model, m, 0, warning));
  return fg_check_fit_grid(ctx, &station->check_design, m, fit);
}

/* Judges scale and shear against the allowed deviation, the picture's state against its
 * baseline. */
static fg_status judge_check(fg_context *ctx, fg_inspection *station,
                             const fg_measurement *measurement, check_result *check, char *words,
                             size_t size) {
  fg_check_state baseline;
  int64_t at;
  check->sha256 = measurement->sha256;
  fg_check_fit_judge(&check->fit, station->settings->check.scale_max_ppm, words, size);
  fg_check_state_find(measurement, &check->fit, &check->state);
  pthread_mutex_lock(&station->database.writing);
  fg_status status =
      fg_check_state_baseline(ctx, station->database.writer, check->state.dpi, &at, &baseline);
  pthread_mutex_unlock(&station->database.writing);
  FG_TRY(status);
  check->baseline = !at && check->fit.passes;
  if (at) fg_check_state_compare(&check->state, &baseline, check->changes, sizeof check->changes);
  put_state_words(check, at, words, size);
  return FG_OK;
}

fg_status fg_station_measure_check(fg_context *ctx, fg_inspection *station, const char *path,
                                   const fg_station_file *file, char *words, size_t size) {
  if (!station->check_design_known) {
    fg_text_clip(words, size,
                 "is called as a check of the scanner, but the recipe has no station.check.design");
    return keep_refused_check(ctx, station, file, words);
  }
  const fg_measure_options options = {.dpi = station->settings->lot.dpi,
                                      .allow_lossy = station->settings->lot.allow_lossy,
                                      .only_file = true};
  fg_context inner = {.message = ""};
  fg_measurement measurement;
  check_result check = {.file = file, .words = words};
  fg_status status,
      failure = fg_measure_scan(&inner, path, &station->check_design, &options, &measurement);
  if (failure == FG_ERR_MEMORY) return fg_fail(ctx, failure, "%s", inner.message);
  if (failure == FG_OK) {
    failure = fit_check(&inner, station, &measurement, &check.fit);
    if (failure != FG_OK) fg_measurement_free(&measurement);
  }
  if (failure != FG_OK) {
    fg_text_clip(words, size, "the scanner was not checked: %s", inner.message);
    return keep_refused_check(ctx, station, file, words);
  }
  status = judge_check(ctx, station, &measurement, &check, words, size);
  if (status == FG_OK) status = keep_check(ctx, station, &check);
  fg_measurement_free(&measurement);
  station->outcome->measured += status == FG_OK;
  return status;
}

fg_status fg_action_baseline(fg_context *ctx, fg_inspection *station, const fg_request *request,
                             fg_answer *answer) {
  fg_query query;
  FG_TRY(fg_station_database_begin(ctx, &station->database));
  sqlite3 *writer = station->database.writer;
  fg_query_begin(writer,
                 "UPDATE checks SET baseline = 1, changes = '' WHERE id = ?"
                 " AND verdict = 'pass' AND id = (SELECT max(id) FROM checks)",
                 &query);
  fg_query_integer(&query, strtoll(fg_request_get(request, "id"), NULL, 10));
  fg_query_row(&query);
  fg_status status = fg_query_end(ctx, &query, "accepting a baseline");
  if (status == FG_OK && !fg_sqlite.changes(writer))
    status = fg_fail(ctx, FG_ERR_USAGE,
                     "Only the newest check can become the baseline, and only when scale and shear "
                     "are as allowed: load the page again.");
  status = fg_station_database_end(ctx, &station->database, status);
  if (status != FG_OK) return status;
  fg_station_notify(station);
  strcpy(answer->location, "/scanner");
  return FG_OK;
}

fg_status fg_station_check_health(fg_context *ctx, sqlite3 *connection,
                                  const fg_station_check *check, fg_station_health *health) {
  fg_query query;
  *health = (fg_station_health){.asked = check->design[0] != '\0'};
  if (!health->asked) return FG_OK;
  fg_query_begin(connection, "SELECT at, verdict, changes FROM checks ORDER BY id DESC LIMIT 1",
                 &query);
  if (fg_query_row(&query)) {
    health->last_at = fg_query_get_integer(&query, 0);
    health->failed = strcmp(fg_query_get_text(&query, 1), "pass") != 0;
    health->changed = fg_query_get_text(&query, 2)[0] != '\0';
  }
  FG_TRY(fg_query_end(ctx, &query, "reading the checks"));
  if (check->every_h > 0 && health->last_at)
    health->due_at = health->last_at + (int64_t)(check->every_h * (double)MS_PER_HOUR);
  int64_t now = fg_station_now();
  health->clock_back = health->last_at && now < health->last_at - MS_PER_HOUR;
  health->due =
      !health->last_at || (health->due_at && (now > health->due_at || health->clock_back));
  return FG_OK;
}

/* Returns true when limits cannot be judged, as the recipe says nothing of the scanner's scale. */
static bool is_scale_unknown(const fg_design *design, char *why, size_t size) {
  if (!design->tolerance_count || fg_design_may_judge(design)) return false;
  fg_text_clip(
      why, size,
      "Nothing is known of the scanner's scale: give the recipe a model of a plate "
      "(\"model\"), a \"calibration\", or \"calibration\": \"flatbed\", the default for an "
      "unknown flatbed.");
  return true;
}

bool fg_station_check_withholds(fg_inspection *station, const fg_design *design, char *why,
                                size_t size) {
  fg_context inner;
  fg_station_health health;
  const fg_station_check *check = &station->settings->check;
  if (is_scale_unknown(design, why, size)) return true;
  if (!check->withhold) return false;
  pthread_mutex_lock(&station->database.writing);
  fg_status status = fg_station_check_health(&inner, station->database.writer, check, &health);
  pthread_mutex_unlock(&station->database.writing);
  if (status == FG_OK && !health.due && !health.failed && !health.changed) return false;
  fg_text_clip(
      why, size, "%s",
      status != FG_OK  ? inner.message
      : health.changed ? "The scanner's check shows another tone, sharpening or blur than its "
                         "baseline, or a grid another scale: set the driver as it was, scan the "
                         "plate, and then this foil again."
      : health.failed  ? "The last check of the scanner failed: check it again, or have it "
                         "seen to, and then scan this foil again."
      : health.clock_back
          ? "The clock was set back, so the scanner's check may be too old: set the clock, "
            "scan the plate, and then this foil again."
          : "The scanner's check is due: scan the plate, and then this foil again.");
  return true;
}
