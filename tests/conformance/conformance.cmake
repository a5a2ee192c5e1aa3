# cmake -D TABLE=<conformance.csv> -D PROGRAMS=<a file with a test program a line> -P <this>
#
# Fails if a tag of the table is in no test, or a tag [unit:...] of a test is not in the table.
cmake_minimum_required(VERSION 3.25)

# Catch2 breaks lines within tags, so that blanks tell nothing. A list would take [ and ] for more
# than they are.
function(names_of text result)
  string(REGEX REPLACE "[ \t\r\n]" "" text "${text}")
  string(REGEX MATCHALL "\\[unit:[^]]*\\]" tags "${text}")
  string(REGEX REPLACE "\\[unit:([^]]*)\\]" "\\1" names "${tags}")
  set(${result} "${names}" PARENT_SCOPE)
endfunction()

file(READ ${TABLE} table)
names_of("${table}" wanted)

set(tested "")
file(STRINGS ${PROGRAMS} programs)
foreach(program IN LISTS programs)
  # Its exit code is the number of tags.
  execute_process(COMMAND ${program} --list-tags OUTPUT_VARIABLE tags ERROR_VARIABLE tags)
  if(NOT tags MATCHES "[0-9]+ tags?")
    message(FATAL_ERROR "${program} --list-tags: expected tags, found \"${tags}\"")
  endif()
  names_of("${tags}" names)
  list(APPEND tested ${names})
endforeach()
list(REMOVE_DUPLICATES tested)

set(missing ${wanted})
list(REMOVE_ITEM missing ${tested})
set(unknown ${tested})
list(REMOVE_ITEM unknown ${wanted})
foreach(name IN LISTS missing)
  message(SEND_ERROR "conformance.csv: no test has the tag [unit:${name}] (without its blanks)")
endforeach()
foreach(name IN LISTS unknown)
  message(SEND_ERROR "a test has the tag [unit:${name}] (without its blanks), no unit does")
endforeach()
list(LENGTH wanted count)
message(STATUS "${count} units have tests")
