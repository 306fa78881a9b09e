/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/sampler.h"

#include <math.h>

static const double phi_limit = 5;  /* 1 - Phi(5) = 3e-7 */
static const double band_reach = 6; /* in decay lengths */
static const double pi = 3.14159265358979323846;

static fg_side_band make_band(double amplitude, double direction_deg, double length_mm,
                              double gap_mm) {
  double direction = direction_deg * pi / 180;
  return (fg_side_band){.amplitude = amplitude,
                        .x = cos(direction),
                        .y = sin(direction),
                        .length_mm = length_mm,
                        .gap_mm = gap_mm};
}

/* Adds the bands. A shadow's amplitude is light, which is negative coverage where the scan is dark
 * on light. */
static void add_bands(fg_sampler *sampler) {
  const fg_scanner *scanner = &sampler->spec->scanner;
  const fg_shadow *shadow = &scanner->shadow;
  double pixel = fmin(sampler->pixel_mm[0], sampler->pixel_mm[1]);
  if (scanner->wall_amplitude != 0)
    sampler->bands[sampler->band_count++] =
        make_band(scanner->wall_amplitude, scanner->wall_direction_deg,
                  scanner->wall_length_px * pixel, scanner->wall_gap_px * pixel);
  if (shadow->amplitude == 0) return;
  fg_side_band *band = &sampler->bands[sampler->band_count++];
  *band = make_band(scanner->contrast > 0 ? shadow->amplitude : -shadow->amplitude,
                    shadow->direction_deg, shadow->length_px * pixel, shadow->gap_px * pixel);
  band->width_rad = shadow->width_deg * pi / 180;
  band->of_discs = true;
  sampler->disc_band_mm = band_reach * band->length_mm + band->gap_mm;
}

void fg_sampler_init(const fg_render_spec *spec, fg_sampler *sampler) {
  const fg_scanner *scanner = &spec->scanner;
  *sampler = (fg_sampler){.spec = spec, .side_mm = {NAN, NAN}};
  double pixel = fmin(spec->sensor.pixel_mm[0], spec->sensor.pixel_mm[1]);
  for (int axis = 0; axis < 2; axis++)
    sampler->pixel_mm[axis] = spec->sensor.pixel_mm[axis];
  sampler->sd_mm = 0.3 * fmax(spec->sensor.pixel_mm[0], spec->sensor.pixel_mm[1]);
  sampler->has_field = fg_render_effects_have(&spec->effects, FG_RENDER_EFFECT_SCANNER) ||
                       fg_render_effects_have(&spec->effects, FG_RENDER_EFFECT_STEP) ||
                       spec->effects.jumps.count > 0;
  sampler->has_part = fg_render_effects_have(&spec->effects, FG_RENDER_EFFECT_PART);
  sampler->has_normal = fg_render_effects_have(&spec->effects, FG_RENDER_EFFECT_NORMAL);
  sampler->has_width = fg_render_effects_have(&spec->effects, FG_RENDER_EFFECT_WIDTH);
  sampler->has_bump = fg_render_effects_have(&spec->effects, FG_RENDER_EFFECT_BUMP) ||
                      fg_render_effects_have(&spec->effects, FG_RENDER_EFFECT_LIFT);
  sampler->has_edge = fg_render_effects_have(&spec->effects, FG_RENDER_EFFECT_EDGE);
  sampler->one_sided_mm = scanner->one_sided_blur_px * pixel;
  add_bands(sampler);
  double line_px = fg_colour_lines_reach_px(&scanner->colour, (double)spec->sensor.width_px);
  double reach = phi_limit * hypot(sampler->sd_mm, sampler->one_sided_mm);
  reach += 5e-3 * hypot(scanner->edge_roughness_um, scanner->edge_common_um);
  reach += fg_render_effects_reach(&spec->effects);
  reach += line_px * fmax(spec->sensor.pixel_mm[0], spec->sensor.pixel_mm[1]);
  sampler->edge_reach_mm = reach;
  double beside = 0;
  for (int i = 0; i < sampler->band_count; i++)
    beside = fmax(beside, band_reach * sampler->bands[i].length_mm + sampler->bands[i].gap_mm);
  sampler->reach_mm = reach + beside;
  for (int i = 0; i < FG_PHI_STEPS + 2; i++) {
    double u = phi_limit * (2.0 * i / FG_PHI_STEPS - 1);
    sampler->phi[i] = (float)(0.5 * erfc(-u / sqrt(2.0)));
  }
}

