#include "node_table.hpp"

#include <memory>
#include <utility>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::administration::detail {

/// The job of a worker, see run(). When it is destroyed, whether done or not, the end is posted to
/// the server's thread.
struct NodeTable::Job {
    /// Passed to `end`, which runs on another thread than the work.
    struct Outcome {
        StatusCode status{status::Bad_InternalError};
        busbar::detail::ThrownText thrown;
    };

    Job(NodeTable& posts_to, std::function<void()> to_do, std::function<void(StatusCode)> end)
        : table{posts_to}, work{std::move(to_do)}, task{std::make_unique<Task>()}
    {
        task->function = [log = table.log_, outcome = outcome, end = std::move(end)] {
            if (outcome->status.is_bad() && !outcome->thrown.view().empty()) {
                busbar::detail::report_thrown(*log, "the work of a Method", outcome->thrown.view());
            }
            end(outcome->status);
        };
    }
    Job(const Job&) = delete;
    Job& operator=(const Job&) = delete;
    ~Job() { post_end(); }

    void do_work() { outcome->status = busbar::detail::caught(outcome->thrown, work); }
    void refuse(StatusCode why)
    {
        outcome->status = why;
        post_end();
    }
    void post_end()
    {
        work = nullptr; // release what the work holds before `end` runs
        if (task != nullptr) {
            table.post(std::move(task));
        }
    }

    NodeTable& table;
    std::function<void()> work;
    std::shared_ptr<Outcome> outcome{std::make_shared<Outcome>()};
    std::unique_ptr<Task> task;
};

NodeTable::NodeTable(const WallClock& clock, LogSink& log)
    : clock_{&clock}, log_{&log}, turns_{[this](const std::shared_ptr<server::CallBatch>& batch,
                                                std::size_t index) { serve(batch, index); },
                                         log}
{
}

NodeTable::~NodeTable()
{
    for (Task* left = posted_.take(); left != nullptr;) {
        const std::unique_ptr<Task> dropped{std::exchange(left, left->next)};
    }
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

void NodeTable::post(std::unique_ptr<Task> task) noexcept
{
    if (posted_.push(*task.release())) {
        waker_.wake();
    }
}

void NodeTable::post(server::MethodCall call, std::function<void(server::MethodCall& call)> method)
{
    const auto kept = std::make_shared<server::MethodCall>(std::move(call));
    post([this, kept, holder = server_ != nullptr ? holder_of(*server_, *kept) : Holder{},
          method = std::move(method)] {
        StatusCode refused;
        const StatusCode thrown = busbar::detail::guarded(*log_, "a Method of administration", [&] {
            refused = check_posted(*kept, holder);
            if (!refused.is_bad()) {
                method(*kept);
            }
        });
        if (thrown.is_bad() || refused.is_bad()) {
            kept->fail(thrown.is_bad() ? thrown : refused);
        }
    });
}

StatusCode NodeTable::check_posted(const server::MethodCall& call, const Holder& holder) const
{
    if (call.is_abandoned()) {
        return status::Bad_Timeout;
    }
    return server_ != nullptr ? check_still(*server_, holder, call.object_id(), call.method_id())
                              : StatusCode{status::Good};
}

NodeTable::Signal& NodeTable::add_signal(std::function<void()> function)
{
    Signal& added = signals_.emplace_back();
    added.function = std::move(function);
    return added;
}

void NodeTable::raise(Signal& signal) noexcept
{
    signal.is_raised = true;
    waker_.wake();
}

void NodeTable::run(server::Worker* worker, std::function<void()> work,
                    std::function<void(StatusCode done)> end)
{
    if (worker == nullptr) {
        return end(busbar::detail::guarded(*log_, "the work of a Method", work));
    }
    const auto job = std::make_shared<Job>(*this, std::move(work), std::move(end));
    bool is_taken = false;
    const StatusCode thrown = busbar::detail::guarded(
        *log_, "Worker::run", [&] { is_taken = worker->run([job] { job->do_work(); }); });
    if (!is_taken) {
        job->refuse(thrown.is_bad() ? thrown : status::Bad_TooManyOperations);
    }
}

void NodeTable::read(server::ReadBatch batch)
{
    const DateTime now = clock_->now();
    for (std::size_t i = 0; i < batch.size(); ++i) {
        const Entry* const entry = find(batch.items()[i].handle);
        DataValue value{status::Bad_NotReadable};
        if (entry != nullptr && entry->value) {
            const StatusCode done = busbar::detail::guarded(*log_, "the value of a node",
                                                            [&] { value = entry->value(); });
            if (done.is_bad()) {
                value = DataValue{done};
            }
            value.source_timestamp = now;
        }
        batch.results()[i] = std::move(value);
    }
    batch.complete();
}

void NodeTable::write(server::WriteBatch batch)
{
    for (std::size_t i = 0; i < batch.size(); ++i) {
        const server::WriteItem& item = batch.items()[i];
        const Entry* const entry = find(item.handle);
        StatusCode result{status::Bad_NotWritable};
        if (entry != nullptr && entry->setter) {
            const StatusCode done = busbar::detail::guarded(
                *log_, "the setter of a node", [&] { result = entry->setter(*item.data); });
            result = done.is_bad() ? done : result;
        }
        batch.results()[i] = result;
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
    if (may_administer_ && !may_administer_(call.user())) {
        return call.fail(status::Bad_UserAccessDenied);
    }
    // Copy it: the table may grow while the Method adds nodes.
    const Method method = entry->method;
    method(std::move(call));
}

void NodeTable::attach(server::Waker* waker)
{
    turns_.attach(waker);
    waker_.set(waker);
}

void NodeTable::handle_completions()
{
    // Leave tasks that are posted from here on to the next round, when the answers have been sent.
    Task* first = posted_.take();
    for (Signal& signal : signals_) {
        if (signal.is_raised.exchange(false)) {
            do_signal(signal);
        }
    }
    while (first != nullptr) {
        std::unique_ptr<Task> task{std::exchange(first, first->next)};
        task->next = nullptr;
        if (--task->rounds != 0) {
            post(std::move(task));
        } else {
            do_task(std::move(task));
        }
    }
    turns_.serve_next();
}

void NodeTable::do_task(std::unique_ptr<Task> task)
{
    const StatusCode thrown =
        busbar::detail::guarded(*log_, "a task of administration", task->function);
    if (thrown == status::Bad_OutOfMemory && ++task->tries != most_tries) {
        task->rounds = 1;
        post(std::move(task));
    }
}

void NodeTable::do_signal(Signal& signal)
{
    const StatusCode thrown =
        busbar::detail::guarded(*log_, "a task of administration", signal.function);
    if (thrown != status::Bad_OutOfMemory) {
        signal.tries = 0;
    } else if (++signal.tries != most_tries) {
        raise(signal);
    } else { // repeat it in the next round
        signal.tries = 0;
        signal.is_raised = true;
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

} // namespace busbar::administration::detail
