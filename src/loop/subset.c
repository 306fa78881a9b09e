#include "loop/subset.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "loop/points_effects.h"
#include "loop/subset_search.h"

/* Sets this much worse than the best of their size are worse as far as data can show. */
#define WORSE 25.0
/* A set with a shape that is not fitted yet may leave this share of what there is. */
#define FITTING_SHARE 0.1
/* and this many times what a curve leaves */
#define FITTING_TIMES 30.0
/* Shapes nearer to each other than this are one. */
#define TWIN_SHARE 0.05
/* No coefficient is larger, um: columns that nearly cancel would explain anything. */
#define LARGEST_UM 400.0
/* A curve is known to this share of itself: no listed effect stands beside it for less. */
#define CURVE_SHARE 0.03
/* A curve with all its columns leaves less than this share of what a smoother one does. */
#define FINER 0.9
/* Effects that one curve does not stand for. */
enum { FEW = 2 };
/* Columns of a curve (points_effects.c) that are smooth; those of bump.phi that are polynomials. */
enum { PHI_SMOOTH = 8, PHI_ORDERS = 16, NORMAL_SMOOTH = 12 };

typedef struct listed_row {
  fg_subset_effect effect;
  const char *source; /* of its columns; NULL: its own */
  size_t pick[3];     /* which of them */
} listed_row;

static const listed_row smooth[] = {
    {{.id = "scan.scale_y", .columns = 1, .terms = 1}, FG_POWERS_Y, {0}},
    {{.id = "scan.shear", .columns = 1}, NULL, {0}},
    {{.id = "scan.optical_quadratic",
      .form = FG_SUBSET_QUADRATIC,
      .columns = 1,
      .shapes = 1,
      .terms = 2},
     FG_POWERS_X,
     {1, 0}},
    {{.id = "scan.optical_cubic", .form = FG_SUBSET_CUBIC, .columns = 1, .shapes = 1, .terms = 1},
     FG_POWERS_X,
     {2, 1, 0}},
    {{.id = "scan.carriage_quadratic",
      .form = FG_SUBSET_QUADRATIC,
      .columns = 1,
      .shapes = 1,
      .terms = 2},
     FG_POWERS_Y,
     {1, 0}},
    {{.id = "part.ovality"}, NULL, {0}},
    {{.id = "part.ovality:radial"}, NULL, {0}},
    {{.id = "part.spiral"}, NULL, {0}},
    {{.id = "part.spiral:radial"}, NULL, {0}},
    {{.id = "part.bump_crown"}, NULL, {0}},
    {{.id = "part.bump_skew"}, NULL, {0}},
    {{.id = "free.scan.x.dx", .free = true}, NULL, {0}},
    {{.id = "free.scan.x.dy", .free = true}, NULL, {0}},
    {{.id = "free.scan.y.dx", .free = true}, NULL, {0}},
    {{.id = "free.scan.y.dy", .free = true}, NULL, {0}},
    {{.id = "free.foil.s", .free = true}, NULL, {0}},
    {{.id = "free.foil.s:radial", .free = true}, NULL, {0}},
    {{.id = "free.bump.phi", .free = true}, NULL, {0}},
    {{.id = "free.edge.normal", .free = true}, NULL, {0}},
};

/* ---- effects and their columns ---- */

void fg_subset_add(fg_subset_search *s, const fg_subset_effect *effect) {
  fg_subset *out = s->out;
  size_t e = out->effect_count++, first;
  fg_subset_effect *to = &out->effects[e];
  *to = *effect;
  to->columns = to->terms =
      fg_subset_columns_add(&s->columns, effect->id, effect->shape, &first, &out->share[e]);
  for (size_t c = 0; c < to->columns; c++)
    to->column[c] = first + c;
}

