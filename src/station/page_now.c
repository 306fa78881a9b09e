/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The page Now: the newest card, in letters that can be read from two metres, the next step,
 * earlier cards. */
#include <math.h>
#include <string.h>

#include "foilgauge/traceability.h"
#include "page/page.h"
#include "quantity/quantity_rows.h"
#include "station/disposition.h"
#include "station/news.h"
#include "station/orders.h"
#include "station/outbox/outbox.h"
#include "station/pages.h"
#include "station/part_recipes.h"
#include "station/scan_command.h"
#include "station/values.h"

/* LARGE_LETTERS: room beside the name of a file in the largest letters. */
enum { CARDS = 12, WORDS = 700, LARGE_LETTERS = 10 };

/* The newest arrival. */
typedef struct card {
  int64_t id, at, scan, foils, setup;
  char path[512], kind[24], message[WORDS], verdict[24], withheld[WORDS];
} card;

static void copy(const fg_query *query, int column, char *text, size_t size) {
  snprintf(text, size, "%s", fg_query_get_text(query, column));
}

static fg_status read_newest(fg_context *ctx, sqlite3 *reader, card *newest) {
  fg_query query;
  *newest = (card){0};
  fg_query_begin(
      reader,
      "SELECT arrivals.id, arrivals.at, arrivals.path, kind, message, scan, scans.verdict,"
      " scans.withheld, (SELECT count(*) FROM foils WHERE foils.scan = arrivals.scan),"
      " scans.setup"
      " FROM arrivals LEFT JOIN scans ON scans.id = scan"
      " WHERE superseded = 0 ORDER BY arrivals.id DESC LIMIT 1",
      &query);
  if (fg_query_row(&query)) {
    newest->id = fg_query_get_integer(&query, 0);
    newest->at = fg_query_get_integer(&query, 1);
    copy(&query, 2, newest->path, sizeof newest->path);
    copy(&query, 3, newest->kind, sizeof newest->kind);
    copy(&query, 4, newest->message, sizeof newest->message);
    newest->scan = fg_query_get_integer(&query, 5);
    copy(&query, 6, newest->verdict, sizeof newest->verdict);
    copy(&query, 7, newest->withheld, sizeof newest->withheld);
    newest->foils = fg_query_get_integer(&query, 8);
    newest->setup = fg_query_get_integer(&query, 9);
  }
  return fg_query_end(ctx, &query, "reading the cards");
}

/* True where the ± holds the default for an unknown scanner, which another scan does not change. */
static bool is_scale_unknown(const fg_inspection *station, const card *newest) {
  const fg_design *design = &fg_part_recipe_of_setup(station, newest->setup).lot->design;
  return design->calibration.stated &&
         !strcmp(design->calibration.certificate, fg_calibration_of_flatbed().certificate);
}

static const char *next_step(const card *newest) {
  if (!strcmp(newest->kind, "unfinished")) return "Scan the foil again.";
  if (!strcmp(newest->kind, "foreign"))
    return "Scan to PNG or TIFF into this folder; take this file out of it.";
  if (!strcmp(newest->kind, "unreadable") && fg_station_is_scanned(newest->path))
    return "See to the scanner, the glass and the foil, and scan again.";
  if (!strcmp(newest->kind, "unreadable")) return "Look at the foil and the glass, and scan again.";
  if (!strcmp(newest->kind, "check"))
    return fg_page_check_passed(newest->message)
               ? "Go on with foils."
               : "Do not go on with foils: the page Scanner says what to do.";
  if (!strcmp(newest->kind, "known")) return "Nothing is new: go on with the next foil.";
  if (!strcmp(newest->kind, "duplicate")) return "Put this foil on the glass and scan it.";
  if (newest->withheld[0]) return newest->withheld;
  if (!strcmp(newest->verdict, "pass") && newest->foils > 1)
    return "Put the foils with the good ones, and the next ones on the glass.";
  if (!strcmp(newest->verdict, "pass"))
    return "Put the foil with the good ones, and the next one on the glass.";
  if (!strcmp(newest->verdict, "fail"))
    return newest->foils > 1
               ? "Put the foils that failed aside; the values beyond their limits are below."
               : "Put the foil aside; the values beyond their limits are below.";
  if (!strcmp(newest->verdict, "cannot_tell"))
    return "A limit lies within the uncertainty of a value: clean glass and foil, turn the foil by "
           "90 degrees, and scan again.";
  if (!strcmp(newest->verdict, "not_measured"))
    return "Something of the foil could not be measured: clean glass and foil, and scan again.";
  return "The design states no tolerances, so nothing was judged.";
}

