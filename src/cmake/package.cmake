# SPDX-License-Identifier: GPL-3.0-or-later
# cpack: packages for Debian and Ubuntu.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME foilgauge)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "foilgauge developers <foilgauge@localhost>" CACHE STRING
    "Who answers for the packages: NAME <ADDRESS>")

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME foilgauge)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
# A station loads them where it passes parts on by HTTP, by MQTT, and keeps a hub's in PostgreSQL.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS libcurl4)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "libmosquitto1, libpq5")
# Libraries that the program loads itself.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "libtiff6, libsqlite3-0, libmicrohttpd12 | libmicrohttpd12t64")
# Versions for packages that depend on the shared library; a trigger, not a script, refreshes the loader's cache.
file(WRITE ${CMAKE_BINARY_DIR}/package/shlibs "libfoilgauge ${ABI_VERSION} foilgauge (= ${PROJECT_VERSION})\n")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_CONTROL_EXTRA
    ${CMAKE_BINARY_DIR}/package/shlibs ${CMAKE_SOURCE_DIR}/src/cmake/debian/triggers)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_SOURCE_DIR}/src/cmake/debian/stage.cmake)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION
    "The program with its manual, its schemas and samples, and the shared library.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME foilgauge-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "foilgauge (= ${PROJECT_VERSION})")
# Of programs that link the static library.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "libpng-dev, libtiff-dev, libjpeg-dev, libisal-dev, libgsl-dev, libcjson-dev, nettle-dev, libcsv-dev, libsuitesparse-dev, libsundials-dev, libsqlite3-dev, libmicrohttpd-dev")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
    "Headers, the static library, and what pkg-config and CMake need\nto build against foilgauge.")
include(CPack)
