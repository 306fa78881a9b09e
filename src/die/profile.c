/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A profile from the text that profilometers write. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/memory.h"
#include "core/sha256.h"
#include "die/header.h"

enum { PROFILE_BYTES_MAX = 256 << 20, FIELD_SHOWN = 24 };

/* A file being read, for messages. */
typedef struct reader {
  fg_context *ctx;
  const fg_die_source *source;
  const char *text, *data; /* all of it; where the numbers begin */
  size_t first_line;       /* of the data */
  fg_die_style style;
  size_t columns, column[2]; /* from 0 */
} reader;

const char *fg_die_half_word(fg_die_half half) {
  return half == FG_DIE_CONCAVE ? "concave" : "convex";
}

const char *fg_die_unit_word(fg_die_unit unit) {
  static const char *const words[] = {"", "mm", "um", "nm"};
  return words[unit];
}

static double mm_per(fg_die_unit unit) {
  return unit == FG_DIE_MM ? 1 : unit == FG_DIE_UM ? 1e-3 : 1e-6;
}

static fg_status fail_line(const reader *r, size_t line, const char *why) {
  return fg_fail(r->ctx, FG_ERR_DATA, "%s: line %zu: %s", r->source->path, line, why);
}

static bool is_empty(const char *line) {
  return strspn(line, " \t\"") == (size_t)(fg_die_line_end(line) - line);
}

static fg_status find_data(reader *r) {
  size_t line = 1, single = 0;
  for (const char *at = r->text; *at; at = fg_die_line_next(at), line++) {
    const char *end = fg_die_line_end(at);
    if (fg_die_is_data(at, end)) {
      r->data = at;
      r->first_line = line;
      return FG_OK;
    }
    single += fg_die_looks_numeric(at, end);
  }
  if (!r->text[0] || is_empty(r->text + strspn(r->text, "\r\n")))
    return fg_fail(r->ctx, FG_ERR_DATA, "%s: the file is empty; export the profile again",
                   r->source->path);
  return fg_fail(r->ctx, FG_ERR_DATA,
                 single > 2 ? "%s: one number in a line; a profile has two columns, x and z"
                            : "%s: no line with two numbers; export the profile as text with "
                              "columns x and z",
                 r->source->path);
}

/* Chooses the columns x and z: as stated, by the headings, or the only two. */
static fg_status choose_columns(reader *r, const fg_die_header *header) {
  for (int axis = 0; axis < 2; axis++) {
    size_t said = r->source->column[axis] ? r->source->column[axis] : header->column[axis];
    if (!said && r->columns == 2) said = (size_t)axis + 1;
    if (!said)
      return fg_fail(r->ctx, FG_ERR_DATA,
                     "%s: line %zu: %zu columns, and no heading says which is %s; say --columns "
                     "X,Z (their numbers, from 1)",
                     r->source->path, r->first_line, r->columns, axis ? "z" : "x");
    if (said > r->columns || said > FG_DIE_FIELDS_MAX)
      return fg_fail(r->ctx, FG_ERR_DATA, "%s: line %zu: no column %zu; there are %zu",
                     r->source->path, r->first_line, said, r->columns);
    r->column[axis] = said - 1;
  }
  if (r->column[0] != r->column[1]) return FG_OK;
  return fg_fail(r->ctx, FG_ERR_DATA, "%s: x and z are the same column", r->source->path);
}

/* Text behind the data, with no number in a line after it. */
static bool is_footer(const char *line) {
  if (strchr("0123456789+-.,", *line)) return false;
  for (const char *at = line; *at; at = fg_die_line_next(at))
    if (fg_die_is_data(at, fg_die_line_end(at))) return false;
  return true;
}

