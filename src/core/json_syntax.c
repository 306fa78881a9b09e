#include "core/json_syntax.h"

#include <ctype.h>

fg_status fg_json_fail_syntax(fg_context *ctx, const char *path, const char *text, const char *at) {
  const char *start = text;
  int line = 1, shown = 0;
  char excerpt[81];
  if (!at || at < text) at = text;
  for (const char *c = text; c < at; c++)
    if (*c == '\n') {
      line++;
      start = c + 1;
    }
  for (const char *c = start; *c && *c != '\n' && shown < 80; c++)
    if (shown > 0 || !isspace((unsigned char)*c))
      excerpt[shown++] = iscntrl((unsigned char)*c) ? ' ' : *c;
  excerpt[shown] = '\0';
  return fg_fail(ctx, FG_ERR_DATA, "%.500s: line %d, column %td: this is not JSON: %s", path, line,
                 at - start + 1, shown ? excerpt : "(the text ends)");
}
