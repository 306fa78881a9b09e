/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inputs of `forming`: a material, a schedule, a die's report or a prediction, as the input's first
 * byte says. An input that can be read is used. */
#include <stdlib.h>
#include <string.h>

#include "foilgauge/forming.h"
#include "fuzz.h"

/* Longer schedules and finer layers are only slower. */
enum { POINTS = 12, LAYERS = 8, STEPS = 4 };

static void write_reports(const fg_forming *forming) {
  typedef fg_status writer(fg_context *, const fg_forming *, FILE *);
  writer *const writers[] = {fg_forming_write_json, fg_forming_write_text, fg_forming_write_bumps,
                             fg_forming_write_strip, fg_forming_write_html};
  for (size_t i = 0; i < sizeof writers / sizeof *writers; i++) {
    fg_context ctx = {0};
    fuzz_report report;
    if (!fuzz_report_open(&report)) return;
    if (writers[i](&ctx, forming, report.out) != FG_OK) abort();
    fuzz_report_close(&report, false);
  }
}

static void run(const fg_forming_material *material, const fg_forming_schedule *schedule,
                const fg_forming_die *die) {
  fg_context ctx = {0};
  fg_design design;
  fg_forming forming;
  fg_forming_material usual;
  const fg_forming_options options = {.die = die, .layers = LAYERS, .steps = STEPS};
  fg_forming_schedule hold = {0};
  fg_design_default(&design);
  design.bumps.count = 3;
  fg_forming_material_default(&usual);
  if (!schedule && fg_forming_schedule_hold(&ctx, 650, 2, &hold) != FG_OK) return;
  if (fg_forming_run(&ctx, &design, material ? material : &usual, schedule ? schedule : &hold,
                     &options, &forming) == FG_OK) {
    write_reports(&forming);
    fg_forming_free(&forming);
  }
  fg_forming_schedule_free(&hold);
}

static void use_material(const char *path) {
  fg_context ctx = {0};
  fg_forming_material material;
  fg_forming_material_default(&material);
  if (fg_forming_material_load(&ctx, path, &material) == FG_OK) run(&material, NULL, NULL);
}

static void use_schedule(const char *path) {
  fg_context ctx = {0};
  fg_forming_schedule schedule;
  if (fg_forming_schedule_load(&ctx, path, &schedule) != FG_OK) return;
  if (schedule.count <= POINTS) run(NULL, &schedule, NULL);
  fg_forming_schedule_free(&schedule);
}

static void use_die(const char *path) {
  fg_context ctx = {0};
  fg_design design;
  fg_forming_die die;
  fg_design_default(&design);
  if (fg_forming_die_load(&ctx, path, &design, &die) == FG_OK) run(NULL, NULL, &die);
}

static void use_prediction(const char *path) {
  fg_context ctx = {0};
  double value;
  fg_forming_prediction *prediction = malloc(sizeof *prediction);
  if (prediction && fg_forming_prediction_load(&ctx, path, prediction) == FG_OK)
    for (int number = -1; number < 4; number++)
      (void)fg_forming_predict(&ctx, prediction, number, "height_mm", &value);
  free(prediction);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  typedef void user(const char *path);
  static user *const users[] = {use_material, use_schedule, use_die, use_prediction};
  fuzz_bytes bytes = {data, data + size};
  uint8_t kind = fuzz_take(&bytes);
  users[kind % 4](fuzz_file(bytes.at, (size_t)(bytes.end - bytes.at)));
  return 0;
}
