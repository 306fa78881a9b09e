#include "foilgauge/version.h"

const char *fg_version(void) {
  return FOILGAUGE_VERSION;
}
