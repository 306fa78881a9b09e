/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The frame of every page: head, style, end. Text from outside is made harmless. */
#include "page/page.h"

#include "core/json_writer.h"

void fg_html_text(FILE *out, const char *text) {
  while (*text) {
    size_t length = fg_utf8_length(text);
    switch (*text) {
    case '<':
      fputs("&lt;", out);
      break;
    case '>':
      fputs("&gt;", out);
      break;
    case '&':
      fputs("&amp;", out);
      break;
    case '"':
      fputs("&quot;", out);
      break;
    case '\'':
      fputs("&#39;", out);
      break;
    default: {
      char visible[16];
      size_t count;
      fg_utf8_make_visible(text, length ? length : 1, true, visible, &count);
      fwrite(visible, 1, count, out);
    }
    }
    text += length ? length : 1;
  }
}

void fg_html_name(FILE *out, const char *text) {
  if (!*text) return;
  fputs("<span translate=\"no\">", out);
  fg_html_text(out, text);
  fputs("</span>", out);
}

/* A page is one file: it fetches nothing, runs nothing, and sends nothing, whatever a name in it
 * says. Styles are inline, pictures are data. */
void fg_html_head(FILE *out, const char *title) {
  fputs("<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
        "style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'\">\n"
        "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<title>",
        out);
  fg_html_text(out, title);
  fputs(" – foilgauge</title>\n", out);
}

void fg_html_begin(FILE *out, const char *title) {
  fg_html_head(out, title);
  fputs("<style>\n", out);
  fputs(fg_page_style, out);
  fputs("</style>\n</head>\n<body>\n<main>\n", out);
}

void fg_html_end(FILE *out) {
  fputs("</main>\n</body>\n</html>\n", out);
}
