/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cross-section of the strip: its layers through half the thickness (the other half mirrors them),
 * from bent to released. All values are magnitudes; the caller knows the side of the bend and adds
 * the sign. */
#ifndef FG_FORMING_SECTION_H
#define FG_FORMING_SECTION_H

#include "foilgauge/forming.h"

/* Layers of equal thickness, each represented by its middle, and the face without a weight. */
typedef struct fg_section {
  size_t layers;
  double thickness_mm, curvature;
  double *elastic, *plastic; /* layers + 1: strain; owned, `plastic` within the same block */
} fg_section;

fg_status fg_section_make(fg_context *ctx, double thickness_mm, size_t layers, fg_section *section);
void fg_section_free(fg_section *section);

double fg_section_plane_modulus(const fg_forming_material *material, double temperature_C);
/* Returns the yield stress over that at 20 degrees C; NaN beyond the material's curve. */
double fg_section_yield_share(const fg_forming_material *material, double temperature_C);

/* Bends the flat section at 20 degrees C. */
void fg_section_bend(const fg_forming_material *material, double curvature, fg_section *section);
/* Treats the section at constant curvature. */
void fg_section_treat(const fg_forming_material *material, const fg_forming_schedule *schedule,
                      size_t steps, fg_section *section);
/* Bending moment per mm of width at a temperature, N. */
double fg_section_moment(const fg_forming_material *material, double temperature_C,
                         const fg_section *section);
/* E' I per mm of width, N mm, summed over these layers, so that an elastic bend is released
 * completely. */
double fg_section_stiffness(const fg_forming_material *material, const fg_section *section);
/* At the face, MPa. */
double fg_section_face_stress(const fg_forming_material *material, double temperature_C,
                              const fg_section *section);
/* Returns true when a layer's stress after a change of curvature by -change exceeds its yield
 * stress. */
bool fg_section_yields_back(const fg_forming_material *material, double change,
                            const fg_section *section);

#endif
