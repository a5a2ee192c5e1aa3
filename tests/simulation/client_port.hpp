#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>

#include <busbar/channel/client_channel.hpp>
#include <busbar/types/common.hpp>

#include "harness_names.hpp"
#include "support/response.hpp"

namespace busbar::test {

/// A client's end of a link: its channel, and which response belongs to which request. What is to
/// be answered gets an answer: Bad_ConnectionClosed, if need be.
class ClientPort final : public LinkEnd {
public:
    struct Owner {
        Owner() = default;
        Owner(const Owner&) = delete;
        Owner& operator=(const Owner&) = delete;
        virtual ~Owner() = default;
        virtual void channel_opened() = 0;
        /// The port is of no more use, but must not be destroyed yet.
        virtual void channel_closed() = 0;
    };

    ClientPort(Scheduler& scheduler, channel::ClientChannelConfig config,
               const channel::ChannelEnvironment& environment, std::shared_ptr<Link> link,
               Owner& owner);

    [[nodiscard]] const channel::SecuritySetting& security() const { return channel_.security(); }
    template <typename Response, typename Request>
    void call(const Request& request, std::function<void(Result<Response>)> then)
    {
        send(
            [&](binary::Writer& writer) {
                encode(writer, NodeId{0, Request::binary_encoding_id});
                encode(writer, request);
            },
            [then = std::move(then)](Result<std::span<const std::byte>> body) {
                then(body ? decode_response<Response>(*body) : fail(body.error()));
            });
    }
    /// Ends the connection: properly or without a word.
    void close(bool is_proper);

    // LinkEnd
    [[nodiscard]] std::span<const std::byte> output() const override { return channel_.output(); }
    void consume(std::size_t size) override { channel_.consume(size); }
    void feed(std::span<const std::byte> in) override;
    void link_lost() override;

    /// Sends what has not been sent yet, Hello at first.
    void update();

private:
    using Handler = std::function<void(Result<std::span<const std::byte>>)>;

    void send(FunctionRef<void(binary::Writer&)> encode, Handler handler);
    void answer(const channel::ChannelEvent& event);
    void end();

    Scheduler& scheduler_;
    std::shared_ptr<Link> link_;
    Owner& owner_;
    channel::ClientChannel channel_;
    std::map<std::uint32_t, Handler> pending_;
    bool has_ended_{false};
    Alarm deadline_;
};

} // namespace busbar::test
