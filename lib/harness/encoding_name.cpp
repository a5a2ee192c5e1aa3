#include "encoding_name.hpp"

#include <busbar/binary/codec.hpp>
#include <busbar/binary/type_registry.hpp>
#include <busbar/types/registry.hpp>

namespace busbar::harness::detail {

NodeId encoding_of(std::span<const std::byte> body)
{
    binary::Reader reader{body};
    NodeId id;
    decode(reader, id);
    return reader.ok() ? id : NodeId{};
}

std::string encoding_name(const NodeId& encoding_id)
{
    static const binary::TypeRegistry types{binary::namespace0_types()};
    const StructureType* const type = types.find(encoding_id);
    return type != nullptr ? std::string{type->name} : to_string(encoding_id);
}

} // namespace busbar::harness::detail
