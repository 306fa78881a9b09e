/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of results: one row of a table for each, the one source of all its writers.
 *
 * A row has the member's JSON name, the place of its value in a struct (or a function that gives
 * it), its words for people, and the columns in which tables show it. One walker each writes JSON,
 * CSV, the terminal's table, the page's table (page/table.h), the JSON schema and the manual's
 * list; another reads JSON. So a number that gets a row is in all of them.
 *
 * Rows are made by the macros below, which check the type of the field:
 *
 *   static const fg_member direction_rows[] = {
 *       {FG_NUMBER_U("gap_mm", fg_load_direction, gap.value, gap.u),
 *        .words = "free travel of the rotor", .page = {.rank = 3, .heading = "gap,\nµm", .decimals
 * = 1, .scale = 1000}, .csv = {.rank = 14}}, {FG_COUNT("cycles", fg_load_direction, cycles), .words
 * = "closed loops"},
 *   };
 *   static const fg_members direction_members = FG_MEMBERS(direction_rows);
 */
#ifndef FG_CORE_MEMBER_H
#define FG_CORE_MEMBER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "core/json_writer.h"
#include "foilgauge/status.h"

/* Object whose members are asked for, and the whole report it belongs to, for members that depend
 * on more than their own object. */
typedef struct fg_subject {
  const void *object, *whole;
  size_t index; /* of an element in its list */
} fg_subject;

typedef enum fg_member_kind {
  FG_MEMBER_NUMBER,   /* double; NaN: not known */
  FG_MEMBER_COUNT,    /* size_t */
  FG_MEMBER_INTEGER,  /* int */
  FG_MEMBER_UNSIGNED, /* unsigned */
  FG_MEMBER_SEED,     /* uint64_t */
  FG_MEMBER_FLAG,     /* bool */
  FG_MEMBER_TEXT,     /* char[] */
  FG_MEMBER_STRING,   /* const char *; NULL: not known */
  FG_MEMBER_WORD,     /* enum: an index of `choices` */
  FG_MEMBER_RANGE,    /* two doubles: those at `offset` and `u_offset` */
  FG_MEMBER_PAIR,     /* two doubles beside each other, x and y; their u likewise */
  FG_MEMBER_NUMBERS,  /* doubles, on one line */
  FG_MEMBER_TEXTS,    /* texts by `text_at` */
  FG_MEMBER_OBJECT,   /* object with members of its own */
  FG_MEMBER_LIST,     /* array of such objects */
  FG_MEMBER_MAP,  /* object of such objects, each under the name that `key` gives; without a name,
                     they stand in the object around it, and `choices` names them */
  FG_MEMBER_SAME, /* members of another table beside these, without a name of their own */
  FG_MEMBER_HEAD, /* "schema" (`name`) and "version", which begin every document */
  FG_MEMBER_WRITTEN, /* by `write`, as `schema` has it */
} fg_member_kind;

typedef enum fg_member_option {
  FG_MEMBER_ON_LINE = 1u << 0,       /* object or array on one line; of a list: each element */
  FG_MEMBER_LEFT_OUT = 1u << 1,      /* left out where it is not known; else null */
  FG_MEMBER_NEVER_NULL = 1u << 2,    /* always known; numbers are null by default where unknown */
  FG_MEMBER_NOT_NEGATIVE = 1u << 3,  /* 0 or more, for the schema */
  FG_MEMBER_EMPTY_IS_NULL = 1u << 4, /* the text "" is not known, and so is the number 0 */
  FG_MEMBER_LIST_ON_LINE = 1u << 5,  /* of a list: all of it on one line */
  FG_MEMBER_NULLABLE = 1u << 6,    /* may be null: a count, integer, flag, object, empty NUMBERS */
  FG_MEMBER_EXACT = 1u << 7,       /* its numbers lose no digit */
  FG_MEMBER_NOT_IN_JSON = 1u << 8, /* a column of tables alone */
  FG_MEMBER_ENDS_BELOW = 1u << 15, /* with ON_LINE, LIST_ON_LINE: its bracket closes on the next */
  FG_MEMBER_EITHER = 1u << 9,      /* the schema has it beside the row of this name before it */
  FG_MEMBER_NO_VERSION = 1u << 10, /* of HEAD: the schema's name alone */
  /* Of reading (core/member_read.h). */
  FG_MEMBER_REQUIRED = 1u << 11,  /* must be there */
  FG_MEMBER_NOT_EMPTY = 1u << 12, /* of a map's elements: an object with a member at least */
  FG_MEMBER_ABOVE_0 = 1u << 13,   /* a number above 0, for the schema too */
  FG_MEMBER_ANY_TEXT = 1u << 14,  /* a text may hold control characters, as a path or command may */
} fg_member_option;

