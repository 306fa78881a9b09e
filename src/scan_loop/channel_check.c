/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan_loop/channel_check.h"

#include <math.h>
#include <string.h>

#include "core/small_solve.h"
#include "core/text.h"
#include "scan_loop/state.h"

/* P-value that decides either way. */
#define DECIDED_P 0.01
/* P-value for statements about a tie. */
#define CERTAIN_P 0.001
/* Less than this between the lines is none. */
#define CONSTANT_UM 1e-6
/* Minimum share of the variation that the effect's shape must explain to be confirmed. */
#define SHARE_MIN 0.5
/* Relative u of the prediction, because a claim's shape and the windows are approximate. */
#define SHAPE_U 0.1
/* Gaps that are tried where none is stated, rows to either side. */
#define GAP_MAX_PX  64.0
#define GAP_STEP_PX 0.5
/* Steps that a window's average is computed from. */
enum { WINDOW_STEPS = 9, LINES = 3 /* red, green, blue */ };

/* Error of the carriage by some effects, and by others that were found beside them. */
typedef struct carriage {
  fg_field_list fields, others;
  double x_mm, amplitude_um, u_amplitude_um;
} carriage;

/* Evidence of one profile on a prediction: weight and weighted estimate of its factor, and the
 * whole variation. */
typedef struct evidence {
  double weight, sum;      /* the factor is sum / weight, its u 1 / sqrt(weight) */
  double uneven, expected; /* chi-squared above the windows' number; mean square of it, um² */
  size_t profiles;
} evidence;

static double error_um(const carriage *c, const fg_field_list *fields, double y_mm) {
  return 1e3 * fg_field_at(fields, (fg_point){c->x_mm, y_mm}).y;
}

/* Returns the prediction of dy in one window. */
static double predict_shift(const carriage *c, const fg_field_list *fields,
                            const fg_colour_shift *shift, double y_mm, double gap_mm) {
  double sum = 0;
  for (int k = 0; k < WINDOW_STEPS; k++) {
    double y = y_mm + shift->window_mm * ((k + 0.5) / WINDOW_STEPS - 0.5);
    sum += error_um(c, fields, y) - error_um(c, fields, y + gap_mm);
  }
  return sum / WINDOW_STEPS;
}

/* Predictions of one profile, by window. */
typedef struct predictions {
  double asked[FG_COLOUR_WINDOWS_MAX], others[FG_COLOUR_WINDOWS_MAX];
} predictions;

/* Unknowns: factor, factor of the effects found beside it, constant, and errors common to all
 * windows (each with a prior standard deviation). */
enum { FACTOR, OTHERS, CONSTANT, SHARED, UNKNOWNS = SHARED + FG_COLOUR_SHARED };

static void fill_system(const fg_colour_shift *shift, const predictions *p, bool with_factor,
                        fg_normal_equations *system) {
  double row[UNKNOWNS];
  fg_normal_clear(system, UNKNOWNS);
  for (size_t i = 0; i < shift->window_count; i++) {
    const fg_colour_window *w = &shift->windows[i];
    row[FACTOR] = with_factor ? p->asked[i] : 0;
    row[OTHERS] = p->others[i];
    row[CONSTANT] = 1;
    for (int k = 0; k < FG_COLOUR_SHARED; k++)
      row[SHARED + k] = (double)w->shared_um[k];
    fg_normal_add(system, row, (double)w->dy_um, 1 / ((double)w->u_own_um * (double)w->u_own_um));
  }
  for (int k = 0; k < FG_COLOUR_SHARED; k++)
    system->matrix[SHARED + k][SHARED + k] += 1;
  for (int k = FACTOR; k <= OTHERS; k++) /* the factor of a zero prediction is 0 */
    if (system->matrix[k][k] == 0) system->matrix[k][k] = k == OTHERS || !with_factor;
}

/* Solves for the factor and its variance; `left` is the weighted residual sum. False: the profile
 * cannot separate the prediction from a constant. */
static bool solve_profile(const fg_colour_shift *shift, const predictions *p, bool with_factor,
                          double *left, double *factor, double *variance) {
  fg_normal_equations system;
  double x[UNKNOWNS], inverse[FG_SMALL_MAX][FG_SMALL_MAX];
  fill_system(shift, p, with_factor, &system);
  double raw = system.matrix[FACTOR][FACTOR];
  if (!(raw > 0) || !fg_normal_solve(&system, 0, x, inverse)) return false;
  *left = system.sum_squares;
  for (int k = 0; k < UNKNOWNS; k++)
    *left -= x[k] * system.right[k];
  *factor = x[FACTOR];
  *variance = inverse[FACTOR][FACTOR];
  return *variance > 0 && 1 / *variance > 1e-9 * raw;
}

