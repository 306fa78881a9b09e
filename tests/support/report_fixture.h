/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A measurement made of formulas, and what a report's writer makes of it. */
#ifndef FG_TESTS_REPORT_FIXTURE_H
#define FG_TESTS_REPORT_FIXTURE_H

#include <cjson/cJSON.h>

#include "foilgauge/report.h"
#include "quantity/quantity_rows.h"
#include "support/synthetic_foil.h"
#include "support/test.h"

typedef struct fixture {
  fg_design design;
  fg_nominal nominal;
  fg_measurement measurement;
  fg_report_scan scans[2];
  fg_report report;
} fixture;

static inline int set_up(void **state) {
  fixture *all = calloc(1, sizeof *all);
  all->design = synthetic_design();
  all->nominal = synthetic_nominal(&all->design);
  all->measurement = synthetic_measurement(&all->design);
  all->scans[0] = (fg_report_scan){all->measurement.scan, &all->measurement, NULL, NULL};
  all->scans[1] = (fg_report_scan){"lost.png", NULL, "lost.png: cannot be opened", NULL};
  all->report = (fg_report){&all->design, &all->nominal, all->scans, 1, NULL};
  *state = all;
  return 0;
}

static inline int tear_down(void **state) {
  fixture *all = *state;
  synthetic_free(&all->measurement);
  free(all);
  return 0;
}

typedef fg_status report_writer(fg_context *ctx, const fg_report *report, FILE *out);

/* Output of a writer, as text; the caller frees it. */
static inline char *text_of(report_writer *write, const fg_report *report) {
  fg_context ctx = {0};
  char *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  assert_ok(&ctx, write(&ctx, report, out));
  fclose(out);
  return text;
}

static inline cJSON *json_of(const fg_report *report) {
  char *text = text_of(fg_report_write_json, report);
  cJSON *json = cJSON_Parse(text);
  assert_non_null(json);
  free(text);
  return json;
}

static inline const cJSON *member(const cJSON *object, const char *name) {
  const cJSON *found = cJSON_GetObjectItemCaseSensitive(object, name);
  if (!found) print_error("no member '%s'\n", name);
  assert_non_null(found);
  return found;
}

static inline const cJSON *first_foil(const cJSON *json) {
  return cJSON_GetArrayItem(member(json, "foils"), 0);
}

static inline void same_number(const cJSON *json, double value) {
  if (isnan(value)) {
    assert_true(cJSON_IsNull(json));
    return;
  }
  assert_true(cJSON_IsNumber(json));
  assert_true(fabs(json->valuedouble - value) <= 1e-9 * fabs(value));
}

static inline void same_field(const cJSON *object, const fg_quantity *field, const void *values) {
  char u_name[64];
  const char *dot = strchr(field->name, '.'), *name = dot ? dot + 1 : field->name;
  if (dot) {
    char group[64];
    snprintf(group, sizeof group, "%.*s", (int)(dot - field->name), field->name);
    object = member(object, group);
  }
  snprintf(u_name, sizeof u_name, "u_%s", name);
  if (field->kind == FG_QUANTITY_PAIR) {
    double numbers[FG_QUANTITY_NUMBERS_MAX];
    fg_quantity_numbers(field, values, numbers);
    for (int i = 0; i < 2; i++) {
      same_number(cJSON_GetArrayItem(member(object, name), i), numbers[i]);
      same_number(cJSON_GetArrayItem(member(object, u_name), i), numbers[2 + i]);
    }
    return;
  }
  same_number(member(object, name), fg_quantity_value(field, values));
  if (field->u_offset != FG_NO_UNCERTAINTY)
    same_number(member(object, u_name), fg_quantity_uncertainty(field, values));
}

static inline void same_fields(const cJSON *object, fg_quantity_owner owner, const void *values) {
  size_t count;
  const fg_quantity *fields = fg_quantities(owner, &count);
  for (size_t i = 0; i < count; i++)
    if (fg_quantity_applies(owner, &fields[i], FG_FOIL_CLASSICAL))
      same_field(object, &fields[i], values);
}

#define REPORT_TEST(function) cmocka_unit_test_setup_teardown(function, set_up, tear_down)

#endif
