/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Trends: how the process runs, over foils or lots. */
#include <math.h>

#include "core/text.h"
#include "page/page.h"
#include "page/tile.h"
#include "station/cause_keep.h"
#include "station/trend.h"

enum { NAME_BYTES = 140, NARROWEST = 10 };
/* Points that a chart without signals needs before it shows a stable process (AIAG, Statistical
 * Process Control, 2005: 25 subgroups). */
enum { STABLE_MIN = 25 };

typedef struct page {
  FILE *out;
  sqlite3 *reader;
  const fg_inspection *station;
  const fg_trend *trend;
  const fg_trend_choice *choice;
} page;

static const char *things(const fg_trend_choice *choice) {
  return choice->by_lots ? "lots" : "foils";
}

static void write_window(const page *p, size_t newest) {
  fg_trend_choice other = *p->choice;
  other.newest = newest;
  other.of_the_drawn = false;
  fputs("<a href=\"", p->out);
  fg_trend_write_link(p->out, &other, 0, 0);
  fprintf(p->out, "\"%s>", newest == p->choice->newest ? " aria-current=\"true\"" : "");
  if (newest)
    fprintf(p->out, "newest %zu</a>\n", newest);
  else
    fprintf(p->out, "all</a>\n");
}

static void write_step(const page *p, const char *key, const char *words, size_t from, size_t to) {
  fprintf(p->out, "<a data-key=\"%s\" href=\"", key);
  fg_trend_write_link(p->out, p->choice, from, to);
  fprintf(p->out, "\">%s</a>\n", words);
}

/* Writes links that move the drawn range, as dragging does. */
static void write_steps(const page *p) {
  const fg_trend *trend = p->trend;
  size_t from = fg_trend_number(trend, trend->first), to = fg_trend_number(trend, trend->last);
  size_t low = trend->before + 1, high = trend->before + trend->count, span = to - from + 1;
  if (p->choice->of_the_drawn) low = 1, high = trend->total;
  size_t half = span / 2, quarter = span / 4;
  if (from > low)
    write_step(p, "ArrowLeft", "« earlier", from - low > half ? from - half : low,
               from - low > half ? to - half : low + span - 1);
  if (to < high)
    write_step(p, "ArrowRight", "later »", high - to > half ? from + half : high - span + 1,
               high - to > half ? to + half : high);
  if (span > NARROWEST) write_step(p, "+", "closer", from + quarter, to - quarter);
  if (from > low || to < high) {
    write_step(p, "-", "wider", from - low > half ? from - half : low,
               high - to > half ? to + half : high);
    write_step(p, "0", "whole chart", 0, 0);
  }
}

static void write_range_html_form(const page *p) {
  const fg_trend_choice *choice = p->choice;
  const fg_trend *trend = p->trend;
  FILE *out = p->out;
  fputs("<form class=\"fields range\" method=\"get\" action=\"/trends\"><input type=\"hidden\" "
        "name=\"by\" value=\"",
        out);
  fprintf(out, "%s\">", choice->by_lots ? "lots" : "");
  fg_trend_write_hidden(out, choice);
  if (choice->newest)
    fprintf(out, "<input type=\"hidden\" name=\"newest\" value=\"%zu\">", choice->newest);
  else
    fputs("<input type=\"hidden\" name=\"newest\" value=\"all\">", out);
  fprintf(out,
          "<label>From no.<input type=\"number\" name=\"from\" min=\"1\" max=\"%zu\" value=\"%zu\">"
          "</label><label>to no.<input type=\"number\" name=\"to\" min=\"1\" max=\"%zu\" "
          "value=\"%zu\"></label><label class=\"tick\"><input type=\"checkbox\" name=\"limits\" "
          "value=\"drawn\"%s> limits from these alone</label><button>Zoom</button></form>\n",
          trend->total, fg_trend_number(trend, trend->first), trend->total,
          fg_trend_number(trend, trend->last), choice->of_the_drawn ? " checked" : "");
}

static void write_controls(const page *p) {
  fputs("<div class=\"steps noprint\">", p->out);
  write_window(p, 50);
  write_window(p, 200);
  write_window(p, 0);
  fputs("<span></span>\n", p->out);
  write_steps(p);
  fputs("</div>\n", p->out);
}

