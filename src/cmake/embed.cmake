# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DFILE=a.js -DNAME=fg_script -DHEADER=room/page.h -DOUTPUT=a.c -P embed.cmake
# A text as an array of C: `const char NAME[]`, which HEADER declares. An array, as a literal may have 4,095 bytes.
file(READ ${FILE} bytes HEX)
string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
string(REGEX REPLACE "((0x..,){20})" "\\1\n    " bytes "${bytes}")
file(WRITE ${OUTPUT} "#include \"${HEADER}\"\n\nconst char ${NAME}[] = {\n    ${bytes}0x00};\n")
