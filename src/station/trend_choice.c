/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The choice of a trend, from a query and back. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/text.h"
#include "page/page.h"
#include "quantity/quantity_rows.h"
#include "station/trend_choice.h"

/* NEWEST: points of a chart by default: enough for limits, few enough that last year's changes
 * do not widen them. */
enum { NEWEST = 200, NAME_BYTES = 80 };

static const struct {
  fg_quantity_owner owner;
  const char *word;
} owners[] = {{FG_QUANTITY_OF_BUMP, "bump:"}, {FG_QUANTITY_OF_FOIL, "foil:"}};

enum { OWNERS = sizeof owners / sizeof *owners };

static bool find_row(const char *name, fg_trend_choice *choice) {
  for (size_t i = 0; i < OWNERS; i++) {
    size_t length = strlen(owners[i].word);
    if (strncmp(name, owners[i].word, length) != 0) continue;
    choice->owner = owners[i].owner;
    choice->row = fg_quantity_find(owners[i].owner, name + length);
    return choice->row && choice->row->kind != FG_QUANTITY_PAIR;
  }
  return false;
}

/* Chooses the design's first toleranced quantity, else the radius. */
static void choose_first(const fg_design *design, fg_trend_choice *choice) {
  choice->owner = FG_QUANTITY_OF_BUMP;
  choice->row = fg_quantity_find(FG_QUANTITY_OF_BUMP, "radius_mm");
  for (size_t i = 0; i < design->tolerance_count; i++)
    for (size_t o = 0; o < OWNERS; o++) {
      const fg_quantity *row = fg_quantity_find(owners[o].owner, design->tolerances[i].quantity);
      if (!row) continue;
      choice->owner = owners[o].owner;
      choice->row = row;
      return;
    }
}

bool fg_trend_choose_named(const char *name, size_t newest, fg_trend_choice *choice) {
  *choice = (fg_trend_choice){.newest = newest};
  for (size_t i = 0; i < OWNERS; i++) {
    choice->owner = owners[i].owner;
    choice->row = fg_quantity_find(choice->owner, name);
    if (choice->row) return choice->row->kind != FG_QUANTITY_PAIR;
  }
  return false;
}

fg_status fg_trend_find_quantity(fg_context *ctx, sqlite3 *reader, const fg_trend_choice *choice,
                                 int64_t *id) {
  fg_query query;
  fg_query_begin(reader, "SELECT id FROM quantities WHERE owner = ? AND name = ?", &query);
  fg_query_text(&query, choice->owner == FG_QUANTITY_OF_BUMP ? "bump" : "foil");
  fg_query_text(&query, choice->row->name);
  *id = fg_query_row(&query) ? fg_query_get_integer(&query, 0) : 0;
  return fg_query_end(ctx, &query, "reading the quantities");
}

static size_t read_count(const fg_request *request, const char *name) {
  const char *text = fg_request_get(request, name);
  char *end;
  if (*text < '0' || *text > '9') return 0;
  unsigned long value = strtoul(text, &end, 10);
  return *end || value > 1000000000 ? 0 : (size_t)value;
}

fg_status fg_trend_choose(fg_context *ctx, const fg_inspection *station, const fg_request *request,
                          fg_trend_choice *choice) {
  const char *name = fg_request_get(request, "q"), *newest = fg_request_get(request, "newest");
  *choice = (fg_trend_choice){0};
  if (!name[0])
    choose_first(&station->settings->lot.design, choice);
  else if (!find_row(name, choice))
    return fg_fail(ctx, FG_ERR_USAGE, "There is no quantity \"%.60s\".", name);
  if (choice->owner == FG_QUANTITY_OF_BUMP) choice->bump = (int)read_count(request, "bump");
  fg_text_clip(choice->lot, sizeof choice->lot, "%s", fg_request_get(request, "lot"));
  fg_text_clip(choice->die, sizeof choice->die, "%s", fg_request_get(request, "die"));
  choice->by_lots = !strcmp(fg_request_get(request, "by"), "lots");
  choice->newest = !strcmp(newest, "all") ? 0 : newest[0] ? read_count(request, "newest") : NEWEST;
  choice->from = read_count(request, "from");
  choice->to = read_count(request, "to");
  choice->of_the_drawn = fg_request_get(request, "limits")[0] != '\0';
  return FG_OK;
}

