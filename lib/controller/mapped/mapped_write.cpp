#include <algorithm>
#include <utility>

#include "mapped_operation.hpp"

namespace busbar::controller::detail {

namespace {

class Write final : public MappedOperation {
public:
    explicit Write(server::WriteBatch batch) : batch_{std::move(batch)} {}

    std::unique_ptr<backend::LabelRequest> next(MappedContext& context) override;
    void done(MappedContext& context, const backend::LabelRequest& request) override;
    void fail(MappedContext&, StatusCode status) override
    {
        batch_.finish(status);
        is_answered_ = true;
    }

private:
    [[nodiscard]] StatusCode add(MappedContext& context, const server::WriteItem& item,
                                 backend::LabelRequest& request);

    server::WriteBatch batch_;
    bool is_answered_{false};
};

StatusCode Write::add(MappedContext& context, const server::WriteItem& item,
                      backend::LabelRequest& request)
{
    const auto* const variable = context.table.variable(item.handle);
    if (variable == nullptr) {
        return status::Bad_NoCommunication;
    }
    if (variable->shape == nullptr) {
        return status::Bad_NotSupported;
    }
    if (variable->is_broken) {
        return status::Bad_NoCommunication;
    }
    const std::size_t offset = request.bytes.size();
    context.table.add_places(variable->range, request);
    return context.table.encode(*variable->shape, variable->range, item.data->value,
                                request.bytes.data() + offset);
}

std::unique_ptr<backend::LabelRequest> Write::next(MappedContext& context)
{
    if (is_answered_) {
        return nullptr;
    }
    LeafRange all;
    for (const server::WriteItem& item : batch_.items()) {
        if (const auto* const variable = context.table.variable(item.handle)) {
            all.count += variable->range.count;
            all.words += variable->range.words;
        }
    }
    if (!is_within(context.options.limits, all.count, all.words)) {
        fail(context, status::Bad_NoCommunication);
        return nullptr;
    }
    auto request = std::make_unique<backend::LabelRequest>();
    request->kind = backend::LabelRequest::Kind::Write;
    request->places.reserve(all.count);
    request->bytes.reserve(2 * all.words);
    bool is_refused = false;
    for (std::size_t i = 0; i < batch_.size(); ++i) {
        const StatusCode status = add(context, batch_.items()[i], *request);
        batch_.results()[i] = status;
        is_refused = is_refused || status.is_bad();
    }
    if (!is_refused) {
        return request;
    }
    // All or none (8.3): items that were in order fail with the others.
    std::replace(batch_.results().begin(), batch_.results().end(), StatusCode{status::Good},
                 StatusCode{status::Bad_NoCommunication});
    batch_.complete();
    is_answered_ = true;
    return nullptr;
}

void Write::done(MappedContext& context, const backend::LabelRequest& request)
{
    for (const server::WriteItem& item : batch_.items()) {
        if (auto* const variable = context.table.variable(item.handle)) {
            variable->kept = item.data->value;
            variable->time = request.time;
        }
    }
    batch_.finish(status::Good);
    is_answered_ = true;
}

} // namespace

std::unique_ptr<MappedOperation> make_write(server::WriteBatch batch)
{
    return std::make_unique<Write>(std::move(batch));
}

} // namespace busbar::controller::detail
