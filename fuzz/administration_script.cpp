#include "administration_script.hpp"

#include <array>
#include <string>
#include <string_view>
#include <utility>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/types/ids.hpp>

#include "administration/node_table.hpp"
#include "support/identity.hpp"

namespace busbar::fuzz {

namespace {

ByteString bytes_of(Script& script)
{
    const std::uint8_t choice = script.byte();
    if (choice < 64) {
        return ByteString{test::client_identity().certificates.front().der()};
    }
    return ByteString{script.bytes(choice)};
}

String string_of(Script& script)
{
    static const std::array<std::string, 14> known{
        "x",
        "d",
        "../a",
        "",
        "Fitter",
        "Operator",
        "CN=Press 4/O=Works",
        "PEM",
        test::client_identity().certificates.front().thumbprint_text(),
        "ann",
        "bob",
        "Engineer",
        "SecurityAdmin",
        "ConfigureAdmin"};
    const std::uint8_t choice = script.byte();
    if (choice < known.size()) {
        return String{known[choice]};
    }
    const auto bytes = script.bytes(choice % 32U);
    return String{std::string_view{reinterpret_cast<const char*>(bytes.data()), bytes.size()}};
}

NodeId node_of(Script& script)
{
    const std::uint8_t choice = script.byte();
    static constexpr std::array known{
        id::RsaSha256ApplicationCertificateType,
        id::ServerConfiguration_CertificateGroups_DefaultApplicationGroup,
        id::WellKnownRole_Operator};
    if (choice < known.size()) {
        return NodeId{0, known[choice]};
    }
    static constexpr std::array paths{"", "/d", "/a", "/d/a", "/x", "/d/d", "/d/x"};
    return choice % 8 < paths.size()
               ? NodeId{1, String{std::string{"Files/recipes"} + paths[choice % 8]}}
               : NodeId{};
}

} // namespace

Variant value_of(const Argument& argument, Script& script)
{
    const bool is_array = argument.value_rank >= 1;
    if (argument.data_type.is(id::ByteString)) {
        return is_array ? Variant{Array<ByteString>{bytes_of(script)}} : Variant{bytes_of(script)};
    }
    if (argument.data_type.is(id::String)) {
        return is_array ? Variant{Array<String>{string_of(script)}} : Variant{string_of(script)};
    }
    if (argument.data_type.is(id::NodeId)) {
        return Variant{node_of(script)};
    }
    const std::uint8_t small = script.byte();
    if (argument.data_type.is(id::Boolean)) {
        return Variant{small % 2 == 0};
    }
    if (argument.data_type.is(id::Byte)) {
        return Variant{small};
    }
    if (argument.data_type.is(id::UInt16)) {
        return Variant{static_cast<std::uint16_t>(small * 16U)};
    }
    if (argument.data_type.is(id::Int32) || argument.data_type.is(id::ServerState)) {
        return Variant{static_cast<std::int32_t>(small) * 100 - 100};
    }
    if (argument.data_type.is(id::UInt64)) {
        return Variant{std::uint64_t{small} * 50};
    }
    if (argument.data_type.is(id::DateTime)) {
        return Variant{DateTime{}};
    }
    if (argument.data_type.is(id::LocalizedText)) {
        return Variant{LocalizedText{"en", string_of(script)}};
    }
    if (argument.data_type.is(id::IdentityMappingRuleType)) {
        return Variant{ExtensionObject::from(IdentityMappingRuleType{
            static_cast<IdentityCriteriaType>(small % 10), string_of(script)})};
    }
    if (argument.data_type.is(id::EndpointType)) {
        EndpointType endpoint;
        endpoint.endpoint_url = string_of(script);
        return Variant{ExtensionObject::from(std::move(endpoint))};
    }
    return Variant{std::uint32_t{small}};
}

std::optional<MethodTarget> find_method(const model::AddressSpace& space, model::NodeIndex object,
                                        const char* name)
{
    const model::NodeIndex method = administration::detail::child_of(space, object, name);
    if (method == model::no_node) {
        return {};
    }
    const std::string_view called{name};
    MethodTarget target{space.node_id(object),
                        space.node_id(method),
                        {},
                        called.starts_with("Open") || called == "CreateFile" ||
                            called.starts_with("Generate")};
    const model::NodeIndex property =
        administration::detail::child_of(space, method, "InputArguments");
    const Variant value = property != model::no_node ? space.value(property) : Variant{};
    if (const auto* const list = value.array_if<ExtensionObject>()) {
        for (const ExtensionObject& each : *list) {
            if (auto argument = binary::structure_of<Argument>(each)) {
                target.inputs.push_back(*std::move(argument));
            }
        }
    }
    return target;
}

} // namespace busbar::fuzz
