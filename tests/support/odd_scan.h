/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Small measured scans of foils and discs that are odd in every way, made without a picture: edges
 * by formula, measured by the library. Every number comes from bytes, so that a fuzzer can steer
 * it and a test can draw it. */
#ifndef FG_TEST_ODD_SCAN_H
#define FG_TEST_ODD_SCAN_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/measure.h"
#include "geometry/disc_fit.h"
#include "random.h"

enum { ODD_SCANS = 3, ODD_FOILS = 3, ODD_BUMPS = 40, ODD_DISCS = 40, ODD_STATIONS = 6000 };

/* Faults of the edges of one foil or disc. */
typedef enum odd_fault {
  ODD_NAN = 1,         /* some edges are nowhere */
  ODD_DOUBLED = 2,     /* stations stand on their neighbours */
  ODD_HIDDEN = 4,      /* a stretch is not usable */
  ODD_STILL = 8,       /* arc length does not grow */
  ODD_WIDE = 16,       /* edges change places */
  ODD_FAR = 32,        /* a long way from the picture */
  ODD_UNMEASURED = 64, /* the foil counts as not measured */
  ODD_SPIKES = 128,    /* single edges far off */
} odd_fault;

typedef struct odd_foil {
  int bumps, missing; /* places of bumps; bit k % 31: bump k is flat */
  double overall_mm, radius_mm, spread, pitch_deg, chord; /* chord: share of the pitch */
  double turn_deg, x_mm, y_mm, step_mm, noise_um, oval_um;
  bool lip;
  unsigned faults; /* odd_fault */
  uint64_t seed;
} odd_foil;

typedef struct odd_disc {
  double x_mm, y_mm, radius_mm, noise_um, oval_um;
  size_t stations;
  unsigned faults;
  uint64_t seed;
} odd_disc;

/* Errors of the scanner along both axes. */
typedef struct odd_scanner {
  double scale, shear, ripple_um, period_mm, step_um, step_mm, bend_um;
} odd_scanner;

typedef struct odd_scan {
  odd_scanner scanner;
  odd_foil foil[ODD_FOILS];
  odd_disc disc[ODD_DISCS];
  size_t foils, discs;
  bool hold_out;
} odd_scan;

typedef struct odd_input {
  odd_scan scan[ODD_SCANS];
  size_t scans;
  bool same_foil;
  fg_design design;
} odd_input;

/* A plain foil of the default design. */
static inline odd_foil odd_plain_foil(int bumps) {
  return (odd_foil){.bumps = bumps,
                    .overall_mm = 20.95,
                    .radius_mm = 3.38,
                    .spread = 0.01,
                    .pitch_deg = 40.0 / 3,
                    .chord = 0.72,
                    .turn_deg = -90,
                    .x_mm = 24,
                    .y_mm = 24,
                    .step_mm = 0.04,
                    .noise_um = 0.1,
                    .lip = true,
                    .seed = 1};
}

/* ---- edges ---- */

static inline fg_point odd_through(const odd_scanner *s, fg_point p) {
  double y = p.y - 20;
  p.x += s->shear * y + 1e-3 * s->bend_um * (p.x - 20) * (p.x - 20) / 324;
  p.y += s->scale * y + (p.y > s->step_mm ? 1e-3 * s->step_um : 0);
  if (s->period_mm > 0) p.y += 1e-3 * s->ripple_um * sin(6.283185307179586 * y / s->period_mm);
  return p;
}

/* Distance of the midline from O, psi counted from the first bump's middle. */
static inline double odd_midline(const odd_foil *f, double psi) {
  double pitch = f->pitch_deg * 3.141592653589793 / 180, r0 = f->overall_mm;
  int k = (int)floor(psi / pitch + 0.5);
  if (k < 0 || k >= f->bumps || (f->missing >> (k % 31) & 1)) return r0;
  double r = f->radius_mm * (1 + f->spread * sin(2.1 * k)), delta = psi - k * pitch;
  double half = 0.5 * f->chord * pitch, chord = r0 * sin(half);
  if (fabs(delta) >= half || !(chord < r)) return r0;
  double x = r0 * cos(half) + sqrt(r * r - chord * chord), s = x * sin(delta);
  return r * r > s * s ? fmin(r0, x * cos(delta) - sqrt(r * r - s * s)) : r0;
}

