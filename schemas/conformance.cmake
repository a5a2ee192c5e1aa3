# Profiles and conformance units of Part 7: profiles.csv and conformance.csv to a table for
# lib/server/diagnostics/conformance.cpp.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
  ${CMAKE_CURRENT_LIST_DIR}/profiles.csv ${CMAKE_CURRENT_LIST_DIR}/conformance.csv)

function(busbar_conformance_error place expected found)
  message(FATAL_ERROR "schemas/${place}: expected ${expected}, found \"${found}\"")
endfunction()

# busbar_read_conformance(<file> <header> <rows>): the rows of a file that begins with the header.
function(busbar_read_conformance file header rows)
  file(STRINGS ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/${file} all ENCODING UTF-8)
  list(GET all 0 first)
  # Not list(POP_FRONT), after which a semicolon within a row would part it.
  string(FIND "${all};" ";" end)
  math(EXPR end "${end} + 1")
  string(SUBSTRING "${all};" ${end} -1 all)
  string(REGEX REPLACE ";$" "" all "${all}")
  if(NOT first STREQUAL header)
    busbar_conformance_error(${file}:1 "\"${header}\"" "${first}")
  endif()
  set(${rows} "${all}" PARENT_SCOPE)
endfunction()

# The NodeId of an ObjectType or VariableType of namespace 0, or of the declaration of a Property
# that any node may have: NodeVersion.
function(busbar_type_id name place result)
  file(STRINGS ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/NodeIds.csv row
    REGEX "^${name},[0-9]+,((Object|Variable)Type|Variable)$")
  if(NOT row MATCHES ",([0-9]+),")
    busbar_conformance_error(${place} "instance: and a type that is in NodeIds.csv" "${name}")
  endif()
  set(${result} ${CMAKE_MATCH_1} PARENT_SCOPE)
endfunction()

# busbar_conformance_word(<word> <place> <result>): the C++ of one word of the column `needs`.
function(busbar_conformance_word word place result)
  set(flags methods events node_management diagnostics triggering transfer audit roles push
    state_change user_management discovery reverse_connect tcp client)
  set(numbers sessions channels subscriptions items publish queue continuation_points)
  set(users password certificate issued anonymous unencrypted)
  set(policies None Basic256Sha256 Aes128 Aes256)
  set(sizes micro embedded standard full)
  set(enumerators Micro Embedded Standard Full)
  if(word IN_LIST flags)
    set(text "flag(&ConformanceFacts::${word})")
  elseif(word MATCHES "^(application|documentation|host)$")
    set(text "declared()")
  elseif(word STREQUAL "absent")
    set(text "absent()")
  elseif(word STREQUAL "security:any")
    string(CONCAT text "flag(&ConformanceFacts::policy_basic256sha256), "
      "flag(&ConformanceFacts::policy_aes128), flag(&ConformanceFacts::policy_aes256)")
  elseif(word MATCHES "^security:(.+)$" AND CMAKE_MATCH_1 IN_LIST policies)
    string(TOLOWER ${CMAKE_MATCH_1} policy)
    set(text "flag(&ConformanceFacts::policy_${policy})")
  elseif(word MATCHES "^users:(.+)$" AND CMAKE_MATCH_1 IN_LIST users)
    set(text "flag(&ConformanceFacts::users_${CMAKE_MATCH_1})")
  elseif(word MATCHES "^namespace0>=(.+)$" AND CMAKE_MATCH_1 IN_LIST sizes)
    list(FIND sizes ${CMAKE_MATCH_1} size)
    list(GET enumerators ${size} size)
    set(text "at_least(Namespace0Size::${size})")
  elseif(word MATCHES "^([a-z_]+)>=([1-9][0-9]*)$" AND CMAKE_MATCH_1 IN_LIST numbers)
    set(text "at_least(&ConformanceFacts::${CMAKE_MATCH_1}, ${CMAKE_MATCH_2})")
  elseif(word MATCHES "^instance:([A-Za-z0-9]+)$")
    busbar_type_id(${CMAKE_MATCH_1} ${place} type)
    set(text "instance_of(${type})")
  else()
    busbar_conformance_error(${place} "a word that schemas/README.md lists" "${word}")
  endif()
  set(${result} "${text}" PARENT_SCOPE)
endfunction()

# Reads profiles.csv into `keys`, and `uri_<key>` and `includes_<key>`.
macro(busbar_read_profiles)
  busbar_read_conformance(profiles.csv "profile,uri,includes" rows)
  set(keys "")
  set(line 1)
  foreach(row IN LISTS rows)
    math(EXPR line "${line} + 1")
    if(NOT row MATCHES "^([A-Z][A-Za-z0-9]*),(http://[A-Za-z0-9/_.#-]+),([A-Za-z0-9;]*)$")
      busbar_conformance_error(profiles.csv:${line} "profile,uri,profile;profile;..." "${row}")
    endif()
    if(CMAKE_MATCH_1 IN_LIST keys)
      busbar_conformance_error(profiles.csv:${line} "a profile that was not named yet" "${row}")
    endif()
    list(APPEND keys ${CMAKE_MATCH_1})
    set(uri_${CMAKE_MATCH_1} ${CMAKE_MATCH_2})
    set(includes_${CMAKE_MATCH_1} "${CMAKE_MATCH_3}")
    set(line_${CMAKE_MATCH_1} ${line})
    set(units_${CMAKE_MATCH_1} "")
  endforeach()
endmacro()

