# Status codes, attribute ids and the first NodeIds: CSV facts to C++ headers at configure time.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
  ${CMAKE_CURRENT_LIST_DIR}/StatusCode.csv ${CMAKE_CURRENT_LIST_DIR}/AttributeId.csv
  ${CMAKE_CURRENT_LIST_DIR}/NodeIds.csv)

file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/StatusCode.csv rows)
set(constants "")
set(names "")
foreach(row IN LISTS rows)
  if(row MATCHES "^([A-Za-z_0-9]+),(0x[0-9A-Fa-f]+)$")
    string(APPEND constants
      "inline constexpr StatusCode ${CMAKE_MATCH_1}{${CMAKE_MATCH_2}U};\n")
    string(APPEND names "    {${CMAKE_MATCH_2}U, \"${CMAKE_MATCH_1}\"},\n")
  endif()
endforeach()
file(CONFIGURE OUTPUT ${BUSBAR_GENERATED_DIR}/busbar/core/status_codes.hpp @ONLY CONTENT
"// Generated from schemas/StatusCode.csv.
#pragma once

#include <busbar/core/status_code.hpp>

/// Every StatusCode of Part 6, A.2, by its symbolic name.
namespace busbar::status {

@constants@
} // namespace busbar::status
")
file(CONFIGURE OUTPUT ${BUSBAR_GENERATED_DIR}/busbar/core/status_names.inc @ONLY CONTENT
"// Generated from schemas/StatusCode.csv.
@names@")

file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/AttributeId.csv rows)
set(constants "")
set(names "")
foreach(row IN LISTS rows)
  if(row MATCHES "^([A-Za-z]+),([0-9]+)$")
    string(APPEND constants "    ${CMAKE_MATCH_1} = ${CMAKE_MATCH_2},\n")
    string(APPEND names "    \"${CMAKE_MATCH_1}\",\n")
  endif()
endforeach()
file(CONFIGURE OUTPUT ${BUSBAR_GENERATED_DIR}/busbar/core/attribute_names.inc @ONLY CONTENT
"// Generated from schemas/AttributeId.csv.
@names@")
file(CONFIGURE OUTPUT ${BUSBAR_GENERATED_DIR}/busbar/core/attribute_id.hpp @ONLY CONTENT
"// Generated from schemas/AttributeId.csv.
#pragma once

#include <cstdint>

namespace busbar {

/// Identifiers of a Node's attributes (Part 6, A.1).
enum class AttributeId : std::uint32_t {
@constants@};

} // namespace busbar
")

# The NodeIds that are needed before, or without, all of busbar/types/ids.hpp.
file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/NodeIds.csv rows)
set(constants "")
foreach(name Structure Number Integer UInteger Enumeration Decimal OptionSet Union IdType
    StructureType HierarchicalReferences HasChild HasModellingRule HasEncoding HasTypeDefinition
    HasSubtype HasProperty HasComponent HasOrderedComponent Organizes RootFolder
    StructureDefinition_Encoding_DefaultBinary EnumDefinition_Encoding_DefaultBinary
    RolePermissionType_Encoding_DefaultBinary)
  set(row ${rows})
  list(FILTER row INCLUDE REGEX "^${name},[0-9]+,")
  if(NOT row MATCHES "^${name},([0-9]+),[A-Za-z]+$")
    message(FATAL_ERROR "schemas/NodeIds.csv has not one ${name}")
  endif()
  string(APPEND constants "inline constexpr std::uint32_t ${name} = ${CMAKE_MATCH_1};\n")
endforeach()
file(CONFIGURE OUTPUT ${BUSBAR_GENERATED_DIR}/busbar/core/detail/basic_ids.hpp @ONLY CONTENT
"// Generated from schemas/NodeIds.csv.
#pragma once

#include <cstdint>

/// The first of the NodeIds in busbar/types/ids.hpp, for what is built before that or may not cost
/// as much to include.
namespace busbar::detail::basic_id {

@constants@
} // namespace busbar::detail::basic_id
")
