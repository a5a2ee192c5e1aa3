#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include <busbar/client/client.hpp>
#include <busbar/client/once_log.hpp>
#include <busbar/core/api.hpp>
#include <busbar/types/discovery.hpp>

namespace busbar::client {

/// How often a server may register. A discovery server forgets servers that have been silent for
/// longer than the longest interval (Part 4, 5.5.5.1).
inline constexpr Duration min_registration_interval = std::chrono::seconds{10};
inline constexpr Duration max_registration_interval = std::chrono::minutes{10};

/// What a discovery server is told of a server, and when.
struct RegistrationSettings {
    /// `is_online` is filled in. `semaphore_file_path` is for servers that are started when a
    /// client wants them; whoever installs them makes the file and takes it away.
    RegisteredServer server;
    /// For discovery servers that announce servers by mDNS; without capabilities "NA" is sent
    /// (Part 12, Annex D).
    MdnsDiscoveryConfiguration mdns;
    /// Half of the time that a discovery server waits: one registration may be lost.
    Duration interval{std::chrono::minutes{5}};
    /// The wait after a failure, twice as long after each further one, at most the interval.
    Duration first_retry{std::chrono::seconds{1}};
    /// How long taking the registration back may hold up a shutdown.
    Duration farewell{std::chrono::seconds{2}};
};

/// What a Client for a Registration is configured with, who has to have `application_uri` in its
/// certificate. Where `security.allows_none` is set, None is for discovery servers that offer
/// nothing better, or for us without a certificate (`has_identity`).
[[nodiscard]] BUSBAR_API ClientConfig registration_client(std::string discovery_url,
                                                          SecurityWishes security,
                                                          std::string application_uri,
                                                          bool has_identity);

/// Keeps a server registered with a discovery server (Part 4, 5.5.5 and 5.5.6): connects, sends
/// RegisterServer2, or RegisterServer where that is not known, closes the connection, and does so
/// again after the interval. What fails is tried again, and told once, not each time.
///
/// Sans-I/O, beside a Client that is its own: drive that as ever, and call handle_deadline() when
/// next_deadline(), which may change with every step of the Client, has come. One thread.
class BUSBAR_API Registration {
public:
    /// What a discovery server would refuse: Bad_ServerUriInvalid, Bad_ServerNameMissing,
    /// Bad_DiscoveryUrlMissing; Bad_InvalidArgument for a Client or an mdnsServerName of 64 bytes
    /// or more (Part 4, 7.13.2); Bad_OutOfRange for the interval.
    [[nodiscard]] static Result<void> check(const RegistrationSettings& settings);

    /// `client`, made with registration_client() and not used for anything else, `random` and `log`
    /// must outlive the object; `log` should be what the Client writes to as well. The settings
    /// have passed check().
    Registration(Client& client, OnceLog& log, crypto::Random& random,
                 RegistrationSettings settings);
    Registration(const Registration&) = delete;
    Registration& operator=(const Registration&) = delete;
    ~Registration();

    /// Registers now, and again from now on.
    void start(TimePoint now);
    /// Tells the discovery server once that the server goes, if it may know of it. is_stopped() is
    /// true when that is done or its time is over.
    void stop(TimePoint now);
    [[nodiscard]] bool is_stopped() const;

    /// True if the last attempt succeeded.
    [[nodiscard]] bool is_registered() const;
    /// How the last attempt ended; Good before the first.
    [[nodiscard]] StatusCode last_result() const;

    [[nodiscard]] TimePoint next_deadline() const;
    void handle_deadline(TimePoint now);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::client
