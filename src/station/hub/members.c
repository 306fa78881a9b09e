/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stations and parts of a hub as members. */
#include "page/page.h"
#include "report/verdict_members.h"
#include "station/hub/hub.h"
#include "station/pages.h"
#include "station/settings.h"

static const char *verdict_class(const fg_subject *subject) {
  const fg_hub_part *part = subject->object;
  return fg_page_verdict_class(part->verdict, part->withheld[0] != '\0');
}

static void write_serial(FILE *out, const fg_subject *subject) {
  const fg_hub_part *part = subject->object;
  fprintf(out, "<a href=\"/api/part?source=%s&amp;foil=%zu\">", part->source, part->foil);
  fg_html_text(out, part->serial);
  fputs("</a>", out);
}

static const fg_member station_rows[] = {
    {FG_TEXT("station", fg_hub_station, station), .heading = "Station", .page = {.rank = 1}},
    {FG_TEXT("source", fg_hub_station, source), .words = "identity of its database"},
    {FG_COUNT("parts", fg_hub_station, parts), .words = "that came in the last 24 hours",
     .heading = "Parts,\n24 h", .page = {.rank = 2}},
    {FG_COUNT("failed", fg_hub_station, failed), .words = "of them that failed",
     .heading = "Failed", .page = {.rank = 3}},
    {FG_COUNT("open", fg_hub_station, open), .words = "of them without a disposition",
     .heading = "Open", .page = {.rank = 4}},
    {FG_TEXT("received_at", fg_hub_station, received_at),
     .words = "when the hub got its last part, UTC", .heading = "Last part, UTC",
     .page = {.rank = 5}},
};
const fg_members fg_hub_station_members = FG_MEMBERS(station_rows);

static const fg_member part_rows[] = {
    {FG_TEXT("serial", fg_hub_part, serial), .heading = "Serial", .page = {.rank = 1},
     .markup = write_serial, .csv = {.rank = 1}},
    {FG_TEXT("verdict", fg_hub_part, verdict), .choices = fg_verdict_words, .heading = "Verdict",
     .page = {.rank = 2}, .look = verdict_class, .csv = {.rank = 2}},
    {FG_TEXT("withheld", fg_hub_part, withheld), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "why the verdict does not hold", .csv = {.rank = 3}},
    {FG_TEXT("disposition", fg_hub_part, disposition), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "scrap, rework, concession, again", .heading = "Disposition", .page = {.rank = 3},
     .csv = {.rank = 4}},
    {FG_TEXT("station", fg_hub_part, station), .heading = "Station", .page = {.rank = 4},
     .csv = {.rank = 5}},
    {FG_TEXT("lot", fg_hub_part, lot), .heading = "Lot", .page = {.rank = 5}, .csv = {.rank = 6}},
    {FG_TEXT("die", fg_hub_part, die), .heading = "Die", .page = {.rank = 6}, .csv = {.rank = 7}},
    {FG_TEXT("operator", fg_hub_part, operator_name), .heading = "Operator", .page = {.rank = 7},
     .csv = {.rank = 8}},
    {FG_TEXT("measured_at", fg_hub_part, measured_at), .words = "UTC, by the station's clock",
     .heading = "Measured, UTC", .page = {.rank = 8}, .csv = {.rank = 9}},
    {FG_TEXT("received_at", fg_hub_part, received_at),
     .words = "when the part first came, UTC, by the hub's clock", .heading = "Received, UTC",
     .page = {.rank = 9}, .csv = {.rank = 13}},
    {FG_TEXT("source", fg_hub_part, source), .words = "identity of the station's database",
     .csv = {.rank = 10}},
    {FG_COUNT("foil", fg_hub_part, foil), .words = "number in that database", .csv = {.rank = 11}},
    {FG_COUNT("event", fg_hub_part, event), .words = "the newest of the foil", .csv = {.rank = 12}},
};
const fg_members fg_hub_part_members = FG_MEMBERS(part_rows);

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
