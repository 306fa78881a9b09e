/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan_loop/scanner_model_tone.h"

#include <math.h>
#include <string.h>

#include "core/text.h"

/* A level that chance would not show. */
#define SIGNIFICANT 3.3
/* Tolerances for equal settings: a scan has the settings of the level when its edges are as sharp
 * and as asymmetric, its contrast is similar, and its fitted tone curve puts half of the light at
 * the same level. A strip and a disc may fit different curves (exponent or S), but not different
 * levels. */
#define BLUR_RATIO     1.25
#define ASYMMETRY_MAX  0.02
#define CONTRAST_RATIO 1.5
/* A change of the shown level is significant above this many of its deviations, and above the
 * difference of a strip and a disc of one scan. */
#define SHOWN_SIGMAS 3.0
#define SHOWN_MIN    0.01
/* By how much T(1/2) moves with ln gamma, from black on; over part of the scale by less. */
#define LEVEL_PER_LN_GAMMA 0.35
/* A curve whose middle is off by q of the contrast makes an asymmetry of q / 4 (edge_spread.h). */
#define LEVEL_PER_ASYMMETRY 4.0
/* Scatter of the asymmetry, which alone represents an edge without a visible exponent. */
#define U_ASYMMETRY 0.003

/* T(1/2) less a half, as the edge model explains the edge. */
static double shown_level(double model_mm, double plain_mm, double plain_blur_um, bool bright) {
  double both = 2 * sqrt(2 * M_PI) * plain_blur_um / 1000;
  return (plain_mm - model_mm) / (bright ? both : -both);
}

double fg_model_tone_shown_by(const fg_disc *disc) {
  const fg_picture_state *picture = &disc->picture;
  double moved =
      picture->level_known ? 2 * picture->level * sqrt(2 * M_PI) * disc->blur_um / 1000 : 0;
  double as_found = disc->diameter_mm + (disc->bright ? moved : -moved);
  return shown_level(as_found, disc->plain_mm, disc->plain_blur_um, disc->bright);
}

bool fg_model_tone_is_away(const fg_model_tone *tone, double half) {
  return tone->gauges && fabs(tone->level.half - half) > SIGNIFICANT * tone->level.u;
}

/* ---- the file ---- */

static const char *finding_at(const fg_subject *tone, size_t i) {
  const fg_picture_words *words = &fg_picture_finding_words()[i];
  unsigned findings = ((const fg_model_tone *)tone->object)->findings;
  return !words->name || findings & words->finding ? words->name : "";
}

static bool is_written(const fg_subject *tone) {
  (void)tone;
  return true; /* a file of people may lack the member */
}

/* A number within limits; null only where its options allow it. */
#define TONE_NUMBER(name_, field, lowest_, highest_)                                               \
  FG_NUMBER(name_, fg_model_tone, field), .lowest = (lowest_), .highest = (highest_)
enum { GAUGES_MAX = 1000000 };

static const fg_member tone_rows[] = {
    {TONE_NUMBER("level", level.half, 0, 1), .options = FG_MEMBER_NEVER_NULL,
     .words = "share of the contrast, from dark to bright, at which edges lie; 0.5: counts follow "
              "the light"},
    {TONE_NUMBER("u_level", level.u, 0, 0.5), .options = FG_MEMBER_NEVER_NULL,
     .words = "its standard uncertainty"},
    {TONE_NUMBER("contrast", level.contrast, 1, 255), .options = FG_MEMBER_NEVER_NULL,
     .words = "of the discs, counts of 255"},
    {TONE_NUMBER("blur_px", blur_px, 0.01, 100), .options = FG_MEMBER_NEVER_NULL,
     .words = "of edges"},
    {TONE_NUMBER("asymmetry", asymmetry, -1, 1), .options = FG_MEMBER_NEVER_NULL,
     .words = "of edges: the way from half to nine tenths of the contrast less that from a tenth "
              "to half, over both"},
    {TONE_NUMBER("shown_level", shown, -0.5, 0.5), .present = is_written,
     .words = "share of the contrast at which the tone curve that explains their edges has half of "
              "the light, less a half; a scan whose edges show another is not moved"},
    {TONE_NUMBER("gamma", gamma, 0.1, 10),
     .words = "exponent that their edges show; null: not known"},
    {TONE_NUMBER("sharpen_amount", sharpen_amount, 0, 20), .words = "of a sharpening driver"},
    {TONE_NUMBER("sharpen_radius_px", sharpen_radius_px, 0, 100)},
    {FG_COUNT("gauges", fg_model_tone, gauges), .lowest = 1, .highest = GAUGES_MAX,
     .words = "discs that told it"},
    {FG_TEXTS_BY("findings", finding_at), .present = is_written,
     .words = "of the picture's state, by name (picture.findings of a measurement)"},
};
const fg_members fg_model_tone_members = FG_MEMBERS(tone_rows);