/* A column of a table. Columns stand by rank, those of one rank in the order of the rows. */
typedef struct fg_member_column {
  int rank;            /* from 1; 0: not shown */
  const char *heading; /* NULL: the row's; a line break where '\n' stands */
  int decimals;        /* of a number; with `by_u` the least; CSV, 0: as JSON has it */
  bool by_u;           /* as many decimals as U = 2 u has with two digits */
  int digits;          /* > 0: significant digits (%.3g) in place of decimals */
  double min;          /* with `digits`: a value below is shown as "< 1e-12" */
  double scale;        /* from the member's unit to the heading's; 0: 1 */
  const char *unit;    /* written behind the value: "°"; NULL: the heading tells it */
  bool plus;           /* values above 0 have their sign */
  bool no_u;           /* without its U, though it has one */
  bool words;          /* text for reading: aligned left, wrapped */
} fg_member_column;

typedef enum fg_member_medium { FG_ON_CSV, FG_ON_PAGE, FG_ON_TERMINAL, FG_MEDIA } fg_member_medium;

typedef struct fg_member fg_member;

typedef struct fg_members {
  const fg_member *rows;
  size_t count;
  /* Definition of the schema: the object is described once, under this name ("bump"), and referred
   * to. NULL: described where it stands. */
  const char *definition;
  bool nullable;    /* the definition allows null in place of the object */
  const char *file; /* schema that holds the definition ("measure"); NULL: the document's own */
  /* Limits of the object that no row has, members of its schema as JSON text; NULL: none. */
  const char *limits;
  /* Class of an element's line in the page's table ("total"); NULL: none, of either. */
  const char *(*look)(const fg_subject *element);
  const char *frame; /* class around the page's table beside "scroll" ("lots"); NULL: none */
} fg_members;

/* Finds element `i` of a list and returns false behind the last. An element with a NULL object is
 * skipped. `element` comes with the list's own `whole`. */
typedef bool fg_member_element(const fg_subject *list, size_t i, fg_subject *element);

enum { FG_MEMBER_TEXT_MAX = 4096, FG_MEMBER_NUMBERS_MAX = 64 };

struct cJSON;
struct fg_reading;

/* Reads a member by a function of its own; `object` is the struct that its row belongs to. */
typedef fg_status fg_member_reader(const struct fg_reading *reading, const fg_member *member,
                                   const struct cJSON *item, void *object);

struct fg_member {
  const char *name; /* JSON name, unit included */
  fg_member_kind kind;
  unsigned options; /* fg_member_option */
  size_t offset;
  size_t u_offset;  /* standard uncertainty, written under "u_" and the name; 0: none */
  size_t sd_offset; /* standard deviation, written between both as "sd_" and the name; 0: none */
  size_t repeat_offset; /* of repeats alone, "u_repeat_" and the name; 0: none */
  size_t count_offset;  /* number of a list's elements (size_t) */
  size_t stride;        /* bytes of a list's element; bytes of a text */
  bool pointed;         /* the field points to the object or the elements */

