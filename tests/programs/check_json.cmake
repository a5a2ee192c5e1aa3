# cmake -D FILE=<file> -P check_json.cmake: fails if the file is no JSON document.
file(READ "${FILE}" text)
string(JSON type ERROR_VARIABLE error TYPE "{\"document\":${text}}" document)
if(NOT error STREQUAL "NOTFOUND")
  message(FATAL_ERROR "${error}")
endif()
