/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A hub's page: its stations over the last day, and the newest parts. */
#include <string.h>

#include "page/page.h"
#include "page/table.h"
#include "station/hub/hub.h"
#include "station/pages.h"

static void write_hub_input(FILE *out, const char *label, const char *name, const char *value) {
  fprintf(out, "<label>%s<input name=\"%s\" maxlength=\"127\" value=\"", label, name);
  fg_html_text(out, value);
  fputs("\"></label>", out);
}

static void write_hub_search(FILE *out, const fg_hub_search *search) {
  static const char *const words[] = {
      "",         "any",        "pass",        "PASS",
      "fail",     "FAIL",       "cannot_tell", "SCAN AGAIN: cannot tell",
      "withheld", "NO VERDICT", "open",        "without disposition"};
  fputs("<form class=\"fields\" method=\"get\" action=\"/\">", out);
  write_hub_input(out, "Serial", "serial", search->serial);
  write_hub_input(out, "Lot", "lot", search->lot);
  write_hub_input(out, "Station", "station", search->station);
  fputs("<label>Verdict<select name=\"verdict\">", out);
  for (size_t i = 0; i < sizeof words / sizeof *words; i += 2)
    fprintf(out, "<option value=\"%s\"%s>%s</option>", words[i],
            strcmp(words[i], search->verdict) ? "" : " selected", words[i + 1]);
  fputs("</select></label><button>Search</button><a href=\"/\">All</a></form>\n", out);
}

static void write_hub_link(FILE *out, const fg_hub_search *search, const char *path, size_t page,
                           const char *words) {
  const char *const fields[] = {"serial",  search->serial,  "lot",     search->lot,
                                "station", search->station, "verdict", search->verdict};
  fprintf(out, "<a class=\"button plain\" href=\"%s?", path);
  for (size_t i = 0; i < sizeof fields / sizeof *fields; i += 2)
    fg_page_parameter(out, fields[i], fields[i + 1]);
  fprintf(out, "page=%zu\">%s</a>", page + 1, words);
}

static bool hub_station_at(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_hub_state *state = list->object;
  element->object = &state->stations[i];
  return i < state->station_count;
}

static bool hub_part_at(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_hub_state *state = list->object;
  element->object = &state->parts[i];
  return i < state->part_count;
}

static bool is_filtered(const fg_hub_search *search) {
  return search->serial[0] || search->lot[0] || search->station[0] || search->verdict[0] ||
         search->page;
}

void fg_hub_write_page(const fg_hub_search *search, const fg_hub_state *state, FILE *out) {
  const fg_subject all = {.object = state, .whole = state};
  fputs("<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
        "content=\"width=device-width,initial-scale=1\"><title>foilgauge hub</title>",
        out);
  if (!is_filtered(search)) fputs("<meta http-equiv=\"refresh\" content=\"5\">", out);
  fputs(
      "<link rel=\"icon\" href=\"/icon.svg\"><link rel=\"stylesheet\" href=\"/style.css\"></head>\n"
      "<body><main><section><h1>Stations</h1>\n",
      out);
  if (!state->station_count)
    fputs("<p class=\"note\">No station has sent a part yet: start one with <code>--hub</code> and "
          "this address.</p>\n",
          out);
  if (state->station_count) fg_html_table(out, &fg_hub_station_members, &all, hub_station_at);
  fputs("</section><section><h2 class=\"first\">Parts</h2>\n", out);
  write_hub_search(out, search);
  if (state->part_count) fg_html_table(out, &fg_hub_part_members, &all, hub_part_at);
  fputs("<p class=\"paging\">", out);
  if (search->page) write_hub_link(out, search, "/", search->page - 1, "← Newer");
  if (state->more) write_hub_link(out, search, "/", search->page + 1, "Older →");
  if (state->part_count) write_hub_link(out, search, "/api/parts.csv", 0, "CSV");
  fputs("</p></section></main></body></html>\n", out);
}

void fg_hub_write_csv(const fg_hub_state *state, FILE *out) {
  const fg_subject all = {.object = state, .whole = state};
  fg_members_csv(out, &fg_hub_part_members, &all, hub_part_at);
}
