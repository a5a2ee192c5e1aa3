#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace busbar::fuzz {

/// One fuzz target of the program. Its source <name>_fuzz.cpp defines `test_one_input` in the
/// namespace <name>_fuzz; the table of all targets is generated (fuzz/CMakeLists.txt).
struct Target {
    const char* name;
    /// Ends the program if the input shows a fault; what it returns is 0.
    int (*test_one_input)(const std::uint8_t* data, std::size_t size);
    /// Changes an input in place and returns its new size; null where libFuzzer's own way is best.
    std::size_t (*mutate)(std::uint8_t* data, std::size_t size, std::size_t max_size,
                          unsigned seed);
};

/// Returns all targets of this program.
[[nodiscard]] std::span<const Target> targets();

/// True if libFuzzer searches for new inputs, false if a corpus is replayed.
[[nodiscard]] bool is_searching();

/// Changes bytes in place as libFuzzer does by itself, and returns their new size; without
/// libFuzzer it changes nothing.
[[nodiscard]] std::size_t mutate_bytes(std::uint8_t* data, std::size_t size, std::size_t max_size);

} // namespace busbar::fuzz