static inline fg_point odd_at(const odd_foil *f, double psi, double beyond_mm) {
  double turn = (f->turn_deg * 3.141592653589793 / 180) + psi;
  double rho = odd_midline(f, psi) + beyond_mm + 1e-3 * f->oval_um * cos(2 * psi);
  double far = f->faults & ODD_FAR ? 1e7 : 0;
  return (fg_point){far + f->x_mm + rho * cos(turn), far + f->y_mm + rho * sin(turn)};
}

/* The lip is bent outwards within its radius of 0.3 mm. */
static inline size_t odd_lip(const odd_foil *f, double psi, fg_point *path) {
  size_t n = 0;
  for (int k = 30; f->lip && k > 0; k--) {
    double along = 0.02 * k, turn = fmin(along / 0.3, 1.5), leg = fmax(0, along - 0.45);
    double back = (0.3 * sin(turn)) / f->overall_mm;
    path[n++] = odd_at(f, psi - back, 0.3 * (1 - cos(turn)) + leg);
  }
  return n;
}

/* Points of the midline, step_mm apart. */
static inline size_t odd_path(const odd_foil *f, fg_point *path) {
  double pitch = f->pitch_deg * 3.141592653589793 / 180;
  double first = -0.9 * pitch, last = (f->bumps - 0.1) * pitch;
  size_t n = odd_lip(f, first, path);
  for (double psi = first; psi < last && n < ODD_STATIONS;) {
    fg_point p = odd_at(f, psi, 0), q = odd_at(f, psi + 1e-5, 0);
    double speed = hypot(q.x - p.x, q.y - p.y) / 1e-5;
    path[n++] = p;
    psi += f->step_mm / fmax(fmin(speed, 4 * f->overall_mm), 0.2 * f->overall_mm);
  }
  return n;
}

static inline void odd_spoil(const odd_foil *f, fg_strip *strip) {
  uint64_t seed = f->seed ^ 0x5eed;
  for (size_t k = 0; k < strip->count; k++) {
    fg_station *s = &strip->stations[k];
    double u = random_uniform(&seed), share = (double)k / (double)strip->count;
    if (f->faults & ODD_NAN && u < 0.05)
      s->left = s->right = (fg_point){NAN, NAN}, s->weight = u < 0.01 ? 1 : 0;
    if (f->faults & ODD_HIDDEN && share > 0.4 && share < 0.55) s->weight = 0;
    if (f->faults & ODD_SPIKES && u > 0.99) s->right.x += 0.5 * u;
    if (f->faults & ODD_WIDE && u > 0.97) {
      fg_point swap = s->left;
      s->left = s->right;
      s->right = swap;
    }
    if (k && f->faults & ODD_DOUBLED && u > 0.5 && u < 0.6) strip->stations[k] = s[-1];
    if (k && f->faults & ODD_STILL && u > 0.6 && u < 0.7) s->s_mm = s[-1].s_mm;
  }
}

static inline void odd_strip(const odd_foil *f, const odd_scanner *scanner, fg_strip *strip) {
  static fg_point path[ODD_STATIONS + 64];
  size_t n = odd_path(f, path);
  uint64_t seed = f->seed;
  *strip = (fg_strip){.count = n,
                      .step_mm = f->step_mm,
                      .thickness_mm = 0.1,
                      .u_thickness_mm = 1e-5,
                      .blur_left_um = 7,
                      .blur_right_um = 7,
                      .contrast = 0.7,
                      .noise = 0.005,
                      .gamma = 1};
  strip->stations = calloc(n ? n : 1, sizeof *strip->stations);
  for (size_t k = 0; k < n; k++) {
    fg_station *s = &strip->stations[k];
    fg_point a = path[k ? k - 1 : 0], b = path[k + 1 < n ? k + 1 : k];
    double length = hypot(b.x - a.x, b.y - a.y), nx = 0, ny = 1;
    if (length > 0) nx = -(b.y - a.y) / length, ny = (b.x - a.x) / length;
    double mid = 1e-3 * f->noise_um * random_gaussian(&seed);
    double half = 0.05 + 1e-3 * f->noise_um * random_gaussian(&seed);
    s->normal = (fg_point){nx, ny};
    s->left = odd_through(scanner,
                          (fg_point){path[k].x + (mid - half) * nx, path[k].y + (mid - half) * ny});
    s->right = odd_through(
        scanner, (fg_point){path[k].x + (mid + half) * nx, path[k].y + (mid + half) * ny});
    s->s_mm = k ? s[-1].s_mm + hypot(path[k].x - path[k - 1].x, path[k].y - path[k - 1].y) : 0;
    s->u_left_um = s->u_right_um = (float)f->noise_um;
    s->weight = k > 0 && k + 1 < n ? 1 : 0;
  }
  odd_spoil(f, strip);
}

