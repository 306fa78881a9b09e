/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The page Scanner: result of the last check, due time of the next, results over time. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/memory.h"
#include "page/page.h"
#include "page/plot_frame.h"
#include "page/tile.h"
#include "station/check.h"
#include "station/check_page.h"
#include "station/trend.h"

/* Checks that are drawn: those of a month, at two a day. */
enum { DRAWN = 60, LISTED = 10, HISTORY_MAX = 400, WORDS = 1000 };

typedef struct check_row {
  int64_t at;
  double value[4], u[4]; /* scale x, scale y, shear; ppm and µrad; largest residual, µm */
  bool passed;
  char path[160], words[WORDS];
} check_row;

typedef struct history {
  check_row row[HISTORY_MAX]; /* the newest first */
  size_t count;
} history;

static const struct {
  const char *title, *short_title, *unit;
  bool judged;  /* against the allowed deviation */
  double scale; /* from the database to the unit */
  int decimals;
} axes[] = {
    {"Scale along x (across the carriage's way)", "scale x", "ppm", true, 1e6, 0},
    {"Scale along y (the carriage's way)", "scale y", "ppm", true, 1e6, 0},
    {"Shear: how far the axes are from 90°", "shear", "µrad", true, 1e6, 0},
    {"Largest residual of a grid's mark beside scale and shear", "residual", "µm", false, 1, 1},
};
enum { AXES = sizeof axes / sizeof *axes, LARGEST_COLUMN = 11 };

static fg_status read_history(fg_context *ctx, sqlite3 *reader, size_t max, history *all) {
  fg_query query;
  all->count = 0;
  fg_query_begin(
      reader,
      "SELECT at, scale_x, u_scale_x, scale_y, u_scale_y, shear, u_shear, verdict, path,"
      " words, changes, largest.value, largest.u FROM checks LEFT JOIN check_values AS largest"
      " ON largest.check_id = checks.id AND largest.name = 'largest_um'"
      " ORDER BY id DESC LIMIT ?",
      &query);
  fg_query_integer(&query, (int64_t)max);
  while (all->count < max && fg_query_row(&query)) {
    check_row *row = &all->row[all->count++];
    row->at = fg_query_get_integer(&query, 0);
    for (int k = 0; k < AXES; k++) {
      int column = axes[k].judged ? 1 + 2 * k : LARGEST_COLUMN;
      row->value[k] = axes[k].scale * fg_query_get_number(&query, column);
      row->u[k] = axes[k].scale * fg_query_get_number(&query, column + 1);
    }
    row->passed =
        !strcmp(fg_query_get_text(&query, 7), "pass") && !fg_query_get_text(&query, 10)[0];
    snprintf(row->path, sizeof row->path, "%s", fg_query_get_text(&query, 8));
    snprintf(row->words, sizeof row->words, "%s", fg_query_get_text(&query, 9));
  }
  return fg_query_end(ctx, &query, "reading the checks");
}

static const char *call_words(const fg_station_health *health) {
  return health->changed                   ? "CHANGED"
         : health->failed                  ? "OUT OF ORDER"
         : health->due && !health->last_at ? "NOT CHECKED"
         : health->due                     ? "CHECK DUE"
                                           : "IN ORDER";
}

static void write_check_call(FILE *out, const fg_station_health *health) {
  fprintf(out, "<div class=\"call %s\" role=\"status\"><b>%s</b><span>",
          health->failed || health->changed ? "fail"
          : health->due                     ? "again"
                                            : "pass",
          call_words(health));
  if (health->last_at) {
    fputs("last check ", out);
    fg_page_time(out, health->last_at);
  }
  if (health->due_at && !health->clock_back) {
    fprintf(out, "<br>%s ", health->due ? "was due" : "next due");
    fg_page_time(out, health->due_at);
  }
  fputs("</span></div>\n", out);
}

static void write_next(FILE *out, const fg_station_check *check, const fg_station_health *health) {
  bool in_order = !health->clock_back && !health->changed && !health->failed && !health->due;
  fprintf(out, "<p class=\"next%s\">", in_order ? " calm" : "");
  if (health->clock_back)
    fputs("The clock of this machine stands before the last check: it was set back, so nobody can "
          "say how old that check is. Set the clock, and check the scanner. ",
          out);
  if (health->changed)
    fputs("The plate shows another tone, sharpening or blur than the baseline, or a grid another "
          "scale: set the driver as it was (man foilgauge-scanning), clean the glass and the "
          "plate, and check again. A change "
          "that is meant can be taken as the new baseline below, where scale and shear are as "
          "allowed. ",
          out);
  else if (health->failed)
    fputs("Clean the glass and the plate, let the scanner warm up, and check it again. If it fails "
          "again, have it seen to, or measure a model of it anew. ",
          out);
  else if (health->due)
    fputs("Put the plate on the glass and scan it into the folder, under a name as ", out);
  else
    fputs("Go on with foils. The next check: put the plate on the glass and scan it into the "
          "folder, under a name as ",
          out);
  if (!health->failed && !health->changed) {
    fputs("<b>", out);
    fg_html_name(out, check->file_name);
    fputs("</b>. ", out);
  }
  if (check->withhold)
    fputs(health->due || health->failed || health->changed
              ? "Until a check has passed foils are measured, but get no verdict: scan them again "
                "then."
              : "Past due, or when a check fails, foils get no verdict.",
          out);
  fputs("</p>\n", out);
}

