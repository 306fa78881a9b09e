/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/scan_loop/members.h"

#include <math.h>
#include <stdlib.h>

#include "core/file.h"
#include "core/text.h"
#include "foilgauge/scan_loop.h"
#include "report/design/members.h"
#include "report/scan_loop/parts.h"

/* A member that has one word in every report. */
#define CONSTANT(name_, word_)                                                                     \
  FG_WORD_BY(name_, find_only_word, ((const char *const[]){word_, NULL})),                         \
      .options = FG_MEMBER_NEVER_NULL

static int find_only_word(const fg_subject *subject) {
  (void)subject;
  return 0;
}

/* Scans. */
static const char *find_scan_path(const fg_subject *s, char *buffer) {
  (void)buffer;
  return ((const fg_scan_result_scan *)s->object)->before->scan;
}

static const char *find_scan_sha256(const fg_subject *s, char *buffer) {
  (void)buffer;
  return ((const fg_scan_result_scan *)s->object)->before->sha256;
}

static const char *look_at_path(const fg_subject *s) {
  (void)s;
  return "path";
}

static void put_short_sha256(FILE *out, const fg_subject *s) {
  fprintf(out, "<code>%.12s</code>", ((const fg_scan_result_scan *)s->object)->before->sha256);
}

static const char *find_dpi_words(const fg_subject *s, char *buffer) {
  const double *dpi = ((const fg_scan_result_scan *)s->object)->before->dpi;
  fg_text_clip(buffer, 64, "%.6g", dpi[0]);
  if (fabs(dpi[1] / dpi[0] - 1) > 1e-9) fg_text_clip(buffer, 64, "%.6g × %.6g", dpi[0], dpi[1]);
  return buffer;
}

static const char *find_parts_words(const fg_subject *s, char *buffer) {
  const fg_measurement *m = ((const fg_scan_result_scan *)s->object)->before;
  char foils[40] = "", discs[40] = "";
  if (m->foil_count)
    fg_text_clip(foils, sizeof foils, "%zu foil%s", m->foil_count, fg_plural(m->foil_count));
  if (m->disc_count)
    fg_text_clip(discs, sizeof discs, "%zu disc%s", m->disc_count, fg_plural(m->disc_count));
  fg_text_clip(buffer, 100, "%s%s%s", foils, foils[0] && discs[0] ? ", " : "", discs);
  return buffer;
}

static const char *find_role(const fg_subject *s, char *buffer) {
  bool held_out = ((const fg_scan_result_scan *)s->object)->hold_out;
  (void)buffer;
  return held_out ? "kept aside: only confirms" : "searched";
}

static const fg_member input_rows[] = {
    {FG_TEXT_BY("path", find_scan_path), .options = FG_MEMBER_NEVER_NULL, .look = look_at_path,
     .page = {.rank = 1, .heading = "input"}},
    {FG_TEXT_BY("sha256", find_scan_sha256), .options = FG_MEMBER_NEVER_NULL,
     .pattern = "^[0-9a-f]{64}$", .markup = put_short_sha256,
     .page = {.rank = 1, .heading = "SHA-256", .words = true}},
    {FG_TEXT_BY("dpi", find_dpi_words), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .heading = "dpi", .words = true}},
    {FG_TEXT_BY("parts", find_parts_words), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .heading = "shows", .words = true}},
    {FG_FLAG("hold_out", fg_scan_result_scan, hold_out), .words = "the scan only confirms"},
    {FG_TEXT_BY("role", find_role), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .heading = "role", .words = true}},
};
const fg_members fg_scan_input_members = FG_MEMBERS(input_rows);

bool fg_scan_find_input(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_scan_result *result = fg_scan_result_of(list);
  element->object = &result->scan[i];
  return i < result->scans;
}

/* Noise of a row, and half the strip's width. */
static const char *const noise_words[] = {"white", "gaussian", "exponential", NULL};

static const double *list_disc_noise(const fg_subject *s, double *buffer, size_t *count) {
  const fg_scan_noise *noise = s->object;
  (void)buffer;
  *count = noise->discs;
  return noise->disc_um;
}

