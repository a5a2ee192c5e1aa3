#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <busbar/binary/writer.hpp>
#include <busbar/channel/channel_types.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/function_ref.hpp>

namespace busbar::channel {

/// The configuration of a ClientChannel.
struct ClientChannelConfig {
    TransportLimits limits;
    std::string endpoint_url;
    SecuritySetting security;
    /// The server's certificate, known from GetEndpoints; needed for any policy except None. The
    /// chain that the server sends must begin with it and pass the validator before the channel is
    /// open.
    std::optional<crypto::Certificate> server_certificate;
    std::chrono::milliseconds requested_lifetime{3'600'000};
    /// Wait for the server's ReverseHello before sending Hello (Part 6, 7.1.2.6).
    bool is_reverse{false};
    /// If not empty, the ApplicationUri that the server's certificate and, with is_reverse, its
    /// ReverseHello must name. If empty, any is accepted.
    std::string expected_server_uri;
};

/// The client's end of one connection; used like ServerChannel. Opens the channel by itself and
/// renews its SecurityToken when 75 % of its lifetime are over (Part 4, 5.6.2.1).
class BUSBAR_API ClientChannel {
public:
    ClientChannel(ClientChannelConfig config, const ChannelEnvironment& environment, TimePoint now);
    ClientChannel(ClientChannel&&) noexcept;
    ClientChannel& operator=(ClientChannel&&) noexcept;
    ~ClientChannel();

    /// Takes bytes of the server. The functions for events, output and time are those of
    /// ServerChannel.
    Result<void> feed(std::span<const std::byte> in, TimePoint now);
    [[nodiscard]] std::optional<ChannelEvent> next_event();
    [[nodiscard]] std::span<const std::byte> output() const;
    void consume(std::size_t size);
    [[nodiscard]] TimePoint next_deadline() const;
    void handle_deadline(TimePoint now);

    /// Sends the request that `encode` writes and returns the id that its response will have. If
    /// the channel is not open (Bad_SecureChannelClosed), `encode` fails, or the request exceeds
    /// the server's limits (Bad_RequestTooLarge), nothing is sent and the channel stays as it was.
    [[nodiscard]] Result<std::uint32_t> send(FunctionRef<void(binary::Writer&)> encode);
    /// Puts CloseSecureChannel into output(), which must still be delivered.
    void close();

    /// Takes a Message's body back, so that the next one needs no allocation. Optional.
    void recycle(std::vector<std::byte> body);
    /// Bytes that the buffers of this connection hold now.
    [[nodiscard]] std::size_t memory_in_use() const;

    [[nodiscard]] bool is_open() const;
    [[nodiscard]] bool is_closed() const;
    [[nodiscard]] std::uint32_t channel_id() const;
    [[nodiscard]] const SecuritySetting& security() const;
    /// The URL in our Hello; with is_reverse, the one in the server's ReverseHello.
    [[nodiscard]] const std::string& endpoint_url() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::channel