void fg_sampler_use_line(fg_sampler *sampler, int line) {
  const fg_colour_line *from = &sampler->spec->scanner.colour.line[line];
  sampler->has_line = true;
  for (int axis = 0; axis < 2; axis++)
    sampler->line_shift_mm[axis] = from->shift_px[axis] * sampler->pixel_mm[axis];
  sampler->line_scale = 1 / (1 + 1e-6 * from->magnification_ppm);
  sampler->line_middle_mm =
      0.5 * (double)(sampler->spec->sensor.width_px - 1) * sampler->pixel_mm[0];
  sampler->lag_mm = from->gap_px * sampler->pixel_mm[1];
}

/* Normal distribution function, linear between 2048 values: within 3e-6. */
static double phi(const fg_sampler *sampler, double u) {
  double place = (u + phi_limit) * (FG_PHI_STEPS / (2 * phi_limit));
  if (!(place > 0)) return 0;
  if (place >= FG_PHI_STEPS) return 1;
  int i = (int)place;
  double low = (double)sampler->phi[i], high = (double)sampler->phi[i + 1];
  return low + (place - i) * (high - low);
}

/* The cross-section of a place. */
typedef struct cross_section {
  const fg_segment *segment;
  double n;      /* distance from the midline, towards the inner side */
  double nx, ny; /* direction of n */
  double dx, dy; /* from the segment's centre or start */
  double bend;   /* side / r: curvature of the line of equal distance here */
} cross_section;

static void try_segment(const fg_segment *segment, double x, double y, cross_section *best) {
  const double slack = 1e-9; /* mm: no place falls between two segments */
  double dx = x - segment->x, dy = y - segment->y;
  if (segment->line) {
    double t = dx * segment->ax + dy * segment->ay;
    if ((t < -slack && !segment->open_start) ||
        (t > segment->length_mm + slack && !segment->open_end))
      return;
    double n = dx * segment->bx + dy * segment->by;
    if (best->segment && fabs(n) >= fabs(best->n)) return;
    *best = (cross_section){segment, n, segment->bx, segment->by, dx, dy, 0};
    return;
  }
  double forward = segment->sweep > 0 ? 1 : -1;
  if (forward * (segment->ax * dy - segment->ay * dx) < -slack && !segment->open_start) return;
  if (forward * (dx * segment->by - dy * segment->bx) < -slack && !segment->open_end) return;
  double r = sqrt(dx * dx + dy * dy);
  double n = segment->side * (r - segment->radius);
  if (best->segment && fabs(n) >= fabs(best->n)) return;
  double scale = r > 0 ? segment->side / r : 0;
  *best = (cross_section){segment, n, dx * scale, dy * scale, dx, dy, scale};
}

/* Shift of an edge of curvature k by a Gaussian of sd s: its profile moves by k s² / 2 towards the
 * centre of curvature (diffusion moves a level line with half its curvature). */
static double bend_shift(double bend, double sd) {
  double shift = 0.5 * bend * sd * sd;
  return fmax(-0.5 * sd, fmin(0.5 * sd, shift));
}

/* Arc length from the segment's start. */
static double arc_length_of(const cross_section *at) {
  const fg_segment *segment = at->segment;
  if (segment->line) return at->dx * segment->ax + at->dy * segment->ay;
  double turned = atan2(segment->mx * at->dy - segment->my * at->dx,
                        segment->mx * at->dx + segment->my * at->dy);
  return segment->length_mm * (0.5 + turned / segment->sweep);
}

