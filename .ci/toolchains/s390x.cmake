# 64-bit and big-endian.
set(CMAKE_SYSTEM_PROCESSOR s390x)
set(debian_architecture s390x)
set(debian_triplet s390x-linux-gnu)
set(debian_emulator qemu-s390x)
include(${CMAKE_CURRENT_LIST_DIR}/debian.cmake)
