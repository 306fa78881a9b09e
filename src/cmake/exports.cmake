# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DHEADERS="a.h;b.h" -DVERSION=0.1 -DMAP=exports.map -P exports.cmake
# The linker's version script of the shared library: what the public headers declare, and nothing else.
set(names "")
foreach(header ${HEADERS})
  file(READ ${header} text)
  string(REGEX REPLACE "/\\*([^*]|\\*+[^*/])*\\*+/" "" text "${text}")
  string(REGEX MATCHALL "fg_[a-z0-9_]+\\(" calls "${text}")
  string(REPLACE "(" "" calls "${calls}")
  list(APPEND names ${calls})
endforeach()
list(REMOVE_DUPLICATES names)
list(SORT names)
list(JOIN names ";\n    " lines)
file(WRITE ${MAP} "FOILGAUGE_${VERSION} {\n  global:\n    ${lines};\n  local:\n    *;\n};\n")
