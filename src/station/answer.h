/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A request and its answer, without a socket: tests and a fuzzer call it. */
#ifndef FG_STATION_ANSWER_H
#define FG_STATION_ANSWER_H

#include "station/request.h"

/* Answers a request, always; the caller frees the body. */
void fg_station_answer(fg_inspection *station, const fg_request *request, fg_answer *answer);

/* Puts a page into a language. Pages are written in English, tables with decimal points: one that
 * has commas already begins with a byte order mark. */
void fg_station_give_language(const fg_language *language, fg_answer *answer);

/* Answers a request for a style, a script or the icon; false: it is none. */
bool fg_station_give_fixed(const fg_request *request, fg_answer *answer);

#endif