static fg_status read_point(const reader *r, const char *line, size_t number, fg_point *point) {
  fg_die_field fields[FG_DIE_FIELDS_MAX];
  size_t count = fg_die_split(line, fg_die_line_end(line), r->style.separator, fields);
  double *values[2] = {&point->x, &point->y};
  for (int axis = 0; axis < 2; axis++) {
    size_t column = r->column[axis];
    if (count != r->columns)
      return fg_fail(r->ctx, FG_ERR_DATA,
                     "%s: line %zu: %zu columns where the lines before have %zu; was the file cut "
                     "off, or are two profiles in it?",
                     r->source->path, number, count, r->columns);
    if (fg_die_number(&fields[column], r->style.comma_decimal, values[axis])) continue;
    int shown = (int)(fields[column].length < FIELD_SHOWN ? fields[column].length : FIELD_SHOWN);
    return fg_fail(r->ctx, FG_ERR_DATA,
                   "%s: line %zu: %s is '%.*s', which is no number; take out points that the "
                   "instrument has lost, or export the profile again",
                   r->source->path, number, axis ? "z" : "x", shown, fields[column].text);
  }
  return FG_OK;
}

static fg_status read_points(const reader *r, fg_die_profile *profile) {
  size_t capacity = 0, number = r->first_line;
  for (const char *at = r->data; *at; at = fg_die_line_next(at), number++) {
    if (is_empty(at)) continue;
    if (!fg_die_looks_numeric(at, fg_die_line_end(at)) && is_footer(at)) break;
    FG_TRY(fg_memory_reserve(r->ctx, profile->count + 1, sizeof *profile->points, &capacity,
                             (void **)&profile->points));
    FG_TRY(read_point(r, at, number, &profile->points[profile->count]));
    profile->count++;
  }
  return FG_OK;
}

/* x must go one way; a profile that was traced from right to left is turned round. */
static fg_status check_order(const reader *r, fg_die_profile *p) {
  if (p->count < 2) return fail_line(r, r->first_line, "one point is no profile");
  bool down = p->points[p->count - 1].x < p->points[0].x;
  for (size_t i = 1; i < p->count; i++) {
    double step = p->points[i].x - p->points[i - 1].x;
    if (down ? step > 0 : step < 0)
      return fg_fail(r->ctx, FG_ERR_DATA,
                     "%s: point %zu (x = %.10g after %.10g): x goes back; the points must be in "
                     "the order of the trace, one profile in a file",
                     r->source->path, i + 1, p->points[i].x, p->points[i - 1].x);
  }
  for (size_t i = 0; down && i < p->count / 2; i++) {
    fg_point swap = p->points[i];
    p->points[i] = p->points[p->count - 1 - i];
    p->points[p->count - 1 - i] = swap;
  }
  return FG_OK;
}

static fg_status choose_units(const reader *r, const fg_die_header *header, fg_die_profile *p) {
  for (int axis = 0; axis < 2; axis++) {
    fg_die_unit said = r->source->unit[axis], written = header->unit[axis];
    p->unit[axis] = said ? said : written;
    if (said && written && said != written)
      return fg_fail(r->ctx, FG_ERR_DATA,
                     "%s: the header says %s of %s, the command %s; which is right? Correct one",
                     r->source->path, fg_die_unit_word(written), axis ? "z" : "x",
                     fg_die_unit_word(said));
    if (!p->unit[axis])
      return fg_fail(
          r->ctx, FG_ERR_DATA,
          "%s: the header %s; say --unit mm or --unit um (x and z each: --unit mm,um)",
          r->source->path,
          header->other_unit
              ? (axis ? "has a unit of z that is not read" : "has a unit of x that is not read")
              : (axis ? "does not say the unit of z" : "does not say the unit of x"));
  }
  for (size_t i = 0; i < p->count; i++) {
    p->points[i].x *= mm_per(p->unit[0]);
    p->points[i].y *= mm_per(p->unit[1]);
  }
  return FG_OK;
}

/* The file's own name, without its folders. */
static const char *half_of_name(const char *path) {
  const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
  return fg_die_half_in(name, strlen(name));
}

