/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Production lots: many scans to one report for acceptance by a customer.
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
 * The report is a function of the first four alone: it is computed from the recorded values, never
 * from values in memory. So a lot that was killed and resumed, or measured by any number of jobs
 * or shards, reads the same byte for byte.
 *
 * A record is valid while two sums stay the same: the SHA-256 of its scan, and that of its
 * settings (program version, design without tolerances, resolution, scanner's model). Its line
 * must be unchanged to the byte. --resume measures the others. */
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

/* Die that foils of a lot were pressed in, as `foilgauge die` measured it: the mean of its halves,
 * for the design's datum line. */
enum { FG_LOT_DIES_MAX = 12, FG_LOT_DIE_BUMPS_MAX = 64 };

typedef struct fg_lot_die_bump {
  int number;
  double radius_mm, u_radius_mm;
} fg_lot_die_bump;

typedef struct fg_lot_die {
  char name[64]; /* as the manifest's column has it */
  char sha256[65];
  fg_datum datum; /* datum of the design at its measurement */
  double thickness_mm;
  double radius_mm, u_radius_mm; /* mean over its bumps */
  fg_lot_die_bump bump[FG_LOT_DIE_BUMPS_MAX];
  size_t bump_count;
} fg_lot_die;

/* Reference curve: errors of every bump from a simulation or a die, drawn beside a lot's. */
enum { FG_LOT_CURVE_MAX = 64 };

typedef struct fg_lot_curve_point {
  int bump;
  double radius_error_pct, angle_error_pct; /* the second is that of the intersection angle */
} fg_lot_curve_point;

typedef struct fg_lot_curve {
  char name[64];                              /* name of its file */
  size_t count;                               /* 0: no curve */
  fg_lot_curve_point point[FG_LOT_CURVE_MAX]; /* sorted by bump */
} fg_lot_curve;

/* Settings of a lot: the members of a recipe file, "schema": "foilgauge/recipe/1". */
typedef struct fg_lot_settings {
  char name[128];   /* name of the lot in the report */
  fg_design design; /* "design": an object as in a design file, or the path of one */
  double dpi;       /* 0: as the files say */
  /* "calibration" of the recipe, which overrules the design's; not stated: the design's holds. */
  fg_calibration calibration;
  bool allow_lossy; /* accept scans that JPEG has compressed with loss, with wider uncertainties */
  /* Scanner's model that corrects every scan, "model" in a recipe: the path of its file; in the
   * lot's folder scanner_model.json. "": none. */
  char model[1024], model_sha256[65];
  unsigned jobs; /* scans at a time; 0: as many as the process has cores; never changes a result */
  double trim_pct; /* percentage cut off each tail before radius and angle errors are correlated */
  double confidence;           /* confidence of every interval */
  fg_bandwidth_rule bandwidth; /* "silverman", "scott", "sheather_jones" */
  size_t resamples;            /* number of values drawn from the kernel density */
  uint64_t seed;
  unsigned run_rules;       /* bits of control.h; in a recipe numbers of the rules: [1, 2, 3, 4] */
  char group_column[64];    /* column of the groups that are compared (die, coil ...); "": none */
  char part_column[64];     /* column of the part, for repeated scans */
  char operator_column[64]; /* column of the operator; a gauge study needs both */
  char bearing_column[64];  /* column of the bearing; missing: three foils in a row make one */
  char pad_column[64];      /* column of the pad, from 1 */
  /* pads, bumps_per_pad, first_bump, bump_pitch_deg. 0 (null in a recipe) means the design's bump
   * count and pitch, and as many pads as fit around. Pads and bumps_per_pad without a pitch are
   * equally spaced. */
  fg_bearing_layout layout;
  char die_column[64]; /* column of the die that a foil was pressed in */
  /* "dies" in a recipe: an object of names and paths of reports of `foilgauge die`, whose numbers
   * are kept in the lot's own recipe. They are the reference of springback beside the design. */
  fg_lot_die dies[FG_LOT_DIES_MAX];
  size_t die_count;
  fg_lot_curve curve; /* "reference_curve" in a recipe: the path of a CSV */
  /* Drawn bearings, "assembly": {"bearings", "seed", "design_deviation_pct"} in a recipe. */
  struct {
    size_t bearings; /* 0: draws none */
    uint64_t seed;
    double design_deviation_pct; /* deviation of the clearance, of the bearings of the design beside
                                    them */
  } assembly;
  fg_arch_material material; /* youngs_modulus_gpa, poisson_ratio, friction */
  /* Gas film of drawn bearings, "film" in a recipe (foilgauge/film.h); load_n 0: not asked. */
  struct {
    double load_n, load_deg, speed_rpm;
    double rotor_mass_kg; /* 0: the load's by gravity */
    double loss_factor, within_pct;
    size_t bearings, cells_per_bump, cells_axial;
    uint64_t seed;
  } film;
} fg_lot_settings;

void fg_lot_settings_default(fg_lot_settings *settings);

/* FG_ERR_DATA with the member, its value and the valid range. */
fg_status fg_lot_settings_check(fg_context *ctx, const fg_lot_settings *settings);

/* Loads a design in place of the recipe's; the recipe's own calibration stays. */
fg_status fg_lot_settings_load_design(fg_context *ctx, const char *path, fg_lot_settings *settings);

/* Loads a scanner's model, with its sum; unless NULL, `scanner` must be the name of its scanner. */
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

/* Formats the recipe: all of it, or without `jobs`, which changes nothing in a report. */
fg_status fg_lot_settings_format(fg_context *ctx, const fg_lot_settings *settings, bool with_jobs,
                                 char **json);

/* Scans with a page of their own, which is drawn while they are measured. A page is valid while
 * everything that it shows holds: scan, settings, the foil's name, tolerances. With `resume` a
 * missing page is drawn again, which measures the scan once more and keeps its record. */
typedef enum fg_lot_pages {
  FG_LOT_PAGES_ALL,
  FG_LOT_PAGES_BAD, /* those with a foil that does not pass */
  FG_LOT_PAGES_NONE,
} fg_lot_pages;

const char *fg_lot_pages_word(fg_lot_pages which); /* "all", "bad", "none" */

/* Part of the work: items i - 1, i - 1 + n, ... of the manifest; {1, 1} is all of it. */
typedef struct fg_lot_shard {
  size_t index, count;
} fg_lot_shard;

/* Progress of the work. Calls come one at a time, from any thread. */
typedef struct fg_lot_progress {
  size_t done, total, failed; /* `total` does not include kept scans */
  size_t kept;
  double seconds, seconds_left; /* seconds_left is NaN until it can be estimated */
  const char *scan;             /* scan just finished */
  const char *error;            /* reason why it could not be measured, or NULL */
} fg_lot_progress;
typedef void fg_lot_listener(void *user, const fg_lot_progress *progress);

typedef struct fg_lot_request {
  const fg_lot_settings *settings;
  const char *const *paths; /* folders, scans, lists (.txt: a path a line), manifests (.csv with a
                               column `scan`); relative paths in a file count from its folder.
                                With `resume`, the folder's own manifest.csv, whose paths
                                count from where they did */
  size_t path_count;
  const char *folder; /* of the results; FG_ERR_USAGE when a file of it would overwrite an input */
  const char *recipe, *design; /* files that the settings came from; NULL: none */
  bool resume;        /* keep valid records; without it a folder with results is FG_ERR_USAGE */
  bool dry_run;       /* list the scans to measure, and touch nothing */
  bool decimal_comma; /* tables of the report have decimal commas (fg_csv_write); the copy of the
                         manifest has not */
  fg_lot_pages pages;
  fg_lot_shard shard;
  fg_lot_listener *listener; /* may be NULL */
  void *user;
} fg_lot_request;

/* Number of things of a kind that a run met, and the first of them in words. */
typedef struct fg_lot_finding {
  size_t count;
  char first[1024]; /* "": none */
} fg_lot_finding;

/* Scans of the lot, or of the shard. */
typedef struct fg_lot_scans {
  size_t count;
  size_t to_measure, kept; /* without a valid record, with one */
  size_t measured, failed; /* in this run; failed: could not be measured */
  size_t redrawn;          /* kept scans whose pages are drawn again */
  fg_lot_finding missing;  /* scans without file and record; not in to_measure */
} fg_lot_scans;

/* Foils or bearings of the lot, and how many have each verdict. */
typedef struct fg_lot_verdicts {
  size_t count, by_verdict[FG_VERDICT_NONE + 1];
} fg_lot_verdicts;

/* Oddities of the inputs and of earlier results, for the reader of a report. */
typedef struct fg_lot_notes {
  fg_lot_finding invalid_dates; /* cells of the manifest's column `date` that are no date; the
                                   column is ignored then */
  fg_lot_finding named_again;   /* scans that were named again, under any spelling; they count once;
                                   `first`: the name under which it counts, too */
  fg_lot_finding repeated;      /* scans with the bytes of an earlier one under another name; they
                                   count as not measured */
  fg_lot_finding empty_folders; /* empty folders whose name ends as a scan's does */
  fg_lot_finding undrawn_pages; /* pages whose scan could not be read again */
  size_t damaged_lines;         /* of results.jsonl: damaged or incomplete, measured again */
  size_t first_damaged_line;    /* from 1 */
  size_t beyond_model;          /* scans measured now that reach beyond the region of the scanner's
                                   model */
  bool earlier_version;         /* results.jsonl was of one: everything is measured again */
} fg_lot_notes;

enum { FG_LOT_TRACED = 400 };

typedef struct fg_lot_outcome {
  fg_report_outcome judged; /* judgement of all foils, scans, bearings; fg_outcome_exit_code */
  fg_lot_scans scans;
  fg_lot_verdicts foils, bearings;
  bool bearings_judged;       /* the design states tolerances of a bearing */
  size_t exceeded;            /* foils with a value that fails */
  char traced[FG_LOT_TRACED]; /* the verdicts' basis: a state of traceability, with its reason */
  char assembly[4][400]; /* drawn bearings in words, last the limits of their evidence; "": none
                            drawn */
  fg_lot_notes notes;
} fg_lot_outcome;

/* Measures missing scans and writes the report of a whole lot. A scan that cannot be measured is a
 * record with its error, never the end. FG_ERR_IO when a record cannot be kept (disk full: earlier
 * records stay valid) or when another run works in the folder. */
fg_status fg_lot_run(fg_context *ctx, const fg_lot_request *request, fg_lot_outcome *outcome);

/* Merges shards into one lot. FG_ERR_DATA when recipes, manifests or versions differ, a shard is
 * missing or there twice, or a record is missing. */
fg_status fg_lot_merge(fg_context *ctx, const char *const *folders, size_t count,
                       const char *folder, bool decimal_comma, fg_lot_outcome *outcome);

/* Lots over time and against each other, read from lot.json, foils.csv and bumps.csv of their
 * folders. */
typedef struct fg_lot_index_request {
  const char *const *folders;
  size_t count;
  const char *page;       /* links are relative to it */
  const char *json, *csv; /* "foilgauge/lot_index/1", and a line per lot and quantity; NULL: none */
  bool decimal_comma;     /* the csv has decimal commas (fg_csv_write) */
} fg_lot_index_request;

typedef struct fg_lot_index_outcome {
  size_t lots, not_read; /* lots that could and could not be read; the page says why */
  size_t differing;      /* differing pairs of lots, in all quantities */
  char *summary, *notes; /* lines; NULL: none */
} fg_lot_index_outcome;

/* FG_ERR_USAGE when an output would overwrite a report of a lot; FG_ERR_DATA, with the defect of
 * the first, when no lot can be read. */
fg_status fg_lot_index(fg_context *ctx, const fg_lot_index_request *request,
                       fg_lot_index_outcome *outcome);
void fg_lot_index_outcome_free(fg_lot_index_outcome *outcome);

#ifdef __cplusplus
}
#endif
#endif
