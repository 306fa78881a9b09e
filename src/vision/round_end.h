/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Light about the round end of a narrow cut.
 *
 * The cut has two straight sides and ends in an arc across them. The scanner blurs it from all
 * sides: where the arc's radius is a few blurs, the light at the apex is no longer that of a
 * straight edge that is moved a little. The light is found exactly here, as a mean over the lines
 * along the cut, each of which ends at the arc:
 *
 *   V(u, v) = integral over |t| < W of phi((v - t) / s_v) / s_v Phi((h(t) - u) / s_u) dt,
 *   h(t)² = R² - t²,
 *
 * with u from the arc's centre towards the material, v across from the cut's middle, half the width
 * W and the blurs s_u along and s_v across. A pixel takes the place d = s_u Phi^-1(V) beside a
 * straight edge with the same light, so that the step of straight edges fits it.
 */
#ifndef FG_VISION_ROUND_END_H
#define FG_VISION_ROUND_END_H

typedef struct fg_round_end {
  double radius, half_width;      /* of the arc, and of the cut */
  double blur_along, blur_across; /* along the cut and across it */
} fg_round_end;

/* Returns the distance from a straight edge with the same light, positive in the void. */
double fg_round_end_distance(const fg_round_end *end, double u, double v);

#endif
