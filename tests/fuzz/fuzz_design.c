/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Design files, and what follows from them. */
#include "foilgauge/design.h"
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  fg_context ctx = {0};
  fg_design design;
  fg_nominal nominal;
  fg_design_default(&design);
  if (fg_design_load(&ctx, fuzz_file(data, size), &design) == FG_OK)
    (void)fg_design_derive(&ctx, &design, &nominal);
  return 0;
}
