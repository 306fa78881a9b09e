/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lots over time: JSON, "schema": "foilgauge/lot_index/1", and the table, a line for each lot and
 * quantity. */
#include "lots/members.h"

#include <math.h>
#include <string.h>

#include "core/file.h"
#include "lots/index.h"
#include "report/verdict_members.h"

static const fg_index *index_of(const fg_subject *subject) {
  return subject->whole;
}

/* Radius over design. */
static const char *find_spread_range(const fg_subject *subject, char *buffer) {
  const fg_index_spread *spread = subject->object;
  if (!isfinite(spread->min)) return "––";
  snprintf(buffer, 40, "%.3f to %.3f", spread->min, spread->max);
  return buffer;
}

static const fg_member spread_rows[] = {
    {FG_COUNT("count", fg_index_spread, count), .words = "bumps",
     .page = {.rank = 2, .heading = "bumps"}},
    {FG_NUMBER("mean", fg_index_spread, mean), .words = "of R / R_D",
     .page = {.rank = 2, .heading = "mean", .decimals = 4}},
    {FG_NUMBER("mode", fg_index_spread, mode), .words = "where the density is highest",
     .page = {.rank = 2, .heading = "mode", .decimals = 4}},
    {FG_NUMBER("relative_sd_pct", fg_index_spread, relative_sd_pct), .words = "sd over the mean",
     .page = {.rank = 2, .heading = "relative s", .decimals = 2, .unit = " %"}},
    {FG_NUMBER("min", fg_index_spread, min), .words = "smallest"},
    {FG_NUMBER("max", fg_index_spread, max), .words = "largest"},
    {FG_TEXT_BY("range", find_spread_range), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 2, .heading = "range"}},
};
static const fg_members spread_members = FG_MEMBERS_DEFINED(spread_rows, "spread");
#define SPREAD_WORDS "radius of the bumps over the design's"

static const char *find_lot_name(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return index_of(subject)->lots[subject->index].name;
}

static double find_number(const fg_subject *subject) {
  return (double)subject->index + 1;
}

static const fg_member lot_spread_rows[] = {
    {FG_COUNT_BY("number", find_number), .page = {.rank = 1, .heading = "no."}},
    {FG_TEXT_BY("name", find_lot_name), .page = {.rank = 1, .heading = "lot", .words = true}},
    {FG_SAME(&spread_members)},
};
const fg_members fg_index_lot_spread_members = FG_INDEX_TABLE(lot_spread_rows, NULL, NULL);

bool fg_index_lot_spread_at(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_index *index = list->whole;
  element->object = &index->lots[i].spread;
  return i < index->read;
}

/* A quantity of a lot: the subject's index is that of the lot's and the axis' in one. */
static const fg_index_lot *lot_of_stat(const fg_subject *subject) {
  return &index_of(subject)->lots[subject->index / index_of(subject)->axis_count];
}

static const fg_index_axis *axis_of_stat(const fg_subject *subject) {
  return &index_of(subject)->axes[subject->index % index_of(subject)->axis_count];
}

static bool find_stat(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_index *index = list->whole;
  if (i >= index->read * index->axis_count) return false;
  element->object = fg_index_stat_of(axis_of_stat(element), lot_of_stat(element));
  return true;
}

static bool find_stat_of_lot(const fg_subject *lot, size_t i, fg_subject *element) {
  const fg_index *index = lot->whole;
  if (i >= index->axis_count) return false;
  element->object = fg_index_stat_of(&index->axes[i], lot->object);
  return true;
}

static const char *find_stat_name(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return ((const fg_index_stat *)subject->object)->row->name;
}

static const char *stat_key(const fg_subject *subject) {
  return find_stat_name(subject, NULL);
}

static int find_stat_scale(const fg_subject *subject) {
  return (int)axis_of_stat(subject)->scale;
}

static double find_stat_lot(const fg_subject *subject) {
  return (double)fg_index_number(subject->whole, lot_of_stat(subject));
}

static double find_stat_design(const fg_subject *subject) {
  return (double)lot_of_stat(subject)->design_number;
}

