/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields of the scanner that nobody has named: displacements at a place of the glass, per column,
 * and the variances of the columns for length i (fg_rival: `glass`, `variances`). */
#ifndef FG_EVIDENCE_GLASS_FIELDS_H
#define FG_EVIDENCE_GLASS_FIELDS_H

#include "rows/edge_fit.h"

/* Shifts in x or y over one axis. */
size_t fg_glass_x_over_x(const fg_field_frame *frame, fg_point at, fg_point *d);
size_t fg_glass_y_over_x(const fg_field_frame *frame, fg_point at, fg_point *d);
size_t fg_glass_x_over_y(const fg_field_frame *frame, fg_point at, fg_point *d);
size_t fg_glass_y_over_y(const fg_field_frame *frame, fg_point at, fg_point *d);
bool fg_glass_x_variances(const fg_edge_fit *edge_fit, size_t i, double *variance);
bool fg_glass_y_variances(const fg_edge_fit *edge_fit, size_t i, double *variance);

/* Lines of the picture, each moved by another amount along the carriage's way: stretched about
 * whatever point of theirs, or shifted both ways and turned, as the lines of a rigid bar. */
size_t fg_glass_stretched_lines(const fg_field_frame *frame, fg_point at, fg_point *d);
bool fg_glass_stretched_variances(const fg_edge_fit *edge_fit, size_t i, double *variance);
size_t fg_glass_rigid_lines(const fg_field_frame *frame, fg_point at, fg_point *d);
bool fg_glass_rigid_variances(const fg_edge_fit *edge_fit, size_t i, double *variance);

/* Polynomials over both axes. */
size_t fg_glass_plane(const fg_field_frame *frame, fg_point at, fg_point *d);
bool fg_glass_plane_variances(const fg_edge_fit *edge_fit, size_t i, double *variance);

/* Maps of the glass that one cause makes, fg_glass_map_columns columns each. */
size_t fg_glass_maps(const fg_field_frame *frame, fg_point at, fg_point *d);
bool fg_glass_map_variances(const fg_edge_fit *edge_fit, size_t i, double *variance);
size_t fg_glass_map_columns(const fg_edge_fit *edge_fit);

#endif
