/* What the page of the loop on scans says in words. */
#include <math.h>
#include <string.h>

#include "core/text.h"
#include "loop/points_effects.h"
#include "report/scan_loop_parts.h"

typedef struct effect_words {
  const char *id, *words, *equation;
} effect_words;

static const effect_words table[] = {
    {"scan.scale_y", "a wrong scale along the carriage's way", "d_y = q y"},
    {"scan.shear", "a shear of the picture", "d_x = q y"},
    {"scan.carriage_ripple", "a ripple of the carriage", "d_y = a sin(2π y/p + φ)"},
    {"scan.row_step", "a step of the carriage (rows lost or doubled)", "d_y = a where y > y0"},
    {"scan.optical_quadratic", "a quadratic distortion of the optics", "d_x = a ((x − c)/18 mm)²"},
    {"scan.optical_cubic", "a cubic distortion of the optics", "d_x = a ((x − c)/18 mm)³"},
    {"scan.carriage_quadratic", "a carriage that becomes faster or slower",
     "d_y = a ((y − c)/18 mm)²"},
    {"part.ovality", "an oval foil", "a cos 2(ψ − ψ0)"},
    {"part.spiral", "a spiral foil", "a (ψ/ψ_end)³"},
    {"part.bump_crown", "bumps flatter or sharper at the crown than a circle",
     "even in the place in the arc, led by a P4"},
    {"part.bump_skew", "bumps that lean to one side", "odd in the place in the arc, led by a P3"},
    {"free.scan.x.dx", "a shift in x that varies over x", "a smooth curve, freely fitted"},
    {"free.scan.x.dy", "a shift in y that varies over x", "a smooth curve, freely fitted"},
    {"free.scan.y.dx", "a shift in x that varies over y", "a smooth curve, freely fitted"},
    {"free.scan.y.dy", "a shift in y that varies over y", "a smooth curve, freely fitted"},
    {"free.foil.s", "a deviation along the foil", "a smooth curve, freely fitted"},
    {"free.bump.phi", "a deviation of every bump from its circle", "a smooth curve, freely fitted"},
    {"free.edge.normal", "a shift that depends on the edge's direction",
     "a smooth curve, freely fitted"},
    {NULL, NULL, NULL},
};

static const effect_words *find(const char *id) {
  const effect_words *row = table;
  while (row->id && !fg_effect_same(row->id, id))
    row++;
  return row->id ? row : NULL;
}

void fg_scan_effect_words(const char *id, char *words, size_t size) {
  const effect_words *row = find(id);
  fg_text_clip(words, size, "%s", row ? row->words : fg_effect_name(id));
}

const char *fg_scan_effect_equation(const char *id) {
  const effect_words *row = find(id);
  return row ? row->equation : "";
}

bool fg_scan_effect_is_free(const fg_scan_effect *effect) {
  return !strncmp(effect->id, "free.", 5);
}

static bool holds(const fg_subset *subset, size_t member, const char *id) {
  for (size_t e = 0; e < subset->effect_count; e++)
    if ((subset->members[member].mask >> e & 1) && fg_effect_same(subset->effects[e].id, id))
      return true;
  return false;
}

bool fg_scan_effect_is_sure(const fg_subset *subset, const char *id) {
  for (size_t m = 0; m < subset->member_count; m++)
    if (!holds(subset, m, id)) return false;
  return true;
}

bool fg_scan_class_holds(const fg_subset *subset, const char *id) {
  for (size_t m = 0; m < subset->member_count; m++)
    if (holds(subset, m, id)) return true;
  return false;
}

void fg_scan_member_words(const fg_subset *subset, size_t member, bool common, char *words,
                          size_t size) {
  size_t used = 0;
  fg_text_clip(words, size, "%s", common ? "" : "nothing more");
  for (size_t e = 0; e < subset->effect_count && used + 1 < size; e++) {
    const char *id = subset->effects[e].id;
    char one[120];
    if (!(subset->members[member].mask >> e & 1) || fg_scan_effect_is_sure(subset, id) != common)
      continue;
    fg_scan_effect_words(id, one, sizeof one);
    fg_text_clip(words + used, size - used, "%s%s", used ? " together with " : "", one);
    used = strlen(words);
  }
}

/* Two forms of one effect are one explanation. */
size_t fg_scan_class(const fg_subset *subset, size_t members[FG_SUBSET_CLASS]) {
  size_t count = 0;
  char words[FG_SCAN_CLASS_WORDS], before[FG_SCAN_CLASS_WORDS];
  for (size_t m = 0; m < subset->member_count; m++) {
    bool known = false;
    fg_scan_member_words(subset, m, false, words, sizeof words);
    for (size_t k = 0; k < count && !known; k++) {
      fg_scan_member_words(subset, members[k], false, before, sizeof before);
      known = !strcmp(words, before);
    }
    if (!known) members[count++] = m;
  }
  return count;
}

size_t fg_scan_class_unlisted(const fg_subset *subset) {
  bool full = subset->member_count == FG_SUBSET_CLASS;
  return full && subset->member_total > FG_SUBSET_CLASS ? subset->member_total - FG_SUBSET_CLASS
                                                        : 0;
}

