/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/values.h"

#include <math.h>
#include <string.h>

#include "core/text.h"
#include "foilgauge/words.h"
#include "page/page.h"
#include "quantity/quantity_rows.h"

/* A value that decided, as a row of the database has it. */
typedef struct decided {
  const fg_quantity *row; /* NULL: of a later program */
  const char *name, *unit, *verdict;
  int64_t bump;
  double value, u, lower, upper;
  int decimals; /* as many as U = 2 u needs */
} decided;

static decided read_decided(const fg_query *at, int column) {
  decided read = {.name = fg_query_get_text(at, column),
                  .unit = fg_query_get_text(at, column + 2),
                  .verdict = fg_query_get_text(at, column + 8),
                  .bump = fg_query_get_integer(at, column + 3),
                  .value = fg_query_get_number(at, column + 4),
                  .u = fg_query_get_number(at, column + 5),
                  .lower = fg_query_get_number(at, column + 6),
                  .upper = fg_query_get_number(at, column + 7)};
  bool of_bump = !strcmp(fg_query_get_text(at, column + 1), "bump");
  read.row = fg_quantity_find(of_bump ? FG_QUANTITY_OF_BUMP : FG_QUANTITY_OF_FOIL, read.name);
  read.decimals = read.row ? fg_report_decimals(read.row, read.u) : 4;
  if (isnan(read.lower)) read.lower = -INFINITY;
  if (isnan(read.upper)) read.upper = INFINITY;
  return read;
}

/* Writes "Bump 3: radius". */
static void write_decided_name(FILE *out, const decided *at) {
  if (at->bump) fprintf(out, "Bump %lld: ", (long long)at->bump);
  fg_html_text(out, at->row ? at->row->words : at->name);
}

/* A limit with the digits that it was stated with. */
#define LIMIT_FORMAT "%.8g"

static void write_limits(FILE *out, const decided *at) {
  bool low = isfinite(at->lower), high = isfinite(at->upper);
  if (low) fputs(high ? "allowed " : "at least ", out);
  if (low) fprintf(out, LIMIT_FORMAT, at->lower);
  if (high) fputs(low ? " to " : "at most ", out);
  if (high) fprintf(out, LIMIT_FORMAT, at->upper);
  fputc(' ', out);
  fg_html_text(out, at->unit);
}

static void write_decided_value(FILE *out, const decided *at) {
  if (isnan(at->value)) {
    fputs("missing", out);
    return;
  }
  fprintf(out, "%s%.*f", at->value < 0 ? "−" : "", at->decimals, fabs(at->value));
  if (isfinite(at->u)) fprintf(out, " ± %.*f", at->decimals, FG_COVERAGE_FACTOR * at->u);
  fputc(' ', out);
  fg_html_text(out, at->unit);
}

static void write_decided(FILE *out, const decided *at) {
  fprintf(out, "<li class=\"%s\">", at->verdict);
  write_decided_name(out, at);
  fputs("<strong>", out);
  write_decided_value(out, at);
  fputs("</strong><small>", out);
  write_limits(out, at);
  fputs("</small></li>\n", out);
}

void fg_page_decided_line(const fg_query *at, int column, FILE *out) {
  decided read = read_decided(at, column);
  const fg_margin margin = fg_margin_to(read.lower, read.upper, read.value);
  if (read.bump) fprintf(out, "bump %lld ", (long long)read.bump);
  fg_html_text(out, read.row ? read.row->symbol : read.name);
  fputc(' ', out);
  write_decided_value(out, &read);
  fprintf(out, margin.upper ? ", ≤ " LIMIT_FORMAT : ", ≥ " LIMIT_FORMAT, margin.limit);
}

fg_status fg_page_deciding(fg_context *ctx, sqlite3 *reader, int64_t foil, FILE *out) {
  fg_query query;
  fg_query_begin(reader,
                 "SELECT name, owner, unit, bump, value, u, lower, upper, verdict FROM deciding"
                 " JOIN quantities ON quantities.id = quantity WHERE foil = ? ORDER BY rank",
                 &query);
  fg_query_integer(&query, foil);
  bool any = false;
  for (; fg_query_row(&query); any = true) {
    decided read = read_decided(&query, 0);
    if (!any) fputs("<ul class=\"decided\">", out);
    write_decided(out, &read);
  }
  if (any) fputs("</ul>\n", out);
  return fg_query_end(ctx, &query, "reading what decided");
}

