# SPDX-License-Identifier: GPL-3.0-or-later
# libFuzzer targets, with the sanitizers.
set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "")
set(CMAKE_C_COMPILER clang CACHE STRING "")
set(CMAKE_CXX_COMPILER clang++ CACHE STRING "")
set(FOILGAUGE_SANITIZE ON CACHE BOOL "")
set(FOILGAUGE_FUZZ ON CACHE BOOL "")
