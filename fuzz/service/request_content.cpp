#include "request_content.hpp"

#include <array>
#include <limits>
#include <string>
#include <utility>

#include <busbar/types/ids.hpp>

#include "core/visit_built_in.hpp"
#include "request_types.hpp"

namespace busbar::fuzz {

namespace {

using binary::DynamicArray;
using binary::DynamicField;
using binary::DynamicType;
using binary::DynamicValue;

/// Past these levels structures have nothing in them.
constexpr unsigned max_depth = 4;

constexpr std::array standard_nodes{
    id::ObjectsFolder,
    id::Server,
    id::ViewsFolder,
    id::TypesFolder,
    id::References,
    id::HierarchicalReferences,
    id::Organizes,
    id::HasComponent,
    id::HasProperty,
    id::HasSubtype,
    id::BaseEventType,
    id::BaseObjectType,
    id::FolderType,
    id::BaseDataVariableType,
    id::PropertyType,
    id::Int32,
    id::String,
    id::Server_ServerStatus,
    id::Server_ServerStatus_CurrentTime,
    id::Server_NamespaceArray,
    id::Server_GetMonitoredItems,
    id::Server_ResendData,
    id::Server_ServerDiagnostics_EnabledFlag,
    id::Server_ServerDiagnostics_SubscriptionDiagnosticsArray,
};

/// What stands in ExtensionObjects of requests, and what does not.
constexpr std::array objects{
    id::DataChangeFilter,
    id::EventFilter,
    id::AggregateFilter,
    id::LiteralOperand,
    id::ElementOperand,
    id::AttributeOperand,
    id::SimpleAttributeOperand,
    id::ObjectAttributes,
    id::VariableAttributes,
    id::MethodAttributes,
    id::ObjectTypeAttributes,
    id::VariableTypeAttributes,
    id::ReferenceTypeAttributes,
    id::DataTypeAttributes,
    id::ViewAttributes,
    id::GenericAttributes,
    id::AnonymousIdentityToken,
    id::UserNameIdentityToken,
    id::X509IdentityToken,
    id::IssuedIdentityToken,
    id::AdditionalParametersType,
    id::ReadRawModifiedDetails,
    id::Argument,
    id::EUInformation,
    id::Range,
};

} // namespace

NodeId RequestContent::node()
{
    switch (below(8)) {
    case 0:
        return NodeId{1, "text"};
    case 1:
        return once_in(4) ? NodeId{static_cast<std::uint16_t>(any_number()), any_number()}
                          : NodeId{};
    case 2:
    case 3:
    case 4:
        return NodeId{0, one_of(standard_nodes)};
    default:
        return NodeId{1, static_cast<std::uint32_t>(below(24))};
    }
}

std::uint32_t RequestContent::number(std::string_view name)
{
    if (name == "AttributeId") {
        return once_in(2) ? 13 : static_cast<std::uint32_t>(below(29));
    }
    if (name.ends_with("Id") || name.ends_with("Ids") || name.starts_with("Links")) {
        return static_cast<std::uint32_t>(below(12));
    }
    static constexpr std::array numbers{0U, 1U, 2U, 3U, 10U, 100U, 5'000U, UINT32_MAX};
    return once_in(8) ? any_number() : one_of(numbers);
}

std::int32_t RequestContent::enumeration(const DynamicField& field)
{
    if (field.type == nullptr || field.type->values.empty() || once_in(12)) {
        return static_cast<std::int32_t>(below(300)) - 2;
    }
    return static_cast<std::int32_t>(one_of(field.type->values).value);
}

String RequestContent::text(std::string_view name)
{
    static constexpr std::array<std::string_view, 8> ranges{"",    "0",   "1:2", "0:1000",
                                                            "2:1", "0,0", "x",   "1,0:1"};
    static constexpr std::array<std::string_view, 8> texts{
        "", "a", "anonymous", "opc.tcp://localhost:4840", "urn:a", "4", "Default Binary\xC3", "en"};
    if (name == "IndexRange") {
        return String{once_in(3) ? one_of(ranges) : std::string_view{}};
    }
    return once_in(16) ? String{std::string(below(2'000), 'x')} : String{one_of(texts)};
}

ByteString RequestContent::bytes(std::string_view name)
{
    const std::size_t size = name == "ClientNonce" ? 32 : name.starts_with("Cont") ? 1 : below(20);
    std::vector<std::byte> all(size);
    for (std::byte& each : all) {
        each = static_cast<std::byte>(any_number());
    }
    return ByteString{std::move(all)};
}

Variant RequestContent::any()
{
    switch (below(12)) {
    case 0:
        return {};
    case 1:
        return Variant{String{std::string(below(40), 't')}};
    case 2:
        return Variant{Array<std::int32_t>(below(5))};
    case 3:
        return Variant{Array<String>(below(4))};
    case 4:
        return Variant{static_cast<double>(below(300)) / 7};
    case 5:
        return Variant{below(2) == 0};
    case 6:
        return Variant{NodeId{0, id::Server}};
    case 7: {
        const std::size_t rows = below(4);
        return Variant::matrix(Array<std::int32_t>(rows * 2),
                               Array<std::uint32_t>{static_cast<std::uint32_t>(rows), 2});
    }
    case 8:
        return Variant{object(max_depth)};
    case 9:
        return Variant{static_cast<std::uint32_t>(below(12))};
    default:
        return Variant{static_cast<std::int32_t>(below(300))};
    }
}

ExtensionObject RequestContent::object(unsigned depth)
{
    const auto& types = RequestTypes::all().types();
    const DynamicType* const type = types.find(NodeId{0, one_of(objects)});
    if (type == nullptr || depth > max_depth + 2 || once_in(8)) {
        return {};
    }
    auto made = binary::to_extension_object(structure(*type, depth + 1));
    return made ? std::move(*made) : ExtensionObject{};
}

template <typename T>
T RequestContent::one(const DynamicField& field, unsigned depth)
{
    if constexpr (std::is_same_v<T, std::uint32_t>) {
        return number(field.name);
    } else if constexpr (std::is_same_v<T, std::int32_t>) {
        return enumeration(field);
    } else if constexpr (std::is_same_v<T, bool>) {
        return below(2) == 0;
    } else if constexpr (std::is_floating_point_v<T>) {
        static constexpr std::array<T, 8> numbers{
            0, -1, 10, 100, 50, 1000, 1e10, std::numeric_limits<T>::quiet_NaN()};
        return one_of(numbers);
    } else if constexpr (std::is_integral_v<T>) {
        return static_cast<T>(once_in(4) ? any_number() : below(4));
    } else if constexpr (std::is_same_v<T, String>) {
        return text(field.name);
    } else if constexpr (std::is_same_v<T, ByteString>) {
        return bytes(field.name);
    } else if constexpr (std::is_same_v<T, NodeId>) {
        return node();
    } else if constexpr (std::is_same_v<T, ExpandedNodeId>) {
        return once_in(8) ? ExpandedNodeId{node(), "urn:x", 3} : ExpandedNodeId{node()};
    } else if constexpr (std::is_same_v<T, QualifiedName>) {
        static constexpr std::array<std::string_view, 6> names{
            "Server", "ServerStatus", "Message", "1", "InputArguments", "Default Binary"};
        return {static_cast<std::uint16_t>(once_in(3) ? 1 : 0), String{one_of(names)}};
    } else if constexpr (std::is_same_v<T, LocalizedText>) {
        return LocalizedText{once_in(2) ? "en" : "", text({})};
    } else if constexpr (std::is_same_v<T, ExtensionObject>) {
        return object(depth);
    } else if constexpr (std::is_same_v<T, DataValue>) {
        return DataValue{any()};
    } else if constexpr (std::is_same_v<T, StatusCode>) {
        return StatusCode{once_in(2) ? 0U : any_number()};
    } else if constexpr (std::is_same_v<T, DateTime>) {
        return DateTime{once_in(2) ? 0 : std::int64_t{any_number()}};
    } else {
        return T{};
    }
}

Variant RequestContent::content(const DynamicField& field, unsigned depth)
{
    return busbar::detail::visit_built_in(field.built_in, [&](auto tag) -> Variant {
        using T = typename decltype(tag)::type;
        if (field.is_scalar()) {
            if constexpr (std::is_same_v<T, Variant>) {
                return any();
            } else {
                return Variant{one<T>(field, depth)};
            }
        }
        Array<T> values;
        values.clear();
        for (std::size_t count = once_in(16) ? below(40) : below(4); count != 0; --count) {
            if constexpr (std::is_same_v<T, Variant>) {
                values.push_back(any());
            } else {
                values.push_back(one<T>(field, depth));
            }
        }
        return Variant{std::move(values)};
    });
}

void RequestContent::fill(DynamicValue& value, std::size_t index, unsigned depth)
{
    const DynamicField& field = value.type().fields[index];
    if (field.is_matrix()) {
        return;
    }
    if (!field.is_structure) {
        // What does not fit stays as it was.
        static_cast<void>(value.set(index, content(field, depth)));
        return;
    }
    if (field.is_scalar()) {
        if (depth < max_depth) {
            static_cast<void>(value.set(index, structure(*field.type, depth + 1)));
        }
        return;
    }
    DynamicArray array;
    array.values.clear();
    for (std::size_t count = depth < max_depth ? below(4) : 0; count != 0; --count) {
        array.values.push_back(structure(*field.type, depth + 1));
    }
    static_cast<void>(value.set(index, std::move(array)));
}

DynamicValue RequestContent::structure(const DynamicType& type, unsigned depth)
{
    DynamicValue value{type};
    const bool is_union = type.kind == DynamicType::Kind::Union;
    const std::size_t only = is_union ? below(type.fields.size() + 1) : 0;
    for (std::size_t i = 0; i < type.fields.size(); ++i) {
        if (is_union ? only == i : !type.fields[i].is_optional || once_in(2)) {
            fill(value, i, depth);
        }
    }
    return value;
}

void RequestContent::change(DynamicValue& value, unsigned depth)
{
    if (value.type().fields.empty()) {
        return;
    }
    std::size_t index = below(value.type().fields.size());
    if (depth == 0 && index == 0 && !once_in(8)) { // the RequestHeader
        index = value.type().fields.size() - 1;
    }
    const DynamicValue* const inner = value.structure(index);
    if (inner != nullptr && !once_in(4)) {
        DynamicValue changed = *inner;
        change(changed, depth + 1);
        static_cast<void>(value.set(index, std::move(changed)));
    } else if (value.structures(index) != nullptr && !once_in(8)) {
        change_array(value, index, depth);
    } else {
        fill(value, index, depth);
    }
}

void RequestContent::change_array(DynamicValue& value, std::size_t index, unsigned depth)
{
    const DynamicField& field = value.type().fields[index];
    DynamicArray array = *value.structures(index);
    const std::size_t size = array.values.size();
    if (size == 0 || once_in(6)) {
        array.values.push_back(structure(*field.type, depth + 1));
    } else if (once_in(8)) {
        const std::size_t left_out = below(size);
        DynamicArray rest{{}, array.dimensions};
        for (std::size_t i = 0; i < size; ++i) {
            if (i != left_out) {
                rest.values.push_back(array.values[i]);
            }
        }
        array = std::move(rest);
    } else {
        change(array.values[below(size)], depth + 1);
    }
    static_cast<void>(value.set(index, std::move(array)));
}

} // namespace busbar::fuzz
