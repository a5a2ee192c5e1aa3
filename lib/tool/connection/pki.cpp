#include "pki.hpp"

#include <cstdlib>
#include <filesystem>

#include <sys/stat.h>
#include <unistd.h>

#include <busbar/net/system.hpp>

namespace busbar::tool {

namespace {

namespace fs = std::filesystem;

/// Returns the folder of the XDG Base Directory Specification.
fs::path data_folder()
{
    if (const char* folder = std::getenv("XDG_DATA_HOME"); folder != nullptr && *folder == '/') {
        return folder;
    }
    if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0') {
        return fs::path{home} / ".local" / "share";
    }
    throw Failure{Exit::Usage, "no place for certificates: HOME is not set", "give one: --pki DIR"};
}

std::string folder_of(const Options& options)
{
    const fs::path folder =
        options.pki.empty() ? data_folder() / "busbar" / "pki" : fs::path{options.pki};
    std::error_code error;
    if (!fs::exists(folder, error)) {
        const ::mode_t others = ::umask(S_IRWXG | S_IRWXO);
        fs::create_directories(folder, error);
        ::umask(others);
    }
    if (error) {
        throw Failure{Exit::Failed, folder.string() + ": " + error.message(),
                      "give another folder: --pki DIR"};
    }
    return folder.string();
}

std::string host_name()
{
    char name[256]{};
    return ::gethostname(name, sizeof name - 1) == 0 && name[0] != '\0' ? name : "localhost";
}

} // namespace

Pki::Pki(const Options& options, LogSink& log)
    : folder_{folder_of(options)}, storage_{folder_}, own_{storage_}, store_{storage_,
                                                                             crypto::StoreLimits{},
                                                                             log}
{
    if (const auto made = store_.create(); !made) {
        throw Failure{made.error(), folder_ + ": the folders of certificates cannot be made",
                      "give another folder: --pki DIR"};
    }
}

crypto::OwnCertificateSettings Pki::settings(std::uint32_t valid_days) const
{
    crypto::OwnCertificateSettings settings;
    settings.subject.common_name = "busbar";
    settings.subject.organization = "Busbar";
    settings.subject.application_uri = application_uri();
    // `busbar proxy` is a server, mostly for clients of this machine.
    settings.subject.dns_names = {host_name(), "localhost"};
    settings.subject.ip_addresses = {"127.0.0.1", "::1"};
    settings.subject.valid_days = valid_days;
    return settings;
}

std::string Pki::application_uri()
{
    return "urn:" + host_name() + ":busbar:cli";
}

channel::ApplicationIdentity Pki::identity()
{
    auto own = expect(
        own_.load_or_create(settings(crypto::default_valid_days), net::SystemWallClock{}.now()),
        "our certificate");
    return {std::move(own.certificates), std::move(own.key)};
}

std::optional<crypto::OwnCertificate> Pki::own()
{
    return expect(own_.load(), "our certificate");
}

crypto::OwnCertificate Pki::replace_own(std::uint32_t valid_days)
{
    return expect(own_.regenerate(settings(valid_days), net::SystemWallClock{}.now()),
                  "our certificate");
}

} // namespace busbar::tool