  /* Values that are no field. */
  double (*number)(const fg_subject *); /* of a number, count or flag; NaN: not known */
  double (*u)(const fg_subject *);      /* its standard uncertainty */
  const char *(*text)(const fg_subject *, char buffer[FG_MEMBER_TEXT_MAX]); /* NULL: not known */
  int (*word)(const fg_subject *); /* of WORD: index of `choices`; -1: not known */
  /* Of NUMBERS: the values, in the buffer or elsewhere, and their count. */
  const double *(*numbers)(const fg_subject *, double buffer[FG_MEMBER_NUMBERS_MAX], size_t *count);
  const char *(*text_at)(const fg_subject *,
                         size_t i);       /* of TEXTS; NULL behind the last, "" skips */
  fg_subject (*part)(const fg_subject *); /* of OBJECT and SAME; object NULL: not known */
  fg_member_element *element;             /* of LIST and MAP */
  const char *(*key)(const fg_subject *); /* of MAP: the element's name */
  bool (*row_at)(size_t i,
                 fg_member *row); /* of SAME: rows made one by one; false behind the last */
  /* Of WRITTEN; of another kind it prepares what the rows read, and writes in place of the kind. */
  void (*write)(fg_json *, const char *name, const fg_subject *);
  bool (*present)(const fg_subject *); /* false: left out; NULL: always there */
  bool (*line)(const fg_subject *);    /* of a list's element, in place of ON_LINE */
  fg_member_reader *read;              /* NULL: by the row's kind */
  const void *fresh; /* of LIST and MAP: an element before it is read; NULL: all of it is 0 */
  size_t key_offset, key_size; /* of MAP: text of the element that has its name; size 0: `key` */

  const fg_members *members;          /* of OBJECT, LIST, MAP, SAME */
  const char *const *choices;         /* words that a text can be, up to a NULL */
  const char *(*choice_at)(size_t i); /* the same by a function; NULL behind the last */
  const char *schema;                 /* the schema's text, where the kind does not tell it */
  const char *pattern;                /* regular expression that a text fits, for the schema */
  double lowest, highest; /* limits, where highest > lowest or lowest > 0; of a list: elements */

  /* For people. */
  const char *words;   /* meaning: schema and manual, title of a column */
  const char *heading; /* short: of a column, of a tile; NULL: not shown, or the column's */
  fg_member_column csv, page, terminal;
  /* False: page and terminal have no such column in the list's table; NULL: they always do. */
  bool (*column)(const fg_subject *list);
  int (*decimals_by)(const fg_subject *);  /* decimals of the element's value; NULL: the column's */
  const char *(*look)(const fg_subject *); /* class of its cell: a verdict; NULL: none */
  const char *label; /* written before its cell where a narrow page has no heading; NULL: none */
  void (*markup)(FILE *out, const fg_subject *); /* writes the page's cell; NULL: its text does */
  bool named; /* its text is a name that people gave: a page leaves it as it is in every language */
};

#define FG_MEMBERS(rows_)                      FG_MEMBERS_OF_FILE(rows_, NULL, NULL)
#define FG_MEMBERS_DEFINED(rows_, definition_) FG_MEMBERS_OF_FILE(rows_, definition_, NULL)
/* Described in another document's schema ("measure"), under the definition. */
#define FG_MEMBERS_OF_FILE(rows_, definition_, file_)                                              \
  {                                                                                                \
    .rows = (rows_), .count = sizeof(rows_) / sizeof *(rows_), .definition = (definition_),        \
    .file = (file_)                                                                                \
  }
/* Their lines in a page's table have a class. */
#define FG_MEMBERS_LOOKED_AT(rows_, look_)                                                         \
  { .rows = (rows_), .count = sizeof(rows_) / sizeof *(rows_), .look = (look_) }

/* Offset of a field that must be of the type. */
#define FG_FIELD(object, field, type)                                                              \
  (offsetof(object, field) + 0 * sizeof(_Generic(((object *)0)->field, type : (char)0)))
#define FG_SIZE_OF_FIELD(object, field) sizeof(((object *)0)->field)

#define FG_NUMBER(name_, object, field)                                                            \
  .name = (name_), .kind = FG_MEMBER_NUMBER, .offset = FG_FIELD(object, field, double)