/* Encodes text for a query, harmless in an attribute too: all but letters, digits and a few
 * marks become %XX. */
static void write_encoded(FILE *out, const char *text) {
  for (; *text; text++) {
    unsigned char c = (unsigned char)*text;
    bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                 c == '_' || c == '.' || c == '-' || c == ':';
    if (plain)
      fputc(c, out);
    else
      fprintf(out, "%%%02X", c);
  }
}

void fg_trend_write_name(FILE *out, fg_quantity_owner owner, const fg_quantity *row) {
  for (size_t i = 0; i < OWNERS; i++)
    if (owners[i].owner == owner) fputs(owners[i].word, out);
  fputs(row->name, out);
}

void fg_trend_write_link(FILE *out, const fg_trend_choice *choice, size_t from, size_t to) {
  fputs("/trends?q=", out);
  fg_trend_write_name(out, choice->owner, choice->row);
  if (choice->bump) fprintf(out, "&amp;bump=%d", choice->bump);
  if (choice->lot[0]) write_encoded((fputs("&amp;lot=", out), out), choice->lot);
  if (choice->die[0]) write_encoded((fputs("&amp;die=", out), out), choice->die);
  if (choice->by_lots) fputs("&amp;by=lots", out);
  if (choice->newest)
    fprintf(out, "&amp;newest=%zu", choice->newest);
  else
    fputs("&amp;newest=all", out);
  if (choice->of_the_drawn) fputs("&amp;limits=drawn", out);
  if (from || to) fprintf(out, "&amp;from=%zu&amp;to=%zu", from, to);
}

void fg_trend_write_query(FILE *out, const char *page, const fg_trend_choice *choice) {
  fprintf(out, "%s?q=", page);
  fg_trend_write_name(out, choice->owner, choice->row);
  if (choice->bump) fprintf(out, "&bump=%d", choice->bump);
  if (choice->lot[0]) write_encoded((fputs("&lot=", out), out), choice->lot);
  if (choice->die[0]) write_encoded((fputs("&die=", out), out), choice->die);
}

void fg_trend_write_hidden(FILE *out, const fg_trend_choice *choice) {
  fputs("<input type=\"hidden\" name=\"q\" value=\"", out);
  fg_trend_write_name(out, choice->owner, choice->row);
  fputs("\">", out);
  if (choice->bump)
    fprintf(out, "<input type=\"hidden\" name=\"bump\" value=\"%d\">", choice->bump);
  fputs("<input type=\"hidden\" name=\"lot\" value=\"", out);
  fg_html_text(out, choice->lot);
  fputs("\"><input type=\"hidden\" name=\"die\" value=\"", out);
  fg_html_text(out, choice->die);
  fputs("\">", out);
}

static void write_option(FILE *out, fg_quantity_owner owner, const fg_quantity *row,
                         const fg_trend_choice *choice) {
  fputs("<option value=\"", out);
  fg_trend_write_name(out, owner, row);
  fprintf(out, "\"%s>", row == choice->row && owner == choice->owner ? " selected" : "");
  fg_html_text(out, row->words);
  if (row->unit[0]) {
    fputs(", ", out);
    fg_html_text(out, row->unit);
  }
  fputs("</option>", out);
}

static bool is_judged(const fg_design *design, const fg_quantity *row) {
  for (size_t i = 0; i < design->tolerance_count; i++)
    if (!strcmp(design->tolerances[i].quantity, row->name)) return true;
  return false;
}

static void write_group(FILE *out, const char *label, const fg_design *design,
                        fg_quantity_owner only, bool judged, const fg_trend_choice *choice) {
  fprintf(out, "<optgroup label=\"%s\">", label);
  for (size_t o = 0; o < OWNERS; o++) {
    size_t count;
    const fg_quantity *rows = fg_quantities(owners[o].owner, &count);
    if (!judged && owners[o].owner != only) continue;
    for (size_t i = 0; i < count; i++)
      if (rows[i].kind != FG_QUANTITY_PAIR && is_judged(design, &rows[i]) == judged)
        write_option(out, owners[o].owner, &rows[i], choice);
  }
  fputs("</optgroup>", out);
}

