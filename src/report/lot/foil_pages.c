/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/lot/foil_pages.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/file.h"
#include "core/folder.h"
#include "core/memory.h"
#include "core/select.h"
#include "core/sha256.h"
#include "core/text.h"

/* Limits of a page's name: bytes of the scan's name, digits of the sum. */
enum { NAME_BYTES = 60, SUM_DIGITS = 16, PAGE_BYTES_MAX = 1 << 30 };

const char *fg_lot_pages_word(fg_lot_pages which) {
  static const char *const words[] = {
      [FG_LOT_PAGES_ALL] = "all", [FG_LOT_PAGES_BAD] = "bad", [FG_LOT_PAGES_NONE] = "none"};
  return words[which];
}

/* Keeps letters, digits, dots (but for a first one), dashes and underscores of a scan's name; drops
 * its ending. */
static void make_plain_name(const char *scan, char name[NAME_BYTES + 1]) {
  static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.";
  const char *slash = strrchr(scan, '/'), *base = slash ? slash + 1 : scan;
  const char *dot = strrchr(base, '.');
  size_t length = dot && dot > base ? (size_t)(dot - base) : strlen(base);
  if (length > NAME_BYTES) length = NAME_BYTES;
  for (size_t i = 0; i < length; i++)
    name[i] = strchr(plain, base[i]) && (i || base[i] != '.') ? base[i] : '_';
  name[length] = '\0';
}

static fg_status append_tolerances(fg_context *ctx, const fg_design *design, char **text) {
  for (size_t i = 0; i < design->tolerance_count; i++)
    FG_TRY(fg_text_append(ctx, text, "%s %.10g %.10g\n", design->tolerances[i].quantity,
                          design->tolerances[i].lower, design->tolerances[i].upper));
  return FG_OK;
}

fg_status fg_lot_page_name(fg_context *ctx, const fg_design *design, const fg_manifest *manifest,
                           size_t item, const fg_record *record, char **name) {
  const char *scan = fg_manifest_scan(manifest, item);
  char plain[NAME_BYTES + 1], sum[65], *text = NULL;
  make_plain_name(scan, plain);
  fg_status status = fg_text_append(ctx, &text, "%s\n%s\n%s\n%s\n", record->sha256,
                                    record->measured_with, scan, fg_manifest_label(manifest, item));
  if (status == FG_OK) status = append_tolerances(ctx, design, &text);
  if (status == FG_OK) fg_sha256_text(text, sum);
  free(text);
  FG_TRY(status);
  return fg_text_print(ctx, name, FG_LOT_PAGES "/%s-%.*s.html", plain, SUM_DIGITS, sum);
}

bool fg_lot_page_exists(const char *folder, const char *name) {
  char *path = NULL;
  bool there = fg_lot_path(NULL, folder, name, &path) == FG_OK && access(path, F_OK) == 0;
  free(path);
  return there;
}

fg_status fg_lot_page_is_wanted(fg_context *ctx, fg_lot_pages which, const fg_design *design,
                                const fg_foil *foils, size_t count, bool *wanted) {
  *wanted = which == FG_LOT_PAGES_ALL && count > 0;
  for (size_t i = 0; which == FG_LOT_PAGES_BAD && i < count && !*wanted; i++) {
    fg_decision decision;
    FG_TRY(fg_foil_decide(ctx, design, &foils[i], &decision));
    fg_verdict verdict = decision.outcome.verdict;
    *wanted = verdict != FG_VERDICT_PASS && verdict != FG_VERDICT_NONE;
    fg_decision_free(&decision);
  }
  return FG_OK;
}

/* Returns the manifest's name of the foil, where the scan shows one. */
static const char *find_foil_name(const fg_manifest *manifest, size_t item, size_t foils) {
  size_t column = fg_manifest_column(manifest, "foil");
  const char *name =
      foils == 1 && column != FG_NO_COLUMN ? fg_manifest_cell(manifest, item, column) : "";
  return *name ? name : NULL;
}

fg_status fg_lot_page_draw(fg_context *ctx, const fg_design *design, const fg_manifest *manifest,
                           size_t item, const fg_measurement *measurement, char **page) {
  const fg_report_scan scan = {.path = measurement->scan,
                               .measurement = measurement,
                               .name = find_foil_name(manifest, item, measurement->foil_count)};
  const fg_report report = {.design = design,
                            .nominal = &measurement->nominal,
                            .scans = &scan,
                            .scan_count = 1,
                            .back = "../index.html"};
  size_t size;
  FILE *into = fg_stream_open(page, &size);
  if (!into) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a foil's page");
  fg_status status = fg_report_write_html(ctx, &report, into);
  if (!fg_stream_keep(into, page) && status == FG_OK)
    status = fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a foil's page");
  if (status != FG_OK) {
    free(*page);
    *page = NULL;
  }
  return status;
}

