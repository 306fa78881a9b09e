/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/check_state.h"

#include <math.h>
#include <string.h>

#include "core/text.h"

/* Standard deviations by which a change is more than chance: with ten quantities a check, one false
 * alarm in about 40 checks if they varied by u alone, and the smallest change is beyond that. */
#define CHANGE_DEVIATIONS 3.0

/* An arc's edges face some directions only. */
#define COVERAGE_MIN 300.0

static double get_blur(const fg_disc *disc) {
  return disc->blur_um;
}

static double get_uneven_blur(const fg_disc *disc) {
  return disc->picture.blur_px[0] / disc->picture.blur_px[1];
}

#define OF_PICTURE(member)                                                                         \
  static double get_##member(const fg_disc *disc) {                                                \
    return disc->picture.member;                                                                   \
  }
OF_PICTURE(overshoot)
OF_PICTURE(undershoot)
OF_PICTURE(gamma)
OF_PICTURE(u_gamma)
OF_PICTURE(noise)

/* Members of the model of the driver, which is in force where the edges need it. */
static double get_tone_s(const fg_disc *disc) {
  return isnan(disc->picture.tone_s) ? 0 : disc->picture.tone_s;
}

static double get_sharpen_amount(const fg_disc *disc) {
  return isnan(disc->picture.sharpen_amount) ? 0 : disc->picture.sharpen_amount;
}

static double get_noise_along_x(const fg_disc *disc) {
  return disc->picture.noise_correlation[0];
}

static double get_noise_along_y(const fg_disc *disc) {
  return disc->picture.noise_correlation[1];
}

static double get_level(const fg_check_fit *fit, double *u) {
  *u = fit->u_level_um;
  return fit->level_um;
}

static double get_blur_of_marks(const fg_check_fit *fit, double *u) {
  *u = fit->u_blur_um;
  return fit->blur_um;
}

/* A value of grids alone: discs are held against their limits, not against a baseline. */
static double get_of_grid(const fg_check_fit *fit, double value, double u_value, double *u) {
  *u = fit->is_grid ? u_value : NAN;
  return fit->is_grid ? value : NAN;
}

static double get_scale_x(const fg_check_fit *fit, double *u) {
  return get_of_grid(fit, 1e6 * fit->scale[0], 1e6 * fit->u_scale[0], u);
}

static double get_scale_y(const fg_check_fit *fit, double *u) {
  return get_of_grid(fit, 1e6 * fit->scale[1], 1e6 * fit->u_scale[1], u);
}

static double get_shear(const fg_check_fit *fit, double *u) {
  return get_of_grid(fit, 1e6 * fit->shear, 1e6 * fit->u_shear, u);
}

static double get_largest(const fg_check_fit *fit, double *u) {
  return get_of_grid(fit, fit->largest_um, fit->u_largest_um, u);
}

/* Smallest changes that matter: those that move the thickness of a strip by 0.5 µm at 2400 dpi
 * and a blur of 1 px. A level q of the contrast moves it by 2 q sqrt(2 pi) px: 0.01 does.
 * Overshoot equals as much level; the middle of a power of the light moves by 0.35 per unit of
 * gamma; an S moves a thin strip's edges by a fifth of its slope's change. A blur that changes
 * by a tenth, and noise by half or in its correlation, show another focus, filter or resolution. A
 * scale or shear of 50 ppm moves a radius of 20 mm by 1 µm; a residual of 2 µm is a foil's place on
 * such a scanner. */
