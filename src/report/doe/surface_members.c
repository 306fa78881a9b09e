/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An experiment's order of runs, surface, settings that were asked for, and runs as members. */
#include <math.h>

#include "report/doe/members.h"

static const fg_experiment *best_of(const fg_subject *s) {
  return fg_doe_whole_at(s)->best;
}

/* Residuals over the order of the runs. */
static const fg_order_check *order_of(const fg_subject *s) {
  return s->object;
}

static double shows_drift(const fg_subject *s) {
  return fg_order_shows(order_of(s)->drift_p);
}

static double shows_neighbours(const fg_subject *s) {
  return fg_order_shows(order_of(s)->neighbours_p);
}

static double shows_farthest(const fg_subject *s) {
  return fg_order_shows(order_of(s)->farthest_p);
}

static const fg_member drift_rows[] = {
    {FG_FLAG_BY("shows", shows_drift), .words = "it is significant"},
    {FG_NUMBER("change", fg_order_check, drift)},
    {FG_NUMBER("u_change", fg_order_check, u_drift), .words = "its standard uncertainty"},
    {FG_NUMBER("p_value", fg_order_check, drift_p), .words = "Student's t"},
};
static const fg_members drift_members = FG_MEMBERS(drift_rows);

static const fg_member neighbour_rows[] = {
    {FG_FLAG_BY("shows", shows_neighbours), .words = "it is significant"},
    {FG_NUMBER("correlation", fg_order_check, neighbours)},
    {FG_NUMBER("durbin_watson", fg_order_check, durbin_watson)},
    {FG_NUMBER("p_value", fg_order_check, neighbours_p),
     .words = "by independent normal errors through the same model"},
};
static const fg_members neighbour_members = FG_MEMBERS(neighbour_rows);

static double row_number(const fg_subject *s, size_t i) {
  const fg_experiment_report *report = fg_doe_whole_at(s)->report;
  return (double)(report->row ? report->row[i] : i + 1);
}

static double find_farthest_row(const fg_subject *s) {
  return row_number(s, order_of(s)->farthest);
}

static const fg_member farthest_rows[] = {
    {FG_FLAG_BY("shows", shows_farthest), .words = "it is significant"},
    {FG_COUNT_BY("row", find_farthest_row), .lowest = 1, .words = "of the run sheet"},
    {FG_NUMBER("externally_studentised", fg_order_check, farthest_t)},
    {FG_NUMBER("p_value", fg_order_check, farthest_p), .words = "over all runs"},
};
static const fg_members farthest_members = FG_MEMBERS(farthest_rows);

static double find_order_level(const fg_subject *s) {
  (void)s;
  return FG_ORDER_LEVEL;
}

static const char *find_command(const fg_subject *s, char *buffer) {
  (void)buffer;
  return fg_doe_whole_at(s)->command;
}

static const fg_member order_rows[] = {
    {FG_STRING("column", fg_order_check, column), .words = "that orders the runs; null: the rows"},
    {FG_NUMBER_BY("level", find_order_level), .options = FG_MEMBER_NEVER_NULL,
     .words = "of each test"},
    {FG_GROUP("drift", &drift_members),
     .words = "change of the response from the first run to the last, beside the model"},
    {FG_GROUP("neighbours", &neighbour_members), .words = "residuals of neighbouring runs"},
    {FG_GROUP("farthest", &farthest_members),
     .words = "the largest externally studentised residual"},
    {FG_TEXT_BY("command", find_command),
     .words = "that traces it to an effect; null: nothing shows"},
};
static const fg_members order_members = FG_MEMBERS(order_rows);

static fg_subject find_order(const fg_subject *s) {
  const fg_experiment *e = fg_doe_experiment_at(s);
  return (fg_subject){.object = e->has_order ? &e->order : NULL, .whole = s->whole};
}