#define LOT_TEXT(function, value)                                                                  \
  static const char *function(const fg_subject *subject, char *buffer) {                           \
    (void)buffer;                                                                                  \
    return lot_of_stat(subject)->value;                                                            \
  }
LOT_TEXT(find_stat_folder, folder)
LOT_TEXT(find_stat_lot_name, name)
LOT_TEXT(find_stat_date, date.first)

static int find_stat_verdict(const fg_subject *subject) {
  return (int)lot_of_stat(subject)->verdict;
}

/* Columns of the table alone: the JSON has them around the quantity. */
#define OF_TABLE          .options = FG_MEMBER_NOT_IN_JSON, .csv = {.rank = 1}
#define STAT(name, field) FG_NUMBER(name, fg_index_stat, field), .csv = {.rank = 2}

static const fg_member stat_rows[] = {
    {FG_COUNT_BY("lot", find_stat_lot), OF_TABLE},
    {FG_TEXT_BY("folder", find_stat_folder), OF_TABLE},
    {FG_TEXT_BY("name", find_stat_lot_name), OF_TABLE},
    {FG_TEXT_BY("date", find_stat_date), OF_TABLE},
    {FG_WORD_BY("verdict", find_stat_verdict, fg_verdict_words), OF_TABLE},
    {FG_COUNT_BY("design", find_stat_design), OF_TABLE},
    {FG_TEXT_BY("quantity", find_stat_name), OF_TABLE},
    {FG_WORD_BY("scale", find_stat_scale, fg_index_scale_words), OF_TABLE},
    {FG_COUNT("count", fg_index_stat, count), .words = "bumps, beams or foils", .csv = {.rank = 1}},
    {STAT("mean", mean), .words = "of single values; over_design: all over the design's"},
    {STAT("sd", sd), .words = "of single values"},
    {STAT("median", median), .words = "of single values"},
    {STAT("min", min), .words = "smallest single value"},
    {STAT("max", max), .words = "largest single value"},
    {STAT("tolerance_min", lower), .words = "null: no such limit"},
    {STAT("tolerance_max", upper), .words = "null: no such limit"},
    {FG_COUNT("foils", fg_index_stat, foils), .words = "with a value", .csv = {.rank = 1}},
    {STAT("foil_mean", foil_mean), .words = "of the foils' means"},
    {STAT("foil_sd", foil_sd), .words = "of the foils' means"},
    {STAT("expected_low", expected_low),
     .words = "from here the other lots put the mean of this one, at three sigma; null: fewer than "
              "five lots"},
    {STAT("expected_high", expected_high), .words = "to here"},
    {FG_FLAG("unexpected", fg_index_stat, unexpected), .words = "the mean lies outside"},
};
static const fg_members stat_members = FG_MEMBERS_DEFINED(stat_rows, "stat");

/* A lot. */
static const char *const from_words[] = {FG_LOT_DATE_MANIFEST, FG_LOT_DATE_SCANS, NULL};

static const fg_member date_rows[] = {
    {FG_TEXT("first", fg_lot_date, first), .options = FG_MEMBER_EMPTY_IS_NULL, .words = "earliest"},
    {FG_TEXT("last", fg_lot_date, last), .options = FG_MEMBER_EMPTY_IS_NULL, .words = "latest"},
    {FG_STRING("from", fg_lot_date, from), .choices = from_words,
     .words = "manifest: its column `date`; scans: the times of their files"},
};
static const fg_members date_members = FG_MEMBERS_DEFINED(date_rows, "date");

static double count_not_measured(const fg_subject *subject) {
  const fg_index_lot *lot = subject->object;
  return (double)(lot->by_verdict[FG_VERDICT_NOT_MEASURED] + lot->failed_scans);
}

#define OF_VERDICT(name, verdict) FG_COUNT(name, fg_index_lot, by_verdict[verdict])