static fg_status choose_half(const reader *r, const fg_die_header *header, fg_die_profile *p) {
  const char *said = r->source->half, *named = half_of_name(r->source->path);
  const char *half = said ? said : header->half ? header->half : named;
  if (!half)
    return fg_fail(r->ctx, FG_ERR_DATA,
                   "%s: nothing says which half it traces; put --half concave (grooves) or --half "
                   "convex (ridges) before it, or the word into its name",
                   r->source->path);
  if (header->half && strcmp(half, header->half) != 0)
    return fg_fail(r->ctx, FG_ERR_DATA, "%s: the header says %s, the command %s", r->source->path,
                   header->half, half);
  if (!said && named && strcmp(half, named) != 0)
    return fg_fail(r->ctx, FG_ERR_DATA,
                   "%s: the header says %s, the file's name %s; say which with --half",
                   r->source->path, half, named);
  p->half = strcmp(half, "concave") ? FG_DIE_CONVEX : FG_DIE_CONCAVE;
  return FG_OK;
}

static fg_status choose_tip(const reader *r, const fg_die_header *header, fg_die_profile *p) {
  double said = r->source->tip_um;
  p->tip_um = isnan(said) ? header->tip_um : said;
  if (isnan(p->tip_um))
    return fg_fail(r->ctx, FG_ERR_DATA,
                   "%s: the header does not say the radius of the tip; say --tip-um N (0 where the "
                   "instrument has taken it off already)",
                   r->source->path);
  if (isnan(said) || isnan(header->tip_um) || said == 0 ||
      fabs(said - header->tip_um) <= 1e-3 * header->tip_um)
    return FG_OK;
  return fg_fail(
      r->ctx, FG_ERR_DATA,
      "%s: the header says a tip of %g um, the command %g um; which is right? Correct one",
      r->source->path, header->tip_um, said);
}

static fg_status check_count(const reader *r, const fg_die_header *header,
                             const fg_die_profile *p) {
  if (header->points <= p->count) return FG_OK;
  return fg_fail(
      r->ctx, FG_ERR_DATA,
      "%s: the header says %zu points, the file has %zu: it was cut off; export it again",
      r->source->path, header->points, p->count);
}

static fg_status read_profile_text(reader *r, fg_die_profile *p) {
  fg_die_header header;
  fg_die_field fields[FG_DIE_FIELDS_MAX];
  FG_TRY(find_data(r));
  const char *uncertainty = fg_die_style_find(r->data, &r->style);
  if (uncertainty) return fail_line(r, r->first_line, uncertainty);
  r->columns = fg_die_split(r->data, fg_die_line_end(r->data), r->style.separator, fields);
  fg_die_header_read(r->text, r->data, r->style.separator, r->columns, &header);
  FG_TRY(choose_columns(r, &header));
  FG_TRY(read_points(r, p));
  FG_TRY(check_count(r, &header, p));
  FG_TRY(check_order(r, p));
  FG_TRY(choose_half(r, &header, p));
  FG_TRY(choose_tip(r, &header, p));
  p->first_line = r->first_line;
  return choose_units(r, &header, p);
}

static fg_status check_text(fg_context *ctx, const char *path, const char *text) {
  size_t control = 0;
  for (const char *at = text; *at; at++)
    control += (unsigned char)*at < ' ' && !strchr("\t\r\n\f\x1a", *at);
  if (!control) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: not a text (%zu control characters); export the profile as text with columns "
                 "x and z",
                 path, control);
}

fg_status fg_die_profile_load(fg_context *ctx, const fg_die_source *source,
                              fg_die_profile *profile) {
  char *text = NULL;
  memset(profile, 0, sizeof *profile);
  fg_status status = FG_OK;
  FG_TRY(fg_file_read_text(ctx, source->path, PROFILE_BYTES_MAX, &text));
  FG_TRY_EXIT(check_text(ctx, source->path, text));
  fg_sha256_text(text, profile->sha256);
  const char *begin = !strncmp(text, "\xef\xbb\xbf", 3) ? text + 3 : text;
  reader r = {.ctx = ctx, .source = source, .text = begin};
  status = read_profile_text(&r, profile);
exit:
  free(text);
  if (status != FG_OK) fg_die_profile_free(profile);
  return status;
}

void fg_die_profile_free(fg_die_profile *profile) {
  if (!profile) return;
  free(profile->points);
  memset(profile, 0, sizeof *profile);
}
