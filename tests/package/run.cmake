# Wants BUILD_DIR, SOURCE_DIR, GENERATOR, COMPILER, SANITIZE, LIBDIR and PKG_CONFIG; LAUNCHER, a
# command in front of the compiler's as CMake has it, may be empty.
set(test ${BUILD_DIR}/package-test)
file(REMOVE_RECURSE ${test})

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output
    ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

set(ENV{CMAKE_CXX_COMPILER_LAUNCHER} "${LAUNCHER}")
set(flags "")
if(SANITIZE)
  set(flags "-fsanitize=${SANITIZE}")
endif()

# An installation may be moved.
set(prefix ${test}/prefix)
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${test}/installed)
file(RENAME ${test}/installed ${prefix})

run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE_DIR}/consumer -B ${test}/build
  -D MODEL=${SOURCE_DIR}/../schemas/acme.NodeSet2.xml -D CMAKE_PREFIX_PATH=${prefix}
  -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_CXX_FLAGS=${flags})
run(${CMAKE_COMMAND} --build ${test}/build)
run(${test}/build/consumer)
if(EXISTS ${prefix}/bin/busbar)
  # A PLC maker's controller around his own runtime, beside the installed tool.
  set(vendor ${SOURCE_DIR}/../../examples/vendor_runtime)
  run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${vendor} -B ${test}/vendor
    -D CMAKE_PREFIX_PATH=${prefix} -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_CXX_FLAGS=${flags})
  run(${CMAKE_COMMAND} --build ${test}/vendor)
  run(sh ${SOURCE_DIR}/../programs/acceptance/vendor_test.sh ${test}/vendor/vendor-runtime
    ${prefix}/bin/busbar ${vendor})
  # The first project of a newcomer, as README.md shows it.
  run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE_DIR}/../../examples/first_server
    -B ${test}/first_server -D CMAKE_PREFIX_PATH=${prefix} -D CMAKE_CXX_COMPILER=${COMPILER}
    -D CMAKE_CXX_FLAGS=${flags})
  run(${CMAKE_COMMAND} --build ${test}/first_server)
endif()

if(PKG_CONFIG)
  set(ENV{PKG_CONFIG_PATH} ${prefix}/${LIBDIR}/pkgconfig)
  run(${PKG_CONFIG} --cflags busbar-server busbar-harness)
  separate_arguments(cflags UNIX_COMMAND "${output}")
  run(${LAUNCHER} ${COMPILER} -std=c++20 ${flags} ${cflags} -MD -c ${SOURCE_DIR}/plain/main.cpp
    -o ${test}/plain.o)
  run(${PKG_CONFIG} --libs busbar-server busbar-harness)
  separate_arguments(libs UNIX_COMMAND "${output}")
  run(${COMPILER} ${flags} ${test}/plain.o -o ${test}/plain ${libs})
  set(ENV{LD_LIBRARY_PATH} ${prefix}/${LIBDIR})
  run(${test}/plain)
endif()
