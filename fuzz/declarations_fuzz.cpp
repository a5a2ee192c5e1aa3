#include <cstdint>
#include <cstdlib>
#include <string_view>

#include <busbar/controller/declaration_reader.hpp>

#include "program_fuzz.hpp"

namespace declarations_fuzz {

using namespace busbar;

/// Any text as declarations of IEC 61131-3.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    controller::DeclarationLimits limits;
    limits.max_memory = 16U << 20U;
    const std::string_view text{reinterpret_cast<const char*>(data), size};
    check_program(controller::read_declarations(text, "fuzz.st", limits));
    check_left_out(
        controller::read_declarations(text, "fuzz.st", limits, controller::Unserved::LeaveOut));
    return 0;
}

} // namespace declarations_fuzz
