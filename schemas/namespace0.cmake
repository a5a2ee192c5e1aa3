# The types of OPC UA itself, which are part of busbar::binary, and the generator if it is built
# here. Leaves BUSBAR_GENERATED_TYPES_SOURCES, BUSBAR_GENERATED_DEFINITIONS_SOURCES and the targets
# busbar_generated_types and busbar_generated_definitions.
include(${CMAKE_CURRENT_LIST_DIR}/generate.cmake)

busbar_check_generator()
find_package(pugixml QUIET)
if(NOT pugixml_FOUND AND NOT BUSBAR_GENERATOR)
  message(FATAL_ERROR "pugixml is missing: the generator of types and nodes reads XML with it "
    "(Debian: libpugixml-dev). A build whose BUSBAR_GENERATOR names a generator made elsewhere "
    "does without, and without busbar::nodeset.")
endif()
if(pugixml_FOUND)
  add_subdirectory(${PROJECT_SOURCE_DIR}/lib/model/nodeset
    ${PROJECT_BINARY_DIR}/lib/model/nodeset)
endif()
if(NOT BUSBAR_GENERATOR)
  add_subdirectory(${CMAKE_CURRENT_LIST_DIR}/generator ${PROJECT_BINARY_DIR}/schemas/generator)
endif()

busbar_generate_sources(busbar_generated_types BUSBAR_GENERATED_TYPES_SOURCES
  NODESETS ${BUSBAR_NAMESPACE0_NODESETS}
  NAMESPACE_URI http://opcfoundation.org/UA/
  CPP_NAMESPACE busbar
  INCLUDE_PATH busbar/types
  ROOT ${BUSBAR_GENERATED_DIR}
  GROUPS ${CMAKE_CURRENT_LIST_DIR}/groups.csv
  IDS ${CMAKE_CURRENT_LIST_DIR}/NodeIds.csv)

busbar_generate_definitions(busbar_generated_definitions BUSBAR_GENERATED_DEFINITIONS_SOURCES
  NODESETS ${BUSBAR_NAMESPACE0_NODESETS}
  INCLUDE_PATH busbar/definitions
  ROOT ${BUSBAR_GENERATED_DIR})

install(DIRECTORY ${BUSBAR_GENERATED_DIR}/busbar/types
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/busbar FILES_MATCHING PATTERN "*.hpp")
# A vendor's project generates from its own models with these.
install(FILES ${BUSBAR_NAMESPACE0_NODESETS} ${CMAKE_CURRENT_LIST_DIR}/generate.cmake
  DESTINATION ${CMAKE_INSTALL_DATADIR}/busbar/schemas)
install(DIRECTORY ${CMAKE_CURRENT_LIST_DIR}/companion
  DESTINATION ${CMAKE_INSTALL_DATADIR}/busbar/schemas FILES_MATCHING PATTERN "*.xml")
if(NOT BUSBAR_GENERATOR)
  busbar_install_program(busbar-generate development)
elseif(NOT CMAKE_CROSSCOMPILING)
  # A cross build's package is used by one that names a generator of its own machine itself.
  install(PROGRAMS ${BUSBAR_GENERATOR} DESTINATION ${CMAKE_INSTALL_BINDIR} RENAME busbar-generate)
endif()
