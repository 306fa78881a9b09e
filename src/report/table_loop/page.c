/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Page of the loop on tables: the sentence; the residual before and after, over the coordinate that
 * explains it, with the effect, held-out rows marked; errors; candidates and verdicts. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/loop.h"
#include "foilgauge/loop_table.h"
#include "page/page.h"
#include "page/table.h"
#include "report/provenance.h"
#include "report/table_loop/claim_members.h"
#include "report/table_loop/family_members.h"
#include "report/table_loop/influence_members.h"
#include "report/table_loop/next.h"
#include "report/table_loop/plots.h"
#include "report/table_loop/scale_members.h"
#include "report/table_loop/suspect_members.h"

static const char style[] =
    "dl.facts{display:grid;grid-template-columns:max-content 1fr;gap:2px 16px;margin:0;"
    "font-size:13.5px}dl.facts dt{color:var(--soft)}dl.facts dd{margin:0;overflow-wrap:anywhere}"
    ":root{--ink:#16202a;--soft:#5b6875;--line:#dfe4e9;--ground:#f4f6f8;--good:#12804a;"
    "--bad:#c62828;--open:#a86400;--bump:#d95f02;--blue:#1f6fd0}*{box-sizing:border-box}"
    "body{margin:0;background:var(--ground);color:var(--ink);font:15px/1.5 system-ui,"
    "\"Segoe UI\",Roboto,Arial,\"DejaVu Sans\",sans-serif}"
    "main{max-width:1120px;margin:0 auto;padding:20px 16px 48px}"
    "section{background:#fff;border:1px solid var(--line);border-radius:12px;padding:22px 24px;"
    "margin-bottom:24px}h1{font-size:24px;margin:0 0 4px}h2{font-size:17px;margin:0 0 10px}"
    ".verdict{display:inline-block;font-weight:650;padding:4px 14px;border-radius:99px;"
    "color:#fff;background:var(--soft)}.clean{background:var(--good)}.explained,.partly{background:"
    "var(--open)}.unattributed{background:var(--bad)}.clean::before{content:\"✓ \"}"
    ".explained::before,.partly::before{content:\"! "
    "\"}.unattributed::before,.suspected::before{content:\"? "
    "\"}.mean{font-weight:650;font-size:18px;"
    "margin:0 0 0 10px}.say{font-size:17px;max-width:84ch;margin:14px 0 0}.next{margin-top:14px;"
    "border-left:6px solid var(--open);background:#fff8e8;border-radius:0 8px 8px 0;padding:10px "
    "14px;max-width:84ch}.clean~.next{border-left-color:var(--good);background:#edf7f1}.next "
    "b{display:block}"
    ".next ul{margin:2px 0 "
    "0;padding-left:18px}.no{color:var(--bad);font-weight:650}.soft{color:var(--soft);font-size:13."
    "5px}"
    ".pair{display:grid;grid-template-columns:repeat(auto-fit,minmax(300px,1fr));gap:14px}"
    "figure{margin:0;max-width:540px}figcaption{font-size:13px;color:var(--soft)}"
    ".plot{display:block;width:100%;height:auto;font-size:13px}.plot text{fill:var(--ink)}"
    ".x,.t{text-anchor:middle}.y{text-anchor:end}.plot .t{fill:var(--soft)}"
    ".grid{stroke:#e6eaee}.zero{stroke:#8a96a1}.plot path{fill:none}"
    ".fit{fill:var(--blue);fill-opacity:.75}.held{fill:#fff;stroke:var(--bump);stroke-width:2}"
    ".effect{stroke:var(--bump);stroke-width:2.5}.mark{fill:var(--bump)}.l{text-anchor:start}"
    ".plot "
    "path.band{fill:var(--bump);fill-opacity:.16;stroke:var(--bump)}.joined{stroke:var(--blue)"
    ";stroke-opacity:.5}small{color:var(--soft);font-weight:400;font-size:12px}"
    ".scroll{overflow-x:auto}table{border-collapse:collapse;width:100%;font-size:13.5px;"
    "font-variant-numeric:tabular-nums}th,td{padding:5px 10px;text-align:right;"
    "border-bottom:1px solid var(--line)}th{color:var(--soft);font-weight:600}"
    "th:first-child,td:first-child,th.w,td.words{text-align:left}td:not([class]){white-space:"
    "nowrap}td.claimed{font-weight:650}"
    "td small{display:block;overflow-wrap:anywhere}td:first-child{min-width:13em}"
    "ul{margin:6px 0 0;padding-left:22px}@media(max-width:600px){main{padding:8px}section{padding:"
    "14px}.pair{grid-template-columns:1fr}.plot{font-size:16px}}"
    "section>:last-child{margin-bottom:0}"
    "@media print{body{background:#fff;font-size:13px}main{padding:0}section{border:0;padding:4px "
    "0;margin:0 0 6px;break-inside:avoid}section.long{break-inside:auto}tr,figure,li,p{"
    "break-inside:avoid}h2,thead,.key,.long tr:nth-child(-n+3){break-after:avoid}.long "
    "tr:nth-last-child(-n+2){break-before:avoid}.scroll{overflow:visible}table{font-size:12px}"
    "td,th{padding:2px 6px}.say,.mean{font-size:15px}.soft{font-size:12px}.plot{font-size:14px}"
    "*{print-color-adjust:exact;-webkit-print-color-adjust:exact}}";

