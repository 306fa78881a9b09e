/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/scan_command.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "core/date.h"
#include "core/memory.h"
#include "core/text.h"
#include "station/keep.h"
#include "station/news.h"
#include "station/orders.h"
#include "station/pages.h"

extern char **environ;

/* SCAN_SECONDS: a bed at 4800 dpi takes a slow scanner some four minutes. TAIL_BYTES of the
 * command's output are read; OUTPUT_BYTES go on the card. */
enum {
  SCAN_SECONDS = 900,
  TAIL_BYTES = 4096,
  OUTPUT_BYTES = 400,
  TURN_MS = 250,
  NAME_BYTES = 96,
  ORDER_BYTES = 40
};

#define PREFIX       "station-"
#define CHECK_PREFIX "station-check-"

typedef struct fg_station_scanner {
  fg_inspection *station;
  pthread_t thread;
  atomic_bool stop;
  bool check;                                 /* of the plate */
  char hidden[NAME_BYTES], final[NAME_BYTES]; /* below the folder */
} scanner;

/* The end of the command's output. */
typedef struct words {
  char text[TAIL_BYTES + 1];
  size_t length;
} words;

/* True when a name matches a pattern, in which 0 is any digit. */
static bool matches_pattern(const char *name, const char *pattern) {
  for (; *pattern; pattern++, name++)
    if (*pattern == '0' ? *name < '0' || *name > '9' : *name != *pattern) return false;
  return true;
}

bool fg_station_is_scanned_check(const char *name) {
  return matches_pattern(name, CHECK_PREFIX "00000000-000000-000.");
}

bool fg_station_is_scanned(const char *name) {
  return matches_pattern(name, PREFIX "00000000-000000-000.") ||
         matches_pattern(name, PREFIX "00000000-000000-000-") || fg_station_is_scanned_check(name);
}

/* Returns the file's ending that a scanner's program requires. */
static const char *ending_for(const char *command) {
  if (strcasestr(command, "tif")) return "tif";
  return strcasestr(command, "pnm") ? "pnm" : "png";
}

/* Part of the file's name for the open order; "": none is open. */
static void find_order_part(fg_inspection *station, char order[ORDER_BYTES]) {
  fg_context unused;
  fg_order open;
  pthread_mutex_lock(&station->database.reading);
  bool read = fg_order_read_open(&unused, station->database.reader, &open) == FG_OK;
  pthread_mutex_unlock(&station->database.reading);
  if (read) fg_order_file_part(&open, order, ORDER_BYTES);
}

/* While it is written it is hidden from the watch. Both names hold nothing that a shell would see
 * anything in, quoted by the recipe or not. */
static void choose_names(scanner *at) {
  struct timespec now;
  char stamp[FG_DATE_STAMP], order[ORDER_BYTES] = "";
  if (!at->check) find_order_part(at->station, order);
  clock_gettime(CLOCK_REALTIME, &now);
  fg_date_format_stamp(now.tv_sec, stamp);
  fg_text_clip(at->final, sizeof at->final, "%s%s-%03d%s%s.%s", at->check ? CHECK_PREFIX : PREFIX,
               stamp, (int)(now.tv_nsec / 1000000), order[0] ? "-" : "", order,
               ending_for(at->station->settings->scan_command));
  fg_text_clip(at->hidden, sizeof at->hidden, ".%s", at->final);
}

static fg_status build_command(fg_context *ctx, const scanner *at, char **command) {
  static const char place[] = "{file}";
  const char *from = at->station->settings->scan_command, *next;
  fg_status status = FG_OK;
  *command = NULL;
  for (; status == FG_OK && (next = strstr(from, place)); from = next + sizeof place - 1)
    status = fg_text_append(ctx, command, "%.*s%s", (int)(next - from), from, at->hidden);
  return status == FG_OK ? fg_text_append(ctx, command, "%s", from) : status;
}

/* Starts the command in the folder: in a process group of its own, so that all of it can be
 * ended; with the signals that the program blocks unblocked; and without its files, as a command
 * that outlived the station would keep its lock. */
