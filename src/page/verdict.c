/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "page/verdict.h"

const char *fg_html_verdict_title(fg_verdict verdict) {
  switch (verdict) {
  case FG_VERDICT_PASS:
    return "Within tolerance";
  case FG_VERDICT_FAIL:
    return "Out of tolerance";
  case FG_VERDICT_UNDECIDED:
    return "Cannot tell";
  case FG_VERDICT_NOT_MEASURED:
    return "Not measured";
  case FG_VERDICT_NONE:
    return "No tolerances stated";
  }
  return "";
}

void fg_html_verdict(FILE *out, fg_verdict verdict) {
  fprintf(out, "<span class=\"verdict %s\">%s</span>\n", fg_verdict_word(verdict),
          fg_html_verdict_title(verdict));
}

void fg_html_outcome(FILE *out, const fg_report_outcome *outcome) {
  if (outcome->rejected && !outcome->exceeded)
    fputs("<span class=\"verdict fail\">Rejected</span>\n", out);
  else
    fg_html_verdict(out, outcome->verdict);
}
