/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plots of a film. */
#ifndef FG_REPORT_FILM_PLOTS_H
#define FG_REPORT_FILM_PLOTS_H

#include "foilgauge/film.h"

void fg_film_plot_field(FILE *out, const fg_film_report *report); /* pressure, unwrapped */
void fg_film_plot_thickness(FILE *out, const fg_film_report *report);
void fg_film_plot_stability(FILE *out, const fg_film_report *report); /* critical mass over speed */
void fg_film_plot_coefficients(FILE *out, const fg_film_report *report, bool damping);
void fg_film_plot_orbit(FILE *out, const fg_film_report *report);

#endif
