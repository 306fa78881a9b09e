# SPDX-License-Identifier: GPL-3.0-or-later
# The build that users run.
set(CMAKE_BUILD_TYPE Release CACHE STRING "")
