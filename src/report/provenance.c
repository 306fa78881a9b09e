/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/provenance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/date.h"
#include "core/file.h"
#include "core/json_writer.h"
#include "core/sha256.h"
#include "core/text.h"
#include "foilgauge/report.h"
#include "foilgauge/traceability.h"
#include "foilgauge/words.h"
#include "page/page.h"
#include "report/design/json.h"
#include "report/measure/scan_model_words.h"

void fg_provenance_include_date(fg_provenance *p, const char *date) {
  if (!date[0]) return;
  if (!p->first[0] || strcmp(date, p->first) < 0)
    fg_text_clip(p->first, sizeof p->first, "%s", date);
  if (!p->last[0] || strcmp(date, p->last) > 0) fg_text_clip(p->last, sizeof p->last, "%s", date);
}

void fg_provenance_include_file(fg_provenance *p, const char *path) {
  char date[FG_DATE_DAY];
  fg_date_of_file(path, date);
  fg_provenance_include_date(p, date);
}

/* Writes the SHA-256 of the design without its calibration, which has a row of its own. */
static fg_status sum_design(fg_context *ctx, const fg_design *design, char sum[65]) {
  char *text = NULL;
  size_t size;
  fg_json json;
  fg_design bare = *design;
  bare.calibration = (fg_calibration){.stated = false};
  FILE *memory = fg_stream_open(&text, &size);
  if (!memory) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a design");
  fg_json_begin(&json, memory);
  fg_json_object(&json, NULL);
  fg_json_design(&json, "design", &bare);
  fg_json_object_end(&json);
  if (!fg_stream_keep(memory, &text)) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a design");
  fg_sha256_text(text, sum);
  free(text);
  return FG_OK;
}

static fg_status put_design(fg_context *ctx, FILE *out, const fg_design *design,
                            const char *words) {
  char sum[65];
  fputs("<dt>Design</dt><dd>", out);
  if (!design) {
    fg_html_text(out, words ? words : "none");
    fputs("</dd>\n", out);
    return FG_OK;
  }
  FG_TRY(sum_design(ctx, design, sum));
  fg_html_name(out, design->name);
  fprintf(out, " (%s), SHA-256 %.12s…</dd>\n", fg_foil_kind_word(design->kind), sum);
  return FG_OK;
}

static void put_pct(FILE *out, const fg_calibration *c) {
  const fg_calibration_budget terms = fg_calibration_terms(c);
  const double k = 100 * FG_COVERAGE_FACTOR;
  if (c->per_axis)
    fprintf(out, "a length along x to ± %.2g %%, along y to ± %.2g %%", k * terms.length[0],
            k * terms.length[1]);
  else
    fprintf(out, "a length to ± %.2g %%", k * terms.length[0]);
  if (!c->has_temperature) {
    fputs(" (U = 2 u); the part is taken to be at 20 °C", out);
    return;
  }
  fputs(" (U = 2 u; of it ", out);
  if (!c->scale_by_model) fprintf(out, "the pitch %.2g", k * terms.scale[0]);
  if (c->per_axis) fprintf(out, " and %.2g", k * terms.scale[1]);
  if (!c->scale_by_model) fputs(" %, ", out);
  if (terms.bed > 0) fprintf(out, "the scanner's own expansion %.2g %%, ", k * terms.bed);
  fprintf(out,
          "the temperature %.2g %%, the expansion %.2g %%); scanned at %g °C, lengths are "
          "those at 20 °C",
          k * terms.temperature, k * terms.expansion, c->temperature_c);
}

static void put_calibration(FILE *out, const fg_calibration *c) {
  fputs("<dt>Calibration</dt><dd>", out);
  if (!c || !c->stated) {
    fputs("none is stated: U holds statistics only</dd>\n", out);
    return;
  }
  if (c->certificate[0]) {
    fg_html_text(out, c->certificate);
    fputs(c->date[0] ? " of " : ": ", out);
  }
  if (c->date[0]) {
    fg_html_text(out, c->date);
    fputs(": ", out);
  }
  put_pct(out, c);
  fputs("</dd>\n", out);
}

static void put_traceability(FILE *out, const fg_design *design) {
  char sentence[FG_TRACEABILITY_SENTENCE];
  fg_traceability_sentence(design, sentence, sizeof sentence);
  fputs("<dt>Traced to</dt><dd>", out);
  fg_html_text(out, sentence);
  fputs("</dd>\n", out);
}

static void put_dates(FILE *out, const fg_provenance *p) {
  fputs("<dt>Date</dt><dd>", out);
  fg_html_text(out, p->first[0] ? p->first : "not known");
  if (strcmp(p->first, p->last) != 0) {
    fputs(" to ", out);
    fg_html_text(out, p->last);
  }
  fputs("</dd>\n", out);
}

fg_status fg_html_provenance(fg_context *ctx, FILE *out, const fg_provenance *p) {
  if (p->first[0] || p->of_scans) put_dates(out, p);
  fputs("<dt>Program</dt><dd>foilgauge ", out);
  fg_html_text(out, p->version ? p->version : FOILGAUGE_VERSION);
  fputs("</dd>\n", out);
  FG_TRY(put_design(ctx, out, p->design, p->design_words));
  if (p->of_scans) FG_TRY(fg_html_model_facts(ctx, out, p->model));
  if (p->calibration_words) {
    fputs("<dt>Calibration</dt><dd>", out);
    fg_html_text(out, p->calibration_words);
    fputs("</dd>\n", out);
  } else if (p->of_scans || p->calibration) {
    put_calibration(out, p->design ? &p->design->calibration : NULL);
  }
  if (p->of_scans && p->design) put_traceability(out, p->design);
  return FG_OK;
}

fg_status fg_html_provenance_section(fg_context *ctx, FILE *out, const fg_provenance *provenance) {
  fputs("<section>\n<h2 class=\"first\">Where it comes from</h2>\n<dl class=\"facts\">\n", out);
  FG_TRY(fg_html_provenance(ctx, out, provenance));
  fputs("</dl>\n</section>\n", out);
  return FG_OK;
}