/* Writes the arrival's number: a script compares it with that of the foil whose html form is
 * half typed. */
static void write_arrival(FILE *out, int64_t id, const char *words) {
  fprintf(out, " data-arrival=\"%lld\" data-words=\"%s\"", (long long)id, words);
}

/* Writes what the verdict rests on. */
static void write_traceability(FILE *out, const fg_inspection *station, const card *newest) {
  if (newest->foils)
    fprintf(out, "<br>traced to: %s",
            fg_traceability_words[fg_design_traceability(
                &fg_part_recipe_of_setup(station, newest->setup).lot->design)]);
}

static void write_newest_call(FILE *out, const fg_inspection *station, const card *newest) {
  const fg_card_style look = fg_page_card_style(newest->kind, newest->message, newest->verdict,
                                                newest->withheld[0] != '\0');
  fprintf(out, "<div class=\"call %s%s\"", look.style,
          strlen(look.words) > LARGE_LETTERS ? " long" : "");
  write_arrival(out, newest->id, look.words);
  fprintf(out, "><b>%s</b><span>", look.words);
  fg_html_name(out, newest->path);
  fputs("<br>", out);
  fg_page_time(out, newest->at);
  write_traceability(out, station, newest);
  fprintf(out, "</span></div>\n<p class=\"next%s\">", strcmp(look.style, "pass") ? "" : " calm");
  if (newest->message[0]) {
    fg_html_name(out, newest->path);
    fputc(' ', out);
    fg_html_text(out, newest->message);
    fputs(". ", out);
  }
  fg_html_text(out, next_step(newest));
  if (newest->foils && !newest->withheld[0] && !strcmp(newest->verdict, "cannot_tell") &&
      strcmp(newest->kind, "known") != 0 && is_scale_unknown(station, newest))
    fputs(" If it stays so, the scanner's unknown scale decides (± 0.6 % of a length): a model of "
          "the scanner makes it smaller.",
          out);
  fputs("</p>\n", out);
}

/* Writes the stage of the newest file or of the scanner; false: there is none. A verdict that is
 * shown meanwhile is that of the foil before. */
static bool write_stage(FILE *out, fg_inspection *station) {
  static const char *const words[] = {"", "RECEIVING", "MEASURING"};
  fg_arriving arriving;
  fg_station_read_stage(station, &arriving);
  bool scanning = atomic_load(&station->scanning);
  if (arriving.stage == FG_STAGE_NONE && !scanning) return false;
  fprintf(out, "<div class=\"call long none\"><b>%s</b><span>",
          arriving.stage == FG_STAGE_NONE ? "SCANNING" : words[arriving.stage]);
  if (arriving.stage != FG_STAGE_NONE) {
    fg_html_name(out, arriving.file);
    fputs("<br>since ", out);
    fg_page_time(out, arriving.since);
  }
  fputs("</span></div>\n<p class=\"next\">The verdict comes by itself.", out);
  if (arriving.stage == FG_STAGE_RECEIVING)
    fprintf(out,
            " The file is not whole yet; when nothing more has come for %g s, this page says what "
            "is missing.",
            station->settings->receive_s);
  fputs("</p>\n", out);
  return true;
}

static fg_status write_picture(fg_context *ctx, sqlite3 *reader, int64_t foil, FILE *out) {
  fg_query query;
  fg_query_begin(reader, "SELECT html FROM pictures WHERE foil = ?", &query);
  fg_query_integer(&query, foil);
  if (fg_query_row(&query))
    fprintf(out, "<figure class=\"scroll\">%s</figure>\n", fg_query_get_text(&query, 0));
  return fg_query_end(ctx, &query, "reading a picture");
}

