#include <cstdint>
#include <string_view>

#include <busbar/controller/program_text.hpp>

#include "program_fuzz.hpp"

namespace label_table_fuzz {

using namespace busbar;

/// Any text as a table of Sysmac Studio or a list of GX Works, or as whatever its content says.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    controller::DeclarationLimits limits;
    limits.max_memory = 16U << 20U;
    const std::string_view text{reinterpret_cast<const char*>(data), size};
    check_program(controller::read_program_text(text, "fuzz.csv", limits));
    check_left_out(
        controller::read_program_text(text, "fuzz.csv", limits, controller::Unserved::LeaveOut));
    return 0;
}

} // namespace label_table_fuzz
