/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/database.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "core/date.h"
#include "core/text.h"
#include "foilgauge/station.h"
#include "station/stored_name.h"

/* Each step brings a database from one version to the next; a released step is never changed. */
static const char *const migrations[] = {
    /* Settings with which scans were measured and judged. */
    "CREATE TABLE setups (id INTEGER PRIMARY KEY, sha256 TEXT NOT NULL UNIQUE, program TEXT NOT "
    "NULL,"
    " recipe TEXT NOT NULL, model TEXT, model_sha256 TEXT, first_at INTEGER NOT NULL);"
    /* Every scan that was measured, or read and found not to be measurable. */
    "CREATE TABLE scans (id INTEGER PRIMARY KEY AUTOINCREMENT, sha256 TEXT NOT NULL UNIQUE,"
    " setup INTEGER NOT NULL REFERENCES setups, path TEXT NOT NULL, source TEXT NOT NULL,"
    " at INTEGER NOT NULL, dpi_x REAL, dpi_y REAL, width_px INTEGER, height_px INTEGER,"
    " verdict TEXT NOT NULL, withheld TEXT, error TEXT, record TEXT, seconds REAL);"
    "CREATE TABLE foils (id INTEGER PRIMARY KEY AUTOINCREMENT, scan INTEGER NOT NULL REFERENCES "
    "scans,"
    " number INTEGER NOT NULL, serial TEXT NOT NULL, lot TEXT NOT NULL, die TEXT NOT NULL,"
    " operator TEXT NOT NULL, verdict TEXT NOT NULL, reasons TEXT NOT NULL, UNIQUE (scan, number));"
    "CREATE INDEX foils_by_serial ON foils (serial, lot, scan);"
    "CREATE INDEX foils_by_lot ON foils (lot);"
    "CREATE INDEX foils_by_die ON foils (die);"
    "CREATE TABLE bumps (foil INTEGER NOT NULL REFERENCES foils, number INTEGER NOT NULL,"
    " verdict TEXT NOT NULL, flags TEXT NOT NULL, PRIMARY KEY (foil, number)) WITHOUT ROWID;"
    /* Trends leave out crushed bumps: they are few, and this index finds them without reading
     * the others. */
    "CREATE INDEX bumps_flagged ON bumps (foil, number) WHERE flags <> '';"
    "CREATE TABLE quantities (id INTEGER PRIMARY KEY, owner TEXT NOT NULL, name TEXT NOT NULL,"
    " unit TEXT NOT NULL, UNIQUE (owner, name));"
    /* bump 0: the whole foil. */
    "CREATE TABLE measured (quantity INTEGER NOT NULL REFERENCES quantities,"
    " foil INTEGER NOT NULL REFERENCES foils, bump INTEGER NOT NULL, value REAL, u REAL,"
    " PRIMARY KEY (quantity, foil, bump)) WITHOUT ROWID;"
    /* The values that decided, the worst first. */
    "CREATE TABLE deciding (foil INTEGER NOT NULL REFERENCES foils, rank INTEGER NOT NULL,"
    " quantity INTEGER NOT NULL REFERENCES quantities, bump INTEGER NOT NULL, value REAL, u REAL,"
    " lower REAL, upper REAL, verdict TEXT NOT NULL, PRIMARY KEY (foil, rank)) WITHOUT ROWID;"
    /* Pictures of the newest foils, as HTML. */
    "CREATE TABLE pictures (foil INTEGER PRIMARY KEY REFERENCES foils, html TEXT NOT NULL);"
    /* A card for every file that was inspected; the newest of a path is valid. */
    "CREATE TABLE arrivals (id INTEGER PRIMARY KEY AUTOINCREMENT, at INTEGER NOT NULL,"
    " path TEXT NOT NULL, kind TEXT NOT NULL, message TEXT NOT NULL, scan INTEGER REFERENCES scans,"
    " superseded INTEGER NOT NULL DEFAULT 0);"
    "CREATE TABLE files (path TEXT PRIMARY KEY, bytes INTEGER NOT NULL, modified_ns INTEGER NOT "
    "NULL,"
    " arrival INTEGER NOT NULL REFERENCES arrivals) WITHOUT ROWID;"
    /* Corrections of foils: author, field, time. */
    "CREATE TABLE corrections (id INTEGER PRIMARY KEY AUTOINCREMENT, foil INTEGER NOT NULL "
    "REFERENCES"
    " foils, field TEXT NOT NULL, before TEXT NOT NULL, after TEXT NOT NULL, by TEXT NOT NULL,"
    " at INTEGER NOT NULL);"
    "CREATE INDEX corrections_by_foil ON corrections (foil);"
    /* The scanner against a plate or ring of known diameters: scale_x and scale_y are measured over
     * true, less 1; shear is by how much the scanner shows a right angle between +x and +y too
     * small, in radians. */
    "CREATE TABLE checks (id INTEGER PRIMARY KEY AUTOINCREMENT, at INTEGER NOT NULL, path TEXT NOT "
    "NULL,"
    " sha256 TEXT NOT NULL UNIQUE, discs INTEGER NOT NULL, scale_x REAL, u_scale_x REAL, scale_y "
    "REAL,"
    " u_scale_y REAL, shear REAL, u_shear REAL, verdict TEXT NOT NULL, words TEXT NOT NULL);"
    /* Every time that a lot was closed: the newest of a name is in force. */
    "CREATE TABLE lots (id INTEGER PRIMARY KEY AUTOINCREMENT, name TEXT NOT NULL,"
    " closed_at INTEGER NOT NULL, by TEXT NOT NULL, folder TEXT NOT NULL, verdict TEXT NOT NULL,"
    " withheld INTEGER NOT NULL, summary TEXT NOT NULL, state TEXT NOT NULL);"
    "CREATE INDEX lots_by_name ON lots (name);",
    /* Names and words are UTF-8: before, they were whatever bytes a file's name had. */
    "UPDATE scans SET path = stored_name(path) WHERE path <> stored_name(path);"
    "UPDATE files SET path = stored_name(path) WHERE path <> stored_name(path);"
    "UPDATE arrivals SET path = stored_name(path) WHERE path <> stored_name(path);"
    "UPDATE arrivals SET message = stored_name(message) WHERE message <> stored_name(message);"
    "UPDATE checks SET path = stored_name(path) WHERE path <> stored_name(path);"
    "UPDATE checks SET words = stored_name(words) WHERE words <> stored_name(words);",
    /* Tone, sharpening and blur of a check, against the last check of this resolution
     * that was accepted as baseline; changes: in words, '' where there are none. */
    "ALTER TABLE checks ADD COLUMN dpi INTEGER;"
    "ALTER TABLE checks ADD COLUMN findings TEXT NOT NULL DEFAULT '';"
    "ALTER TABLE checks ADD COLUMN baseline INTEGER NOT NULL DEFAULT 0;"
    "ALTER TABLE checks ADD COLUMN changes TEXT NOT NULL DEFAULT '';"
    "CREATE TABLE check_values (check_id INTEGER NOT NULL REFERENCES checks, name TEXT NOT NULL,"
    " value REAL, u REAL, PRIMARY KEY (check_id, name)) WITHOUT ROWID;",
    /* Further data that foils have in common, and accepted causes: `name` is a column of foils or
     * of a context, a point is a level of it, or a place of a piecewise linear curve over it
     * (`time`: days since 1970, local time). A cause is withdrawn, never deleted: the trail keeps
     * it. */
    "ALTER TABLE foils ADD COLUMN coil TEXT NOT NULL DEFAULT '';"
    "ALTER TABLE foils ADD COLUMN oven TEXT NOT NULL DEFAULT '';"
    "ALTER TABLE foils ADD COLUMN scanner TEXT NOT NULL DEFAULT '';"
    "CREATE TABLE causes (id INTEGER PRIMARY KEY AUTOINCREMENT, owner TEXT NOT NULL,"
    " quantity TEXT NOT NULL, bump INTEGER NOT NULL, name TEXT NOT NULL, words TEXT NOT NULL,"
    " value REAL NOT NULL, u REAL, since INTEGER NOT NULL, by TEXT NOT NULL, at INTEGER NOT NULL,"
    " note TEXT NOT NULL, withdrawn_by TEXT NOT NULL DEFAULT '', withdrawn_at INTEGER NOT NULL "
    "DEFAULT 0);"
    "CREATE INDEX causes_by_quantity ON causes (owner, quantity, bump);"
    "CREATE TABLE cause_points (cause INTEGER NOT NULL REFERENCES causes, number INTEGER NOT NULL,"
    " level TEXT NOT NULL, x REAL, shift REAL NOT NULL, PRIMARY KEY (cause, number)) WITHOUT "
    "ROWID;",
    /* Orders; the open one is that which was opened last. Dispositions of foils that did not pass:
     * the newest of a foil is in force. */
    "CREATE TABLE orders (id INTEGER PRIMARY KEY AUTOINCREMENT, number TEXT NOT NULL UNIQUE,"
    " part TEXT NOT NULL, lot TEXT NOT NULL, die TEXT NOT NULL, coil TEXT NOT NULL,"
    " operator TEXT NOT NULL, pieces INTEGER NOT NULL, opened_at INTEGER NOT NULL,"
    " closed_at INTEGER NOT NULL DEFAULT 0, closed_by TEXT NOT NULL DEFAULT '');"
    "ALTER TABLE foils ADD COLUMN order_id INTEGER NOT NULL DEFAULT 0;"
    "CREATE INDEX foils_by_order ON foils (order_id) WHERE order_id <> 0;"
    "CREATE TABLE dispositions (id INTEGER PRIMARY KEY AUTOINCREMENT, foil INTEGER NOT NULL"
    " REFERENCES foils, kind TEXT NOT NULL, reason TEXT NOT NULL, note TEXT NOT NULL,"
    " by TEXT NOT NULL, at INTEGER NOT NULL);"
    "CREATE INDEX dispositions_by_foil ON dispositions (foil);",
    /* Foils that did not pass are few: this index finds the open ones. */
    "CREATE INDEX foils_not_passed ON foils (id) WHERE verdict IN ('fail', 'cannot_tell',"
    " 'not_measured');",
    /* Everything that befell a foil, in order, with its names of then; receivers get one after the
     * other. `passed`: the last event that arrived; `prepared`: one that lies in a folder under a
     * hidden name. The identity, with the event's number, is a part's key for receivers. */
    "CREATE TABLE identity (id TEXT NOT NULL);"
    "INSERT INTO identity VALUES (lower(hex(randomblob(16))));"
    "CREATE TABLE events (id INTEGER PRIMARY KEY AUTOINCREMENT, at INTEGER NOT NULL,"
    " kind TEXT NOT NULL, foil INTEGER NOT NULL REFERENCES foils, serial TEXT NOT NULL,"
    " lot TEXT NOT NULL, die TEXT NOT NULL, operator TEXT NOT NULL,"
    " disposition INTEGER NOT NULL DEFAULT 0);"
    "INSERT INTO events (at, kind, foil, serial, lot, die, operator, disposition)"
    " SELECT scans.at, 'measured', foils.id, serial, lot, die, operator,"
    " coalesce((SELECT max(id) FROM dispositions WHERE foil = foils.id), 0)"
    " FROM foils JOIN scans ON scans.id = scan ORDER BY foils.id;"
    "CREATE TABLE destinations (name TEXT PRIMARY KEY, passed INTEGER NOT NULL,"
    " prepared INTEGER NOT NULL DEFAULT 0, passed_at INTEGER NOT NULL DEFAULT 0,"
    " count INTEGER NOT NULL DEFAULT 0) WITHOUT ROWID;",
    /* Actions of known users. */
    "CREATE TABLE trail (id INTEGER PRIMARY KEY AUTOINCREMENT, at INTEGER NOT NULL,"
    " user TEXT NOT NULL, action TEXT NOT NULL, subject TEXT NOT NULL, refused TEXT NOT NULL);",
};

