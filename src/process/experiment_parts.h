/* The stages of fg_experiment_analyse, in their order. */
#ifndef FG_PROCESS_EXPERIMENT_PARTS_H
#define FG_PROCESS_EXPERIMENT_PARTS_H

#include "foilgauge/experiment.h"

fg_status fg_experiment_note(fg_context *ctx, fg_experiment *experiment, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Fits again with weights where the measurement's uncertainty asks for it. */
fg_status fg_experiment_weigh(fg_context *ctx, fg_experiment *experiment,
                              const fg_extended *response);

/* Split plots, coefficients by stratum, Lenth, Box-Cox, curvature, what the measurement adds. */
fg_status fg_experiment_effects(fg_context *ctx, fg_experiment *experiment);

/* What the residuals show over the order of the runs. */
fg_status fg_experiment_check_order(fg_context *ctx, fg_experiment *experiment);

/* Surface, region, stationary point, optimum, ridge. */
fg_status fg_experiment_surface(fg_context *ctx, const fg_experiment_options *options,
                                fg_experiment *experiment);

/* Adds "2*a + b <= 3" (real units) to the region as a half-space in the model's units. */
fg_status fg_experiment_constrain(fg_context *ctx, const fg_experiment *experiment,
                                  const char *text, fg_region *region);

/* The expected response at a place of the surface; whether it lies on the region's border. */
fg_status fg_experiment_predict_at(fg_context *ctx, const fg_experiment *experiment,
                                   const double *x, fg_prediction *prediction);
bool fg_experiment_on_border(const fg_region *region, const double *x);

/* The best setting that can be made, where steps are given. */
fg_status fg_experiment_round(fg_context *ctx, const fg_experiment_options *options,
                              fg_experiment *experiment);

#endif