static fg_status read_tone_row(fg_context *ctx, const cJSON *object, const fg_member *row,
                               fg_model_tone *tone) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, row->name);
  double *value = (double *)(void *)((char *)tone + row->offset);
  *value = cJSON_IsNumber(item) ? item->valuedouble : NAN;
  if (!(row->options & FG_MEMBER_NEVER_NULL) && (!item || cJSON_IsNull(item))) return FG_OK;
  if (*value >= row->lowest && *value <= row->highest) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA, "`tone.%s` is %g; %g to %g is allowed", row->name, *value,
                 row->lowest, row->highest);
}

static fg_status read_findings(fg_context *ctx, const cJSON *object, fg_model_tone *tone) {
  const cJSON *array = cJSON_GetObjectItemCaseSensitive(object, "findings"), *item;
  if (!array) return FG_OK;
  if (!cJSON_IsArray(array))
    return fg_fail(ctx, FG_ERR_DATA, "`tone.findings` must be an array of words");
  cJSON_ArrayForEach(item, array) {
    const fg_picture_words *words = fg_picture_finding_words();
    while (words->name && !(cJSON_IsString(item) && !strcmp(words->name, item->valuestring)))
      words++;
    if (!words->name)
      return fg_fail(ctx, FG_ERR_DATA, "`tone.findings` holds what is no finding of a picture");
    tone->findings |= words->finding;
  }
  return FG_OK;
}

fg_status fg_model_tone_read(fg_context *ctx, const cJSON *root, fg_model_tone *tone) {
  const cJSON *object = cJSON_GetObjectItemCaseSensitive(root, "tone");
  *tone = (fg_model_tone){.gauges = 0};
  if (!object || cJSON_IsNull(object)) return FG_OK;
  if (!cJSON_IsObject(object))
    return fg_fail(ctx, FG_ERR_DATA, "`tone` is no object; an object or null is allowed");
  for (size_t i = 0; i < fg_model_tone_members.count; i++)
    if (tone_rows[i].kind == FG_MEMBER_NUMBER)
      FG_TRY(read_tone_row(ctx, object, &tone_rows[i], tone));
  const cJSON *gauges = cJSON_GetObjectItemCaseSensitive(object, "gauges");
  double count = cJSON_IsNumber(gauges) ? gauges->valuedouble : NAN;
  if (!(count >= 1 && count <= GAUGES_MAX && count == floor(count)))
    return fg_fail(ctx, FG_ERR_DATA, "`tone.gauges` is %g; a whole number, 1 to %d, is allowed",
                   count, GAUGES_MAX);
  tone->gauges = (size_t)count;
  return read_findings(ctx, object, tone);
}

/* ---- applying it ---- */

/* Means over the edges of a scan. */
typedef struct scan_state {
  double blur_px, asymmetry, contrast, shown, u_gamma;
} scan_state;

static void add_part(scan_state *state, const scan_state *part, double *n) {
  if (!isfinite(part->blur_px) || !isfinite(part->asymmetry)) return;
  double share = 1 / ++*n;
  state->blur_px += share * (part->blur_px - state->blur_px);
  state->asymmetry += share * (part->asymmetry - state->asymmetry);
  state->contrast += share * (part->contrast - state->contrast);
  state->shown += share * (part->shown - state->shown);
  state->u_gamma += share * (part->u_gamma - state->u_gamma);
}

static double relative_u_gamma(const fg_picture_state *picture) {
  return picture->u_gamma / picture->gamma;
}

static scan_state state_of_strip(const fg_strip *s) {
  return (scan_state){s->spread_px, s->asymmetry, s->plain_counts,
                      shown_level(s->thickness_mm, s->plain_mm, s->plain_blur_um, s->bright),
                      relative_u_gamma(&s->picture)};
}

