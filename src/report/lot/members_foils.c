/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of lot.json about a foil, and about the dies of the foils. */
#include <math.h>

#include "foilgauge/foil_kind.h"
#include "foilgauge/traceability.h"
#include "foilgauge/words.h"
#include "page/page.h"
#include "quantity/parts.h"
#include "report/flag_names.h"
#include "report/lot/members.h"
#include "report/lot/page_parts.h"
#include "report/verdict_members.h"

static const fg_lot_analysis *analysis_of(const fg_subject *subject) {
  return subject->whole;
}

static const fg_lot_foil *foil_of(const fg_subject *subject) {
  return subject->object;
}

static const char *find_label(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return fg_manifest_label(&analysis_of(subject)->lot->manifest, foil_of(subject)->item);
}

static double find_foil_number(const fg_subject *subject) {
  return foil_of(subject)->foil->number;
}

static const char *foil_flag_at(const fg_subject *subject, size_t i) {
  const fg_foil *foil = foil_of(subject)->foil;
  return fg_flag_name_at(fg_foil_flag_words(), foil->flags, foil->strip.picture.findings, i);
}

static const char *foil_flag_choice(size_t i) {
  return fg_flag_name_at(fg_foil_flag_words(), ~0u, ~0u, i);
}

static const char *find_flag_cell(const fg_subject *subject, char *buffer) {
  const fg_foil *foil = foil_of(subject)->foil;
  fg_flag_names(fg_foil_flag_words(), foil->flags, foil->strip.picture.findings, buffer,
                FG_MEMBER_TEXT_MAX);
  return buffer;
}

static const char *find_defect(const fg_subject *subject, char *buffer) {
  const fg_design *design = &analysis_of(subject)->lot->settings.design;
  return fg_foil_defect(design, foil_of(subject)->foil, buffer, FG_MEMBER_TEXT_MAX) ? buffer : NULL;
}

static const char *find_error(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return foil_of(subject)->foil->error;
}

static const char *find_page(const fg_subject *subject, char *buffer) {
  char *const *pages = analysis_of(subject)->pages;
  (void)buffer;
  return pages ? pages[foil_of(subject)->item] : NULL;
}

static const char *find_worst_quantity(const fg_subject *subject, char *buffer) {
  const fg_quantity *row = foil_of(subject)->worst_row;
  (void)buffer;
  return row ? row->name : NULL;
}

static double find_bump_median_of_foil(const fg_subject *subject) {
  const fg_foil *foil = foil_of(subject)->foil;
  return fg_bump_radius_median(foil->bumps, foil->bump_count);
}

static const fg_member foil_rows[] = {
    {FG_COUNT("input", fg_lot_foil, item), .words = "place of its scan in `inputs`"},
    {FG_TEXT_BY("label", find_label), .options = FG_MEMBER_NEVER_NULL,
     .words = "as the manifest has it"},
    {FG_COUNT_BY("number", find_foil_number), .lowest = 1, .words = "on its scan",
     .csv = {.rank = 1, .heading = "foil_number"}},
    {FG_TEXT_BY("page", find_page), .options = FG_MEMBER_NOT_IN_JSON, .csv = {.rank = 2}},
    {FG_TEXTS_BY("flags", foil_flag_at), .choice_at = foil_flag_choice,
     .words = "what is wrong with the foil or its picture"},
    {FG_TEXT_BY("flags", find_flag_cell), .options = FG_MEMBER_NOT_IN_JSON, .csv = {.rank = 4}},
    {FG_VERDICT(fg_lot_foil, verdict)},
    {FG_WORD("verdict", fg_lot_foil, verdict, fg_verdict_words), .options = FG_MEMBER_NOT_IN_JSON,
     .csv = {.rank = 3}},
    {FG_TEXT_BY("error", find_error), .options = FG_MEMBER_NOT_IN_JSON, .csv = {.rank = 5}},
    {FG_WORD_BY("traceability", fg_lot_traceability, fg_traceability_cells),
     .options = FG_MEMBER_NOT_IN_JSON, .csv = {.rank = 6}},
    {FG_TEXT_BY("defect", find_defect), .words = "what rejects the foil whatever its values are"},
    {FG_NUMBER_BY("bump_radius_median_mm", find_bump_median_of_foil), .options = FG_MEMBER_LEFT_OUT,
     .words = "median radius of the fitted bumps"},
    {FG_FLAG("exceeded", fg_lot_foil, exceeded),
     .words = "a value is beyond a limit by more than U"},
    {FG_NUMBER("severity", fg_lot_foil, severity),
     .words = "share of what the tolerance allows: 0 in its middle or at the nominal, 1 at its "
              "limit; without tolerances distance from the lot's mean in standard deviations"},
    {FG_TEXT_BY("worst_quantity", find_worst_quantity),
     .words = "quantity of the highest severity"},
    {FG_INTEGER("worst_bump", fg_lot_foil, worst_number), .options = FG_MEMBER_NOT_NEGATIVE,
     .present = fg_lot_has_no_beams, .words = "its bump; 0: the whole foil"},
    {FG_INTEGER("worst_beam", fg_lot_foil, worst_number), .options = FG_MEMBER_NOT_NEGATIVE,
     .present = fg_lot_has_beams, .words = "of a cantilever, instead of worst_bump"},
    {FG_NUMBER("worst_value", fg_lot_foil, worst_value)},
    {FG_NUMBER("worst_u", fg_lot_foil, worst_u), .words = "standard uncertainty of worst_value"},
    {FG_NUMBER("worst_limit", fg_lot_foil, worst_limit), .words = "the limit that is nearer"},
    {FG_NUMBER("worst_margin", fg_lot_foil, worst_margin),
     .words = "how far worst_value is within worst_limit; negative: beyond it"},
};
const fg_members fg_lot_foil_members = FG_MEMBERS_DEFINED(foil_rows, "foil");