/* Returns the time of a foil's measurement. */
static int64_t time_of(const page *p, size_t point) {
  fg_query query;
  fg_context unused;
  fg_query_begin(p->reader,
                 "SELECT at FROM scans JOIN foils ON scans.id = foils.scan WHERE foils.id = ?",
                 &query);
  fg_query_integer(&query, p->trend->foil[point]);
  int64_t at = fg_query_row(&query) ? fg_query_get_integer(&query, 0) : 0;
  fg_query_end(&unused, &query, "reading a time");
  return at;
}

static void write_point(const page *p, size_t point) {
  char name[NAME_BYTES];
  fg_trend_name(p->reader, p->trend, point, name, sizeof name);
  if (!p->choice->by_lots)
    fprintf(p->out, "<a href=\"/foil?id=%lld\">", (long long)p->trend->foil[point]);
  fg_html_name(p->out, name);
  fprintf(p->out, "%s (no. %zu)", p->choice->by_lots ? "" : "</a>",
          fg_trend_number(p->trend, point));
}

static void write_changes(const page *p) {
  const fg_trend_change *change = p->trend->change;
  size_t count = p->trend->changes;
  if (!count) return;
  fputs(" Dotted brown: foils were measured in another way from there on:", p->out);
  for (size_t i = 0; i < count; i++) {
    const char *and = change[i].program && (change[i].recipe || change[i].model) ? ", " : "";
    fprintf(p->out, "%s by another %s%s%s%s%s since ", i ? ";" : "",
            change[i].program ? "program" : "", and, change[i].recipe ? "recipe" : "",
            change[i].recipe && change[i].model ? ", " : "",
            change[i].model ? "model of the scanner" : "");
    write_point(p, change[i].point);
  }
  fputs(".", p->out);
}

static void write_caption(const page *p) {
  const fg_trend *trend = p->trend;
  const fg_tolerance *tolerance = trend->quantity.tolerance;
  const char *unit = p->choice->row->unit;
  fprintf(p->out, "<p class=\"note\">%zu %s, from ", trend->count, things(p->choice));
  write_point(p, 0);
  fputs(", ", p->out);
  fg_page_time_zoned(p->out, time_of(p, 0));
  fputs(", to ", p->out);
  write_point(p, trend->count - 1);
  fputs(", ", p->out);
  fg_page_time_zoned(p->out, time_of(p, trend->count - 1));
  if (p->choice->by_lots)
    fprintf(p->out,
            ". Dashed blue: the chart's limits, three sigma of a lot's mean from the mean, by what "
            "foils vary within lots (σ %.3g%s%s).",
            trend->quantity.means.sigma, unit[0] ? " " : "", unit);
  else
    fprintf(p->out,
            ". Dashed blue: the chart's limits, three sigma from the mean, by what varies from one "
            "foil to the next (σ %.3g%s%s).",
            trend->quantity.chart.sigma, unit[0] ? " " : "", unit);
  if (tolerance)
    fprintf(p->out, " Red: beyond the tolerance of the %s (%s).",
            trend->mixed ? "newest foil's recipe" : "design",
            p->choice->owner == FG_QUANTITY_OF_BUMP && !p->choice->bump
                ? "which each bump must keep; the chart is of means"
                : "a limit that is far off is not drawn");
  else
    fputs(" The design states no tolerance for it.", p->out);
  write_changes(p);
  fputs("</p>\n", p->out);
}

/* "nine in a row on one side of the centre: since 0123 (no. 17)". */
static void write_run(const page *p, const fg_trend_run *run) {
  bool lasts = run->last + 1 == p->trend->count, single = run->first == run->last;
  fprintf(p->out, "<li value=\"%zu\"><b>%s</b>: ", run->mark, fg_run_rule_words(run->rule));
  fputs(single ? "" : lasts ? "since " : "from ", p->out);
  write_point(p, run->first);
  if (!single && !lasts) {
    fputs(" to ", p->out);
    write_point(p, run->last);
  }
  fputs("</li>\n", p->out);
}

