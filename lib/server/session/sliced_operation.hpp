#pragma once

#include <cstddef>
#include <optional>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

#include "service.hpp"
#include "session.hpp"

namespace busbar::server::detail {

/// A service whose request is a list of operations with a result for each, as many of which are
/// done at a time as the connection's Turn allows. The response has `results` and
/// `diagnostic_infos`.
template <typename Request, typename Response>
class SlicedOperation : public OperationOf<Request> {
public:
    void start(ServiceContext& context) final
    {
        StatusCode status = begin(context);
        // Before anything is done, as it cannot be undone.
        if (!status.is_bad() && !this->charge(size() * sizeof(Result))) {
            status = status::Bad_TooManyOperations;
        }
        if (status.is_bad()) {
            return this->fault(status);
        }
        response_.results.reserve(size(), this->kept_memory());
        take_turn(context);
    }
    [[nodiscard]] bool wants_turn() const final { return !this->is_finished(); }
    void take_turn(ServiceContext& context) final
    {
        if (const StatusCode status = resume(context); status.is_bad()) {
            return this->fault(status);
        }
        busbar::detail::Undo taken_back{[&] { undo(response_); }};
        Turn& turn = context.peer.turn();
        do {
            if (auto result = work(response_.results.size(), turn)) {
                response_.results.push_back(*std::move(result));
            }
        } while (response_.results.size() < size() && !turn.is_over() &&
                 !context.peer.has_thrown());
        const bool has_thrown = context.peer.has_thrown();
        if (has_thrown) {
            undo(response_);
        }
        taken_back.keep();
        pause(context);
        if (has_thrown) {
            return this->fault(status::Bad_InternalError);
        }
        if (response_.results.size() == size()) {
            this->respond_results(response_);
        }
    }

protected:
    using Result = typename decltype(Response::results)::value_type;

    /// The number of operations.
    [[nodiscard]] virtual std::size_t size() const = 0;
    /// Called once: Good, or the reason why nothing is done. If it is good there is at least one
    /// operation.
    [[nodiscard]] virtual StatusCode begin(ServiceContext& context) = 0;
    /// Called before the first operation and after each pause, in which anything may have happened:
    /// Good, or the reason why the rest is not done.
    [[nodiscard]] virtual StatusCode resume(ServiceContext& context) = 0;
    /// Does one operation, and spends its cost. Returns nothing if the turn ended meanwhile: the
    /// next one continues with the same operation.
    [[nodiscard]] virtual std::optional<Result> work(std::size_t index, Turn& turn) = 0;
    /// Undoes the operations of this and earlier turns: the request ends in a fault.
    virtual void undo(const Response&) {}
    /// Called after the last operation of a turn.
    virtual void pause(ServiceContext&) {}

private:
    Response response_;
};

} // namespace busbar::server::detail
