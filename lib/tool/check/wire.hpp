#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <busbar/binary/codec.hpp>
#include <busbar/types/secure_channel.hpp>

#include "subject.hpp"

namespace busbar::tool::rules {

using Bytes = std::vector<std::byte>;

/// Returns what `encode` writes.
[[nodiscard]] Bytes bytes_of(FunctionRef<void(binary::Writer&)> encode);

/// A chunk as it is on the wire: "ACKF" and so on, and what follows the size.
struct RawChunk {
    std::string type{};
    Bytes body{};

    [[nodiscard]] std::uint32_t number(std::size_t offset) const;
    [[nodiscard]] std::size_t size() const { return 8 + body.size(); }
};

/// The parameters of a Hello (Part 6, 7.1.2.3).
struct HelloForm {
    std::uint32_t version{0};
    std::uint32_t buffer_size{65'535};
    std::uint32_t max_message_size{0};
    std::uint32_t max_chunk_count{0};
    std::string url{};
};

/// A TCP connection on which any bytes are sent.
class Wire {
public:
    /// Connects; throws Unreachable.
    explicit Wire(const Subject& subject);
    Wire(Wire&&) noexcept;
    ~Wire();

    void send(std::span<const std::byte> bytes);
    /// Sends a chunk with its header; `type` has the chunk's letter: "HELF".
    void send(std::string_view type, std::span<const std::byte> body);
    /// Returns the next chunk; nothing if the server has closed the connection. Throws NoAnswer.
    [[nodiscard]] std::optional<RawChunk> receive();
    /// The StatusCode of the Error message that comes next, or Bad_ConnectionClosed.
    [[nodiscard]] Answer refusal();
    [[nodiscard]] std::optional<RawChunk> hello(const HelloForm& form);

    [[nodiscard]] const Subject& subject() const { return *subject_; }

private:
    struct Impl;

    const Subject* subject_;
    std::unique_ptr<Impl> impl_;
};

/// A channel without security whose chunks a rule makes by itself.
class RawChannel {
public:
    /// Says Hello and opens the channel. Throws Refused, Unreachable or NoAnswer.
    explicit RawChannel(const Subject& subject, const HelloForm& form = {});

    /// An OpenSecureChannel of this kind; `change` may make it wrong.
    [[nodiscard]] Bytes
    open_request(SecurityTokenRequestType type,
                 const std::function<void(OpenSecureChannelRequest&)>& change = {},
                 std::string_view policy = {}, std::uint32_t channel_id = 0);
    /// A chunk of a MSG with the next sequence number; `number` and `token_id` replace it, and the
    /// SecurityToken, unless 0.
    [[nodiscard]] Bytes message(std::span<const std::byte> body, std::uint32_t number = 0,
                                std::uint32_t token_id = 0, std::uint32_t channel_id = 0);
    /// The encoding of a GetEndpoints, which needs no session.
    [[nodiscard]] Bytes some_request(std::uint32_t handle = 1) const;
    /// Sends a GetEndpoints and returns the first chunk of the response.
    [[nodiscard]] std::optional<RawChunk> ask();
    /// Takes the token of a response to OpenSecureChannel.
    [[nodiscard]] Result<OpenSecureChannelResponse>
    take_token(const std::optional<RawChunk>& chunk);

    [[nodiscard]] Wire& wire() { return wire_; }
    [[nodiscard]] std::uint32_t sequence_number() const { return sequence_number_; }
    [[nodiscard]] std::uint32_t request_id() const { return request_id_; }
    [[nodiscard]] const ChannelSecurityToken& token() const { return token_; }
    [[nodiscard]] const RawChunk& acknowledge() const { return acknowledge_; }

private:
    [[nodiscard]] DateTime subject_time() const;

    Wire wire_;
    RawChunk acknowledge_;
    ChannelSecurityToken token_;
    std::uint32_t sequence_number_{0};
    std::uint32_t request_id_{0};
};

} // namespace busbar::tool::rules