static void write_quantities(FILE *out, const fg_design *design, const fg_trend_choice *choice) {
  /* The page's script shows the search and the star, and fills the first group. */
  fputs("<label hidden data-script>Search quantities<input type=\"search\" data-search "
        "autocomplete=\"off\"></label><label>Quantity<select name=\"q\"><optgroup "
        "label=\"favourites\" hidden></optgroup>",
        out);
  if (design->tolerance_count)
    write_group(out, "with a tolerance", design, FG_QUANTITY_OF_BUMP, true, choice);
  write_group(out, "of the bumps", design, FG_QUANTITY_OF_BUMP, false, choice);
  write_group(out, "of the foil", design, FG_QUANTITY_OF_FOIL, false, choice);
  fputs("</select></label><button type=\"button\" class=\"plain\" hidden data-script data-star "
        "aria-pressed=\"false\" aria-label=\"Favourite\" title=\"Favourite: it stands first in the "
        "list, in this browser\">☆</button>",
        out);
}

static void write_bumps(FILE *out, const fg_trend_choice *choice, int bumps) {
  fputs("<label>Bump<select name=\"bump\"><option value=\"\">mean of the foil's</option>", out);
  for (int i = 1; i <= bumps; i++)
    fprintf(out, "<option value=\"%d\"%s>%d</option>", i, i == choice->bump ? " selected" : "", i);
  fputs("</select></label>", out);
}

static fg_status write_known(fg_context *ctx, sqlite3 *reader, FILE *out, const char *label,
                             const char *name, const char *value, const char *sql) {
  fg_query query;
  fprintf(out,
          "<label>%s<input name=\"%s\" maxlength=\"127\" autocomplete=\"off\" placeholder=\"all\" "
          "list=\"known-%s\" value=\"",
          label, name, name);
  fg_html_text(out, value);
  fprintf(out, "\"></label><datalist id=\"known-%s\">", name);
  fg_query_begin(reader, sql, &query);
  while (fg_query_row(&query)) {
    fputs("<option value=\"", out);
    fg_html_text(out, fg_query_get_text(&query, 0));
    fputs("\">", out);
  }
  fputs("</datalist>", out);
  return fg_query_end(ctx, &query, "reading the names");
}

static fg_status count_bumps(fg_context *ctx, sqlite3 *reader, int *bumps) {
  fg_query query;
  fg_query_begin(reader,
                 "SELECT max(number) FROM bumps WHERE foil > (SELECT max(id) FROM foils) - 50",
                 &query);
  *bumps = fg_query_row(&query) ? (int)fg_query_get_integer(&query, 0) : 0;
  return fg_query_end(ctx, &query, "reading the bumps");
}

fg_status fg_trend_write_html_form(fg_context *ctx, const fg_inspection *station, sqlite3 *reader,
                                   const fg_trend_choice *choice, FILE *out) {
  int bumps;
  FG_TRY(count_bumps(ctx, reader, &bumps));
  fputs("<form class=\"fields\" method=\"get\" action=\"/trends\">", out);
  write_quantities(out, &station->settings->lot.design, choice);
  write_bumps(out, choice, bumps > choice->bump ? bumps : choice->bump);
  FG_TRY(write_known(ctx, reader, out, "Lot", "lot", choice->lot,
                     "SELECT lot FROM foils WHERE lot <> '' GROUP BY lot ORDER BY max(id) DESC"
                     " LIMIT 100"));
  FG_TRY(write_known(ctx, reader, out, "Die", "die", choice->die,
                     "SELECT die FROM foils WHERE die <> '' GROUP BY die ORDER BY max(id) DESC"
                     " LIMIT 100"));
  fprintf(
      out,
      "<label>Over<select name=\"by\"><option value=\"\">foils</option><option value=\"lots\"%s>"
      "lots (means)</option></select></label>",
      choice->by_lots ? " selected" : "");
  if (choice->newest)
    fprintf(out, "<input type=\"hidden\" name=\"newest\" value=\"%zu\">", choice->newest);
  else
    fputs("<input type=\"hidden\" name=\"newest\" value=\"all\">", out);
  fputs("<button>Show</button></form>\n", out);
  return FG_OK;
}
