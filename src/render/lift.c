/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/lift.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

typedef struct lift_request {
  double amplitude_um, period_bumps, phase_deg;
  int every, first;
} lift_request;

static const fg_spec_row table[] = {
    {"amplitude_um", FG_SPEC_NUMBER, offsetof(lift_request, amplitude_um), -50, 50},
    {"period_bumps", FG_SPEC_NUMBER, offsetof(lift_request, period_bumps), 1.5, 1000},
    {"phase_deg", FG_SPEC_NUMBER, offsetof(lift_request, phase_deg), -360, 360},
    {"every", FG_SPEC_INTEGER, offsetof(lift_request, every), 1, FG_LIFT_BUMPS_MAX},
    {"first", FG_SPEC_INTEGER, offsetof(lift_request, first), 1, FG_LIFT_BUMPS_MAX},
    {"id", FG_SPEC_OTHER, 0, 0, 0},
    {"form", FG_SPEC_OTHER, 0, 0, 0},
    {"bumps", FG_SPEC_OTHER, 0, 0, 0},
    {"values_um", FG_SPEC_OTHER, 0, 0, 0},
    {0}};

static bool has_member(const cJSON *object, const char *name) {
  return cJSON_GetObjectItemCaseSensitive(object, name) != NULL;
}

/* Checks that exactly one way to name bumps is used, without members of another way. */
static fg_status check_selectors(const fg_place *place, const cJSON *object) {
  const char *selectors[] = {"bumps", "every", "period_bumps", "values_um"};
  const char *belongs[][2] = {{"first", "every"}, {"phase_deg", "period_bumps"}};
  int given = 0;
  for (size_t i = 0; i < sizeof selectors / sizeof *selectors; i++)
    given += has_member(object, selectors[i]);
  if (given != 1)
    return fg_member_fail(place, "", object,
                          "say which bumps, one way: bumps, every, period_bumps or values_um");
  for (size_t i = 0; i < 2; i++)
    if (has_member(object, belongs[i][0]) && !has_member(object, belongs[i][1]))
      return fg_member_fail(place, belongs[i][0],
                            cJSON_GetObjectItemCaseSensitive(object, belongs[i][0]),
                            i ? "belongs to period_bumps" : "belongs to every");
  if (has_member(object, "values_um") == has_member(object, "amplitude_um"))
    return fg_member_fail(place, "amplitude_um",
                          cJSON_GetObjectItemCaseSensitive(object, "amplitude_um"),
                          "bumps, every and period_bumps need it, values_um does not");
  return FG_OK;
}

/* Reads the numbers of the named bumps. */
static fg_status fill_named(const fg_place *place, const cJSON *array, double amplitude_um,
                            fg_lift *lift) {
  double numbers[FG_LIFT_BUMPS_MAX];
  int count = 0;
  FG_TRY(fg_member_numbers(place, "bumps", array,
                           (fg_array_limits){1, FG_LIFT_BUMPS_MAX, 1, FG_LIFT_BUMPS_MAX}, numbers,
                           &count));
  for (int i = 0; i < count; i++) {
    int bump = (int)numbers[i];
    if (numbers[i] != floor(numbers[i]))
      return fg_member_fail(place, "bumps", array, "must be whole numbers");
    lift->um[bump - 1] = amplitude_um;
    if (bump > lift->last) lift->last = bump;
  }
  return FG_OK;
}

static void fill_pattern(const lift_request *request, fg_lift *lift) {
  for (int i = 1; i <= FG_LIFT_BUMPS_MAX; i++) {
    if (request->every)
      lift->um[i - 1] = i >= request->first && (i - request->first) % request->every == 0
                            ? request->amplitude_um
                            : 0;
    else
      lift->um[i - 1] = request->amplitude_um *
                        sin(2 * pi * i / request->period_bumps + request->phase_deg * pi / 180);
  }
  if (request->every) lift->last = request->first;
}

fg_status fg_lift_parse(const fg_place *place, const cJSON *object, fg_lift *lift) {
  lift_request request = {0};
  int whole = 0;
  *lift = (fg_lift){.last = 1};
  FG_TRY(fg_members_read(place, object, table, &request));
  FG_TRY(fg_member_choice(place, object, "form", (const char *const[]){"crown", "whole"}, &whole));
  lift->whole = whole == 1;
  FG_TRY(check_selectors(place, object));
  if (has_member(object, "bumps"))
    return fill_named(place, cJSON_GetObjectItemCaseSensitive(object, "bumps"),
                      request.amplitude_um, lift);
  if (has_member(object, "values_um"))
    return fg_member_numbers(
        place, "values_um", cJSON_GetObjectItemCaseSensitive(object, "values_um"),
        (fg_array_limits){-50, 50, 1, FG_LIFT_BUMPS_MAX}, lift->um, &lift->last);
  if (request.every && !request.first) request.first = request.every;
  fill_pattern(&request, lift);
  return FG_OK;
}

double fg_lift_largest_um(const fg_lift *lift) {
  double largest = 0;
  for (int i = 0; i < FG_LIFT_BUMPS_MAX; i++)
    largest = fmax(largest, fabs(lift->um[i]));
  return largest;
}