static inline void odd_edge(const odd_disc *d, const odd_scanner *scanner, fg_disc *disc) {
  uint64_t seed = d->seed;
  double far = d->faults & ODD_FAR ? 1e7 : 0;
  disc->station_count = d->stations;
  disc->stations = calloc(d->stations ? d->stations : 1, sizeof *disc->stations);
  for (size_t k = 0; k < d->stations; k++) {
    double angle = 6.283185307179586 * ((double)k + 0.5) / (double)d->stations;
    double r =
        d->radius_mm + 1e-3 * (d->noise_um * random_gaussian(&seed) + d->oval_um * cos(2 * angle));
    double u = random_uniform(&seed);
    fg_disc_point *p = &disc->stations[k];
    *p = (fg_disc_point){.at = odd_through(scanner, (fg_point){far + d->x_mm + r * cos(angle),
                                                               far + d->y_mm + r * sin(angle)}),
                         .u = 1e-3 * d->noise_um,
                         .split = NAN,
                         .u_split = NAN,
                         .used = !(d->faults & ODD_HIDDEN && angle > 1 && angle < 2.5)};
    if (d->faults & ODD_SPIKES && u > 0.97) p->at.x += u;
    if (k && d->faults & ODD_DOUBLED && u < 0.3) *p = p[-1];
  }
}

/* ---- measured ---- */

static inline void odd_add_foil(const odd_input *in, const odd_foil *f, const odd_scanner *scanner,
                                fg_measurement *m) {
  fg_context ctx = {0};
  fg_foil *foil = &m->foils[m->foil_count];
  odd_strip(f, scanner, &foil->strip);
  if (fg_foil_measure(&ctx, &in->design, 1, foil) != FG_OK) abort();
  foil->number = (int)++m->foil_count;
  if (f->faults & ODD_UNMEASURED) foil->flags |= FG_FOIL_NOT_MEASURED;
}

/* A disc without a fitted circle is left out, as the measurement leaves it out. */
static inline void odd_add_disc(const odd_disc *d, const odd_scanner *scanner, fg_measurement *m) {
  fg_context ctx = {0};
  fg_disc *disc = &m->discs[m->disc_count];
  *disc = (fg_disc){.blur_um = 7, .level_u_mm = 1e-5};
  odd_edge(d, scanner, disc);
  if (fg_disc_measure_again(&ctx, disc) != FG_OK) {
    fg_disc_free(disc);
    return;
  }
  disc->number = (int)++m->disc_count;
}

/* A measurement of each scan; free each with fg_measurement_free. */
static inline void odd_measure(const odd_input *in, fg_measurement *measurements) {
  for (size_t i = 0; i < in->scans; i++) {
    const odd_scan *scan = &in->scan[i];
    fg_measurement *m = &measurements[i];
    *m = (fg_measurement){.file = {.width_px = 9000,
                                   .height_px = 9000,
                                   .bit_depth = 8,
                                   .dpi_file = {4800, 4800},
                                   .format = "PNG"},
                          .dpi = {4800, 4800},
                          .design = in->design};
    fg_context ctx = {0};
    if (in->design.kind != FG_FOIL_DISCS) (void)fg_design_derive(&ctx, &in->design, &m->nominal);
    snprintf(m->scan, sizeof m->scan, "odd %zu", i + 1);
    snprintf(m->sha256, sizeof m->sha256, "%064zx", i + 1);
    m->foils = calloc(ODD_FOILS, sizeof *m->foils);
    m->discs = calloc(ODD_DISCS, sizeof *m->discs);
    for (size_t f = 0; f < scan->foils; f++)
      odd_add_foil(in, &scan->foil[f], &scan->scanner, m);
    for (size_t d = 0; d < scan->discs; d++)
      odd_add_disc(&scan->disc[d], &scan->scanner, m);
  }
}

/* ---- from bytes ---- */

typedef struct odd_bytes {
  const uint8_t *data;
  size_t size, at;
} odd_bytes;

static inline unsigned odd_byte(odd_bytes *b) {
  return b->at < b->size ? b->data[b->at++] : 0;
}

