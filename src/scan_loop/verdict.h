/* What the loop on scans says of its effects: decided once, for JSON, page and text alike. */
#ifndef FG_SCAN_LOOP_VERDICT_H
#define FG_SCAN_LOOP_VERDICT_H

#include "explain/explain.h"

struct fg_scan_loop;

/* An effect of this size would be a nuisance: what could have been shown at it and was not is
 * `absent`. */
#define FG_SCAN_LOOP_MATTERS_UM 3.0

/* An effect that is not claimed. */
typedef struct fg_scan_loop_unclaimed {
  const fg_effect *kind;
  fg_loop_verdict
      verdict; /* tied: one of several explanations; else absent, inconclusive, absorbed */
  double would_explain, share, smallest_um; /* as in fg_explanations */
  bool barred;                              /* found, and not confirmed from disc to disc */
} fg_scan_loop_unclaimed;

typedef struct fg_scan_loop_decisions {
  bool sure[FG_EFFECT_SET_MAX];      /* of the set's effects: every explanation holds it */
  size_t shown[FG_EXPLANATIONS_MAX]; /* explanations that differ in more than an effect's form */

  size_t shown_count; /* 2 or more: tied, and not named */
  size_t unlisted;    /* further ones, that there is no room for */
  fg_scan_loop_unclaimed candidate[FG_CANDIDATES_MAX + FG_POINTS_BARRED];
  size_t candidates;
  const char *advice[2]; /* the measurements that would part what is tied */
  size_t advices;
} fg_scan_loop_decisions;

/* Whether every explanation that the data allow holds the effect, in whatever form. */
bool fg_scan_loop_is_sure(const fg_explanations *explanations, const fg_effect *kind);

/* From what was searched and fitted. */
void fg_scan_loop_decide(const struct fg_scan_loop *loop, fg_scan_loop_decisions *decided);

#endif
