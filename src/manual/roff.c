/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "manual/roff.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* Decodes a UTF-8 sequence: code point and length. It is not checked: the texts are the
 * project's own. */
static size_t decode(const char *text, size_t length, unsigned *code) {
  unsigned char first = (unsigned char)text[0];
  size_t size = first < 0xC0 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
  if (size > length) size = length;
  *code = size == 1 ? first : first & (0x7Fu >> size);
  for (size_t i = 1; i < size; i++)
    *code = *code << 6 | ((unsigned char)text[i] & 0x3Fu);
  return size;
}

static void escape_one(unsigned code, FILE *out) {
  if (code >= 0x80)
    fprintf(out, "\\[u%04X]", code);
  else if (code == '\\')
    fputs("\\e", out);
  else if (code == '-')
    fputs("\\-", out);
  else if (code == '\'')
    fputs("\\(aq", out);
  else if (code == '`')
    fputs("\\(ga", out);
  else if (code == '^')
    fputs("\\(ha", out);
  else if (code == '~')
    fputs("\\(ti", out);
  else
    fputc((int)code, out);
}

void fg_roff_escape(const char *text, size_t length, FILE *out) {
  if (length && text[0] == '.') fputs("\\&", out);
  while (length) {
    unsigned code;
    size_t size = decode(text, length, &code);
    escape_one(code, out);
    text += size;
    length -= size;
  }
}

/* Returns the length of the text that a mark at `text` encloses; 0: it is no mark. */
static size_t enclosed(const char *text, size_t length, const char *mark) {
  size_t width = strlen(mark);
  if (length < 2 * width || strncmp(text, mark, width) != 0) return 0;
  for (size_t at = width; at + width <= length; at++)
    if (!strncmp(text + at, mark, width)) return at - width;
  return 0;
}

/* Returns the length of a link [words](address), and that of its words. */
static size_t link_length(const char *text, size_t length, size_t *words) {
  const char *middle = length && *text == '[' ? memmem(text, length, "](", 2) : NULL;
  const char *end = middle ? memchr(middle, ')', length - (size_t)(middle - text)) : NULL;
  if (!end) return 0;
  *words = (size_t)(middle - text) - 1;
  return (size_t)(end - text) + 1;
}

void fg_roff_inline(const char *text, size_t length, FILE *out) {
  if (length && text[0] == '.') fputs("\\&", out);
  while (length) {
    unsigned code;
    size_t words = enclosed(text, length, "`"), used = words + 2;
    size_t mark = 1;
    if (!words) {
      words = enclosed(text, length, "**");
      mark = 2;
      used = words + 4;
    }
    if (words) {
      fputs("\\fB", out);
      fg_roff_escape(text + mark, words, out);
      fputs("\\fR", out);
    } else if ((used = link_length(text, length, &words)) > 0) {
      fg_roff_inline(text + 1, words, out);
    } else {
      used = decode(text, length, &code);
      escape_one(code, out);
    }
    text += used;
    length -= used;
  }
}

typedef struct writer {
  FILE *out;
  bool in_code, in_table, gap; /* gap: a paragraph begins */
  char heading[4][80];         /* of the table's columns */
  size_t columns, cells;       /* with a heading, and all */
  bool wrong;                  /* a row has other cells than its table's head */
} writer;

static void end_code(writer *w) {
  if (w->in_code) fputs(".EE\n.RE\n", w->out);
  w->in_code = false;
}

static void write_code(writer *w, const char *line, size_t length) {
  if (!w->in_code) fputs(".PP\n.RS 4\n.EX\n", w->out);
  w->in_code = true;
  fg_roff_escape(line + 4, length - 4, w->out);
  fputc('\n', w->out);
}

/* True for a bar between cells, as readers of Markdown see it; `\\|` is a bar of the text, in
 * code as well. */
static bool is_border(const char *at, const char *start) {
  return *at == '|' && (at == start || at[-1] != '\\');
}

static size_t count_cells(const char *line, size_t length) {
  size_t borders = 0;
  for (size_t i = 0; i < length; i++)
    borders += is_border(line + i, line);
  return borders ? borders - 1 : 0;
}

