/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A request and its answer, without a socket: what tests and a fuzzer call. */
#ifndef FG_STATION_ANSWER_H
#define FG_STATION_ANSWER_H

#include "station/request.h"

/* Always an answer; body is the caller's to free. */
void fg_station_answer(fg_inspection *station, const fg_request *request, fg_answer *answer);

#endif
