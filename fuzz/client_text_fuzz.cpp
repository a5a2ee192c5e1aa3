#include <cstdint>
#include <cstdlib>
#include <string_view>

#include <busbar/client/node_address.hpp>
#include <busbar/client/value_json.hpp>
#include <busbar/client/value_text.hpp>

namespace client_text_fuzz {

using namespace busbar;

/// Texts of people and scripts: an address is written as it was read, and a value survives JSON.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    if (size < 2) {
        return 0;
    }
    client::ValueType type;
    type.built_in = static_cast<BuiltInType>(1 + data[0] % last_built_in_type);
    type.value_rank = static_cast<std::int32_t>(data[1] % 6) - 3;
    const std::string_view text{reinterpret_cast<const char*>(data) + 2, size - 2};
    const auto address = client::NodeAddress::parse(text);
    if (address && client::NodeAddress::parse(address->text()) != address) {
        std::abort();
    }
    const auto value = client::parse_value(text, type);
    if (!value) {
        return 0;
    }
    const auto again = client::parse_value(client::to_json(*value), {BuiltInType::Variant, -2});
    if (client::to_text(*value).find('\x1b') != std::string::npos ||
        (value->type() <= BuiltInType::Double && (!again || *again != *value))) {
        std::abort();
    }
    return 0;
}

} // namespace client_text_fuzz
