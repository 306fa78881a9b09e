/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loop on grids: what a scanner does to its bed, from scans of plates and boards.
 *
 * All marks are held against their board's lattice. What stays with the glass is the scanner:
 * listed effects first, then a smooth map for the rest. Residuals that turn with a board that is
 * scanned again belong to the board. Everything is one linear mixed model, whose prior sizes are
 * estimated by restricted likelihood, as astrometric plate solutions do it. */
#ifndef FOILGAUGE_GRID_LOOP_H
#define FOILGAUGE_GRID_LOOP_H

#include <stdio.h>

#include "foilgauge/measure.h"
#include "foilgauge/scan_loop.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { FG_GRID_CLAIMS = 16, FG_GRID_SCANS = 64, FG_GRID_WORDS = 400 };

typedef struct fg_grid_loop_options {
  double dpi;       /* 0: the files' own */
  bool allow_lossy; /* as in fg_measure_options */
  unsigned threads; /* 0: all cores */
  bool same_part;   /* all scans show one board, turned or moved in between */
  /* Quarter turns of every scan's board against the first scan's, from x towards y; -1: found by
   * what the pictures show. */
  int turns[FG_GRID_SCANS];
  bool hold_out[FG_GRID_SCANS]; /* scans that only confirm; one at least must be none */
  const char *scanner;          /* as in fg_scan_loop_options */
  int64_t date;
} fg_grid_loop_options;

typedef enum fg_grid_verdict {
  FG_GRID_FOUND,  /* its size exceeds its uncertainty by far */
  FG_GRID_TIED,   /* scanner or board: these scans cannot tell */
  FG_GRID_ABSENT, /* smaller than its uncertainty tells */
} fg_grid_verdict;

/* An effect of scanner or board. */
typedef struct fg_grid_claim {
  const char *id, *words; /* "scan.scale_y" */
  bool of_board;
  fg_grid_verdict verdict;
  double value, u; /* ratio, or um */
  bool ratio;      /* `value` is one */
  double shape;    /* period or place, mm; NaN: none */
  double z;        /* value over its uncertainty beside all other effects and the map */
} fg_grid_claim;

/* A place of the bed, with the displacement of the scanner. */
typedef struct fg_grid_map_point {
  fg_point at_mm, d_um, u_um;
} fg_grid_map_point;

typedef struct fg_grid_scan {
  const fg_measurement *measurement;
  int turn_deg;          /* of the board against the first scan; 0 without --same-part */
  fg_point *residual_mm; /* owned; of every mark after all corrections; NaN: not used */
} fg_grid_scan;

/* A scan that only confirms: errors of its marks, without and with the model of the others. */
typedef struct fg_grid_held_out {
  const fg_measurement *measurement;
  int turn_deg;
  double before_um, after_um; /* rms along one axis, of its marks in the region */
} fg_grid_held_out;

typedef struct fg_grid_loop_result {
  fg_grid_scan *scan;         /* owned */
  fg_grid_held_out *held_out; /* owned */
  size_t held_out_scans;
  size_t scans, boards, marks;
  bool turned;  /* scans of one board, turned by a quarter: scanner and board are told apart */
  double scale; /* of both axes, where boards tell it */
  bool scale_known, axes_known; /* by the boards' stated pitch, or (the axes) by turned scans */
  bool tied;
  fg_grid_claim claim[FG_GRID_CLAIMS];
  size_t claims;
  double axis_ratio, u_axis_ratio;   /* of the scanner: a length along x over the same along y */
  double board_ratio, u_board_ratio; /* of the first board */
  double mark_um;                    /* sd of a mark in one scan, from all residuals */
  double board_mark_um;              /* sd of the boards' marks; NaN: not told */
  double carriage_um;                /* random part, by the scans of one pose; NaN: not told */
  double map_um;                     /* rms of the map over the region; 0: none */
  double u_map_um;                   /* rms of its standard uncertainty */
  double board_map_um;               /* of the first board's own; 0: none */
  double before_um, after_um;        /* rms of all marks, each component */
  double held_out_before_um, held_out_after_um; /* of scans held out, else of marks in turn */
  double low_mm[2], high_mm[2];                 /* region */
  fg_grid_map_point *map;                       /* owned; row by row */
  size_t map_columns, map_rows;
  double wave_mm, short_wave_mm; /* a ripple in the model, and the one that the marks show as it; 0:
                                    none */
  double telling_turn_deg;       /* turn of the board that would tell these two apart */
  char sentence[FG_GRID_WORDS], advice[FG_GRID_WORDS];
} fg_grid_loop_result;

typedef struct fg_grid_loop fg_grid_loop;

/* FG_ERR_DATA when the scans do not fit together, or nothing tells how a board was turned. */
fg_status fg_grid_loop_run(fg_context *ctx, const char *const *paths, size_t count,
                           const fg_design *design, const fg_grid_loop_options *options,
                           fg_grid_loop **loop);
void fg_grid_loop_free(fg_grid_loop *loop);
const fg_grid_loop_result *fg_grid_loop_result_of(const fg_grid_loop *loop);

/* "foilgauge/grid-loop/1". */
fg_status fg_grid_loop_write_json(fg_context *ctx, const fg_grid_loop *loop, FILE *out);
fg_status fg_grid_loop_write_text(fg_context *ctx, const fg_grid_loop *loop, FILE *out);
fg_status fg_grid_loop_write_html(fg_context *ctx, const fg_grid_loop *loop, FILE *out);
/* "foilgauge/scan-model/1". */
fg_status fg_grid_loop_write_model(fg_context *ctx, const fg_grid_loop *loop, FILE *out);

#ifdef __cplusplus
}
#endif
#endif
