#include "station/check.h"

#include <math.h>
#include <string.h>

#include "core/text.h"
#include "foilgauge/measure.h"
#include "station/check_fit.h"
#include "station/keep_parts.h"

#define MS_PER_HOUR INT64_C(3600000)

static fg_status insert_check(fg_context *ctx, sqlite3 *writer, const fg_station_file *file,
                              const char *sha256, const fg_check_fit *fit, const char *words) {
  fg_query query;
  fg_query_begin(
      writer,
      "INSERT OR IGNORE INTO checks (at, path, sha256, discs, scale_x, u_scale_x, scale_y,"
      " u_scale_y, shear, u_shear, verdict, words)"
      " VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
      &query);
  fg_query_integer(&query, fg_station_now());
  fg_query_text(&query, file->name);
  fg_query_text(&query, sha256);
  fg_query_integer(&query, (int64_t)fit->discs);
  fg_query_number(&query, fit->scale[0]);
  fg_query_number(&query, fit->u_scale[0]);
  fg_query_number(&query, fit->scale[1]);
  fg_query_number(&query, fit->u_scale[1]);
  fg_query_number(&query, fit->shear);
  fg_query_number(&query, fit->u_shear);
  fg_query_text(&query, fit->passes ? "pass" : "fail");
  fg_query_text(&query, words);
  fg_query_row(&query);
  return fg_query_end(ctx, &query, "keeping a check");
}

static fg_status keep_check(fg_context *ctx, fg_inspection *station, const fg_station_file *file,
                            const char *sha256, const fg_check_fit *fit, const char *words) {
  FG_TRY(fg_station_database_begin(ctx, &station->database));
  fg_status status = insert_check(ctx, station->database.writer, file, sha256, fit, words);
  if (status == FG_OK)
    status = fg_station_insert_card(ctx, &station->database, file, FG_CARD_CHECK, words, 0);
  return fg_station_database_end(ctx, &station->database, status);
}

static fg_status refuse(fg_context *ctx, fg_inspection *station, const fg_station_file *file,
                        const char *words) {
  station->outcome->refused++;
  station->outcome->judged.not_measured++;
  return fg_station_keep_card(ctx, &station->database, file, FG_CARD_UNREADABLE, words, 0);
}

fg_status fg_station_take_check(fg_context *ctx, fg_inspection *station, const char *path,
                                const fg_station_file *file, char *words, size_t size) {
  if (!station->check_design_known) {
    fg_text_clip(words, size,
                 "is called as a check of the scanner, but the recipe has no station.check.design");
    return refuse(ctx, station, file, words);
  }
  const fg_measure_options options = {.dpi = station->settings->lot.dpi,
                                      .allow_lossy = station->settings->lot.allow_lossy,
                                      .only_file = true};
  fg_context inner = {.message = ""};
  fg_measurement measurement;
  fg_check_fit fit;
  fg_status failure = fg_measure_scan(&inner, path, &station->check_design, &options, &measurement);
  if (failure == FG_ERR_MEMORY) return fg_fail(ctx, failure, "%s", inner.message);
  if (failure == FG_OK) {
    failure = fg_check_fit_plate(&inner, &station->check_design, &measurement, &fit);
    if (failure != FG_OK) fg_measurement_free(&measurement);
  }
  if (failure != FG_OK) {
    fg_text_clip(words, size, "the scanner was not checked: %s", inner.message);
    return refuse(ctx, station, file, words);
  }
  fg_check_fit_judge(&fit, station->settings->check.scale_max_ppm, words, size);
  fg_status status = keep_check(ctx, station, file, measurement.sha256, &fit, words);
  fg_measurement_free(&measurement);
  station->outcome->measured += status == FG_OK;
  return status;
}

fg_status fg_station_check_health(fg_context *ctx, sqlite3 *connection,
                                  const fg_station_check *check, fg_station_health *health) {
  fg_query query;
  *health = (fg_station_health){.asked = check->design[0] != '\0'};
  if (!health->asked) return FG_OK;
  fg_query_begin(connection, "SELECT at, verdict FROM checks ORDER BY id DESC LIMIT 1", &query);
  if (fg_query_row(&query)) {
    health->last_at = fg_query_get_integer(&query, 0);
    health->failed = strcmp(fg_query_get_text(&query, 1), "pass") != 0;
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

bool fg_station_check_withholds(fg_inspection *station, char *why, size_t size) {
  fg_context inner;
  fg_station_health health;
  const fg_station_check *check = &station->settings->check;
  if (!check->withhold) return false;
  pthread_mutex_lock(&station->database.writing);
  fg_status status = fg_station_check_health(&inner, station->database.writer, check, &health);
  pthread_mutex_unlock(&station->database.writing);
  if (status == FG_OK && !health.due && !health.failed) return false;
  fg_text_clip(
      why, size, "%s",
      status != FG_OK ? inner.message
      : health.failed ? "The last check of the scanner failed: check it again, or have it "
                        "seen to, and then scan this foil again."
      : health.clock_back
          ? "The clock was set back, so the scanner's check may be too old: set the clock, "
            "scan the plate, and then this foil again."
          : "The scanner's check is due: scan the plate, and then this foil again.");
  return true;
}
