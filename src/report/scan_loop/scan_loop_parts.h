/* Parts of the page of the loop on scans. All write into an open <main>. */
#ifndef FG_REPORT_SCAN_LOOP_SCAN_LOOP_PARTS_H
#define FG_REPORT_SCAN_LOOP_SCAN_LOOP_PARTS_H

#include "report/measure/measure_page_parts.h"
#include "scan_loop/state.h"

/* ---- words (scan_loop_words.c) ---- */

/* The effects of one of several explanations as a sum of ids. */
void fg_scan_loop_explanation_name(const fg_explanations *explanations, size_t explanation,
                                   char *name, size_t size);

/* What an explanation shares with all others (`common`), or what it has of its own: "a together
 * with b".
 */
enum { FG_SCAN_LOOP_CLASS_WORDS = 512 };
void fg_scan_loop_explanation_words(const fg_explanations *explanations, size_t explanation,
                                    bool common, char *words, size_t size);

/* Parameter i of an effect with the name and unit that people read; false: there are no more. */
typedef struct fg_scan_loop_parameter {
  const char *name, *unit;
  double value, u;
} fg_scan_loop_parameter;
bool fg_effect_found_parameter(const fg_effect_found *effect, size_t i,
                               fg_scan_loop_parameter *parameter);

/* "0.0010003 ± 0.0000012": value and U = 2u, U with two digits. */
void fg_scan_loop_value_words(double value, double u, char *words, size_t size);

/* "0.0302 µm"; nm below a nanometre, so that figures beside each other have one unit. */
void fg_scan_loop_length_words(double um, char *words, size_t size);

/* The largest of 1, 2, 5 times a power of ten that is not above `most`. */
double fg_scan_loop_nice_below(double most);

/* The page's one sentence; the caller frees it. */
fg_status fg_scan_loop_sentence(fg_context *ctx, const fg_scan_loop *loop, char **text);

/* ---- what an effect does (scan_loop_curves.c) ---- */

/* The axis's name with its unit. */
const char *fg_scan_loop_coordinate_title(fg_effect_coordinate coordinate);

/* The deformation of the picture, curves over the coordinates, parameters. */
fg_status fg_scan_loop_page_effects(fg_context *ctx, FILE *out, const fg_scan_loop *loop);
void fg_scan_loop_page_grid(FILE *out, const fg_scan_loop *loop);

/* ---- residuals (scan_loop_vectors.c, scan_loop_plots.c) ---- */

fg_status fg_scan_loop_page_vectors(fg_context *ctx, FILE *out, const fg_scan_loop *loop);
fg_status fg_scan_loop_page_residuals(fg_context *ctx, FILE *out, const fg_scan_loop *loop);

/* Colour class of a scan's marks: "k0" to "k3", "k4" from the fifth on. */
const char *fg_scan_loop_colour(const fg_scan_loop *loop, size_t scan);

/* Rows up to this weight hardly take part: the edge of a disc that is not round. */
double fg_scan_light(const fg_points *points);

/* Size that all but `share` of |values| stay below, over rows that weigh; 0 without any. */
fg_status fg_scan_loop_residual_limit(fg_context *ctx, const fg_points *points,
                                      const double *values, double share, double *limit);

/* ---- dimensions (scan_loop_dimensions.c) ---- */

void fg_scan_loop_page_dimensions(FILE *out, const fg_scan_loop *loop);

/* ---- the bumps (scan_loop_bump_page.c) ---- */

/* Appends what was found over the bumps. */
fg_status fg_scan_loop_bumps_sentence(fg_context *ctx, const fg_scan_loop_bumps *bumps,
                                      char **text);
void fg_scan_loop_page_bumps(FILE *out, const fg_scan_loop_bumps *bumps);

#endif
