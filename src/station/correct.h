/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Changes of a foil's identity (serial, lot, die, operator), and the page that asks before a
 * change in conflict. */
#ifndef FG_STATION_CORRECT_H
#define FG_STATION_CORRECT_H

#include "station/naming.h"
#include "station/request.h"

enum { FG_IDENTITY_FIELDS = 4 }; /* serial, lot, die, operator */

typedef struct fg_identity_change {
  int64_t foil;
  /* By field: the foil's value, the value that the form showed, and the one wanted. */
  char before[FG_IDENTITY_FIELDS][FG_IDENTITY_BYTES], was[FG_IDENTITY_FIELDS][FG_IDENTITY_BYTES],
      after[FG_IDENTITY_FIELDS][FG_IDENTITY_BYTES];
  bool was_given[FG_IDENTITY_FIELDS];
  bool asked[FG_IDENTITY_FIELDS];     /* it was changed in the form */
  bool overtaken[FG_IDENTITY_FIELDS]; /* somebody else changed it meanwhile */
  bool owned;                         /* another foil has the serial number that is wanted */
  bool held;                    /* nothing was changed: the page asks about one of these first */
  bool to_now;                  /* the html form was on the page Now */
  char also[FG_IDENTITY_BYTES]; /* the serial number that the user allowed to be shared; "": none */
  char by[FG_IDENTITY_BYTES];
} fg_identity_change;

const char *fg_identity_field(size_t field);

/* 409: the conflicts of a held correction, and a form to resolve them. */
fg_status fg_page_identity(fg_context *ctx, fg_inspection *station, const fg_identity_change *asked,
                           fg_answer *answer);

#endif