/* A point of the surface, in the order of the axes: the subject is its coded coordinates. */
static const double *list_coded(const fg_subject *s, double *buffer, size_t *count) {
  (void)buffer;
  *count = best_of(s)->surface.factors;
  return s->object;
}

static const double *list_real(const fg_subject *s, double *buffer, size_t *count) {
  const double *x = s->object;
  *count = best_of(s)->surface.factors;
  for (size_t k = 0; k < *count; k++)
    buffer[k] = fg_factor_real(fg_surface_factor(best_of(s), k), x[k]);
  return buffer;
}

static const fg_member point_rows[] = {
    {FG_NUMBERS_BY("coded", list_coded), .options = FG_MEMBER_NEVER_NULL},
    {FG_NUMBERS_BY("real", list_real), .options = FG_MEMBER_NEVER_NULL, .words = "in real units"},
};
static const fg_members point_members = FG_MEMBERS(point_rows);

static const fg_member prediction_rows[] = {
    {FG_NUMBER("mean", fg_prediction, mean), .words = "expected response"},
    {FG_NUMBER("standard_error", fg_prediction, standard_error)},
    {FG_RANGE("interval", fg_prediction, low, high),
     .words = "of the mean; at a setting that the runs chose (stationary, optimum, rounded, ridge) "
              "it holds at all settings of the region at once, at one that was asked for there "
              "alone"},
    {FG_NUMBER("coverage_factor", fg_prediction, coverage_factor),
     .words = "half of this interval over the standard error"},
    {FG_RANGE("confirmation_run_interval", fg_prediction, run_low, run_high),
     .words = "of one new run, likewise"},
};
static const fg_members prediction_members = FG_MEMBERS(prediction_rows);

#define POINT_AT(object, field)                                                                    \
  { FG_SAME(&point_members), .offset = offsetof(object, field) }
#define PREDICTION_AT(object, field)                                                               \
  { FG_SAME(&prediction_members), .offset = offsetof(object, field) }

static const fg_member stationary_rows[] = {
    POINT_AT(fg_experiment, surface.stationary),
    {FG_FLAG("inside_region", fg_experiment, stationary_inside),
     .words = "of the data and the constraints"},
    PREDICTION_AT(fg_experiment, stationary),
};
static const fg_members stationary_members = FG_MEMBERS(stationary_rows);

static fg_subject find_stationary(const fg_subject *s) {
  return (fg_subject){.object = best_of(s)->surface.has_stationary ? best_of(s) : NULL,
                      .whole = s->whole};
}

/* The optimum. */
static const char *const goal_words[] = {"lowest", "highest", "target", NULL};

static const char *find_goal(const fg_subject *s, char *buffer) {
  (void)buffer;
  return fg_goal_word(best_of(s)->best.goal);
}

static double find_target(const fg_subject *s) {
  return best_of(s)->best.goal == FG_GOAL_TARGET ? best_of(s)->best.target : NAN;
}

static const char *constraint_at(const fg_subject *s, size_t i) {
  return i < best_of(s)->constraints ? best_of(s)->constraint[i] : NULL;
}

/* Level of a word factor: the subject's index is the variable's. */
static bool find_level(const fg_subject *list, size_t v, fg_subject *element) {
  const fg_experiment *e = best_of(list);
  if (v >= e->model.formula.variables) return false;
  element->object = e->model.levels[v].count && v != e->block_variable ? e : NULL;
  return true;
}

static const char *find_level_variable(const fg_subject *s) {
  return best_of(s)->model.formula.variable[s->index].name;
}

static const char *find_level_name(const fg_subject *s, char *buffer) {
  const fg_experiment *e = best_of(s);
  (void)buffer;
  return e->model.levels[s->index].name[(size_t)e->best.levels[s->index]];
}

static const fg_member level_rows[] = {
    {FG_TEXT_BY(NULL, find_level_name), .options = FG_MEMBER_NEVER_NULL}};
static const fg_members level_members = FG_MEMBERS(level_rows);

