/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/lot/page_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "page/page.h"

void fg_lot_put_number(FILE *out, double value, int digits) {
  if (isfinite(value))
    fprintf(out, "%s%.*g", value < 0 ? "−" : "", digits, fabs(value));
  else
    fputs("–", out);
}

void fg_lot_put_value(FILE *out, const fg_quantity *row, double value) {
  fg_lot_put_decimals(out, value, row->decimals);
}

void fg_lot_put_decimals(FILE *out, double value, int decimals) {
  char text[64];
  if (!isfinite(value)) {
    fputs("–", out);
    return;
  }
  snprintf(text, sizeof text, "%.*f", decimals, fabs(value));
  bool zero = strspn(text, "0.") == strlen(text);
  fprintf(out, "%s%s", value < 0 && !zero ? "−" : "", text);
}

void fg_lot_put_href(FILE *out, const char *path) {
  static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./~";
  for (; *path; path++)
    if (strchr(plain, *path))
      fputc(*path, out);
    else
      fprintf(out, "%%%02X", (unsigned)(unsigned char)*path);
}

/* Puts the relative path from a folder to a file, both absolute: "../scans/1.png". */
static void put_relative_path(FILE *out, const char *folder, const char *file) {
  size_t same = 0; /* length of the common path, with its last slash */
  for (size_t i = 0; folder[i] && folder[i] == file[i]; i++)
    if (file[i] == '/') same = i + 1;
  size_t length = strlen(folder);
  if (!strncmp(folder, file, length) && file[length] == '/') same = length + 1;
  for (size_t i = same; i < length; i++)
    if (i == same || folder[i] == '/') fputs("../", out);
  fg_lot_put_href(out, file + same);
}

void fg_lot_put_scan(FILE *out, const fg_lot_analysis *analysis, size_t item) {
  const char *scan = fg_manifest_scan(&analysis->lot->manifest, item), *slash = strrchr(scan, '/');
  char *folder = analysis->folder ? realpath(analysis->folder, NULL) : NULL;
  char *file = folder ? realpath(scan, NULL) : NULL;
  if (file) {
    fputs("<a href=\"", out);
    put_relative_path(out, folder, file);
    fputs("\">", out);
  }
  fg_html_name(out, slash && slash[1] ? slash + 1 : scan);
  if (file) fputs("</a>", out);
  free(file);
  free(folder);
}

bool fg_lot_begin_foil_link(FILE *out, const fg_lot_analysis *analysis, const fg_lot_foil *foil) {
  const fg_record *record = &analysis->lot->records[foil->item];
  const char *page = analysis->pages ? analysis->pages[foil->item] : NULL;
  if (!page && !foil->row) return false;
  fputs("<a href=\"", out);
  if (page) {
    fg_lot_put_href(out, page);
    fprintf(out, "#part%zu\">", (size_t)(foil->foil - record->foils) + 1);
  } else {
    fprintf(out, "#foil-%zu\">", (size_t)(foil - analysis->foils) + 1);
  }
  return true;
}

void fg_lot_put_foil_link(FILE *out, const fg_lot_analysis *analysis, const fg_lot_foil *foil) {
  bool linked = fg_lot_begin_foil_link(out, analysis, foil);
  fg_lot_put_label(out, analysis, foil);
  if (linked) fputs("</a>", out);
}

void fg_lot_put_label(FILE *out, const fg_lot_analysis *analysis, const fg_lot_foil *foil) {
  fg_html_name(out, fg_manifest_label(&analysis->lot->manifest, foil->item));
  if (analysis->lot->records[foil->item].foil_count > 1)
    fprintf(out, ", foil %d", foil->foil->number);
}
