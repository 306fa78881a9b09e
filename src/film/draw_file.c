/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "film/draw_file.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/sha256.h"
#include "foilgauge/memory.h"
#include "foilgauge/version.h"

enum { LINE_MAX_BYTES = 1024, RESULT_NUMBERS = 15 };
static const char heading[] = "foilgauge film draws ";

static void add_to_sum(struct sha256_ctx *sum, double value) {
  char text[40];
  int length = snprintf(text, sizeof text, "%.17g,", value);
  sha256_update(sum, (size_t)length, (const uint8_t *)text);
}

/* Sums all that the result of a draw depends on. */
static void sum_inputs(const fg_film_report *r, const fg_film_bearing *perfect,
                       const fg_film_stock *stock, char hex[65]) {
  struct sha256_ctx sum;
  const fg_film_options *o = &r->options;
  const double numbers[] = {o->load_n,
                            o->load_deg,
                            o->speed_rpm,
                            o->rotor_mass_kg,
                            r->clearance_um,
                            r->compliance,
                            r->length_mm,
                            r->diameter_mm,
                            o->loss_factor,
                            o->viscosity_upa_s,
                            o->ambient_kpa,
                            (double)o->pads,
                            (double)o->bumps_per_pad,
                            o->pitch_deg,
                            (double)o->top_foil,
                            o->top_foil_mm,
                            o->material.youngs_modulus_gpa,
                            o->material.poisson_ratio,
                            (double)o->cells_per_bump,
                            (double)o->cells_axial,
                            o->touching_um,
                            o->draw.shim_low_pct,
                            o->draw.shim_high_pct,
                            (double)o->seed,
                            r->tolerance.threshold_rpm,
                            o->within_pct};
  sha256_init(&sum);
  sha256_update(&sum, strlen(FOILGAUGE_VERSION), (const uint8_t *)FOILGAUGE_VERSION);
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
    add_to_sum(&sum, numbers[i]);
  for (size_t i = 0; i < perfect->count; i++) {
    add_to_sum(&sum, perfect->clearance_mm[i]);
    add_to_sum(&sum, perfect->stiffness_n_mm2[i]);
    add_to_sum(&sum, r->bore_shift_mm[i]);
  }
  for (size_t i = 0; stock && i < stock->foils * stock->places; i++) {
    add_to_sum(&sum, stock->clearance_mm[i]);
    add_to_sum(&sum, stock->stiffness[i]);
  }
  fg_sha256_finish(&sum, hex);
}

/* The numbers of a line, in its order. */
static void list_result_numbers(fg_film_result *result, double *numbers[RESULT_NUMBERS]) {
  double *const all[RESULT_NUMBERS] = {
      &result->speed_rpm,         &result->compressibility,  &result->place_um[0],
      &result->place_um[1],       &result->eccentricity,     &result->attitude_deg,
      &result->min_film_um,       &result->min_film_deg,     &result->max_pressure_kpa,
      &result->power_w,           &result->critical_mass_kg, &result->whirl_ratio,
      &result->mass_over_perfect, &result->stable_again_kg,  NULL};
  memcpy(numbers, all, sizeof all);
}

/* Reads "draw outcome threshold number ..."; false for a line that was cut off. */
static bool read_draw_line(const char *line, fg_film_result *result) {
  double *numbers[RESULT_NUMBERS];
  unsigned long draw;
  unsigned outcome, threshold;
  int used = 0;
  size_t length = strlen(line);
  if (!length || line[length - 1] != '\n') return false;
  if (sscanf(line, "%lu %u %u%n", &draw, &outcome, &threshold, &used) != 3) return false;
  if (outcome > FG_FILM_UNSOLVED || threshold > FG_FILM_THRESHOLD_ABOVE) return false;
  *result = (fg_film_result){.outcome = (fg_film_outcome)outcome,
                             .threshold = (fg_film_threshold_verdict)threshold,
                             .draw = draw,
                             .log_decrement = NAN};
  list_result_numbers(result, numbers);
  const char *at = line + used;
  for (size_t i = 0; numbers[i]; i++) {
    char *end;
    *numbers[i] = strtod(at, &end);
    if (end == at) return false;
    at = end;
  }
  return *at == '\n';
}

