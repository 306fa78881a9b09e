/* The loop's page: the sentence, the residual before and after over the coordinate that explains
 * it, with the effect drawn over it, kept-aside rows apart; errors; candidates and verdicts. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/loop.h"
#include "report/measure/measure_page_parts.h"
#include "report/table_loop/loop_plots.h"
#include "report/table_loop/loop_words.h"

static const char style[] =
    ":root{--ink:#16202a;--soft:#5b6875;--line:#dfe4e9;--ground:#f4f6f8;--good:#12804a;"
    "--bad:#c62828;--open:#a86400;--bump:#d95f02;--blue:#1f6fd0}*{box-sizing:border-box}"
    "body{margin:0;background:var(--ground);color:var(--ink);font:15px/1.5 system-ui,"
    "\"Segoe UI\",Roboto,Arial,\"DejaVu Sans\",sans-serif}"
    "main{max-width:1120px;margin:0 auto;padding:20px 16px 48px}"
    "section{background:#fff;border:1px solid var(--line);border-radius:12px;padding:22px 24px;"
    "margin-bottom:24px}h1{font-size:24px;margin:0 0 4px}h2{font-size:17px;margin:0 0 10px}"
    ".verdict{display:inline-block;font-weight:650;padding:4px 14px;border-radius:99px;"
    "color:#fff;background:var(--soft)}.clean{background:var(--good)}.explained{background:"
    "var(--blue)}.partly,.unattributed{background:var(--open)}"
    ".say{font-size:18px;max-width:80ch;margin:14px 0 4px}.soft{color:var(--soft);font-size:13.5px}"
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
    "th:first-child,td:first-child,th.w,td.w{text-align:left}td:first-child{overflow-wrap:anywhere}"
    "ul{margin:6px 0 0;padding-left:22px}@media(max-width:600px){main{padding:8px}section{padding:"
    "14px}.pair{grid-template-columns:1fr}.plot{font-size:16px}}"
    "@media print{body{background:#fff}main{padding:0}section{border:0;padding:6px 0;margin:0 0 "
    "8px;"
    "break-inside:avoid}section.long{break-inside:auto}tr,figure{break-inside:avoid}}";

/* A number, or a dash where there is none. */
static void put_number(FILE *out, const char *format, double value) {
  if (isfinite(value))
    fprintf(out, format, value);
  else
    fputs("–", out);
}

static void put_error(FILE *out, const char *name, double before, double after) {
  if (!isfinite(before)) return;
  fprintf(out, "<tr><td>%s</td><td>%.4g</td><td>", name, before);
  put_number(out, "%.4g", after);
  fputs("</td><td>", out);
  put_number(out, "%.3f", after / before);
  fputs("</td></tr>\n", out);
}

static void put_errors(FILE *out, const fg_loop_result *result) {
  const fg_loop_error *before = &result->before, *after = &result->after;
  fputs("<section><h2>Error before and after</h2><div class=\"scroll\"><table><tr><th>error</th>"
        "<th>before</th><th>after</th><th>ratio</th></tr>\n",
        out);
  put_error(out, "rms", before->rms, after->rms);
  put_error(out, "robust sd", before->robust_sd, after->robust_sd);
  put_error(out, "95th percentile", before->p95, after->p95);
  put_error(out, "maximum", before->maximum, after->maximum);
  put_error(out, "rows that took no part in the search, rms", before->held_out_rms,
            after->held_out_rms);
  put_error(out, "each group predicted from the others, rms", before->cross_validated_rms,
            after->cross_validated_rms);
  fputs("</table></div><p class=\"soft\">Noise floor ", out);
  put_number(out, "%.4g", result->noise_floor);
  if (result->noise.rho > 0) fprintf(out, ", correlation along the order %.2f", result->noise.rho);
  if (result->noise.lambda > 0)
    fprintf(out, ", variance between groups %.2g times that within", result->noise.lambda);
  fprintf(out, ". 95 %% interval of the ratio: %.3f to %.3f.</p></section>\n",
          result->ratio_interval[0], result->ratio_interval[1]);
}

/* Words first, the id small. */
static void put_name(FILE *out, const char *words, const char *id) {
  fg_html_text(out, words);
  fputs(" <small>", out);
  fg_html_text(out, id);
  fputs("</small>", out);
}

