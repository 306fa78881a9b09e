#include "lot/page_parts.h"

#include <math.h>
#include <string.h>

#include "report/measure/measure_page_parts.h"

void fg_lot_put_number(FILE *out, double value, int digits) {
  if (isfinite(value))
    fprintf(out, "%s%.*g", value < 0 ? "−" : "", digits, fabs(value));
  else
    fputs("–", out);
}

void fg_lot_put_value(FILE *out, const fg_quantity *row, double value) {
  fg_lot_put_decimals(out, value, row->decimals);
}

void fg_lot_put_decimals(FILE *out, double value, int decimals) {
  char text[64];
  if (!isfinite(value)) {
    fputs("–", out);
    return;
  }
  snprintf(text, sizeof text, "%.*f", decimals, fabs(value));
  bool zero = strspn(text, "0.") == strlen(text);
  fprintf(out, "%s%s", value < 0 && !zero ? "−" : "", text);
}

void fg_lot_put_verdict(FILE *out, fg_verdict verdict) {
  fprintf(out, "<td class=\"%s\">%s</td>", fg_verdict_word(verdict),
          verdict == FG_VERDICT_UNDECIDED      ? "cannot tell"
          : verdict == FG_VERDICT_NOT_MEASURED ? "not measured"
          : verdict == FG_VERDICT_NONE         ? "–"
                                               : fg_verdict_word(verdict));
}

void fg_lot_put_label(FILE *out, const fg_lot_analysis *analysis, const fg_lot_foil *foil) {
  fg_html_text(out, fg_manifest_label(&analysis->lot->manifest, foil->item));
  if (analysis->lot->records[foil->item].foil_count > 1)
    fprintf(out, ", foil %d", foil->foil->number);
}
