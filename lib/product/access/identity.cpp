#include "identity.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>

#include <busbar/administration/managed_certificates.hpp>
#include <busbar/crypto/own_certificate.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "product/configuration/toml_reader.hpp"

namespace busbar::product {

namespace {

namespace fs = std::filesystem;

/// Certificates are configured, too: a refusal of one's own is a problem.
template <typename T>
T expect_own(Checked<T> result)
{
    if (!result) {
        throw ConfigError{problem_of(result.error())};
    }
    return *std::move(result);
}

crypto::OwnCertificateSettings settings_of(const CertificateConfig& config, const std::string& name,
                                           const std::string& application_uri,
                                           const std::vector<std::string>& host_names)
{
    crypto::OwnCertificateSettings settings;
    settings.key_bits = config.key_bits;
    settings.subject = subject_of(config.subject, name, host_names);
    settings.subject.valid_days = config.valid_days;
    settings.subject.application_uri = application_uri;
    return settings;
}

crypto::Secret read_file(const fs::path& path)
{
    std::ifstream file{path, std::ios::binary};
    return crypto::Secret{std::string_view{std::string{std::istreambuf_iterator<char>{file}, {}}}};
}

/// Version 0.1 kept certificate and key as files in `own` itself: clients trust that certificate.
void take_over_first_version(const fs::path& own, const crypto::OwnCertificateStore& store,
                             const std::string& application_uri)
{
    const fs::path certificate_file = own / "certificate.der";
    const fs::path key_file = own / "private_key.pem";
    if (!fs::exists(certificate_file) && !fs::exists(key_file)) {
        return;
    }
    const auto key = crypto::PrivateKey::parse(read_file(key_file).span());
    if (!key) {
        throw ConfigError{Problem{key.error(), key_file.string(), "is no private key"}};
    }
    auto certificates = expect_own(crypto::read_certificates(read_file(certificate_file).span()));
    expect_own(store.install({std::move(certificates), *key}, application_uri));
}

} // namespace

channel::ApplicationIdentity load_identity(const CertificateConfig& config, const std::string& name,
                                           const std::string& application_uri,
                                           const std::vector<std::string>& host_names, DateTime now,
                                           LogSink& log)
{
    storage::FolderStorage files{config.folder};
    expect(administration::finish_changes(files));
    const crypto::OwnCertificateStore store{files, &log};
    if (!expect_own(store.load(application_uri))) {
        take_over_first_version(fs::path{config.folder} / "own", crypto::OwnCertificateStore{files},
                                application_uri);
    }
    auto own = expect_own(
        store.load_or_create(settings_of(config, name, application_uri, host_names), now));
    return {std::move(own.certificates), std::move(own.key)};
}

crypto::Certificate regenerate_certificate(const CertificateConfig& config, const std::string& name,
                                           const std::string& application_uri,
                                           const std::vector<std::string>& host_names, DateTime now)
{
    storage::FolderStorage files{config.folder};
    expect(administration::finish_changes(files));
    const crypto::OwnCertificateStore store{files};
    return expect_own(store.regenerate(settings_of(config, name, application_uri, host_names), now))
        .certificates.front();
}

} // namespace busbar::product