static scan_state state_of_disc(const fg_disc *disc) {
  return (scan_state){disc->spread_px, disc->asymmetry, disc->contrast,
                      fg_model_tone_shown_by(disc), relative_u_gamma(&disc->picture)};
}

static bool see_state(const fg_measurement *m, scan_state *state) {
  double n = 0;
  *state = (scan_state){.blur_px = 0};
  for (size_t f = 0; f < m->foil_count; f++) {
    const scan_state part = state_of_strip(&m->foils[f].strip);
    if (m->foils[f].strip.count) add_part(state, &part, &n);
  }
  for (size_t d = 0; d < m->disc_count; d++) {
    const scan_state part = state_of_disc(&m->discs[d]);
    add_part(state, &part, &n);
  }
  if (m->picture.findings & FG_PICTURE_UNKNOWN_PROFILE) state->shown = NAN;
  return n > 0;
}

/* Standard deviation of the level that the scan's edges show. */
static double u_shown(const scan_state *scan) {
  return scan->u_gamma > 0 ? LEVEL_PER_LN_GAMMA * scan->u_gamma : LEVEL_PER_ASYMMETRY * U_ASYMMETRY;
}

/* Returns the limit within which the level counts as unchanged: uncertainty of its visible and of
 * its invisible part. Where no tone curve explains the edges, of the scan or of the model, only the
 * asymmetry shows it. */
static double u_sameness(const fg_model_tone *tone, const scan_state *scan) {
  double seen = fabs(scan->shown - tone->shown);
  if (!isfinite(seen))
    seen = LEVEL_PER_ASYMMETRY * hypot(scan->asymmetry - tone->asymmetry, U_ASYMMETRY);
  return hypot(seen, u_shown(scan));
}

/* The first member of the scan's state that differs; NULL: none. */
static const char *difference(const fg_model_tone *tone, const scan_state *scan,
                              unsigned findings) {
  const unsigned widening = FG_PICTURE_SHARPENED | FG_PICTURE_TONE_CURVE |
                            FG_PICTURE_UNKNOWN_PROFILE | FG_PICTURE_CLIPPED | FG_PICTURE_FEW_LEVELS;
  if (fabs(log(scan->blur_px / tone->blur_px)) > log(BLUR_RATIO)) return "edges are not as sharp";
  if (!(fabs(scan->asymmetry - tone->asymmetry) <= ASYMMETRY_MAX) ||
      fabs(scan->shown - tone->shown) > fmax(SHOWN_SIGMAS * u_shown(scan), SHOWN_MIN))
    return "the edges show another tone curve";
  if (fabs(log(scan->contrast / tone->level.contrast)) > log(CONTRAST_RATIO))
    return "the contrast is another";
  if (findings & widening & ~tone->findings)
    return "the picture shows what the model's scans did not";
  if ((findings ^ tone->findings) & FG_PICTURE_BLOCK_NOISE)
    return "either it or the model's scans were compressed with loss (JPEG), not both";
  return NULL;
}

fg_status fg_model_tone_apply(fg_context *ctx, const fg_model_tone *tone, unsigned threads,
                              fg_measurement *m) {
  scan_state state;
  m->tone_note[0] = 0;
  if (!tone->gauges || m->picture.level_known || !see_state(m, &state)) return FG_OK;
  const unsigned loss = m->file.jpeg_quality ? FG_PICTURE_BLOCK_NOISE : 0;
  const char *other = difference(tone, &state, m->picture.findings | loss);
  if (!other) {
    fg_level level = tone->level;
    level.u = hypot(level.u, u_sameness(tone, &state));
    return fg_level_apply(ctx, &level, threads, m);
  }
  fg_text_clip(m->tone_note, sizeof m->tone_note,
               "the model's level of edges is not applied: %s (blur %.2f px, model %.2f; asymmetry "
               "%.3f, %.3f; level shown %.3f, %.3f; contrast %.0f, %.0f): have the settings "
               "changed?",
               other, state.blur_px, tone->blur_px, state.asymmetry, tone->asymmetry,
               0.5 + state.shown, 0.5 + tone->shown, state.contrast, tone->level.contrast);
  return FG_OK;
}