const fg_check_quantity fg_check_quantities[FG_CHECK_QUANTITIES] = {
    {"level_um", "edges of bright parts, outwards", "µm", 2, 0.25, 0, NULL, NULL,
     "tone curve, contrast, brightness", 0, get_level},
    {"blur_um", "blur", "µm", 2, 0, 0.1, get_blur, NULL,
     "sharpening, dirty glass, focus, interpolation", 0, get_blur_of_marks},
    {"uneven_blur", "blur along its longest axis over across", "", 3, 0.1, 0, get_uneven_blur, NULL,
     "interpolation, carriage", FG_PICTURE_UNEVEN_BLUR, NULL},
    {"overshoot", "overshoot", "", 3, 0.01, 0, get_overshoot, NULL, "sharpening", 0, NULL},
    {"undershoot", "undershoot", "", 3, 0.01, 0, get_undershoot, NULL, "sharpening", 0, NULL},
    {"gamma", "gamma", "", 3, 0.03, 0, get_gamma, get_u_gamma, "gamma", 0, NULL},
    {"tone_s", "S-shape of the tone curve", "", 3, 0.05, 0, get_tone_s, NULL,
     "contrast, tone curve", 0, NULL},
    {"sharpen_amount", "unsharp mask", "", 3, 0.05, 0, get_sharpen_amount, NULL, "sharpening", 0,
     NULL},
    {"noise", "noise", "counts", 2, 0.1, 0.5, get_noise, NULL, "noise reduction, lamp, contrast", 0,
     NULL},
    {"noise_correlation_x", "correlation of the noise along x", "", 2, 0.1, 0, get_noise_along_x,
     NULL, "noise reduction, interpolation", FG_PICTURE_CORRELATED_NOISE, NULL},
    {"noise_correlation_y", "correlation of the noise along y", "", 2, 0.1, 0, get_noise_along_y,
     NULL, "noise reduction, interpolation", FG_PICTURE_CORRELATED_NOISE, NULL},
    {"scale_x_ppm", "scale along x", "ppm", 0, 50, 0, NULL, NULL, "temperature, optics", 0,
     get_scale_x},
    {"scale_y_ppm", "scale along y", "ppm", 0, 50, 0, NULL, NULL, "temperature, carriage", 0,
     get_scale_y},
    {"shear_urad", "shear", "µrad", 0, 50, 0, NULL, NULL, "carriage, rails", 0, get_shear},
    {"largest_um", "largest residual of a mark", "µm", 1, 2, 0.3, NULL, NULL,
     "carriage, rows lost, dirt", 0, get_largest},
};

/* Mean over the discs, and their standard deviation: not that of the mean, as discs show how much
 * the quantity varies over the glass. One disc does not show that: 0. */
static void find_mean(const fg_measurement *measurement, double (*of_disc)(const fg_disc *),
                      double *mean, double *sd) {
  double sum = 0, squares = 0;
  size_t count = 0;
  for (size_t i = 0; i < measurement->disc_count; i++) {
    double value = of_disc(&measurement->discs[i]);
    if (!isfinite(value) || measurement->discs[i].coverage_deg < COVERAGE_MIN) continue;
    sum += value;
    count++;
  }
  *mean = count ? sum / (double)count : NAN;
  for (size_t i = 0; i < measurement->disc_count; i++) {
    double value = of_disc(&measurement->discs[i]);
    if (!isfinite(value) || measurement->discs[i].coverage_deg < COVERAGE_MIN) continue;
    squares += (value - *mean) * (value - *mean);
  }
  *sd = count > 1 ? sqrt(squares / (double)(count - 1)) : 0;
}

void fg_check_state_find(const fg_measurement *measurement, const fg_check_fit *fit,
                         fg_check_state *state) {
  *state = (fg_check_state){.dpi = llround(measurement->dpi[0]),
                            .findings = measurement->picture.findings};
  for (size_t k = 0; k < FG_CHECK_QUANTITIES; k++) {
    const fg_check_quantity *row = &fg_check_quantities[k];
    if (row->of_disc) {
      double unused;
      find_mean(measurement, row->of_disc, &state->value[k], &state->u[k]);
      if (row->u_of_disc) find_mean(measurement, row->u_of_disc, &state->u[k], &unused);
    }
    if (row->of_fit && !(row->of_disc && isfinite(state->value[k])))
      state->value[k] = row->of_fit(fit, &state->u[k]);
  }
}

double fg_check_state_allowed(const fg_check_state *state, const fg_check_state *baseline,
                              size_t k) {
  const fg_check_quantity *row = &fg_check_quantities[k];
  double chance = CHANGE_DEVIATIONS * hypot(state->u[k], baseline->u[k]);
  return fmax(chance, fmax(row->smallest_change, row->share * fabs(baseline->value[k])));
}

static void append_state_words(char *words, size_t size, const char *text) {
  size_t used = strlen(words);
  fg_text_clip(words + used, size - used, "%s%s", used ? ", " : "", text);
}

size_t fg_check_state_compare(const fg_check_state *state, const fg_check_state *baseline,
                              char *words, size_t size) {
  size_t count = 0;
  unsigned new_findings = state->findings & ~baseline->findings;
  char text[200];
  words[0] = '\0';
  for (size_t k = 0; k < FG_CHECK_QUANTITIES; k++) {
    const fg_check_quantity *row = &fg_check_quantities[k];
    double change = fabs(state->value[k] - baseline->value[k]);
    if (isnan(state->u[k]) || isnan(baseline->u[k])) continue;
    if (!isnan(change)) new_findings &= ~row->findings;
    if (!(change > fg_check_state_allowed(state, baseline, k))) continue;
    fg_text_clip(text, sizeof text, "%s %.*f%s%s (was %.*f, allowed ± %.*f)", row->words,
                 row->decimals, state->value[k], row->unit[0] ? " " : "", row->unit, row->decimals,
                 baseline->value[k], row->decimals, fg_check_state_allowed(state, baseline, k));
    append_state_words(words, size, text);
    count++;
  }
  for (const fg_picture_words *found = fg_picture_finding_words(); found->name; found++) {
    if (!(new_findings & found->finding)) continue;
    append_state_words(words, size, found->name);
    count++;
  }
  return count;
}

