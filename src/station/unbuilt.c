#include "station/pages.h"

#define PAGE(name)                                                                                 \
  fg_status name(fg_context *ctx, fg_inspection *station, sqlite3 *reader,                         \
                 const fg_request *request, FILE *out) {                                           \
    (void)request;                                                                                 \
    FG_TRY(fg_page_begin(ctx, station, reader, out, FG_TAB_HISTORY, "?"));                         \
    fg_page_end(out);                                                                              \
    return FG_OK;                                                                                  \
  }
PAGE(fg_page_scanner)
