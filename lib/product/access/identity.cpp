#include "identity.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>

#include <busbar/administration/managed_certificates.hpp>
#include <busbar/core/text.hpp>
#include <busbar/crypto/own_certificate.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "product/configuration/toml_reader.hpp"

namespace busbar::product {

namespace {

namespace fs = std::filesystem;

/// Turns a refusal of the own certificate, which is part of the configuration, into a ConfigError.
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

/// True if the names differ from those that the controller, or its preset, has by default.
bool are_configured(const SubjectNames& names)
{
    return !(names == SubjectNames{} || names == nj501_subject());
}

/// Tells whether the certificate has these names; a name that contains the address changes with it.
bool has_names(const crypto::Certificate& own, const SubjectNames& names)
{
    const crypto::CertificateSubject has = crypto::subject_of(own);
    const bool has_address = names.common_name.find('{') != std::string::npos;
    return (names.common_name.empty() || has_address || has.common_name == names.common_name) &&
           has.organization == names.organization && has.locality == names.locality &&
           has.state == names.state && has.country == names.country &&
           has.organizational_unit == names.organizational_unit;
}

crypto::Secret read_file(const fs::path& path)
{
    std::ifstream file{path, std::ios::binary};
    return crypto::Secret{std::string_view{std::string{std::istreambuf_iterator<char>{file}, {}}}};
}

/// Takes over the files of version 0.1, which kept certificate and key directly in `own`, because
/// clients trust that certificate.
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
        throw ConfigError{Problem{key.error(), key_file.string(), "is not a private key"}};
    }
    auto certificates = expect_own(crypto::read_certificates(read_file(certificate_file).span()));
    expect_own(store.install({std::move(certificates), *key}, application_uri));
}

} // namespace

crypto::CertificateSubject configured_subject(const ControllerConfig& config)
{
    const SubjectNames& names = config.certificates.subject;
    crypto::CertificateSubject subject;
    if (are_configured(names)) {
        subject = subject_of(names, config.server.application_name, config.server.host_names);
        subject.dns_names.clear();
        subject.ip_addresses.clear();
    }
    for (const std::string& host : config.server.host_names) {
        crypto::add_host(subject, host);
    }
    return subject;
}

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
    // A certificate that was made earlier keeps its names, because clients may trust it.
    if (are_configured(config.subject) && !has_names(own.certificates.front(), config.subject)) {
        log.write(LogLevel::Warning, "certificate",
                  "the own certificate is " + printable(own.certificates.front().subject()) +
                      ", and other names are configured: `busbar admin cert regenerate` makes one "
                      "with these, which clients have to trust");
    }
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