static fg_status write_foil(fg_context *ctx, fg_inspection *station, sqlite3 *reader,
                            const fg_query *foil, bool focus, FILE *out) {
  int64_t id = fg_query_get_integer(foil, 0);
  bool withheld = !fg_query_is_null(foil, 7);
  fprintf(out, "<h2 id=\"foil%lld\">Foil <a href=\"/foil?id=%lld\">", (long long)id, (long long)id);
  fg_html_name(out, fg_query_get_text(foil, 1));
  fprintf(out, "</a> <span class=\"tag %s\">%s</span></h2>\n",
          fg_page_verdict_class(fg_query_get_text(foil, 5), withheld),
          fg_page_verdict_words(fg_query_get_text(foil, 5), withheld));
  if (fg_query_get_text(foil, 6)[0]) {
    fputs("<p class=\"next\">", out);
    fg_html_text(out, fg_query_get_text(foil, 6));
    fputs("</p>\n", out);
  }
  FG_TRY(fg_page_crushed(ctx, reader, id, out));
  /* Without a verdict there is no colour of one. */
  fputs(withheld ? "<div class=\"withheld\">" : "<div>", out);
  FG_TRY(fg_page_deciding(ctx, reader, id, out));
  fputs("</div>\n", out);
  FG_TRY(fg_disposition_write_link(ctx, reader, id, out));
  const fg_foil_html_form html_form = {.back = "/", .focus = focus};
  fg_page_foil_html_form(station, foil, &html_form, out);
  FG_TRY(fg_page_same_serial(ctx, reader, id, out));
  return write_picture(ctx, reader, id, out);
}

/* Writes an overview of a bed: every foil with its verdict, and a link to its place on the page. */
static fg_status write_overview(fg_context *ctx, sqlite3 *reader, const card *newest, FILE *out) {
  fg_query foils;
  if (newest->foils < 2) return FG_OK;
  fg_query_begin(reader, "SELECT id, serial, verdict FROM foils WHERE scan = ? ORDER BY number",
                 &foils);
  fg_query_integer(&foils, newest->scan);
  fputs("<p class=\"bed\">", out);
  while (fg_query_row(&foils)) {
    bool withheld = newest->withheld[0] != '\0';
    const char *verdict = fg_query_get_text(&foils, 2);
    fprintf(out, "<a class=\"tag %s\" href=\"#foil%lld\">",
            fg_page_verdict_class(verdict, withheld), (long long)fg_query_get_integer(&foils, 0));
    fg_html_name(out, fg_query_get_text(&foils, 1));
    fprintf(out, " %s</a> ", fg_page_verdict_words(verdict, withheld));
  }
  fputs("</p>\n", out);
  return fg_query_end(ctx, &foils, "reading the foils");
}

static fg_status write_foils(fg_context *ctx, fg_inspection *station, sqlite3 *reader, int64_t scan,
                             FILE *out) {
  fg_query foils;
  fg_status status = FG_OK;
  bool first = true;
  fg_query_begin(
      reader,
      "SELECT foils.id, serial, lot, die, operator, foils.verdict, reasons, withheld FROM foils"
      " JOIN scans ON scans.id = scan WHERE scan = ? ORDER BY number",
      &foils);
  fg_query_integer(&foils, scan);
  while (status == FG_OK && fg_query_row(&foils)) {
    status = write_foil(ctx, station, reader, &foils, first, out);
    first = false;
  }
  fg_status ended = fg_query_end(ctx, &foils, "reading the foils");
  return status == FG_OK ? ended : status;
}

static void write_scan_button(const fg_inspection *station, FILE *out) {
  if (!station->settings->scan_command[0]) return;
  fputs("<form class=\"fields\" method=\"post\" action=\"/scan\">", out);
  fg_page_csrf_token(station, out);
  fprintf(out, "<button class=\"big\"%s>%s</button></form>\n",
          atomic_load(&station->scanning) ? " disabled" : "",
          atomic_load(&station->scanning) ? "Scanning …" : "Scan");
  if (!station->scan_warning[0]) return;
  fputs("<p class=\"banner\"><b>The recipe's scan_command spoils scans.</b> ", out);
  fg_html_text(out, station->scan_warning);
  fputs("</p>\n", out);
}

