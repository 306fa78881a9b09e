/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Load-displacement tests as tables. */
#include <math.h>

#include "core/csv.h"
#include "core/file.h"
#include "core/utf8.h"
#include "foilgauge/load_report.h"
#include "report/load_test/members.h"

static void put_csv_text(FILE *out, const char *text) {
  fg_csv_put_text(out, text, fg_utf8_put);
}

static bool find_csv_direction(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_load_test *test = list->object;
  element->object = &test->directions[i];
  return i < test->direction_count;
}

fg_status fg_load_write_csv(fg_context *ctx, const fg_load_test *test, FILE *out) {
  fg_members_csv(out, &fg_load_direction_members, &(fg_subject){.object = test, .whole = test},
                 find_csv_direction);
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
