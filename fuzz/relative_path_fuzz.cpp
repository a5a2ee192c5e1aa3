#include <cstdint>
#include <cstdlib>
#include <string_view>

#include <busbar/model/address_space.hpp>
#include <busbar/model/relative_path.hpp>

namespace relative_path_fuzz {

using namespace busbar;

/// What is read is written as a text that is read as the same.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    static const model::AddressSpace space;
    const std::string_view text{reinterpret_cast<const char*>(data), size};
    const auto path = model::parse_relative_path(text, space);
    if (!path) {
        return 0;
    }
    const auto written = model::to_text(*path, space);
    if (!written || model::parse_relative_path(*written, space) != path) {
        std::abort();
    }
    return 0;
}

} // namespace relative_path_fuzz
