# Wants BUILD_DIR, SOURCE_DIR, GENERATOR, COMPILER, SANITIZE, LIBDIR, VERSION, SHARED and PKG_CONFIG;
# LAUNCHER, a command in front of the compiler's as CMake has it, may be empty.
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

# What is installed says itself what it is: a version, a manual page, completions of its options.
file(GLOB programs ${prefix}/bin/*)
foreach(program IN LISTS programs)
  get_filename_component(name ${program} NAME)
  set(ENV{LD_LIBRARY_PATH} ${prefix}/${LIBDIR})
  run(${program} --version)
  if(NOT output STREQUAL "${name} ${VERSION}\n")
    message(FATAL_ERROR "${name} --version: expected ${name} ${VERSION}, found ${output}")
  endif()
  run(${program} --help)
  string(REGEX MATCHALL "--[a-z][a-z-]+" options "${output}")
  file(GLOB page ${prefix}/share/man/man1/${name}.1*)
  run(gzip -cdf ${page})
  string(REPLACE "\\-" "-" page "${output}")
  foreach(option IN LISTS options)
    string(FIND "${page}" "${option}" place)
    if(place EQUAL -1)
      message(FATAL_ERROR "the manual page of ${name} does not have ${option}, which --help has")
    endif()
  endforeach()
  set(completions ${prefix}/share/bash-completion/completions/${name})
  if(EXISTS ${completions})
    run(bash -n ${completions})
    file(STRINGS ${completions} complete REGEX "^complete .* ${name}$")
    # The script asks the program.
    execute_process(COMMAND ${prefix}/bin/${name} --complete "${name} --vers"
      OUTPUT_VARIABLE words OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(NOT complete OR NOT words STREQUAL "--version")
      message(FATAL_ERROR "${completions} does not complete ${name} --version")
    endif()
  elseif(NOT name STREQUAL "busbar-generate")
    message(FATAL_ERROR "there is no ${completions}")
  endif()
endforeach()
if(EXISTS ${prefix}/bin/busbar)
  file(STRINGS ${prefix}/share/zsh/vendor-completions/_busbar words LIMIT_COUNT 1)
  if(NOT words STREQUAL "#compdef busbar")
    message(FATAL_ERROR "share/zsh/vendor-completions/_busbar begins with \"${words}\"")
  endif()
endif()
foreach(file LICENSE CHANGELOG.md examples/first_server/main.cpp)
  if(NOT EXISTS ${prefix}/share/doc/busbar/${file})
    message(FATAL_ERROR "share/doc/busbar/${file} is not installed")
  endif()
endforeach()

# components(<found> <text> <components> <options>...): whether find_package finds these, and what
# it says.
function(components found text wanted)
  file(REMOVE_RECURSE ${test}/components)
  run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE_DIR}/components -B ${test}/components
    -D WANTED=${wanted} -D CMAKE_PREFIX_PATH=${prefix} -D CMAKE_CXX_COMPILER=${COMPILER} ${ARGN})
  # A message is wrapped.
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  if(NOT output MATCHES "busbar found: ${found} " OR NOT output MATCHES "${text}")
    message(FATAL_ERROR "components ${wanted}: expected \"${text}\" and found: ${found}, ${output}")
  endif()
endfunction()
components(1 "server found: TRUE" server)
components(0 "busbar has no component sever; it was installed with core, binary, " server,sever)
if(NOT SHARED)
  components(0 "component crypto of busbar needs OpenSSL 3 .Debian: libssl-dev., which was not"
    crypto -D CMAKE_DISABLE_FIND_PACKAGE_OpenSSL=ON)
  components(1 "model found: TRUE" model -D CMAKE_DISABLE_FIND_PACKAGE_OpenSSL=ON)
endif()
if(EXISTS ${prefix}/${LIBDIR}/pkgconfig/busbar-net.pc)
  components(1 "net found: TRUE" server,net)
  components(0 "component net of busbar needs Asio without Boost, asio.hpp .Debian: libasio-dev."
    net -D busbar_ASIO_INCLUDE_DIR=busbar_ASIO_INCLUDE_DIR-NOTFOUND
    -D CMAKE_FIND_USE_CMAKE_SYSTEM_PATH=OFF)
endif()

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

find_program(C_COMPILER cc)
if(C_COMPILER AND NOT SANITIZE AND EXISTS ${prefix}/${LIBDIR}/pkgconfig/busbar-c.pc)
  run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE_DIR}/in_c -B ${test}/in_c
    -D CMAKE_PREFIX_PATH=${prefix} -D CMAKE_CXX_COMPILER=${COMPILER})
  run(${CMAKE_COMMAND} --build ${test}/in_c)
  run(${test}/in_c/in_c)
  if(PKG_CONFIG)
    set(ENV{PKG_CONFIG_PATH} ${prefix}/${LIBDIR}/pkgconfig)
    run(${PKG_CONFIG} --cflags --libs busbar-c)
    separate_arguments(all UNIX_COMMAND "${output}")
    run(${C_COMPILER} -std=c99 -Wall -Wextra -pedantic -Werror ${SOURCE_DIR}/in_c/main.c
      -o ${test}/plain_c ${all})
    run(${test}/plain_c)
  endif()
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
