/* SPDX-License-Identifier: GPL-3.0-or-later */
/* foilgauge/gauge.h has the equation. */
#include "measure/level.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <string.h>

#include "core/text.h"
#include "geometry/level_uncertainty.h"
#include "measure/again.h"
#include "measure/loss.h"

/* Relative scale error of a scanner whose calibration is not stated, standard deviation. */
#define SCALE_UNKNOWN 0.002
/* T(1/2) is between the levels of both sides, whatever the tone curve. */
#define LEVEL_MAX 0.5
/* Standard deviation of T(1/2) by an unknown tone curve (geometry/level_uncertainty.c). */
#define LEVEL_UNKNOWN_SD 0.08
/* Limit of a usual level: few drivers' tone curves lie beyond, and a wrong width would look alike.
 */
#define LEVEL_UNUSUAL 0.25
/* Uncertainty of a level that is transferred from one edge to another. It is a share of the shift,
 * for edges of other directions and slopes of the tone curve; and a share of the contrast by its
 * own ratio, for a curve that bends over one range bends by as much less over a part of it. */
#define CARRY_SHARE          0.05
#define CARRY_CONTRAST_SHARE 0.1
/* Share of the shift where no tone curve explains the edges' profile. */
#define CARRY_UNEXPLAINED_SHARE 0.15
/* Max probability of chance at which gauges contradict each other. */
#define CONTRADICTION_P 0.005

/* Width of a bright gauge per unit of level, mm. */
static double per_level(const fg_gauge_reading *reading) {
  double both = 2 * sqrt(2 * M_PI) * reading->blur_mm;
  return reading->bright ? both : -both;
}

static double u_scale(const fg_design *design) {
  const fg_calibration *c = &design->calibration;
  return fg_calibration_has_scale(c) ? fmax(c->u_scale[0], c->u_scale[1]) : SCALE_UNKNOWN;
}

/* Findings that allow an edge's shift beyond all tone curves. */
#define BEYOND_TONE ((unsigned)FG_PICTURE_CLIPPED | (unsigned)FG_PICTURE_FEW_LEVELS)

static unsigned findings_of(const fg_measurement *m) {
  unsigned found = 0;
  for (size_t i = 0; i < m->foil_count; i++)
    found |= m->foils[i].strip.picture.findings;
  for (size_t i = 0; i < m->disc_count; i++)
    found |= m->discs[i].picture.findings;
  return found;
}

/* One gauge's own level: h - 1/2. */
static void read_level(const fg_design *design, const fg_gauge *gauge, unsigned state,
                       fg_gauge_reading *reading) {
  double slope = per_level(reading);
  double u = hypot(hypot(gauge->u_mm, reading->u_measured_mm), gauge->width_mm * u_scale(design));
  reading->level = (reading->measured_mm - gauge->width_mm) / slope;
  reading->u_level = u / fabs(slope);
  double level = reading->level;
  if (!reading->used || fabs(level) <= LEVEL_UNUSUAL + 2 * reading->u_level) return;
  if (fabs(level) <= LEVEL_MAX + 2 * reading->u_level) {
    fg_text_clip(reading->note, sizeof reading->note,
                 "few tone curves make %g mm read %.4f mm: check that the stated width is its own",
                 gauge->width_mm, reading->measured_mm);
    return;
  }
  reading->used = false;
  if (state & BEYOND_TONE)
    fg_text_clip(reading->note, sizeof reading->note,
                 "reads %.4f mm, not %g mm: the scan is spoiled (%s): scan again without that",
                 reading->measured_mm, gauge->width_mm,
                 state & FG_PICTURE_CLIPPED ? "clipped_levels" : "few_levels");
  else
    fg_text_clip(reading->note, sizeof reading->note,
                 "no tone curve makes %g mm read %.4f mm: is the stated width its own?",
                 gauge->width_mm, reading->measured_mm);
}

void fg_level_add(fg_level_sum *sum, const fg_gauge *gauge, const fg_gauge_reading *reading) {
  double slope = per_level(reading), width = gauge->width_mm;
  double weight = 1 / (gauge->u_mm * gauge->u_mm + reading->u_measured_mm * reading->u_measured_mm);
  double y = reading->measured_mm - width + 0.5 * slope;
  sum->hh += weight * slope * slope;
  sum->he += weight * slope * width;
  sum->ee += weight * width * width;
  sum->h += weight * slope * y;
  sum->e += weight * width * y;
  sum->squares += weight * y * y;
  sum->contrast += reading->contrast;
  sum->count++;
}

