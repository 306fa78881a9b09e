# SPDX-License-Identifier: GPL-3.0-or-later
# AddressSanitizer and UndefinedBehaviorSanitizer; warnings are errors.
set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "")
set(FOILGAUGE_WERROR ON CACHE BOOL "")
set(FOILGAUGE_SANITIZE ON CACHE BOOL "")