#define FG_NUMBER_U(name_, object, field, u_field)                                                 \
  FG_NUMBER(name_, object, field), .u_offset = FG_FIELD(object, u_field, double)
#define FG_NUMBER_BY(name_, function)                                                              \
  .name = (name_), .kind = FG_MEMBER_NUMBER, .number = (function)
#define FG_COUNT(name_, object, field)                                                             \
  .name = (name_), .kind = FG_MEMBER_COUNT, .offset = FG_FIELD(object, field, size_t)
#define FG_COUNT_BY(name_, function) .name = (name_), .kind = FG_MEMBER_COUNT, .number = (function)
#define FG_INTEGER(name_, object, field)                                                           \
  .name = (name_), .kind = FG_MEMBER_INTEGER, .offset = FG_FIELD(object, field, int)
#define FG_UNSIGNED(name_, object, field)                                                          \
  .name = (name_), .kind = FG_MEMBER_UNSIGNED, .offset = FG_FIELD(object, field, unsigned)
#define FG_SEED(name_, object, field)                                                              \
  .name = (name_), .kind = FG_MEMBER_SEED, .offset = FG_FIELD(object, field, uint64_t)
#define FG_FLAG(name_, object, field)                                                              \
  .name = (name_), .kind = FG_MEMBER_FLAG, .offset = FG_FIELD(object, field, bool)
#define FG_FLAG_BY(name_, function) .name = (name_), .kind = FG_MEMBER_FLAG, .number = (function)
#define FG_TEXT(name_, object, field)                                                              \
  .name = (name_), .kind = FG_MEMBER_TEXT, .offset = FG_FIELD(object, field, char *),              \
  .stride = FG_SIZE_OF_FIELD(object, field)
#define FG_TEXT_BY(name_, function) .name = (name_), .kind = FG_MEMBER_STRING, .text = (function)
#define FG_STRING(name_, object, field)                                                            \
  .name = (name_), .kind = FG_MEMBER_STRING,                                                       \
  .offset = offsetof(object, field) +                                                              \
            0 * sizeof(_Generic(&((object *)0)->field,                                             \
                char **: (char)0, const char **: (char)0, char *const *: (char)0,                  \
                const char *const *: (char)0))
#define FG_SHA256_PATTERN               "^[0-9a-f]{64}$"
#define FG_SHA256(name_, object, field) FG_TEXT(name_, object, field), .pattern = FG_SHA256_PATTERN
#define FG_WORD(name_, object, field, words_)                                                      \
  .name = (name_), .kind = FG_MEMBER_WORD, .choices = (words_),                                    \
  .offset =                                                                                        \
      offsetof(object, field) + 0 * sizeof(char[FG_SIZE_OF_FIELD(object, field) == 4 ? 1 : -1])
#define FG_WORD_BY(name_, function, words_)                                                        \
  .name = (name_), .kind = FG_MEMBER_WORD, .word = (function), .choices = (words_)
#define FG_RANGE(name_, object, low, high)                                                         \
  .name = (name_), .kind = FG_MEMBER_RANGE, .offset = FG_FIELD(object, low, double),               \
  .u_offset = FG_FIELD(object, high, double)
#define FG_PAIR(name_, object, field)                                                              \
  .name = (name_), .kind = FG_MEMBER_PAIR,                                                         \
  .offset = offsetof(object, field) +                                                              \
            0 * sizeof(char[FG_SIZE_OF_FIELD(object, field) == 2 * sizeof(double) ? 1 : -1])
#define FG_NUMBERS_BY(name_, function)                                                             \
  .name = (name_), .kind = FG_MEMBER_NUMBERS, .numbers = (function)
/* All of an array of doubles; the first of it, as many as a count says. */
#define FG_NUMBERS(name_, object, field)                                                           \
  .name = (name_), .kind = FG_MEMBER_NUMBERS, .offset = FG_FIELD(object, field[0], double),        \
  .lowest = FG_SIZE_OF_FIELD(object, field) / sizeof(double),                                      \
  .highest = FG_SIZE_OF_FIELD(object, field) / sizeof(double)