static fg_status read_draws(fg_context *ctx, const char *sum, fg_film_draws *draws,
                            fg_film_draw_file *file) {
  char line[LINE_MAX_BYTES];
  fg_film_result result;
  bool ours = false;
  while (fgets(line, sizeof line, file->stream)) {
    if (!strncmp(line, heading, sizeof heading - 1)) {
      ours = !strncmp(line + sizeof heading - 1, sum, strlen(sum));
      if (!ours)
        return fg_fail(
            ctx, FG_ERR_DATA,
            "%s: holds draws of another bearing, load, mesh, seed or program: keep these "
            "in a file of their own",
            file->path);
      continue;
    }
    if (!ours)
      return fg_fail(ctx, FG_ERR_DATA,
                     "%s: not a file that `foilgauge film --keep` wrote; name another one",
                     file->path);
    if (!read_draw_line(line, &result) || !result.draw || result.draw > draws->count) continue;
    draws->kept += !file->known[result.draw - 1];
    file->known[result.draw - 1] = true;
    draws->result[result.draw - 1] = result;
  }
  return FG_OK;
}

/* Begins with the heading, on a line of its own whatever a killed run left. */
static fg_status begin_part(fg_context *ctx, const char *sum, fg_film_draw_file *file) {
  bool cut = fseek(file->stream, -1, SEEK_END) == 0 && fgetc(file->stream) != '\n';
  fseek(file->stream, 0, SEEK_END);
  if (fprintf(file->stream, "%s%s%s\n", cut ? "\n" : "", heading, sum) > 0 &&
      fflush(file->stream) == 0)
    return FG_OK;
  return fg_output_fail(ctx, file->path, errno);
}

fg_status fg_film_draw_file_open(fg_context *ctx, const fg_film_report *report,
                                 const fg_film_bearing *perfect, const fg_film_stock *stock,
                                 fg_film_draws *draws, fg_film_draw_file *file) {
  char sum[65];
  void *block;
  fg_status status = FG_OK;
  *file = (fg_film_draw_file){.path = report->options.draw.keep, .count = draws->count};
  FG_TRY(fg_memory_allocate(ctx, draws->count, sizeof *file->known, &block));
  file->known = block;
  pthread_mutex_init(&file->lock, NULL);
  if (!file->path) return FG_OK;
  sum_inputs(report, perfect, stock, sum);
  status = fg_file_open_to_append(ctx, file->path, &file->stream);
  if (status == FG_OK) status = read_draws(ctx, sum, draws, file);
  if (status == FG_OK) status = begin_part(ctx, sum, file);
  if (status != FG_OK) {
    fg_context unused;
    fg_film_draw_file_close(&unused, file);
  }
  return status;
}

fg_status fg_film_draw_file_add(fg_context *ctx, fg_film_draw_file *file,
                                const fg_film_result *result) {
  double *numbers[RESULT_NUMBERS];
  fg_film_result copy = *result;
  if (!file->stream) return FG_OK;
  list_result_numbers(&copy, numbers);
  pthread_mutex_lock(&file->lock);
  fprintf(file->stream, "%zu %u %u", result->draw, (unsigned)result->outcome,
          (unsigned)result->threshold);
  for (size_t i = 0; numbers[i]; i++)
    fprintf(file->stream, " %.17g", *numbers[i]);
  fputc('\n', file->stream);
  bool fine = fflush(file->stream) == 0 && !ferror(file->stream);
  pthread_mutex_unlock(&file->lock);
  return fine ? FG_OK : fg_output_fail(ctx, file->path, errno);
}

fg_status fg_film_draw_file_close(fg_context *ctx, fg_film_draw_file *file) {
  bool fine = !file->stream || fclose(file->stream) == 0;
  pthread_mutex_destroy(&file->lock);
  free(file->known);
  file->known = NULL;
  return fine ? FG_OK : fg_output_fail(ctx, file->path, errno);
}