static void put_claim_row(FILE *out, const fg_loop_report *report, const fg_loop_claim *claim) {
  char words[2 * FG_LOOP_WORDS], size[FG_LOOP_NAME];
  fg_loop_claim_words(report, claim, words);
  fg_loop_claim_size(claim, size);
  fputs("<tr><td>", out);
  put_name(out, words, claim->name);
  fprintf(out, "</td><td class=\"w\"><b>%s</b></td><td>%s</td><td>%.2g</td><td class=\"w\">",
          fg_loop_verdict_word(claim->verdict), size, claim->p_value);
  for (size_t k = 0; k < claim->aliases; k++) {
    fputs(k ? ";<br>" : "", out);
    fg_loop_alias_words(report, &claim->alias[k], words);
    put_name(out, words, claim->alias[k].name);
  }
  fputs("</td></tr>\n", out);
}

static void put_candidates(FILE *out, const fg_loop_report *report) {
  const fg_loop_result *result = report->result;
  char words[FG_LOOP_WORDS];
  fputs("<section class=\"long\"><h2>All that was looked for</h2><div class=\"scroll\"><table><tr>"
        "<th>effect</th><th class=\"w\">verdict</th><th>size, or what would have shown</th>"
        "<th>p</th><th class=\"w\">could also be</th></tr>\n",
        out);
  for (size_t i = 0; i < result->claims; i++)
    put_claim_row(out, report, &result->claim[i]);
  for (size_t i = 0; i < result->rejects; i++) {
    const fg_loop_rejected *one = &result->rejected[i];
    fg_loop_candidate_words(report, &one->candidate, words);
    fputs("<tr><td>", out);
    put_name(out, words, one->name);
    fprintf(out, "</td><td class=\"w\">%s</td><td>", fg_loop_rejected_word(one));
    put_number(out, "≥ %.3g", one->smallest_detectable);
    fputs("</td><td>", out);
    put_number(out, "%.2g", one->p_value);
    fputs("</td><td></td></tr>\n", out);
  }
  fputs("</table></div></section>\n", out);
}

static void put_advice(FILE *out, const fg_loop_report *report) {
  const fg_loop_result *result = report->result;
  if (!result->advices && !result->notes && !report->problem->excluded && !report->said) return;
  fputs("<section><h2>What to know, and to do next</h2><ul>\n", out);
  for (size_t i = 0; i < result->advices; i++) {
    fputs("<li>", out);
    fg_html_text(out, result->advice[i].text);
    fputs("</li>\n", out);
  }
  if (report->said) {
    fputs("<li>", out);
    fg_html_text(out, report->said);
    fputs("</li>\n", out);
  }
  for (size_t i = 0; i < result->notes; i++) {
    fputs("<li>", out);
    fg_html_text(out, result->note[i]);
    fputs("</li>\n", out);
  }
  if (report->problem->excluded) {
    fputs("<li>Columns that are no candidates: ", out);
    fg_html_text(out, report->problem->excluded);
    fputs("</li>\n", out);
  }
  fputs("</ul></section>\n", out);
}

static void put_head(FILE *out, const fg_loop_report *report, const char *sentence) {
  static const char *const classes[] = {"clean", "explained", "partly", "unattributed"};
  fg_html_head(out, "Closing the loop");
  fprintf(out, "<style>%s</style></head><body><main><section><h1>", style);
  fg_html_text(out, report->spec->response);
  fputs("</h1><p class=\"soft\">", out);
  fg_html_text(out, report->path);
  fputs(", declared model: ", out);
  fg_html_text(out, report->spec->model);
  fprintf(out, "</p><span class=\"verdict %s\">%s</span><p class=\"say\">",
          classes[report->result->verdict], fg_loop_outcome_word(report->result->verdict));
  fg_html_text(out, sentence);
  fputs("</p></section>\n", out);
}

fg_status fg_loop_write_html(fg_context *ctx, const fg_loop_report *report, FILE *out) {
  char *sentence = NULL;
  FG_TRY(fg_loop_sentence(ctx, report, &sentence));
  put_head(out, report, sentence);
  free(sentence);
  FG_TRY(fg_loop_plots_put(ctx, out, report));
  put_errors(out, report->result);
  put_advice(out, report);
  put_candidates(out, report);
  fputs("</main></body></html>\n", out);
  return fg_stream_finish(ctx, out, "the loop's page");
}
