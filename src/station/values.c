#include "station/values.h"

#include <math.h>
#include <string.h>

#include "quantity/quantity_rows.h"
#include "report/measure/measure_page_parts.h"

/* "bump 3: radius", as people say it. */
static void write_name(FILE *out, const fg_quantity *row, const char *name, int64_t bump) {
  if (bump) fprintf(out, "Bump %lld: ", (long long)bump);
  fg_html_text(out, row ? row->words : name);
}

static void write_limits(FILE *out, double lower, double upper, int decimals, const char *unit) {
  if (isfinite(lower) && isfinite(upper))
    fprintf(out, "allowed %.*f to %.*f ", decimals, lower, decimals, upper);
  else if (isfinite(lower))
    fprintf(out, "at least %.*f ", decimals, lower);
  else
    fprintf(out, "at most %.*f ", decimals, upper);
  fg_html_text(out, unit);
}

static void write_value(FILE *out, double value, double u, int decimals, const char *unit) {
  if (isnan(value)) {
    fputs("missing", out);
    return;
  }
  fprintf(out, "%.*f", decimals, value);
  if (isfinite(u)) fprintf(out, " ± %.*f", decimals, FG_COVERAGE_FACTOR * u);
  fputc(' ', out);
  fg_html_text(out, unit);
}

static void write_decided(FILE *out, const fg_query *at) {
  fg_quantity_owner owner =
      strcmp(fg_query_get_text(at, 1), "bump") ? FG_QUANTITY_OF_FOIL : FG_QUANTITY_OF_BUMP;
  const char *name = fg_query_get_text(at, 0), *unit = fg_query_get_text(at, 2);
  const fg_quantity *row = fg_quantity_find(owner, name);
  double u = fg_query_get_number(at, 5);
  int decimals = row ? fg_report_decimals(row, u) : 4;
  fprintf(out, "<li class=\"%s\">", fg_query_get_text(at, 8));
  write_name(out, row, name, fg_query_get_integer(at, 3));
  fputs("<strong>", out);
  write_value(out, fg_query_get_number(at, 4), u, decimals, unit);
  fputs("</strong><small>", out);
  double lower = fg_query_is_null(at, 6) ? -INFINITY : fg_query_get_number(at, 6);
  double upper = fg_query_is_null(at, 7) ? INFINITY : fg_query_get_number(at, 7);
  write_limits(out, lower, upper, decimals, unit);
  fputs("</small></li>\n", out);
}

fg_status fg_page_deciding(fg_context *ctx, sqlite3 *reader, int64_t foil, FILE *out) {
  fg_query query;
  fg_query_begin(reader,
                 "SELECT name, owner, unit, bump, value, u, lower, upper, verdict FROM deciding"
                 " JOIN quantities ON quantities.id = quantity WHERE foil = ? ORDER BY rank",
                 &query);
  fg_query_integer(&query, foil);
  fputs("<ul class=\"decided\">", out);
  while (fg_query_row(&query))
    write_decided(out, &query);
  fputs("</ul>\n", out);
  return fg_query_end(ctx, &query, "reading what decided");
}

static void write_field(FILE *out, const char *label, const char *name, const char *value,
                        bool focus) {
  fprintf(out, "<label>%s<input name=\"%s\" maxlength=\"127\" autocomplete=\"off\"%s value=\"",
          label, name, focus ? " data-focus" : "");
  fg_html_text(out, value);
  fputs("\"></label>", out);
}

void fg_page_foil_form(const fg_inspection *station, const fg_query *foil, const char *back,
                       bool focus, FILE *out) {
  fputs("<form class=\"fields\" method=\"post\" action=\"/correct\">", out);
  fg_page_form_token(station, out);
  fprintf(
      out,
      "<input type=\"hidden\" name=\"foil\" value=\"%lld\"><input type=\"hidden\" name=\"back\" "
      "value=\"%s\">",
      (long long)fg_query_get_integer(foil, 0), back);
  write_field(out, "Serial", "serial", fg_query_get_text(foil, 1), focus);
  write_field(out, "Lot", "lot", fg_query_get_text(foil, 2), false);
  write_field(out, "Die", "die", fg_query_get_text(foil, 3), false);
  write_field(out, "Operator", "operator", fg_query_get_text(foil, 4), false);
  fputs("<button>Keep</button></form>\n", out);
}
