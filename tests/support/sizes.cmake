# busbar_test_sizes: the nodes of each size of namespace 0, whichever one the library has, for whoever
# includes this.
if(TARGET busbar_test_sizes)
  return()
endif()
set(sizes_root ${PROJECT_BINARY_DIR}/tests/sizes)
set(size_sources "")
foreach(size micro embedded standard full)
  set(list ${PROJECT_SOURCE_DIR}/schemas/sizes/${size}.txt)
  if(size STREQUAL "full")
    set(list "")
  endif()
  busbar_generate_nodes(busbar_test_nodes_${size} source
    NODESETS ${BUSBAR_NAMESPACE0_NODESETS}
    NAMESPACE_URI http://opcfoundation.org/UA/
    CPP_NAMESPACE busbar::test::${size}_size
    INCLUDE_PATH nodes_of/${size}
    ROOT ${sizes_root}
    NODE_LIST ${list}
    FEATURE_LIST ${PROJECT_SOURCE_DIR}/schemas/features.csv
    FEATURES ${BUSBAR_NAMESPACE0_FEATURES})
  list(APPEND size_sources ${source})
endforeach()
add_library(busbar_test_sizes STATIC EXCLUDE_FROM_ALL ${size_sources})
target_include_directories(busbar_test_sizes PUBLIC ${sizes_root})
target_link_libraries(busbar_test_sizes PUBLIC busbar::server PRIVATE busbar_flags)
foreach(size micro embedded standard full)
  add_dependencies(busbar_test_sizes busbar_test_nodes_${size})
endforeach()