static void put_table_errors(FILE *out, const fg_loop_report *report) {
  const fg_loop_result *result = report->result;
  fg_loop_error_row row[FG_LOOP_ERROR_ROWS];
  const fg_subject list = {row, report, fg_loop_error_rows(report, row)};
  bool after = fg_loop_has_after(result);
  fprintf(out, "<section><h2>%s</h2>",
          after ? "Error before and after" : "Error of the declared model");
  fg_html_table(out, &fg_loop_error_row_members, &list, fg_loop_find_error);
  fputs("<p class=\"soft\">", out);
  if (fg_loop_claims_scatter(result, FG_LOOP_SERIAL))
    fputs("After: each row predicted from the one before it. ", out);
  fprintf(out, "The noise of one row has a standard deviation of %s",
          fg_loop_number_text("%.4g", result->noise_floor).text);
  if (result->noise.rho > 0) fprintf(out, "; neighbours correlate by %.2f", result->noise.rho);
  if (result->noise.lambda > 0)
    fprintf(out, "; between groups the variance is %.2g times that within", result->noise.lambda);
  if (after)
    fprintf(out, ". With 95 %% confidence the ratio of the rms lies between %.3f and %.3f",
            result->ratio_interval[0], result->ratio_interval[1]);
  fputs(".</p></section>\n", out);
}

/* The tests of the whole residual. */
static void put_residual_tests(FILE *out, const fg_loop_report *report) {
  const fg_loop_checked *check = report->result->check;
  double level = 0;
  for (size_t k = 0; k < FG_LOOP_CHECKS; k++)
    level = fmax(level, check[k].done ? check[k].level : 0);
  if (!(level > 0)) return;
  fputs("<section><h2>Is what is left only noise?</h2>", out);
  fg_html_table(out, &fg_loop_check_members, &(fg_subject){report, report, 0}, fg_loop_find_check);
  fprintf(out,
          "<p class=\"soft\">No: p below %.2g. Not sure: p up to 0.1. Effects that were looked for by "
          "name (serial correlation, cycles, changing scatter, outliers and more) are listed "
          "below.</p></section>\n",
          level);
}

static void put_candidates(FILE *out, const fg_loop_report *report) {
  const fg_loop_result *result = report->result;
  fg_subject subject = {report, report, 0};
  fg_member_columns claimed, rejected;
  char shares[FG_LOOP_WORDS];
  if (!result->claims && !result->rejects) return;
  fg_member_columns_of(&fg_loop_claim_members, FG_ON_PAGE, &subject, &claimed);
  fg_member_columns_of(&fg_loop_rejected_members, FG_ON_PAGE, &subject, &rejected);
  fputs("<section class=\"long\"><h2>All that was looked for</h2><p class=\"soft key\">Absent: "
        "it would have shown at the size that matters. Inconclusive: only a larger one would "
        "have. In the model already: the declared model takes it up. Of the error rate each kind "
        "has its share, whatever the number of its candidates: ",
        out);
  fg_loop_shares_words(result, shares);
  fprintf(out, "%s.</p>", shares);
  fg_html_table_begin(out, &claimed);
  fg_html_table_rows(out);
  for (size_t i = 0; i < result->claims + result->rejects; i++) {
    bool claim = i < result->claims;
    subject.object =
        claim ? (const void *)&result->claim[i] : &result->rejected[i - result->claims];
    fg_html_table_row(out, claim ? &claimed : &rejected, &subject);
    fputs("</tr>\n", out);
  }
  fg_html_table_end(out);
  fputs("</section>\n", out);
}

