# SPDX-License-Identifier: GPL-3.0-or-later
# README.md as it is installed: its links lead to installed files. Pictures and reports that it links to lie beside it;
# a text of the manual becomes its page; what only the source tree has keeps its words alone.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS README.md)
file(READ README.md readme)

set(page "src/manual/text/(foilgauge[-a-z]*)\\.([157])\\.md")
string(REGEX REPLACE "\\[foilgauge[-a-z]*\\]\\(${page}\\)" "`man \\2 \\1`" readme "${readme}")
string(REGEX REPLACE "\\[([^]]*)\\]\\(${page}\\)" "\\1 (`man \\3 \\2`)" readme "${readme}")

file(RELATIVE_PATH schema ${CMAKE_INSTALL_FULL_DOCDIR} ${CMAKE_INSTALL_FULL_DATADIR}/foilgauge/schema)
string(REPLACE "[reports/schema/](reports/schema/)" "[schema](${schema}/)" readme "${readme}")
string(REGEX REPLACE "\\[([^]]*)\\]\\((src|include|tests)/[^)]*\\)" "\\1" readme "${readme}")
string(REGEX REPLACE "\\[(reports/[^]]*)\\]\\(reports/(README.md)?\\)" "\\1" readme "${readme}")
string(REGEX REPLACE "\\[([^]]*)\\]\\((\\.github)/[^)]*\\)" "\\1" readme "${readme}")
file(WRITE ${CMAKE_BINARY_DIR}/package/README.md "${readme}")
install(FILES ${CMAKE_BINARY_DIR}/package/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)

string(REGEX MATCHALL "\\]\\([a-z][^):]*\\)" links "${readme}")
list(TRANSFORM links REPLACE "\\]\\(|\\)" "")
list(REMOVE_DUPLICATES links)
foreach(link ${links})
  get_filename_component(folder ${link} DIRECTORY)
  install(FILES ${link} DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder} COMPONENT program)
endforeach()
