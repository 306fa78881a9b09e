/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loss of a JPEG, by its quantization tables. */
#ifndef FG_SCAN_JPEG_TABLES_H
#define FG_SCAN_JPEG_TABLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Number of steps that count, in zigzag order: the frequencies with u + v up to 6. A blurred edge
 * hardly has higher ones. */
enum { FG_JPEG_STEPS = 28 };

/* Reorders the steps of a table from natural order (8 u + v) to zigzag order. */
void fg_jpeg_to_zigzag(const uint16_t natural[64], uint16_t zigzag[64]);

/* Returns the quality of the Independent JPEG Group, 1 to 100, whose table of luminance has the
 * nearest root mean square of the steps that count. */
int fg_jpeg_quality_of(const uint16_t zigzag[64]);

/* Step of that quality at place i < FG_JPEG_STEPS in zigzag order, in gray values of 8 bits, and
 * its place 8 u + v, u along y. */
int fg_jpeg_step_at(int quality, int i);
int fg_jpeg_place_of(int i);

/* Root mean square of the steps that count, in gray values of 8 bits. */
double fg_jpeg_step_of(int quality);

/* Finds the first quantization table of a stream of markers (before the image, or in TIFF's tag
 * JPEGTables), in zigzag order; false: there is none. */
bool fg_jpeg_find_table(const uint8_t *bytes, size_t length, uint16_t zigzag[64]);

#endif
