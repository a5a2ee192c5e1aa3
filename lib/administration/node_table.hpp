#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/core/detail/hand_over.hpp>
#include <busbar/core/log.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/data_source.hpp>
#include <busbar/server/method_table.hpp>
#include <busbar/server/worker.hpp>

#include "call_turns.hpp"
#include "permissions.hpp"

namespace busbar::administration::detail {

/// The options of administration's own sources. A call that waits for the worker times out only
/// after the client's own timeoutHint (Part 4, 7.32): after an earlier Bad_Timeout the client would
/// not know that it is done all the same.
[[nodiscard]] inline server::DataSourceOptions own_source_options()
{
    return {.timeout = std::chrono::hours{1}, .is_always_in_service = true};
}

/// The functions for nodes: values that are computed when they are read, values that are checked
/// when they are written, and Methods.
///
/// Used on the server's thread, except post() and raise(). If a function throws, its operation ends
/// and the log is told.
class NodeTable final : public server::DataSource {
public:
    using Value = std::function<DataValue()>;
    /// Returns Good or the reason for a refusal.
    using Setter = std::function<StatusCode(const DataValue& value)>;
    using Method = server::MethodTable::Function;

    /// Number of attempts, without delay, for a task that runs out of memory.
    static constexpr unsigned most_tries = 3;
    /// A task for the server's thread.
    struct Task {
        std::function<void()> function;
        /// Number of rounds of completions before the task runs.
        unsigned rounds{1};
        unsigned tries{0};
        Task* next{nullptr};
    };
    /// A task for the server's thread that runs once, however often it was raised.
    struct Signal {
        std::function<void()> function;
        std::atomic<bool> is_raised{false};
        unsigned tries{0};
    };

    /// The clock provides the source timestamps of values.
    NodeTable(const WallClock& clock, LogSink& log);
    NodeTable(const NodeTable&) = delete;
    NodeTable& operator=(const NodeTable&) = delete;
    ~NodeTable() override;
    /// Sets the server that the nodes belong to; must be called before it calls this source.
    void set_server(server::Server& server)
    {
        server_ = &server;
        turns_.set_server(server);
    }

    /// Lets `value` provide the Variable's value from now on. False if the node does not exist.
    bool bind_value(model::AddressSpace& space, model::NodeIndex node, Value value,
                    Setter setter = {});
    bool bind_method(model::AddressSpace& space, model::NodeIndex node, Method method);
    /// True if there is a Waker, without which posted tasks never run.
    [[nodiscard]] bool has_way_back() const { return !waker_.is_empty(); }
    /// See AdministrationParts::may_administer.
    void ask_before_calls(std::function<bool(const server::UserIdentity&)> may_administer)
    {
        may_administer_ = std::move(may_administer);
    }
    /// Runs the task in the next round of completions. Allocate a task beforehand if it must run
    /// because of what was done. Thread-safe.
    void post(std::unique_ptr<Task> task) noexcept;
    void post(std::function<void()> function)
    {
        post(std::make_unique<Task>(Task{std::move(function)}));
    }
    /// Calls the Method in the next round, outside of the server's callbacks, if the client still
    /// waits then and its user still has the right. If it throws, it answers like Methods that are
    /// served at once.
    void post(server::MethodCall call, std::function<void(server::MethodCall& call)> method);
    /// Returns a signal that lives as long as the table; call this before other threads raise it.
    [[nodiscard]] Signal& add_signal(std::function<void()> function);
    /// Makes the signal's task run. Thread-safe.
    void raise(Signal& signal) noexcept;
    /// Lets the worker do `work`, and calls `end` on the server's thread afterwards; without a
    /// worker it calls both at once. `end` gets Good, Bad_TooManyOperations if the worker has no
    /// room, Bad_InternalError if the worker drops the work, or the status of an exception. Throws
    /// only if there is no memory; then neither is called.
    void run(server::Worker* worker, std::function<void()> work,
             std::function<void(StatusCode done)> end);

    [[nodiscard]] server::DataSourceOptions options() const override
    {
        return own_source_options();
    }
    void read(server::ReadBatch batch) override;
    void write(server::WriteBatch batch) override;
    void call(server::CallBatch batch) override;
    void attach(server::Waker* waker) override;
    void handle_completions() override;

private:
    struct Entry {
        Value value;
        Setter setter;
        Method method;
    };

    struct Job;

    std::uint64_t add(Entry entry);
    /// Returns Good, or why a Method that was posted is not called.
    [[nodiscard]] StatusCode check_posted(const server::MethodCall& call,
                                          const Holder& holder) const;
    void do_task(std::unique_ptr<Task> task);
    void do_signal(Signal& signal);
    void serve(const std::shared_ptr<server::CallBatch>& batch, std::size_t index);
    [[nodiscard]] const Entry* find(std::uint64_t handle) const
    {
        return handle < entries_.size() ? &entries_[static_cast<std::size_t>(handle)] : nullptr;
    }

    const WallClock* clock_;
    LogSink* log_;
    server::Server* server_{nullptr};
    std::function<bool(const server::UserIdentity&)> may_administer_;
    /// Indexed by handle.
    std::vector<Entry> entries_;
    CallTurns turns_;
    std::deque<Signal> signals_;
    busbar::detail::HandOver<Task> posted_;
    busbar::detail::WakerSlot waker_;
};

/// Finds the child with this name in namespace 0; no_node if there is none.
[[nodiscard]] model::NodeIndex child_of(const model::AddressSpace& space, model::NodeIndex parent,
                                        std::string_view name);

} // namespace busbar::administration::detail
