#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <busbar/binary/codec.hpp>
#include <busbar/binary/type_registry.hpp>
#include <busbar/channel/client_channel.hpp>
#include <busbar/client/user_identity.hpp>
#include <busbar/types/common.hpp>
#include <busbar/types/discovery.hpp>
#include <busbar/types/registry.hpp>

namespace busbar::client {

struct ConnectionConfig {
    channel::ClientChannelConfig channel;
    std::string application_name{"Busbar client"};
    std::string application_uri{"urn:busbar:client"};
    std::string session_name{"Busbar"};
    UserIdentity identity;
    std::chrono::milliseconds session_timeout{60'000};
    /// After this an open request is given up with Bad_Timeout.
    std::chrono::milliseconds request_timeout{10'000};
    /// False for FindServers and GetEndpoints, which need no session.
    bool wants_session{true};
    /// What responses may contain.
    binary::DecodeLimits limits{};
};

/// What happened on a client.
struct ConnectionEvent {
    enum class Kind : std::uint8_t {
        Ready,    // the session is activated, or the channel open if no session is wanted
        Response, // to the request with `handle`
        Closed,   // nothing more will come
    };
    Kind kind{Kind::Closed};
    std::uint32_t handle{0};
    /// Response: the ServiceResult, or Bad_Timeout, Bad_SecureChannelClosed if none came.
    /// Closed: why.
    StatusCode status;
    /// Response: NodeId of the encoding and the structure; empty if none came.
    std::vector<std::byte> body;

    /// The response as a T, whose strings borrow from this event; Bad_DecodingError if it is none,
    /// the ServiceResult if that is bad.
    template <typename T>
    [[nodiscard]] Result<T> response(const binary::DecodeLimits& limits = {}) const;
};

/// A client on one connection to a server: opens the channel, creates and activates a session,
/// sends requests and matches their responses. Sans-I/O, in the shape of the channel. A connection
/// that is lost ends it; Client makes new ones.
class Connection {
public:
    /// `environment` must outlive the Connection.
    Connection(ConnectionConfig config, const channel::ChannelEnvironment& environment,
               TimePoint now);
    Connection(Connection&&) noexcept;
    Connection& operator=(Connection&&) noexcept;
    ~Connection();

    Result<void> feed(std::span<const std::byte> in, TimePoint now);
    [[nodiscard]] std::optional<ConnectionEvent> next_event();
    [[nodiscard]] std::span<const std::byte> output() const;
    void consume(std::size_t size);
    [[nodiscard]] TimePoint next_deadline() const;
    void handle_deadline(TimePoint now);
    [[nodiscard]] bool is_closed() const;

    /// Sends `request`, whose header is filled in here; the handle that its Response will carry.
    /// Any number may be under way.
    template <typename Request>
    [[nodiscard]] Result<std::uint32_t> send(Request&& request);
    /// Closes session and channel (Part 4, 5.7.4 and 5.6.3).
    void close();

    /// What the server offered in CreateSession.
    [[nodiscard]] const Array<EndpointDescription>& endpoints() const;

private:
    struct Impl;

    void fill(RequestHeader& header);
    [[nodiscard]] Result<void> send(std::uint32_t handle,
                                    FunctionRef<void(binary::Writer&)> encode);

    std::unique_ptr<Impl> impl_;
};

template <typename T>
Result<T> ConnectionEvent::response(const binary::DecodeLimits& limits) const
{
    if (status.is_bad()) {
        return fail(status);
    }
    static const binary::TypeRegistry types{binary::namespace0_types()};
    binary::Reader reader{body, binary::Strings::Borrow, &types, limits};
    NodeId id;
    T structure;
    decode(reader, id);
    if (!id.is(T::binary_encoding_id)) {
        return fail(status::Bad_DecodingError);
    }
    decode(reader, structure);
    if (!reader.ok()) {
        return fail(reader.status());
    }
    return structure;
}

template <typename Request>
Result<std::uint32_t> Connection::send(Request&& request)
{
    using Type = std::remove_cvref_t<Request>;
    fill(request.request_header);
    const std::uint32_t handle = request.request_header.request_handle;
    const auto sent = send(handle, [&](binary::Writer& writer) {
        encode(writer, NodeId{0, Type::binary_encoding_id});
        encode(writer, request);
    });
    if (!sent) {
        return fail(sent.error());
    }
    return handle;
}

} // namespace busbar::client
