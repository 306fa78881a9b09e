/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The inspection station: a watched folder, a database of all its measurements, and pages in a
 * browser.
 *
 * A scan that appears in the folder and is whole is measured and judged as `foilgauge lot` does
 * it, and kept with every quantity, its standard uncertainty, the verdict and its reasons in one
 * SQLite database, FG_STATION_DATABASE, in the folder. The scan itself is never touched. A file
 * that is no scan, is not whole or cannot be read is kept too, as a card with the fault. Each
 * scan is kept in one transaction: a program that is killed has kept all of a scan or nothing,
 * and finds the rest in the folder when it starts again. */
#ifndef FOILGAUGE_STATION_H
#define FOILGAUGE_STATION_H

#include "foilgauge/lot.h"

#ifdef __cplusplus
extern "C" {
#endif

#define FG_STATION_DATABASE "foilgauge.sqlite"

enum { FG_STATION_CONTEXTS = 8 }; /* maximum number of files that say more about foils */

/* The scanner's check with a plate or ring of known diameters (`design`: a file of the kind
 * discs). */
typedef struct fg_station_check {
  char design[1024];    /* path, relative to the recipe; "": no check is asked for */
  char file_name[256];  /* pattern like that of foils; a file so named is a check. "check*" */
  double every_h;       /* 0: at any time */
  double scale_max_ppm; /* the check fails when the scale differs from 1 by more */
  bool withhold;        /* an overdue or failed check withholds verdicts */
} fg_station_check;

enum { FG_STATION_DESTINATIONS = 8 }; /* maximum number of a recipe */

/* Form in which a part is passed on. */
typedef enum fg_part_format {
  FG_PART_JSON,
  FG_PART_CSV,       /* a line of the foil */
  FG_PART_BUMPS_CSV, /* a line per bump or beam */
  FG_PART_DFQ,
  FG_PART_QIF
} fg_part_format;

/* Receiver of every part, as it is measured, corrected and disposed. */
typedef struct fg_station_destination {
  char to[1024];         /* folder (relative to the recipe), http://…, https://…, mqtt://… */
  char token_file[1024]; /* path, relative to the recipe: what the receiver must be told; "" */
  fg_part_format format;
} fg_station_destination;

/* Backups of the database, without stopping the station. */
typedef struct fg_station_backup {
  char folder[1024]; /* path, relative to the recipe; "": none are made */
  double every_h;
  double keep_days; /* older ones are removed, but never the newest; 0: none is */
} fg_station_backup;

enum { FG_STATION_PARTS = 16 }; /* maximum number of parts with a recipe of their own */

/* A part that orders name, and the recipe by which its scans are measured and judged. */
typedef struct fg_station_part {
  char part[128];
  char recipe[1024]; /* path, relative to the station's recipe */
} fg_station_part;

typedef struct fg_station_settings {
  fg_lot_settings lot; /* of the whole recipe: design, model, dpi, run rules, bearings ... */
  /* Pattern of file names: text, `*` for anything, and {serial}, {lot}, {die}, {operator},
   * {coil}, {oven}, {scanner}, {check}; without its ending. "{serial}" unless the recipe says
   * otherwise. */
  char file_name[256];
  /* Run by /bin/sh in the folder when somebody presses Scan; {file} is the scan to write. It is
   * hidden until the command has ended well, then called station-DATE-TIME.png (.tif, .pnm where
   * the command names that). "": none. */
  char scan_command[1024];
  /* Time after its last change in which an incomplete file may still grow; then the station reports
   * the missing part. */
  double receive_s;
  char reasons[1024]; /* codes that a disposition's field proposes, between commas */
  char language[16];  /* of the pages: "de"; "": as the browser asks */
  fg_station_check check;
  fg_station_part parts[FG_STATION_PARTS];
  size_t part_count;
  fg_station_destination pass_on[FG_STATION_DESTINATIONS];
  size_t pass_on_count;
  fg_station_backup backup;
} fg_station_settings;

/* A recipe of lots with a member `station` {"file_name", "scan_command", "check": {"design",
 * "file_name", "every_h", "scale_max_ppm", "withhold"}}; NULL: no recipe. FG_ERR_DATA names the
 * member. */
fg_status fg_station_settings_load(fg_context *ctx, const char *recipe, const char *design,
                                   fg_station_settings *settings);

typedef struct fg_station_request {
  const char *folder;
  const fg_station_settings *settings;
  bool once;               /* measure new files, and return */
  const char *export_path; /* export the database's lots as folders below this one, and return */
  const char *orders;      /* CSV file, or folder of such, of an ERP's orders; NULL: none */
  bool digest; /* write what changed, is suspected and was found to standard output, and return */
  const char *digest_page; /* and as a page into this file; NULL: no page */
  bool decimal_comma;      /* in CSV of lots that are closed or exported (fg_csv_write) */
  double poll_s;      /* poll every `poll_s` seconds (network folders); 0: the system notifies */
  const char *listen; /* address; NULL: 127.0.0.1 */
  unsigned port;      /* 0: any free port */
  const char *name;   /* of the station, for receivers of parts; NULL: the machine's */
  const char *hub;    /* address of a hub that gets all parts; NULL: none */
  const char *hub_token_file;
  const char *backup_path;  /* write a backup of the database there, and return */
  const char *restore_path; /* put this backup in the place of the database, and return */
  const char *users;        /* file of users with roles and tokens; NULL: who may ask may do all */
  const char *user_header;  /* header by which a proxy names the user; NULL: none */
  const char *token;        /* needed by every request; NULL: none (loopback only) */
  const char *const *hosts; /* further host names that requests may use, with or without a port */
  size_t host_count;
  /* CSV files with further columns of foils, by a column `serial` or `time`: candidates for causes.
   */
  const char *const *contexts;
  size_t context_count;
  const char
      *origin; /* of a proxy in front of the pages, "https://scanner.example.com"; NULL: none */
  int end_descriptor; /* the station ends when it is readable, with FG_ERR_INTERRUPTED; 0: none */
  /* Callbacks: `ready` when pages are served, once for each address; `looked_at` for every file
   * that was read. They are called from any thread, one at a time; either may be NULL. */
  void (*ready)(void *user, const char *address);
  void (*looked_at)(void *user, const char *file, const char *words);
  void *user;
} fg_station_request;

typedef struct fg_station_outcome {
  size_t measured, known,
      refused;              /* files: scans measured; seen before; no scan, not whole, unreadable */
  fg_report_outcome judged; /* of the scans that were measured */
} fg_station_outcome;

/* Runs a hub, which shows the parts of stations that send them there: its database is a file of
 * SQLite, or "postgresql://…". Of `pages` counts all about addresses, tokens and the end; with
 * an `export_path` the parts are written there as CSV, and nothing is served. */
fg_status fg_hub_run(fg_context *ctx, const char *database, const fg_station_request *pages);

/* Runs the station. FG_ERR_IO: another station runs in the folder, the database cannot be
 * written, the address is taken. Without `once` and `export_path` it runs until `end_descriptor`
 * is readable (FG_ERR_INTERRUPTED). Its pages report failures meanwhile, and it tries again. */
fg_status fg_station_run(fg_context *ctx, const fg_station_request *request,
                         fg_station_outcome *outcome);

#ifdef __cplusplus
}
#endif
#endif
