/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Load-displacement tests as tables. */
#include <math.h>

#include "core/csv.h"
#include "core/file.h"
#include "core/json_writer.h"
#include "foilgauge/load_report.h"

static void put_csv_text(FILE *out, const char *text) {
  fg_csv_put_text(out, text, fg_utf8_put);
}

static void put_load_value(FILE *out, const fg_load_value *value, double unit) {
  fg_csv_put_number(out, unit * value->value);
  fg_csv_put_number(out, unit * value->u);
}

fg_status fg_load_write_csv(fg_context *ctx, const fg_load_test *test, FILE *out) {
  fputs("bearing,azimuth_deg,pad,verdict,flags,cycles,clearance_mm,u_clearance_mm,"
        "clearance_unloading_mm,u_clearance_unloading_mm,stiffness_n_mm,u_stiffness_n_mm,"
        "stiffness_at_mm,loop_area_n_mm,u_loop_area_n_mm,loss_factor,u_loss_factor,"
        "loss_factor_secant,u_loss_factor_secant,stiffness_secant_n_mm,u_stiffness_secant_n_mm,"
        "loss_factor_foil,u_loss_factor_foil,friction_intercept_n,friction_slope,"
        "predicted_clearance_mm,u_predicted_clearance_mm,clearance_difference_mm,"
        "u_clearance_difference_mm,gap_mm,u_gap_mm\n",
        out);
  for (size_t i = 0; i < test->direction_count; i++) {
    const fg_load_direction *d = &test->directions[i];
    char flags[200];
    fg_load_flag_words(d->flags, false, flags, sizeof flags);
    put_csv_text(out, test->bearings[d->bearing].name);
    fg_csv_put_number(out, d->azimuth_deg);
    fputc(',', out);
    put_csv_text(out, d->pad);
    fprintf(out, ",%s,%s,%zu", fg_verdict_word(fg_load_judge_direction(test, d)), flags, d->cycles);
    put_load_value(out, &d->clearance, 1);
    put_load_value(out, &d->unloading, 1);
    put_load_value(out, &d->stiffness, 1);
    fg_csv_put_number(out, d->stiffness_at_mm);
    put_load_value(out, &d->area, 1);
    put_load_value(out, &d->loss, 1);
    put_load_value(out, &d->loss_secant, 1);
    put_load_value(out, &d->secant, 1);
    put_load_value(out, &d->loss_foil, 1);
    fg_csv_put_number(out, d->friction.a_n);
    fg_csv_put_number(out, d->friction.b);
    put_load_value(out, &d->predicted, 1);
    put_load_value(out, &d->difference, 1);
    put_load_value(out, &d->gap, 1);
    fputc('\n', out);
  }
  return fg_stream_finish(ctx, out, "the CSV");
}

/* Causes that the table can have. */
typedef struct causes {
  bool bearing, pad, predicted_pad;
} causes;

static causes find_causes(const fg_load_test *test) {
  causes all = {.bearing = test->bearing_count > 1};
  for (size_t i = 0; i < test->direction_count; i++) {
    all.pad = all.pad || test->directions[i].pad[0];
    all.predicted_pad = all.predicted_pad || test->directions[i].predicted_pad > 0;
  }
  all.predicted_pad = all.predicted_pad && !all.pad;
  return all;
}

fg_status fg_load_write_table(fg_context *ctx, const fg_load_test *test, FILE *out) {
  bool lot = test->options.lot != NULL;
  causes all = find_causes(test);
  fprintf(out, "%s%sazimuth_cosine,azimuth_sine,azimuth_cosine_2,azimuth_sine_2,%s\n",
          all.bearing ? "bearing," : "", all.pad || all.predicted_pad ? "pad," : "",
          lot ? "difference_um" : "clearance_um");
  for (size_t i = 0; i < test->direction_count; i++) {
    const fg_load_direction *d = &test->directions[i];
    const fg_load_value *response = lot ? &d->difference : &d->clearance;
    double angle = d->azimuth_deg * M_PI / 180;
    if (!isfinite(response->value)) continue;
    if (all.bearing) {
      put_csv_text(out, test->bearings[d->bearing].name);
      fputc(',', out);
    }
    if (all.pad) {
      put_csv_text(out, d->pad);
      fputc(',', out);
    }
    if (all.predicted_pad) fprintf(out, "pad %d,", d->predicted_pad);
    fprintf(out, "%.9f,%.9f,%.9f,%.9f", cos(angle), sin(angle), cos(2 * angle), sin(2 * angle));
    fg_csv_put_number(out, 1000 * response->value);
    fputc('\n', out);
  }
  return fg_stream_finish(ctx, out, "the table");
}
