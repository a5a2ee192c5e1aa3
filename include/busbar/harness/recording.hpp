#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/result.hpp>
#include <busbar/harness/link.hpp>

namespace busbar::harness {

/// Limits of a recording, and of one that is read from a file.
struct RecordingLimits {
    std::size_t max_bytes{64U << 20U};
    std::size_t max_entries{1'000'000};
    std::uint32_t max_connections{10'000};
};

/// The bytes of sessions, as they arrived.
struct BUSBAR_API Recording {
    /// The kind of entry.
    enum class Kind : std::uint8_t { Opened, Bytes, Ended };
    /// One of these, with its time.
    struct Entry {
        Kind kind{Kind::Bytes};
        /// Time since the world began; never before the previous entry.
        Duration time{0};
        /// Number of the connection from 1, in the order of opening. Its bytes and ends follow its
        /// Opened.
        std::uint32_t connection{0};
        /// The side that has sent the bytes, or that is gone for the other end. Client for Opened.
        Side from{Side::Client};
        /// For Bytes: at least one byte.
        std::vector<std::byte> bytes{};

        friend bool operator==(const Entry&, const Entry&) = default;
    };

    /// The seed of the recorded world.
    std::uint64_t seed{0};
    /// False if there was more than the limits allow.
    bool is_complete{true};
    std::vector<Entry> entries;

    friend bool operator==(const Recording&, const Recording&) = default;

    /// Everything that `from` has sent on this connection.
    [[nodiscard]] std::vector<std::byte> stream(std::uint32_t connection, Side from) const;
};

/// Records what happens on links: see Network::set_observer(). Stops at the limits.
class BUSBAR_API Recorder final : public LinkObserver {
public:
    explicit Recorder(std::uint64_t seed, RecordingLimits limits = {});

    [[nodiscard]] const Recording& recording() const { return recording_; }

    // LinkObserver.
    void opened(const Link& link) override;
    void arrived(const Link& link, Side from, std::span<const std::byte> bytes) override;
    void ended(const Link& link, Side side) override;

private:
    void add(const Link& link, Recording::Entry entry);

    RecordingLimits limits_;
    Recording recording_;
    std::size_t size_{0};
    std::map<const Link*, std::uint32_t> numbers_;
    std::uint32_t last_number_{0};
};

/// Returns a recording as text, to be kept in a file with a test: a line for the format and its
/// version, one for the seed, and one for each entry with nanoseconds, connection, "open", ">" (to
/// the server), "<" or "end", and the bytes in hexadecimal.
[[nodiscard]] BUSBAR_API std::string write_recording(const Recording& recording);
/// Reads it back. Bad_DecodingError for anything else, Bad_NotSupported for another version,
/// Bad_EncodingLimitsExceeded past the limits.
[[nodiscard]] BUSBAR_API Result<Recording> read_recording(std::string_view text,
                                                          const RecordingLimits& limits = {});

/// Returns the recording as a capture file (libpcap's format of microseconds, version 2.4) with
/// Ethernet, IPv4 and TCP headers around the bytes, the server on `port`: tshark and Wireshark read
/// it, and decode it as OPC UA on port 4840. Timestamps are 1970 plus the time since the world
/// began.
[[nodiscard]] BUSBAR_API std::vector<std::byte> to_pcap(const Recording& recording,
                                                        std::uint16_t port = 4840);

/// Returns the same as a file of the format pcapng, with the lines of `key_log` (see
/// channel::KeyLog) in a Decryption Secrets Block of type "OPC UA Key Log" before the packets:
/// Wireshark 4.4 and later decrypt with them, earlier ones read the packets as they are.
[[nodiscard]] BUSBAR_API std::vector<std::byte>
to_pcapng(const Recording& recording, std::string_view key_log, std::uint16_t port = 4840);

/// Returns the recording as it would be if its channels had had policy None: every chunk of which
/// `key_log` (see channel::KeyLog) has the key is decrypted, without its signature, which is not
/// checked; OpenSecureChannel messages, whose keys are private, become empty ones. A connection
/// with a chunk that cannot be decrypted stays as it is. Bytes are moved to the entry that
/// completes their chunk. The result has everything that was secret.
[[nodiscard]] BUSBAR_API Recording decrypted(const Recording& recording, std::string_view key_log);

} // namespace busbar::harness