# Adds unit number `unit` to the profiles that one row names; mandatory unless a '?' is in front.
macro(busbar_add_to_facets facets place)
  foreach(facet IN ITEMS ${facets})
    string(REGEX REPLACE "^\\?" "" key "${facet}")
    if(NOT key IN_LIST keys)
      busbar_conformance_error(${place} "a profile that profiles.csv has" "${facet}")
    endif()
    if(key STREQUAL facet)
      list(APPEND units_${key} ${unit})
    endif()
  endforeach()
endmacro()

# Adds the clauses of one row to `words` and `clauses`; what was added before is found again.
macro(busbar_add_needs needs place)
  foreach(clause IN ITEMS ${needs})
    if(NOT DEFINED clause_${clause})
      set(clause_${clause} ${clause_count})
      math(EXPR clause_count "${clause_count} + 1")
      string(REPLACE "|" ";" alternatives "${clause}")
      set(all "")
      foreach(word IN LISTS alternatives)
        busbar_conformance_word("${word}" ${place} text)
        list(APPEND all "${text}")
      endforeach()
      list(JOIN all ", " all)
      string(REGEX MATCHALL "\\(" parts "${all}")
      list(LENGTH parts count)
      string(APPEND words "    ${all},\n")
      string(APPEND clauses "    {\"${clause}\", ${word_count}, ${count}},\n")
      math(EXPR word_count "${word_count} + ${count}")
    endif()
    string(APPEND unit_clauses "${clause_${clause}}, ")
    math(EXPR unit_clause_count "${unit_clause_count} + 1")
  endforeach()
endmacro()

# Reads conformance.csv into `units` and what they refer to.
macro(busbar_read_units)
  busbar_read_conformance(conformance.csv "unit,id,facets,needs,tag" rows)
  set(unit 0)
  set(names "")
  foreach(row IN LISTS rows)
    math(EXPR line "${unit} + 2")
    set(place conformance.csv:${line})
    if(NOT row MATCHES "^([^],;\"\\[]+),([0-9]*),([A-Za-z0-9;?]+),([^],\"\\[ ]*),([^,;\"]*)$")
      busbar_conformance_error(${place} "unit,id,facet;?facet;...,need;need|need;...,tag" "${row}")
    endif()
    set(name "${CMAKE_MATCH_1}")
    set(facets "${CMAKE_MATCH_3}")
    set(needs "${CMAKE_MATCH_4}")
    set(tag "${CMAKE_MATCH_5}")
    if(name IN_LIST names)
      busbar_conformance_error(${place} "a unit that was not named yet" "${name}")
    endif()
    list(APPEND names "${name}")
    if(NOT tag STREQUAL "" AND NOT tag STREQUAL "[unit:${name}]")
      busbar_conformance_error(${place} "no tag or [unit:${name}]" "${tag}")
    endif()
    set(first ${unit_clause_count})
    busbar_add_needs("${needs}" ${place})
    math(EXPR count "${unit_clause_count} - ${first}")
    set(has_test true)
    if(tag STREQUAL "")
      set(has_test false)
    endif()
    string(APPEND units "    {\"${name}\", ${first}, ${count}, ${has_test}},\n")
    busbar_add_to_facets("${facets}" ${place})
    math(EXPR unit "${unit} + 1")
  endforeach()
endmacro()

# Makes `profiles`, `profile_includes` and `profile_units` of what was read.
macro(busbar_write_profiles)
  set(first_include 0)
  set(first_unit 0)
  foreach(key IN LISTS keys)
    foreach(included IN LISTS includes_${key})
      list(FIND keys ${included} index)
      if(index EQUAL -1)
        busbar_conformance_error(profiles.csv:${line_${key}} "a profile of the file" ${included})
      endif()
      string(APPEND profile_includes "${index}, ")
    endforeach()
    foreach(index IN LISTS units_${key})
      string(APPEND profile_units "${index}, ")
    endforeach()
    list(LENGTH includes_${key} include_count)
    list(LENGTH units_${key} count)
    if(include_count EQUAL 0 AND count EQUAL 0)
      busbar_conformance_error(profiles.csv:${line_${key}} "a profile with a mandatory unit" ${key})
    endif()
    string(APPEND profiles "    {\"${key}\", \"${uri_${key}}\",\n"
      "     ${first_include}, ${include_count}, ${first_unit}, ${count}},\n")
    math(EXPR first_include "${first_include} + ${include_count}")
    math(EXPR first_unit "${first_unit} + ${count}")
  endforeach()
endmacro()

function(busbar_generate_conformance)
  foreach(table words clauses unit_clauses units profiles profile_includes profile_units)
    set(${table} "")
  endforeach()
  set(clause_count 0)
  set(word_count 0)
  set(unit_clause_count 0)
  busbar_read_profiles()
  busbar_read_units()
  busbar_write_profiles()
  file(CONFIGURE OUTPUT ${BUSBAR_GENERATED_DIR}/busbar/server/conformance_table.inc @ONLY CONTENT
"// Generated from schemas/profiles.csv and schemas/conformance.csv.
constexpr Word words[]{
@words@};

constexpr ClauseRow clause_rows[]{
@clauses@};

constexpr std::uint16_t unit_clauses[]{@unit_clauses@};

constexpr UnitRow unit_rows[]{
@units@};

constexpr std::uint16_t profile_includes[]{@profile_includes@};

constexpr std::uint16_t profile_units[]{@profile_units@};

constexpr ProfileRow profile_rows[]{
@profiles@};
")
endfunction()

busbar_generate_conformance()
