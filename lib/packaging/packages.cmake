# What `cpack` makes of a build: packages for Debian, and with CPackSourceConfig.cmake a tarball of
# the sources, which needs no git to be built.
if(NOT PROJECT_IS_TOP_LEVEL)
  return()
endif()
set(BUSBAR_PACKAGE_RELEASE 1 CACHE STRING "Which packages of this version these are")
set(BUSBAR_STATE_DIR ${CMAKE_INSTALL_FULL_LOCALSTATEDIR}/lib/busbar)
set(BUSBAR_CONFIG_DIR ${CMAKE_INSTALL_FULL_SYSCONFDIR}/busbar)

if(TARGET busbar-controller AND LINUX)
  include(${CMAKE_CURRENT_LIST_DIR}/controller.toml.cmake)
  configure_file(${CMAKE_CURRENT_LIST_DIR}/busbar-controller.service.in
    ${PROJECT_BINARY_DIR}/packaging/busbar-controller.service @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/packaging/busbar-controller.service
    DESTINATION lib/systemd/system COMPONENT controller)
  # Below the prefix; finish.cmake moves what has /usr as its prefix to /etc.
  install(FILES ${PROJECT_BINARY_DIR}/packaging/controller.toml
    DESTINATION ${CMAKE_INSTALL_SYSCONFDIR}/busbar COMPONENT controller)
endif()

set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_PACKAGE_NAME busbar)
set(CPACK_PACKAGE_VENDOR Busbar)
set(CPACK_PACKAGE_CONTACT "Busbar maintainers <maintainers@busbar.example>")
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_GENERATOR DEB)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/finish.cmake)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL development)
if(BUILD_SHARED_LIBS)
  list(APPEND CPACK_COMPONENTS_ALL runtime)
endif()
if(TARGET busbar-controller)
  list(APPEND CPACK_COMPONENTS_ALL controller tools)
endif()
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE ${BUSBAR_PACKAGE_RELEASE})
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/packaging/libraries)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)

set(packages "")
# busbar_package(<component> <name> <section> <summary> <text>)
macro(busbar_package component name section summary text)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section})
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${summary}\n${text}")
  list(APPEND packages ${component}=${name})
endmacro()
busbar_package(runtime libbusbar libs "OPC UA binary protocol stack, shared libraries"
  "Server and client over one codec and one secure channel, a controller in
front of PLCs, and the network layer.")
busbar_package(development libbusbar-dev libdevel
  "OPC UA binary protocol stack, for building with it"
  "Headers, packages for CMake and pkg-config, the generator that makes C++
types of NodeSet2 files, and examples.")
busbar_package(controller busbar-controller net "OPC UA server in front of a PLC, as a service"
  "A machine controller that publishes its variables, or a model that is
mapped to labels, with certificates, users, logs and backups. It runs as its
own user, with what it does not need taken away.")
busbar_package(tools busbar-tools net "command line tools for OPC UA servers"
  "busbar browses, reads, writes, watches and administers; busbar-bench
measures servers.")

set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/deb/triggers)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
  "libssl-dev (>= 3), libpugixml-dev, libasio-dev")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "cmake, pkg-config, g++")
set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS "bash-completion")
set(CPACK_DEBIAN_CONTROLLER_PACKAGE_DEPENDS adduser)
set(CPACK_DEBIAN_CONTROLLER_PACKAGE_SUGGESTS "busbar-tools")
set(scripts ${CMAKE_CURRENT_LIST_DIR}/deb)
set(CPACK_DEBIAN_CONTROLLER_PACKAGE_CONTROL_EXTRA ${scripts}/conffiles ${scripts}/postinst
  ${scripts}/prerm ${scripts}/postrm)
set(CPACK_DEBIAN_CONTROLLER_PACKAGE_CONTROL_STRICT_PERMISSION ON)
if(BUILD_SHARED_LIBS)
  set(CPACK_COMPONENT_DEVELOPMENT_DEPENDS runtime)
  set(CPACK_COMPONENT_CONTROLLER_DEPENDS runtime)
  set(CPACK_COMPONENT_TOOLS_DEPENDS runtime)
endif()

# What is compiled in of others, for the bill of materials: name, version, licence, its place, and
# the components that have it.
set(static "")
if(NOT BUILD_SHARED_LIBS)
  set(static ",controller,tools")
endif()
macro(busbar_part name version licence locator components)
  list(APPEND parts "${name}|${version}|${licence}|${locator}|${components}")
endmacro()
function(busbar_header_number variable file name)
  file(STRINGS ${file} line REGEX "define ${name} ")
  string(REGEX MATCH "[0-9]+" number "${line}")
  set(${variable} ${number} PARENT_SCOPE)
endfunction()
set(parts "")
if(ASIO_INCLUDE_DIR)
  busbar_header_number(number ${ASIO_INCLUDE_DIR}/asio/version.hpp ASIO_VERSION)
  math(EXPR major "${number} / 100000")
  math(EXPR minor "${number} / 100 % 1000")
  math(EXPR patch "${number} % 100")
  busbar_part(asio ${major}.${minor}.${patch} BSL-1.0 https://think-async.com/Asio
    runtime,development${static})
endif()
if(TARGET busbar-controller)
  find_package(CLI11 REQUIRED)
  busbar_part(CLI11 ${CLI11_VERSION} BSD-3-Clause https://github.com/CLIUtils/CLI11
    development,controller,tools)
  set(version_file ${TOMLPLUSPLUS_INCLUDE_DIR}/toml++/impl/version.h)
  if(EXISTS ${version_file})
    foreach(step MAJOR MINOR PATCH)
      busbar_header_number(toml_${step} ${version_file} TOML_LIB_${step})
    endforeach()
    busbar_part(tomlplusplus ${toml_MAJOR}.${toml_MINOR}.${toml_PATCH} MIT
      https://github.com/marzer/tomlplusplus development,controller,tools)
  endif()
endif()

# What finish.cmake wants to know; cpack is told what begins with CPACK.
set(CPACK_BUSBAR_PACKAGES ${packages})
set(CPACK_BUSBAR_PARTS ${parts})
set(CPACK_BUSBAR_SOURCE_DIR ${PROJECT_SOURCE_DIR})
set(CPACK_BUSBAR_LIBRARIES ${PROJECT_BINARY_DIR}/packaging/libraries)
set(CPACK_BUSBAR_VERSION ${PROJECT_VERSION}-${BUSBAR_PACKAGE_RELEASE})
set(CPACK_BUSBAR_LIBDIR ${CMAKE_INSTALL_LIBDIR})

set(CPACK_SOURCE_GENERATOR TGZ)
set(CPACK_SOURCE_PACKAGE_FILE_NAME busbar-${PROJECT_VERSION})
set(CPACK_SOURCE_IGNORE_FILES "^${PROJECT_SOURCE_DIR}/([.]git|build|[.]cache)/" /node_modules/
  /compile_commands[.]json$)
include(CPack)
