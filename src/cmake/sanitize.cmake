# SPDX-License-Identifier: GPL-3.0-or-later
# AddressSanitizer and UndefinedBehaviorSanitizer; warnings are errors.
set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "")
# Debug information of lines alone, all that a sanitizer's report shows: a tenth off the compiler's time.
set(CMAKE_C_FLAGS_RELWITHDEBINFO "-O2 -g1 -DNDEBUG" CACHE STRING "")
set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O2 -g1 -DNDEBUG" CACHE STRING "")
set(FOILGAUGE_WERROR ON CACHE BOOL "")
set(FOILGAUGE_SANITIZE ON CACHE BOOL "")
