/* How long a connection may take to say what it wants. The library's own limit starts again with
 * every byte: who sends a header byte by byte would hold a connection for ever. */
#ifndef FG_STATION_PATIENCE_H
#define FG_STATION_PATIENCE_H

#include <pthread.h>

#include <microhttpd.h>

enum { FG_CONNECTIONS = 96 };

typedef struct fg_patience {
  pthread_mutex_t mutex;
  struct {
    struct MHD_Connection *connection; /* NULL: none here */
    int socket;
    double until; /* fg_clock_seconds; 0: it has asked, and waits for an answer */
  } one[FG_CONNECTIONS];
} fg_patience;

void fg_patience_begin(fg_patience *patience);
void fg_patience_end(fg_patience *patience);

/* MHD_NotifyConnectionCallback with the fg_patience as its first argument: a new connection has
 * some seconds; whoever is over its time is cut off then, since only then is the place missed. */
void fg_patience_notify(void *patience, struct MHD_Connection *connection, void **unused,
                        enum MHD_ConnectionNotificationCode code);
/* It has said what it wants; it is answered, and may ask again. */
void fg_patience_asked(fg_patience *patience, struct MHD_Connection *connection);
void fg_patience_answered(fg_patience *patience, struct MHD_Connection *connection);

#endif