enum { VERSION = sizeof migrations / sizeof *migrations, BUSY_MS = 5000, IN_FILE_EVERY_S = 5 };

int64_t fg_station_now(void) {
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

/* fg_stored_name in SQL, for migrations. */
static void store_name(sqlite3_context *call, int count, sqlite3_value **values) {
  char *stored;
  const unsigned char *name = count ? fg_sqlite.value_text(values[0]) : NULL;
  if (!name) return;
  if (fg_stored_name(NULL, (const char *)name, &stored) != FG_OK)
    fg_sqlite.result_error_nomem(call);
  else
    fg_sqlite.result_text(call, stored, -1, free);
}

/* journal_size_limit: a journal that a large transaction or a slow reader made large shrinks
 * again. */
static fg_status open_connection(fg_context *ctx, const char *path, bool write,
                                 sqlite3 **connection) {
  int flags = write ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READWRITE;
  const char *settings = write ? "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL;"
                                 "PRAGMA foreign_keys = ON; PRAGMA journal_size_limit = 8388608;"
                               : "PRAGMA query_only = ON;";
  FG_TRY(fg_sql_open(ctx, path, flags | SQLITE_OPEN_NOMUTEX, connection));
  fg_sqlite.busy_timeout(*connection, BUSY_MS);
  if (write && fg_sqlite.create_function(*connection, "stored_name", 1,
                                         SQLITE_UTF8 | SQLITE_DETERMINISTIC | SQLITE_DIRECTONLY,
                                         NULL, store_name, NULL, NULL) != SQLITE_OK)
    return fg_sql_fail(ctx, *connection, path);
  if (fg_sqlite.exec(*connection, settings, NULL, NULL, NULL) == SQLITE_OK) return FG_OK;
  return fg_sql_fail(ctx, *connection, path);
}

static fg_status read_version(fg_context *ctx, const fg_station_database *database, int *version) {
  fg_query query;
  fg_query_begin(database->writer, "PRAGMA user_version", &query);
  *version = fg_query_row(&query) ? (int)fg_query_get_integer(&query, 0) : 0;
  return fg_query_end(ctx, &query, database->path);
}

/* A database of version 0 with tables is another program's: it only has our name. */
static fg_status check_empty(fg_context *ctx, const fg_station_database *database) {
  fg_query query;
  fg_query_begin(database->writer, "SELECT 1 FROM sqlite_schema LIMIT 1", &query);
  bool used = fg_query_row(&query);
  FG_TRY(fg_query_end(ctx, &query, database->path));
  if (!used) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA, "%s: is the database of another program: put it elsewhere",
                 database->path);
}