static const fg_member count_rows[] = {
    {FG_COUNT("scans", fg_index_lot, scans), .words = "of the lot"},
    {FG_COUNT("scans_not_measured", fg_index_lot, failed_scans), .words = "without a foil"},
    {FG_COUNT("foils", fg_index_lot, foils), .words = "of the lot",
     .page = {.rank = 2, .heading = "foils"}},
    {OF_VERDICT("pass", FG_VERDICT_PASS), .words = "foils", .page = {.rank = 2, .heading = "pass"}},
    {OF_VERDICT("fail", FG_VERDICT_FAIL), .words = "foils", .page = {.rank = 2, .heading = "fail"}},
    {OF_VERDICT("cannot_tell", FG_VERDICT_UNDECIDED), .words = "foils",
     .page = {.rank = 2, .heading = "cannot\ntell"}},
    {OF_VERDICT("not_measured", FG_VERDICT_NOT_MEASURED), .words = "foils"},
    {FG_COUNT_BY("not_measured", count_not_measured), .options = FG_MEMBER_NOT_IN_JSON,
     .words = "foils, and scans without a foil", .page = {.rank = 2, .heading = "not\nmeasured"}},
    {OF_VERDICT("no_tolerance", FG_VERDICT_NONE), .words = "foils"},
    {FG_COUNT("exceeded", fg_index_lot, exceeded), .words = "tolerances that a foil exceeds"},
};
static const fg_members count_members = FG_MEMBERS_DEFINED(count_rows, "counts");

static double find_lot_in_tolerance(const fg_subject *subject) {
  return fg_is_in_tolerance(((const fg_index_lot *)subject->object)->verdict);
}

static bool is_read(const fg_subject *subject) {
  return !((const fg_index_lot *)subject->object)->problem;
}

static bool has_dies(const fg_subject *list) {
  return index_of(list)->die_count > 0;
}

static bool has_coils(const fg_subject *list) {
  const fg_index *index = index_of(list);
  for (size_t i = 0; i < index->read; i++)
    if (index->lots[i].coils) return true;
  return false;
}

static fg_subject find_lot_prediction(const fg_subject *subject) {
  const fg_index_prediction *prediction = &((const fg_index_lot *)subject->object)->prediction;
  return (fg_subject){.object = prediction->known ? prediction : NULL, .whole = subject->whole};
}

static const fg_member read_rows[] = {
    {FG_COUNT_BY("number", find_number), .options = FG_MEMBER_NOT_IN_JSON,
     .words = "in order of date, by which every figure is numbered",
     .page = {.rank = 1, .heading = "no."}},
    {FG_STRING("name", fg_index_lot, name), .options = FG_MEMBER_NEVER_NULL, .words = "of the lot",
     .page = {.rank = 1, .heading = "lot", .words = true}, .markup = fg_index_put_lot_link},
    {FG_OBJECT("date", fg_index_lot, date, &date_members), .options = FG_MEMBER_ON_LINE},
    {FG_TEXT("date", fg_index_lot, date.first), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .heading = "date"}, .markup = fg_index_put_lot_date},
    {FG_TEXT("version", fg_index_lot, version), .words = "of the program that measured it"},
    {FG_FLAG_BY("in_tolerance", find_lot_in_tolerance), .options = FG_MEMBER_NULLABLE,
     .words = FG_IN_TOLERANCE_WORDS},
    {FG_WORD("verdict", fg_index_lot, verdict, fg_verdict_words), .words = "that of its worst foil",
     .page = {.rank = 1, .heading = "verdict"}, .markup = fg_index_put_lot_verdict},
    {FG_GROUP("counts", &count_members), .options = FG_MEMBER_ON_LINE},
    {FG_SAME(&count_members), .options = FG_MEMBER_NOT_IN_JSON},
    {FG_STRING("dies", fg_index_lot, die_names), .words = "names of its foils' dies",
     .page = {.rank = 3, .heading = "die", .words = true}, .column = has_dies},
    {FG_STRING("coils", fg_index_lot, coils), .words = "names of its foils' coils",
     .page = {.rank = 3, .heading = "coil", .words = true}, .column = has_coils},
    {FG_TEXT("design_name", fg_index_lot, design.name), .words = "as the lot's design says",
     .page = {.rank = 3, .heading = "design", .words = true}, .markup = fg_index_put_lot_design},
    {FG_COUNT("design_number", fg_index_lot, design_number), .lowest = 1,
     .words = "lots of one number are of one design, whatever its name and tolerances"},
    {FG_STRING("foils_unknown", fg_index_lot, foils_unknown),
     .words = "why there are no values foil by foil"},
    {FG_OBJECT("radius_over_design", fg_index_lot, spread, &spread_members),
     .options = FG_MEMBER_ON_LINE, .words = SPREAD_WORDS},
    {FG_PART("prediction", find_lot_prediction, &fg_index_prediction_members),
     .options = FG_MEMBER_ON_LINE | FG_MEMBER_NULLABLE,
     .words = "its die's, held by `foilgauge lot --expected`; null: none"},
    {FG_MAP_BY("quantities", find_stat_of_lot, stat_key, &stat_members),
     .options = FG_MEMBER_ON_LINE, .words = "by their names"},
};
static const fg_members read_members = FG_MEMBERS(read_rows);