double fg_level_solve(const fg_level_sum *sum, double u_scale_rel, fg_level *level) {
  double ee = sum->ee + 1 / (u_scale_rel * u_scale_rel);
  double determinant = sum->hh * ee - sum->he * sum->he, count = (double)sum->count;
  double scale = (sum->hh * sum->e - sum->he * sum->h) / determinant;
  level->half = (ee * sum->h - sum->he * sum->e) / determinant;
  level->u = sqrt(ee / determinant);
  level->contrast = sum->contrast / count;
  if (sum->count < 2) return 0;
  double chi2 = fmax(0, sum->squares - level->half * sum->h - scale * sum->e);
  level->u *= sqrt(fmax(1, chi2 / (count - 1)));
  return chi2 / (count - 1);
}

bool fg_level_is_contradicted(const fg_level_sum *sum, double ratio) {
  double dof = (double)sum->count - 1;
  return dof > 0 && ratio * dof > gsl_cdf_chisq_Qinv(CONTRADICTION_P, dof);
}

double fg_level_u_scale(const fg_level_sum *sum) {
  double hh = sum->hh + 1 / (LEVEL_UNKNOWN_SD * LEVEL_UNKNOWN_SD);
  return sqrt(hh / (hh * sum->ee - sum->he * sum->he));
}

bool fg_level_of_gauges(fg_measurement *m, fg_level *level) {
  fg_level_sum sum = {.count = 0};
  unsigned state = findings_of(m);
  for (size_t i = 0; i < m->design.gauge_count; i++) {
    fg_gauge_reading *reading = &m->gauges[i];
    if (!reading->found) continue;
    read_level(&m->design, &m->design.gauges[i], state, reading);
    if (reading->used) fg_level_add(&sum, &m->design.gauges[i], reading);
  }
  if (!sum.count) return false;
  double ratio = fg_level_solve(&sum, u_scale(&m->design), level);
  m->gauges_contradict = fg_level_is_contradicted(&sum, ratio);
  return true;
}

/* ---- moving the edges ---- */

/* A part by the edge model, and with counts used as light. */
typedef struct placed_part {
  double width_mm, plain_mm, blur_um, plain_blur_um, contrast;
  bool bright;
} placed_part;

/* Sets the shift of a part's edges with its u: as a level in units of the edge model's blur. */
static void set_level(const fg_level *level, const placed_part *part, fg_picture_state *picture) {
  double per_plain = sqrt(2 * M_PI) * part->plain_blur_um / 1000;
  double per_model = sqrt(2 * M_PI) * part->blur_um / 1000;
  double shift = level->half - 0.5; /* of plain edges, towards the dark side */
  double by_model = 0.5 * (part->width_mm - part->plain_mm) * (part->bright ? 1 : -1);
  double ratio =
      part->contrast > 0 && level->contrast > 0 ? fabs(log(part->contrast / level->contrast)) : 0;
  double share =
      picture->findings & FG_PICTURE_UNKNOWN_PROFILE ? CARRY_UNEXPLAINED_SHARE : CARRY_SHARE;
  double u = hypot(hypot(level->u, share * shift), ratio * hypot(CARRY_CONTRAST_SHARE, shift));
  picture->level_known = isfinite(part->plain_mm) && per_model > 0;
  if (!picture->level_known) return;
  picture->level = (shift * per_plain + by_model) / per_model;
  picture->u_level = u * per_plain / per_model;
}

static void set_strip(const fg_level *level, fg_strip *s) {
  const placed_part part = {
      s->thickness_mm,  s->plain_mm,     0.5 * (s->blur_left_um + s->blur_right_um),
      s->plain_blur_um, s->plain_counts, s->bright};
  set_level(level, &part, &s->picture);
}

/* Sets a disc's level uncertainty. The level is now known by gauges, except for JPEG's loss. */
static void set_disc(const fg_level *level, const fg_measurement *m, fg_disc *disc) {
  double um = 25400 / sqrt(m->dpi[0] * m->dpi[1]);
  const placed_part part = {disc->diameter_mm,   disc->plain_mm, disc->blur_um,
                            disc->plain_blur_um, disc->contrast, disc->bright};
  set_level(level, &part, &disc->picture);
  if (!disc->picture.level_known) return;
  disc->edge_u_mm =
      um / 1000 * fg_loss_edge_px(m->file.jpeg_quality, disc->contrast, disc->blur_um / um);
  fg_disc_find_level_uncertainty(&m->design, disc);
}

