/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scale of a table's response on which the declared model may hold. */
#ifndef FOILGAUGE_LOOP_SCALE_H
#define FOILGAUGE_LOOP_SCALE_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Profile of the power of the response (Box and Cox 1964): 1 is the response itself, 0 its
 * logarithm. */
typedef struct fg_loop_response_scale {
  bool known;         /* false: a response that is not positive, or does not vary enough */
  double power;       /* with the largest likelihood */
  double interval[2]; /* 95 % */
  double p_value;     /* of the power 1, alone */
  double chosen;      /* simplest power in the interval; 1: the response may stay as it is */
  size_t removes; /* claims of scatter and interaction that do not show on that scale: each is tied
                     with it */
} fg_loop_response_scale;

/* Writes "1/time", "log(time)", "time^0.5". */
void fg_loop_scale_name(double power, const char *response, char *text, size_t size);

#ifdef __cplusplus
}
#endif

#endif
