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
    ".pair{display:grid;grid-template-columns:repeat(auto-fit,minmax(380px,1fr));gap:14px}"
    "figure{margin:0}figcaption{font-size:13px;color:var(--soft)}"
    ".plot{display:block;width:100%;height:auto;font-size:13px}.plot text{fill:var(--ink)}"
    ".x,.t{text-anchor:middle}.y{text-anchor:end}.plot .t{fill:var(--soft)}"
    ".grid{stroke:#e6eaee}.zero{stroke:#8a96a1}.plot path{fill:none}"
    ".fit{fill:var(--blue);fill-opacity:.75}.held{fill:#fff;stroke:var(--bump);stroke-width:2}"
    ".effect{stroke:var(--bump);stroke-width:2.5}.mark{fill:var(--bump)}"
    ".scroll{overflow-x:auto}table{border-collapse:collapse;width:100%;font-size:13.5px;"
    "font-variant-numeric:tabular-nums}th,td{padding:5px 10px;text-align:right;"
    "border-bottom:1px solid var(--line)}th{color:var(--soft);font-weight:600}"
    "th:first-child,td:first-child,th.w,td.w{text-align:left}td:first-child{overflow-wrap:anywhere}"
    "ul{margin:6px 0 0;padding-left:22px}@media(max-width:600px){main{padding:8px}section{padding:"
    "14px}.pair{grid-template-columns:1fr}.plot{font-size:16px}}"
    "@media print{body{background:#fff}section{border:0;padding:8px 0;break-inside:avoid}}";

typedef struct loop_plot {
  FILE *out;
  double x_low, x_high, y_low, y_high;
} loop_plot;

enum { LEFT = 64, RIGHT = 510, TOP = 14, BOTTOM = 250, WIDTH = 520, HEIGHT = 296 };

static double at_x(const loop_plot *at, double x) {
  return LEFT + (x - at->x_low) / (at->x_high - at->x_low) * (RIGHT - LEFT);
}

static double at_y(const loop_plot *at, double y) {
  return BOTTOM - (y - at->y_low) / (at->y_high - at->y_low) * (BOTTOM - TOP);
}

static double nice_step(double range) {
  double step = pow(10, floor(log10(range / 5)));
  return range / step > 25   ? 5 * step
         : range / step > 12 ? 2.5 * step
         : range / step > 10 ? 2 * step
                             : step;
}

/* Multiples of a step in a range; a step that vanishes beside its ends (10^17 and a range of 100)
 * would never get from one to the other. */
static size_t tick_count(double low, double high, double step) {
  double count = floor(high / step) - ceil(low / step) + 1;
  return count >= 1 && count <= 40 ? (size_t)count : 0;
}

static void put_axes(const loop_plot *at, const fg_loop_coordinate *coordinate, const char *title) {
  double step = nice_step(at->y_high - at->y_low);
  size_t ticks = tick_count(at->y_low, at->y_high, step);
  for (size_t i = 0; i < ticks; i++) {
    double y = (ceil(at->y_low / step) + (double)i) * step;
    fprintf(at->out,
            "<path class=\"%s\" d=\"M%d %.1fH%d\"/><text class=\"y\" x=\"%d\" y=\"%.1f\">%.4g"
            "</text>\n",
            fabs(y) < step / 1e6 ? "zero" : "grid", LEFT, at_y(at, y), RIGHT, LEFT - 6,
            at_y(at, y) + 4, fabs(y) < step / 1e6 ? 0 : y);
  }
  if (coordinate->levels) {
    for (size_t k = 0; k < coordinate->levels; k++) {
      fprintf(at->out, "<text class=\"x\" x=\"%.1f\" y=\"%d\">", at_x(at, (double)k), BOTTOM + 18);
      fg_html_text(at->out, coordinate->level_name[k]);
      fputs("</text>\n", at->out);
    }
  } else {
    step = nice_step(at->x_high - at->x_low);
    ticks = tick_count(at->x_low, at->x_high, step);
    for (size_t i = 0; i < ticks; i++) {
      double x = (ceil(at->x_low / step) + (double)i) * step;
      fprintf(at->out, "<text class=\"x\" x=\"%.1f\" y=\"%d\">%.4g</text>\n", at_x(at, x),
              BOTTOM + 18, x);
    }
  }
  fprintf(at->out, "<text class=\"t\" x=\"%d\" y=\"%d\">", (LEFT + RIGHT) / 2, HEIGHT - 8);
  fg_html_text(at->out, coordinate->name);
  fputs("</text>\n<text class=\"t\" transform=\"translate(14 132) rotate(-90)\">", at->out);
  fg_html_text(at->out, title);
  fputs("</text>\n", at->out);
}

/* At most this many points: more would only blacken the page. */
enum { POINTS_MOST = 4000 };

