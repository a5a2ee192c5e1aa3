#include <algorithm>

#include <busbar/binary/codec.hpp>

#include "publish_queue.hpp"
#include "subscription.hpp"
#include "subscription_table.hpp"

namespace busbar::server::detail {

PublishOperation::~PublishOperation()
{
    if (part_ != nullptr) {
        std::erase(part_->requests_, this);
    }
}

void PublishOperation::start(ServiceContext& context)
{
    const SubscriptionLimits& limits = all_.needs().limits.subscriptions;
    if (request().subscription_acknowledgements.size() > limits.max_acknowledgements) {
        return fault(status::Bad_TooManyOperations);
    }
    PublishPart& part = PublishPart::of(*context.session);
    if (!part.has_anything()) {
        return fault(status::Bad_NoSubscription);
    }
    acknowledge(*context.session);
    if (!charge(results_.size() * sizeof(StatusCode))) {
        return fault(status::Bad_TooManyOperations);
    }
    part.enqueue(*this, limits.max_publish_requests);
    part.serve(context.now);
}

/// DeleteAckedNotificationMsgs(), for all Subscriptions of the session.
void PublishOperation::acknowledge(const Session& session)
{
    results_.reserve(request().subscription_acknowledgements.size());
    for (const SubscriptionAcknowledgement& acknowledgement :
         request().subscription_acknowledgements) {
        Subscription* const subscription = all_.find(acknowledgement.subscription_id, session);
        if (subscription == nullptr) {
            results_.push_back(status::Bad_SubscriptionIdInvalid);
            continue;
        }
        const bool was_kept =
            subscription->retransmission().acknowledge(acknowledgement.sequence_number);
        results_.push_back(was_kept ? status::Good : status::Bad_SequenceNumberUnknown);
    }
}

std::size_t PublishOperation::room_for_message(std::size_t available) const
{
    // Headers, and the parts of the response other than its message.
    const std::size_t of_diagnostics =
        diagnostics().wants_operations() ? 512 + 32 * results_.size() : 0;
    const std::size_t others = 256 + 4 * results_.size() + 4 * available + of_diagnostics;
    const std::size_t limit = response_limit();
    return limit > others ? limit - others : 0;
}

void PublishOperation::answer(const Message& message)
{
    ReturnDiagnostics diagnostics = this->diagnostics();
    const auto infos = diagnose(diagnostics);
    respond<PublishResponse>(diagnostics, [&](binary::Writer& writer) {
        writer.number(message.subscription.id());
        message.subscription.retransmission().encode_available(writer);
        encode(writer, message.more_notifications);
        writer.bytes(message.bytes);
        encode_results(writer, infos);
    });
}

void PublishOperation::answer_status_change(std::uint32_t subscription_id,
                                            std::span<const std::byte> message)
{
    ReturnDiagnostics diagnostics = this->diagnostics();
    const auto infos = diagnose(diagnostics);
    respond<PublishResponse>(diagnostics, [&](binary::Writer& writer) {
        writer.number(subscription_id);
        writer.length(0);
        encode(writer, false);
        writer.bytes(message);
        encode_results(writer, infos);
    });
}

/// Returns the diagnostics of the acknowledgements.
Array<DiagnosticInfo> PublishOperation::diagnose(ReturnDiagnostics& diagnostics) const
{
    return diagnostics.of_operations(
        results_.size(), [&](std::size_t i) { return results_[i]; },
        [](std::size_t) { return std::string{}; });
}

void PublishOperation::encode_results(binary::Writer& writer,
                                      const Array<DiagnosticInfo>& infos) const
{
    writer.length(results_.size());
    for (const StatusCode result : results_) {
        encode(writer, result);
    }
    encode(writer, infos);
}

} // namespace busbar::server::detail
