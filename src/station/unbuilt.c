#include "station/actions.h"
#include "station/export.h"
#include "station/pages.h"

#define PAGE(name)                                                                                 \
  fg_status name(fg_context *ctx, fg_inspection *station, sqlite3 *reader,                         \
                 const fg_request *request, FILE *out) {                                           \
    (void)request;                                                                                 \
    FG_TRY(fg_page_begin(ctx, station, reader, out, FG_TAB_HISTORY, "?"));                         \
    fg_page_end(out);                                                                              \
    return FG_OK;                                                                                  \
  }
PAGE(fg_page_trends)
PAGE(fg_page_scanner)
PAGE(fg_page_lots)
#define ACTION(name)                                                                               \
  fg_status name(fg_context *ctx, fg_inspection *station, const fg_request *request,               \
                 fg_answer *answer) {                                                              \
    (void)station;                                                                                 \
    (void)request;                                                                                 \
    (void)answer;                                                                                  \
    return fg_fail(ctx, FG_ERR_DATA, "not yet");                                                   \
  }
ACTION(fg_action_close)
ACTION(fg_action_download)
fg_status fg_station_export(fg_context *ctx, fg_inspection *station, const char *folder) {
  (void)station;
  (void)folder;
  return fg_fail(ctx, FG_ERR_DATA, "not yet");
}