static void write_runs(const page *p, const fg_trend_run *runs, size_t count, size_t all) {
  fputs("<h2>Signals</h2>\n", p->out);
  if (!count) {
    fprintf(p->out,
            "<p class=\"next calm\">None: these %s vary as they would by chance alone.</p>\n",
            things(p->choice));
    return;
  }
  fprintf(p->out,
          "<p class=\"next\">Look for what was new then (die, coil, press, operator, scanner). By "
          "chance alone a steady process has %.2g points with a signal in %zu %s.</p>\n"
          "<ol class=\"runs\">",
          fg_chart_chance_signals(p->trend->count, p->station->settings->lot.run_rules),
          p->trend->count, things(p->choice));
  for (size_t i = 0; i < count; i++)
    write_run(p, &runs[i]);
  fputs("</ol>\n", p->out);
  if (all > count) fprintf(p->out, "<p class=\"note\">and %zu earlier ones</p>\n", all - count);
}

static void write_ratio(FILE *out, const char *name, const fg_ratio *ratio, const char *words) {
  if (!isfinite(ratio->value)) return;
  char text[80];
  if (isfinite(ratio->low) && isfinite(ratio->high))
    snprintf(text, sizeof text, "%.2f<small>%.2f to %.2f</small>", ratio->value, ratio->low,
             ratio->high);
  else
    snprintf(text, sizeof text, "%.2f", ratio->value);
  fg_html_tile(out, &(fg_tile){name, .text = text, .small = words});
}

static void write_withheld_reasons(const page *p) {
  const fg_lot_quantity *quantity = &p->trend->quantity;
  FILE *out = p->out;
  fputs("<p class=\"next\">Not stated: ", out);
  if (!quantity->tolerance)
    fputs("the design has no tolerance for this quantity.", out);
  else if (p->trend->shift)
    fputs("accepted causes move the process within these foils: choose a range without them.", out);
  else if (p->choice->by_lots)
    fputs("it is a matter of single foils: choose \"Over: foils\".", out);
  else if (p->trend->mixed)
    fputs("these foils were measured by more than one recipe, which may have other tolerances: "
          "choose a range or a lot of one.",
          out);
  else if (p->trend->count < STABLE_MIN)
    fprintf(out, "%zu foil%s: too few to say that the process is stable; it takes %d.",
            p->trend->count, fg_plural(p->trend->count), STABLE_MIN);
  else if (quantity->chance.outliers)
    fprintf(out,
            "the chart is not stable: %zu %s farther out than chance explains (level %d %%). Find "
            "the cause, or choose a range without %s with limits of its own.",
            quantity->chance.outliers, quantity->chance.outliers == 1 ? "point lies" : "points lie",
            FG_LOT_CHART_LEVEL_PCT, quantity->chance.outliers == 1 ? "it" : "them");
  else if (!quantity->chance.steady)
    fprintf(out,
            "the chart is not stable (%zu %s with a signal; chance explains up to %zu, level %d "
            "%%). What a process will do can be said "
            "when it is stable; find the causes of the signals first, or choose a range after the "
            "last of them with limits of its own.",
            quantity->chart.signals, quantity->chart.signals == 1 ? "point" : "points",
            quantity->chance.max, FG_LOT_CHART_LEVEL_PCT);
  else if (!quantity->stable)
    fprintf(out,
            "the spread within foils is not stable: it leaves its limits at %zu %s, more or "
            "farther than chance explains (level %d %%).",
            quantity->deviations.signals, quantity->deviations.signals == 1 ? "foil" : "foils",
            FG_LOT_CHART_LEVEL_PCT);
  else
    fputs("the values do not differ.", out);
  fputs("</p>\n", out);
}

/* Says why signals withhold nothing. */
static void write_chance_signals(const page *p) {
  const fg_lot_quantity *quantity = &p->trend->quantity;
  size_t signals = quantity->chart.signals;
  if (signals)
    fprintf(p->out,
            "<p class=\"note\">Stated although %zu %s a signal: chance explains up to %zu in %zu "
            "foils (level %d %%), and no point lies farther out than by chance.</p>\n",
            signals, signals == 1 ? "point has" : "points have", quantity->chance.max,
            p->trend->count, FG_LOT_CHART_LEVEL_PCT);
}

