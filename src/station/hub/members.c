/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stations and parts of a hub as members. */
#include <string.h>

#include "page/page.h"
#include "report/verdict_members.h"
#include "station/hub/hub.h"
#include "station/pages.h"
#include "station/settings.h"

/* As the station shows it: of a verdict that does not hold none is seen. */
static void write_verdict(FILE *out, const fg_subject *subject) {
  const fg_hub_part *part = subject->object;
  bool withheld = part->withheld[0] != '\0';
  fprintf(out, "<span class=\"tag %s\">%s</span>", fg_page_verdict_class(part->verdict, withheld),
          fg_page_verdict_words(part->verdict, withheld));
}

/* Writes "2026-03-01T14:02:33.120Z" as "2026-03-01 14:02:33". */
static void write_hub_time(FILE *out, const char *utc) {
  enum { DAY = 10, CLOCK = 8 };
  if (strlen(utc) < DAY + 1 + CLOCK)
    fg_html_text(out, utc);
  else
    fprintf(out, "%.*s %.*s", DAY, utc, CLOCK, utc + DAY + 1);
}

static void write_measured(FILE *out, const fg_subject *subject) {
  write_hub_time(out, ((const fg_hub_part *)subject->object)->measured_at);
}

static void write_received(FILE *out, const fg_subject *subject) {
  write_hub_time(out, ((const fg_hub_part *)subject->object)->received_at);
}

static void write_last(FILE *out, const fg_subject *subject) {
  write_hub_time(out, ((const fg_hub_station *)subject->object)->received_at);
}

static void write_serial(FILE *out, const fg_subject *subject) {
  const fg_hub_part *part = subject->object;
  fprintf(out, "<a href=\"/api/part?source=%s&amp;foil=%zu\">", part->source, part->foil);
  fg_html_name(out, part->serial);
  fputs("</a>", out);
}

static const fg_member station_rows[] = {
    {FG_TEXT("station", fg_hub_station, station), .heading = "Station", .page = {.rank = 1},
     .named = true},
    {FG_TEXT("source", fg_hub_station, source), .words = "identity of its database"},
    {FG_COUNT("parts", fg_hub_station, parts), .words = "that came in the last 24 hours",
     .heading = "Parts,\n24 h", .page = {.rank = 2}, .label = "parts, 24 h"},
    {FG_COUNT("failed", fg_hub_station, failed), .words = "of them that failed",
     .heading = "Failed", .page = {.rank = 3}, .label = "failed"},
    {FG_COUNT("open", fg_hub_station, open), .words = "of them without a disposition",
     .heading = "Without disposition", .page = {.rank = 4}, .label = "without disposition"},
    {FG_TEXT("received_at", fg_hub_station, received_at),
     .words = "when the hub got its last part, UTC", .heading = "Last part, UTC",
     .page = {.rank = 5}, .markup = write_last, .label = "last part, UTC"},
};
const fg_members fg_hub_station_members = {station_rows, sizeof station_rows / sizeof *station_rows,
                                           .frame = "left rows"};

static const fg_member part_rows[] = {
    {FG_TEXT("serial", fg_hub_part, serial), .heading = "Serial", .page = {.rank = 1},
     .markup = write_serial, .csv = {.rank = 1}},
    {FG_TEXT("verdict", fg_hub_part, verdict), .choices = fg_verdict_words, .heading = "Verdict",
     .page = {.rank = 2}, .markup = write_verdict, .csv = {.rank = 2}},
    {FG_TEXT("withheld", fg_hub_part, withheld), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "why the verdict does not hold", .csv = {.rank = 3}},
    {FG_TEXT("disposition", fg_hub_part, disposition), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "scrap, rework, concession, again", .heading = "Disposition", .page = {.rank = 3},
     .label = "disposition", .csv = {.rank = 4}},
    {FG_TEXT("station", fg_hub_part, station), .heading = "Station", .page = {.rank = 4},
     .label = "station", .named = true, .csv = {.rank = 5}},
    {FG_TEXT("lot", fg_hub_part, lot), .heading = "Lot", .page = {.rank = 5}, .label = "lot",
     .named = true, .csv = {.rank = 6}},
    {FG_TEXT("die", fg_hub_part, die), .heading = "Die", .page = {.rank = 6}, .label = "die",
     .named = true, .csv = {.rank = 7}},
    {FG_TEXT("operator", fg_hub_part, operator_name), .heading = "Operator", .page = {.rank = 7},
     .label = "operator", .named = true, .csv = {.rank = 8}},
    {FG_TEXT("measured_at", fg_hub_part, measured_at), .words = "UTC, by the station's clock",
     .heading = "Measured, UTC", .page = {.rank = 8}, .markup = write_measured,
     .label = "measured, UTC", .csv = {.rank = 9}},
    {FG_TEXT("received_at", fg_hub_part, received_at),
     .words = "when the part first came, UTC, by the hub's clock", .heading = "Received, UTC",
     .page = {.rank = 9}, .markup = write_received, .label = "received, UTC", .csv = {.rank = 13}},
    {FG_TEXT("source", fg_hub_part, source), .words = "identity of the station's database",
     .csv = {.rank = 10}},
    {FG_COUNT("foil", fg_hub_part, foil), .words = "number in that database", .csv = {.rank = 11}},
    {FG_COUNT("event", fg_hub_part, event), .words = "the newest of the foil", .csv = {.rank = 12}},
};
const fg_members fg_hub_part_members = {part_rows, sizeof part_rows / sizeof *part_rows,
                                        .frame = "left rows"};

static const fg_member state_rows[] = {
    {FG_HEAD("foilgauge/hub/1")},
    {FG_LIST("stations", fg_hub_state, stations, station_count, &fg_hub_station_members)},
    {FG_LIST("parts", fg_hub_state, parts, part_count, &fg_hub_part_members),
     .options = FG_MEMBER_ON_LINE, .words = "those that came last first"},
    {FG_FLAG("more", fg_hub_state, more), .words = "the next page has parts"},
};
const fg_members fg_hub_state_members = FG_MEMBERS(state_rows);

const fg_document fg_hub_document = {
    .file = "hub",
    .title = "foilgauge hub",
    .description = "Stations of a hub over the last day, and the parts of a search.",
    .made_by = "a hub's page `/api/parts`",
    .members = &fg_hub_state_members,
};