/* Adds one profile. Where windows scatter more than their u implies, even beside the prediction,
 * the carriage has further errors, and the profile's weight is lowered. */
static void add_profile(const carriage *c, const fg_colour_shift *shift, double gap_mm,
                        evidence *to) {
  predictions p;
  double before, after, factor, variance, mean = 0, squares = 0;
  double count = (double)shift->window_count;
  for (size_t i = 0; i < shift->window_count; i++) {
    double y_mm = (double)shift->windows[i].y_mm;
    p.asked[i] = predict_shift(c, &c->fields, shift, y_mm, gap_mm);
    p.others[i] = predict_shift(c, &c->others, shift, y_mm, gap_mm);
    mean += p.asked[i] / count;
    squares += p.asked[i] * p.asked[i] / count;
  }
  to->profiles++;
  to->expected += fmax(0, squares - mean * mean);
  if (!solve_profile(shift, &p, false, &before, &factor, &variance)) return;
  bool told = solve_profile(shift, &p, true, &after, &factor, &variance);
  double scatter = fmax(1, (told ? after : before) / fmax(1, count - 2));
  to->uneven += fmax(0, before / scatter - (count - 1));
  if (!told) return;
  to->weight += 1 / variance / scatter;
  to->sum += factor / variance / scatter;
}

/* ---- all scans ---- */

static bool speaks(const fg_colour_shift *shift) {
  return shift->state == FG_COLOUR_MEASURED && shift->window_count > UNKNOWNS;
}

static bool any_speaks(const fg_scan_loop *loop) {
  for (size_t i = 0; i < loop->scan_count; i++)
    for (int k = 0; k < 2; k++)
      if (loop->before[i].colour_lines.seen && speaks(&loop->before[i].colour_lines.shifts[k]))
        return true;
  return false;
}

static double pixel_mm(const fg_scan_loop *loop) {
  return 25.4 / loop->before[0].dpi[1];
}

static int line_of(fg_channel channel) {
  return (int)channel - FG_CHANNEL_RED;
}

/* Collects the evidence of one line, or of all (-1). Profiles and gaps are relative to the measured
 * line, which also saw the carriage's error as found. */
static evidence collect_evidence(const fg_scan_loop *loop, const carriage *c, int line,
                                 const double gap_px[]) {
  evidence all = {0};
  for (size_t i = 0; i < loop->scan_count; i++)
    for (int k = 0; k < 2; k++) {
      const fg_colour_lines *lines = &loop->before[i].colour_lines;
      const fg_colour_shift *shift = &lines->shifts[k];
      int of = line_of(shift->channel);
      if (!lines->seen || !speaks(shift) || (line >= 0 && of != line)) continue;
      double ahead_px = gap_px[of] - gap_px[line_of(lines->against)];
      add_profile(c, shift, ahead_px * pixel_mm(loop), &all);
    }
  return all;
}

/* By how much the prediction, as large as it is, fits better than a constant. */
static double gain(const evidence *e) {
  return 2 * e->sum - e->weight;
}

/* Below it nobody believes a probability, and a report of 0 is none. */
#define P_MIN 1e-300

static double two_sided(double sigmas) {
  return fmax(P_MIN, erfc(fabs(sigmas) * M_SQRT1_2));
}

static void decide(fg_channel_check *w, bool max, const char *why_not) {
  w->verdict = FG_CHANNEL_CHECK_CANNOT_TELL;
  w->reason = why_not;
  if (w->p_value < DECIDED_P && w->factor > 0 && !(w->p_against < DECIDED_P) && max)
    w->verdict = FG_CHANNEL_CHECK_FOR;
  else if (w->p_against < DECIDED_P && w->factor < 0.5)
    w->verdict = FG_CHANNEL_CHECK_AGAINST;
  if (w->verdict == FG_CHANNEL_CHECK_AGAINST)
    w->reason = "the colour lines would show it, and do not";
  if (w->verdict == FG_CHANNEL_CHECK_FOR)
    w->reason = w->gap_stated ? "the colour lines show it as well"
                              : "the colour lines show it as well, with the gaps that fit best";
}

