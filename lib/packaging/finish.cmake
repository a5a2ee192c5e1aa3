# Run by cpack when the files of all packages are in place and none is packed: adds to each what a
# package for Debian has besides, and its bill of materials.
include(${CPACK_BUSBAR_SOURCE_DIR}/lib/packaging/bill.cmake)

# Each package has a summary of its own, before which cpack would put this one.
set(CPACK_DEFAULT_PACKAGE_DESCRIPTION_SUMMARY "${CPACK_PACKAGE_DESCRIPTION_SUMMARY}")

# The time of all that is made here; of the sources if SOURCE_DATE_EPOCH is set.
string(TIMESTAMP created "%Y-%m-%dT%H:%M:%SZ" UTC)
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
find_program(GZIP_PROGRAM gzip REQUIRED)
find_program(STRIP_PROGRAM strip REQUIRED)

foreach(each IN LISTS CPACK_BUSBAR_PACKAGES)
  string(REGEX MATCH "^(.*)=(.*)$" matched ${each})
  set(component ${CMAKE_MATCH_1})
  set(name ${CMAKE_MATCH_2})
  set(root ${CPACK_TEMPORARY_DIRECTORY}/${component})
  if(NOT EXISTS ${root})
    continue()
  endif()
  if(EXISTS ${root}/usr/etc)
    file(RENAME ${root}/usr/etc ${root}/etc)
  endif()
  set(documents ${root}/usr/share/doc/${name})
  file(MAKE_DIRECTORY ${documents})
  configure_file(${CPACK_BUSBAR_SOURCE_DIR}/LICENSE ${documents}/copyright COPYONLY)
  execute_process(COMMAND ${GZIP_PROGRAM} -9nc ${CPACK_BUSBAR_SOURCE_DIR}/CHANGELOG.md
    OUTPUT_FILE ${documents}/changelog.gz COMMAND_ERROR_IS_FATAL ANY)
  file(WRITE ${documents}/changelog.Debian "busbar (${CPACK_BUSBAR_VERSION}) unstable; urgency=low\n
  * The packages of ${CPACK_PACKAGE_VERSION}; changelog.gz has what is new.\n
 -- ${CPACK_PACKAGE_CONTACT}  ${date}\n")
  execute_process(COMMAND ${GZIP_PROGRAM} -9n ${documents}/changelog.Debian
    COMMAND_ERROR_IS_FATAL ANY)
  if(component STREQUAL "runtime")
    # Where dpkg-shlibdeps looks for what the other packages need of this one.
    file(GLOB libraries ${root}/usr/${CPACK_BUSBAR_LIBDIR}/*.so.*)
    file(REMOVE_RECURSE ${CPACK_BUSBAR_LIBRARIES})
    file(COPY ${libraries} DESTINATION ${CPACK_BUSBAR_LIBRARIES})
  endif()
  # What cpack would change after the bill has named it.
  file(GLOB_RECURSE files LIST_DIRECTORIES false ${root}/*)
  foreach(file IN LISTS files)
    if(NOT IS_SYMLINK ${file} AND file MATCHES "/bin/|[.]so[.]")
      execute_process(COMMAND ${STRIP_PROGRAM} --strip-unneeded ${file}
        COMMAND_ERROR_IS_FATAL ANY)
    elseif(NOT IS_SYMLINK ${file} AND file MATCHES "[.]a$")
      execute_process(COMMAND ${STRIP_PROGRAM} --strip-debug --enable-deterministic-archives ${file}
        COMMAND_ERROR_IS_FATAL ANY)
    endif()
  endforeach()
  busbar_write_bill(${root} ${component} ${name} ${documents}/${name}.spdx.json ${created})
endforeach()
