/* What the parts of the search for a subset share. */
#ifndef FG_LOOP_SUBSET_SEARCH_H
#define FG_LOOP_SUBSET_SEARCH_H

#include "loop/subset_columns.h"

typedef struct fg_subset_search {
  fg_subset_columns columns;
  fg_subset *out;
  size_t free_column, free_end; /* columns of the free curves */
  const fg_scan_set *tried;     /* was fitted and is not right, or NULL */
  double full;                  /* residual sum beside everything */
  size_t freedom;               /* columns that took it */
  size_t new_shapes;            /* ripples and steps that were found in this round */
} fg_subset_search;

/* Adds an effect whose columns are its own. */
void fg_subset_add(fg_subset_search *s, const fg_subset_effect *effect);

/* Noise of a row and its correlation, from what is left beside geometry and all effects, or all
 * that are listed; returns the rank of the basis that took them out. */
size_t fg_subset_noise(fg_subset_search *s, bool listed_only);

/* Looks for ripples and steps beside everything else, and adds those that stand out. */
fg_status fg_subset_find_shaped(fg_context *ctx, fg_subset_search *s);

/* Steps at other places that the geometry turns into those that are known: a whole bump between the
 * two places takes the difference. They are added as effects of their own. */
fg_status fg_subset_add_other_steps(fg_context *ctx, fg_subset_search *s, const fg_scan_set *known);

/* Start i of `count`: a ripple's period, evenly in frequency; a step's place. */
double fg_subset_ripple_period(const fg_points *points, size_t i, size_t count);
double fg_subset_step_place(const fg_points *points, size_t i, size_t count);

size_t fg_subset_bits(unsigned mask);
/* Of all effects, those that are free curves, or those that are listed. */
unsigned fg_subset_mask_of(const fg_subset *out, bool of_free);
/* Puts a member into the class, the one that leaves least first. */
void fg_subset_keep_member(fg_subset *out, const fg_subset_member *member);

#endif