static const fg_member optimum_rows[] = {
    {FG_TEXT_BY("goal", find_goal), .options = FG_MEMBER_NEVER_NULL, .choices = goal_words},
    {FG_NUMBER_BY("target", find_target), .words = "response wanted; null: another goal"},
    {FG_TEXTS_BY("constraints", constraint_at), .words = "as given"},
    POINT_AT(fg_optimum, x),
    {FG_MAP_BY("levels", find_level, find_level_variable, &level_members),
     .words = "of factors of words"},
    {FG_FLAG("on_border", fg_optimum, on_border), .words = "the best setting may lie beyond"},
    PREDICTION_AT(fg_optimum, prediction),
};
static const fg_members optimum_members = FG_MEMBERS(optimum_rows);

static fg_subject find_optimum(const fg_subject *s) {
  return (fg_subject){.object = best_of(s)->best.found ? &best_of(s)->best.optimum : NULL,
                      .whole = s->whole};
}

static bool has_optimum(const fg_subject *s) {
  return best_of(s)->best.found;
}

/* The best setting that can be made. */
static bool find_step_of_axis(const fg_subject *list, size_t k, fg_subject *element) {
  element->object = best_of(list);
  return k < best_of(list)->surface.factors;
}

static double find_step(const fg_subject *s) {
  return best_of(s)->best.step[s->index] > 0 ? best_of(s)->best.step[s->index] : NAN;
}

static const fg_member step_rows[] = {{FG_NUMBER_BY(NULL, find_step)}};
static const fg_members step_members = FG_MEMBERS(step_rows);

static const fg_member rounded_rows[] = {
    {FG_LIST_BY("steps", find_step_of_axis, &step_members),
     .words = "of the axes; null: not rounded"},
    POINT_AT(fg_optimum, x),
    {FG_FLAG("on_border", fg_optimum, on_border), .words = "of the region"},
    PREDICTION_AT(fg_optimum, prediction),
};
static const fg_members rounded_members = FG_MEMBERS(rounded_rows);

static fg_subject find_rounded(const fg_subject *s) {
  return (fg_subject){.object = best_of(s)->best.has_rounded ? &best_of(s)->best.rounded : NULL,
                      .whole = s->whole};
}

/* The ridge: there is one where its last point has a radius. */
static const fg_member ridge_rows[] = {
    {FG_NUMBER("radius", fg_ridge_point, radius), .words = "coded, from the centre"},
    POINT_AT(fg_ridge_point, x),
    {FG_FLAG("inside_region", fg_ridge_point, inside), .words = "of the data and the constraints"},
    PREDICTION_AT(fg_ridge_point, prediction),
};
static const fg_members ridge_members = FG_MEMBERS(ridge_rows);

static bool find_ridge_point(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_experiment *e = best_of(list);
  element->object = &e->best.ridge[i];
  return i < FG_RIDGE_POINTS && e->best.ridge[FG_RIDGE_POINTS - 1].radius > 0;
}

/* Factors without a significant effect. */
static const char *find_idle_name(const fg_subject *s, char *buffer) {
  const fg_idle_factor *idle = s->object;
  (void)buffer;
  return fg_doe_experiment_at(s)->model.formula.variable[idle->variable].column;
}

static const fg_member idle_rows[] = {
    {FG_TEXT_BY("name", find_idle_name), .options = FG_MEMBER_NEVER_NULL},
    {FG_COUNT("terms", fg_idle_factor, columns), .words = "coefficients that hold the factor"},
    {FG_NUMBER("p_value", fg_idle_factor, p_value),
     .words = "of all of them together; null: no error is known, Lenth's margin decided"},
};
static const fg_members idle_members = FG_MEMBERS(idle_rows);

static bool find_idle(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = &fg_doe_experiment_at(list)->idle.factor[i];
  return i < fg_doe_experiment_at(list)->idle.count;
}

