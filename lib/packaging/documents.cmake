# busbar_install_program(<target> <component> [SHELLS] [COMPLETION <arguments>...]): installs a
# program with its manual page and completions, which it prints itself: what --help says is written
# once. COMPLETION are the words that have it print a script for bash; SHELLS says that `completion
# fish` and `completion zsh` work, too. A program that this machine cannot run has neither.
find_program(GZIP_PROGRAM gzip)

# A command that writes what `arguments` have the program print; compressed if `file` ends so.
function(busbar_print target file)
  if(file MATCHES "[.]gz$")
    set(command $<TARGET_FILE:${target}> ${ARGN} | ${GZIP_PROGRAM} -9n)
  else()
    set(command $<TARGET_FILE:${target}> ${ARGN})
  endif()
  add_custom_command(OUTPUT ${file} COMMAND ${command} > ${file} DEPENDS ${target}
    COMMENT "Printing ${file}")
endfunction()

function(busbar_install_program target component)
  cmake_parse_arguments(ARG "SHELLS" "" "COMPLETION" ${ARGN})
  install(TARGETS ${target} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT ${component})
  if(CMAKE_CROSSCOMPILING)
    return()
  endif()
  set(folder ${PROJECT_BINARY_DIR}/documents)
  file(MAKE_DIRECTORY ${folder})
  set(page ${folder}/${target}.1)
  if(GZIP_PROGRAM)
    string(APPEND page .gz)
  endif()
  busbar_print(${target} ${page} --print-man)
  set(files ${page})
  install(FILES ${page} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${component})
  if(ARG_COMPLETION)
    busbar_print(${target} ${folder}/${target}.bash ${ARG_COMPLETION})
    list(APPEND files ${folder}/${target}.bash)
    install(FILES ${folder}/${target}.bash RENAME ${target} COMPONENT ${component}
      DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  endif()
  if(ARG_SHELLS)
    foreach(shell fish zsh)
      busbar_print(${target} ${folder}/${target}.${shell} completion ${shell})
      list(APPEND files ${folder}/${target}.${shell})
    endforeach()
    install(FILES ${folder}/${target}.fish COMPONENT ${component}
      DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
    install(FILES ${folder}/${target}.zsh RENAME _${target} COMPONENT ${component}
      DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
  endif()
  add_custom_target(${target}-documents ALL DEPENDS ${files})
endfunction()
