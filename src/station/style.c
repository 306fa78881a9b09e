/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The station's style, after that of the reports, and its icon. */
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

#include "page/page.h"
#include "station/pages.h"
#include "station/trend.h"

/* A bump of a foil. */
const char fg_station_icon[] =
    "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 32 32\"><rect width=\"32\" "
    "height=\"32\" rx=\"6\" fill=\"#16202a\"/><path d=\"M2 23H7Q16 -3 25 23H30\" fill=\"none\" "
    "stroke=\"#fff\" stroke-width=\"3.5\"/></svg>\n";

static char *whole;

static void join_styles(void) {
  size_t size;
  FILE *out = open_memstream(&whole, &size);
  if (!out) return;
  fputs(fg_page_style, out);
  fputs(fg_station_style, out);
  fputs(fg_trend_style, out);
  fclose(out);
}

const char *fg_station_style_text(void) {
  static pthread_once_t once = PTHREAD_ONCE_INIT;
  pthread_once(&once, join_styles);
  return whole ? whole : fg_station_style;
}
