/* The lot's page: groups against each other, and the gauge study. */
#include <math.h>

#include "lot/page_parts.h"
#include "report/measure/measure_page_parts.h"

static void put_p(FILE *out, double p) {
  fprintf(out, "<td>%s%.3g</td>", p < 1e-4 ? "&lt; " : "", p < 1e-4 ? 1e-4 : p);
}

void fg_lot_put_comparisons(FILE *out, const fg_lot_analysis *analysis) {
  if (!analysis->difference_count) return;
  fputs("<section class=\"part\">\n<h1>Groups: ", out);
  fg_html_text(out, analysis->lot->settings.group_column);
  fputs("</h1>\n<div class=\"scroll "
        "lots\"><table><thead><tr><th>quantity</th><th>groups</th><th>means"
        "</th><th>difference</th><th>p (Welch)</th><th>s</th><th>p (F)</th><th>p (Levene)</th></tr>"
        "</thead>\n<tbody>\n",
        out);
  for (size_t i = 0; i < analysis->difference_count; i++) {
    const fg_lot_difference *one = &analysis->differences[i];
    fprintf(out, "<tr><td class=\"words\">%s</td><td class=\"words\">", one->quantity->row->words);
    fg_html_text(out, one->a);
    fputs(" against ", out);
    fg_html_text(out, one->b);
    fprintf(out, "</td><td>%.6g<br>%.6g</td><td>%.4g<i>%.4g … %.4g</i></td>", one->mean_a,
            one->mean_b, one->comparison.difference, one->comparison.low, one->comparison.high);
    put_p(out, one->comparison.p_means);
    fprintf(out, "<td>%.3g<br>%.3g</td>", one->sd_a, one->sd_b);
    put_p(out, one->comparison.p_variances);
    put_p(out, one->comparison.p_levene);
    fputs("</tr>\n", out);
  }
  fputs("</tbody></table></div>\n</section>\n", out);
}

void fg_lot_put_gauge(FILE *out, const fg_lot_analysis *analysis) {
  if (!analysis->gauge_count) return;
  fprintf(out,
          "<section class=\"part\">\n<h1>Gauge repeatability and reproducibility</h1>\n<div "
          "class=\"scroll\"><table>"
          "<thead><tr><th>quantity</th><th>%s</th><th>repeatability</th><th>reproducibility</th>"
          "<th>GRR</th><th>part</th><th>GRR, %%</th><th>categories</th></tr></thead>\n<tbody>\n",
          fg_lot_words_of(analysis)->one);
  for (size_t i = 0; i < analysis->gauge_count; i++) {
    const fg_lot_gauge *gauge = &analysis->gauges[i];
    const fg_gauge_study *study = &gauge->study;
    fprintf(out,
            "<tr><td>%s</td><td>%d</td><td>%.3g</td><td>%.3g</td><td>%.3g</td><td>%.3g</td><td>%.3g"
            "</td><td>%.0f</td></tr>\n",
            gauge->quantity->row->words, gauge->number, study->repeatability,
            study->reproducibility, study->grr, study->part, study->grr_pct,
            floor(study->distinct_categories));
  }
  fputs("</tbody></table></div>\n</section>\n", out);
}
