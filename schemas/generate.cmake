# C++ types from NodeSet2 files, for Busbar's own namespace and for a vendor's companion models.
#
#   busbar_generate(<target>
#     NODESETS <file>...            NodeSet2 files of one namespace
#     [NAMESPACE_URI <uri>]         by default that of the first file's <Model>
#     [CPP_NAMESPACE <name>]        by default <target>
#     [INCLUDE_PATH <path>]         by default <target>: #include <path/types.hpp>
#     [DEPENDS <target>...]         targets of busbar_generate whose types are used
#     [GROUPS <file>] [IDS <file>]  see busbar-generate
#     [NODES]                       also <path/nodes.hpp>, for AddressSpace::add; links busbar::model
#   )
#
# makes the static library <target>, which links busbar::binary. The namespace of OPC UA itself is
# always among the dependencies. With BUSBAR_GENERATOR set, that program of the host is run;
# otherwise the generator is built here.
include_guard(GLOBAL)

set(BUSBAR_SCHEMAS_DIR ${CMAKE_CURRENT_LIST_DIR} CACHE INTERNAL "Where generate.cmake stands")
file(GLOB nodesets CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/Opc.Ua.*.NodeSet2.xml)
set(BUSBAR_NAMESPACE0_NODESETS ${nodesets} CACHE INTERNAL "The NodeSet2 files of OPC UA itself")

# Says what is missing where the generator cannot run.
function(busbar_check_generator)
  set(how "Build it once without your toolchain file, with the compiler of this machine:\n"
    "  cmake --preset host && cmake --build --preset host\n"
    "(in the sources of Busbar, with pugixml installed) and configure again with\n"
    "  -D BUSBAR_GENERATOR=.../build/host/bin/busbar-generate")
  string(CONCAT how ${how})
  if(BUSBAR_GENERATOR AND NOT EXISTS ${BUSBAR_GENERATOR})
    message(FATAL_ERROR "BUSBAR_GENERATOR names ${BUSBAR_GENERATOR}, which does not exist.\n${how}")
  elseif(CMAKE_CROSSCOMPILING AND NOT BUSBAR_GENERATOR)
    message(FATAL_ERROR "A cross build needs Busbar's generator of types and nodes as a program of "
      "this machine, and BUSBAR_GENERATOR does not name one.\n${how}")
  endif()
endfunction()

function(busbar_find_generator command_variable target_variable)
  busbar_check_generator()
  if(BUSBAR_GENERATOR)
    set(command ${BUSBAR_GENERATOR})
    set(target ${BUSBAR_GENERATOR})
  elseif(TARGET busbar-generate)
    set(command $<TARGET_FILE:busbar-generate>)
    set(target busbar-generate)
  else()
    # Installed: the program stands beside share/busbar.
    find_program(BUSBAR_INSTALLED_GENERATOR busbar-generate REQUIRED
      HINTS ${BUSBAR_SCHEMAS_DIR}/../../../bin)
    set(command ${BUSBAR_INSTALLED_GENERATOR})
    set(target ${BUSBAR_INSTALLED_GENERATOR})
  endif()
  set(${command_variable} ${command} PARENT_SCOPE)
  set(${target_variable} ${target} PARENT_SCOPE)
endfunction()

# The files that a run makes for the groups of a CSV, as far as they are known now.
function(busbar_generated_files folder groups sources_variable headers_variable)
  set(names structures)
  if(groups)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${groups})
    file(STRINGS ${groups} names)
    list(TRANSFORM names REPLACE "^.*," "")
    list(REMOVE_DUPLICATES names)
  endif()
  list(TRANSFORM names PREPEND ${folder}/)
  set(sources ${names})
  set(headers ${names} ${folder}/enumerations ${folder}/types ${folder}/fields ${folder}/ids
    ${folder}/registry)
  list(APPEND sources ${folder}/registry)
  list(TRANSFORM sources APPEND .cpp)
  list(TRANSFORM headers APPEND .hpp)
  set(${sources_variable} ${sources} PARENT_SCOPE)
  set(${headers_variable} ${headers} PARENT_SCOPE)