static double roughness_of(const fg_drawn_foil *drawn, int edge, double s_mm) {
  double place = s_mm / drawn->roughness_step_mm + 1;
  double last = (double)drawn->roughness_count - 3;
  place = place < 1 ? 1 : place > last ? last : place;
  return fg_roughness_at(drawn->roughness[edge], place);
}

/* Roughness of a disc. Its values have one before the first and three after the last, of the circle
 * that closes. */
static double disc_roughness(const fg_shape *shape, double dx, double dy) {
  double turn = atan2(dy, dx) / (2 * pi);
  return fg_roughness_at(shape->roughness,
                         1 + (turn - floor(turn)) * (double)shape->roughness_count);
}

/* Blur of an edge: bright-to-dark edges, along the carriage's direction, are blurred more. (mx, my)
 * points out of the bright or dark thing; `bright` is +1 when the thing is brighter than its
 * surroundings. */
static double edge_sd(const fg_sampler *sampler, double sd, double my, double bright) {
  my *= sampler->spec->scanner.one_sided_way;
  if (sampler->one_sided_mm <= 0 || my * bright <= 0) return sd;
  double extra = sampler->one_sided_mm * my;
  return sqrt(sd * sd + extra * extra);
}

/* Share of a band's amplitude beside an edge that faces (nx, ny). */
static double band_share(const fg_side_band *band, double nx, double ny) {
  double facing = nx * band->x + ny * band->y;
  if (band->width_rad <= 0) return fmax(0, facing);
  double turn = acos(fmax(-1, fmin(1, facing)));
  return turn < band->width_rad ? 0.5 * (1 + cos(pi * turn / band->width_rad)) : 0;
}

/* Value of a band at a distance from an edge that faces (nx, ny). */
static double band_value(const fg_side_band *band, double nx, double ny, double distance) {
  double share = band_share(band, nx, ny);
  if (share <= 0) return 0;
  double strength = band->amplitude * share, past = distance - band->gap_mm;
  if (past >= 0) return strength * exp(-past / band->length_mm);
  if (band->gap_mm <= 0) return strength;
  double u = 2 * past / band->gap_mm; /* within the gap it fades towards the edge */
  return strength * exp(-0.5 * u * u);
}

/* Sum of the bands beside a strip, on the side of the place. */
static double side_bands(const fg_sampler *sampler, const cross_section *at, double inner,
                         double outer) {
  bool inside = at->n > 0.5 * (inner + outer);
  double way = inside ? 1 : -1, distance = inside ? at->n - inner : outer - at->n, sum = 0;
  for (int i = 0; i < sampler->band_count; i++)
    sum += band_value(&sampler->bands[i], way * at->nx, way * at->ny, distance);
  return sum;
}

/* Sum of the shapes of one target where the cross-section meets the midline. */
static double shape_at(const fg_sampler *sampler, const fg_drawn_foil *drawn,
                       const cross_section *at, fg_render_effect_target of) {
  double x = at->segment->x + at->dx - at->n * at->nx;
  double y = at->segment->y + at->dy - at->n * at->ny;
  return fg_render_effects_shape(&sampler->spec->effects, of, fg_foil_psi(drawn, x, y),
                                 drawn->half_span_rad);
}

static double half_thickness(const fg_sampler *sampler, const fg_drawn_foil *drawn,
                             const cross_section *at) {
  if (!sampler->has_width) return drawn->half_thickness_mm;
  return drawn->half_thickness_mm + shape_at(sampler, drawn, at, FG_RENDER_EFFECT_WIDTH);
}

