#include "identity.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>

#include <busbar/crypto/file.hpp>

#include "toml_reader.hpp"

namespace busbar::example {

namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t key_bits = 2048;

std::string read_file(const fs::path& path)
{
    std::ifstream file{path, std::ios::binary};
    return {std::istreambuf_iterator<char>{file}, {}};
}

template <typename T>
T expect(Result<T> result, const std::string& what)
{
    if (!result) {
        throw ConfigError{what + ": " + std::string{name(result.error())}};
    }
    return *std::move(result);
}

channel::ApplicationIdentity load(const fs::path& certificate_file, const fs::path& key_file)
{
    const std::string certificate = read_file(certificate_file);
    crypto::Secret key{std::string_view{read_file(key_file)}};
    return {{expect(crypto::Certificate::parse_file(std::as_bytes(std::span{certificate})),
                    certificate_file.string())},
            expect(crypto::PrivateKey::parse(key.span()), key_file.string())};
}

bool is_address(const std::string& host)
{
    return host.find_first_not_of("0123456789.") == std::string::npos ||
           host.find(':') != std::string::npos;
}

crypto::CertificateSubject subject_of(const std::string& name, const std::string& application_uri,
                                      const std::vector<std::string>& host_names, DateTime now)
{
    crypto::CertificateSubject subject;
    subject.common_name = name;
    subject.application_uri = application_uri;
    for (const std::string& host : host_names) {
        (is_address(host) ? subject.ip_addresses : subject.dns_names).push_back(host);
    }
    // Clocks differ: a certificate of this moment must not be from the future for a client.
    constexpr std::int64_t seconds_per_day = 86'400;
    subject.valid_from = DateTime{now.ticks - seconds_per_day * DateTime::ticks_per_second};
    return subject;
}

void make(const fs::path& certificate_file, const fs::path& key_file,
          const crypto::CertificateSubject& subject)
{
    const auto key = expect(crypto::PrivateKey::generate(key_bits), "the private key");
    const auto certificate = expect(crypto::create_self_signed(key, subject), "the certificate");
    std::error_code error;
    fs::create_directories(key_file.parent_path(), error);
    if (error || !key.save(key_file.string()) ||
        !crypto::save_file(certificate_file.string(), certificate.der(),
                           crypto::FileAccess::Everyone)) {
        throw ConfigError{key_file.parent_path().string() + ": cannot write the own certificate"};
    }
}

} // namespace

channel::ApplicationIdentity load_identity(const std::string& folder, const std::string& name,
                                           const std::string& application_uri,
                                           const std::vector<std::string>& host_names, DateTime now)
{
    const fs::path own = fs::path{folder} / "own";
    const fs::path certificate_file = own / "certificate.der";
    const fs::path key_file = own / "private_key.pem";
    const bool has_certificate = fs::exists(certificate_file);
    if (has_certificate != fs::exists(key_file)) {
        throw ConfigError{own.string() +
                          ": found only one of certificate.der and private_key.pem, expected both "
                          "or none"};
    }
    if (!has_certificate) {
        make(certificate_file, key_file, subject_of(name, application_uri, host_names, now));
    }
    auto identity = load(certificate_file, key_file);
    if (!identity.key.belongs_to(identity.certificates.front())) {
        throw ConfigError{key_file.string() + ": the key does not belong to certificate.der"};
    }
    return identity;
}

} // namespace busbar::example
