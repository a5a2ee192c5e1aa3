#include <cstdint>
#include <string_view>

#include <busbar/controller/plcopen_xml.hpp>

#include "program_fuzz.hpp"

namespace plcopen_xml_fuzz {

using namespace busbar;

/// Any text as PLCopen XML.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    controller::DeclarationLimits limits;
    limits.max_memory = 16U << 20U;
    const std::string_view text{reinterpret_cast<const char*>(data), size};
    check_program(controller::read_plcopen_xml(text, "fuzz.xml", limits));
    check_left_out(
        controller::read_plcopen_xml(text, "fuzz.xml", limits, controller::Unserved::LeaveOut));
    return 0;
}

} // namespace plcopen_xml_fuzz