static const fg_member lot_rows[] = {
    {FG_STRING("folder", fg_index_lot, folder), .options = FG_MEMBER_NEVER_NULL,
     .words = "as given"},
    {FG_SHA256("sha256", fg_index_lot, sha256), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "of its lot.json"},
    {FG_STRING("problem", fg_index_lot, problem),
     .words = "why nothing else is known of it; null: it is read"},
    {FG_SAME(&read_members), .present = is_read},
};
const fg_members fg_index_lot_members = FG_INDEX_TABLE(lot_rows, "lot", NULL);

bool fg_index_read_lot_at(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_index *index = list->whole;
  element->object = &index->lots[i];
  return i < index->read;
}

/* An axis. */
static const char *find_axis_name(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return ((const fg_index_axis *)subject->object)->row->name;
}

static const char *find_same_axis(const fg_subject *subject, char *buffer) {
  const fg_index_axis *axis = subject->object;
  (void)buffer;
  return axis->same_as == FG_INDEX_NONE ? NULL : index_of(subject)->axes[axis->same_as].row->name;
}

static const fg_member axis_rows[] = {
    {FG_TEXT_BY("name", find_axis_name), .options = FG_MEMBER_NEVER_NULL,
     .words = "of the quantity"},
    {FG_WORD("scale", fg_index_axis, scale, fg_index_scale_words), .words = FG_INDEX_SCALE_WORDS},
    {FG_TEXT_BY("same_as", find_same_axis),
     .words = "a quantity that says the same of every foil: tested once"},
    {FG_COUNT("lots", fg_index_axis, lots), .words = "whose foils are known, two at least of each"},
    {FG_NUMBER_U("centre", fg_index_axis, between.centre, between.u_centre),
     .words = "of the lots' means"},
    {FG_NUMBER("between_sd", fg_index_axis, between.sd),
     .words = "of the lots' means, beyond what foils scatter (Paule and Mandel)"},
    {FG_NUMBER("between_sd_low", fg_index_axis, between.sd_low), .words = "its 95 % interval"},
    {FG_NUMBER("between_sd_high", fg_index_axis, between.sd_high), .words = "its end"},
    {FG_NUMBER("within_sd", fg_index_axis, within_sd), .words = "of foils within lots"},
    {FG_NUMBER("p_equal", fg_index_axis, p_equal), .words = "p-value of all lots having one mean"},
};
static const fg_members axis_members = FG_MEMBERS_DEFINED(axis_rows, "axis");

/* A die. */
static const fg_member die_rows[] = {
    {FG_STRING("name", fg_index_die, name), .options = FG_MEMBER_NEVER_NULL, .words = "of the die"},
    {FG_COUNT("foils", fg_index_die, foils), .words = "of all lots"},
    {FG_COUNT("lots", fg_index_die, lots), .words = "with foils of it"},
    {FG_OBJECT("radius_over_design", fg_index_die, spread, &spread_members),
     .options = FG_MEMBER_ON_LINE, .words = SPREAD_WORDS},
};
static const fg_members die_members = FG_MEMBERS(die_rows);

static const fg_index_die *die_of(const fg_subject *subject) {
  return &index_of(subject)->dies[subject->index];
}

