#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <busbar/client/client.hpp>
#include <busbar/client/once_log.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/types/discovery.hpp>

namespace busbar::client {

/// The shortest and longest interval of registrations. A discovery server forgets servers that have
/// been silent for longer than the longest interval (Part 4, 5.5.5.1).
inline constexpr Duration min_registration_interval = std::chrono::seconds{10};
inline constexpr Duration max_registration_interval = std::chrono::minutes{10};

/// The information about a server that a discovery server receives, and its times.
struct RegistrationSettings {
    /// `is_online` is filled in. `semaphore_file_path` is for servers that are started on demand;
    /// their installation creates and removes the file.
    RegisteredServer server;
    /// For discovery servers that announce servers by mDNS; without capabilities "NA" is sent
    /// (Part 12, Annex D).
    MdnsDiscoveryConfiguration mdns;
    /// Half of the time that a discovery server waits, so that one registration may be lost.
    Duration interval{std::chrono::minutes{5}};
    /// The delay after a failure, doubled after each further one, at most the interval.
    Duration first_retry{std::chrono::seconds{1}};
    /// Maximum time by which unregistering may delay a shutdown.
    Duration farewell{std::chrono::seconds{2}};
};

/// Returns the configuration of a Client for a Registration; its certificate must contain
/// `application_uri`. If `security.allows_none` is set, None is used with discovery servers that
/// offer nothing better, or if we have no certificate (`has_identity`).
[[nodiscard]] BUSBAR_API ClientConfig registration_client(std::string discovery_url,
                                                          SecurityWishes security,
                                                          std::string application_uri,
                                                          bool has_identity);

/// Keeps a server registered with a discovery server (Part 4, 5.5.5 and 5.5.6): connects, sends
/// RegisterServer2, or RegisterServer if that is unknown, closes the connection, and repeats this
/// after the interval. Failures are tried again, and logged once, not each time.
///
/// Sans-I/O, with a Client of its own: drive that as usual, and call handle_deadline() at
/// next_deadline(), which may change with every step of the Client. One thread.
class BUSBAR_API Registration {
public:
    /// Checks for what a discovery server would refuse: Bad_ServerUriInvalid,
    /// Bad_ServerNameMissing, Bad_DiscoveryUrlMissing; Bad_InvalidArgument for a Client or an
    /// mdnsServerName of 64 bytes or more (Part 4, 7.13.2); Bad_OutOfRange for the interval.
    [[nodiscard]] static Result<void> check(const RegistrationSettings& settings);

    /// `client`, created with registration_client() and used for nothing else, `random` and `log`
    /// must outlive the object; `log` should be the one that the Client writes to as well. The
    /// settings must have passed check().
    Registration(Client& client, OnceLog& log, crypto::Random& random,
                 RegistrationSettings settings);
    Registration(const Registration&) = delete;
    Registration& operator=(const Registration&) = delete;
    ~Registration();

    /// Registers now, and repeatedly from now on.
    void start(TimePoint now);
    /// Unregisters the server once, if the discovery server may know of it. is_stopped() is true
    /// when that is done or its time is over.
    void stop(TimePoint now);
    /// After stop(): registers again, as by start(), once the server is unregistered.
    void start_again(TimePoint now);
    [[nodiscard]] bool is_stopped() const;

    /// True if the last attempt succeeded.
    [[nodiscard]] bool is_registered() const;
    /// The result of the last attempt; Good before the first.
    [[nodiscard]] StatusCode last_result() const;

    /// The time of the next attempt, or of its timeout.
    [[nodiscard]] TimePoint next_deadline() const;
    /// Does what is due at `now`.
    void handle_deadline(TimePoint now);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::client