/* Dies. */
static const char *find_die_name(const fg_subject *subject, char *buffer) {
  const fg_lot_die_sum *sum = subject->object;
  (void)buffer;
  return sum->die ? sum->die->name : "all";
}

static const char *find_die_sha256(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return ((const fg_lot_die_sum *)subject->object)->die->sha256;
}

static const char *look_at_die(const fg_subject *subject) {
  return ((const fg_lot_die_sum *)subject->object)->die ? NULL : "total";
}

static const fg_member die_sum_rows[] = {
    {FG_TEXT_BY("name", find_die_name), .options = FG_MEMBER_NEVER_NULL,
     .page = {.rank = 1, .heading = "die"}},
    {FG_TEXT_BY("sha256", find_die_sha256), .options = FG_MEMBER_NEVER_NULL,
     .words = "of the die's report"},
    {FG_COUNT("foils", fg_lot_die_sum, foils), .page = {.rank = 1, .heading = "foils"}},
    {FG_COUNT("bumps", fg_lot_die_sum, bumps), .page = {.rank = 1, .heading = "bumps"}},
    {FG_COUNT("bumps_by_mean", fg_lot_die_sum, by_mean),
     .words = "of them: held against the die's mean, for no trace shows theirs"},
    {FG_NUMBER_U("die_radius_error_pct", fg_lot_die_sum, die_error_pct, u_die_error_pct),
     .words = "of the die against the design, mean over the foils' bumps",
     .page = {.rank = 1, .heading = "die against\ndesign, %", .decimals = 3, .plus = true}},
    {FG_NUMBER("radius_error_mean_pct", fg_lot_die_sum, design_mean_pct),
     .words = "of the foils against the design",
     .page = {.rank = 1, .heading = "foils against\ndesign, %", .decimals = 3, .plus = true}},
    {FG_NUMBER("radius_error_sd_pct", fg_lot_die_sum, design_sd_pct),
     .words = "its standard deviation over the bumps",
     .page = {.rank = 1, .heading = "s", .decimals = 3}},
    {FG_NUMBER("radius_error_to_die_mean_pct", fg_lot_die_sum, die_mean_pct),
     .words = "of the foils against the die: springback",
     .page = {.rank = 1, .heading = "foils against\ndie, %", .decimals = 3, .plus = true}},
    {FG_NUMBER("radius_error_to_die_sd_pct", fg_lot_die_sum, die_sd_pct),
     .words = "its standard deviation over the bumps",
     .page = {.rank = 1, .heading = "s", .decimals = 3}},
    {FG_NUMBER("explained_by_die_pct", fg_lot_die_sum, explained_pct),
     .words = "the die's share of the foils' mean error",
     .page = {.rank = 1, .heading = "the die's share\nof the mean, %", .decimals = 1}},
};
const fg_members fg_lot_die_sum_members = FG_MEMBERS_LOOKED_AT(die_sum_rows, look_at_die);

static const fg_member die_rows[] = {
    {FG_ARRAY("each", fg_lot_dies, sum, count, &fg_lot_die_sum_members)},
    {FG_COUNT("bumps", fg_lot_dies, all.bumps), .words = "of all dies"},
    {FG_NUMBER("radius_error_sd_pct", fg_lot_dies, all.design_sd_pct),
     .words = "standard deviation over all bumps, against the design"},
    {FG_NUMBER("radius_error_to_die_sd_pct", fg_lot_dies, all.die_sd_pct),
     .words = "the same against the dies"},
    {FG_NUMBER("explained_variance_pct", fg_lot_dies, explained_variance_pct),
     .words = "share of the variance over all bumps that the dies explain; below 0: none"},
    {FG_NUMBER("foils_differ_pct", fg_lot_dies, foils_differ_pct),
     .words = "of two dies: foils of the second minus those of the first, against the design"},
    {FG_NUMBER("dies_differ_pct", fg_lot_dies, dies_differ_pct),
     .words = "the second die minus the first"},
    {FG_NUMBER("explained_difference_pct", fg_lot_dies, explained_difference_pct),
     .words = "dies_differ_pct over foils_differ_pct"},
};
const fg_members fg_lot_dies_members = FG_MEMBERS(die_rows);