/* Value beyond the reach of the edges: a band or 0. */
static double far_value(const fg_sampler *sampler, const fg_drawn_foil *drawn,
                        const cross_section *at, double sd) {
  const fg_segment *segment = at->segment;
  if (!sampler->band_count) return 0;
  double half = half_thickness(sampler, drawn, at), value = side_bands(sampler, at, half, -half);
  if (value == 0 || !(segment->open_start || segment->open_end)) return value;
  double t = arc_length_of(at);
  if (segment->open_start) value *= phi(sampler, t / sd);
  if (segment->open_end) value *= phi(sampler, (segment->length_mm - t) / sd);
  return value;
}

/* Outward shift of an arc's cut at the crossing of a line at n. */
static double cut_shift(const fg_drawn_foil *drawn, int end, double n) {
  if (!drawn->cut[end]) return 0;
  double place = (n + drawn->half_thickness_mm) / drawn->roughness_step_mm + 1;
  double last = (double)drawn->cut_count - 3;
  return fg_roughness_at(drawn->cut[end], place < 1 ? 1 : place > last ? last : place);
}

static double strip_value(const fg_sampler *sampler, const fg_drawn_foil *drawn,
                          const cross_section *at, double sd) {
  const fg_segment *segment = at->segment;
  double inner = half_thickness(sampler, drawn, at), outer = -inner;
  double t = 0;
  bool ends = segment->open_start || segment->open_end;
  bool bump = sampler->has_bump && (segment->bump || segment->joins);
  if (ends || drawn->roughness[0] || bump) t = arc_length_of(at);
  if (bump) {
    double shift = fg_segment_bump_shift(&sampler->spec->effects, segment, t);
    inner += shift;
    outer += shift;
  }
  if (sampler->has_normal) {
    double shift = shape_at(sampler, drawn, at, FG_RENDER_EFFECT_NORMAL);
    inner -= shift;
    outer -= shift;
  }
  if (sampler->has_edge) {
    double shift[2];
    fg_render_effects_edges(&sampler->spec->effects, at->nx, at->ny, shift);
    inner += shift[0];
    outer += shift[1];
  }
  if (drawn->roughness[0]) {
    inner += roughness_of(drawn, 0, segment->s_mm + t);
    outer += roughness_of(drawn, 1, segment->s_mm + t);
  }
  double bright = sampler->spec->scanner.contrast > 0 ? 1 : -1;
  double inner_sd = edge_sd(sampler, sd, at->ny, bright);
  double outer_sd = edge_sd(sampler, sd, -at->ny, bright);
  double n = at->n + bend_shift(at->bend, sd);
  double value = phi(sampler, (n - outer) / outer_sd) - phi(sampler, (n - inner) / inner_sd);
  if (sampler->band_count) value += (1 - value) * side_bands(sampler, at, inner, outer);
  if (segment->open_start) value *= phi(sampler, (t + cut_shift(drawn, 0, at->n)) / sd);
  if (segment->open_end)
    value *= phi(sampler, (segment->length_mm - t + cut_shift(drawn, 1, at->n)) / sd);
  return value;
}

bool fg_sheet_inside(const fg_scene *scene, const fg_drawn_foil *drawn, double x_mm, double y_mm) {
  cross_section best = {0};
  for (size_t i = 0; i < drawn->segment_count; i++)
    try_segment(&scene->segments[drawn->first_segment + i], x_mm, y_mm, &best);
  return best.segment && best.n > 0;
}

/* Outward shift of a sheet's edge by scatter and effects. */
static double sheet_shift(const fg_sampler *sampler, const fg_drawn_foil *drawn,
                          const cross_section *at) {
  double shift[2] = {0};
  if (sampler->has_edge) fg_render_effects_edges(&sampler->spec->effects, -at->nx, -at->ny, shift);
  if (drawn->roughness[0])
    shift[0] += roughness_of(drawn, 0, at->segment->s_mm + arc_length_of(at));
  return shift[0];
}

/* The strongest of the bands beside edges that face this place: a band continues where another edge
 * is nearer. */
