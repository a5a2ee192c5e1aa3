#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <busbar/channel/client_channel.hpp>
#include <busbar/channel/server_channel.hpp>
#include <busbar/harness/link.hpp>

namespace busbar::harness::detail {

/// A channel at one end of a link. What happens is looked at by its owner, after `changed` has gone
/// off: not at once, since links call back from within.
template <typename Channel>
class ProxyEnd final : public LinkEnd {
public:
    ProxyEnd(Scheduler& scheduler, Side side, Alarm& changed)
        : scheduler_{&scheduler}, side_{side}, changed_{&changed},
          deadline_{scheduler, [this] {
                        channel_->handle_deadline(scheduler_->now());
                        changed_->set_after(Duration{0});
                    }}
    {
    }
    ~ProxyEnd() override { leave(); }

    /// Before it has a link.
    void begin(Channel channel) { channel_.emplace(std::move(channel)); }
    void begin(std::shared_ptr<Link> link)
    {
        link_ = std::move(link);
        changed_->set_after(Duration{0});
    }
    [[nodiscard]] Channel& channel() { return *channel_; }
    [[nodiscard]] bool is_open() const { return channel_ && channel_->is_open(); }
    /// It has begun, and has ended or will not carry anything any more.
    [[nodiscard]] bool is_over() const
    {
        return channel_ && (link_ == nullptr || channel_->is_closed());
    }
    [[nodiscard]] bool has_link() const { return link_ != nullptr; }
    /// The link has ended without the other end's having said so.
    [[nodiscard]] bool was_cut() const { return was_cut_; }

    [[nodiscard]] std::optional<channel::ChannelEvent> next_event()
    {
        auto event = channel_ ? channel_->next_event() : std::nullopt;
        if (event && event->kind == channel::ChannelEvent::Kind::Closed) {
            status_ = event->status;
            reason_ = event->reason;
        }
        return event;
    }
    /// Sends what the channel has to say, and closes the link after a channel that has ended.
    void flush()
    {
        if (link_ == nullptr) {
            return;
        }
        link_->flush(side_);
        if (channel_->is_closed()) {
            std::exchange(link_, nullptr)->close(side_);
            deadline_.cancel();
        } else {
            deadline_.set(channel_->next_deadline());
        }
    }
    /// Ends as the other side of the proxy has ended.
    template <typename Other>
    void end_as(const ProxyEnd<Other>& other)
    {
        if (link_ == nullptr) {
            return;
        }
        if (other.was_cut()) {
            leave();
            return;
        }
        if constexpr (std::is_same_v<Channel, channel::ServerChannel>) {
            if (other.status().is_bad()) {
                channel_->close(other.status(), other.reason());
            }
        } else {
            channel_->close();
        }
        link_->flush(side_);
        std::exchange(link_, nullptr)->close(side_);
        deadline_.cancel();
    }
    [[nodiscard]] StatusCode status() const { return status_; }
    [[nodiscard]] const std::string& reason() const { return reason_; }

    // LinkEnd.
    [[nodiscard]] std::span<const std::byte> output() const override { return channel_->output(); }
    void consume(std::size_t size) override { channel_->consume(size); }
    void feed(std::span<const std::byte> in) override
    {
        static_cast<void>(channel_->feed(in, scheduler_->now()));
        changed_->set_after(Duration{0});
    }
    void link_lost() override
    {
        was_cut_ = link_ != nullptr && link_->is_cut();
        link_.reset();
        deadline_.cancel();
        changed_->set_after(Duration{0});
    }

private:
    void leave()
    {
        if (const auto link = std::exchange(link_, nullptr)) {
            link->leave(side_);
        }
        deadline_.cancel();
    }

    Scheduler* scheduler_;
    Side side_;
    Alarm* changed_;
    std::optional<Channel> channel_;
    std::shared_ptr<Link> link_;
    StatusCode status_;
    std::string reason_;
    bool was_cut_{false};
    Alarm deadline_;
};

} // namespace busbar::harness::detail