static const char *find_die_name(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return die_of(subject)->name;
}

static double find_die_lots(const fg_subject *subject) {
  return (double)die_of(subject)->lots;
}

static double find_die_foils(const fg_subject *subject) {
  return (double)die_of(subject)->foils;
}

static const fg_member die_spread_rows[] = {
    {FG_TEXT_BY("name", find_die_name), .page = {.rank = 1, .heading = "die"}},
    {FG_COUNT_BY("lots", find_die_lots), .page = {.rank = 1, .heading = "lots"}},
    {FG_COUNT_BY("foils", find_die_foils), .page = {.rank = 1, .heading = "foils"}},
    {FG_SAME(&spread_members)},
};
const fg_members fg_index_die_spread_members = FG_INDEX_TABLE(die_spread_rows, NULL, NULL);

bool fg_index_die_spread_at(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_index *index = list->whole;
  element->object = &index->dies[i].spread;
  return i < index->die_count;
}

/* The report. */
static const char *sentence_at(const fg_subject *subject, size_t i) {
  const fg_index *index = index_of(subject);
  return i < index->sentence_count ? index->sentences[i] : NULL;
}

/* Finds line `i` of the notes. */
static bool find_note(const fg_subject *subject, size_t i, fg_subject *element) {
  const char *line = index_of(subject)->notes;
  for (; line && *line && i > 0; i--) {
    line = strchr(line, '\n');
    if (line) line++;
  }
  element->object = line;
  return line && *line;
}

static const char *find_note_line(const fg_subject *subject, char *buffer) {
  const char *line = subject->object;
  snprintf(buffer, 1200, "%.*s", (int)strcspn(line, "\n"), line);
  return buffer;
}

static const fg_member note_rows[] = {
    {FG_TEXT_BY(NULL, find_note_line), .options = FG_MEMBER_NEVER_NULL}};
static const fg_members note_members = FG_MEMBERS(note_rows);

static double count_unread(const fg_subject *subject) {
  return (double)(index_of(subject)->count - index_of(subject)->read);
}

static const fg_member index_rows[] = {
    {FG_HEAD("foilgauge/lot_index/1")},
    {FG_TEXTS_BY("summary", sentence_at), .words = "the most important sentence first"},
    {FG_COUNT("lots_read", fg_index, read)},
    {FG_COUNT_BY("lots_not_read", count_unread), .words = "each says why"},
    {FG_COUNT("designs", fg_index, designs), .words = "different ones"},
    {FG_LIST("lots", fg_index, lots, count, &fg_index_lot_members),
     .words = "in order of date, unread ones last"},
    {FG_LIST("quantities", fg_index, axes, axis_count, &axis_members), .options = FG_MEMBER_ON_LINE,
     .words = "over all lots"},
    {FG_GROUP("comparisons", &fg_index_comparison_members),
     .words = "Welch's test of the means of foils"},
    {FG_LIST("dies", fg_index, dies, die_count, &die_members)},
    {FG_LIST("die_comparisons", fg_index, die_pairs, die_pair_count, &fg_index_die_pair_members),
     .options = FG_MEMBER_ON_LINE, .words = "by p-value"},
    {FG_LIST_BY("notes", find_note, &note_members), .words = "to know of the lots"},
};
static const fg_members index_members = FG_MEMBERS(index_rows);

const fg_document fg_index_document = {
    .file = "lot_index",
    .title = "foilgauge index of lots",
    .description = "Lots over time and against each other, in order of date. Units are in the "
                   "names of quantities. null is a value that is not known.",
    .made_by = "`foilgauge lot --index -o`",
    .members = &index_members,
};

fg_status fg_index_write_json(fg_context *ctx, const fg_index *index, FILE *out) {
  fg_document_json(out, &index_members, index);
  return fg_stream_finish(ctx, out, "the index of lots");
}

fg_status fg_index_write_csv(fg_context *ctx, const fg_index *index, FILE *out) {
  fg_members_csv(out, &stat_members, &(fg_subject){.object = index, .whole = index}, find_stat);
  return fg_stream_finish(ctx, out, "the table of lots");
}