static const fg_member noise_rows[] = {
    {FG_STRING("form", fg_scan_noise, model), .choices = noise_words,
     .options = FG_MEMBER_NEVER_NULL},
    {FG_NUMBER("sd", fg_scan_noise, sd_um)},
    {FG_NUMBER("white_sd", fg_scan_noise, white_um)},
    {FG_NUMBER("correlated_sd", fg_scan_noise, correlated_um)},
    {FG_NUMBER("correlation", fg_scan_noise, correlation), .lowest = 0, .highest = 1,
     .options = FG_MEMBER_NEVER_NULL},
    {FG_NUMBER("range_mm", fg_scan_noise, range_mm),
     .options = FG_MEMBER_NEVER_NULL | FG_MEMBER_NOT_NEGATIVE},
    {FG_NUMBER("long_waves", fg_scan_noise, long_waves), .lowest = 1,
     .options = FG_MEMBER_NEVER_NULL},
    {FG_NUMBERS_BY("sd_of_discs", list_disc_noise), .options = FG_MEMBER_LEFT_OUT,
     .words = "form discs only: every disc has its own, in the order of before.discs; sd is that "
              "of the cleanest one"},
};
static const fg_members noise_members = FG_MEMBERS(noise_rows);

static const fg_member half_width_rows[] = {
    {FG_NUMBER("rms", fg_scan_result, half_width_rms_um)},
    {FG_NUMBER("smooth", fg_scan_result, half_width_smooth_um)},
};
static const fg_members half_width_members = FG_MEMBERS(half_width_rows);

/* Errors after over those before. */
static const char *const fold_words[] = {"bumps", "discs", "stretches of the edge", NULL};

static double find_rms_ratio(const fg_subject *s) {
  const fg_scan_result *result = fg_scan_result_of(s);
  return result->after.rms / result->before.rms;
}

static double find_held_out_ratio(const fg_subject *s) {
  const fg_scan_result *result = fg_scan_result_of(s);
  return result->after.held_out_rms / result->before.held_out_rms;
}

static const fg_member ratio_rows[] = {
    {FG_NUMBER_BY("rms", find_rms_ratio)},
    {FG_NUMBER_BY("held_out", find_held_out_ratio)},
    {FG_COUNT("folds", fg_scan_result, folds)},
    {FG_STRING("fold_of", fg_scan_result, fold_of), .choices = fold_words},
};
static const fg_members ratio_members = FG_MEMBERS(ratio_rows);

/* The report. */
static const char *const outcome_words[] = {
    [FG_LOOP_CLEAN] = "clean",
    [FG_LOOP_EXPLAINED] = "explained",
    [FG_LOOP_PARTLY] = "partly explained",
    [FG_LOOP_UNATTRIBUTED] = "unattributed",
    [FG_LOOP_SUSPECTED] = "suspected",
    NULL,
};

static const char *find_sentence(const fg_subject *s, char *buffer) {
  (void)buffer;
  return ((const fg_scan_report *)s->whole)->sentence;
}

static fg_subject find_calibration_of_scans(const fg_subject *s) {
  const fg_calibration *c = &fg_scan_result_of(s)->scan[0].before->design.calibration;
  return (fg_subject){c->stated ? c : NULL, s->whole, 0};
}

static fg_subject find_design_of_scans(const fg_subject *s) {
  return (fg_subject){&fg_scan_result_of(s)->scan[0].before->design, s->whole, 0};
}

static const char *advice_at(const fg_subject *s, size_t i) {
  const fg_scan_result *result = s->object;
  return i < result->advices ? result->advice[i] : NULL;
}

static const char *note_at(const fg_subject *s, size_t i) {
  const fg_scan_result *result = s->object;
  return i < result->notes ? result->note[i] : NULL;
}

