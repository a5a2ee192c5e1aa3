#pragma once

#include <memory>
#include <utility>

#include <busbar/channel/open_worker.hpp>
#include <busbar/channel/server_channel.hpp>

namespace busbar::test {

/// Does the asymmetric work of a channel when the test says so.
class HandWorker final : public channel::OpenWorker {
public:
    [[nodiscard]] bool start(std::shared_ptr<channel::OpenWork> next) override
    {
        if (is_full) {
            return false;
        }
        work = std::move(next);
        ++started;
        return true;
    }
    void drop() override
    {
        work = nullptr;
        ++dropped;
    }
    /// False if there is nothing to do.
    bool finish(channel::ServerChannel& server, TimePoint now)
    {
        const auto done = std::exchange(work, nullptr);
        if (done == nullptr) {
            return false;
        }
        done->run();
        server.work_done({}, now);
        return true;
    }

    std::shared_ptr<channel::OpenWork> work;
    int started{0};
    int dropped{0};
    bool is_full{false};
};

} // namespace busbar::test