static fg_status migrate(fg_context *ctx, fg_station_database *database) {
  int version;
  char *step = NULL;
  FG_TRY(read_version(ctx, database, &version));
  if (version < 0)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: the database has version %d, which no program writes: put it elsewhere, or "
                   "take it from a backup",
                   database->path, version);
  if (version > VERSION)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: the database has version %d, of a later program; this one knows version %d",
                   database->path, version, VERSION);
  if (version == 0) FG_TRY(check_empty(ctx, database));
  for (; version < VERSION; version++) {
    FG_TRY(fg_text_print(ctx, &step, "BEGIN IMMEDIATE;%s PRAGMA user_version = %d; COMMIT;",
                         migrations[version], version + 1));
    bool done = fg_sqlite.exec(database->writer, step, NULL, NULL, NULL) == SQLITE_OK;
    free(step);
    if (!done) return fg_sql_fail(ctx, database->writer, database->path);
  }
  return FG_OK;
}

static fg_status find_file(fg_context *ctx, fg_station_database *database) {
  struct stat file;
  if (stat(database->path, &file) != 0)
    return fg_fail(ctx, FG_ERR_IO,
                   "%s: was removed while it was opened: does another program tidy the folder?",
                   database->path);
  database->device = file.st_dev;
  database->inode = file.st_ino;
  return FG_OK;
}

