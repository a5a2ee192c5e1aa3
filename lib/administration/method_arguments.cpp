#include "method_arguments.hpp"

#include "node_table.hpp"

#include <busbar/core/array.hpp>
#include <busbar/core/string.hpp>

namespace busbar::administration::detail {

std::string_view text_view(const server::MethodCall& call, std::size_t index)
{
    const auto* const text = call.inputs()[index].get_if<String>();
    return text != nullptr ? text->view() : std::string_view{};
}

std::span<const std::byte> bytes_input(const server::MethodCall& call, std::size_t index)
{
    const auto* const bytes = call.inputs()[index].get_if<ByteString>();
    return bytes != nullptr ? bytes->span() : std::span<const std::byte>{};
}

Variant texts(const std::vector<std::string>& list)
{
    Array<String> result;
    result.clear();
    for (const std::string& each : list) {
        result.push_back(String{each});
    }
    return Variant{std::move(result)};
}

Variant node_ids(const std::vector<NodeId>& ids)
{
    Array<NodeId> result;
    result.clear();
    for (const NodeId& each : ids) {
        result.push_back(each);
    }
    return Variant{std::move(result)};
}

Array<Argument> declared_arguments(const model::AddressSpace& space, model::NodeIndex method,
                                   std::string_view property)
{
    Array<Argument> result;
    const model::NodeIndex node = child_of(space, method, property);
    const Variant value = node != model::no_node ? space.value(node) : Variant{};
    if (const auto* const list = value.array_if<ExtensionObject>()) {
        for (const ExtensionObject& each : *list) {
            if (auto argument = binary::structure_of<Argument>(each)) {
                result.push_back(*std::move(argument));
            }
        }
    }
    return result;
}

} // namespace busbar::administration::detail
