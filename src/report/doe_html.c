#include "foilgauge/experiment.h"
fg_status fg_experiment_write_html(fg_context *ctx, const fg_experiment_report *report, FILE *out) {
  (void)ctx; (void)report; (void)out; return FG_OK;
}
