#include "foilgauge/loop.h"
fg_status fg_loop_write_html(fg_context *ctx, const fg_loop_report *report, FILE *out) {
  return fg_loop_write_text(ctx, report, out);
}
fg_status fg_loop_write_model(fg_context *ctx, const fg_loop_report *report, FILE *out) {
  return fg_loop_write_text(ctx, report, out);
}
