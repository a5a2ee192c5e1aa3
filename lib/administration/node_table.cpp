#include "node_table.hpp"

#include <memory>
#include <utility>

#include <busbar/core/status_codes.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::administration::detail {

std::uint64_t NodeTable::add(Entry entry)
{
    entries_.push_back(std::move(entry));
    return entries_.size() - 1;
}

bool NodeTable::bind_value(model::AddressSpace& space, model::NodeIndex node, Value value,
                           Setter setter)
{
    if (node == model::no_node) {
        return false;
    }
    space.bind(node, index(), add({std::move(value), std::move(setter), {}}));
    return true;
}

bool NodeTable::bind_method(model::AddressSpace& space, model::NodeIndex node, Method method)
{
    if (node == model::no_node) {
        return false;
    }
    space.bind(node, index(), add({{}, {}, std::move(method)}));
    return true;
}

void NodeTable::post(std::function<void()> task)
{
    {
        const std::lock_guard lock{mutex_};
        if (waker_ != nullptr) {
            tasks_.push_back(std::move(task));
            waker_->wake();
            return;
        }
    }
    task();
}

void NodeTable::read(server::ReadBatch batch)
{
    const DateTime now = clock_->now();
    for (std::size_t i = 0; i < batch.size(); ++i) {
        const Entry* const entry = find(batch.items()[i].handle);
        if (entry == nullptr || !entry->value) {
            batch.results()[i] = DataValue{status::Bad_NotReadable};
            continue;
        }
        DataValue value = entry->value();
        value.source_timestamp = now;
        batch.results()[i] = std::move(value);
    }
    batch.complete();
}

void NodeTable::write(server::WriteBatch batch)
{
    for (std::size_t i = 0; i < batch.size(); ++i) {
        const server::WriteItem& item = batch.items()[i];
        const Entry* const entry = find(item.handle);
        batch.results()[i] =
            entry != nullptr && entry->setter ? entry->setter(*item.data) : status::Bad_NotWritable;
    }
    batch.complete();
}

void NodeTable::call(server::CallBatch batch)
{
    const auto shared = std::make_shared<server::CallBatch>(std::move(batch));
    for (std::size_t i = 0; i < shared->size(); ++i) {
        const Entry* const entry = find(shared->items()[i].handle);
        server::MethodCall call{shared, i};
        if (entry == nullptr || !entry->method) {
            call.fail(status::Bad_NotImplemented);
            continue;
        }
        // The table may grow while the Method adds nodes.
        const Method method = entry->method;
        method(std::move(call));
    }
}

void NodeTable::attach(server::Waker* waker)
{
    const std::lock_guard lock{mutex_};
    waker_ = waker;
}

void NodeTable::handle_completions()
{
    std::vector<std::function<void()>> tasks;
    {
        const std::lock_guard lock{mutex_};
        tasks.swap(tasks_);
    }
    for (const auto& task : tasks) {
        task();
    }
}

model::NodeIndex child_of(const model::AddressSpace& space, model::NodeIndex parent,
                          std::string_view name)
{
    model::NodeIndex found = model::no_node;
    if (parent != model::no_node) {
        space.for_each_child(parent, space.find(id::HasChild), true,
                             QualifiedName{0, String::borrow(name)}, [&](model::NodeIndex child) {
                                 found = child;
                                 return false;
                             });
    }
    return found;
}

void copy_access(model::AddressSpace& space, model::NodeIndex from, model::NodeIndex to)
{
    const model::NodeAccess* const access =
        from != model::no_node ? space.node_access(from) : nullptr;
    if (access != nullptr && to != model::no_node) {
        space.set_node_access(to, model::NodeAccess{*access});
    }
}

} // namespace busbar::administration::detail
