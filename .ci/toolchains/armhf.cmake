# 32-bit ARM with hardware floating point: sizes of 32 bits and, in Debian 12, a time_t of 32 bits.
set(CMAKE_SYSTEM_PROCESSOR arm)
set(debian_architecture armhf)
set(debian_triplet arm-linux-gnueabihf)
set(debian_emulator qemu-arm)
include(${CMAKE_CURRENT_LIST_DIR}/debian.cmake)