/* ---- parameters ---- */

fg_field_list fg_scan_page_fields(const fg_scan_loop *loop) {
  fg_field_list list = {.frame = loop->points.frame};
  for (size_t i = 0; i < loop->set.count && list.count < FG_FIELDS_MAX; i++) {
    const fg_field_row *row = fg_field_find(loop->set.effects[i].id);
    if (row) list.fields[list.count++] = fg_scan_field(&loop->set.effects[i], row);
  }
  return list;
}

/* Names of fg_field_parameter with their units for people; a ratio is told in ppm. */
static void put_unit(fg_scan_parameter *p) {
  static const struct {
    const char *name, *people, *unit;
    double factor;
  } units[] = {{"value", "q", "ppm", 1e6},  {"amplitude_um", "a", "µm", 1},
               {"period_mm", "p", "mm", 1}, {"phase_deg", "φ", "°", 1},
               {"y_mm", "y0", "mm", 1},     {"centre_mm", "c", "mm", 1}};
  for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
    if (strcmp(p->name, units[i].name) != 0) continue;
    p->name = units[i].people;
    p->unit = units[i].unit;
    p->value *= units[i].factor;
    p->u *= units[i].factor;
    return;
  }
}

/* Size of a part effect: its only coefficient, the one that leads, or a cosine's and a sine's. */
static bool part_parameter(const fg_scan_effect *effect, size_t i, fg_scan_parameter *p) {
  const double *c = effect->coefficient_um, *u = effect->u_coefficient_um;
  double degrees = 180 / M_PI, square = c[0] * c[0] + c[1] * c[1], a = sqrt(square);
  if (!fg_effect_same(effect->id, "part.ovality")) {
    *p = (fg_scan_parameter){"a", "µm", c[0], u[0]};
    return i == 0;
  }
  if (i == 0)
    *p = (fg_scan_parameter){"a", "µm", a,
                             a > 0 ? hypot(c[0] * u[0], c[1] * u[1]) / a : hypot(u[0], u[1])};
  else
    *p =
        (fg_scan_parameter){"ψ0", "°", 0.5 * atan2(c[1], c[0]) * degrees,
                            a > 0 ? 0.5 * hypot(c[1] * u[0], c[0] * u[1]) / square * degrees : NAN};
  return i < 2;
}

bool fg_scan_effect_parameter(const fg_scan_effect *effect, size_t i,
                              fg_scan_parameter *parameter) {
  if (fg_scan_effect_is_free(effect)) return false;
  const fg_field_row *row = fg_field_find(effect->id);
  if (!row) return part_parameter(effect, i, parameter);
  fg_field field = fg_scan_field(effect, row);
  *parameter = (fg_scan_parameter){"", "", 0, 0};
  if (!fg_field_parameter(&field, i, &parameter->name, &parameter->value, &parameter->u))
    return false;
  put_unit(parameter);
  return true;
}

void fg_scan_value_words(double value, double u, char *words, size_t size) {
  double expanded = FG_COVERAGE_FACTOR * u;
  if (!isfinite(value)) {
    fg_text_clip(words, size, "–");
  } else if (!(expanded > 0) || !isfinite(expanded)) {
    fg_text_clip(words, size, "%.5g", value);
  } else {
    int decimals = (int)fmin(9, fmax(0, 1 - floor(log10(expanded))));
    fg_text_clip(words, size, "%.*f ± %.*f", decimals, value, decimals, expanded);
  }
}

void fg_scan_length_words(double um, char *words, size_t size) {
  if (!isfinite(um))
    fg_text_clip(words, size, "–");
  else if (fabs(um) < 1e-3 && um != 0)
    fg_text_clip(words, size, "%.3g nm", 1000 * um);
  else
    fg_text_clip(words, size, "%.3g µm", um);
}

double fg_scan_nice_below(double most) {
  double power = pow(10, floor(log10(most))), share = most / power;
  return power * (share >= 5 ? 5 : share >= 2 ? 2 : 1);
}

/* ---- the sentence ---- */

static fg_status say_parameters(fg_context *ctx, const fg_scan_effect *effect, char **text) {
  fg_scan_parameter p;
  char value[64];
  for (size_t i = 0; fg_scan_effect_parameter(effect, i, &p); i++) {
    fg_scan_value_words(p.value, p.u, value, sizeof value);
    FG_TRY(fg_text_append(ctx, text, "%s%s = %s%s%s", i ? ", " : " (", p.name, value,
                          strcmp(p.unit, "°") ? " " : "", p.unit));
    if (!fg_scan_effect_parameter(effect, i + 1, &p)) FG_TRY(fg_text_append(ctx, text, ")"));
  }
  return FG_OK;
}