static int spawn(const char *folder, const char *command, int output, pid_t *child) {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t how;
  sigset_t none, all;
  char *const arguments[] = {"sh", "-c", (char *)(uintptr_t)command, NULL};
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawn_file_actions_init(&files);
  posix_spawnattr_init(&how);
  posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, output, 1);
  posix_spawn_file_actions_adddup2(&files, output, 2);
  posix_spawn_file_actions_addchdir_np(&files, folder);
  posix_spawn_file_actions_addclosefrom_np(&files, 3);
  posix_spawnattr_setpgroup(&how, 0);
  posix_spawnattr_setsigmask(&how, &none);
  posix_spawnattr_setsigdefault(&how, &all);
  posix_spawnattr_setflags(&how,
                           POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  int error = posix_spawn(child, "/bin/sh", &files, &how, arguments, environ);
  posix_spawnattr_destroy(&how);
  posix_spawn_file_actions_destroy(&files);
  return error;
}

static void listen_to(int input, words *said) {
  char bytes[1024];
  ssize_t got;
  while ((got = read(input, bytes, sizeof bytes)) > 0) {
    size_t size = (size_t)got, over = said->length + size;
    over = over > TAIL_BYTES ? over - TAIL_BYTES : 0;
    memmove(said->text, said->text + over, said->length - over);
    memcpy(said->text + said->length - over, bytes, size);
    said->length += size - over;
  }
}

/* True with how it ended; false: it took too long, or the station ends. */
static bool wait_for(scanner *at, pid_t child, int input, words *said, int *ended) {
  double until = fg_clock_seconds() + SCAN_SECONDS;
  struct pollfd descriptor = {.fd = input, .events = POLLIN};
  while (!atomic_load(&at->stop) && fg_clock_seconds() < until) {
    if (poll(&descriptor, 1, TURN_MS) > 0 && descriptor.revents & (POLLHUP | POLLERR)) {
      descriptor.fd = -1; /* end of its output */
    }
    listen_to(input, said);
    if (waitpid(child, ended, WNOHANG) == child) {
      listen_to(input, said);
      return true;
    }
  }
  kill(-child, SIGKILL);
  waitpid(child, ended, 0);
  return false;
}

/* Copies the last words of the output on one line, without control characters. */
static void find_last_words(const words *said, char text[OUTPUT_BYTES + 1]) {
  size_t length = 0, from = said->length > OUTPUT_BYTES ? said->length - OUTPUT_BYTES : 0;
  /* Not from the middle of a character. */
  while (from && from < said->length && ((unsigned char)said->text[from] & 0xC0) == 0x80)
    from++;
  for (size_t i = from; i < said->length; i++) {
    char c = said->text[i];
    bool space = (unsigned char)c <= ' ' || c == 0x7f;
    if (space && (!length || text[length - 1] == ' ')) continue;
    text[length++] = c;
    if (space) text[length - 1] = ' ';
  }
  while (length && text[length - 1] == ' ')
    length--;
  text[length] = '\0';
}

static bool is_there(const char *folder, const char *name) {
  struct stat file;
  char *path = NULL;
  bool there = fg_text_print(NULL, &path, "%s/%s", folder, name) == FG_OK &&
               stat(path, &file) == 0 && S_ISREG(file.st_mode) && file.st_size > 0;
  free(path);
  return there;
}

/* FG_OK: the hidden file is there. */
static fg_status run_command(fg_context *ctx, scanner *at, words *said) {
  const char *folder = at->station->request->folder;
  char *command;
  int pipes[2], ended = 0;
  pid_t child;
  FG_TRY(build_command(ctx, at, &command));
  if (pipe2(pipes, O_CLOEXEC | O_NONBLOCK) != 0) {
    free(command);
    return fg_fail(ctx, FG_ERR_IO, "was not scanned: %s", strerror(errno));
  }
  int flags = fcntl(pipes[1], F_GETFL);
  fcntl(pipes[1], F_SETFL, flags & ~O_NONBLOCK); /* the command's end waits, ours does not */
  int error = spawn(folder, command, pipes[1], &child);
  free(command);
  close(pipes[1]);
  bool whole = !error && wait_for(at, child, pipes[0], said, &ended);
  close(pipes[0]);
  if (error)
    return fg_fail(ctx, FG_ERR_IO, "was not scanned: /bin/sh cannot be run: %s", strerror(error));
  if (!whole)
    return fg_fail(ctx, FG_ERR_IO, "was not scanned: the scan command took longer than %d s",
                   SCAN_SECONDS);
  if (WIFSIGNALED(ended))
    return fg_fail(ctx, FG_ERR_IO, "was not scanned: the scan command was ended by signal %d",
                   WTERMSIG(ended));
  if (WEXITSTATUS(ended))
    return fg_fail(ctx, FG_ERR_IO, "was not scanned: the scan command ended with exit code %d",
                   WEXITSTATUS(ended));
  if (!is_there(folder, at->hidden))
    return fg_fail(ctx, FG_ERR_IO, "was not scanned: the scan command wrote no file");
  return FG_OK;
}