static fg_status open_both(fg_context *ctx, const char *folder, fg_station_database *database) {
  FG_TRY(fg_text_print(ctx, &database->path, "%s/%s", folder, FG_STATION_DATABASE));
  FG_TRY(open_connection(ctx, database->path, true, &database->writer));
  FG_TRY(migrate(ctx, database));
  FG_TRY(open_connection(ctx, database->path, false, &database->reader));
  return find_file(ctx, database);
}

fg_status fg_station_database_open_reader(fg_context *ctx, const char *path, sqlite3 **reader) {
  fg_status status = open_connection(ctx, path, false, reader);
  if (status == FG_OK) return FG_OK;
  fg_sql_close(*reader);
  *reader = NULL;
  return status;
}

fg_status fg_station_database_check(fg_context *ctx, const char *path) {
  fg_query query;
  sqlite3 *reader;
  if (access(path, R_OK) != 0)
    return fg_fail(ctx, FG_ERR_IO,
                   "%s: there is no database of a station: check the folder, or start `foilgauge "
                   "station` in it",
                   path);
  FG_TRY(fg_station_database_open_reader(ctx, path, &reader));
  fg_query_begin(reader, "PRAGMA user_version", &query);
  int version = fg_query_row(&query) ? (int)fg_query_get_integer(&query, 0) : 0;
  fg_status status = fg_query_end(ctx, &query, path);
  fg_sql_close(reader);
  if (status != FG_OK || version == VERSION) return status;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: the database has version %d, this program's have %d: start the station of "
                 "this program once",
                 path, version, VERSION);
}