/* Of the curves, what all effects at once have: half as many columns, and one form. */
static void choose_parts(fg_subset_columns *c, const fg_subset_effect *effect) {
  bool splines = fg_field_find(effect->id) || !strcmp(effect->id, "free.foil.s");
  for (size_t k = 0; k < effect->columns; k++) {
    bool rough = !strcmp(effect->id, "free.bump.phi") ? k >= PHI_SMOOTH && k < PHI_ORDERS
                 : splines                            ? k % 2 > 0
                                                      : k >= NORMAL_SMOOTH;
    if (strchr(effect->id, ':')) rough = true;
    c->part[effect->column[k]] = rough     ? FG_SUBSET_LEFT_OUT
                                 : splines ? FG_SUBSET_WITH_NEXT
                                           : FG_SUBSET_ITSELF;
  }
}

/* The powers are shared by the polynomials that are made of them. */
static void add_smooth(fg_subset_search *s) {
  const char *source = NULL;
  size_t first[2] = {0, 0};
  double share[2] = {0, 0}, none[FG_LOOP_SHAPES] = {0};
  for (int axis = 0; axis < 2; axis++)
    fg_subset_columns_add(&s->columns, axis ? FG_POWERS_Y : FG_POWERS_X, none, &first[axis],
                          &share[axis]);
  for (size_t i = 0; i < sizeof smooth / sizeof smooth[0]; i++) {
    source = smooth[i].source;
    if (smooth[i].effect.free && !s->free_column) s->free_column = s->columns.count;
    if (!source) {
      fg_subset_add(s, &smooth[i].effect);
      if (smooth[i].effect.free)
        choose_parts(&s->columns, &s->out->effects[s->out->effect_count - 1]);
      continue;
    }
    size_t e = s->out->effect_count++;
    int axis = !strcmp(source, FG_POWERS_Y);
    s->out->effects[e] = smooth[i].effect;
    for (int k = 0; k < 3; k++)
      s->out->effects[e].column[k] = first[axis] + smooth[i].pick[k];
    size_t lead = first[axis] + smooth[i].pick[0];
    s->out->share[e] = s->columns.gram[lead * FG_SUBSET_COLUMNS + lead] / (double)s->columns.rows;
  }
  s->free_end = s->columns.count;
}

double fg_subset_integral(const fg_subset_columns *s) {
  return fg_points_integral(s->points, s->row, s->rows, s->left);
}

static double noise_of(const fg_subset_columns *c, size_t rank) {
  double freedom = fmax((double)c->rows - (double)rank, 1);
  return sqrt(fg_subset_dot(c->rows, c->left, c->left) / freedom);
}

static void take_noise(fg_subset_search *s, size_t rank) {
  s->full = fg_subset_dot(s->columns.rows, s->columns.left, s->columns.left);
  s->freedom = rank - s->columns.geometry_rank;
  s->out->noise_um = noise_of(&s->columns, rank);
  s->out->integral = fg_subset_integral(&s->columns);
}

size_t fg_subset_noise(fg_subset_search *s, bool listed_only) {
  size_t end = listed_only ? s->free_end : s->free_column;
  size_t rank = fg_subset_columns_span(&s->columns, s->free_column, end);
  take_noise(s, rank);
  return rank;
}

/* A curve that is there is no noise: the one that leaves far less with all its columns has them. */
static void refine_noise(fg_subset_search *s) {
  const fg_subset_effect *best = NULL;
  size_t rank = fg_subset_noise(s, false);
  double least = FINER * s->out->noise_um;
  for (size_t e = 0; e < s->out->effect_count; e++) {
    const fg_subset_effect *curve = &s->out->effects[e];
    if (!curve->free) continue;
    size_t from = curve->column[0];
    size_t more = fg_subset_columns_span_more(&s->columns, rank, from, from + curve->columns);
    double noise = noise_of(&s->columns, more);
    if (noise >= least) continue;
    least = noise;
    best = curve;
  }
  if (!best) return;
  size_t from = best->column[0];
  take_noise(s, fg_subset_columns_span_more(&s->columns, rank, from, from + best->columns));
}

/* ---- all sets ---- */

