# What Debian's cross compilers have in common. Libraries come from where .ci/setup-cross puts them.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_CXX_COMPILER ${debian_triplet}-g++)

get_filename_component(debian_root
  ${CMAKE_CURRENT_LIST_DIR}/../../build/sysroot/${debian_architecture} ABSOLUTE)
set(CMAKE_FIND_ROOT_PATH ${debian_root})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
foreach(kind LIBRARY INCLUDE PACKAGE)
  set(CMAKE_FIND_ROOT_PATH_MODE_${kind} ONLY)
endforeach()
set(ENV{PKG_CONFIG_LIBDIR} ${debian_root}/usr/lib/${debian_triplet}/pkgconfig)
# OpenSSL's configuration differs between architectures and lies apart. GCC need not note where it
# once changed how arguments are passed.
set(CMAKE_CXX_FLAGS_INIT "-isystem ${debian_root}/usr/include/${debian_triplet} -Wno-psabi")

# With it, tests run as if they were programs of this machine.
set(CMAKE_CROSSCOMPILING_EMULATOR ${debian_emulator} -L /usr/${debian_triplet}
  -E LD_LIBRARY_PATH=${debian_root}/usr/lib/${debian_triplet})
