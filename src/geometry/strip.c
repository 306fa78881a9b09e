#include "foilgauge/strip.h"

#include <stdlib.h>
#include <string.h>

void fg_strip_free(fg_strip *strip) {
  if (!strip) return;
  free(strip->stations);
  memset(strip, 0, sizeof *strip);
}
