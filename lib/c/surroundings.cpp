#include "surroundings.hpp"

#include <cstring>
#include <utility>

#include <busbar/core/text.hpp>
#include <busbar/crypto/own_certificate.hpp>
#include <busbar/storage/folder_storage.hpp>
#include <busbar/storage/memory_storage.hpp>

namespace busbar::c {

void CallbackLog::write(LogLevel level, std::string_view source, std::string_view text)
{
    if (callback_ != nullptr && static_cast<int>(level) >= level_) {
        callback_(context_, static_cast<int>(level), std::string{source}.c_str(),
                  std::string{text}.c_str());
    }
}

ApplicationSurroundings::ApplicationSurroundings(const busbar_application& application)
    : uri_{text_or(application.uri, "")}, name_{text_or(application.name, uri_)},
      host_{text_or(application.host_name, "localhost")}, log_{application.log,
                                                               application.log_context,
                                                               application.log_level}
{
}

StatusCode ApplicationSurroundings::open(const busbar_application& application,
                                         FailureText& failure)
{
    if (uri_.empty()) {
        return misconfigured(failure, "application.uri",
                             "is empty, expected a globally unique URI");
    }
    const bool has_certificate = application.certificate != nullptr;
    if (application.folder != nullptr) {
        storage_ = std::make_unique<storage::FolderStorage>(application.folder);
    } else if (has_certificate) {
        storage_ = std::make_unique<storage::MemoryStorage>();
    } else {
        return status::Good;
    }
    store_.emplace(*storage_, crypto::StoreLimits{}, log_);
    if (const auto made = store_->create(); !made) {
        return misconfigured(failure, "application.folder", "cannot be created (Part 12, F.1)",
                             made.error());
    }
    validator_.emplace(*store_, log_);
    for (std::size_t i = 0; i < application.trusted_count; ++i) {
        const busbar_text& each = application.trusted[i];
        const auto added = store_->add(crypto::StoreList::Trusted, bytes_of(each.data, each.size));
        if (!added && added.error().status != status::Bad_EntryExists) {
            return failed(failure, problem_of(added.error()));
        }
    }
    return has_certificate ? take_certificate(application, failure) : load_certificate(failure);
}

StatusCode ApplicationSurroundings::take_certificate(const busbar_application& application,
                                                     FailureText& failure)
{
    auto certificates =
        crypto::read_certificates(bytes_of(application.certificate, application.certificate_size));
    if (!certificates) {
        return failed(failure, problem_of(certificates.error()));
    }
    auto key = crypto::PrivateKey::parse(bytes_of(application.key, application.key_size));
    if (!key || certificates->empty() || !key->belongs_to(certificates->front())) {
        return misconfigured(failure, "application.key",
                             "is not the RSA key of the certificate, as PEM or DER",
                             key ? status::Bad_ConfigurationError : key.error());
    }
    identity_ = channel::ApplicationIdentity{std::move(*certificates), std::move(*key)};
    return status::Good;
}

StatusCode ApplicationSurroundings::load_certificate(FailureText& failure)
{
    crypto::OwnCertificateSettings settings;
    settings.subject.common_name = name_;
    settings.subject.organization = name_;
    settings.subject.application_uri = uri_;
    crypto::add_host(settings.subject, host_);
    const crypto::OwnCertificateStore own{*storage_};
    auto loaded = own.load_or_create(settings, clock_.now());
    if (!loaded) {
        return failed(failure, problem_of(loaded.error()));
    }
    identity_ =
        channel::ApplicationIdentity{std::move(loaded->certificates), std::move(loaded->key)};
    return status::Good;
}

} // namespace busbar::c
