/* Geometry and effects fitted together. */
#ifndef FG_EXPLAIN_JOINT_FIT_H
#define FG_EXPLAIN_JOINT_FIT_H

#include "effect/set.h"

/* From the effects' present numbers and the geometry that stands. `residual_um` (rows, or NULL)
 * gets what is left. */
fg_status fg_joint_fit(fg_context *ctx, fg_points *points, fg_effect_set *set, double *residual_um);

#endif