size_t fg_subset_bits(unsigned mask) {
  size_t n = 0;
  for (; mask; mask &= mask - 1)
    n++;
  return n;
}

unsigned fg_subset_mask_of(const fg_subset *out, bool of_free) {
  unsigned mask = 0;
  for (size_t e = 0; e < out->effect_count; e++)
    if (out->effects[e].free == of_free) mask |= 1u << e;
  return mask;
}

/* Two forms of one effect, and two ripples of one period or two steps at one place, are no set. */
static bool are_twins(const fg_subset_effect *a, const fg_subset_effect *b) {
  if (!fg_effect_same(a->id, b->id)) return false;
  return strchr(b->id, ':') || fabs(a->shape[0] / b->shape[0] - 1) < TWIN_SHARE;
}

static bool has_twins(const fg_subset *out, unsigned mask) {
  for (size_t a = 0; a < out->effect_count; a++)
    for (size_t b = a + 1; (mask >> a & 1) && b < out->effect_count; b++)
      if ((mask >> b & 1) && are_twins(&out->effects[a], &out->effects[b])) return true;
  return false;
}

void fg_subset_keep_member(fg_subset *out, const fg_subset_member *member) {
  out->member_total++;
  size_t at = out->member_count < FG_SUBSET_CLASS ? out->member_count++ : FG_SUBSET_CLASS;
  if (at == FG_SUBSET_CLASS && member->excess >= out->members[FG_SUBSET_CLASS - 1].excess) return;
  if (at == FG_SUBSET_CLASS) at--;
  for (; at > 0 && out->members[at - 1].excess > member->excess; at--)
    out->members[at] = out->members[at - 1];
  out->members[at] = *member;
}

/* Schwarz's criterion. */
static double score_of(const fg_subset_search *s, const fg_subset_member *m) {
  return m->excess - log((double)s->columns.rows / s->out->integral) * m->freedom;
}

/* Ripples and steps, those in force and all. */
typedef struct shaped_masks {
  unsigned known, all;
} shaped_masks;

static shaped_masks find_shaped_masks(const fg_subset_search *s) {
  shaped_masks masks = {0, 0};
  size_t count = s->out->effect_count;
  for (size_t e = 0; e < count; e++) {
    const char *id = s->out->effects[e].id;
    if (strcmp(id, "scan.carriage_ripple") != 0 && strcmp(id, "scan.row_step") != 0) continue;
    masks.all |= 1u << e;
    if (e + s->new_shapes < count) masks.known |= 1u << e;
  }
  return masks;
}

/* Few smooth effects, which can stand for each other; ripples and steps stand alone, and all that
 * are there may be. */
static bool is_small(unsigned mask, shaped_masks shaped, size_t most) {
  unsigned held = mask & shaped.all, more = held & ~shaped.known;
  bool one_more = (held & shaped.known) == shaped.known && fg_subset_bits(more) <= 1;
  return fg_subset_bits(mask & ~shaped.all) <= most &&
         (fg_subset_bits(mask) <= most || one_more || held == shaped.all);
}

/* Listed sets by size; the first size with one that is right ends the search. Returns the best by
 * Schwarz's criterion of those that were tried. */
static fg_subset_member try_listed(fg_subset_search *s, const fg_subset_yardstick *y, size_t most) {
  fg_subset *out = s->out;
  unsigned listed = fg_subset_mask_of(out, false);
  shaped_masks shaped = find_shaped_masks(s);
  fg_subset_member best = {.excess = INFINITY};
  size_t largest = most + fg_subset_bits(shaped.all);
  if (largest > FG_SCAN_EFFECTS) largest = FG_SCAN_EFFECTS;
  for (size_t size = 0; size <= largest && !out->member_count; size++)
    for (unsigned mask = 0, first = 1; first || mask; first = 0, mask = (mask - listed) & listed) {
      if (fg_subset_bits(mask) != size || !is_small(mask, shaped, most) || has_twins(out, mask))
        continue;
      fg_subset_member member = fg_subset_try(s, y, mask);
      if (fg_subset_is_right(y, &member)) fg_subset_keep_member(out, &member);
      if (isfinite(member.excess) &&
          (!isfinite(best.excess) || score_of(s, &member) < score_of(s, &best)))
        best = member;
    }
  return best;
}

