#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <busbar/client/operation.hpp>
#include <busbar/core/detail/guarded.hpp>

#include "batch_plan.hpp"
#include "handlers.hpp"

namespace busbar::client::detail {

/// Sets the outcome of an item whose request failed; overloaded for other outcomes.
inline void set_failed(StatusCode& outcome, StatusCode why)
{
    outcome = why;
}
inline void set_failed(DataValue& outcome, StatusCode why)
{
    outcome = DataValue{why};
}
template <typename T>
void set_failed(Result<T>& outcome, StatusCode why)
{
    outcome = fail(why);
}
template <typename T>
requires requires(T& outcome)
{
    outcome.status_code;
}
void set_failed(T& outcome, StatusCode why)
{
    outcome = T{};
    outcome.status_code = why;
}

/// A request that ends with a list, which stays with its Batch: it is encoded from there, not
/// copied. Valid as long as the request's handler, which keeps the Batch.
template <typename Request, typename Item>
struct BorrowingRequest {
    static constexpr std::uint32_t binary_encoding_id = Request::binary_encoding_id;

    friend void encode(binary::Writer& writer, const BorrowingRequest& request)
    {
        encode(writer, request.request_header);
        if (request.encode_others != nullptr) {
            request.encode_others(writer, request.others);
        }
        writer.length(request.items.size());
        for (const Item& item : request.items) {
            encode(writer, item);
        }
    }

    std::span<const Item> items;
    /// The fields between the header and the list, if there are any.
    Request others{};
    void (*encode_others)(binary::Writer&, const Request&){nullptr};
    RequestHeader request_header{};
};

/// One service over a list of items, in parts of which a few are under way at a time.
///
/// Service has Item, Outcome, Response, is_repeatable, limit(OperationLimits), request(span of
/// items) and results(Response&, count), an Array whose elements convert to Outcome. A part that
/// fails gives its status to its items. Lives as long as a request is under way.
template <typename Service>
class Batch final : public OperationState, public std::enable_shared_from_this<Batch<Service>> {
public:
    using Item = typename Service::Item;
    using Outcome = typename Service::Outcome;
    using Response = typename Service::Response;
    using Handler = std::function<void(std::vector<Outcome>)>;

    Batch(Requester& requester, Service service, std::vector<Item> items, Handler handler,
          const ServiceOptions& options)
        : requester_{requester}, service_{std::move(service)}, items_{std::move(items)},
          outcomes_(items_.size()), handler_{std::move(handler)}, options_{options},
          plan_{items_.size(), options.max_items_per_request}
    {
    }

    static std::shared_ptr<Batch> start(Requester& requester, Service service,
                                        std::vector<Item> items, Handler handler,
                                        const ServiceOptions& options)
    {
        auto batch = std::make_shared<Batch>(requester, std::move(service), std::move(items),
                                             std::move(handler), options);
        if (batch->items_.empty()) {
            batch->under_way_.push_back({later(requester, [batch] { batch->finish(); }), {}});
        } else {
            busbar::detail::Undo undo{[&] { batch->cancel(); }};
            batch->send_parts();
            undo.keep();
        }
        return batch;
    }

    void cancel() override
    {
        handler_ = nullptr;
        static_cast<void>(plan_.take_rest());
        for (const UnderWay& request : std::exchange(under_way_, {})) {
            requester_.cancel(request.id);
        }
    }
    /// Unsent parts end with Bad_RequestCancelledByClient; the handler is called when the rest is
    /// answered.
    void stop()
    {
        for (const BatchPlan::Part& part : plan_.take_rest()) {
            fail_part(part, status::Bad_RequestCancelledByClient);
        }
    }

private:
    struct UnderWay {
        RequestId id;
        BatchPlan::Part part;
    };

