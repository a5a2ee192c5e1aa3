#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include <busbar/net/client_loop.hpp>
#include <busbar/types/attribute.hpp>

#include "hostile.hpp"
#include "load.hpp"
#include "tally.hpp"

namespace busbar::bench {

/// Longer than anybody waits: what is late is to be measured, not given up.
inline constexpr std::chrono::milliseconds patience{30'000};

/// A client that wants one value, soon.
class GoodClient {
public:
    explicit GoodClient(Load& load);

    [[nodiscard]] Result<void> connect();
    /// Reads as long as it is to, and at least once; fails when there is no connection any more.
    [[nodiscard]] Result<void> read_while(const std::function<bool(double)>& goes_on,
                                          HostileRow& row);
    void leave() { loop_->close(); }

private:
    Load* load_;
    std::unique_ptr<net::ClientLoop> loop_;
    ReadRequest request_;
};

/// The good client's Subscription, on a thread and a connection of its own.
class GoodSubscriber {
public:
    explicit GoodSubscriber(Load& load);

    [[nodiscard]] Result<void> finish(HostileRow& row);

    static constexpr std::chrono::milliseconds warm_up{400};

private:
    Result<std::vector<SubscribeRow>> rows_;
    std::thread thread_;
};

/// Further connections of the good client, so many a second, each on one of so many threads.
class Newcomers {
public:
    Newcomers(Load& load, const Tally& tally, HostileRow& row, std::size_t threads,
              std::size_t per_second);
    Newcomers(const Newcomers&) = delete;
    Newcomers& operator=(const Newcomers&) = delete;
    ~Newcomers();

private:
    void come_and_go(Load& load, std::chrono::steady_clock::time_point next,
                     std::chrono::milliseconds apart);
    void note(const Result<void>& opened, double took_ms, std::size_t before);

    const Tally& tally_;
    std::mutex mutex_;
    HostileRow& row_;
    std::atomic<bool> is_over_{false};
    std::vector<std::thread> threads_;
};

} // namespace busbar::bench