/* The surface. */
static const char *axis_at(const fg_subject *s, size_t k) {
  return k < best_of(s)->surface.factors ? fg_surface_factor(best_of(s), k)->name : NULL;
}

static const char *const kind_words[] = {"minimum", "maximum", "saddle", "ridge", "plane", NULL};

static const char *find_kind(const fg_subject *s, char *buffer) {
  (void)buffer;
  return fg_surface_kind_word(best_of(s)->surface.kind);
}

static const double *list_eigenvalues(const fg_subject *s, double *buffer, size_t *count) {
  (void)buffer;
  *count = best_of(s)->surface.factors;
  return best_of(s)->surface.eigenvalue;
}

static bool find_eigenvector(const fg_subject *list, size_t k, fg_subject *element) {
  element->object = best_of(list)->surface.eigenvector[k];
  return k < best_of(list)->surface.factors;
}

static const fg_member eigenvector_rows[] = {
    {FG_NUMBERS_BY(NULL, list_coded), .options = FG_MEMBER_NEVER_NULL}};
static const fg_members eigenvector_members = FG_MEMBERS(eigenvector_rows);

static const fg_member surface_rows[] = {
    {FG_STRING("formula", fg_experiment, formula), .options = FG_MEMBER_NEVER_NULL},
    {FG_LIST_BY("any", find_idle, &idle_members),
     .words = "factors any setting of which will do: neither one of their terms nor all together "
              "stand out from the scatter"},
    {FG_TEXTS_BY("axes", axis_at), .words = "factors of the surface"},
    {FG_TEXT_BY("kind", find_kind), .options = FG_MEMBER_NEVER_NULL, .choices = kind_words},
    {FG_NUMBERS_BY("eigenvalues", list_eigenvalues), .options = FG_MEMBER_NEVER_NULL,
     .words = "descending"},
    {FG_LIST_BY("eigenvectors", find_eigenvector, &eigenvector_members)},
    {FG_PART("stationary", find_stationary, &stationary_members),
     .words = "point; null: there is none"},
    {FG_PART("optimum", find_optimum, &optimum_members), .options = FG_MEMBER_LEFT_OUT,
     .words = "best setting"},
    {FG_PART("rounded", find_rounded, &rounded_members), .present = has_optimum,
     .words = "the best setting that can be made, every factor with a step at a multiple of it; "
              "null: no step was given"},
    {FG_LIST_BY("ridge", find_ridge_point, &ridge_members),
     .words = "the best setting at each distance from the centre"},
};
static const fg_members surface_members = FG_MEMBERS(surface_rows);

static fg_subject find_surface(const fg_subject *s) {
  return (fg_subject){.object = best_of(s)->has_surface ? best_of(s) : NULL, .whole = s->whole};
}

/* A setting that was asked for: numbers in the order of `factors`. */
static const double *list_asked(const fg_subject *s, const double *values, bool real,
                                double *buffer, size_t *count) {
  const fg_experiment *e = fg_doe_experiment_at(s);
  *count = e->factors;
  for (size_t f = 0; f < e->factors; f++) {
    double value = values[e->factor[f].variable];
    buffer[f] = real ? fg_factor_real(&e->factor[f], value) : value;
  }
  return buffer;
}

static const fg_asked *asked_of(const fg_subject *s) {
  return s->object;
}

static const double *list_asked_coded(const fg_subject *s, double *buffer, size_t *count) {
  return list_asked(s, asked_of(s)->setting, false, buffer, count);
}

static const double *list_asked_real(const fg_subject *s, double *buffer, size_t *count) {
  return list_asked(s, asked_of(s)->setting, true, buffer, count);
}

static const double *list_best_real(const fg_subject *s, double *buffer, size_t *count) {
  return list_asked(s, asked_of(s)->best_at, true, buffer, count);
}

static const double *list_best_mean(const fg_subject *s, double *buffer, size_t *count) {
  return list_asked(s, asked_of(s)->best_mean, false, buffer, count);
}

