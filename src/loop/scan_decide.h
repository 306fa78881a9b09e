/* What the loop on scans says of its effects: decided once, for JSON, page and text alike. */
#ifndef FG_LOOP_SCAN_DECIDE_H
#define FG_LOOP_SCAN_DECIDE_H

#include "loop/subset.h"

struct fg_scan_loop;

/* An effect of this size would be a nuisance: what could have been shown at it and was not is
 * `absent`. */
#define FG_SCAN_MATTERS_UM 3.0

/* An effect that is not claimed. */
typedef struct fg_scan_candidate {
  const fg_effect *kind;
  fg_loop_verdict verdict; /* tied: a member of the class; else absent, inconclusive, absorbed */
  double would_explain, share, smallest_um; /* as in fg_subset */
  bool barred;                              /* found, and not confirmed from disc to disc */
} fg_scan_candidate;

typedef struct fg_scan_decisions {
  bool sure[FG_SCAN_EFFECTS];      /* of the set's effects: every explanation holds it */
  size_t members[FG_SUBSET_CLASS]; /* of the class, that differ in more than an effect's form */
  size_t member_count;             /* 2 or more: tied, and not named */
  size_t unlisted;                 /* further members, that the class has no room for */
  fg_scan_candidate candidate[FG_SUBSET_EFFECTS + FG_POINTS_BARRED];
  size_t candidates;
  const char *advice[2]; /* the measurements that would part what is tied */
  size_t advices;
} fg_scan_decisions;

/* Whether every explanation that the data allow holds the effect, in whatever form. */
bool fg_scan_effect_is_sure(const fg_subset *subset, const fg_effect *kind);

/* From what was searched and fitted. */
void fg_scan_decide(const struct fg_scan_loop *loop, fg_scan_decisions *decided);

#endif
