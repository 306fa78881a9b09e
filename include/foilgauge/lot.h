/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Production lots: many scans to one report that a customer accepts.
 *
 * A lot is a folder:
 *   recipe.json     the settings in force (fg_lot_settings; without `jobs`)
 *   manifest.csv    every scan of the lot in its order, with the columns that it came with
 *   scanner_model.json   the scanner's model, where the lot is corrected by one
 *   results.jsonl   one line per measured scan, kept as it is made, with the date of its
 *                   file and a checksum of its own ("foilgauge/results/2")
 *   pages/          a page per scan: picture and report of its foils (fg_lot_pages)
 *   lot.json, foils.csv, bumps.csv, bearings.csv, index.html, results.qif, results.dfq   the report
 *
 * The report is a function of the first three alone: it is computed from the recorded values, never
 * from what happens to be in memory, so a lot that was killed and resumed, measured by any number
 * of jobs or in any number of shards reads byte for byte the same.
 *
 * A record is valid while the SHA-256 of its scan and of what it was measured with (program
 * version, design without tolerances, resolution, scanner's model) stay the same, and its line is
 * what was written, to the byte; --resume measures the rest.
 */
#ifndef FOILGAUGE_LOT_H
#define FOILGAUGE_LOT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "foilgauge/bearing.h"
#include "foilgauge/density.h"
#include "foilgauge/design.h"
#include "foilgauge/report.h"
#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What `foilgauge die` measured of a die that foils of a lot were pressed in: the mean of its
 * halves, of the design's datum line. */
enum { FG_LOT_DIES_MAX = 12, FG_LOT_DIE_BUMPS_MAX = 64 };

typedef struct fg_lot_die_bump {
  int number;
  double radius_mm, u_radius_mm;
} fg_lot_die_bump;

typedef struct fg_lot_die {
  char name[64]; /* as the manifest's column has it */
  char sha256[65];
  fg_datum datum; /* of the design that it was measured for */
  double thickness_mm;
  double radius_mm, u_radius_mm; /* mean of its bumps */
  fg_lot_die_bump bump[FG_LOT_DIE_BUMPS_MAX];
  size_t bump_count;
} fg_lot_die;

/* What a simulation or a die says of the errors of every bump, to be drawn beside a lot's. */
enum { FG_LOT_CURVE_MAX = 64 };

typedef struct fg_lot_curve_point {
  int bump;
  double radius_error_pct, angle_error_pct; /* the second of the intersection angle */
} fg_lot_curve_point;

typedef struct fg_lot_curve {
  char name[64];                              /* of its file */
  size_t count;                               /* 0: there is none */
  fg_lot_curve_point point[FG_LOT_CURVE_MAX]; /* bumps ascending */
} fg_lot_curve;

/* Every option of a lot: the members of a recipe file, "schema": "foilgauge/recipe/1". */
typedef struct fg_lot_settings {
  char name[128];   /* of the lot, as the report shows it */
  fg_design design; /* "design": an object as in a design file, or the path of one */
  double dpi;       /* 0: as the scans say */
  /* "calibration" of the recipe itself, which is the design's too then; not stated: as the design
   * says. */
  fg_calibration calibration;
  bool allow_lossy; /* take scans that JPEG has compressed with loss, with wider uncertainties */
  /* The scanner's model that corrects every scan, as "model" in a recipe: the path of its file; in
   * the lot's folder it is scanner_model.json. "": none. */
  char model[1024], model_sha256[65];
  unsigned jobs; /* scans at a time; 0: as many as the process has cores; never changes a result */
  double trim_pct;             /* cut off each tail before radius and angle errors are correlated */
  double confidence;           /* of every interval */
  fg_bandwidth_rule bandwidth; /* "silverman", "scott", "sheather_jones" */
  size_t resamples;            /* drawn from the kernel density */
  uint64_t seed;
  unsigned run_rules;       /* bits of control.h; in a recipe the rules' numbers: [1, 2, 3, 4] */
  char group_column[64];    /* lots are compared by this column (die, coil ...); "": none */
  char part_column[64];     /* repeated scans: the part, and ... */
  char operator_column[64]; /* ... who or what measured it; both needed for a gauge study */
  char bearing_column[64];  /* which bearing a foil goes into; without: three in a row make one */
  char pad_column[64];      /* and which of its pads it is, from 1 */
  /* pads, bumps_per_pad, first_bump, bump_pitch_deg. 0, in a recipe null: the design's bump count
   * and pitch, and as many pads as fit around; pads and bumps_per_pad without a pitch are equally
   * spaced. */
  fg_bearing_layout layout;
  char die_column[64]; /* which of the dies a foil was pressed in */
  /* "dies" in a recipe: an object of names and paths of reports of `foilgauge die`, whose numbers
   * stand in the lot's own recipe. They are the reference of springback beside the design. */
  fg_lot_die dies[FG_LOT_DIES_MAX];
  size_t die_count;
  fg_lot_curve curve; /* "reference_curve" in a recipe: the path of a CSV */
  /* Bearings drawn from the lot's foils, in a recipe "assembly": {"bearings", "seed",
   * "design_deviation_pct"}. */
  struct {
    size_t bearings; /* 0: none are drawn */
    uint64_t seed;
    double design_deviation_pct; /* of the clearance: of the bearings of the design beside them */
  } assembly;
  fg_arch_material material; /* youngs_modulus_gpa, poisson_ratio, friction */
} fg_lot_settings;

void fg_lot_settings_default(fg_lot_settings *settings);

/* FG_ERR_DATA with the member, its value and what would be right. */
fg_status fg_lot_settings_check(fg_context *ctx, const fg_lot_settings *settings);

/* The design of a file in place of the recipe's, under the recipe's own calibration. */
fg_status fg_lot_settings_load_design(fg_context *ctx, const char *path, fg_lot_settings *settings);

/* Sets the model and its sum; the file must be one, and the scanner's of that name unless NULL. */
fg_status fg_lot_settings_load_model(fg_context *ctx, const char *path, const char *scanner,
                                     fg_lot_settings *settings);

/* Adds a die from its report, the JSON of `foilgauge die`. */
fg_status fg_lot_settings_add_die(fg_context *ctx, const char *name, const char *path,
                                  fg_lot_settings *settings);

/* Sets the reference curve from a CSV with the columns bump, radius_error_pct and
 * intersection_angle_error_pct. */
fg_status fg_lot_settings_load_curve(fg_context *ctx, const char *path, fg_lot_settings *settings);

/* Reads a recipe; members that are absent keep their value. Paths are relative to the recipe. A
 * model that is not the one that the recipe states the sum of is FG_ERR_DATA; parsing alone does
 * not look for its file. */
fg_status fg_lot_settings_load(fg_context *ctx, const char *path, fg_lot_settings *settings);
fg_status fg_lot_settings_parse(fg_context *ctx, const char *path, const char *json,
                                fg_lot_settings *settings);

/* The recipe as text: all of it, or without `jobs`, which changes nothing in a report. */
fg_status fg_lot_settings_format(fg_context *ctx, const fg_lot_settings *settings, bool with_jobs,
                                 char **json);

/* Which scans get a page of their own, drawn while they are measured. A page holds while all that
 * it shows holds: its scan, what measured it, the foil's name, the tolerances. With `resume` what
 * is wanted and not there is drawn again, which measures the scan once more and keeps its record.
 */
typedef enum fg_lot_pages {
  FG_LOT_PAGES_ALL,
  FG_LOT_PAGES_BAD, /* those with a foil that does not pass */
  FG_LOT_PAGES_NONE,
} fg_lot_pages;

const char *fg_lot_pages_word(fg_lot_pages which); /* "all", "bad", "none" */

/* One part of the work: items i - 1, i - 1 + n, ... of the manifest; {1, 1} is all of it. */
typedef struct fg_lot_shard {
  size_t index, count;
} fg_lot_shard;

/* How far the work is. Calls come one at a time, from any thread. */
typedef struct fg_lot_progress {
  size_t done, total, failed; /* `total` leaves out what was kept from before */
  size_t kept;
  double seconds, seconds_left; /* left is NaN until it can be said */
  const char *scan;             /* just finished */
  const char *error;            /* why it could not be measured, or NULL */
} fg_lot_progress;
typedef void fg_lot_listener(void *user, const fg_lot_progress *progress);

typedef struct fg_lot_request {
  const fg_lot_settings *settings;
  const char *const *paths; /* folders, scans, lists (.txt: a path a line), manifests (.csv with a
                               column `scan`); relative paths in a file count from its folder.
                                With `resume`, the folder's own manifest.csv, whose paths
                                count from where they did */
  size_t path_count;
  const char *folder; /* of the results; none of its files may overwrite an input: FG_ERR_USAGE */
  const char *recipe, *design; /* the files that the settings came from; NULL: none */
  bool resume;        /* keep valid records; without it a folder with results is FG_ERR_USAGE */
  bool dry_run;       /* list the scans to measure, and touch nothing */
  bool decimal_comma; /* of the report's tables (fg_csv_write); not of its copy of the manifest */
  fg_lot_pages pages;
  fg_lot_shard shard;
  fg_lot_listener *listener; /* may be NULL */
  void *user;
} fg_lot_request;

typedef struct fg_lot_outcome {
  fg_report_outcome judged; /* of all foils, scans, bearings; fg_outcome_exit_code */
  size_t scans, to_measure, measured, failed, kept; /* scans; failed: could not be measured */
  size_t missing; /* scans without a record that are not there; not in to_measure */
  char first_missing[512];
  size_t redrawn;   /* kept scans whose pages are drawn again */
  size_t not_drawn; /* pages that could not be: the scan could not be read again */
  char first_not_drawn[512];
  size_t foils, foils_by_verdict[FG_VERDICT_NONE + 1];
  bool bearings_judged; /* the design states tolerances of a bearing */
  size_t bearings, bearings_by_verdict[FG_VERDICT_NONE + 1];
  char assembly[4][400]; /* drawn bearings in words, last what they do not tell; "": none drawn */
  size_t exceeded;       /* foils with a value that fails */
  size_t beyond;     /* scans measured now that reach beyond the region of the scanner's model */
  size_t torn;       /* lines of results.jsonl that were damaged or not whole, and measured again */
  size_t first_torn; /* the first of them, from 1 */
  size_t
      no_dates; /* cells of the manifest's column `date` that are no date: all of it is not taken */
  char first_no_date[64];
  size_t doubles; /* scans that were named once more, under whatever spelling, and count once */
  char first_double[512]; /* the first of them, with the name under which it counts */
  /* Scans with the bytes of an earlier one under another name: they count as not measured. */
  size_t repeated;
  char first_repeated[1024]; /* in words */
  size_t empty;              /* folders that are called as a scan is, and hold none */
  char first_empty[512];
  bool earlier; /* results.jsonl was of an earlier version: all of it is measured again */
} fg_lot_outcome;

/* Measures what is missing and, for the whole of a lot, writes the report. A scan that cannot be
 * measured is a record with its error, never the end. FG_ERR_IO when a record cannot be kept (disk
 * full: what was kept stays valid) or another run is at work in the folder. */
fg_status fg_lot_run(fg_context *ctx, const fg_lot_request *request, fg_lot_outcome *outcome);

/* Shards to one lot. FG_ERR_DATA when recipes, manifests or versions differ, a shard is missing or
 * there twice, a record is missing. */
fg_status fg_lot_merge(fg_context *ctx, const char *const *folders, size_t count,
                       const char *folder, bool decimal_comma, fg_lot_outcome *outcome);

/* Lots over time and against each other: from lot.json, foils.csv and bumps.csv of their folders.
 */
typedef struct fg_lot_index_request {
  const char *const *folders;
  size_t count;
  const char *page;       /* links are relative to it */
  const char *json, *csv; /* "foilgauge/lot_index/1", and a line per lot and quantity; NULL: none */
  bool decimal_comma;     /* of the csv (fg_csv_write) */
} fg_lot_index_request;

typedef struct fg_lot_index_outcome {
  size_t lots, not_read; /* the page says why these are not on it */
  size_t differing;      /* pairs of lots, in all quantities */
  char *summary, *notes; /* lines; NULL: none */
} fg_lot_index_outcome;

/* FG_ERR_USAGE when an output would overwrite a report of a lot; FG_ERR_DATA when no lot can be
 * read, with what is wrong with the first. */
fg_status fg_lot_index(fg_context *ctx, const fg_lot_index_request *request,
                       fg_lot_index_outcome *outcome);
void fg_lot_index_outcome_free(fg_lot_index_outcome *outcome);

#ifdef __cplusplus
}
#endif
#endif
