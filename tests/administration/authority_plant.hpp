#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include <busbar/administration/authorities.hpp>
#include <busbar/binary/codec.hpp>
#include <busbar/binary/reader.hpp>
#include <busbar/binary/writer.hpp>
#include <busbar/server/method_table.hpp>
#include <busbar/types/configuration.hpp>
#include <busbar/types/enumerations.hpp>

#include "crypto/revoking.hpp"
#include "managed_fixture.hpp"
#include "trust_list_ids.hpp"

/// A controller of W588 with its five authorities.
namespace busbar::test {

using administration::Authorities;
using administration::Authority;

inline constexpr std::uint32_t rsa_type = id::RsaSha256ApplicationCertificateType;

// Masks of lists (Part 12, 7.8.2.9).
inline constexpr std::uint32_t trusted_certificates = 1;
inline constexpr std::uint32_t trusted_crls = 2;
inline constexpr std::uint32_t issuer_certificates = 4;
inline constexpr std::uint32_t issuer_crls = 8;

/// An authority by the user of its name.
struct Level {
    Authority authority;
    const char* name;
    std::vector<std::string> roles;
};
inline const std::array levels{
    Level{Authority::Administrator, "Administrator", {"SecurityAdmin", "ConfigureAdmin"}},
    Level{Authority::Designer, "Designer", {"Engineer"}},
    Level{Authority::Maintainer, "Maintainer", {"Supervisor"}},
    Level{Authority::Operator, "Operator", {"Operator"}},
    Level{Authority::Observer, "Observer", {"Observer"}},
};

inline const Issued& root()
{
    static const Issued issued = issue(test::authority("root"), key_number(2));
    return issued;
}

/// A controller with the preset, and logs such as variables mode has.
struct Plant : ManagedFixture {
    explicit Plant(Authorities of = Authorities::FiveLevels) : ManagedFixture{nullptr, of}
    {
        REQUIRE(applications.add(crypto::StoreList::Trusted, trusted.der()));
        applications.reject(rejected, today);
        model::AddressSpace& space = server.address_space();
        model::NewVariable variable;
        variable.data_type = NodeId{0, id::String};
        variable.value = String{"started"};
        const auto entries = space.add_variable(named("Log"), variable).value();
        model::NewMethod method;
        method.source = server.add_source(methods);
        method.handle = methods.add([](server::MethodCall call) { call.succeed(); });
        const auto clear = space.add_method(named("Clear"), method).value();
        const auto access = administration::access_from(Authority::Operator, Authority::Maintainer);
        space.set_node_access(entries, access);
        space.set_node_access(clear, access);
    }
    TestClient log_in_as(const Level& level)
    {
        REQUIRE(user_list.add({level.name, {}, 0, {}, level.roles}, "patience is all", random));
        return log_in(level.name, "patience is all");
    }
    model::NewNode named(const char* name)
    {
        model::NewNode node;
        node.id = NodeId{1, name};
        node.browse_name = QualifiedName{1, name};
        node.parent = server.address_space().find(id::ObjectsFolder);
        return node;
    }
    StatusCode on_list(TestClient& client, std::uint32_t method, std::vector<Variant> inputs)
    {
        return call(client, NodeId{0, trust_list}, NodeId{0, method}, std::move(inputs))
            .status_code;
    }
    StatusCode on_server(TestClient& client, NodeId method, std::vector<Variant> inputs)
    {
        return call(client, NodeId{0, id::ServerConfiguration}, method, std::move(inputs))
            .status_code;
    }
    static StatusCode value(TestClient& client, const NodeId& node)
    {
        ReadRequest request;
        request.nodes_to_read.resize(1);
        request.nodes_to_read[0].node_id = node;
        request.nodes_to_read[0].attribute_id = 13;
        const auto response = client.call<ReadResponse>(request);
        REQUIRE(response);
        return response->results[0].status;
    }
    /// What these lists hold; the status of the first thing that fails.
    Result<TrustListDataType> look(TestClient& client, std::uint32_t masks)
    {
        const auto opened =
            call(client, NodeId{0, trust_list}, NodeId{0, open_with_masks}, {Variant{masks}});
        if (opened.status_code.is_bad()) {
            return fail(opened.status_code);
        }
        const Variant handle = opened.output_arguments[0];
        const auto piece = call(client, NodeId{0, trust_list}, NodeId{0, read_method},
                                {handle, Variant{std::int32_t{60'000}}});
        if (piece.status_code.is_bad()) {
            return fail(piece.status_code);
        }
        binary::Reader reader{piece.output_arguments[0].get_if<ByteString>()->span()};
        TrustListDataType data;
        decode(reader, data);
        REQUIRE(reader.ok());
        if (const StatusCode closed = on_list(client, close_method, {handle}); closed.is_bad()) {
            return fail(closed);
        }
        return data;
    }
    StatusCode sees(TestClient& client, std::uint32_t masks)
    {
        const auto data = look(client, masks);
        return data ? status::Good : data.error();
    }
    /// The lists become these, but nothing is in force until changes are applied.
    StatusCode replace(TestClient& client, const TrustListDataType& data)
    {
        const auto opened =
            call(client, NodeId{0, trust_list}, NodeId{0, open_method}, {Variant{std::uint8_t{6}}});
        if (opened.status_code.is_bad()) {
            return opened.status_code;
        }
        const Variant handle = opened.output_arguments[0];
        binary::VectorSink sink;
        binary::Writer writer{sink};
        encode(writer, data);
        const auto bytes = sink.take(writer.written());
        const StatusCode wrote =
            on_list(client, write_method, {handle, Variant{ByteString{bytes}}});
        if (wrote.is_bad()) {
            return wrote;
        }
        const StatusCode closed = on_list(client, close_and_update, {handle});
        return closed.is_bad() ? closed : apply(client);
    }
    StatusCode apply(TestClient& client)
    {
        return on_server(client, NodeId{0, id::ServerConfiguration_ApplyChanges}, {});
    }
    StatusCode add(TestClient& client, const crypto::Certificate& certificate)
    {
        return on_list(client, add_certificate,
                       {Variant{ByteString{certificate.der()}}, Variant{true}});
    }
    StatusCode remove(TestClient& client, const crypto::Certificate& certificate, bool is_trusted)
    {
        return on_list(client, remove_certificate,
                       {Variant{String{certificate.thumbprint_text()}}, Variant{is_trusted}});
    }
    /// Whoever may not see the list does not know what to keep of it.
    StatusCode replace_issuers(TestClient& client, bool with_root)
    {
        TrustListDataType data;
        data.specified_lists = issuer_certificates;
        if (with_root) {
            data.issuer_certificates.push_back(ByteString{root().certificate.der()});
        }
        return replace(client, data);
    }
    StatusCode replace_crls(TestClient& client, std::uint32_t mask, bool with_one)
    {
        TrustListDataType data;
        data.specified_lists = mask;
        auto& lists = mask == trusted_crls ? data.trusted_crls : data.issuer_crls;
        if (with_one) {
            lists.push_back(ByteString{revoke(root()).der()});
        }
        return replace(client, data);
    }
    StatusCode regenerate(TestClient& client)
    {
        const StatusCode removed =
            on_server(client, NodeId{0, 19345}, {Variant{NodeId{}}, Variant{NodeId{0, rsa_type}}});
        if (removed.is_bad()) {
            return removed;
        }
        const StatusCode made = on_server(
            client, NodeId{0, 19342},
            {Variant{NodeId{}}, Variant{NodeId{0, rsa_type}}, Variant{String{"CN=Press 4"}},
             Variant{Array<String>{"plc.example"}}, Variant{Array<String>{}},
             Variant{std::uint16_t{365}}, Variant{std::uint16_t{2'048}}});
        on_server(client, NodeId{0, id::ServerConfiguration_CancelChanges}, {});
        return made;
    }
    StatusCode set(TestClient& client)
    {
        return call(client, NodeId{1, "Settings"}, NodeId{1, "Settings.Set"},
                    {Variant{Array<String>{"limits.sessions"}},
                     Variant{Array<Variant>{Variant{std::int64_t{9}}}}})
            .status_code;
    }
    StatusCode shut_down(TestClient& client)
    {
        return call(client, NodeId{0, id::Server}, NodeId{0, id::Server_RequestServerStateChange},
                    {Variant{static_cast<std::int32_t>(ServerState::Shutdown)}, Variant{DateTime{}},
                     Variant{std::uint32_t{10}}, Variant{LocalizedText{"en", "maintenance"}},
                     Variant{false}})
            .status_code;
    }

    crypto::Certificate trusted{issue({}, key_number(1)).certificate};
    crypto::Certificate rejected{issue({.common_name = "stranger"}, key_number(3)).certificate};
    server::MethodTable methods;
};

} // namespace busbar::test