fg_status fg_page_crushed(fg_context *ctx, sqlite3 *reader, int64_t foil, FILE *out) {
  fg_query query;
  int64_t crushed = 0, bumps = 0;
  char list[200] = "";
  fg_query_begin(reader,
                 "SELECT number, instr(' ' || flags || ' ', ' crushed ') > 0 FROM bumps"
                 " WHERE foil = ? ORDER BY number",
                 &query);
  fg_query_integer(&query, foil);
  for (; fg_query_row(&query); bumps++) {
    size_t length = strlen(list);
    if (!fg_query_get_integer(&query, 1)) continue;
    fg_text_clip(list + length, sizeof list - length, "%s%lld", crushed++ ? ", " : "",
                 (long long)fg_query_get_integer(&query, 0));
  }
  /* If all bumps are off, none was crushed: the foil is of another design. */
  if (crushed && crushed == bumps)
    fputs("<p class=\"next\">No bump has the height and radius of the design: is this a foil of "
          "it?</p>\n",
          out);
  else if (crushed)
    fprintf(out,
            "<p class=\"next\">Bump%s %s %s crushed: far lower, wider or rounder than the "
            "others.</p>\n",
            fg_plural((size_t)crushed), list, crushed == 1 ? "is" : "are");
  return fg_query_end(ctx, &query, "reading the bumps");
}

fg_status fg_page_same_serial(fg_context *ctx, sqlite3 *reader, int64_t foil, FILE *out) {
  enum { SHOWN = 3 };
  fg_query query;
  int64_t count = 0;
  fg_query_begin(reader,
                 "SELECT o.id, o.lot, o.verdict, s.withheld, s.at FROM foils AS f JOIN foils AS o"
                 " ON o.serial = f.serial AND o.id <> f.id JOIN scans AS s ON s.id = o.scan"
                 " WHERE f.id = ? ORDER BY o.id DESC LIMIT ?",
                 &query);
  fg_query_integer(&query, foil);
  fg_query_integer(&query, SHOWN + 1);
  for (; fg_query_row(&query); count++) {
    bool withheld = !fg_query_is_null(&query, 3);
    const char *verdict = fg_query_get_text(&query, 2), *lot = fg_query_get_text(&query, 1);
    if (count < SHOWN) {
      fprintf(out, "%s<a href=\"/foil?id=%lld\">",
              count ? ", " : "<p class=\"note\">The serial also has ",
              (long long)fg_query_get_integer(&query, 0));
      fg_page_time(out, fg_query_get_integer(&query, 4));
      fprintf(out, "</a> <span class=\"tag %s\">%s</span>",
              fg_page_verdict_class(verdict, withheld), fg_page_verdict_words(verdict, withheld));
      if (*lot) fputs(" in lot ", out);
      fg_html_name(out, lot);
    }
  }
  if (count) fputs(count > SHOWN ? " and older ones.</p>\n" : ".</p>\n", out);
  return fg_query_end(ctx, &query, "reading the serial numbers");
}

static const struct {
  const char *label, *name, *more;
} foil_fields[] = {{"Serial", "serial", " required"},
                   {"Lot", "lot", ""},
                   {"Die", "die", ""},
                   {"Operator", "operator", ""}};

enum { FOIL_FIELDS = sizeof foil_fields / sizeof *foil_fields };

/* Input for column i + 1 of the row; its value at display goes along, hidden. */
static void write_field(const fg_query *foil, const fg_foil_html_form *html_form, int i,
                        FILE *out) {
  const char *was = fg_query_get_text(foil, i + 1), *name = foil_fields[i].name;
  fprintf(out, "<input type=\"hidden\" name=\"was_%s\" value=\"", name);
  fg_html_text(out, was);
  fprintf(out, "\"><label>%s<input name=\"%s\" maxlength=\"127\" autocomplete=\"off\"%s%s value=\"",
          foil_fields[i].label, name, foil_fields[i].more,
          !i && html_form->focus ? " data-focus" : "");
  fg_html_text(out, html_form->asked[i] ? html_form->asked[i] : was);
  fputs("\"></label>", out);
}

/* Enter, which a barcode reader adds, presses the first button: never the one that shares. */
static void write_buttons(const fg_foil_html_form *html_form, FILE *out) {
  fputs("<button>Keep</button>", out);
  if (!html_form->also || !html_form->also[0]) return;
  fputs("<button class=\"plain\" name=\"also\" value=\"", out);
  fg_html_text(out, html_form->also);
  fputs("\">The same foil: keep ", out);
  fg_html_name(out, html_form->also);
  fputs("</button>", out);
}

void fg_page_foil_html_form(const fg_inspection *station, const fg_query *foil,
                            const fg_foil_html_form *html_form, FILE *out) {
  long long id = (long long)fg_query_get_integer(foil, 0);
  fprintf(out, "<form class=\"fields\" method=\"post\" action=\"/correct\" data-foil=\"%lld\">",
          id);
  fg_page_csrf_token(station, out);
  fprintf(out,
          "<input type=\"hidden\" name=\"foil\" value=\"%lld\">"
          "<input type=\"hidden\" name=\"back\" value=\"%s\">",
          id, html_form->back);
  for (int i = 0; i < FOIL_FIELDS; i++)
    write_field(foil, html_form, i, out);
  if (html_form->who) {
    fputs("<label>Corrected by<input name=\"by\" maxlength=\"127\" autocomplete=\"off\" required "
          "value=\"",
          out);
    fg_html_text(out, html_form->by ? html_form->by : "");
    fputs("\"></label>", out);
  }
  write_buttons(html_form, out);
  fputs("</form>\n", out);
}
