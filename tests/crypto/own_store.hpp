#pragma once

#include <fstream>
#include <iterator>
#include <memory>
#include <string>

#include <catch2/catch.hpp>

#include <busbar/crypto/own_certificate.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "issuing.hpp"
#include "store_fixture.hpp"

/// A store of an own certificate in a folder of the test's own, and what is done to it.
namespace busbar::test {

using crypto::OwnCertificate;
using crypto::OwnCertificateSettings;
using crypto::OwnCertificateStore;
using RequestKey = OwnCertificateStore::RequestKey;

inline const std::string uri = "urn:test:leaf";

inline OwnCertificateSettings settings()
{
    OwnCertificateSettings result;
    result.subject.common_name = "Line 3";
    result.subject.organization = "Works";
    result.subject.application_uri = uri;
    result.subject.dns_names = {"plc.example"};
    result.subject.ip_addresses = {"192.0.2.7"};
    return result;
}

inline std::string read(const fs::path& file)
{
    std::ifstream stream{file, std::ios::binary};
    return {std::istreambuf_iterator<char>{stream}, {}};
}

inline void write(const fs::path& file, std::string_view text)
{
    fs::create_directories(file.parent_path());
    std::ofstream{file, std::ios::binary} << text;
}

inline std::vector<std::byte> joined(std::vector<std::byte> a, const std::vector<std::byte>& b)
{
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

inline std::string text_of(std::span<const std::byte> bytes)
{
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

inline bool is_same(const OwnCertificate& a, const OwnCertificate& b)
{
    return a.certificates == b.certificates && a.key.to_pem()->text() == b.key.to_pem()->text();
}

/// A store in a folder of its own, and what its files are called.
struct Store {
    TemporaryFolder folder;
    // A store is passed around as one that cannot be changed.
    std::unique_ptr<storage::FolderStorage> files{
        std::make_unique<storage::FolderStorage>(folder.path.string())};
    OwnCertificateStore store{*files};

    [[nodiscard]] fs::path certificate() const { return folder.path / "own/certs/own.der"; }
    [[nodiscard]] fs::path key() const { return folder.path / "own/private/own.pem"; }
    [[nodiscard]] fs::path pending() const { return folder.path / "own/private/pending.pem"; }
    [[nodiscard]] fs::path replaced() const { return folder.path / "own/replaced"; }

    /// Makes one, as the first start of a server does.
    [[nodiscard]] OwnCertificate start() const { return *store.load_or_create(settings(), now); }
    void put(const Issued& issued) const
    {
        write(certificate(), text_of(issued.certificate.der()));
        put_key(key(), issued.key);
    }
    static void put_key(const fs::path& file, const crypto::PrivateKey& key)
    {
        write(file, key.to_pem()->text());
        fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
    }
    /// What the CA answers to a request for the pending key.
    [[nodiscard]] crypto::Certificate issue_pending(const Issued& ca,
                                                    const CertificateOptions& options = {}) const
    {
        const std::string pem = read(pending());
        const auto pending_key = crypto::PrivateKey::parse(std::as_bytes(std::span{pem}));
        REQUIRE(pending_key);
        return issue(options, *pending_key, &ca).certificate;
    }
};

inline const Issued& ca()
{
    static const Issued result = issue(authority("CA"), key_number(9));
    return result;
}

} // namespace busbar::test
