#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <busbar/channel/open_worker.hpp>

#include "server/users/work_queue.hpp"

namespace busbar::server {
class Worker;
}

namespace busbar::server::detail {

class PeerLink;
struct Core;

/// Lets a Worker do the asymmetric work of one connection's channel: work of open channels precedes
/// that of unknown peers (see WorkQueue).
class ChannelWork final : public channel::OpenWorker, private WorkOwner {
public:
    /// Both must outlive it.
    ChannelWork(Core& core, PeerLink& link, std::string_view address);

    /// Returns itself; null if there is no worker, or it cannot report back: the work is then done
    /// in place.
    [[nodiscard]] channel::OpenWorker* if_there();
    [[nodiscard]] bool start(std::shared_ptr<channel::OpenWork> work) override;
    void drop() override;

private:
    struct Item;

    void work_done(TimePoint now) override;
    void work_displaced(TimePoint now) override;

    Core& core_;
    PeerLink& link_;
    std::string source_;
    std::shared_ptr<Item> item_;
};

} // namespace busbar::server::detail
