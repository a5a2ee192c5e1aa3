#pragma once

#include <memory>
#include <string>
#include <utility>

#include <busbar/client/text_access.hpp>

#include "client/services/handlers.hpp"

namespace busbar::client::detail {

/// The common part of operations with texts: steps one after the other, and one way to end.
template <typename Outcome>
class TextOperation : public OperationState {
public:
    using Done = std::function<void(Accessed<Outcome>)>;

    TextOperation(Requester& requester, TypeCache& types, Done done, const ServiceOptions& options)
        : requester_{requester}, types_{types}, options_{options}, done_{std::move(done)}
    {
    }

    void cancel() override
    {
        done_ = nullptr;
        step_.cancel();
    }
    void no_memory() { fail_with(status::Bad_OutOfMemory, "no memory"); }

protected:
    void end(Accessed<Outcome> outcome)
    {
        if (const Done done = std::exchange(done_, nullptr)) {
            done(std::move(outcome));
        }
    }
    void fail_with(StatusCode status, std::string message)
    {
        end(Unexpected{AccessError{status, std::move(message)}});
    }

    Requester& requester_;
    TypeCache& types_;
    ServiceOptions options_;
    Operation step_;

private:
    Done done_;
};

} // namespace busbar::client::detail
