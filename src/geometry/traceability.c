/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/traceability.h"

#include <math.h>
#include <string.h>

#include "core/date.h"
#include "core/text.h"

const char *const fg_traceability_words[] = {"none", "stated", "plate", NULL};

const char *const fg_traceability_cells[] = {"none", "stated", "plate", "not needed", NULL};
enum { CELL_NOT_NEEDED = 3 };

const char fg_traceability_cure[] =
    "Scan a plate of known sizes for a model (--model), state a calibration, or take --flatbed.";

fg_artefact fg_design_traced_to(const fg_design *design) {
  const fg_calibration *c = &design->calibration;
  fg_artefact artefact = design->model_scale.artefact;
  if (fg_calibration_has_scale(c) && (c->artefact[0] || !artefact.name[0])) {
    memcpy(artefact.name, c->artefact, sizeof artefact.name);
    memcpy(artefact.certificate, c->certificate, sizeof artefact.certificate);
    memcpy(artefact.date, c->date, sizeof artefact.date);
    memcpy(artefact.due, c->due, sizeof artefact.due);
  }
  return artefact;
}

fg_traceability fg_design_traceability(const fg_design *design) {
  if (!fg_calibration_has_scale(&design->calibration) && !design->model_scale.known)
    return FG_TRACED_TO_NONE;
  return fg_design_traced_to(design).name[0] ? FG_TRACED_TO_PLATE : FG_TRACED_TO_STATED;
}

int fg_design_traceability_cell(const fg_design *design) {
  fg_traceability state = fg_design_traceability(design);
  bool needless = state == FG_TRACED_TO_NONE && design->calibration.not_needed[0];
  return needless ? CELL_NOT_NEEDED : (int)state;
}

bool fg_design_may_judge(const fg_design *design) {
  return fg_design_traceability(design) != FG_TRACED_TO_NONE || design->calibration.not_needed[0];
}

static void append_fact(char *sentence, size_t size, const char *before, const char *fact) {
  size_t used = strlen(sentence);
  if (fact[0]) fg_text_clip(sentence + used, size - used, "%s%s", before, fact);
}

void fg_traceability_sentence(const fg_design *design, char *sentence, size_t size) {
  const fg_artefact artefact = fg_design_traced_to(design);
  fg_traceability state = fg_design_traceability(design);
  fg_text_clip(sentence, size, "%s", fg_traceability_words[state]);
  if (state == FG_TRACED_TO_NONE) {
    if (design->calibration.not_needed[0])
      append_fact(sentence, size, "; no calibration is needed: ", design->calibration.not_needed);
    else
      append_fact(sentence, size, ": ", "nothing is known of the scanner's scale");
    return;
  }
  append_fact(sentence, size, ": ", artefact.name);
  append_fact(sentence, size, artefact.name[0] ? ", certificate " : ": ", artefact.certificate);
  if (!artefact.name[0] && !artefact.certificate[0])
    append_fact(sentence, size, ": ",
                fg_calibration_has_scale(&design->calibration)
                    ? "a calibration without a certificate"
                    : "gauges of known size, without a certificate");
  append_fact(sentence, size, " of ", artefact.date);
  append_fact(sentence, size, ", due ", artefact.due);
}

static bool is_day(const char *text) {
  return strlen(text) == 10 && !isnan(fg_date_days(text));
}

fg_status fg_artefact_check(fg_context *ctx, const char *member, const fg_artefact *artefact) {
  if (!artefact->name[0])
    return fg_fail(ctx, FG_ERR_DATA, "%s has no name: how it is marked, as \"plate GP-17\"",
                   member);
  if (artefact->date[0] && !is_day(artefact->date))
    return fg_fail(ctx, FG_ERR_DATA, "%s.date '%s' is no date; write it as 2026-03-14", member,
                   artefact->date);
  if (artefact->due[0] && !is_day(artefact->due))
    return fg_fail(ctx, FG_ERR_DATA, "%s.due '%s' is no date; write it as 2027-03-14", member,
                   artefact->due);
  if (artefact->date[0] && artefact->due[0] && strcmp(artefact->due, artefact->date) <= 0)
    return fg_fail(ctx, FG_ERR_DATA, "%s.due %s is not after its date %s", member, artefact->due,
                   artefact->date);
  return FG_OK;
}

fg_status fg_artefact_check_due(fg_context *ctx, const char *file, const fg_artefact *artefact,
                                const char *scan_date) {
  if (!artefact->due[0] || !scan_date[0] || strncmp(scan_date, artefact->due, 10) <= 0)
    return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%.300s%s%s was due for calibration on %s, and the scan is of %.10s: have it "
                 "calibrated, and scan it again for a new model",
                 file ? file : "", file ? ": " : "", artefact->name, artefact->due, scan_date);
}
