# The configuration of an installed controller: the built-in one with its folders below the state
# directory, and a setup by the first administrator, since a service has no terminal that could show
# a password.
set(source ${PROJECT_SOURCE_DIR}/examples/controller/controller.toml)
file(READ ${source} text)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${source})

# busbar_replace(<from> <to>): in `text`; stops where it is not there.
macro(busbar_replace from to)
  string(FIND "${text}" "${from}" place)
  if(place EQUAL -1)
    message(FATAL_ERROR "${source} has no \"${from}\", which lib/packaging looks for")
  endif()
  string(REPLACE "${from}" "${to}" text "${text}")
endmacro()

busbar_replace("# The configuration of busbar-controller, with its defaults. It is secure: clients need a"
  "# The configuration of the service busbar-controller. It has hashes of passwords, no passwords.
# `systemctl reload busbar-controller` has it read again.
#
# It is secure: clients need a")
busbar_replace("folder = \"busbar-certificates\"" "folder = \"${BUSBAR_STATE_DIR}/certificates\"")
busbar_replace("# setup = false                 # true, where" "setup = true                    # where")
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/packaging/controller.toml CONTENT "${text}" @ONLY)