static const char *sign_of(double value) {
  return value < 0 ? "−" : value > 0 ? "+" : "";
}

/* Rounded, and 0 without the sign that it comes from. */
static double rounded(double value, int decimals) {
  double unit = decimals ? 10 : 1;
  return round(unit * value) / unit + 0.0;
}

/* Writes the newest values of each axis, against the first that is drawn. */
static void write_tiles(FILE *out, const history *all, double allowed) {
  const check_row *last = &all->row[0], *first = &all->row[all->count - 1];
  fputs("<dl class=\"tiles\">", out);
  for (int k = 0; k < AXES; k++) {
    char text[120], since[80] = "";
    if (!isfinite(last->value[k])) continue;
    double value = rounded(last->value[k], axes[k].decimals);
    int used = snprintf(text, sizeof text, "%s%.*f ± %.*f %s", sign_of(value), axes[k].decimals,
                        fabs(value), axes[k].decimals, 2 * last->u[k], axes[k].unit);
    if (axes[k].judged)
      snprintf(text + used, sizeof text - (size_t)used, "<small>allowed ± %.0f %s</small>", allowed,
               axes[k].unit);
    double change = rounded(last->value[k] - first->value[k], 0);
    if (all->count > 1 && axes[k].judged)
      snprintf(since, sizeof since, "%s%.0f ± %.0f since the first that is drawn", sign_of(change),
               fabs(change), 2 * hypot(last->u[k], first->u[k]));
    fg_html_tile(out, &(fg_tile){axes[k].short_title, .text = text, .small = since});
  }
  fputs("</dl>\n", out);
}

/* Returns row i counted from the oldest. */
static const check_row *in_order(const history *all, size_t i) {
  return &all->row[all->count - 1 - i];
}

static double find_span(const history *all, int axis, double allowed) {
  double range[2] = {axes[axis].judged ? -allowed : 0, axes[axis].judged ? allowed : 0};
  for (size_t i = 0; i < all->count; i++)
    if (isfinite(all->row[i].value[axis]))
      fg_range_add(range, fabs(all->row[i].value[axis]), 2 * all->row[i].u[axis]);
  return 1.12 * range[1];
}

static void draw_day(const fg_plot *at, const history *all, size_t i, const char *anchor) {
  char text[32];
  time_t seconds = (time_t)(in_order(all, i)->at / 1000);
  struct tm local;
  if (!localtime_r(&seconds, &local) || !strftime(text, sizeof text, "%Y-%m-%d", &local)) return;
  fprintf(at->out, "<text class=\"%s\" x=\"%.1f\" y=\"%.1f\">%s</text>\n", anchor,
          fg_plot_x(at, (double)i + 1), at->bottom + 20, text);
}

static void draw_check(const fg_plot *at, const check_row *row, double x, int axis) {
  double value = row->value[axis], reach = 2 * row->u[axis];
  if (!isfinite(value)) return;
  fg_plot_segment(at, x, value - reach, x, value + reach, "whisker");
  fprintf(at->out, "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"%d\"><title>",
          row->passed ? "s2" : "signal", fg_plot_x(at, x), fg_plot_y(at, value),
          row->passed ? 4 : 6);
  fg_html_text(at->out, row->path);
  fputs(", ", at->out);
  fg_page_time(at->out, row->at);
  fprintf(at->out, ": %+.*f ± %.*f %s</title></circle>\n", axes[axis].decimals, value,
          axes[axis].decimals, reach, axes[axis].unit);
}

