/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Removes the elements around names that people gave, so that tests can ask for sentences with names in them. */
#ifndef FG_TESTS_PAGE_NAMES_H
#define FG_TESTS_PAGE_NAMES_H

#include <string.h>

static inline char *page_without_name_marks(char *page) {
  static const char begin[] = "<span translate=\"no\">", end[] = "</span>";
  for (char *at = page; at && (at = strstr(at, begin));) {
    memmove(at, at + sizeof begin - 1, strlen(at + sizeof begin - 1) + 1);
    char *close = strstr(at, end);
    if (close) memmove(close, close + sizeof end - 1, strlen(close + sizeof end - 1) + 1);
  }
  return page;
}

#endif
