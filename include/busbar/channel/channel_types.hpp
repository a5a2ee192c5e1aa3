#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/channel/chunk_hook.hpp>
#include <busbar/channel/key_log.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/named_fields.hpp>
#include <busbar/core/result.hpp>
#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/certificate_validator.hpp>
#include <busbar/crypto/private_key.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/crypto/security_policy.hpp>
#include <busbar/types/enumerations.hpp>

namespace busbar::channel {

class OpenGate;
class OpenWorker;

/// The smallest buffer size that either side may request (Part 6, 7.1.2.3).
inline constexpr std::uint32_t min_buffer_size = 8'192;

/// Limits of one connection, in bytes. All are finite: 0 means the default, and they apply to a
/// peer that sets no limit, too.
struct TransportLimits {
    /// Size of the largest chunk that is accepted and sent.
    std::uint32_t receive_buffer_size{65'535};
    std::uint32_t send_buffer_size{65'535};
    /// Size of the largest message body that is accepted and sent, and the maximum number of its
    /// chunks.
    std::uint32_t max_message_size{16U << 20U};
    std::uint32_t max_chunk_count{512};
    /// Time from the start of the connection until the channel must be open.
    Duration handshake_timeout{std::chrono::seconds{10}};
};

/// "Invalid", "None", "Sign" or "SignAndEncrypt" (Part 4, 7.20); empty for any other number.
[[nodiscard]] BUSBAR_API std::string_view name(MessageSecurityMode mode);

/// The security of a channel: a policy and a mode that belong together.
struct SecuritySetting {
    const crypto::SecurityPolicy* policy{&crypto::policy_none()};
    MessageSecurityMode mode{MessageSecurityMode::None};

    friend bool operator==(const SecuritySetting&, const SecuritySetting&) = default;
};

/// The identity of an application: certificates are sent as they are, leaf first.
struct ApplicationIdentity {
    crypto::CertificateChain certificates;
    crypto::PrivateKey key;
};

/// Limits the bytes that the unfinished messages of all channels that share it hold together, so
/// that many peers cannot do what a single one must not. Called from any thread.
class BUSBAR_API AssemblyBudget {
public:
    explicit AssemblyBudget(std::size_t limit) : left_{limit} {}

    /// Takes `size` bytes. False, with nothing taken, if fewer are available.
    [[nodiscard]] bool take(std::size_t size);
    /// Makes bytes that were taken available again.
    void give_back(std::size_t size) { left_.fetch_add(size, std::memory_order_relaxed); }
    [[nodiscard]] std::size_t left() const { return left_.load(std::memory_order_relaxed); }

private:
    std::atomic<std::size_t> left_;
};

/// The services that channels, and clients on them, need from outside, set field by field:
/// `{.random = &random, .wall_clock = &clock, .log = &log}`. All must outlive them.
struct ChannelEnvironment {
    [[no_unique_address]] NamedFields named_fields{};

    /// Required.
    crypto::Random* random{nullptr};
    /// Required.
    const WallClock* wall_clock{nullptr};
    /// Required; NullLog for none.
    LogSink* log{nullptr};
    /// Required unless only policy None is used.
    crypto::CertificateValidator* validator{nullptr};
    /// Required unless only policy None is used.
    const ApplicationIdentity* identity{nullptr};
    /// Optional; null if connections are few.
    AssemblyBudget* budget{nullptr};
    /// Optional, for servers; if null, every request is served at once.
    OpenGate* gate{nullptr};
    /// Optional, for servers; if null, asymmetric work is done by the calling thread.
    OpenWorker* worker{nullptr};
    /// Optional; null in every product. Builds without BUSBAR_KEY_LOG ignore it.
    KeyLog* key_log{nullptr};
    /// Optional; null in every product.
    ChunkHook* chunk_hook{nullptr};
};

/// An occurrence on a channel.
struct ChannelEvent {
    /// The kind of occurrence.
    enum class Kind : std::uint8_t {
        Opened,  // the channel is open
        Renewed, // it has a new SecurityToken
        Message, // a request (server) or response (client)
        Aborted, // client: the server gave up the response to request_id, with `status`
        Closed,  // the last event; `status` is Good after CloseSecureChannel, else exact: the peer
                 // may have been told less
    };
    Kind kind{Kind::Closed};
    std::uint32_t request_id{0};
    /// Message: its body, which begins with the NodeId of the structure's encoding.
    std::vector<std::byte> body;
    StatusCode status;
    /// Closed: for the log; from the peer and already printable.
    std::string reason;
};

} // namespace busbar::channel
