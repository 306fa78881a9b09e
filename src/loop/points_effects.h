/* Effects of scanner and part over the rows of points.
 *
 * An id may carry a form behind a colon ("part.ovality:radial"): one effect of the table, in two
 * forms that data can tell apart. Reports name it without the form.
 */
#ifndef FG_LOOP_POINTS_EFFECTS_H
#define FG_LOOP_POINTS_EFFECTS_H

#include "foilgauge/loop.h"
#include "loop/points.h"

/* What polynomial effects of the scanner are made of: u, u², u³ of one axis about the middle of the
 * picture, along that axis; 1 at FG_FIELD_HALF_MM from it. */
#define FG_POWERS_X "powers.x"
#define FG_POWERS_Y "powers.y"

/* Columns of an effect at the rows: um of residual per um of amplitude. `columns` is
 * FG_FIELD_COLUMNS × row_count; returns how many were filled, 0 for an id that is not known. */
size_t fg_points_effect_columns(const fg_points *points, const char *id, const double *shape,
                                double *columns);

/* The same for half the strip's width: a scanner's field stretches the strip as it stretches the
 * foil, a part's effect leaves its thickness alone. Returns 0 for those. */
size_t fg_points_width_columns(const fg_points *points, const char *id, const double *shape,
                               double *columns);

/* An id without its form; the form ("normal", "radial"; NULL: the effect has one form only). */
const char *fg_effect_name(const char *id);
const char *fg_effect_form(const char *id);
/* Whether two ids are one effect, in whatever form. */
bool fg_effect_same(const char *a, const char *b);

#endif