fg_status fg_station_database_open(fg_context *ctx, const char *folder,
                                   fg_station_database *database) {
  *database = (fg_station_database){0};
  pthread_mutex_init(&database->writing, NULL);
  pthread_mutex_init(&database->reading, NULL);
  fg_status status = open_both(ctx, folder, database);
  if (status != FG_OK) fg_station_database_close(database);
  return status;
}

bool fg_station_database_is_there(const fg_station_database *database) {
  struct stat file;
  return stat(database->path, &file) == 0 && file.st_dev == database->device &&
         file.st_ino == database->inode;
}

/* Keeps SQLite, which removes journals by name, from removing one: when the open file has lost
 * its name, a journal of that name is another database's. */
static void leave_journal(sqlite3 *connection) {
  int persist = 1;
  if (!connection) return;
  fg_sqlite.db_config(connection, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, NULL);
  fg_sqlite.file_control(connection, "main", SQLITE_FCNTL_PERSIST_WAL, &persist);
}

void fg_station_database_keep_up(fg_station_database *database) {
  double now = fg_clock_seconds();
  if (now - database->in_file_at < IN_FILE_EVERY_S) return;
  pthread_mutex_lock(&database->writing);
  int64_t changes = fg_sqlite.total_changes64(database->writer);
  if (changes != database->in_file && fg_station_database_is_there(database) &&
      fg_sqlite.wal_checkpoint_v2(database->writer, NULL, SQLITE_CHECKPOINT_PASSIVE, NULL, NULL) ==
          SQLITE_OK)
    database->in_file = changes;
  database->in_file_at = now;
  pthread_mutex_unlock(&database->writing);
}

/* SQLite does so itself when the last connection closes, but not where another program has the file
 * open. */
static void move_journal(sqlite3 *writer) {
  if (writer) fg_sqlite.wal_checkpoint_v2(writer, NULL, SQLITE_CHECKPOINT_TRUNCATE, NULL, NULL);
}

void fg_station_database_close(fg_station_database *database) {
  bool gone = database->inode && !fg_station_database_is_there(database);
  if (gone) {
    leave_journal(database->reader);
    leave_journal(database->writer);
  }
  fg_sql_close(database->reader);
  if (!gone) move_journal(database->writer);
  fg_sql_close(database->writer);
  database->reader = database->writer = NULL;
  free(database->path);
  database->path = NULL;
}

fg_status fg_station_database_reopen(fg_context *ctx, const char *folder,
                                     fg_station_database *database) {
  fg_station_database other = {0};
  fg_status status = open_both(ctx, folder, &other);
  if (status == FG_OK) {
    pthread_mutex_lock(&database->reading);
    pthread_mutex_lock(&database->writing);
    fg_station_database before = *database;
    database->reader = other.reader;
    database->writer = other.writer;
    database->path = other.path;
    database->device = other.device;
    database->inode = other.inode;
    database->in_file = other.in_file;
    pthread_mutex_unlock(&database->writing);
    pthread_mutex_unlock(&database->reading);
    other = before;
  }
  fg_station_database_close(&other);
  return status;
}

fg_status fg_station_database_begin(fg_context *ctx, fg_station_database *database) {
  pthread_mutex_lock(&database->writing);
  fg_status status =
      fg_station_database_is_there(database)
          ? fg_sql_run(ctx, database->writer, "BEGIN IMMEDIATE")
          : fg_fail(ctx, FG_ERR_IO, "%s: is not in its folder any more", database->path);
  if (status != FG_OK) pthread_mutex_unlock(&database->writing);
  return status;
}

fg_status fg_station_database_end(fg_context *ctx, fg_station_database *database,
                                  fg_status status) {
  fg_context inner;
  if (status == FG_OK) status = fg_sql_run(ctx, database->writer, "COMMIT");
  /* An error may have rolled back already. */
  if (status != FG_OK && !fg_sqlite.get_autocommit(database->writer))
    fg_sql_run(&inner, database->writer, "ROLLBACK");
  pthread_mutex_unlock(&database->writing);
  return status;
}