static void set_levels(const fg_level *level, fg_measurement *m) {
  for (size_t f = 0; f < m->foil_count; f++)
    if (m->foils[f].strip.count) set_strip(level, &m->foils[f].strip);
  for (size_t d = 0; d < m->disc_count; d++)
    set_disc(level, m, &m->discs[d]);
}

/* Share of the mean blur for edges of this normal, where blur is uneven. */
static double blur_towards(const fg_picture_state *picture, fg_point normal) {
  double turn = picture->blur_direction_deg * M_PI / 180;
  double along = normal.x * cos(turn) + normal.y * sin(turn);
  double across = normal.y * cos(turn) - normal.x * sin(turn);
  return hypot(along * picture->blur_px[0], across * picture->blur_px[1]);
}

static double mean_blur(const fg_strip *strip) {
  double sum = 0, count = 0;
  for (size_t k = 0; k < strip->count; k++) {
    sum += blur_towards(&strip->picture, strip->stations[k].normal);
    count++;
  }
  return sum / count;
}

/* Shift of an edge towards its dark side, mm. */
static double shift_of(const fg_strip *strip, double blur_um) {
  double outwards = strip->picture.level * sqrt(2 * M_PI) * blur_um / 1000;
  return strip->bright ? outwards : -outwards;
}

static fg_point moved_point(fg_point at, fg_point towards, double by) {
  return (fg_point){at.x + by * towards.x, at.y + by * towards.y};
}

/* Moves the corners of a cut. It runs from edge to edge and lies across the strip: its corners move
 * with the edges, and along the strip with the cut. */
static void move_end(const fg_strip *strip, const fg_station *station, double inwards,
                     const double shift[2], fg_strip_end *end) {
  fg_point normal = station->normal, along = {normal.y, -normal.x};
  double cut = inwards * (isfinite(end->blur_um) ? shift_of(strip, end->blur_um) : 0);
  end->left = moved_point(moved_point(end->left, normal, shift[0]), along, cut);
  end->right = moved_point(moved_point(end->right, normal, -shift[1]), along, cut);
}

static void move_strip(const void *user, const fg_foil *foil, fg_strip *strip) {
  (void)user;
  (void)foil;
  double mean = mean_blur(strip);
  const double shift[2] = {shift_of(strip, strip->blur_left_um),
                           shift_of(strip, strip->blur_right_um)};
  if (!strip->count || !strip->picture.level_known) return;
  for (size_t k = 0; k < strip->count; k++) {
    fg_station *s = &strip->stations[k];
    double share = isfinite(mean) ? blur_towards(&strip->picture, s->normal) / mean : 1;
    s->left = moved_point(s->left, s->normal, share * shift[0]);
    s->right = moved_point(s->right, s->normal, -share * shift[1]);
  }
  move_end(strip, &strip->stations[0], 1, shift, &strip->ends[0]);
  move_end(strip, &strip->stations[strip->count - 1], -1, shift, &strip->ends[1]);
}

static fg_point move_point(const void *user, const fg_disc *disc, fg_point at) {
  (void)user;
  double dx = at.x - disc->centre_mm.x, dy = at.y - disc->centre_mm.y, r = hypot(dx, dy);
  double outwards = disc->picture.level * sqrt(2 * M_PI) * disc->blur_um / 1000;
  if (!disc->bright) outwards = -outwards;
  return r > 0 && disc->picture.level_known ? moved_point(at, (fg_point){dx / r, dy / r}, -outwards)
                                            : at;
}

/* Keeps the level of the part with the largest uncertainty for the picture. */
static void keep_worst_level(const fg_picture_state *from, fg_picture_state *to) {
  if (to->level_known && !(from->u_level > to->u_level)) return;
  to->level = from->level;
  to->u_level = from->u_level;
  to->level_known = true;
}

static void set_picture(fg_measurement *m) {
  m->picture.level_known = false;
  for (size_t f = 0; f < m->foil_count; f++)
    if (m->foils[f].strip.count) keep_worst_level(&m->foils[f].strip.picture, &m->picture);
  for (size_t d = 0; d < m->disc_count; d++)
    keep_worst_level(&m->discs[d].picture, &m->picture);
}

fg_status fg_level_apply(fg_context *ctx, const fg_level *level, unsigned threads,
                         fg_measurement *m) {
  const fg_measure_mover mover = {move_strip, move_point, NULL, NULL};
  fg_measurement again;
  set_levels(level, m);
  FG_TRY(fg_measure_again(ctx, m, &mover, threads, &again));
  fg_measurement_free(m);
  *m = again;
  set_picture(m);
  return FG_OK;
}
