# Wants BUILD_DIR, VERSION, GENERATOR and COMPILER; LAUNCHER may be empty.
set(test ${BUILD_DIR}/tarball-test)
file(REMOVE_RECURSE ${test})
file(MAKE_DIRECTORY ${test}/nothing)

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output
    ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${output}")
  endif()
endfunction()

get_filename_component(programs ${CMAKE_COMMAND} DIRECTORY)
run(${programs}/cpack --config ${BUILD_DIR}/CPackSourceConfig.cmake -B ${test})
file(ARCHIVE_EXTRACT INPUT ${test}/busbar-${VERSION}.tar.gz DESTINATION ${test})
set(source ${test}/busbar-${VERSION})
if(EXISTS ${source}/.git OR EXISTS ${source}/build)
  message(FATAL_ERROR "the tarball has .git or build in it")
endif()

# A git that cannot be run, before the one of this machine.
file(WRITE ${test}/nothing/git "#!/bin/sh\necho 'git is not there' >&2\nexit 127\n")
file(CHMOD ${test}/nothing/git PERMISSIONS OWNER_READ OWNER_EXECUTE)
set(ENV{PATH} ${test}/nothing:$ENV{PATH})
set(ENV{CMAKE_CXX_COMPILER_LAUNCHER} "${LAUNCHER}")

# built(<variable> <source>): a checksum of the first layer, with the folders of debuggers in it.
function(built variable source)
  run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${source} -B ${source}/../out-of-${variable}
    -D CMAKE_BUILD_TYPE=Debug -D CMAKE_CXX_COMPILER=${COMPILER}
    -D "CMAKE_CXX_FLAGS_DEBUG=-O0 -g" -D BUSBAR_TESTS=OFF -D BUSBAR_UNITY=ON
    -D BUSBAR_REPRODUCIBLE=ON)
  run(${CMAKE_COMMAND} --build ${source}/../out-of-${variable} --target busbar_core)
  file(SHA256 ${source}/../out-of-${variable}/lib/core/libbusbar_core.a sum)
  set(${variable} ${sum} PARENT_SCOPE)
endfunction()
built(first ${source})
# The same sources give the same bytes in another folder.
file(RENAME ${source} ${test}/elsewhere)
built(second ${test}/elsewhere)
if(NOT first STREQUAL second)
  message(FATAL_ERROR "in another folder, libbusbar_core.a has other bytes: ${first}, ${second}")
endif()
