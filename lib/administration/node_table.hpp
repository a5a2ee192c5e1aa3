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

namespace busbar::administration::detail {

/// The options of administration's own sources. A call that waits for the worker is late when the
/// client's own timeoutHint has passed (Part 4, 7.32), and not before: after Bad_Timeout the client
/// would not know that it is done all the same.
[[nodiscard]] inline server::DataSourceOptions own_source_options()
{
    return {.timeout = std::chrono::hours{1}, .is_always_in_service = true};
}

/// Functions behind nodes: values that are made when they are asked for, values that are checked
/// when they are written, and Methods.
///
/// On the server's thread, but for post() and raise(). A function that throws ends what it was
/// called for, and the log is told.
class NodeTable final : public server::DataSource {
public:
    using Value = std::function<DataValue()>;
    /// Good, or why not.
    using Setter = std::function<StatusCode(const DataValue& value)>;
    using Method = server::MethodTable::Function;

    /// How often something is tried again at once for which there was no memory.
    static constexpr unsigned most_tries = 3;
    /// Something to do on the server's thread.
    struct Task {
        std::function<void()> function;
        /// It is done after so many rounds of completions.
        unsigned rounds{1};
        unsigned tries{0};
        Task* next{nullptr};
    };
    /// Something to do on the server's thread, once for all who have asked for it.
    struct Signal {
        std::function<void()> function;
        std::atomic<bool> is_raised{false};
        unsigned tries{0};
    };

    /// The clock gives values their source timestamps.
    NodeTable(const WallClock& clock, LogSink& log);
    NodeTable(const NodeTable&) = delete;
    NodeTable& operator=(const NodeTable&) = delete;
    ~NodeTable() override;
    /// Names the server that the nodes belong to; to be called before it calls this source.
    void set_server(server::Server& server) { turns_.set_server(server); }

    /// The Variable's value comes from `value` from now on. False if there is no such node.
    bool bind_value(model::AddressSpace& space, model::NodeIndex node, Value value,
                    Setter setter = {});
    bool bind_method(model::AddressSpace& space, model::NodeIndex node, Method method);
    /// Whether there is a Waker, without which nothing that is posted is ever done.
    [[nodiscard]] bool has_way_back() const { return !waker_.is_empty(); }
    /// See AdministrationParts::may_administer.
    void ask_before_calls(std::function<bool(const server::UserIdentity&)> may_administer)
    {
        may_administer_ = std::move(may_administer);
    }
    /// Does the task in the next round of completions. A task that must not fail to come, because
    /// of what was done before, is made before that. Any thread.
    void post(std::unique_ptr<Task> task) noexcept;
    void post(std::function<void()> function)
    {
        post(std::make_unique<Task>(Task{std::move(function)}));
    }
    /// Does the Method in the next round, when the server is in none of its callbacks. One that
    /// throws answers as those do that are served at once.
    void post(server::MethodCall call, std::function<void(server::MethodCall& call)> method);
    /// As long as the table; before others raise it.
    [[nodiscard]] Signal& add_signal(std::function<void()> function);
    /// Any thread.
    void raise(Signal& signal) noexcept;
    /// Has the worker do `work`, and calls `end` on the server's thread afterwards; without a
    /// worker it does both at once. `end` gets Good, Bad_TooManyOperations if the worker has no
    /// room, Bad_InternalError if it drops the work, or the status of what one of them threw. If
    /// this throws there was no memory, and neither is called.
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
    void do_task(std::unique_ptr<Task> task);
    void do_signal(Signal& signal);
    void serve(const std::shared_ptr<server::CallBatch>& batch, std::size_t index);
    [[nodiscard]] const Entry* find(std::uint64_t handle) const
    {
        return handle < entries_.size() ? &entries_[static_cast<std::size_t>(handle)] : nullptr;
    }

    const WallClock* clock_;
    LogSink* log_;
    std::function<bool(const server::UserIdentity&)> may_administer_;
    /// The handle is the index.
    std::vector<Entry> entries_;
    CallTurns turns_;
    std::deque<Signal> signals_;
    busbar::detail::HandOver<Task> posted_;
    busbar::detail::WakerSlot waker_;
};

/// The child with this name in namespace 0; no_node if there is none.
[[nodiscard]] model::NodeIndex child_of(const model::AddressSpace& space, model::NodeIndex parent,
                                        std::string_view name);

} // namespace busbar::administration::detail
