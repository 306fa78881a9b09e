# cpack runs it before it makes the packages. It adds the files that Debian's policy asks for and `cmake --install` has no place
# for: copyright, changelog, and overrides of lintian; and it compresses the manual pages.
set(here ${CMAKE_CURRENT_LIST_DIR})
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
foreach(package program:foilgauge development:foilgauge-dev)
  string(REGEX MATCHALL "[^:]+" package ${package})
  list(POP_FRONT package component name)
  set(share ${CPACK_TEMPORARY_DIRECTORY}/${component}${CPACK_PACKAGING_INSTALL_PREFIX}/share)
  file(MAKE_DIRECTORY ${share}/doc/${name})
  configure_file(${here}/copyright ${share}/doc/${name}/copyright COPYONLY)
  file(WRITE ${share}/doc/${name}/changelog
       "foilgauge (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium\n\n"
       "  * Made of the sources, whose changes are told in .github/CHANGELOG.md.\n\n"
       " -- ${CPACK_DEBIAN_PACKAGE_MAINTAINER}  ${date}\n")
  file(STRINGS ${here}/overrides overrides REGEX "^(#|${name}:)")
  list(JOIN overrides "\n" overrides)
  if(EXISTS ${share}/doc/${name}/README.md)
    file(READ ${share}/doc/${name}/README.md readme)
    string(REPLACE "](LICENSE)" "](copyright)" readme "${readme}")
    file(WRITE ${share}/doc/${name}/README.md "${readme}")
  endif()
  file(WRITE ${share}/lintian/overrides/${name} "${overrides}\n")
  file(CHMOD_RECURSE ${share}/lintian ${share}/doc/${name} FILE_PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ
       DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
  file(GLOB texts ${share}/doc/${name}/changelog ${share}/man/man*/*.[157])
  # A page of another name for a command is a link to the command's own.
  foreach(link ${texts})
    if(IS_SYMLINK ${link})
      file(READ_SYMLINK ${link} page)
      file(REMOVE ${link})
      file(CREATE_LINK ${page}.gz ${link}.gz SYMBOLIC)
      list(REMOVE_ITEM texts ${link})
    endif()
  endforeach()
  execute_process(COMMAND gzip -9n ${texts} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