/* Members that are worse than the best as far as the data can show leave; the width of the strip
 * puts those that stay in order. Its noise is what the best of them leaves of it. */
static void order_members(fg_subset_search *s, const fg_subset_yardstick *y) {
  fg_subset *out = s->out;
  size_t kept = 0;
  double width = INFINITY;
  for (size_t m = 0; m < out->member_count; m++)
    if (out->members[m].excess <= out->members[0].excess + WORSE + y->allowance)
      out->members[kept++] = out->members[m];
  out->member_total -= out->member_count - kept;
  out->member_count = kept;
  for (size_t m = 0; m < kept; m++)
    width = fmin(width, out->members[m].width);
  for (size_t m = 0; m < kept; m++)
    out->members[m].width =
        width > 0 ? (out->members[m].width / width - 1) * (double)s->columns.rows : 0;
  for (size_t m = 1; m < kept; m++)
    for (size_t k = m; k > 0 && out->members[k].excess + out->members[k].width <
                                    out->members[k - 1].excess + out->members[k - 1].width;
         k--) {
      fg_subset_member swap = out->members[k];
      out->members[k] = out->members[k - 1];
      out->members[k - 1] = swap;
    }
}

/* The same for a set with a free curve, as far as a listed effect beside it goes. */
static double free_score(const fg_subset_search *s, const fg_subset_yardstick *y,
                         fg_subset_member m) {
  if (!isfinite(m.excess)) return INFINITY;
  m.excess = fmax(0, m.excess - CURVE_SHARE * CURVE_SHARE * y->none);
  return score_of(s, &m);
}

/* A free curve, alone or beside up to two listed effects: the one that leaves least for its
 * columns; the best listed set stands when none does better. */
static fg_subset_member try_free(fg_subset_search *s, const fg_subset_yardstick *y,
                                 fg_subset_member best) {
  fg_subset *out = s->out;
  unsigned listed = fg_subset_mask_of(out, false);
  double score = isfinite(best.excess) ? score_of(s, &best) : INFINITY;
  for (size_t size = 0; size <= 2; size++)
    for (unsigned mask = 0, first = 1; first || mask; first = 0, mask = (mask - listed) & listed) {
      if (fg_subset_bits(mask) != size || has_twins(out, mask)) continue;
      for (size_t e = 0; e < out->effect_count; e++) {
        if (!out->effects[e].free) continue;
        fg_subset_member member = fg_subset_try(s, y, mask | 1u << e);
        /* Every further effect must be worth its while. */
        double gained = score - score_of(s, &member);
        if (size) gained = fmin(gained, free_score(s, y, best) - free_score(s, y, member));
        if (!(gained > 10)) continue;
        score = score_of(s, &member);
        best = member;
      }
    }
  return best;
}

static bool scanned_again(const fg_points *points) {
  return points->view_count > points->part_count;
}

/* Two curves, alone or beside one listed effect: a carriage that runs unevenly also sways. One view
 * could not tell them. */
static fg_subset_member try_two_free(fg_subset_search *s, const fg_subset_yardstick *y,
                                     fg_subset_member best) {
  fg_subset *out = s->out;
  unsigned listed = fg_subset_mask_of(out, false), free = fg_subset_mask_of(out, true);
  if (!s->two_curves || fg_subset_is_right(y, &best)) return best;
  for (unsigned two = 0, first = 1; first || two; first = 0, two = (two - free) & free) {
    if (fg_subset_bits(two) != 2 || has_twins(out, two)) continue;
    for (size_t with = 0; with <= out->effect_count; with++) {
      unsigned mask = two | (with < out->effect_count ? 1u << with & listed : 0);
      if (with < out->effect_count && mask == two) continue;
      fg_subset_member member = fg_subset_try(s, y, mask);
      double gained = fmin(score_of(s, &best) - score_of(s, &member),
                           free_score(s, y, best) - free_score(s, y, member));
      if (gained > 10) best = member;
    }
  }
  return best;
}