#define FG_NUMBERS_OF(name_, object, field, count_)                                                \
  .name = (name_), .kind = FG_MEMBER_NUMBERS, .offset = FG_FIELD(object, field[0], double),        \
  .count_offset = FG_FIELD(object, count_, size_t)
#define FG_TEXTS_BY(name_, function) .name = (name_), .kind = FG_MEMBER_TEXTS, .text_at = (function)
/* A struct inside the struct; a group of members of the same object; an object that a function
 * finds. */
#define FG_OBJECT(name_, object, field, members_)                                                  \
  .name = (name_), .kind = FG_MEMBER_OBJECT, .offset = offsetof(object, field),                    \
  .members = (members_)
#define FG_POINTED(name_, object, field, members_)                                                 \
  .name = (name_), .kind = FG_MEMBER_OBJECT, .offset = offsetof(object, field), .pointed = true,   \
  .members = (members_)
#define FG_GROUP(name_, members_) .name = (name_), .kind = FG_MEMBER_OBJECT, .members = (members_)
#define FG_PART(name_, function, members_)                                                         \
  .name = (name_), .kind = FG_MEMBER_OBJECT, .part = (function), .members = (members_)
/* A pointer to elements with their number; an array inside the struct with its number; elements
 * that a function finds. */
#define FG_LIST(name_, object, field, count_, members_)                                            \
  .name = (name_), .kind = FG_MEMBER_LIST, .pointed = true, .offset = offsetof(object, field),     \
  .count_offset = FG_FIELD(object, count_, size_t), .stride = sizeof(*((object *)0)->field),       \
  .members = (members_)
#define FG_ARRAY(name_, object, field, count_, members_)                                           \
  .name = (name_), .kind = FG_MEMBER_LIST, .offset = offsetof(object, field),                      \
  .count_offset = FG_FIELD(object, count_, size_t), .stride = sizeof(((object *)0)->field[0]),     \
  .members = (members_)
#define FG_LIST_BY(name_, function, members_)                                                      \
  .name = (name_), .kind = FG_MEMBER_LIST, .element = (function), .members = (members_)
#define FG_MAP_BY(name_, function, key_, members_)                                                 \
  .name = (name_), .kind = FG_MEMBER_MAP, .element = (function), .key = (key_),                    \
  .members = (members_)
/* Objects in an array of the struct, each under the name that its field `key_` has. */
#define FG_MAP(name_, object, field, count_, key_, members_)                                       \
  .name = (name_), .kind = FG_MEMBER_MAP, .offset = offsetof(object, field),                       \
  .count_offset = FG_FIELD(object, count_, size_t), .stride = sizeof(((object *)0)->field[0]),     \
  .key_offset = offsetof(object, field[0].key_) - offsetof(object, field[0]),                      \
  .key_size = FG_SIZE_OF_FIELD(object, field[0].key_), .members = (members_)
#define FG_SAME(members_)    .kind = FG_MEMBER_SAME, .members = (members_)
#define FG_SAME_BY(function) .kind = FG_MEMBER_SAME, .row_at = (function)
#define FG_HEAD(name_)       .name = (name_), .kind = FG_MEMBER_HEAD
/* Written by a function of its own, as the schema's text has it. */
#define FG_WRITTEN(name_, function, schema_)                                                       \
  .name = (name_), .kind = FG_MEMBER_WRITTEN, .write = (function), .schema = (schema_)
/* Described in another document's schema: FG_REF("design.schema.json") */
#define FG_REF(file_and_definition) "{\"$ref\": \"" file_and_definition "\"}"

/* Returns false for texts, objects, lists and whatever is not one number. Value of a number, count
 * or flag; NaN where not known, and of other kinds. */
