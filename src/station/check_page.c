/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/check_page.h"

#include <math.h>

#include "page/page.h"
#include "station/check_state.h"
#include "station/pages.h"

/* The newest check. */
typedef struct newest_check {
  int64_t id;
  bool passed, baseline, changed;
  fg_check_state state;
} newest_check;

static fg_status read_newest(fg_context *ctx, sqlite3 *reader, newest_check *newest) {
  fg_query query;
  *newest = (newest_check){.id = 0};
  fg_query_begin(reader,
                 "SELECT id, verdict = 'pass', baseline, changes <> '' FROM checks"
                 " WHERE dpi IS NOT NULL AND id = (SELECT max(id) FROM checks)",
                 &query);
  if (fg_query_row(&query)) {
    newest->id = fg_query_get_integer(&query, 0);
    newest->passed = fg_query_get_integer(&query, 1) != 0;
    newest->baseline = fg_query_get_integer(&query, 2) != 0;
    newest->changed = fg_query_get_integer(&query, 3) != 0;
  }
  FG_TRY(fg_query_end(ctx, &query, "reading the checks"));
  return newest->id ? fg_check_state_load(ctx, reader, newest->id, &newest->state) : FG_OK;
}

static void write_state_value(FILE *out, const fg_check_quantity *row, const fg_check_state *state,
                              size_t k) {
  fprintf(out, "<td>%.*f ± %.*f</td>", row->decimals, state->value[k], row->decimals,
          2 * state->u[k]);
}

static void write_state_row(FILE *out, size_t k, const fg_check_state *state,
                            const fg_check_state *baseline) {
  const fg_check_quantity *row = &fg_check_quantities[k];
  if (isnan(state->value[k])) return;
  double allowed = fg_check_state_allowed(state, baseline, k);
  double change = state->value[k] - baseline->value[k];
  fputs("<tr><td>", out);
  fg_html_text(out, row->words);
  fprintf(out, "%s%s</td>", row->unit[0] ? ", " : "", row->unit);
  write_state_value(out, row, state, k);
  if (isnan(baseline->value[k])) {
    fputs("<td></td><td></td><td></td><td></td></tr>\n", out);
    return;
  }
  write_state_value(out, row, baseline, k);
  bool changed = fabs(change) > allowed;
  fprintf(out, "<td>%s%+.*f%s</td><td>± %.*f</td><td class=\"words\">%s</td></tr>\n",
          changed ? "<b>" : "", row->decimals, change, changed ? "</b>" : "", row->decimals,
          allowed, row->cause);
}

static void write_findings(FILE *out, unsigned findings) {
  for (const fg_picture_words *found = fg_picture_finding_words(); found->name; found++) {
    if (!(findings & found->finding)) continue;
    fprintf(out, "<p class=\"note\"><b>%s</b> ", found->name);
    fg_html_text(out, found->meaning);
    fputc(' ', out);
    fg_html_text(out, found->cure);
    fputs("</p>\n", out);
  }
}

static void write_accept(const fg_inspection *station, FILE *out, int64_t id) {
  fputs("<form class=\"fields noprint\" method=\"post\" action=\"/baseline\">", out);
  fg_page_csrf_token(station, out);
  fprintf(out,
          "<input type=\"hidden\" name=\"id\" value=\"%lld\"><button>Take this check as the new "
          "baseline</button></form>\n",
          (long long)id);
}

fg_status fg_page_scanner_state(fg_context *ctx, const fg_inspection *station, sqlite3 *reader,
                                FILE *out) {
  newest_check newest;
  fg_check_state baseline;
  int64_t at;
  FG_TRY(read_newest(ctx, reader, &newest));
  if (!newest.id) return FG_OK;
  FG_TRY(fg_check_state_baseline(ctx, reader, newest.state.dpi, &at, &baseline));
  if (!at) baseline = newest.state;
  fprintf(out, "<h2>Tone, sharpening and blur at %lld dpi</h2>\n<p class=\"note\">",
          (long long)newest.state.dpi);
  if (at) {
    fputs(newest.baseline ? "This check is the baseline, " : "Against the baseline of ", out);
    fg_page_time(out, at);
    fputs(". A change counts beyond three standard deviations over the glass, and beyond what "
          "matters: half a micrometre of a strip's thickness.",
          out);
  } else {
    fputs("There is no baseline yet: the first check with scale and shear as allowed becomes it.",
          out);
  }
  fputs("</p>\n<table><thead><tr><th></th><th>now</th><th>baseline</th><th>change</th><th>allowed</"
        "th>"
        "<th class=\"words\">what changes it</th></tr></thead><tbody>\n",
        out);
  for (size_t k = 0; k < FG_CHECK_QUANTITIES; k++)
    write_state_row(out, k, &newest.state, &baseline);
  fputs("</tbody></table>\n", out);
  write_findings(out, newest.state.findings);
  if (newest.changed && newest.passed) write_accept(station, out, newest.id);
  return FG_OK;
}