static bool was_tried(const fg_subset_search *s, const fg_subset_member *m) {
  size_t count = 0;
  for (size_t e = 0; s->tried && e < s->out->effect_count; e++) {
    if (!(m->mask >> e & 1)) continue;
    if (count == s->tried->count || strcmp(s->tried->effects[count].id, s->out->effects[e].id))
      return false;
    count++;
  }
  return s->tried && count > 0 && count == s->tried->count;
}

/* A ripple or step that was found just now has not been fitted with the geometry yet: a set that
 * holds one and takes most of what there is to take gets its chance before any curve that is not
 * far better. */
static bool is_worth_fitting(const fg_subset_search *s, const fg_subset_yardstick *y,
                             const fg_subset_member *best, const fg_subset_member *curve) {
  size_t count = s->out->effect_count, first = count - s->new_shapes;
  bool one_curve =
      fg_subset_bits(curve->mask) == 1 && curve->excess < CURVE_SHARE * CURVE_SHARE * y->none;
  if (one_curve && fg_subset_bits(best->mask) > FEW) return false;
  return best->mask >> first && best->excess < FITTING_SHARE * y->none && !was_tried(s, best) &&
         best->excess < FITTING_TIMES * (curve->excess + y->freedom);
}

static void try_sets(fg_subset_search *s) {
  fg_subset *out = s->out;
  fg_subset_yardstick y = fg_subset_yardstick_of(s);
  fg_subset_member best = try_listed(s, &y, scanned_again(s->columns.points) ? 3 : 2);
  out->right = out->member_count > 0;
  if (out->right) order_members(s, &y);
  if (!out->member_count) {
    fg_subset_member curve = try_free(s, &y, best);
    bool hope = is_worth_fitting(s, &y, &best, &curve);
    if (!hope) curve = try_two_free(s, &y, curve);
    out->right = !hope && fg_subset_is_right(&y, &curve);
    fg_subset_keep_member(out, hope ? &best : &curve);
  }
  fg_subset_describe_effects(s, &y);
  fg_subset_describe_width(s, &y);
}

static void add_known(fg_subset_search *s, const fg_scan_set *known) {
  for (size_t e = 0; known && e < known->count; e++) {
    const fg_scan_effect *from = &known->effects[e];
    bool kept = !strcmp(from->id, "scan.carriage_ripple") || !strcmp(from->id, "scan.row_step");
    fg_subset_effect effect = {.id = from->id, .columns = from->columns, .shapes = from->shapes};
    memcpy(effect.shape, from->shape, sizeof effect.shape);
    if (kept && s->out->effect_count < FG_SUBSET_EFFECTS) fg_subset_add(s, &effect);
  }
}

fg_status fg_subset_find(fg_context *ctx, const fg_points *points, const fg_subset_request *request,
                         fg_subset *subset) {
  memset(subset, 0, sizeof *subset);
  fg_subset_search s = {.out = subset, .tried = request->tried, .two_curves = request->two_curves};
  fg_status status = FG_OK;
  FG_TRY(fg_subset_columns_open(ctx, points, request->residual_um, request->jacobian, &s.columns));
  add_smooth(&s);
  add_known(&s, request->known);
  FG_TRY_EXIT(fg_subset_add_other_steps(ctx, &s, request->known));
  FG_TRY_EXIT(fg_subset_width_doubt(ctx, &s.columns));
  if (request->look) FG_TRY_EXIT(fg_subset_find_shaped(ctx, &s));
  refine_noise(&s);
  try_sets(&s);
exit:
  fg_subset_columns_close(&s.columns);
  return status;
}