endfunction()

# The command that writes a namespace's types; its .cpp files are in `sources_variable`. The custom
# target <name> stands for all of its outputs.
function(busbar_generate_sources name sources_variable)
  cmake_parse_arguments(ARG "" "NAMESPACE_URI;CPP_NAMESPACE;INCLUDE_PATH;ROOT;GROUPS;IDS"
    "NODESETS;DEPENDENCIES" ${ARGN})
  busbar_find_generator(command generator)
  set(folder ${ARG_ROOT}/${ARG_INCLUDE_PATH})
  busbar_generated_files(${folder} "${ARG_GROUPS}" sources headers)
  set(arguments --output ${folder} --cpp-namespace ${ARG_CPP_NAMESPACE}
    --include-path ${ARG_INCLUDE_PATH})
  set(files ${ARG_NODESETS})
  foreach(option NAMESPACE_URI GROUPS IDS)
    if(ARG_${option})
      string(TOLOWER ${option} flag)
      string(REPLACE _ - flag ${flag})
      list(APPEND arguments --${flag} ${ARG_${option}})
    endif()
  endforeach()
  list(APPEND files ${ARG_GROUPS} ${ARG_IDS})
  foreach(dependency IN LISTS ARG_DEPENDENCIES)
    list(APPEND arguments --dependency ${dependency})
    string(REGEX REPLACE ",.*" "" file ${dependency})
    list(APPEND files ${file})
  endforeach()
  add_custom_command(OUTPUT ${sources} ${headers}
    COMMAND ${command} ${arguments} ${ARG_NODESETS}
    DEPENDS ${generator} ${files}
    COMMENT "Generating types in ${folder}"
    VERBATIM)
  add_custom_target(${name} DEPENDS ${sources} ${headers})
  set(${sources_variable} ${sources} PARENT_SCOPE)
endfunction()

# The command that writes a namespace's nodes as constant data, nodes.hpp and nodes.cpp.
function(busbar_generate_nodes name sources_variable)
  cmake_parse_arguments(ARG "ADDITION"
    "NAMESPACE_URI;CPP_NAMESPACE;INCLUDE_PATH;ROOT;NODE_LIST;FEATURE_LIST"
    "NODESETS;DEPENDENCIES;FEATURES;GIVEN" ${ARGN})
  busbar_find_generator(command generator)
  set(folder ${ARG_ROOT}/${ARG_INCLUDE_PATH})
  set(arguments --nodes --output ${folder} --cpp-namespace ${ARG_CPP_NAMESPACE}
    --include-path ${ARG_INCLUDE_PATH})
  if(ARG_NAMESPACE_URI)
    list(APPEND arguments --namespace-uri ${ARG_NAMESPACE_URI})
  endif()
  if(ARG_NODE_LIST)
    list(APPEND arguments --node-list ${ARG_NODE_LIST})
  endif()
  if(ARG_FEATURE_LIST)
    list(APPEND arguments --features ${ARG_FEATURE_LIST})
  endif()
  foreach(feature IN LISTS ARG_FEATURES)
    list(APPEND arguments --feature ${feature})
  endforeach()
  foreach(feature IN LISTS ARG_GIVEN)
    list(APPEND arguments --given ${feature})
  endforeach()
  if(ARG_ADDITION)
    list(APPEND arguments --addition)
  endif()
  set(files ${ARG_NODESETS} ${ARG_NODE_LIST} ${ARG_FEATURE_LIST})
  foreach(dependency IN LISTS ARG_DEPENDENCIES)
    list(APPEND arguments --dependency ${dependency})
    string(REGEX REPLACE ",.*" "" file ${dependency})
    list(APPEND files ${file})
  endforeach()
  add_custom_command(OUTPUT ${folder}/nodes.cpp ${folder}/nodes.hpp
    COMMAND ${command} ${arguments} ${ARG_NODESETS}
    DEPENDS ${generator} ${files}
    COMMENT "Generating nodes in ${folder}"
    VERBATIM)
  add_custom_target(${name} DEPENDS ${folder}/nodes.cpp ${folder}/nodes.hpp)
  set(${sources_variable} ${folder}/nodes.cpp PARENT_SCOPE)
