#include "station/values.h"

#include <math.h>
#include <string.h>

#include "quantity/quantity_rows.h"
#include "report/measure/measure_page_parts.h"

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

/* "Bump 3: radius", as people say it. */
static void write_name(FILE *out, const decided *at) {
  if (at->bump) fprintf(out, "Bump %lld: ", (long long)at->bump);
  fg_html_text(out, at->row ? at->row->words : at->name);
}

/* As it was stated. */
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

static void write_value(FILE *out, const decided *at) {
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
  write_name(out, at);
  fputs("<strong>", out);
  write_value(out, at);
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
  write_value(out, &read);
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

static void write_field(FILE *out, const char *label, const char *name, const char *value,
                        const char *more) {
  fprintf(out, "<label>%s<input name=\"%s\" maxlength=\"127\" autocomplete=\"off\"%s value=\"",
          label, name, more);
  fg_html_text(out, value);
  fputs("\"></label>", out);
}

void fg_page_foil_form(const fg_inspection *station, const fg_query *foil, const fg_foil_form *form,
                       FILE *out) {
  fputs("<form class=\"fields\" method=\"post\" action=\"/correct\">", out);
  fg_page_form_token(station, out);
  fprintf(out,
          "<input type=\"hidden\" name=\"foil\" value=\"%lld\">"
          "<input type=\"hidden\" name=\"back\" value=\"%s\">",
          (long long)fg_query_get_integer(foil, 0), form->back);
  write_field(out, "Serial", "serial", fg_query_get_text(foil, 1),
              form->focus ? " required autofocus data-focus" : " required");
  write_field(out, "Lot", "lot", fg_query_get_text(foil, 2), "");
  write_field(out, "Die", "die", fg_query_get_text(foil, 3), "");
  write_field(out, "Operator", "operator", fg_query_get_text(foil, 4), "");
  if (form->who) write_field(out, "Corrected by", "by", "", " required");
  fputs("<button>Keep</button></form>\n", out);
}
