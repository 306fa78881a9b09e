/* A page over lots, from their lot.json. */
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "core/file.h"
#include "core/overwrite.h"
#include "core/text.h"
#include "foilgauge/lot.h"
#include "lot/lot_report.h"
#include "report/measure/measure_page_parts.h"

enum { LOT_BYTES_MAX = 1 << 30 };

static const char *text_of(const cJSON *object, const char *name) {
  const cJSON *value = cJSON_GetObjectItemCaseSensitive(object, name);
  return cJSON_IsString(value) ? value->valuestring : "";
}

static double count_of(const cJSON *counts, const char *name) {
  const cJSON *value = cJSON_GetObjectItemCaseSensitive(counts, name);
  return cJSON_IsNumber(value) ? value->valuedouble : 0;
}

static fg_verdict verdict_of(const char *word) {
  for (int verdict = FG_VERDICT_PASS; verdict < FG_VERDICT_NONE; verdict++)
    if (!strcmp(word, fg_verdict_word((fg_verdict)verdict))) return (fg_verdict)verdict;
  return FG_VERDICT_NONE;
}

static void put_path(FILE *out, const char *path) {
  static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./~";
  for (; *path; path++)
    if (strchr(plain, *path))
      fputc(*path, out);
    else
      fprintf(out, "%%%02X", (unsigned)(unsigned char)*path);
}

/* A folder as seen from the page's: both as given, so a lot beside or below the page keeps its
 * link when all is moved together. */
static const char *seen_from(const char *page, const char *folder) {
  const char *slash = strrchr(page, '/');
  size_t length = slash ? (size_t)(slash - page) + 1 : 0;
  return length && !strncmp(page, folder, length) ? folder + length : folder;
}

static void put_row(FILE *out, const char *page, const char *folder, const cJSON *root) {
  static const char *const columns[] = {"scans", "foils",       "pass",
                                        "fail",  "cannot_tell", "not_measured"};
  const cJSON *counts = cJSON_GetObjectItemCaseSensitive(root, "counts");
  fputs("<tr><td><a href=\"", out);
  put_path(out, seen_from(page, folder));
  fputs("/index.html\">", out);
  fg_html_text(out, text_of(root, "name"));
  fputs("</a></td><td>", out);
  fg_html_verdict(out, verdict_of(text_of(root, "verdict")));
  fputs("</td>", out);
  for (size_t i = 0; i < sizeof columns / sizeof *columns; i++)
    fprintf(out, "<td>%.0f</td>", count_of(counts, columns[i]));
  fputs("</tr>\n", out);
}

static fg_status add_lot(fg_context *ctx, FILE *out, const char *page, const char *folder) {
  char *path, *text = NULL;
  FG_TRY(fg_lot_path(ctx, folder, "lot.json", &path));
  fg_status status = fg_file_read_text(ctx, path, LOT_BYTES_MAX, &text);
  if (status == FG_OK) {
    cJSON *root = cJSON_Parse(text);
    if (!root || strcmp(text_of(root, "schema"), "foilgauge/lot/1") != 0)
      status = fg_fail(ctx, FG_ERR_DATA, "%s: not the report of a lot", path);
    else
      put_row(out, page, folder, root);
    cJSON_Delete(root);
  }
  free(text);
  free(path);
  return status;
}

/* The page must not take the place of what it is made from, nor of what it links to. */
static fg_status check_page(fg_context *ctx, const char *const *folders, size_t count,
                            const char *page) {
  fg_overwrite overwrite = {0};
  fg_status status = fg_overwrite_begin(ctx, &page, 1, &overwrite);
  for (size_t i = 0; i < 2 * count && status == FG_OK; i++) {
    char *path;
    status = fg_lot_path(ctx, folders[i / 2], i % 2 ? "lot.json" : "index.html", &path);
    if (status != FG_OK) break;
    status = fg_overwrite_check(ctx, &overwrite, path, "a report of a lot");
    free(path);
  }
  fg_overwrite_free(&overwrite);
  return status;
}

fg_status fg_lot_index(fg_context *ctx, const char *const *folders, size_t count,
                       const char *page) {
  fg_output output;
  FG_TRY(check_page(ctx, folders, count, page));
  FG_TRY(fg_output_open(ctx, page, &output));
  fg_html_begin(output.stream, "Lots");
  fputs("<section>\n<h1>Lots</h1>\n<div class=\"scroll\"><table><thead><tr><th>lot</th><th>verdict"
        "</th><th>scans</th><th>foils</th><th>pass</th><th>fail</th><th>cannot tell</th><th>not "
        "measured</th></tr></thead>\n<tbody>\n",
        output.stream);
  fg_status status = FG_OK;
  for (size_t i = 0; i < count && status == FG_OK; i++)
    status = add_lot(ctx, output.stream, page, folders[i]);
  fputs("</tbody></table></div>\n</section>\n", output.stream);
  fg_html_end(output.stream);
  return fg_output_end(ctx, &output, status);
}
