/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The inspection station: a watched folder, a database of everything that was measured in it, and
 * pages in a browser.
 *
 * A scan that appears in the folder and is whole is measured and judged as `foilgauge lot` does it,
 * and kept with every quantity, its standard uncertainty, the verdict and its reasons in one SQLite
 * database, FG_STATION_DATABASE, in the folder. The scan itself is never touched. What is no scan,
 * is not whole or cannot be read is kept too, as a card with what is wrong.
 *
 * What is kept is kept in one transaction: a program that is killed has kept all of a scan or
 * nothing, and what it had not kept it finds in the folder when it starts again.
 */
#ifndef FOILGAUGE_STATION_H
#define FOILGAUGE_STATION_H

#include "foilgauge/lot.h"

#ifdef __cplusplus
extern "C" {
#endif

#define FG_STATION_DATABASE "foilgauge.sqlite"

/* When the scanner has to prove itself with a plate or ring of known diameters (`design`: a file
 * of the form discs). */
typedef struct fg_station_check {
  char design[1024];    /* path, relative to the recipe; "": no check is asked for */
  char file_name[256];  /* as that of foils; what is called so is a check. "check*" */
  double every_h;       /* 0: whenever somebody likes */
  double scale_max_ppm; /* a scale further from 1 fails */
  bool withhold;        /* past due, or failed: no verdict */
} fg_station_check;

typedef struct fg_station_settings {
  fg_lot_settings lot; /* of the whole recipe: design, model, dpi, run rules, bearings ... */
  /* How files are called: text, `*` for anything, and {serial}, {lot}, {die}, {operator}, {check};
   * without its ending. "{serial}" unless the recipe says otherwise. */
  char file_name[256];
  /* Run by /bin/sh in the folder when somebody presses Scan; {file} is the scan to write. It is
   * hidden until the command has ended well, then called station-DATE-TIME.png (.tif, .pnm where
   * the command names that). "": none. */
  char scan_command[1024];
  /* Time after its last change in which an incomplete file may still grow; then the station reports
   * the missing part. */
  double receive_s;
  fg_station_check check;
} fg_station_settings;

/* A recipe of lots with a member `station` {"file_name", "scan_command", "check": {"design",
 * "file_name", "every_h", "scale_max_ppm", "withhold"}}; NULL: no recipe. FG_ERR_DATA names the
 * member. */
fg_status fg_station_settings_load(fg_context *ctx, const char *recipe, const char *design,
                                   fg_station_settings *settings);

typedef struct fg_station_request {
  const char *folder;
  const fg_station_settings *settings;
  bool once; /* measure what is new, and return */
  const char
      *export_path;   /* write the lots of the database as folders below this one, and return */
  bool decimal_comma; /* of the tables of lots that are closed or written (fg_csv_write) */
  double poll_s;      /* look every so many seconds (network folders); 0: be told by the system */
  const char *listen; /* address; NULL: 127.0.0.1 */
  unsigned port;      /* 0: one that is free */
  const char *token;  /* needed by every request; NULL: none (loopback only) */
  const char *const *hosts; /* further names that requests may be for, with or without a port */
  size_t host_count;
  const char *origin; /* "https://scanner.example.com": of a proxy before the pages; NULL: none */
  int end_descriptor; /* readable: the station ends, with FG_ERR_INTERRUPTED; 0: it is never told */
  /* Called when pages can be had, once for each of their addresses; and for every file that was
   * looked at. From any thread, one at a time; either may be NULL. */
  void (*ready)(void *user, const char *address);
  void (*looked_at)(void *user, const char *file, const char *words);
  void *user;
} fg_station_request;

typedef struct fg_station_outcome {
  size_t measured, known,
      refused;              /* files: scans measured; seen before; no scan, not whole, unreadable */
  fg_report_outcome judged; /* of the scans that were measured */
} fg_station_outcome;

/* FG_ERR_IO: another station is at work in the folder, the database cannot be written, the address
 * is taken. Without `once` and `export_path` it runs until `end_descriptor` is readable
 * (FG_ERR_INTERRUPTED). Its pages report failures meanwhile, and it tries again. */
fg_status fg_station_run(fg_context *ctx, const fg_station_request *request,
                         fg_station_outcome *outcome);

#ifdef __cplusplus
}
#endif
#endif