    void send_parts()
    {
        plan_.limit(Service::limit(requester_.server().operation_limits));
        const std::size_t max_parallel = std::max<std::size_t>(options_.max_parallel, 1);
        while (under_way_.size() < max_parallel) {
            const auto part = plan_.next();
            if (!part) {
                break;
            }
            send(*part);
        }
        if (under_way_.empty()) {
            finish();
        }
    }
    void send(BatchPlan::Part part)
    {
        sending_ = part;
        under_way_.reserve(under_way_.size() + 1);
        const std::span<const Item> items{items_.data() + part.first, part.count};
        const RequestId id = requester_.call<Response>(
            service_.request(items),
            [self = this->shared_from_this(), part](Result<Response> response) {
                self->answered(part, std::move(response));
            },
            options_.request);
        under_way_.push_back({id, part});
        sending_.reset();
    }
    void answered(BatchPlan::Part part, Result<Response> response)
    {
        std::erase_if(under_way_,
                      [&](const UnderWay& sent) { return sent.part.first == part.first; });
        bool is_taken = false;
        busbar::detail::Undo undo{[&] {
            if (!is_taken) {
                fail_part(part, status::Bad_OutOfMemory);
            }
            give_up(status::Bad_OutOfMemory);
        }};
        if (response) {
            take_results(part, *response);
        } else if (!is_too_large(response.error(), Service::is_repeatable) || !plan_.halve(part)) {
            fail_part(part, response.error());
        }
        is_taken = true;
        send_parts();
        undo.keep();
    }
    /// Drops unsent parts.
    void give_up(StatusCode why)
    {
        if (const auto part = std::exchange(sending_, std::nullopt)) {
            fail_part(*part, why);
        }
        while (const auto part = plan_.next()) {
            fail_part(*part, why);
        }
        if (under_way_.empty()) {
            finish();
        }
    }
    void take_results(BatchPlan::Part part, Response& response)
    {
        auto results = Service::results(response, part.count);
        if (results.size() != part.count) {
            // Part 4, 5.3: there is one result for each operation.
            return fail_part(part, status::Bad_UnknownResponse);
        }
        for (std::size_t i = 0; i < part.count; ++i) {
            outcomes_[part.first + i] = std::move(results[i]);
        }
    }
    void fail_part(BatchPlan::Part part, StatusCode why)
    {
        for (std::size_t i = 0; i < part.count; ++i) {
            set_failed(outcomes_[part.first + i], why);
        }
    }
    void finish()
    {
        under_way_.clear();
        if (const Handler handler = std::exchange(handler_, nullptr)) {
            handler(std::move(outcomes_));
        }
    }

    Requester& requester_;
    Service service_;
    std::vector<Item> items_;
    std::vector<Outcome> outcomes_;
    Handler handler_;
    ServiceOptions options_;
    BatchPlan plan_;
    std::vector<UnderWay> under_way_;
    /// The part that is no longer in the plan and not yet under way.
    std::optional<BatchPlan::Part> sending_;
};

/// Starts a service that consists of a batch only.
template <typename Service>
Operation run_batch(Requester& requester, Service service,
                    std::vector<typename Service::Item> items,
                    typename Batch<Service>::Handler done, const ServiceOptions& options)
{
    return Operation{Batch<Service>::start(requester, std::move(service), std::move(items),
                                           std::move(done), options)};
}

/// Returns `options` with RequestHeader.returnDiagnostics that requests the additionalInfo of
/// operations.
[[nodiscard]] inline ServiceOptions asking_for_additional_info(ServiceOptions options)
{
    constexpr std::uint32_t additional_info = 0x80; // Part 4, 7.32
    options.request.return_diagnostics |= additional_info;
    return options;
}

/// Returns the additionalInfo of operation `index`; empty if the response has none.
[[nodiscard]] inline std::string additional_info_of(const Array<DiagnosticInfo>& infos,
                                                    std::size_t index)
{
    const bool is_there = index < infos.size() && infos[index].additional_info;
    return is_there ? infos[index].additional_info->str() : std::string{};
}

} // namespace busbar::client::detail
