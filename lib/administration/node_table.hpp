#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/model/address_space.hpp>
#include <busbar/server/data_source.hpp>
#include <busbar/server/method_table.hpp>

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
/// On the server's thread, but for post(). Functions that throw end what they were called for.
class NodeTable final : public server::DataSource {
public:
    using Value = std::function<DataValue()>;
    /// Good, or why not.
    using Setter = std::function<StatusCode(const DataValue& value)>;
    using Method = server::MethodTable::Function;

    /// `now` is the source timestamp of values.
    explicit NodeTable(const WallClock& clock);
    /// Names the server that the nodes belong to; to be called before it calls this source.
    void set_server(server::Server& server) { turns_.set_server(server); }

    /// The Variable's value comes from `value` from now on. False if there is no such node.
    bool bind_value(model::AddressSpace& space, model::NodeIndex node, Value value,
                    Setter setter = {});
    bool bind_method(model::AddressSpace& space, model::NodeIndex node, Method method);
    /// Runs the task on the server's thread, soon; at once without a Waker. Any thread.
    void post(std::function<void()> task);
    /// What is posted when users or roles have changed; may be empty.
    void after_change(std::function<void()> task) { after_change_ = std::move(task); }
    void post_change()
    {
        if (after_change_) {
            post(after_change_);
        }
    }

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

    std::uint64_t add(Entry entry);
    void serve(const std::shared_ptr<server::CallBatch>& batch, std::size_t index);
    [[nodiscard]] const Entry* find(std::uint64_t handle) const
    {
        return handle < entries_.size() ? &entries_[static_cast<std::size_t>(handle)] : nullptr;
    }

    const WallClock* clock_;
    std::function<void()> after_change_;
    /// The handle is the index.
    std::vector<Entry> entries_;
    CallTurns turns_;
    std::mutex mutex_; // of what follows
    server::Waker* waker_{nullptr};
    std::vector<std::function<void()>> tasks_;
};

/// The child with this name in namespace 0; no_node if there is none.
[[nodiscard]] model::NodeIndex child_of(const model::AddressSpace& space, model::NodeIndex parent,
                                        std::string_view name);

/// `to` has RolePermissions and AccessRestrictions as `from`; nothing where one of them is no node.
void copy_access(model::AddressSpace& space, model::NodeIndex from, model::NodeIndex to);

} // namespace busbar::administration::detail
