/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/check_page.h"

#include <math.h>

#include "page/page.h"
#include "page/table.h"
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

/* The newest state against the baseline: the subject's index is the quantity's. */
typedef struct compared_states {
  const fg_check_state *now, *baseline;
} compared_states;

static const fg_check_quantity *quantity_of(const fg_subject *s) {
  return &fg_check_quantities[s->index];
}

static const char *find_quantity_words(const fg_subject *s, char *buffer) {
  const fg_check_quantity *row = quantity_of(s);
  snprintf(buffer, FG_MEMBER_TEXT_MAX, "%s%s%s", row->words, row->unit[0] ? ", " : "", row->unit);
  return buffer;
}

/* True where a value that is written with these decimals is below 0, and not 0. */
static bool is_negative(double value, int decimals) {
  return value <= -0.5 * pow(10, -decimals);
}

static const char *show_state(const fg_subject *s, const fg_check_state *state, char *buffer) {
  int decimals = quantity_of(s)->decimals;
  double value = state->value[s->index];
  snprintf(buffer, 80, "%s%.*f ± %.*f", is_negative(value, decimals) ? "−" : "", decimals,
           fabs(value), decimals, 2 * state->u[s->index]);
  return buffer;
}

static const char *find_now(const fg_subject *s, char *buffer) {
  return show_state(s, ((const compared_states *)s->object)->now, buffer);
}

static bool has_baseline(const fg_subject *s) {
  return !isnan(((const compared_states *)s->object)->baseline->value[s->index]);
}

static const char *find_baseline(const fg_subject *s, char *buffer) {
  if (!has_baseline(s)) return "";
  return show_state(s, ((const compared_states *)s->object)->baseline, buffer);
}

static double allowed_of(const fg_subject *s) {
  const compared_states *states = s->object;
  return fg_check_state_allowed(states->now, states->baseline, s->index);
}

static void write_state_change(FILE *out, const fg_subject *s) {
  const compared_states *states = s->object;
  if (!has_baseline(s)) return;
  double change = states->now->value[s->index] - states->baseline->value[s->index];
  bool changed = fabs(change) > allowed_of(s);
  int decimals = quantity_of(s)->decimals;
  const char *sign = is_negative(change, decimals)    ? "−"
                     : is_negative(-change, decimals) ? "+"
                                                      : "";
  fprintf(out, changed ? "<b>%s%.*f</b>" : "%s%.*f", sign, decimals, fabs(change));
}

static const char *find_allowed(const fg_subject *s, char *buffer) {
  if (!has_baseline(s)) return "";
  snprintf(buffer, 80, "± %.*f", quantity_of(s)->decimals, allowed_of(s));
  return buffer;
}

static const char *find_cause(const fg_subject *s, char *buffer) {
  (void)buffer;
  return has_baseline(s) ? quantity_of(s)->cause : "";
}

static const fg_member state_rows[] = {
    {FG_TEXT_BY("quantity", find_quantity_words), .page = {.rank = 1, .heading = ""}},
    {FG_TEXT_BY("now", find_now), .page = {.rank = 1, .heading = "now"}},
    {FG_TEXT_BY("baseline", find_baseline), .page = {.rank = 1, .heading = "baseline"}},
    {FG_TEXT_BY("change", NULL), .markup = write_state_change,
     .page = {.rank = 1, .heading = "change"}},
    {FG_TEXT_BY("allowed", find_allowed), .page = {.rank = 1, .heading = "allowed"}},
    {FG_TEXT_BY("cause", find_cause),
     .page = {.rank = 1, .heading = "what changes it", .words = true}},
};
static const fg_members state_members = FG_MEMBERS(state_rows);

static bool find_compared(const fg_subject *list, size_t k, fg_subject *element) {
  const compared_states *states = list->object;
  if (k >= FG_CHECK_QUANTITIES) return false;
  element->object = isnan(states->now->value[k]) ? NULL : states;
  return true;
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
  fputs("</p>\n", out);
  const compared_states states = {&newest.state, &baseline};
  fg_html_table(out, &state_members, &(fg_subject){.object = &states}, find_compared);
  write_findings(out, newest.state.findings);
  if (newest.changed && newest.passed) write_accept(station, out, newest.id);
  return FG_OK;
}