static fg_status write_cards(fg_context *ctx, sqlite3 *reader, int64_t newest, FILE *out) {
  fg_query query;
  fg_query_begin(reader,
                 "SELECT arrivals.at, arrivals.path, kind, message, scans.verdict, scans.withheld,"
                 " (SELECT min(id) FROM foils WHERE foils.scan = arrivals.scan), arrivals.id"
                 " FROM arrivals LEFT JOIN scans ON scans.id = scan"
                 " WHERE superseded = 0 AND arrivals.id < ?"
                 " ORDER BY arrivals.id DESC LIMIT ?",
                 &query);
  fg_query_integer(&query, newest);
  fg_query_integer(&query, CARDS);
  bool any = false;
  for (; fg_query_row(&query); any = true) {
    if (!any)
      fputs("<section class=\"noprint\"><h2 class=\"first\">Before</h2>\n<ul class=\"cards\">",
            out);
    const fg_card_style look =
        fg_page_card_style(fg_query_get_text(&query, 2), fg_query_get_text(&query, 3),
                           fg_query_get_text(&query, 4), !fg_query_is_null(&query, 5));
    fputs("<li", out);
    write_arrival(out, fg_query_get_integer(&query, 7), look.words);
    fprintf(out, "><span class=\"tag %s\">%s</span><span>", look.style, look.words);
    if (!fg_query_is_null(&query, 6))
      fprintf(out, "<a href=\"/foil?id=%lld\">", (long long)fg_query_get_integer(&query, 6));
    fg_html_name(out, fg_query_get_text(&query, 1));
    fputs(fg_query_is_null(&query, 6) ? " " : "</a> ", out);
    fg_html_text(out, fg_query_get_text(&query, 3));
    fputs("</span><span class=\"note\">", out);
    fg_page_time(out, fg_query_get_integer(&query, 0));
    fputs("</span></li>\n", out);
  }
  if (any) fputs("</ul></section>\n", out);
  return fg_query_end(ctx, &query, "reading the cards");
}

static void write_ready(const fg_inspection *station, FILE *out) {
  fputs("<div class=\"call none\"><b>READY</b><span>Put a foil on the glass and scan it into ",
        out);
  fg_html_name(out, station->request->folder);
  fputs("</span></div>\n", out);
}

/* The foils of a card, if it is theirs: a scan that came a second time under another name is none.
 */
static fg_status write_scan(fg_context *ctx, fg_inspection *station, sqlite3 *reader,
                            const card *newest, FILE *out) {
  if (!newest->scan || !strcmp(newest->kind, "duplicate")) return FG_OK;
  FG_TRY(write_overview(ctx, reader, newest, out));
  return write_foils(ctx, station, reader, newest->scan, out);
}

static void write_before(FILE *out, const card *newest) {
  const fg_card_style look = fg_page_card_style(newest->kind, newest->message, newest->verdict,
                                                newest->withheld[0] != '\0');
  fputs("<p class=\"note\"", out);
  write_arrival(out, newest->id, look.words);
  fputs(">Before it: ", out);
  fg_html_name(out, newest->path);
  fprintf(out, " %s, ", look.words);
  fg_page_time(out, newest->at);
  fputs(newest->message[0] ? ": " : "", out);
  fg_html_text(out, newest->message);
  fputs("</p>\n", out);
}

fg_status fg_page_now(fg_context *ctx, fg_inspection *station, sqlite3 *reader,
                      const fg_request *request, FILE *out) {
  card newest;
  (void)request;
  FG_TRY(fg_page_begin(ctx, station, reader, out, FG_TAB_NOW, "Now"));
  fg_page_heading(out, "Now");
  FG_TRY(read_newest(ctx, reader, &newest));
  fputs(newest.foils > 1 ? "<section class=\"many\" data-live>\n" : "<section data-live>\n", out);
  bool arriving = write_stage(out, station);
  if (newest.id && !arriving) write_newest_call(out, station, &newest);
  if (!newest.id && !arriving) write_ready(station, out);
  FG_TRY(fg_order_write_progress(ctx, reader, out));
  FG_TRY(fg_disposition_write_open(ctx, reader, out));
  FG_TRY(fg_outbox_write_line(ctx, station, reader, out));
  fputs("<div data-typing></div>\n", out);
  write_scan_button(station, out);
  if (newest.id && arriving) write_before(out, &newest);
  FG_TRY(write_scan(ctx, station, reader, &newest, out));
  fputs("</section>\n", out);
  if (newest.id) FG_TRY(write_cards(ctx, reader, newest.id, out));
  fg_page_end(out);
  return FG_OK;
}
