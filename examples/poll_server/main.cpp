// A server without Asio, threads and exceptions: a loop of its own, a table of modules.
// usage: POLL_SERVER_PASSWORD=... poll-server [PORT [FOLDER]]
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <busbar/crypto/own_certificate.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/crypto/store_validator.hpp>
#include <busbar/server/memory_source.hpp>
#include <busbar/server/password_users.hpp>
#include <busbar/server/server.hpp>
#include <busbar/storage/folder_storage.hpp>
#include <busbar/types/ids.hpp>

#include "poll_loop.hpp"
#include "table.hpp"

using namespace busbar;

namespace {

volatile std::sig_atomic_t is_to_stop = 0;

constexpr const char* application_uri = "urn:example:poll-server";

/// A clock, which every machine has.
class Clock final : public WallClock {
public:
    [[nodiscard]] DateTime now() const override
    {
        using Ticks =
            std::chrono::duration<std::int64_t, std::ratio<1, DateTime::ticks_per_second>>;
        const auto since = std::chrono::system_clock::now().time_since_epoch();
        return DateTime::from_unix_ticks(std::chrono::duration_cast<Ticks>(since).count());
    }
};

class Log final : public LogSink {
public:
    void write(LogLevel level, std::string_view source, std::string_view text) override
    {
        if (level >= LogLevel::Warning) {
            std::fprintf(stderr, "%.*s: %.*s\n", static_cast<int>(source.size()), source.data(),
                         static_cast<int>(text.size()), text.data());
        }
    }
};

int fail_with(const char* what, StatusCode status)
{
    std::fprintf(stderr, "%s: %s\n", what, std::string{name(status)}.c_str());
    return 1;
}

} // namespace

int main(int argc, char** argv)
{
    const std::string port = argc > 1 ? argv[1] : "4840";
    const std::string folder = argc > 2 ? argv[2] : "poll_server_pki";
    const char* const password = std::getenv("POLL_SERVER_PASSWORD");
    if (password == nullptr) {
        std::fprintf(stderr, "usage: POLL_SERVER_PASSWORD=... poll-server [PORT [FOLDER]]\n");
        return 2;
    }
    Clock clock;
    Log log;
    crypto::SystemRandom random;

    storage::FolderStorage files{folder};
    crypto::CertificateStore store{files, {}, log};
    if (const auto made = store.create(); !made) {
        return fail_with("certificate folder", made.error());
    }
    crypto::StoreValidator validator{store, log};
    crypto::OwnCertificateSettings certificate;
    certificate.subject.common_name = "Poll server";
    certificate.subject.application_uri = application_uri;
    crypto::add_host(certificate.subject, "localhost");
    const crypto::OwnCertificateStore own{files};
    auto identity = own.load_or_create(certificate, clock.now());
    if (!identity) {
        return fail_with("own certificate", identity.error().status);
    }
    server::PasswordUsers users;
    if (const auto added = users.add("operator", password, random); !added) {
        return fail_with("user", added.error().status);
    }

    server::ServerConfig config;
    config.application_uri = application_uri;
    config.endpoint_url = "opc.tcp://localhost:" + port;
    config.endpoints.resize(1); // Basic256Sha256, SignAndEncrypt
    config.identity =
        channel::ApplicationIdentity{std::move(identity->certificates), std::move(identity->key)};
    const server::ServerEnvironment environment{.random = &random,
                                                .wall_clock = &clock,
                                                .log = &log,
                                                .validator = &validator,
                                                .users = &users};
    auto made = server::Server::create(poll_server::modules(), std::move(config), environment,
                                       poll_server::address_space());
    if (!made) {
        return fail_with("server", made.error().status); // the log says more
    }
    server::MemorySource source{clock};
    made->add_source(source);
    model::AddressSpace& space = made->address_space();
    const auto speed = space.add_variable(space.find(id::ObjectsFolder), {1, "Speed"},
                                          source.variable(1480.0), model::Access::ReadWrite);
    if (!speed) {
        return fail_with("variable", speed.error());
    }
    poll_server::PollLoop loop{*made};
    if (!loop.listen(static_cast<std::uint16_t>(std::atoi(port.c_str())))) {
        return fail_with("port", status::Bad_ResourceUnavailable);
    }
    std::fprintf(stderr, "ready at opc.tcp://localhost:%s\n", port.c_str());
    std::signal(SIGTERM, [](int) { is_to_stop = 1; });
    while (loop.step(std::chrono::seconds{1})) { // no longer, as poll() may miss a signal
        if (is_to_stop != 0) {
            made->begin_shutdown(std::chrono::steady_clock::now(), "stopped by a signal");
        }
    }
    return 0;
}