static void put_note(FILE *out, const char *words) {
  fputs("<li>", out);
  fg_html_text(out, words);
  fputs("</li>\n", out);
}

static void put_notes(FILE *out, const fg_loop_report *report) {
  const fg_loop_result *result = report->result;
  if (!result->notes && !report->problem->excluded && !report->said && !result->influences &&
      !fg_loop_tells_scale(result))
    return;
  fputs("<section><h2>What else to know</h2><ul>\n", out);
  if (report->said) put_note(out, report->said);
  if (fg_loop_tells_scale(result)) {
    char words[FG_LOOP_WORDS];
    fg_loop_scale_words(report, words);
    put_note(out, words);
  }
  for (size_t i = 0; i < result->influences; i++) {
    char words[FG_LOOP_WORDS];
    fg_loop_influence_words(report, &result->influence[i], words);
    put_note(out, words);
  }
  for (size_t i = 0; i < result->notes; i++)
    put_note(out, result->note[i]);
  if (report->problem->excluded) {
    fputs("<li>Columns that are no candidates: ", out);
    fg_html_text(out, report->problem->excluded);
    fputs("</li>\n", out);
  }
  fputs("</ul></section>\n", out);
}

static void put_next(FILE *out, const fg_loop_report *report) {
  char step[FG_LOOP_STEP];
  fputs("<div class=\"next\"><b>What to do next</b><ul>\n", out);
  for (size_t i = 0; i < fg_loop_next_count(report); i++) {
    fg_loop_next_step(report, i, step);
    fputs("<li>", out);
    fg_html_text(out, step);
    fputs("</li>\n", out);
  }
  fputs("</ul></div>", out);
}

static void put_suspects(FILE *out, const fg_loop_report *report) {
  if (!report->result->suspects) return;
  fputs("<section><h2>Suspected, not proven</h2>", out);
  fg_html_table(out, &fg_loop_suspect_members, &(fg_subject){report, report, 0},
                fg_loop_find_suspect);
  fputs(
      "<p class=\"soft\">p alone: had only this been asked for. p of all that was tried: noise "
      "alone shows something as clear in that share of such tables; below 0.01, and with a smaller "
      "error of rows that are left out, it would be proven.</p></section>\n",
      out);
}

static void put_table_head(FILE *out, const fg_loop_report *report, const char *sentence) {
  static const char *const classes[] = {"clean", "explained", "partly", "unattributed",
                                        "suspected"};
  fg_loop_check check;
  bool suspected = fg_loop_suspects_residual(report->result, &check);
  fg_html_head(out, "Closing the loop");
  fprintf(out, "<style>%s</style></head><body><main><section><h1>", style);
  fg_html_text(out, report->spec->response);
  fputs("</h1><p class=\"soft\">", out);
  fg_html_text(out, report->path);
  fputs(", declared model: ", out);
  if (!strchr(report->spec->model, '~') && strcmp(report->spec->model, "arc_length") != 0) {
    fg_html_text(out, report->spec->response);
    fputs(" ~ ", out);
  }
  fg_html_text(out, report->spec->model);
  if (report->spec->offset) {
    fputs(" + offset(", out);
    fg_html_text(out, report->spec->offset);
    fputc(')', out);
  }
  fprintf(out,
          "; %zu rows</p><span class=\"verdict %s\">%s</span><span class=\"mean\">%s</span><p "
          "class=\"say\">",
          report->problem->problem.rows, suspected ? "suspected" : classes[report->result->verdict],
          fg_loop_outcome_word(report->result->verdict), fg_loop_outcome_meaning(report->result));
  fg_html_text(out, sentence);
  fputs("</p>", out);
  put_next(out, report);
  fputs("</section>\n", out);
}

fg_status fg_loop_write_html(fg_context *ctx, const fg_loop_report *report, FILE *out) {
  char *sentence = NULL;
  FG_TRY(fg_loop_sentence(ctx, report, &sentence));
  put_table_head(out, report, sentence);
  free(sentence);
  put_suspects(out, report);
  FG_TRY(fg_loop_plots_put(ctx, out, report));
  put_table_errors(out, report);
  put_residual_tests(out, report);
  put_notes(out, report);
  put_candidates(out, report);
  fg_provenance from = {.of_scans = false};
  fg_provenance_include_file(&from, report->path);
  FG_TRY(fg_html_provenance_section(ctx, out, &from));
  fputs("</main></body></html>\n", out);
  return fg_stream_finish(ctx, out, "the loop's page");
}
