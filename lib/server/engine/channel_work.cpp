#include "channel_work.hpp"

#include <utility>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/server/worker.hpp>

#include "peer_link.hpp"
#include "server/users/login_guard.hpp"

namespace busbar::server::detail {

struct ChannelWork::Item final : WorkItem {
    void run() override
    {
        failure = busbar::detail::caught(thrown, [&] { work->run(); });
    }

    std::shared_ptr<channel::OpenWork> work;
    /// The status until it is done.
    StatusCode failure{status::Bad_OutOfMemory};
    busbar::detail::ThrownText thrown;
};

ChannelWork::ChannelWork(Core& core, PeerLink& link, std::string_view address)
    : core_{core}, link_{link}, source_{network_of(address)}
{
}

channel::OpenWorker* ChannelWork::if_there()
{
    const bool is_there =
        core_.environment.channel_worker != nullptr && core_.channel_work.has_way_back();
    return is_there ? this : nullptr;
}

bool ChannelWork::start(std::shared_ptr<channel::OpenWork> work)
{
    auto item = std::make_shared<Item>();
    item->source = source_;
    item->rank = static_cast<unsigned>(work->kind());
    item->owner = this;
    item->work = std::move(work);
    const auto run = [&](std::function<void()> job) {
        bool is_taken = false;
        busbar::detail::guarded(link_.log(), "Worker::run", [&] {
            is_taken = core_.environment.channel_worker->run(std::move(job));
        });
        return is_taken;
    };
    item_ = item;
    return core_.channel_work.start(item, run, core_.latest);
}

void ChannelWork::drop()
{
    if (const auto item = std::exchange(item_, nullptr)) {
        core_.channel_work.forget(*item);
    }
}

void ChannelWork::work_done(TimePoint now)
{
    const auto item = std::exchange(item_, nullptr);
    if (item->failure.is_bad()) {
        busbar::detail::report_thrown(link_.log(), "OpenSecureChannel on a worker",
                                      item->thrown.view());
    }
    link_.channel_work_done(item->failure, now);
}

void ChannelWork::work_displaced(TimePoint now)
{
    item_ = nullptr;
    link_.channel_work_done(status::Bad_TcpServerTooBusy, now);
}

} // namespace busbar::server::detail
