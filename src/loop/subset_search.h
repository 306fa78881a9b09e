/* What the parts of the search for a subset share. */
#ifndef FG_LOOP_SUBSET_SEARCH_H
#define FG_LOOP_SUBSET_SEARCH_H

#include "loop/subset_columns.h"

typedef struct fg_subset_search {
  fg_subset_columns columns;
  fg_subset *out;
  size_t free_column, free_end; /* columns of the free curves */
  bool two_curves;              /* may stand in */
  const fg_scan_set *tried;     /* was fitted and is not right, or NULL */
  double full;                  /* residual sum beside everything */
  size_t freedom;               /* columns that took it */
  size_t new_shapes;            /* ripples and steps that were found in this round */
  unsigned unfitted;            /* effects with a shape that was found in this round */
} fg_subset_search;

/* What the search compares with: everything at once. */
typedef struct fg_subset_yardstick {
  double full, freedom, unit, allowance;
  double none;    /* excess of no effect */
  unsigned bends; /* crown and skew */
  double reach;   /* of a polynomial's middle, in units of FG_FIELD_HALF_MM */
} fg_subset_yardstick;

fg_subset_yardstick fg_subset_yardstick_of(fg_subset_search *s);

/* Fits a set; an excess of INFINITY says that it is no set of its own. */
fg_subset_member fg_subset_try(const fg_subset_search *s, const fg_subset_yardstick *y,
                               unsigned mask);
bool fg_subset_is_right(const fg_subset_yardstick *y, const fg_subset_member *m);

/* Fill what the report says of every effect, and of the width, beside the best member. */
void fg_subset_describe_effects(fg_subset_search *s, const fg_subset_yardstick *y);
void fg_subset_describe_width(fg_subset_search *s, const fg_subset_yardstick *y);

/* Adds an effect whose columns are its own. */
void fg_subset_add(fg_subset_search *s, const fg_subset_effect *effect);

/* Noise of a row and its correlation, from what is left beside geometry and all effects, or all
 * that are listed; returns the rank of the basis that took them out. */
size_t fg_subset_noise(fg_subset_search *s, bool listed_only);

/* FG_ERR_DATA when the last noise rests on too few rows. */
fg_status fg_subset_check_rows(fg_context *ctx, const fg_subset_search *s);

/* Integral of the correlation of what is left, along the edge. */
double fg_subset_integral(const fg_subset_columns *columns);

/* Gain in chi² that makes one worth a place in the search: its best of some hundred places stands
 * for ln of their number more; and its size, um. */
#define FG_SUBSET_SHAPED_CHI2     45.0
#define FG_SUBSET_SHAPED_LEAST_UM 0.15

/* Where one takes most beside the first `rank` vectors of the basis, with `left` beside them: its
 * gain in chi², its size in um. `work` has room for two columns. */
typedef struct fg_subset_hit {
  double gain, amplitude, at;
} fg_subset_hit;
fg_subset_hit fg_subset_find_place(const fg_subset_search *s, size_t rank, const fg_effect *kind,
                                   double *work);

/* Shapes nearer to each other than this are one. */
#define FG_SUBSET_TWIN_SHARE 0.05

/* Adds a smooth effect with a shape: with the one it has in the known set (NULL: none), and with
 * the one that takes most beside the geometry alone, which a fit beside wrong effects may have
 * missed.
 */
fg_status fg_subset_add_shaped(fg_context *ctx, fg_subset_search *s, const fg_effect *kind,
                               const fg_scan_set *known);

/* Looks for ripples and steps beside everything else, and adds those that stand out. */
fg_status fg_subset_find_shaped(fg_context *ctx, fg_subset_search *s);

/* Steps at other places that the geometry turns into those that are known: a whole bump between the
 * two places takes the difference. They are added as effects of their own. */
fg_status fg_subset_add_other_steps(fg_context *ctx, fg_subset_search *s, const fg_scan_set *known);

size_t fg_subset_bits(unsigned mask);
/* Of all effects, those that are free curves, or those that are listed. */
unsigned fg_subset_mask_of(const fg_subset *out, bool of_free);
/* Puts a member into the class, the one that leaves least first. */
void fg_subset_keep_member(fg_subset *out, const fg_subset_member *member);

#endif