static void put_points(const loop_plot *at, const fg_loop_problem *problem,
                       const fg_loop_coordinate *coordinate, const double *residual) {
  size_t stride = problem->rows / POINTS_MOST + 1;
  for (int held = 0; held < 2; held++)
    for (size_t i = 0; i < problem->rows; i += stride) {
      if ((problem->aside && problem->aside[i]) != held) continue;
      /* levels are spread a little, so that rows do not hide each other */
      double shift = coordinate->levels ? 0.16 * sin(12.9898 * (double)i) : 0;
      double y = fmin(fmax(residual[i], at->y_low), at->y_high);
      fprintf(at->out, "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\"/>\n",
              held ? "held" : "fit", at_x(at, coordinate->value[i] + shift), at_y(at, y),
              problem->rows > 400 ? 2.0 : 4.0);
    }
}

typedef struct place {
  double x, y;
} place;

static int by_x(const void *a, const void *b) {
  const place *p = a, *q = b;
  return (p->x > q->x) - (p->x < q->x);
}

/* The effect over its coordinate: a line through its value at the rows, averaged where they share
 * one. */
static fg_status put_effect(fg_context *ctx, const loop_plot *at, const fg_loop_problem *problem,
                            const fg_loop_coordinate *coordinate, const double *effect) {
  place *points = NULL;
  double mean = 0;
  FG_TRY(fg_memory_allocate(ctx, problem->rows, sizeof *points, (void **)&points));
  for (size_t i = 0; i < problem->rows; i++) {
    points[i] = (place){coordinate->value[i], effect[i]};
    mean += effect[i] / (double)problem->rows;
  }
  qsort(points, problem->rows, sizeof *points, by_x);
  if (!coordinate->levels) fputs("<path class=\"effect\" d=\"", at->out);
  double drawn = -INFINITY, finest = problem->rows > POINTS_MOST ? 0.2 : 0;
  for (size_t i = 0, next; i < problem->rows; i = next) {
    double sum = 0;
    for (next = i; next < problem->rows && points[next].x == points[i].x; next++)
      sum += points[next].y;
    double x = at_x(at, points[i].x), y = at_y(at, sum / (double)(next - i) - mean);
    if (x - drawn < finest && next < problem->rows) continue;
    drawn = x;
    if (coordinate->levels)
      fprintf(at->out, "<path class=\"effect\" d=\"M%.1f %.1fh60\"/>\n", x - 30, y);
    else
      fprintf(at->out, "%s%.1f %.1f", i ? "L" : "M", x, y);
  }
  if (!coordinate->levels) fputs("\"/>\n", at->out);
  free(points);
  return FG_OK;
}

static fg_status put_plot(fg_context *ctx, FILE *out, const fg_loop_report *report,
                          const fg_loop_coordinate *coordinate, const double *residual,
                          const double *effect, double limit, const char *caption) {
  const fg_loop_problem *problem = &report->problem->problem;
  double margin = coordinate->levels ? 0.5 : 0.03 * (coordinate->high - coordinate->low);
  loop_plot at = {out, coordinate->low - margin, coordinate->high + margin, -limit, limit};
  if (!(at.x_high > at.x_low)) return FG_OK;
  fprintf(out,
          "<figure><svg class=\"plot\" viewBox=\"0 0 %d %d\" role=\"img\" aria-label=\"%s\">\n",
          WIDTH, HEIGHT, caption);
  put_axes(&at, coordinate, report->spec->response);
  put_points(&at, problem, coordinate, residual);
  if (effect) FG_TRY(put_effect(ctx, &at, problem, coordinate, effect));
  fprintf(out, "</svg><figcaption>%s</figcaption></figure>\n", caption);
  return FG_OK;
}

static double largest(const fg_loop_report *report) {
  double size = 0;
  for (size_t i = 0; i < report->problem->problem.rows; i++)
    size = fmax(size, fabs(report->result->before_fit[i]));
  return size > 0 ? 1.08 * size : 1;
}

/* Before: the residual of the declared model, the effect over it. After: what is left. */
static fg_status put_pair(fg_context *ctx, FILE *out, const fg_loop_report *report,
                          const char *heading, size_t coordinate, const double *effect) {
  const fg_loop_coordinate *at = &report->problem->problem.coordinate[coordinate];
  double limit = largest(report);
  fputs("<section><h2>", out);
  fg_html_text(out, heading);
  fputs("</h2><div class=\"pair\">\n", out);
  FG_TRY(put_plot(ctx, out, report, at, report->result->before_fit, effect, limit,
                  effect ? "Residual of the declared model, and the effect over it"
                         : "Residual of the declared model"));
  if (effect)
    FG_TRY(put_plot(ctx, out, report, at, report->result->after_fit, NULL, limit,
                    "What is left with the effect in the model"));
  fputs("</div><p class=\"soft\">Filled: rows that took part. Rings: rows kept aside.</p>"
        "</section>\n",
        out);
  return FG_OK;
}