fg_status fg_lot_pages_make_folder(fg_context *ctx, const char *folder) {
  char *pages;
  FG_TRY(fg_lot_path(ctx, folder, FG_LOT_PAGES, &pages));
  fg_status status = fg_folder_make(ctx, pages);
  free(pages);
  return status;
}

static int compare_page_names(const void *a, const void *b) {
  return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Returns true for names as fg_lot_page_name makes them: other files in the folder belong to
 * somebody. */
static bool is_page_name(const char *name) {
  static const char ending[] = ".html";
  size_t length = strlen(name), tail = SUM_DIGITS + sizeof ending - 1;
  if (length < tail + 1 || strcmp(name + length - (sizeof ending - 1), ending) != 0) return false;
  return name[length - tail - 1] == '-' &&
         strspn(name + length - tail, "0123456789abcdef") == SUM_DIGITS;
}

/* Removes pages that are not `kept`, which is sorted by name. */
static fg_status remove_unkept_pages(fg_context *ctx, const char *folder, char *const *kept,
                                     size_t count) {
  char *pages;
  FG_TRY(fg_lot_path(ctx, folder, FG_LOT_PAGES, &pages));
  DIR *listing = opendir(pages);
  free(pages);
  fg_status status = FG_OK;
  for (struct dirent *entry; listing && status == FG_OK && (entry = readdir(listing));) {
    char *name;
    if (!is_page_name(entry->d_name)) continue;
    status = fg_lot_path(ctx, FG_LOT_PAGES, entry->d_name, &name);
    if (status != FG_OK) break;
    if (!bsearch(&name, kept, count, sizeof *kept, compare_page_names))
      unlinkat(dirfd(listing), entry->d_name, 0);
    free(name);
  }
  if (listing) closedir(listing);
  return status;
}

static fg_status remove_stale_pages(fg_context *ctx, const char *folder, const fg_lot *lot,
                                    char *const *names) {
  void *block;
  size_t count = 0;
  FG_TRY(fg_memory_allocate(ctx, lot->manifest.items, sizeof *names, &block));
  char **kept = block;
  for (size_t i = 0; i < lot->manifest.items; i++)
    if (names[i]) kept[count++] = names[i];
  fg_sort_items(kept, count, sizeof *kept, compare_page_names);
  fg_status status = remove_unkept_pages(ctx, folder, kept, count);
  free(kept);
  return status;
}

fg_status fg_lot_pages_find(fg_context *ctx, const char *folder, const fg_lot *lot, char ***names) {
  void *block;
  fg_status status = FG_OK;
  FG_TRY(fg_memory_allocate(ctx, lot->manifest.items, sizeof **names, &block));
  *names = block;
  for (size_t i = 0; i < lot->manifest.items && status == FG_OK; i++) {
    const fg_record *record = &lot->records[i];
    if (record->error) continue;
    status = fg_lot_page_name(ctx, &lot->settings.design, &lot->manifest, i, record, &(*names)[i]);
    if (status != FG_OK || fg_lot_page_exists(folder, (*names)[i])) continue;
    free((*names)[i]);
    (*names)[i] = NULL;
  }
  if (status == FG_OK) status = remove_stale_pages(ctx, folder, lot, *names);
  if (status != FG_OK) {
    fg_lot_pages_free(lot, *names);
    *names = NULL;
  }
  return status;
}

void fg_lot_pages_free(const fg_lot *lot, char **names) {
  for (size_t i = 0; names && i < lot->manifest.items; i++)
    free(names[i]);
  free(names);
}

/* Links the page, or copies it where the system cannot link: pages are replaced, never changed. */
static fg_status link_page(fg_context *ctx, const char *from, const char *to, const char *name) {
  char *source = NULL, *target = NULL, *text = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_lot_path(ctx, from, name, &source));
  FG_TRY_EXIT(fg_lot_path(ctx, to, name, &target));
  if (access(source, F_OK) != 0 || link(source, target) == 0 || errno == EEXIST) goto exit;
  FG_TRY_EXIT(fg_file_read_text(ctx, source, PAGE_BYTES_MAX, &text));
  FG_TRY_EXIT(fg_lot_write_text(ctx, to, name, text));
exit:
  free(source);
  free(target);
  free(text);
  return status;
}

fg_status fg_lot_pages_link(fg_context *ctx, const char *const *folders, const size_t *from,
                            const char *folder, const fg_lot *lot) {
  bool made = false;
  for (size_t i = 0; i < lot->manifest.items; i++) {
    char *name = NULL;
    if (lot->records[i].error) continue;
    FG_TRY(
        fg_lot_page_name(ctx, &lot->settings.design, &lot->manifest, i, &lot->records[i], &name));
    bool there = fg_lot_page_exists(folders[from[i]], name);
    fg_status status = there && !made ? fg_lot_pages_make_folder(ctx, folder) : FG_OK;
    made |= there;
    if (there && status == FG_OK) status = link_page(ctx, folders[from[i]], folder, name);
    free(name);
    FG_TRY(status);
  }
  return FG_OK;
}