static void name_findings(unsigned findings, char *names, size_t size) {
  names[0] = '\0';
  for (const fg_picture_words *found = fg_picture_finding_words(); found->name; found++)
    if (findings & found->finding) append_state_words(names, size, found->name);
}

static unsigned read_findings(const char *names) {
  unsigned findings = 0;
  for (const fg_picture_words *found = fg_picture_finding_words(); found->name; found++) {
    size_t length = strlen(found->name);
    for (const char *at = names; (at = strstr(at, found->name)); at += length)
      if ((at == names || at[-1] == ' ') && (!at[length] || at[length] == ','))
        findings |= found->finding;
  }
  return findings;
}

fg_status fg_check_state_keep(fg_context *ctx, sqlite3 *writer, int64_t id,
                              const fg_check_state *state) {
  fg_query query;
  char names[500];
  name_findings(state->findings, names, sizeof names);
  fg_query_begin(writer, "UPDATE checks SET dpi = ?, findings = ? WHERE id = ?", &query);
  fg_query_integer(&query, state->dpi);
  fg_query_text(&query, names);
  fg_query_integer(&query, id);
  fg_query_row(&query);
  FG_TRY(fg_query_end(ctx, &query, "keeping a check"));
  fg_query_begin(writer, "INSERT INTO check_values (check_id, name, value, u) VALUES (?, ?, ?, ?)",
                 &query);
  for (size_t k = 0; k < FG_CHECK_QUANTITIES; k++) {
    if (isnan(state->value[k])) continue;
    fg_query_again(&query);
    fg_query_integer(&query, id);
    fg_query_text(&query, fg_check_quantities[k].name);
    fg_query_number(&query, state->value[k]);
    fg_query_number(&query, state->u[k]);
    fg_query_row(&query);
  }
  return fg_query_end(ctx, &query, "keeping a check");
}

static fg_status load_values(fg_context *ctx, sqlite3 *connection, int64_t id,
                             fg_check_state *state) {
  fg_query query;
  fg_query_begin(connection, "SELECT name, value, u FROM check_values WHERE check_id = ?", &query);
  fg_query_integer(&query, id);
  while (fg_query_row(&query))
    for (size_t k = 0; k < FG_CHECK_QUANTITIES; k++)
      if (!strcmp(fg_query_get_text(&query, 0), fg_check_quantities[k].name)) {
        state->value[k] = fg_query_get_number(&query, 1);
        state->u[k] = fg_query_get_number(&query, 2);
      }
  return fg_query_end(ctx, &query, "reading the checks");
}

fg_status fg_check_state_load(fg_context *ctx, sqlite3 *connection, int64_t id,
                              fg_check_state *state) {
  fg_query query;
  *state = (fg_check_state){.dpi = 0};
  for (size_t k = 0; k < FG_CHECK_QUANTITIES; k++)
    state->value[k] = state->u[k] = NAN;
  fg_query_begin(connection, "SELECT dpi, findings FROM checks WHERE id = ?", &query);
  fg_query_integer(&query, id);
  if (fg_query_row(&query)) {
    state->dpi = fg_query_get_integer(&query, 0);
    state->findings = read_findings(fg_query_get_text(&query, 1));
  }
  FG_TRY(fg_query_end(ctx, &query, "reading the checks"));
  return load_values(ctx, connection, id, state);
}

fg_status fg_check_state_baseline(fg_context *ctx, sqlite3 *connection, int64_t dpi, int64_t *at,
                                  fg_check_state *state) {
  fg_query query;
  int64_t id = 0;
  *at = 0;
  fg_query_begin(
      connection,
      "SELECT id, at FROM checks WHERE baseline = 1 AND dpi = ? ORDER BY id DESC LIMIT 1", &query);
  fg_query_integer(&query, dpi);
  if (fg_query_row(&query)) {
    id = fg_query_get_integer(&query, 0);
    *at = fg_query_get_integer(&query, 1);
  }
  FG_TRY(fg_query_end(ctx, &query, "reading the checks"));
  return id ? fg_check_state_load(ctx, connection, id, state) : FG_OK;
}
