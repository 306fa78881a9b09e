# SPDX-License-Identifier: GPL-3.0-or-later
# The shared library and everything that `cmake --install` puts in place. Components: `program` runs,
# `development` builds against the library.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# Layouts of the public structs may change with every minor version until 1.0.
set(ABI_VERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})

set(EXPORTS ${CMAKE_BINARY_DIR}/exports.map)
add_custom_command(OUTPUT ${EXPORTS}
  COMMAND ${CMAKE_COMMAND} "-DHEADERS=${PUBLIC_HEADERS}" -DVERSION=${ABI_VERSION} -DMAP=${EXPORTS}
          -P ${CMAKE_SOURCE_DIR}/src/cmake/exports.cmake
  DEPENDS ${PUBLIC_HEADERS} src/cmake/exports.cmake VERBATIM)
add_custom_target(exports DEPENDS ${EXPORTS})

# Compiled once: objects as for a program serve the shared library too, where the compiler makes them for any address
# (PIE), since nothing in the library can be replaced from outside. But of data of other libraries (GSL's methods, stdin,
# environ) a program gets a copy: what uses them is compiled for a library (else the linker says "recompile with -fPIC").
include(CheckCSourceCompiles)
check_c_source_compiles("
#if !defined __PIE__ || !defined __x86_64__
#error
#endif
int main(void) { return 0; }" OBJECTS_FOR_ANY_ADDRESS)
if(OBJECTS_FOR_ANY_ADDRESS)
  set_source_files_properties(
    src/forming/search.c src/geometry/circle_fit.c src/geometry/circle_levenberg.c src/geometry/roundness.c
    src/process/experiment_order.c src/process/experiment_simultaneous.c src/scan_loop/scanner_change.c src/station/scan_command.c
    src/stats/gauge_uneven.c src/stats/table_load.c
    PROPERTIES COMPILE_OPTIONS -fPIC)
else()
  set_target_properties(foilgauge_static PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_compile_options(foilgauge_static PRIVATE -fno-semantic-interposition)
endif()

add_library(foilgauge_shared SHARED $<TARGET_OBJECTS:foilgauge_static>)
add_dependencies(foilgauge_shared exports)
set_target_properties(foilgauge_shared PROPERTIES OUTPUT_NAME foilgauge EXPORT_NAME foilgauge
  VERSION ${PROJECT_VERSION} SOVERSION ${ABI_VERSION} LINKER_LANGUAGE C LINK_DEPENDS ${EXPORTS})
target_link_options(foilgauge_shared PRIVATE
  -Wl,--version-script=${EXPORTS} -Wl,-z,defs -Wl,-Bsymbolic -Wl,--as-needed)
target_link_libraries(foilgauge_shared PRIVATE ${LIBRARY_NEEDS})

install(TARGETS foilgauge RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
# The program and the library look for the module there (src/vision/cv_bridge.c).
install(TARGETS foilgauge_opencv LIBRARY DESTINATION lib/foilgauge COMPONENT program)
install(TARGETS foilgauge_shared EXPORT foilgaugeTargets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT program NAMELINK_COMPONENT development
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(TARGETS foilgauge_static EXPORT foilgaugeTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES ${PUBLIC_HEADERS} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/foilgauge
        COMPONENT development)

set(PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/foilgauge)
configure_package_config_file(src/cmake/foilgaugeConfig.cmake.in
  ${CMAKE_BINARY_DIR}/package/foilgaugeConfig.cmake INSTALL_DESTINATION ${PACKAGE_DIR})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/package/foilgaugeConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/package/foilgaugeConfig.cmake
              ${CMAKE_BINARY_DIR}/package/foilgaugeConfigVersion.cmake
        DESTINATION ${PACKAGE_DIR} COMPONENT development)
install(EXPORT foilgaugeTargets NAMESPACE foilgauge:: DESTINATION ${PACKAGE_DIR}
        COMPONENT development)

# The folder may be moved: paths start at the file's own place.
file(RELATIVE_PATH PC_TO_PREFIX /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
list(TRANSFORM STATIC_NEEDS PREPEND -l OUTPUT_VARIABLE PC_STATIC_LIBRARIES)
list(JOIN PC_STATIC_LIBRARIES " " PC_STATIC_LIBRARIES)
configure_file(src/cmake/foilgauge.pc.in ${CMAKE_BINARY_DIR}/package/foilgauge.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/package/foilgauge.pc
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)

foreach(section 1 5 7)
  if(MANUAL_TEXTS MATCHES "\\.${section}\\.md")
    install(DIRECTORY ${CMAKE_BINARY_DIR}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man${section}
            COMPONENT program FILES_MATCHING PATTERN "*.${section}")
  endif()
endforeach()
install(FILES ${CMAKE_BINARY_DIR}/completion/foilgauge
        DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
install(DIRECTORY reports/schema DESTINATION ${CMAKE_INSTALL_DATADIR}/foilgauge COMPONENT program)
include(src/cmake/installed_readme.cmake)
# A Debian package names Debian's own copy of the text (src/cmake/debian/copyright).
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT licence)
install(DIRECTORY samples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program
        PATTERN run.sh EXCLUDE)
install(FILES samples/station/foilgauge-station.service DESTINATION lib/systemd/system
        COMPONENT program)
