#include "node_table.hpp"

#include <memory>
#include <utility>

#include <busbar/core/status_codes.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::administration::detail {

NodeTable::NodeTable(const WallClock& clock)
    : clock_{&clock}, turns_{[this](const std::shared_ptr<server::CallBatch>& batch,
                                    std::size_t index) { serve(batch, index); }}
{
}

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
    turns_.add(std::move(batch));
}

void NodeTable::serve(const std::shared_ptr<server::CallBatch>& batch, std::size_t index)
{
    const Entry* const entry = find(batch->items()[index].handle);
    server::MethodCall call{batch, index};
    if (entry == nullptr || !entry->method) {
        return call.fail(status::Bad_NotImplemented);
    }
    // The table may grow while the Method adds nodes.
    const Method method = entry->method;
    method(std::move(call));
}

void NodeTable::attach(server::Waker* waker)
{
    turns_.attach(waker);
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
    turns_.serve_next();
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
