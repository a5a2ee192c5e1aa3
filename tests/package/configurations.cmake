# Configures what users may choose and looks at the commands that come of it; builds nothing.
# Wants SOURCE_DIR, BUILD_DIR, GENERATOR, COMPILER and ARCHITECTURE, CMake's name of it.

# expect(<name> <wanted> <unwanted> <options>...): each command of core matches the first regular
# expression and not the second. With SAME_COMPILER first, CMake is told what it found out about the
# compiler for "default": the options must not change that.
function(expect name wanted unwanted)
  set(trees ${BUILD_DIR}/configurations-test)
  set(tree ${trees}/${name})
  file(REMOVE_RECURSE ${tree})
  cmake_parse_arguments(ARG SAME_COMPILER "" "" ${ARGN})
  if(ARG_SAME_COMPILER)
    file(COPY ${trees}/default/CMakeFiles/${CMAKE_VERSION} DESTINATION ${tree}/CMakeFiles)
  endif()
  execute_process(COMMAND ${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE_DIR} -B ${tree}
      -D CMAKE_CXX_COMPILER=${COMPILER} -D BUSBAR_TESTS=OFF ${ARG_UNPARSED_ARGUMENTS}
    RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${name}: ${output}")
  endif()
  file(STRINGS ${tree}/compile_commands.json commands REGEX "\"command\".*lib/core/[a-z_]+[.]cpp")
  foreach(command IN LISTS commands)
    if(NOT command MATCHES "${wanted}" OR command MATCHES "${unwanted}")
      message(FATAL_ERROR "${name}: expected ${wanted} and no ${unwanted}, found ${command}")
    endif()
  endforeach()
  if(NOT commands)
    message(FATAL_ERROR "${name}: no layer is compiled")
  endif()
endfunction()

expect(default "-fPIC .*-std=c[+][+]20 " "-Werror|visibility|-flto")
expect(newer " -std=c[+][+](23|2b) " "-Werror" SAME_COMPILER -D CMAKE_CXX_STANDARD=23)
expect(fixed-address " -c " "-fPIC" SAME_COMPILER -D CMAKE_POSITION_INDEPENDENT_CODE=OFF)
expect(optimized-together " -flto" "-Werror" -D CMAKE_INTERPROCEDURAL_OPTIMIZATION=ON)
# As for a target that nothing can be linked for: CMake looks into an object file then.
expect(optimized-by-flags " -flto" "-Werror" -D CMAKE_CXX_FLAGS=-flto
  -D CMAKE_TRY_COMPILE_TARGET_TYPE=STATIC_LIBRARY -D CMAKE_LIBRARY_ARCHITECTURE=${ARCHITECTURE})
file(READ ${BUILD_DIR}/configurations-test/optimized-by-flags/busbar-config-version.cmake version)
if(version MATCHES "OR \"\" STREQUAL \"\"")
  message(FATAL_ERROR "optimized-by-flags: CMake does not know the size of a pointer")
endif()
expect(shared " -fvisibility=hidden .*-fvisibility-inlines-hidden" "-Werror|_EXPORTS"
  SAME_COMPILER -D BUILD_SHARED_LIBS=ON)
expect(strict " -Werror" "-flto" SAME_COMPILER -D BUSBAR_WARNINGS_AS_ERRORS=ON)
