#pragma once

#include <algorithm>
#include <memory>
#include <utility>

#include <busbar/server/memory_source.hpp>

#include "harness_names.hpp"
#include "support/failing_allocation.hpp"

namespace busbar::test {

/// Another one's values, as a slow bus brings them: those of the moment when they were asked for,
/// some time later, in order. Nothing is slower than the server waits.
class LateSource final : public server::DataSource {
public:
    static constexpr Duration longest{std::chrono::seconds{3}};

    LateSource(Scheduler& scheduler, const server::MemorySource& memory, Chance chance)
        : scheduler_{&scheduler}, memory_{&memory}, chance_{chance}
    {
    }

    [[nodiscard]] server::DataSourceOptions options() const override { return memory_->options(); }
    void read(server::ReadBatch batch) override
    {
        const Uncounted in_test;
        const auto late = std::make_shared<server::ReadBatch>(std::move(batch));
        for (std::size_t i = 0; i < late->size(); ++i) {
            late->results()[i] = memory_->get(late->items()[i].handle);
        }
        const bool is_slow = chance_.one_in(4);
        const Duration delay = chance_.between(Duration{0}, is_slow ? longest : longest / 100);
        due_ = std::max(due_, scheduler_->now() + delay);
        if (due_ <= scheduler_->now()) {
            return late->complete();
        }
        scheduler_->at(due_, [late] { late->complete(); });
    }

private:
    Scheduler* scheduler_;
    const server::MemorySource* memory_;
    Chance chance_;
    /// When the last one that was asked for comes.
    TimePoint due_{};
};

} // namespace busbar::test