static const fg_member asked_rows[] = {
    {FG_STRING("setting", fg_asked, text), .options = FG_MEMBER_NEVER_NULL, .words = "as given"},
    {FG_NUMBERS_BY("coded", list_asked_coded), .options = FG_MEMBER_NEVER_NULL},
    {FG_NUMBERS_BY("real", list_asked_real), .options = FG_MEMBER_NEVER_NULL},
    PREDICTION_AT(fg_asked, prediction),
    {FG_FLAG("inside_runs", fg_asked, inside), .words = "within their range in every factor"},
    {FG_NUMBERS_BY("best_along_real", list_best_real), .options = FG_MEMBER_NEVER_NULL,
     .words = "best value of each factor within the runs, the others as asked"},
    {FG_NUMBERS_BY("best_along_mean", list_best_mean), .options = FG_MEMBER_NEVER_NULL,
     .words = "the response there"},
};
static const fg_members asked_members = FG_MEMBERS(asked_rows);

static bool find_asked(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = &fg_doe_experiment_at(list)->asked[i];
  return i < fg_doe_experiment_at(list)->askeds;
}

/* A run, by its index. */
static bool find_run(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_regression *r = &fg_doe_experiment_at(list)->regression;
  element->object = r;
  return i < r->rows;
}

static double find_run_row(const fg_subject *s) {
  return row_number(s, s->index);
}

static const fg_regression *regression_of(const fg_subject *s) {
  return s->object;
}

static double find_run_response(const fg_subject *s) {
  return regression_of(s)->fitted[s->index] + regression_of(s)->residual[s->index];
}

static double find_run_u(const fg_subject *s) {
  const double *u = fg_doe_experiment_at(s)->measurement.u;
  return u ? u[s->index] : NAN;
}

#define RUN_VALUE(function, array)                                                                 \
  static double function(const fg_subject *s) {                                                    \
    return regression_of(s)->array[s->index];                                                      \
  }
RUN_VALUE(find_run_fitted, fitted)
RUN_VALUE(find_run_residual, residual)
RUN_VALUE(find_run_leverage, leverage)
RUN_VALUE(find_run_internal, internal)
RUN_VALUE(find_run_external, external)
RUN_VALUE(find_run_cook, cook)

static const fg_member run_rows[] = {
    {FG_COUNT_BY("row", find_run_row), .lowest = 1, .words = "of the run sheet"},
    {FG_NUMBER_BY("response", find_run_response)},
    {FG_NUMBER_BY("u", find_run_u), .words = "its standard uncertainty"},
    {FG_NUMBER_BY("fitted", find_run_fitted)},
    {FG_NUMBER_BY("residual", find_run_residual)},
    {FG_NUMBER_BY("leverage", find_run_leverage)},
    {FG_NUMBER_BY("internally_studentised", find_run_internal)},
    {FG_NUMBER_BY("externally_studentised", find_run_external)},
    {FG_NUMBER_BY("cook", find_run_cook), .words = "Cook's distance"},
};
static const fg_members run_members = FG_MEMBERS(run_rows);

static const fg_member result_rows[] = {
    {FG_PART("order", find_order, &order_members),
     .words = "residuals over the order of the runs; null: not tested (whole plots, no degrees of "
              "freedom, an exact fit)"},
    {FG_PART("surface", find_surface, &surface_members),
     .words = "of the model without the factors that cannot be told from noise, which `any` lists; "
              "where it lists every factor, of the model as given, and its optimum is a setting to "
              "test"},
    {FG_LIST_BY("asked", find_asked, &asked_members),
     .words = "settings that were asked for (--at), by the model as given; numbers in the order of "
              "factors"},
    {FG_LIST_BY("runs", find_run, &run_members), .options = FG_MEMBER_ON_LINE},
};
const fg_members fg_doe_result_members = FG_MEMBERS(result_rows);
