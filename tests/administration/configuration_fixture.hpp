#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/crypto/self_signed.hpp>

#include "managed_fixture.hpp"

namespace busbar::test {

inline const NodeId rsa{0, id::RsaSha256ApplicationCertificateType};

struct Configuration : ManagedFixture {
    using ManagedFixture::ManagedFixture;

    CallMethodResult on_server(TestClient& client, const NodeId& method,
                               std::vector<Variant> inputs)
    {
        return call(client, NodeId{0, id::ServerConfiguration}, method, std::move(inputs));
    }
    CallMethodResult on_server(TestClient& client, std::uint32_t method,
                               std::vector<Variant> inputs)
    {
        return on_server(client, NodeId{0, method}, std::move(inputs));
    }
    std::string_view update(TestClient& client, const crypto::Certificate& certificate,
                            const char* format = "", std::span<const std::byte> key = {})
    {
        return name(on_server(client, id::ServerConfiguration_UpdateCertificate,
                              {Variant{NodeId{}}, Variant{rsa},
                               Variant{ByteString{certificate.der()}}, Variant{Array<ByteString>{}},
                               Variant{String{format}}, Variant{ByteString{key}}})
                        .status_code);
    }
    std::string_view apply(TestClient& client)
    {
        return name(on_server(client, id::ServerConfiguration_ApplyChanges, {}).status_code);
    }
    CallMethodResult request(TestClient& client, bool needs_key, const char* subject = "",
                             std::size_t nonce = 32)
    {
        return on_server(client, id::ServerConfiguration_CreateSigningRequest,
                         {Variant{NodeId{}}, Variant{rsa}, Variant{String{subject}},
                          Variant{needs_key},
                          Variant{ByteString{std::vector<std::byte>(nonce, std::byte{7})}}});
    }
    Result<crypto::PrivateKey> storage_key(const char* name)
    {
        const auto bytes = read_file(storage, name, 10'000);
        REQUIRE(bytes);
        return crypto::PrivateKey::parse(*bytes);
    }
    /// What the server's clients see.
    [[nodiscard]] std::string certificate() const
    {
        return server.config().identity->certificates.front().thumbprint_text();
    }
    [[nodiscard]] std::string stored() const
    {
        const crypto::OwnCertificateStore own{const_cast<storage::MemoryStorage&>(storage)};
        const auto loaded = own.load();
        REQUIRE(loaded);
        REQUIRE(*loaded);
        return (*loaded)->certificates.front().thumbprint_text();
    }
};

/// A certificate for the server, with a key of its own.
inline channel::ApplicationIdentity successor()
{
    auto key = key_number(5);
    crypto::CertificateSubject subject;
    subject.common_name = "server";
    subject.application_uri = "urn:busbar:test:server";
    subject.dns_names = {"localhost"};
    subject.valid_from = DateTime{today.ticks - 86'400 * DateTime::ticks_per_second};
    return {{crypto::create_self_signed(key, subject).value()}, key};
}

} // namespace busbar::test
