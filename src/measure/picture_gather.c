/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/picture_gather.h"

#include <math.h>
#include <stdio.h>

/* Min difference of the channels' magnifications. Nothing tells the right one, nor does their
 * majority: this difference makes a radius of 3 mm wrong by as much as its u. */
#define MAGNIFICATION_PPM   60.0
#define MAGNIFICATION_SIGMA 3.0
#define RINGING_SHARE       0.015

static double is_certain(double difference, double u) {
  return fabs(difference) - MAGNIFICATION_SIGMA * u;
}

/* Returns the largest certain difference between any two channels' magnifications, ppm. */
static double max_magnification(const fg_colour_lines *lines) {
  const fg_colour_shift *a = &lines->shifts[0], *b = &lines->shifts[1];
  double max = 0;
  /* fmax prefers the number to NaN: a channel that is not measured is unknown */
  max = fmax(max, is_certain(a->magnification_ppm, a->u_magnification_ppm));
  max = fmax(max, is_certain(b->magnification_ppm, b->u_magnification_ppm));
  double u = hypot(a->u_magnification_ppm, b->u_magnification_ppm);
  return fmax(max, is_certain(a->magnification_ppm - b->magnification_ppm, u));
}

static void add_finding(fg_measurement *m, unsigned finding) {
  for (size_t i = 0; i < m->foil_count; i++)
    m->foils[i].strip.picture.findings |= finding;
  for (size_t i = 0; i < m->disc_count; i++)
    m->discs[i].picture.findings |= finding;
}

/* Decides findings under JPEG. It makes edges ring, which looks like a little sharpening or an odd
 * tone curve. A file that declares itself a JPEG needs no finding: its edges' uncertainties include
 * the loss already. */
static void decide_blocks(bool jpeg, fg_picture_state *state) {
  const unsigned looks = FG_PICTURE_SHARPENED | FG_PICTURE_TONE_CURVE | FG_PICTURE_UNKNOWN_PROFILE;
  if (!jpeg && !(state->findings & FG_PICTURE_BLOCK_NOISE)) return;
  if (fmax(state->overshoot, state->undershoot) < RINGING_SHARE) state->findings &= ~looks;
  if (jpeg) state->findings &= ~(unsigned)FG_PICTURE_BLOCK_NOISE;
}

static void decide_all_blocks(fg_measurement *m) {
  for (size_t i = 0; i < m->foil_count; i++)
    decide_blocks(m->file.jpeg_quality > 0, &m->foils[i].strip.picture);
  for (size_t i = 0; i < m->disc_count; i++)
    decide_blocks(m->file.jpeg_quality > 0, &m->discs[i].picture);
}

static void merge_all(fg_measurement *m) {
  m->picture = fg_picture_unknown();
  for (size_t i = 0; i < m->foil_count; i++)
    if (m->foils[i].strip.count || m->foils[i].beam_count)
      fg_picture_merge(&m->picture, &m->foils[i].strip.picture);
  for (size_t i = 0; i < m->disc_count; i++)
    fg_picture_merge(&m->picture, &m->discs[i].picture);
}

/* Appends the names of all findings. */
static void note_findings(fg_measurement *m) {
  size_t used = (size_t)snprintf(m->warning, sizeof m->warning, "state of the picture:");
  const char *before = " ";
  for (const fg_picture_words *words = fg_picture_finding_words(); words->name; words++) {
    if (!(m->picture.findings & words->finding) || used >= sizeof m->warning) continue;
    used +=
        (size_t)snprintf(m->warning + used, sizeof m->warning - used, "%s%s", before, words->name);
    before = ", ";
  }
}

void fg_picture_gather(fg_measurement *m) {
  decide_all_blocks(m);
  if (m->colour_lines.seen && max_magnification(&m->colour_lines) > MAGNIFICATION_PPM)
    add_finding(m, FG_PICTURE_CHANNEL_SCALE);
  merge_all(m);
  if (m->picture.findings && !m->warning[0]) note_findings(m);
}