static size_t order_coordinate(const fg_loop_problem *problem) {
  for (size_t i = 0; i < problem->coordinates; i++)
    if (problem->coordinate[i].roles & (FG_LOOP_ORDER | FG_LOOP_BUMP)) return i;
  return 0;
}

static fg_status put_findings(fg_context *ctx, FILE *out, const fg_loop_report *report) {
  const fg_loop_problem *problem = &report->problem->problem;
  const fg_loop_result *result = report->result;
  double *effect = NULL;
  fg_status status = FG_OK;
  FG_TRY(fg_memory_allocate(ctx, problem->rows, sizeof *effect, (void **)&effect));
  for (size_t m = 0; m < result->claims; m++) {
    const fg_loop_claim *claim = &result->claim[m];
    bool lone = !claim->candidate.effect->accepts;
    size_t at = lone ? order_coordinate(problem) : claim->candidate.a;
    FG_TRY_EXIT(fg_loop_claim_evaluate(ctx, problem, claim, effect));
    if (problem->coordinates) FG_TRY_EXIT(put_pair(ctx, out, report, claim->name, at, effect));
  }
  if (result->has_curve) {
    char heading[FG_LOOP_NAME + 40];
    fg_text_clip(heading, sizeof heading, "unattributed: over %s", result->curve.name);
    const fg_loop_coordinate *at = &problem->coordinate[result->curve.coordinate];
    for (size_t i = 0; i < problem->rows; i++)
      effect[i] = fg_loop_curve_at(&result->curve, at->value[i]);
    FG_TRY_EXIT(put_pair(ctx, out, report, heading, result->curve.coordinate, effect));
  }
  if (!result->claims && !result->has_curve && problem->coordinates)
    FG_TRY_EXIT(put_pair(ctx, out, report, "The residual, in which nothing shows",
                         order_coordinate(problem), NULL));
exit:
  free(effect);
  return status;
}

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
  put_error(out, "kept aside, rms", before->held_out_rms, after->held_out_rms);
  put_error(out, "cross-validated, rms", before->cross_validated_rms, after->cross_validated_rms);
  fputs("</table></div><p class=\"soft\">Noise floor ", out);
  put_number(out, "%.4g", result->noise_floor);
  if (result->noise.rho > 0) fprintf(out, ", correlation along the order %.2f", result->noise.rho);
  if (result->noise.lambda > 0)
    fprintf(out, ", variance between groups %.2g times that within", result->noise.lambda);
  fprintf(out, ". 95 %% interval of the ratio: %.3f to %.3f.</p></section>\n",
          result->ratio_interval[0], result->ratio_interval[1]);
}

static void put_claim_row(FILE *out, const fg_loop_claim *claim) {
  fputs("<tr><td><b>", out);
  fg_html_text(out, claim->name);
  fprintf(out, "</b></td><td class=\"w\">%s</td><td>", fg_loop_verdict_word(claim->verdict));
  put_number(out, "%.3g ± ", claim->amplitude);
  put_number(out, "%.2g", 2 * claim->amplitude_u);
  fprintf(out, "</td><td>%.2g</td><td class=\"w\">", claim->p_value);
  for (size_t k = 0; k < claim->aliases; k++) {
    fputs(k ? "; " : "or ", out);
    fg_html_text(out, claim->alias[k].name);
  }
  fputs("</td></tr>\n", out);
}

static void put_candidates(FILE *out, const fg_loop_result *result) {
  fputs("<section><h2>Candidates and verdicts</h2><div class=\"scroll\"><table><tr><th>effect</th>"
        "<th class=\"w\">verdict</th><th>amplitude, or what would have shown</th><th>p</th>"
        "<th class=\"w\">could also be</th></tr>\n",
        out);
  for (size_t i = 0; i < result->claims; i++)
    put_claim_row(out, &result->claim[i]);
  for (size_t i = 0; i < result->rejects; i++) {
    const fg_loop_rejected *one = &result->rejected[i];
    fputs("<tr><td>", out);
    fg_html_text(out, one->name);
    fprintf(out, "</td><td class=\"w\">%s</td><td>", fg_loop_verdict_word(one->verdict));
    put_number(out, "≥ %.3g", one->smallest_detectable);
    fprintf(out, "</td><td>%.2g</td><td></td></tr>\n", one->p_value);
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
  FG_TRY(put_findings(ctx, out, report));
  put_errors(out, report->result);
  put_advice(out, report);
  put_candidates(out, report->result);
  fputs("</main></body></html>\n", out);
  return fg_stream_finish(ctx, out, "the loop's page");
}
