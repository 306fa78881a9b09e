/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Access: hosts, tokens, forms of this station alone, users with roles. */
#ifndef FG_STATION_ACCESS_H
#define FG_STATION_ACCESS_H

#include "station/request.h"

/* Roles of users; each may do all that the roles before may. */
typedef enum fg_role {
  FG_ROLE_OPERATOR, /* measure, name foils, open orders, dispositions but concessions */
  FG_ROLE_QUALITY,  /* concessions, lots, baselines, causes */
  FG_ROLE_ADMIN     /* backups */
} fg_role;

enum { FG_USER_NAME = 128 };

typedef struct fg_user {
  char name[FG_USER_NAME];
  fg_role role;
  char token[FG_TOKEN_MAX + 1];
} fg_user;

/* Reads the users of request->users, lines "name,role,token"; none without a file. FG_ERR_DATA
 * names the line. */
fg_status fg_users_load(fg_context *ctx, const char *path, fg_users *users);

/* False with the answer when the request goes no further. */
bool fg_access_allows(const fg_inspection *station, const fg_request *request, fg_answer *answer);

/* The user who asks; NULL where the station knows no users. */
const fg_user *fg_access_user(const fg_inspection *station, const fg_request *request);
/* False with the answer where the user's role does not reach. */
bool fg_access_has_role(const fg_inspection *station, const fg_request *request, fg_role role,
                        fg_answer *answer);

/* Puts the user's name into the field `by` of an action, whatever its html form says. */
void fg_access_sign(const fg_inspection *station, fg_request *request);

/* Answers with a page that states the error. */
void fg_access_refuse(fg_answer *answer, int code, const char *words);

/* A request of a program, not of a browser. */
bool fg_access_is_api(const char *path);

#endif