/* Checks with known gaps, where the expected size is known too. Returns the gain over a constant.
 */
static double check_known_gaps(const fg_scan_loop *loop, const carriage *c, fg_channel_check *w) {
  double gap_px[LINES] = {loop->options.colour_gap_px[0], 0, loop->options.colour_gap_px[1]};
  evidence e = collect_evidence(loop, c, -1, gap_px);
  w->gap_stated = true;
  for (int k = 0; k < LINES; k++)
    w->gap_px[k] = gap_px[k];
  w->expected_um = e.profiles ? sqrt(e.expected / (double)e.profiles) : NAN;
  if (!(e.weight > 0)) {
    w->verdict = FG_CHANNEL_CHECK_CANNOT_TELL;
    w->reason = "it makes the same between the lines everywhere, which the scanner takes out";
    return 0;
  }
  w->factor = e.sum / e.weight;
  w->u_factor = 1 / sqrt(e.weight);
  double uncertainty = hypot(w->u_factor, hypot(SHAPE_U, c->u_amplitude_um / c->amplitude_um));
  w->p_value = two_sided(w->factor / w->u_factor);
  w->p_against = two_sided((1 - w->factor) / uncertainty);
  decide(w, gain(&e) >= SHARE_MIN * e.uneven,
         w->p_value < DECIDED_P ? "the colour lines show something uneven of another size or shape"
                                : "what it makes between the lines is too small for their u");
  return gain(&e);
}

/* The likeliest gap of one line. */
static double find_gap(const fg_scan_loop *loop, const carriage *c, int line, evidence *best) {
  double likeliest = 0, gaps[LINES] = {0};
  *best = (evidence){0};
  for (double gap = -GAP_MAX_PX; gap <= GAP_MAX_PX; gap += GAP_STEP_PX) {
    gaps[line] = gap;
    evidence e = collect_evidence(loop, c, line, gaps);
    if (!(gain(&e) > gain(best))) continue;
    *best = e;
    likeliest = gap;
  }
  return likeliest;
}

/* Checks with unknown gaps: each line's gap is fitted. Gap and factor are two dof; the best line is
 * corrected for the number of lines. */
static double check_fitted_gaps(const fg_scan_loop *loop, const carriage *c, fg_channel_check *w) {
  double min = 1, lines = 0, all = 0;
  bool max = false;
  for (int line = 0; line < LINES; line++) {
    evidence e;
    double gap = find_gap(loop, c, line, &e), p = fmax(P_MIN, exp(-0.5 * fmax(0, gain(&e))));
    w->gap_px[line] = e.profiles ? gap : NAN;
    lines += e.profiles > 0;
    all += fmax(0, gain(&e));
    if (!(p < min)) continue;
    min = p;
    max = gain(&e) >= SHARE_MIN * e.uneven;
    w->factor = 1;
    w->expected_um = sqrt(e.expected / (double)e.profiles);
  }
  w->p_value = fmin(1, fmax(1, lines) * min);
  w->p_against = NAN;
  decide(w, max,
         w->p_value < DECIDED_P
             ? "the colour lines show something uneven of another shape"
             : "nothing of it shows between the lines; whether it should depends on their gap "
               "(--colour-gap)");
  return all;
}

static fg_channel_check ask_of(const fg_scan_loop *loop, const carriage *c, double *better) {
  fg_channel_check w = {.p_value = NAN,
                        .p_against = NAN,
                        .factor = NAN,
                        .u_factor = NAN,
                        .expected_um = NAN,
                        .gap_px = {NAN, NAN, NAN}};
  bool stated = loop->options.colour_gap_px[0] != 0 || loop->options.colour_gap_px[1] != 0;
  *better = (stated ? check_known_gaps : check_fitted_gaps)(loop, c, &w);
  return w;
}

/* ---- claims and ties ---- */

static bool add_field(const fg_effect_found *effect, fg_field_list *to) {
  if (!effect->kind->of_carriage || to->count == FG_FIELDS_MAX) return false;
  to->fields[to->count++] = fg_effect_found_field(effect);
  return true;
}

static bool accept_effect(const fg_effect_found *effect, carriage *c) {
  if (!add_field(effect, &c->fields)) return false;
  double a = fabs(fg_effect_found_amplitude(effect));
  if (a > c->amplitude_um) {
    c->amplitude_um = a;
    c->u_amplitude_um = fg_effect_found_u(effect);
  }
  return true;
}