bool fg_member_is_number(const fg_member *member);
double fg_member_value(const fg_member *member, const fg_subject *subject);
/* Its standard uncertainty; NaN without one. */
double fg_member_u(const fg_member *member, const fg_subject *subject);
bool fg_member_has_u(const fg_member *member);
/* Text of a text, string or word; NULL where not known, and of other kinds. */
const char *fg_member_text(const fg_member *member, const fg_subject *subject,
                           char buffer[FG_MEMBER_TEXT_MAX]);
/* Choice `i` of a word; NULL behind the last. */
const char *fg_member_choice_at(const fg_member *member, size_t i);
/* Returns false where `present` leaves the member out. */
bool fg_member_is_present(const fg_member *member, const fg_subject *subject);
/* Subject of an OBJECT or SAME; its object is NULL where not known. */
fg_subject fg_member_part(const fg_member *member, const fg_subject *subject);
/* Element of a LIST or MAP, by its function or by its fields. */
bool fg_member_element_at(const fg_member *member, const fg_subject *subject, size_t i,
                          fg_subject *element);

/* Decimals with which U = 2 u shows two digits, at least `min`; one digit, where the second would
 * be a nanometre or less. */
int fg_decimals_by_u(int min, double u);

enum { FG_MEMBER_COLUMNS_MAX = 96 };

/* Finds element `i` of a list for a table. */
bool fg_list_next(const fg_subject *list, fg_member_element *element, size_t i, fg_subject *found);

/* Columns of a table in one medium. */
typedef struct fg_member_columns {
  const fg_member *rows[FG_MEMBER_COLUMNS_MAX];
  size_t count;
  const fg_members *members;
} fg_member_columns;

const fg_member_column *fg_member_column_of(const fg_member *member, fg_member_medium medium);
const char *fg_member_heading(const fg_member *member, fg_member_medium medium);
/* Lists the members that a medium shows of this list, by rank. */
void fg_member_columns_of(const fg_members *members, fg_member_medium medium,
                          const fg_subject *list, fg_member_columns *columns);
/* Writes the value as the column shows it, in the column's unit; "–" where not known. */
void fg_member_show(const fg_member *member, fg_member_medium medium, const fg_subject *subject,
                    char *text, size_t size);
/* Writes U = 2 u likewise; "" where there is none to show. */
void fg_member_show_u(const fg_member *member, fg_member_medium medium, const fg_subject *subject,
                      char *text, size_t size);

/* Write one member under its name; all members of an object into the open object; a whole
 * document. */
void fg_member_json(fg_json *json, const fg_member *member, const fg_subject *subject);
void fg_members_json(fg_json *json, const fg_members *members, const fg_subject *subject);
void fg_document_json(FILE *out, const fg_members *members, const void *whole);

/* CSV: a heading, then a line per element of the list. */
void fg_members_csv(FILE *out, const fg_members *members, const fg_subject *list,
                    fg_member_element *element);
/* The heading's names, and an element's cells, from the first to the last, without a line's end,
 * for a table that puts other columns beside them. */
void fg_members_csv_heading(FILE *out, const fg_member_columns *columns);
void fg_members_csv_cells(FILE *out, const fg_member_columns *columns, const fg_subject *element);

/* Table of the terminal, indented by `indent`: columns are as wide as their cells. */
void fg_members_terminal(FILE *out, const char *indent, const fg_members *members,
                         const fg_subject *list, fg_member_element *element);

/* A document: the JSON that a command writes or reads. Of one that people write the schema requires
 * the members that reading requires, and the manual tells defaults. */
typedef struct fg_document {
  const char *file;        /* of its schema: "load_test" */
  const char *title;       /* "foilgauge stiffness report" */
  const char *description; /* NULL: none */
  const char *made_by;     /* words for the manual: "`foilgauge stiffness -o`" */
  const fg_members *members;
  bool is_read;                    /* people write it */
  const void *(*find_usual)(void); /* object that a file without members gives; NULL: none */
  const char *inside;              /* before each name of the manual: "station."; NULL: nothing */
  const fg_members *const *describes; /* definitions of the schema for other documents, to a NULL */
} fg_document;

#endif