static double sheet_bands(const fg_sampler *sampler, const size_t *ids, size_t count, double x,
                          double y) {
  double strongest = 0;
  for (size_t i = 0; i < count; i++) {
    cross_section at = {0};
    try_segment(&sampler->spec->scene.segments[ids[i]], x, y, &at);
    if (!at.segment || at.n > 0) continue;
    double value = side_bands(sampler, &at, INFINITY, 0);
    if (fabs(value) > fabs(strongest)) strongest = value;
  }
  return strongest;
}

static double sheet_value(const fg_sampler *sampler, const size_t *ids, size_t count, double x,
                          double y, double sd) {
  const fg_scene *scene = &sampler->spec->scene;
  const fg_drawn_foil *drawn = &scene->drawn[scene->segments[ids[0]].foil];
  cross_section best = {0};
  for (size_t i = 0; i < count; i++)
    try_segment(&scene->segments[ids[i]], x, y, &best);
  if (!best.segment) return fg_sheet_inside(scene, drawn, x, y) ? 1 : 0;
  double limit = sampler->edge_reach_mm + phi_limit * (sd - sampler->sd_mm), value = 0;
  if (best.n > limit) return 1;
  if (best.n > -limit) {
    double bright = sampler->spec->scanner.contrast > 0 ? 1 : -1;
    double n = best.n + bend_shift(best.bend, sd) + sheet_shift(sampler, drawn, &best);
    value = phi(sampler, n / edge_sd(sampler, sd, -best.ny, bright));
  }
  if (!sampler->band_count || best.n > 0) return value;
  return value + (1 - value) * sheet_bands(sampler, ids, count, x, y);
}

static double foil_value(const fg_sampler *sampler, const size_t *ids, size_t count, double x,
                         double y, double sd) {
  const fg_scene *scene = &sampler->spec->scene;
  const fg_drawn_foil *drawn = &scene->drawn[scene->segments[ids[0]].foil];
  if (drawn->sheet) return sheet_value(sampler, ids, count, x, y, sd);
  if (sampler->has_part) {
    /* The shape moves radially, so a place belongs to the part that is radially below it. */
    double dx = x - drawn->x, dy = y - drawn->y, distance = hypot(dx, dy);
    double shift = fg_render_effects_shape(&sampler->spec->effects, FG_RENDER_EFFECT_PART,
                                           fg_foil_psi(drawn, x, y), drawn->half_span_rad);
    x -= shift * dx / distance;
    y -= shift * dy / distance;
  }
  cross_section best = {0};
  for (size_t i = 0; i < count; i++)
    try_segment(&scene->segments[ids[i]], x, y, &best);
  if (!best.segment) return 0;
  double limit =
      sampler->edge_reach_mm + drawn->half_thickness_mm + phi_limit * (sd - sampler->sd_mm);
  if (fabs(best.n) > limit) return far_value(sampler, drawn, &best, sd);
  return strip_value(sampler, drawn, &best, sd);
}

/* Bands beside a disc's edge, or within a hole; `out` is the vector from its centre, `edge` the
 * distance from its edge, `cover` its coverage here. */
static double disc_bands(const fg_sampler *sampler, const fg_shape *shape, const double out[2],
                         double edge, double cover, double value) {
  bool hole = shape->value < 0.5;
  double way = hole ? -1 : 1, sum = 0;
  for (int i = 0; i < sampler->band_count; i++)
    if (sampler->bands[i].of_discs)
      sum += band_value(&sampler->bands[i], way * out[0], way * out[1], way * edge);
  return value + (hole ? cover : 1 - value) * sum;
}

/* Share of a square; squares that meet in a corner add up. */
static double square_value(const fg_sampler *sampler, const fg_shape *shape, double x, double y,
                           double sd, double below) {
  double cover = 1;
  for (int k = 0; k < 2; k++) {
    double across = (x - shape->x0) * shape->normal[k].x + (y - shape->y0) * shape->normal[k].y;
    cover *= phi(sampler, (shape->half_mm[k] - across) / sd) +
             phi(sampler, (shape->half_mm[k] + across) / sd) - 1;
  }
  return below + shape->value * cover;
}