static inline double odd_between(odd_bytes *b, double low, double high) {
  return low + (high - low) * odd_byte(b) / 255.0;
}

static inline odd_scanner odd_read_scanner(odd_bytes *b) {
  odd_scanner s = {0};
  unsigned what = odd_byte(b);
  if (what & 1) s.scale = odd_between(b, -0.006, 0.006);
  if (what & 2) s.shear = odd_between(b, -0.006, 0.006);
  if (what & 4) s.ripple_um = odd_between(b, 0, 40), s.period_mm = odd_between(b, 0.3, 20);
  if (what & 8) s.step_um = odd_between(b, -80, 80), s.step_mm = odd_between(b, 0, 45);
  if (what & 16) s.bend_um = odd_between(b, -40, 40);
  if (what & 32) s.scale *= 1e3;
  return s;
}

static inline odd_foil odd_read_foil(odd_bytes *b) {
  odd_foil f = odd_plain_foil(0);
  unsigned what = odd_byte(b);
  f.bumps = 1 + (int)(odd_byte(b) % (what & 1 ? 10 : 3));
  f.seed = odd_byte(b);
  f.faults = what & 2 ? odd_byte(b) : 0;
  f.step_mm = what & 4 ? odd_between(b, 0.01, 0.2) : 0.05;
  f.turn_deg = odd_between(b, -180, 180);
  if (what & 8) f.overall_mm = odd_between(b, 3, 60), f.radius_mm = odd_between(b, 0.3, 9);
  if (what & 16) f.missing = (int)odd_byte(b), f.spread = odd_between(b, -0.4, 0.4);
  if (what & 32) f.pitch_deg = odd_between(b, 3, 40), f.chord = odd_between(b, 0.05, 1);
  if (what & 64) f.noise_um = odd_between(b, 0, 20), f.oval_um = odd_between(b, -50, 50);
  if (what & 128) f.x_mm = odd_between(b, -50, 100), f.lip = false;
  return f;
}

static inline odd_disc odd_read_disc(odd_bytes *b) {
  unsigned what = odd_byte(b);
  odd_disc d = {.seed = what, .noise_um = 0.3, .stations = 32};
  d.x_mm = odd_between(b, 2, 40);
  d.y_mm = what & 1 ? 20 : odd_between(b, 2, 40);
  d.radius_mm = what & 2 ? 1 : odd_between(b, 0.1, 8);
  if (what & 4) d.stations = 8 + odd_byte(b);
  if (what & 8) d.noise_um = odd_between(b, 0, 30), d.oval_um = odd_between(b, -30, 30);
  if (what & 16) d.faults = odd_byte(b);
  return d;
}

/* Foils, discs, or both on one scan; up to ODD_SCANS of them. */
static inline void odd_read(const uint8_t *data, size_t size, odd_input *in) {
  odd_bytes b = {data, size, 0};
  unsigned what = odd_byte(&b);
  memset(in, 0, sizeof *in);
  fg_design_default(&in->design);
  in->scans = 1 + (what & 1) + (what & 1 && what & 2);
  in->same_foil = what & 4;
  if (what & 8) in->design.kind = FG_FOIL_SINUSOIDAL;
  if (what & 16) (void)fg_design_become(NULL, FG_FOIL_DISCS, &in->design);
  for (size_t i = 0; in->design.kind == FG_FOIL_DISCS && what & 64 && i < 4; i++)
    in->design.discs.diameters_mm[in->design.discs.count++] = odd_between(&b, 0.2, 16);
  for (size_t i = 0; i < in->scans; i++) {
    odd_scan *scan = &in->scan[i];
    unsigned count = odd_byte(&b);
    bool discs = in->design.kind == FG_FOIL_DISCS || what & 32;
    scan->hold_out = i > 0 && what & 128;
    scan->scanner = odd_read_scanner(&b);
    scan->foils = in->design.kind == FG_FOIL_DISCS ? 0 : 1 + (count & 3) % ODD_FOILS;
    scan->discs = discs ? 1 + (count >> 2) % (count & 1 ? 10 : 4) : 0;
    for (size_t f = 0; f < scan->foils; f++)
      scan->foil[f] = odd_read_foil(&b);
    for (size_t d = 0; d < scan->discs; d++)
      scan->disc[d] = odd_read_disc(&b);
  }
}

#endif
