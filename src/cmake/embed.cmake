# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DFILE=a.js -DNAME=fg_script -DHEADER=room/page.h -DOUTPUT=a.c -P embed.cmake
# A text as an array of C: `const char NAME[]`, which HEADER declares. An array, as a literal may have 4,095 bytes.
# A style sheet loses its comments and its layout: every page carries it. Its strings must hold none of `{};,:` before
# or behind a blank, and its selectors are written `a>b`, `a+b`.
file(READ ${FILE} text)
if(FILE MATCHES "\\.css$")
  string(REGEX REPLACE "/\\*[^*]*\\*+([^/*][^*]*\\*+)*/" "" text "${text}")
  string(REGEX REPLACE "[ \n\t]+" " " text "${text}")
  string(REGEX REPLACE " ?([{};,]) ?" "\\1" text "${text}")
  string(REGEX REPLACE ": " ":" text "${text}")
  string(REPLACE ";}" "}" text "${text}")
  string(STRIP "${text}\n" text)
  set(text "${text}\n")
endif()
string(HEX "${text}" bytes)
string(REGEX REPLACE "(..)" "'\\\\x\\1'," bytes "${bytes}")
string(REGEX REPLACE "(('[^']*',){20})" "\\1\n    " bytes "${bytes}")
file(WRITE ${OUTPUT} "#include \"${HEADER}\"\n\nconst char ${NAME}[] = {\n    ${bytes}'\\0'};\n")