/* The effects that every explanation holds: listed ones, or free curves. */
static fg_status say_effects(fg_context *ctx, const fg_scan_loop *loop, bool free_curves,
                             char **text) {
  const char *before = !free_curves ? "Found: "
                       : *text      ? "; no listed effect explains "
                                    : "No listed effect explains ";
  bool first = true;
  for (size_t i = 0; i < loop->set.count; i++) {
    const fg_scan_effect *effect = &loop->set.effects[i];
    char words[120];
    if (fg_scan_effect_is_free(effect) != free_curves ||
        !fg_scan_effect_is_sure(&loop->subset, effect->id))
      continue;
    fg_scan_effect_words(effect->id, words, sizeof words);
    const char *between = free_curves ? ", nor " : "; ";
    FG_TRY(fg_text_append(ctx, text, "%s%s", first ? before : between, words));
    FG_TRY(say_parameters(ctx, effect, text));
    first = false;
  }
  return FG_OK;
}

/* What stands beside the common effects in each explanation. */
static fg_status say_class(fg_context *ctx, const fg_scan_loop *loop, char **text) {
  enum { NAMED = 3 };
  const fg_subset *subset = &loop->subset;
  size_t members[FG_SUBSET_CLASS], count = fg_scan_class(subset, members);
  size_t total = count + fg_scan_class_unlisted(subset);
  size_t named = total <= NAMED ? count : NAMED - 1;
  if (count < 2) return FG_OK;
  FG_TRY(fg_text_append(ctx, text, "%s",
                        *text ? "; beside it the data cannot tell which it is: "
                              : "Found, but the data cannot tell which it is: "));
  for (size_t m = 0; m < named; m++) {
    char words[FG_SCAN_CLASS_WORDS];
    fg_scan_member_words(subset, members[m], false, words, sizeof words);
    FG_TRY(fg_text_append(ctx, text, "%s%s", m == 0 ? "" : m + 1 == total ? " or " : ", ", words));
  }
  if (total == named + 1) FG_TRY(fg_text_append(ctx, text, " or one other explanation"));
  if (total > named + 1)
    FG_TRY(fg_text_append(ctx, text, " or one of %zu other explanations", total - named));
  return FG_OK;
}

static fg_status say_errors(fg_context *ctx, const fg_scan_loop *loop, char **text) {
  char before[32], after[32], floor_words[32];
  fg_scan_length_words(loop->error_before.rms, before, sizeof before);
  fg_scan_length_words(loop->error_after.rms, after, sizeof after);
  fg_scan_length_words(loop->noise_floor_um, floor_words, sizeof floor_words);
  FG_TRY(fg_text_append(ctx, text,
                        " The edge residual %s from %s to %s rms; the noise alone makes %s.",
                        loop->error_after.rms <= loop->error_before.rms ? "falls" : "rises", before,
                        after, floor_words));
  if (!isfinite(loop->error_before.held_out_rms)) return FG_OK;
  fg_scan_length_words(loop->error_before.held_out_rms, before, sizeof before);
  fg_scan_length_words(loop->error_after.held_out_rms, after, sizeof after);
  return fg_text_append(ctx, text, " On scans kept aside it %s from %s to %s.",
                        loop->error_after.held_out_rms <= loop->error_before.held_out_rms ? "falls"
                                                                                          : "rises",
                        before, after);
}

static fg_status say_chance(fg_context *ctx, double p, char **text) {
  if (p < 1e-12) return fg_text_append(ctx, text, "Noise alone would do this with p < 10⁻¹².");
  return fg_text_append(ctx, text, "Noise alone would do this with p = %.2g.", p);
}

static fg_status say_clean(fg_context *ctx, const fg_scan_loop *loop, char **text) {
  char rms[32];
  fg_scan_length_words(loop->error_before.rms, rms, sizeof rms);
  return fg_text_print(ctx, text,
                       "Nothing is claimed: what the circles leave of the edges (%s rms) is noise "
                       "as far as %s can tell. The dimensions stand as measured.",
                       rms, loop->scan_count > 1 ? "these scans" : "this scan");
}

static fg_status say_edges(fg_context *ctx, const fg_scan_loop *loop, char **text) {
  char rms[32];
  fg_scan_length_words(loop->error_before.rms, rms, sizeof rms);
  return fg_text_print(ctx, text, "The edges lie on their circles within the noise (%s rms).", rms);
}

static fg_status say_points(fg_context *ctx, const fg_scan_loop *loop, char **text) {
  if (loop->verdict == FG_LOOP_CLEAN) return say_clean(ctx, loop, text);
  if (!loop->set.count) return say_edges(ctx, loop, text);
  FG_TRY(say_effects(ctx, loop, false, text));
  FG_TRY(say_effects(ctx, loop, true, text));
  if (loop->tied) FG_TRY(say_class(ctx, loop, text));
  FG_TRY(fg_text_append(ctx, text, ". "));
  FG_TRY(say_chance(ctx, loop->subset.p_value, text));
  return say_errors(ctx, loop, text);
}

fg_status fg_scan_loop_sentence(fg_context *ctx, const fg_scan_loop *loop, char **text) {
  *text = NULL;
  FG_TRY(say_points(ctx, loop, text));
  return fg_scan_bumps_sentence(ctx, &loop->bumps, text);
}
