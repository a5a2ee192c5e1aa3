#include <cstdint>
#include <cstdlib>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/client/type_dictionary.hpp>

#include "client/types/dictionary_types.hpp"

namespace dictionary_fuzz {

using namespace busbar;

namespace {

client::DictionaryLimits limits()
{
    client::DictionaryLimits small;
    small.max_types = 50;
    small.max_fields = 50;
    small.max_values = 50;
    return small;
}

/// Within the limits, and a type that has a reason has nothing else.
void check(const client::TypeDictionary& dictionary)
{
    if (dictionary.types.size() > limits().max_types) {
        std::abort();
    }
    for (const client::DictionaryType& type : dictionary.types) {
        if (type.fields.size() > limits().max_fields || type.values.size() > limits().max_values ||
            (!type.reason.empty() && !type.fields.empty())) {
            std::abort();
        }
    }
}

} // namespace

/// Any text as a type dictionary: what is accepted becomes DataTypes that can be compiled, each of
/// them usable or reported.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    const auto dictionary =
        client::parse_type_dictionary(std::as_bytes(std::span{data, size}), limits());
    if (!dictionary) {
        if (dictionary.error().found.empty()) {
            std::abort();
        }
        return 0;
    }
    check(*dictionary);
    client::detail::DictionaryTypes types{{}, limits().max_types};
    types.add(NodeId{2, 1U}, *dictionary);
    std::vector<binary::DefinitionError> errors;
    auto entries = types.entries(errors);
    const std::size_t count = entries.size();
    if (count + errors.size() != dictionary->types.size()) {
        std::abort();
    }
    const auto compiled = binary::DynamicTypes::compile(std::move(entries));
    if (compiled.size() + compiled.errors().size() < count) {
        std::abort();
    }
    return 0;
}

} // namespace dictionary_fuzz
