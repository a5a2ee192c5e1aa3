#include "remote.hpp"

#include <algorithm>
#include <utility>

#include <busbar/administration/configured_users.hpp>
#include <busbar/binary/codec.hpp>
#include <busbar/binary/reader.hpp>
#include <busbar/binary/writer.hpp>
#include <busbar/client/methods.hpp>
#include <busbar/client/view.hpp>
#include <busbar/types/enumerations.hpp>

#include "tool/nodes/nodes.hpp"

namespace busbar::tool::admin {

namespace {

constexpr std::int32_t piece_size = 32'768;
/// Greater than any trust list: protects against a server that sends without end.
constexpr std::size_t max_list_size = 64U << 20U;

/// Throws if the connection is gone, which is not the same as a missing node.
void throw_if_gone(StatusCode status, const char* what)
{
    if (status.is_bad() && exit_of(status) == Exit::NotConnected) {
        throw Failure{status, what};
    }
}

std::vector<ReferenceDescription> children(Connection& connection, const NodeId& parent)
{
    using Results = std::vector<BrowseResult>;
    const auto results = connection.wait_for<Results>([&](std::function<void(Results)> done) {
        client::browse(connection.client(), {client::children_of(parent)}, std::move(done));
    });
    const auto& references = results.front().references;
    throw_if_gone(results.front().status_code, "browsing");
    return {references.begin(), references.end()};
}

/// Returns advice if the server itself lacks something; empty otherwise.
std::string_view hint_at_server(StatusCode status)
{
    if (status == status::Bad_CertificateChainIncomplete) {
        return "add the CA that signed it first: busbar admin trust add --issuer FILE...";
    }
    return status == status::Bad_CertificateRevocationUnknown
               ? "add the CA's revocation list: busbar admin trust add --issuer FILE.crl"
               : "";
}

} // namespace

std::vector<Variant> call(Connection& connection, const NodeId& object, const NodeId& method,
                          const std::vector<Variant>& inputs, const std::string& what,
                          Duration timeout)
{
    CallMethodRequest request;
    request.object_id = object;
    request.method_id = method;
    request.input_arguments = Array<Variant>{inputs};
    const client::ExplainedCall result = call_explained(connection, std::move(request), timeout);
    if (result.status_code == status::Bad_NodeIdUnknown) {
        throw Failure{result.status_code, what,
                      "the server has no such service, or this user may not see it: log in as one "
                      "with the role SecurityAdmin"};
    }
    if (result.status_code.is_bad()) {
        auto failure = refused_by_server(result.status_code, what, result.additional_info,
                                         operand_of(object, method));
        if (const auto hint = hint_at_server(result.status_code); !hint.empty()) {
            failure.hint = hint;
        }
        throw std::move(failure);
    }
    return {result.output_arguments.begin(), result.output_arguments.end()};
}

Variant read(Connection& connection, const NodeId& variable)
{
    const auto values = read_attributes(connection, variable, {AttributeId::Value});
    throw_if_gone(values.front().status, "reading");
    return values.front().status.is_bad() ? Variant{} : values.front().value;
}

std::optional<std::vector<UserManagementDataType>> find_users(Connection& connection)
{
    const Variant value = read(connection, standard(id::UserManagement_Users));
    const auto* const list = value.array_if<ExtensionObject>();
    if (list == nullptr) {
        return std::nullopt;
    }
    std::vector<UserManagementDataType> users;
    for (const ExtensionObject& each : *list) {
        if (const auto* const user = each.get_if<UserManagementDataType>()) {
            users.push_back(*user);
        }
    }
    return users;
}

bool is_of_file(const UserManagementDataType& user)
{
    constexpr auto fixed = static_cast<std::uint32_t>(UserConfigurationMask::NoDelete) |
                           static_cast<std::uint32_t>(UserConfigurationMask::NoChangeByUser);
    return (static_cast<std::uint32_t>(user.user_configuration) & fixed) == fixed &&
           user.description.view() == administration::of_configuration;
}

NodeId find_child(Connection& connection, const NodeId& parent, std::string_view name)
{
    for (const ReferenceDescription& child : children(connection, parent)) {
        if (child.browse_name.name.view() == name) {
            return child.node_id.node_id;
        }
    }
    return {};
}

NodeId find_method(Connection& connection, const NodeId& parent, std::string_view name)
{
    for (const ReferenceDescription& child : children(connection, parent)) {
        if (child.node_class == NodeClass::Method && child.browse_name.name.view() == name) {
            return child.node_id.node_id;
        }
    }
    return {};
}

NodeId child_of(Connection& connection, const NodeId& parent, std::string_view name)
{
    if (NodeId found = find_child(connection, parent, name); !found.is_null()) {
        return found;
    }
    throw Failure{status::Bad_NotFound, std::string{name},
                  "the server has no such service, or this user may not see it: log in as one with "
                  "the role SecurityAdmin"};
}

std::vector<NamedChild> objects_below(Connection& connection, const NodeId& parent)
{
    std::vector<NamedChild> result;
    for (const ReferenceDescription& child : children(connection, parent)) {
        if (child.node_class == NodeClass::Object) {
            result.push_back({child.browse_name.name.str(), child.node_id.node_id});
        }
    }
    return result;
}

TrustListNodes trust_list(Connection& connection, bool of_users)
{
    const NodeId group =
        standard(of_users ? id::ServerConfiguration_CertificateGroups_DefaultUserTokenGroup
                          : id::ServerConfiguration_CertificateGroups_DefaultApplicationGroup);
    TrustListNodes nodes;
    nodes.object = child_of(connection, group, "TrustList");
    for (const ReferenceDescription& child : children(connection, nodes.object)) {
        const std::string_view name = child.browse_name.name.view();
        NodeId* const known = name == "Open"                ? &nodes.open
                              : name == "Close"             ? &nodes.close
                              : name == "Read"              ? &nodes.read
                              : name == "Write"             ? &nodes.write
                              : name == "CloseAndUpdate"    ? &nodes.close_and_update
                              : name == "AddCertificate"    ? &nodes.add
                              : name == "RemoveCertificate" ? &nodes.remove
                                                            : nullptr;
        if (known != nullptr) {
            *known = child.node_id.node_id;
        }
    }
    return nodes;
}

TrustListDataType read_trust_list(Connection& connection, const TrustListNodes& nodes)
{
    constexpr std::uint8_t for_reading = 1;
    const std::string what = "reading the trust list";
    const auto opened = call(connection, nodes.object, nodes.open, {Variant{for_reading}}, what);
    const Variant handle = opened.empty() ? Variant{} : opened.front();
    std::vector<std::byte> bytes;
    for (;;) {
        const auto piece =
            call(connection, nodes.object, nodes.read, {handle, Variant{piece_size}}, what);
        const auto* const part = piece.empty() ? nullptr : piece.front().get_if<ByteString>();
        if (part == nullptr || part->span().empty()) {
            break;
        }
        bytes.insert(bytes.end(), part->span().begin(), part->span().end());
        if (bytes.size() > max_list_size) {
            throw Failure{status::Bad_EncodingLimitsExceeded, what};
        }
    }
    call(connection, nodes.object, nodes.close, {handle}, what);
    TrustListDataType data;
    binary::Reader reader{bytes};
    decode(reader, data);
    if (!reader.ok()) {
        throw Failure{reader.status(), what};
    }
    return data;
}

/// Writes the list into a transaction, which ApplyChanges applies (Part 12, 7.8.2.5).
void write_trust_list(Connection& connection, const TrustListNodes& nodes,
                      const TrustListDataType& data, const std::string& what)
{
    constexpr std::uint8_t for_writing = 6; // and erases it
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode(writer, data);
    const std::vector<std::byte> bytes = sink.take(writer.written());
    const auto opened = call(connection, nodes.object, nodes.open, {Variant{for_writing}}, what);
    const Variant handle = opened.empty() ? Variant{} : opened.front();
    const NodeId configuration = standard(id::ServerConfiguration);
    try {
        const std::span<const std::byte> all{bytes};
        for (std::size_t at = 0; at < all.size(); at += static_cast<std::size_t>(piece_size)) {
            const std::size_t size = std::min<std::size_t>(piece_size, all.size() - at);
            call(connection, nodes.object, nodes.write,
                 {handle, Variant{ByteString{all.subspan(at, size)}}}, what);
        }
        call(connection, nodes.object, nodes.close_and_update, {handle}, what);
        call(connection, configuration, standard(id::ServerConfiguration_ApplyChanges), {}, what);
    } catch (const Failure&) {
        try {
            call(connection, configuration, standard(id::ServerConfiguration_CancelChanges), {},
                 what);
        } catch (const Failure&) { // the transaction has already ended
        }
        throw;
    }
}

std::vector<crypto::Certificate> certificates_of(const Array<ByteString>& ders)
{
    std::vector<crypto::Certificate> result;
    for (const ByteString& der : ders) {
        if (auto certificate = crypto::Certificate::parse(der.span())) {
            result.push_back(*std::move(certificate));
        }
    }
    return result;
}

std::vector<crypto::Certificate> rejected(Connection& connection)
{
    const auto outputs =
        call(connection, standard(id::ServerConfiguration),
             standard(id::ServerConfiguration_GetRejectedList), {}, "reading the rejected list");
    const auto* const ders = outputs.empty() ? nullptr : outputs.front().array_if<ByteString>();
    return ders != nullptr ? certificates_of(*ders) : std::vector<crypto::Certificate>{};
}

} // namespace busbar::tool::admin