static void write_capability(const page *p) {
  const fg_lot_quantity *quantity = &p->trend->quantity;
  const fg_capability *capability = &quantity->capability;
  FILE *out = p->out;
  fputs("<h2>Capability</h2>\n", out);
  if (p->choice->by_lots || !quantity->has_capability || !quantity->stable || p->trend->shift ||
      p->trend->count < STABLE_MIN) {
    write_withheld_reasons(p);
    return;
  }
  fputs("<dl class=\"tiles\">", out);
  write_ratio(out, "Cpk", &capability->ck, "what the process will do");
  write_ratio(out, "Cp", &capability->c, "if it were centred");
  write_ratio(out, "Ppk", &capability->pk, "what it did");
  fprintf(out,
          "</dl>\n<p class=\"note\">Intervals at %.4g %%; of %zu values of %zu foils against %.6g "
          "to %.6g.%s</p>\n",
          100 * p->station->settings->lot.confidence, capability->count, p->trend->count,
          quantity->tolerance->lower, quantity->tolerance->upper,
          capability->normal ? ""
                             : " The values are not normally distributed: Cp and Cpk say less "
                               "of how many will be beyond.");
  if (!isfinite(capability->pk.low))
    fputs(
        "<p class=\"note\">Ppk and Cpk have no interval: nothing is known of the scanner's scale, "
        "whose error moves all foils alike. Calibrate it.</p>\n",
        out);
  write_chance_signals(p);
}

/* The columns of the database are searched for a cause. */
static void write_ask_why(const page *p) {
  fputs("<form class=\"fields noprint\" method=\"post\" action=\"/why\">", p->out);
  fg_page_csrf_token(p->station, p->out);
  fg_trend_write_hidden(p->out, p->choice);
  fputs("<button>Why?</button></form>\n", p->out);
}

static fg_status write_chart(fg_context *ctx, const page *p) {
  fg_trend_run runs[FG_TREND_RUNS];
  size_t all, count = fg_trend_runs(p->trend, runs, &all);
  write_controls(p);
  for (int narrow = 0; narrow < 2; narrow++)
    fg_trend_plot(p->out, p->reader, p->trend, runs, count, narrow);
  write_range_html_form(p);
  write_caption(p);
  write_runs(p, runs, count, all);
  if (!p->choice->by_lots) write_ask_why(p);
  FG_TRY(fg_page_causes(ctx, p->station, p->reader, p->choice, p->out));
  write_capability(p);
  return FG_OK;
}

static void write_title(const page *p) {
  const fg_trend_choice *choice = p->choice;
  fputs("<h1>", p->out);
  if (choice->bump) fprintf(p->out, "Bump %d: ", choice->bump);
  fg_html_text(p->out, choice->row->words);
  if (choice->lot[0]) fg_html_name((fputs(", lot ", p->out), p->out), choice->lot);
  if (choice->die[0]) fg_html_name((fputs(", die ", p->out), p->out), choice->die);
  fputs("</h1>\n", p->out);
}

static fg_status write_trend(fg_context *ctx, const page *p) {
  write_title(p);
  FG_TRY(fg_trend_write_html_form(ctx, p->station, p->reader, p->choice, p->out));
  if (p->trend->quantity.has_chart) return write_chart(ctx, p);
  if (p->choice->by_lots)
    fprintf(p->out,
            "<p class=\"next\">%zu %s: a chart of lots needs two, one of them with two foils at "
            "least.</p>\n",
            p->trend->total, p->trend->total == 1 ? "lot" : "lots");
  else
    fprintf(p->out, "<p class=\"next\">%zu %s with this quantity: a chart needs two.</p>\n",
            p->trend->total, p->trend->total == 1 ? "foil" : "foils");
  return FG_OK;
}

fg_status fg_page_trends(fg_context *ctx, fg_inspection *station, sqlite3 *reader,
                         const fg_request *request, FILE *out) {
  fg_trend_choice choice;
  fg_trend trend;
  FG_TRY(fg_trend_choose(ctx, station, request, &choice));
  FG_TRY(fg_trend_read(ctx, station, reader, &choice, &trend));
  const page p = {out, reader, station, &trend, &choice};
  fg_status status = fg_page_begin(ctx, station, reader, out, FG_TAB_TRENDS, "Trends");
  if (status == FG_OK) {
    fputs("<script src=\"/trends.js\" defer></script>\n<section>\n", out);
    status = write_trend(ctx, &p);
    fputs("</section>\n", out);
    fg_page_end(out);
  }
  fg_trend_free(&trend);
  return status;
}
