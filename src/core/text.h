/* Text that the callee allocates, which is public. */
#ifndef FG_CORE_TEXT_H
#define FG_CORE_TEXT_H

#include "foilgauge/text.h"

#endif