/* A link and not a new name, which would replace a file that came to be there. */
static fg_status publish_scan(fg_context *ctx, const scanner *at) {
  const char *folder = at->station->request->folder;
  int error = EIO, open_folder = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (open_folder >= 0) {
    error =
        renameat2(open_folder, at->hidden, open_folder, at->final, RENAME_NOREPLACE) ? errno : 0;
    if (error == EINVAL) /* a file system that does not know of it */
      error = linkat(open_folder, at->hidden, open_folder, at->final, 0) ||
                      unlinkat(open_folder, at->hidden, 0)
                  ? errno
                  : 0;
    close(open_folder);
  }
  if (!error) return FG_OK;
  return fg_fail(ctx, FG_ERR_IO, "was scanned but not kept: %s", strerror(error));
}

static void keep_failure(scanner *at, const char *why, const words *said) {
  char last[OUTPUT_BYTES + 1], message[OUTPUT_BYTES + 400];
  fg_context ctx;
  const fg_station_file file = {.name = at->final, .modified_ns = -1};
  find_last_words(said, last);
  fg_text_clip(message, sizeof message, "%s%s%s", why, last[0] ? ": " : "", last);
  fg_station_keep_card(&ctx, &at->station->database, &file, FG_CARD_UNREADABLE, message, 0);
}

static void remove_hidden(const scanner *at) {
  char *path = NULL;
  if (fg_text_print(NULL, &path, "%s/%s", at->station->request->folder, at->hidden) == FG_OK)
    unlink(path);
  free(path);
}

static void *scan(void *argument) {
  scanner *at = argument;
  fg_inspection *station = at->station;
  fg_context ctx = {.message = ""};
  words said = {.length = 0};
  fg_status status = run_command(&ctx, at, &said);
  if (status == FG_OK) status = publish_scan(&ctx, at);
  if (status != FG_OK && !atomic_load(&at->stop)) keep_failure(at, ctx.message, &said);
  if (status != FG_OK) remove_hidden(at);
  atomic_store(&station->scanning, false);
  fg_station_notify(station);
  return NULL;
}

/* The thread of the scan before has come to its end, or is about to. */
static void forget_scanner(fg_inspection *station) {
  if (!station->scanner) return;
  pthread_join(station->scanner->thread, NULL);
  free(station->scanner);
  station->scanner = NULL;
}

fg_status fg_station_scan_begin(fg_context *ctx, fg_inspection *station, bool check) {
  void *block;
  if (atomic_exchange(&station->scanning, true)) return FG_OK;
  forget_scanner(station);
  fg_status status = fg_memory_allocate(ctx, 1, sizeof(scanner), &block);
  if (status != FG_OK) {
    atomic_store(&station->scanning, false);
    return status;
  }
  scanner *at = block;
  *at = (scanner){.station = station};
  at->check = check;
  choose_names(at);
  station->scanner = at;
  int error = pthread_create(&at->thread, NULL, scan, at);
  if (!error) return FG_OK;
  station->scanner = NULL;
  free(at);
  atomic_store(&station->scanning, false);
  return fg_fail(ctx, FG_ERR_MEMORY, "No scan was begun: %s", strerror(error));
}

void fg_station_scan_stop(fg_inspection *station) {
  if (station->scanner) atomic_store(&station->scanner->stop, true);
  forget_scanner(station);
}

fg_status fg_action_scan(fg_context *ctx, fg_inspection *station, const fg_request *request,
                         fg_answer *answer) {
  bool check = fg_request_get(request, "check")[0] && station->check_design_known;
  if (!station->settings->scan_command[0])
    return fg_fail(ctx, FG_ERR_USAGE, "The recipe has no scan_command.");
  FG_TRY(fg_station_scan_begin(ctx, station, check));
  fg_station_notify(station);
  strcpy(answer->location, "/");
  return FG_OK;
}
