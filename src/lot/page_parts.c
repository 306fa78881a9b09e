#include "lot/page_parts.h"

#include <math.h>

#include "report/measure/measure_page_parts.h"

void fg_lot_put_number(FILE *out, double value, int digits) {
  if (isfinite(value))
    fprintf(out, "%s%.*g", value < 0 ? "−" : "", digits, fabs(value));
  else
    fputs("–", out);
}

void fg_lot_put_label(FILE *out, const fg_lot_analysis *analysis, const fg_lot_foil *foil) {
  fg_html_text(out, fg_manifest_label(&analysis->lot->manifest, foil->item));
  if (analysis->lot->records[foil->item].foil_count > 1)
    fprintf(out, ", foil %d", foil->foil->number);
}