endfunction()

# The command that writes the DataTypes of OPC UA itself, definitions.hpp and definitions.cpp.
function(busbar_generate_definitions name sources_variable)
  cmake_parse_arguments(ARG "" "INCLUDE_PATH;ROOT" "NODESETS" ${ARGN})
  busbar_find_generator(command generator)
  set(folder ${ARG_ROOT}/${ARG_INCLUDE_PATH})
  add_custom_command(OUTPUT ${folder}/definitions.cpp ${folder}/definitions.hpp
    COMMAND ${command} --definitions --output ${folder} --include-path ${ARG_INCLUDE_PATH}
      --namespace-uri http://opcfoundation.org/UA/ ${ARG_NODESETS}
    DEPENDS ${generator} ${ARG_NODESETS}
    COMMENT "Generating definitions in ${folder}"
    VERBATIM)
  add_custom_target(${name} DEPENDS ${folder}/definitions.cpp ${folder}/definitions.hpp)
  set(${sources_variable} ${folder}/definitions.cpp PARENT_SCOPE)
endfunction()

function(busbar_generate target)
  cmake_parse_arguments(ARG "NODES" "NAMESPACE_URI;CPP_NAMESPACE;INCLUDE_PATH;GROUPS;IDS"
    "NODESETS;DEPENDS" ${ARGN})
  foreach(option CPP_NAMESPACE INCLUDE_PATH)
    if(NOT ARG_${option})
      set(ARG_${option} ${target})
    endif()
  endforeach()
  list(TRANSFORM ARG_NODESETS REPLACE "^([^/].*)$" "${CMAKE_CURRENT_SOURCE_DIR}/\\1")
  list(TRANSFORM BUSBAR_NAMESPACE0_NODESETS APPEND ",busbar,busbar/types"
    OUTPUT_VARIABLE dependencies)
  foreach(other IN LISTS ARG_DEPENDS)
    get_target_property(others ${other} BUSBAR_DEPENDENCIES)
    list(APPEND dependencies ${others})
  endforeach()
  list(REMOVE_DUPLICATES dependencies)
  set(root ${CMAKE_CURRENT_BINARY_DIR}/${target})
  busbar_generate_sources(${target}_types sources
    NODESETS ${ARG_NODESETS} DEPENDENCIES ${dependencies} ROOT ${root}
    NAMESPACE_URI ${ARG_NAMESPACE_URI} CPP_NAMESPACE ${ARG_CPP_NAMESPACE}
    INCLUDE_PATH ${ARG_INCLUDE_PATH} GROUPS ${ARG_GROUPS} IDS ${ARG_IDS})
  if(ARG_NODES)
    busbar_generate_nodes(${target}_nodes nodes_source
      NODESETS ${ARG_NODESETS} DEPENDENCIES ${dependencies} ROOT ${root}
      NAMESPACE_URI ${ARG_NAMESPACE_URI} CPP_NAMESPACE ${ARG_CPP_NAMESPACE}
      INCLUDE_PATH ${ARG_INCLUDE_PATH})
    list(APPEND sources ${nodes_source})
  endif()
  add_library(${target} STATIC ${sources})
  add_dependencies(${target} ${target}_types)
  if(ARG_NODES)
    add_dependencies(${target} ${target}_nodes)
    target_link_libraries(${target} PUBLIC busbar::model)
  endif()
  target_include_directories(${target} PUBLIC ${root})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_link_libraries(${target} PUBLIC busbar::binary ${ARG_DEPENDS})
  list(TRANSFORM ARG_NODESETS APPEND ",${ARG_CPP_NAMESPACE},${ARG_INCLUDE_PATH}"
    OUTPUT_VARIABLE own)
  set_target_properties(${target} PROPERTIES BUSBAR_DEPENDENCIES "${dependencies};${own}")
endfunction()