/* Finds the next cell of a row, without the blanks around it. */
static bool next_cell(const char **at, const char *end, const char **cell, size_t *length) {
  const char *start = *at;
  while (start < end && (*start == '|' || *start == ' '))
    start++;
  if (start >= end) return false;
  const char *stop = start;
  while (stop < end && !is_border(stop, start))
    stop++;
  *at = stop;
  while (stop > start && stop[-1] == ' ')
    stop--;
  *cell = start;
  *length = (size_t)(stop - start);
  return true;
}

static void read_headings(writer *w, const char *at, const char *end) {
  const char *cell;
  size_t length;
  w->columns = 0;
  while (w->columns < 4 && next_cell(&at, end, &cell, &length))
    snprintf(w->heading[w->columns++], sizeof *w->heading, "%.*s", (int)length, cell);
}

/* Writes the text of a cell, its bars without their escape. */
static void write_roff_cell(const char *cell, size_t length, FILE *out) {
  char *plain = malloc(length + 1);
  size_t count = 0;
  if (!plain) abort();
  for (size_t i = 0; i < length; i++)
    if (cell[i] != '\\' || i + 1 == length || cell[i + 1] != '|') plain[count++] = cell[i];
  fg_roff_inline(plain, count, out);
  free(plain);
}

/* Writes a row as a tagged paragraph: the first cell, then the others, named where there are
 * several. */
static void write_roff_row(writer *w, const char *at, const char *end) {
  const char *cell;
  size_t length;
  for (size_t column = 0; next_cell(&at, end, &cell, &length); column++) {
    if (column == 0) fputs(".TP\n", w->out);
    if (column > 0 && column + 1 < w->columns) {
      fg_roff_inline(w->heading[column], strlen(w->heading[column]), w->out);
      fputs(": ", w->out);
    }
    write_roff_cell(cell, length, w->out);
    fputs(column > 0 && column + 1 < w->columns ? ";\n" : "\n", w->out);
  }
}

static void write_table_line(writer *w, const char *line, size_t length) {
  size_t cells = count_cells(line, length);
  if (!w->in_table) w->cells = cells;
  w->wrong = w->wrong || cells != w->cells;
  if (!w->in_table)
    read_headings(w, line, line + length);
  else if (strncmp(line, "|---", 4) != 0)
    write_roff_row(w, line, line + length);
  w->in_table = true;
}

static void write_heading(writer *w, const char *line, size_t length) {
  bool section = strncmp(line, "## ", 3) == 0;
  size_t skip = section ? 3 : 4;
  fputs(section ? ".SH " : ".SS ", w->out);
  for (size_t i = skip; i < length; i++)
    escape_one(section ? (unsigned)toupper((unsigned char)line[i]) : (unsigned char)line[i],
               w->out);
  fputc('\n', w->out);
  w->gap = false;
}

static void write_line(writer *w, const char *line, size_t length) {
  if (length == 0) {
    w->gap = true;
    w->in_table = false;
    return;
  }
  if (length > 4 && !strncmp(line, "    ", 4)) {
    if (w->in_code && w->gap) fputc('\n', w->out);
    write_code(w, line, length);
    w->gap = false;
    return;
  }
  end_code(w);
  if (line[0] == '#') {
    write_heading(w, line, length);
  } else if (line[0] == '|') {
    write_table_line(w, line, length);
    w->gap = true;
  } else if (!strncmp(line, "- ", 2)) {
    fputs(".IP \\(bu 2\n", w->out);
    fg_roff_inline(line + 2, length - 2, w->out);
    fputc('\n', w->out);
  } else {
    if (w->gap) fputs(".PP\n", w->out);
    while (length && *line == ' ') {
      line++;
      length--;
    }
    fg_roff_inline(line, length, w->out);
    fputc('\n', w->out);
    w->gap = false;
  }
}

bool fg_roff_text(const char *text, FILE *out) {
  writer w = {.out = out, .gap = true};
  while (*text) {
    size_t length = strcspn(text, "\n");
    write_line(&w, text, length);
    text += length + (text[length] == '\n');
  }
  end_code(&w);
  return !w.wrong;
}