static carriage start_carriage(const fg_scan_loop *loop) {
  return (carriage){.fields = {.frame = loop->edge_fit.frame},
                    .others = {.frame = loop->edge_fit.frame},
                    .x_mm = loop->edge_fit.frame.centre_mm[0]};
}

static carriage carriage_of(const fg_scan_loop *loop, const fg_effect_set *set) {
  carriage c = start_carriage(loop);
  for (size_t e = 0; e < set->count; e++)
    accept_effect(&set->effects[e], &c);
  return c;
}

static void name_set(const fg_effect_set *set, char name[FG_SCAN_RESULT_WORDS]) {
  name[0] = 0;
  for (size_t e = 0; e < set->count; e++) {
    size_t used = strlen(name);
    fg_text_clip(name + used, FG_SCAN_RESULT_WORDS - used, "%s%s", used ? " + " : "",
                 set->effects[e].kind->id);
  }
}

/* Marks fitted gaps as unknown: only the reader may know the sensor. */
static void put_gaps(const fg_channel_check *w, char words[96]) {
  double gaps[LINES];
  size_t count = 0;
  words[0] = 0;
  for (int k = 0; k < LINES; k++)
    if (isfinite(w->gap_px[k])) gaps[count++] = fabs(w->gap_px[k]);
  if (w->gap_stated || !count) return;
  if (count == 1)
    fg_text_clip(words, 96, "; if two of the lines lie %g rows apart", gaps[0]);
  else
    fg_text_clip(words, 96, "; if the lines lie %g and %g rows from the one measured", gaps[0],
                 gaps[1]);
}

/* Evidence on a tie: explanations with an effect of the carriage that would show between the lines,
 * and the channel check of the one that fits best. */
typedef struct contest {
  char names[FG_SCAN_RESULT_WORDS / 2];
  size_t holds, lacks; /* explanations */
  fg_channel_check channel_check;
  double better;
} contest;

/* Enters an explanation. In a tie the numbers of the carriage's effects are too uncertain to
 * separate these from each other (reports/colour_lines.md), but not from explanations that predict
 * a constant. */
static void enter_explanation(const fg_scan_loop *loop, const fg_effect_set *set, contest *to) {
  carriage c = carriage_of(loop, set);
  fg_channel_check w = {.expected_um = NAN};
  double better = 0;
  if (c.fields.count) w = ask_of(loop, &c, &better);
  if (!(w.expected_um > CONSTANT_UM)) {
    to->lacks++;
    return;
  }
  char name[FG_SCAN_RESULT_WORDS];
  size_t used = strlen(to->names);
  name_set(set, name);
  fg_text_clip(to->names + used, sizeof to->names - used, "%s%s", used ? ", " : "", name);
  if (!to->holds || better > to->better) {
    to->better = better;
    to->channel_check = w;
  }
  to->holds++;
}

static void ask_tie(const fg_scan_loop *loop, fg_scan_result *result) {
  contest all = {0};
  char gaps[96];
  enter_explanation(loop, &loop->set, &all);
  for (size_t k = 0; k < loop->tie_count; k++)
    enter_explanation(loop, &loop->tie[k], &all);
  if (!all.holds || !all.lacks || all.channel_check.verdict != FG_CHANNEL_CHECK_FOR ||
      !(all.channel_check.p_value < CERTAIN_P) || result->advices == FG_SCAN_RESULT_ADVICE)
    return;
  put_gaps(&all.channel_check, gaps);
  fg_text_clip(result->channel_check_words, sizeof result->channel_check_words,
               "the colour lines of these scans, in which neither part nor optics shows, speak for "
               "the carriage (p = %.1g): %s, and not for the other %zu%s",
               all.channel_check.p_value, all.names, all.lacks, gaps);
  result->advice[result->advices++] = result->channel_check_words;
}

void fg_scan_loop_check_channels(const fg_scan_loop *loop, fg_scan_result *result) {
  if (!any_speaks(loop)) return;
  for (size_t i = 0; i < loop->set.count && i < result->claims; i++) {
    carriage c = start_carriage(loop);
    if (result->claim[i].free || !accept_effect(&loop->set.effects[i], &c)) continue;
    for (size_t k = 0; k < loop->set.count; k++)
      if (k != i) add_field(&loop->set.effects[k], &c.others);
    double better;
    result->claim[i].channel_check = ask_of(loop, &c, &better);
  }
  if (!result->named) ask_tie(loop, result);
}