static double shape_value(const fg_sampler *sampler, const fg_shape *shape, double x, double y,
                          double sd, double below) {
  if (shape->half_mm[0] > 0) return square_value(sampler, shape, x, y, sd, below);
  double lx = shape->x1 - shape->x0, ly = shape->y1 - shape->y0, length2 = lx * lx + ly * ly;
  double dx = x - shape->x0, dy = y - shape->y0;
  if (length2 > 0) {
    double t = fmin(1, fmax(0, (dx * lx + dy * ly) / length2));
    dx -= t * lx;
    dy -= t * ly;
  }
  double r = sqrt(dx * dx + dy * dy);
  double edge = r - shape->radius;
  if (r > 0) edge += bend_shift(length2 > 0 ? 0 : 1 / r, sd);
  if (shape->lobes &&
      fabs(edge) < fabs(shape->lobe_mm) + phi_limit * hypot(sd, sampler->one_sided_mm))
    edge -= shape->lobe_mm * cos(shape->lobes * (atan2(dy, dx) - shape->lobe_phase_rad));
  if (shape->roughness && fabs(edge) < sampler->edge_reach_mm + phi_limit * sd)
    edge -= disc_roughness(shape, dx, dy);
  if (!shape->adds && r > 0 && sampler->has_edge) {
    /* A hole's edge faces inwards: its normal and its shift are reversed. */
    double out = shape->value > 0.5 ? 1 : -1, shift[2];
    fg_render_effects_edges(&sampler->spec->effects, out * dx / r, out * dy / r, shift);
    edge -= out * shift[0];
  }
  if (!shape->adds && r > 0) {
    double bright = sampler->spec->scanner.contrast * (shape->value - 0.5) > 0 ? 1 : -1;
    sd = edge_sd(sampler, sd, dy / r, bright);
  }
  double cover = phi(sampler, -edge / sd);
  if (shape->adds) return below + shape->value * cover;
  double value = below + (shape->value - below) * cover;
  if (sampler->disc_band_mm <= 0 || r <= 0) return value;
  return disc_bands(sampler, shape, (double[]){dx / r, dy / r}, edge, cover, value);
}

double fg_sample(const fg_sampler *sampler, const fg_near *near, double x_mm, double y_mm,
                 double sd_mm) {
  const fg_scene *scene = &sampler->spec->scene;
  double x = x_mm, y = y_mm;
  if (sampler->has_line) {
    double middle = sampler->line_middle_mm;
    x = middle + (x - sampler->line_shift_mm[0] - middle) * sampler->line_scale;
    y -= sampler->line_shift_mm[1];
  }
  if (sampler->has_field) {
    double d[2], lag = sampler->lag_mm;
    const double side[2] = {isnan(sampler->side_mm[0]) ? x_mm : sampler->side_mm[0],
                            (isnan(sampler->side_mm[1]) ? y_mm : sampler->side_mm[1]) + lag};
    fg_render_effects_field(&sampler->spec->effects, x_mm, y_mm + lag, side, d);
    x += d[0];
    y += d[1];
  }
  double value = near->filled ? 1 : 0;
  size_t i = 0;
  while (i < near->count && near->ids[i] < scene->segment_count) {
    size_t first = i, foil = scene->segments[near->ids[i]].foil;
    while (i < near->count && near->ids[i] < scene->segment_count &&
           scene->segments[near->ids[i]].foil == foil)
      i++;
    value += (1 - value) * foil_value(sampler, near->ids + first, i - first, x, y, sd_mm);
  }
  for (; i < near->count; i++)
    value = shape_value(sampler, &scene->shapes[near->ids[i] - scene->segment_count], x, y, sd_mm,
                        value);
  return value;
}
