/* What the parts of the search share. */
#ifndef FG_EXPLAIN_SEARCH_H
#define FG_EXPLAIN_SEARCH_H

#include "explain/explain_columns.h"

typedef struct fg_explain_search {
  fg_explain_columns columns;
  fg_explanations *out;
  size_t free_column, free_end; /* columns of the free curves */
  bool two_curves;              /* may stand in */
  const fg_effect_set *tried;   /* was fitted and is not right, or NULL */
  double full;                  /* residual sum beside everything */
  size_t freedom;               /* columns that took it */
  size_t new_shapes;            /* ripples and steps that were found in this round */
  unsigned unfitted;            /* effects with a shape that was found in this round */
} fg_explain_search;

/* What the search compares with: everything at once. */
typedef struct fg_explain_yardstick {
  double full, freedom, unit, allowance;
  double none;    /* excess of no effect */
  unsigned bends; /* crown and skew */
  double reach;   /* of a polynomial's middle, in units of FG_FIELD_HALF_MM */
} fg_explain_yardstick;

fg_explain_yardstick fg_explain_yardstick_of(fg_explain_search *s);

/* Fits a set; an excess of INFINITY says that it is no set of its own. */
fg_explanation fg_explain_try(const fg_explain_search *s, const fg_explain_yardstick *y,
                              unsigned mask);
bool fg_explain_is_right(const fg_explain_yardstick *y, const fg_explanation *m);

/* Fill what the report says of every effect, and of the width, beside the best explanation. */
void fg_explain_describe_effects(fg_explain_search *s, const fg_explain_yardstick *y);
void fg_explain_describe_width(fg_explain_search *s, const fg_explain_yardstick *y);

/* Adds an effect whose columns are its own. */
void fg_explain_add(fg_explain_search *s, const fg_candidate *effect);

/* Noise of a row and its correlation, from what is left beside geometry and all effects, or all
 * that are listed; returns the rank of the basis that took them out. */
size_t fg_explain_noise(fg_explain_search *s, bool listed_only);

/* FG_ERR_DATA when the last noise rests on too few rows. */
fg_status fg_explain_check_rows(fg_context *ctx, const fg_explain_search *s);

/* Integral of the correlation of what is left, along the edge. */
double fg_explain_integral(const fg_explain_columns *columns);

/* Gain in chi² that makes one worth a place in the search: its best of some hundred places stands
 * for ln of their number more; and its size, um. */
#define FG_EXPLAIN_SHAPED_CHI2     45.0
#define FG_EXPLAIN_SHAPED_LEAST_UM 0.15

/* Where one takes most beside the first `rank` vectors of the basis, with `left` beside them: its
 * gain in chi², its size in um. `work` has room for two columns. */
typedef struct fg_explain_hit {
  double gain, amplitude, at;
} fg_explain_hit;
fg_explain_hit fg_explain_find_place(const fg_explain_search *s, size_t rank, const fg_effect *kind,
                                     double *work);

/* Shapes nearer to each other than this are one. */
#define FG_EXPLAIN_TWIN_SHARE 0.05

/* Adds a smooth effect with a shape: with the one it has in the known set (NULL: none), and with
 * the one that takes most beside the geometry alone, which a fit beside wrong effects may have
 * missed.
 */
fg_status fg_explain_add_shaped(fg_context *ctx, fg_explain_search *s, const fg_effect *kind,
                                const fg_effect_set *known);

/* Looks for ripples and steps beside everything else, and adds those that stand out. */
fg_status fg_explain_find_shaped(fg_context *ctx, fg_explain_search *s);

/* Steps at other places that the geometry turns into those that are known: a whole bump between the
 * two places takes the difference. They are added as effects of their own. */
fg_status fg_explain_add_other_steps(fg_context *ctx, fg_explain_search *s,
                                     const fg_effect_set *known);

size_t fg_explain_bits(unsigned mask);
/* Of all effects, those that are free curves, or those that are listed. */
unsigned fg_explain_mask_of(const fg_explanations *out, bool of_free);
/* Puts an explanation into the list, the one that leaves least first. */
void fg_explain_keep(fg_explanations *out, const fg_explanation *explanation);

#endif
