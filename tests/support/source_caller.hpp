#pragma once

#include <condition_variable>
#include <initializer_list>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "server/data/data_call.hpp"

namespace busbar::test {

/// A Waker that a test can wait for.
class TestWaker final : public server::Waker {
public:
    void wake() override
    {
        const std::lock_guard lock{mutex_};
        ++count_;
        woken_.notify_all();
    }
    /// Waits until there were more than `seen` calls and gives their number.
    unsigned wait(unsigned seen)
    {
        std::unique_lock lock{mutex_};
        woken_.wait(lock, [&] { return count_ > seen; });
        return count_;
    }
    [[nodiscard]] unsigned count()
    {
        const std::lock_guard lock{mutex_};
        return count_;
    }

private:
    std::mutex mutex_;
    std::condition_variable woken_;
    unsigned count_{0};
};

/// Calls a data source as a server does: `caller.read({handle})`.
class SourceCaller {
public:
    explicit SourceCaller(server::DataSource& source) : sources_{&waker_} { sources_.add(source); }

    /// Waits for a source that completes from another thread.
    std::vector<DataValue> read(const std::vector<server::ReadItem>& items)
    {
        server::detail::SourceRead call{sources_, items.size()};
        ask(call, items);
        Owner owner;
        if (!call.start(owner, TimePoint{}, [](auto&) {})) {
            wait(owner);
        }
        std::vector<DataValue> values;
        for (std::size_t i = 0; i < items.size(); ++i) {
            const server::ReadSlot& slot = call.result(i);
            values.push_back(slot);
            // A copy owns its strings, as the slot may not.
            values.back().value = slot.shared != nullptr ? *slot.shared : slot.value;
        }
        return values;
    }
    std::vector<DataValue> read(std::initializer_list<std::uint64_t> handles)
    {
        std::vector<server::ReadItem> items;
        for (const std::uint64_t handle : handles) {
            items.push_back({handle, nullptr});
        }
        return read(items);
    }
    std::vector<StatusCode> write(const std::vector<server::WriteItem>& items)
    {
        Owner owner;
        server::detail::SourceWrite call{sources_, items.size()};
        ask(call, items);
        if (!call.start(owner, TimePoint{}, [](auto&) {})) {
            wait(owner);
        }
        std::vector<StatusCode> results;
        for (std::size_t i = 0; i < items.size(); ++i) {
            results.push_back(call.result(i));
        }
        return results;
    }
    StatusCode write(std::uint64_t handle, const DataValue& data)
    {
        return write({server::WriteItem{handle, nullptr, &data}})[0];
    }
    /// Waits for a source that has something else to complete, and lets it.
    void await_wake()
    {
        seen_ = waker_.wait(seen_);
        sources_.handle_completions();
    }

private:
    struct Owner final : server::detail::SourceCallOwner {
        bool done{false};
        void call_completed() override { done = true; }
    };

    template <typename Call, typename Items>
    static void ask(Call& call, const Items& items)
    {
        for (std::size_t i = 0; i < items.size(); ++i) {
            call.ask(i, 0, items[i]);
        }
    }
    void wait(const Owner& owner)
    {
        while (!owner.done) {
            await_wake();
        }
    }

    TestWaker waker_;
    server::detail::DataSources sources_;
    unsigned seen_{0};
};

} // namespace busbar::test
