#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/server/data_source.hpp>

namespace busbar::server {

/// One call of a Method, which a function answers by one of succeed, fail and refuse, on any
/// thread, at once or later. Destroyed without that, it answers Bad_InternalError. Results of the
/// other members are valid until then.
class BUSBAR_API MethodCall {
public:
    MethodCall(std::shared_ptr<CallBatch> batch, std::size_t index)
        : batch_{std::move(batch)}, index_{index}
    {
    }
    MethodCall(MethodCall&&) noexcept = default;
    MethodCall& operator=(MethodCall&&) noexcept = default;
    ~MethodCall() = default;

    [[nodiscard]] const NodeId& object_id() const { return *item().object_id; }
    [[nodiscard]] const NodeId& method_id() const { return *item().method_id; }
    [[nodiscard]] std::span<const Variant> inputs() const { return item().inputs; }
    /// Returns input `index` if it is a scalar of T, else `otherwise`: Methods may accept others.
    template <BuiltIn T>
    [[nodiscard]] T input(std::size_t index, T otherwise = {}) const
    {
        return inputs()[index].value_or<T>(std::move(otherwise));
    }
    [[nodiscard]] const UserIdentity& user() const { return batch_->caller().user; }
    [[nodiscard]] const NodeId& session_id() const { return batch_->caller().session_id; }
    [[nodiscard]] const MethodCaller& caller() const { return batch_->caller(); }
    [[nodiscard]] bool is_abandoned() const { return batch_->is_abandoned(); }

    // Each of these ends the call; a second one does nothing. `reason` is CallResult::reason.
    void succeed(Array<Variant> outputs = {});
    void fail(StatusCode status, std::string reason = {});
    /// Answers Bad_InvalidArgument with one status for each input.
    void refuse(Array<StatusCode> input_results, std::string reason = {});

private:
    [[nodiscard]] const CallItem& item() const { return batch_->items()[index_]; }
    void finish(CallResult result);

    std::shared_ptr<CallBatch> batch_; // of all its calls, the last of which completes it
    std::size_t index_;
};

/// Methods as functions: a data source without values.
///
///     const std::uint64_t start = table.add([&](MethodCall call) {
///         machine.start(call.input<double>(0));
///         call.succeed();
///     });
///
/// Used on the server's thread only; the functions may answer on any thread.
class BUSBAR_API MethodTable final : public DataSource {
public:
    /// Must not block: slow work keeps the call and answers later. An exception answers
    /// Bad_InternalError, unless the call was answered, and is logged.
    using Function = std::function<void(MethodCall)>;

    explicit MethodTable(const DataSourceOptions& options = {}) : options_{options} {}

    /// Returns the handle that the Method's node must have.
    [[nodiscard]] std::uint64_t add(Function function);
    /// Frees the function of a Method that was removed; not within one. The handle may come again.
    void remove(std::uint64_t handle) noexcept;

    [[nodiscard]] DataSourceOptions options() const override { return options_; }
    void read(ReadBatch batch) override { batch.fail(status::Bad_NotReadable); }
    void call(CallBatch batch) override;

private:
    DataSourceOptions options_;
    std::vector<Function> functions_; // by handle
    std::vector<std::uint64_t> free_;
};

} // namespace busbar::server