static void draw_history(FILE *out, const history *all, int axis, double allowed) {
  double span = find_span(all, axis, allowed), low = axes[axis].judged ? -span : 0;
  if (!(span > 0)) return; /* no grid was scanned */
  if (!axes[axis].judged) allowed = 0;
  fprintf(out, "<figure><h2>%s, %s</h2>\n", axes[axis].title, axes[axis].unit);
  fg_plot at = fg_plot_frame_begin(
      out, &(fg_plot_frame){axes[axis].title, .width = 560, .height = 220, .left = 66, .top = 10,
                            .bottom = 30, .x = (double[]){0.5, (double)all->count + 0.5},
                            .y = (double[]){low, span}, .y_title = "", .ticks = FG_TICKS_OWN,
                            .band = (double[]){-allowed, allowed}, .band_style = "allowed"});
  for (int side = -1; side <= 1 && axes[axis].judged; side += 2)
    fg_plot_level(&at, side * allowed, "tolerance");
  for (size_t i = 0; i < all->count; i++)
    draw_check(&at, in_order(all, i), (double)i + 1, axis);
  draw_day(&at, all, 0, "start");
  if (all->count > 1) draw_day(&at, all, all->count - 1, "end");
  fg_plot_end(&at);
  fputs("</figure>\n", out);
}

static void write_list(FILE *out, const history *all) {
  fputs("<h2>The newest</h2>\n<ul class=\"cards checks\">", out);
  for (size_t i = 0; i < all->count && i < LISTED; i++) {
    const check_row *row = &all->row[i];
    fprintf(out, "<li><span class=\"tag %s\">%s</span><span>", row->passed ? "pass" : "fail",
            row->passed ? "PASSED" : "FAILED");
    fg_html_name(out, row->path);
    fputs("</span><span class=\"note\">", out);
    fg_page_time(out, row->at);
    fputs("</span><span class=\"note\">", out);
    fg_html_text(out, row->words);
    fputs("</span></li>\n", out);
  }
  fputs("</ul>\n", out);
}

static void write_history(FILE *out, const history *all, double allowed) {
  fputs("<div class=\"panels\">", out);
  for (int k = 0; k < AXES; k++)
    draw_history(out, all, k, allowed);
  fprintf(
      out,
      "</div>\n<p class=\"note noprint\">Measured over true, less 1, with ± 2 u; green: what is "
      "allowed. The newest %zu check%s, in the order in which they were made. "
      "<a href=\"/scanner?newest=all\">all</a></p>\n",
      all->count, fg_plural(all->count));
  write_list(out, all);
}

static void write_button(const fg_inspection *station, FILE *out) {
  bool scanning = atomic_load(&station->scanning);
  if (!station->settings->scan_command[0] || !station->check_design_known) return;
  fputs("<form class=\"fields\" method=\"post\" action=\"/scan\">", out);
  fg_page_csrf_token(station, out);
  fprintf(out,
          "<input type=\"hidden\" name=\"check\" value=\"1\"><button class=\"big\"%s>%s"
          "</button></form>\n",
          scanning ? " disabled" : "", scanning ? "Scanning …" : "Scan the plate");
}

static fg_status write_all(fg_context *ctx, const fg_inspection *station, sqlite3 *reader,
                           const history *all, FILE *out) {
  double allowed = station->settings->check.scale_max_ppm;
  if (!all->count) {
    fputs("<p class=\"note\">There was no check so far.</p>\n", out);
    return FG_OK;
  }
  write_tiles(out, all, allowed);
  FG_TRY(fg_page_scanner_state(ctx, station, reader, out));
  write_history(out, all, allowed);
  return FG_OK;
}

static fg_status write_checks(fg_context *ctx, const fg_inspection *station, sqlite3 *reader,
                              size_t max, FILE *out) {
  const fg_station_check *check = &station->settings->check;
  void *block;
  fg_station_health health;
  FG_TRY(fg_station_check_health(ctx, reader, check, &health));
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof(history), &block));
  history *all = block;
  fg_status status = read_history(ctx, reader, max, all);
  if (status == FG_OK) {
    write_check_call(out, &health);
    write_next(out, check, &health);
    status = write_all(ctx, station, reader, all, out);
  }
  free(all);
  return status;
}

fg_status fg_page_scanner(fg_context *ctx, fg_inspection *station, sqlite3 *reader,
                          const fg_request *request, FILE *out) {
  const fg_station_check *check = &station->settings->check;
  bool all = !strcmp(fg_request_get(request, "newest"), "all");
  FG_TRY(fg_page_begin(ctx, station, reader, out, FG_TAB_SCANNER, "Scanner"));
  fputs("<section data-live>\n<h1>Scanner</h1>\n", out);
  write_button(station, out);
  if (!check->design[0])
    fputs("<p class=\"next\">The recipe asks for no checks. With a grid of known pitch, a "
          "plate or a ring of known diameters the station shows how far the scanner's scale and "
          "its axes are off, reminds "
          "of it, and withholds verdicts where it must: <code>station.check</code> in the recipe "
          "(man foilgauge-recipe).</p>\n",
          out);
  else
    FG_TRY(write_checks(ctx, station, reader, all ? HISTORY_MAX : DRAWN, out));
  fputs("</section>\n", out);
  fg_page_end(out);
  return FG_OK;
}