static const fg_member result_rows[] = {
    {FG_HEAD("foilgauge/loop/1")},
    {CONSTANT("domain", "scan"), .words = "a loop on scans, not on a table"},
    {FG_WORD("verdict", fg_scan_result, verdict, outcome_words),
     .words = "on the residual of the edges and of the bumps"},
    {FG_TEXT_BY("summary", find_sentence), .options = FG_MEMBER_NEVER_NULL, .pattern = ".",
     .words = "what was found and how sure it is, in words"},
    {FG_LIST_BY("inputs", fg_scan_find_input, &fg_scan_input_members), .lowest = 1,
     .words = "scans, in their order"},
    {FG_PART("calibration", find_calibration_of_scans, &fg_calibration_used_members),
     .words = "it is in u_ of the foils of before and after, and in nothing that the loop decides"},
    {FG_TRACEABILITY(find_design_of_scans)},
    {FG_FLAG("same_foil", fg_scan_result, same_foil), .words = "all scans show the same foil"},
    {FG_STRING("without", fg_scan_result, without),
     .words = "effects that were not looked for (--without), with commas; null: none"},
    {FG_NUMBER("p_value", fg_scan_result, p_value),
     .words = "that no effect is needed: all candidates together against the noise"},
    {FG_NUMBER("noise_floor", fg_scan_result, noise_floor_um),
     .words = "sd of an edge row that all effects together leave"},
    {FG_OBJECT("noise", fg_scan_result, noise, &noise_members),
     .words =
         "of an edge row, as the search left it beside what was found. form: white (rows are "
         "independent), or how the correlation of two rows falls with their distance d along the "
         "edge beside the white part: gaussian exp(-(d / range)^2), exponential exp(-d / range). "
         "sd^2 = white_sd^2 + correlated_sd^2; correlation: correlated_sd^2 / sd^2; long_waves: "
         "variance of waves of half a millimetre over what the form says of them"},
    {FG_NUMBER("edge_model_error", fg_scan_result, edge_model_error_um),
     .words = "of the edge model, allowed for in every decision"},
    {FG_GROUP("half_width", &half_width_members),
     .words = "half the strip's width along the edges, beside the scanner's stretch: all of it, "
              "and what follows place or direction (threshold, flare, shading, one-sided blur move "
              "the edges apart; geometry moves them together)"},
    {CONSTANT("unit", "um"), .words = "of residuals and amplitudes"},
    {FG_PART("before", fg_scan_find_before, &fg_scan_side_members), .options = FG_MEMBER_NEVER_NULL,
     .words = "errors of the edge rows and the foils as measured"},
    {FG_LIST_BY("claims", fg_scan_find_claim, &fg_scan_claim_members),
     .words = "effects of the corrected model"},
    {FG_PART("unattributed", fg_scan_find_curve, &fg_scan_curve_members),
     .words = "largest curve that no listed effect explains; null: none"},
    {FG_PART("after", fg_scan_find_after, &fg_scan_side_members), .options = FG_MEMBER_NEVER_NULL,
     .words = "errors of the edge rows and the foils as corrected"},
    {FG_GROUP("error_ratio", &ratio_members),
     .words = "after / before. folds: that held_out is cross-fitted over; 0 where scans were kept "
              "aside, nothing was found (the ratio is 1), or bumps are too few (null). fold_of: "
              "what took turns; null where nothing did"},
    {FG_LIST_BY("rejected", fg_scan_find_rejected, &fg_scan_rejected_members),
     .words = "effects that are not claimed"},
    {FG_TEXTS_BY("separating_measurement", advice_at),
     .words = "measurements that would tell the explanations apart"},
    {FG_OBJECT("bumps", fg_scan_result, bumps, &fg_scan_bumps_members),
     .words = "the bumps of `after` against the declared springback, or against the declared "
              "forming; views of one foil are averaged"},
    {FG_TEXTS_BY("notes", note_at), .words = "what else is to be known"},
};
static const fg_members result_members = FG_MEMBERS(result_rows);

static const fg_member report_rows[] = {
    {FG_SAME(&result_members), .offset = offsetof(fg_scan_report, result), .pointed = true}};
static const fg_members report_members = FG_MEMBERS(report_rows);

const fg_document fg_scan_loop_document = {
    .file = "loop_scan",
    .title =
        "foilgauge loop report of scans (\"schema\": \"foilgauge/loop/1\", \"domain\": \"scan\")",
    .description = "What the scanner or the foil does that the geometry lacks. Residuals and "
                   "amplitudes in um.",
    .made_by = "`foilgauge loop SCAN -o`",
    .members = &report_members,
};

fg_status fg_scan_loop_write_json(fg_context *ctx, const fg_scan_loop *loop, FILE *out) {
  char *sentence = NULL;
  fg_status status = FG_OK;
  fg_scan_report report = {.result = fg_scan_loop_result(loop), .ctx = ctx, .status = &status};
  FG_TRY(fg_scan_loop_sentence(ctx, report.result, &sentence));
  report.sentence = sentence;
  fg_document_json(out, &report_members, &report);
  free(sentence);
  return status;
}
