#include "client_port.hpp"

#include <utility>

namespace busbar::test {

ClientPort::ClientPort(Scheduler& scheduler, channel::ClientChannelConfig config,
                       const channel::ChannelEnvironment& environment, std::shared_ptr<Link> link,
                       Owner& owner)
    : scheduler_{scheduler}, link_{std::move(link)}, owner_{owner}, channel_{std::move(config),
                                                                             environment,
                                                                             scheduler.now()},
      deadline_{scheduler, [this] {
                    channel_.handle_deadline(scheduler_.now());
                    update();
                }}
{
}

void ClientPort::feed(std::span<const std::byte> in)
{
    static_cast<void>(channel_.feed(in, scheduler_.now()));
    update();
}

void ClientPort::update()
{
    while (auto event = channel_.next_event()) {
        switch (event->kind) {
        case channel::ChannelEvent::Kind::Opened:
            owner_.channel_opened();
            break;
        case channel::ChannelEvent::Kind::Message:
        case channel::ChannelEvent::Kind::Aborted:
            answer(*event);
            break;
        case channel::ChannelEvent::Kind::Renewed:
            break;
        case channel::ChannelEvent::Kind::Closed:
            close(true);
            break;
        }
    }
    if (!has_ended_) {
        link_->flush(Side::Client);
        deadline_.set(channel_.next_deadline());
    }
}

void ClientPort::send(FunctionRef<void(binary::Writer&)> encode, Handler handler)
{
    const auto id = has_ended_ ? fail(status::Bad_ConnectionClosed) : channel_.send(encode);
    if (!id) {
        return handler(fail(id.error()));
    }
    pending_.emplace(*id, std::move(handler));
    link_->flush(Side::Client);
}

void ClientPort::answer(const channel::ChannelEvent& event)
{
    auto found = pending_.extract(event.request_id);
    if (found.empty()) {
        return;
    }
    if (event.kind == channel::ChannelEvent::Kind::Aborted) {
        found.mapped()(fail(event.status));
    } else {
        found.mapped()(std::span<const std::byte>{event.body});
    }
}

void ClientPort::close(bool is_proper)
{
    if (has_ended_) {
        return;
    }
    if (is_proper) {
        channel_.close();
        link_->close(Side::Client);
    } else {
        link_->leave(Side::Client);
    }
    end();
}

void ClientPort::link_lost()
{
    end();
}

void ClientPort::end()
{
    if (std::exchange(has_ended_, true)) {
        return;
    }
    deadline_.cancel();
    for (auto& [id, handler] : std::exchange(pending_, {})) {
        handler(fail(status::Bad_ConnectionClosed));
    }
    owner_.channel_closed();
}

} // namespace busbar::test
