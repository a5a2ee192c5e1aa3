#pragma once

#include <cstddef>
#include <optional>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

#include "service.hpp"
#include "session.hpp"

namespace busbar::server::detail {

/// A service whose request is a list of things to do, with a result for each: as many are done at a
/// time as the connection's Turn allows. The response has `results` and `diagnostic_infos`.
template <typename Request, typename Response>
class SlicedOperation : public OperationOf<Request> {
public:
    void start(ServiceContext& context) final
    {
        StatusCode status = begin(context);
        // Before anything is done, as it cannot be taken back.
        if (!status.is_bad() && !this->charge(size() * sizeof(Result))) {
            status = status::Bad_TooManyOperations;
        }
        if (status.is_bad()) {
            return this->fault(status);
        }
        response_.results.reserve(size());
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

    /// How many things there are to do.
    [[nodiscard]] virtual std::size_t size() const = 0;
    /// Once: Good, or why nothing is done. There is one thing to do at least if it is good.
    [[nodiscard]] virtual StatusCode begin(ServiceContext& context) = 0;
    /// Before the first and after each pause, in which anything may have happened: Good, or why the
    /// rest is not done.
    [[nodiscard]] virtual StatusCode resume(ServiceContext& context) = 0;
    /// Does one thing, and spends what it takes. Nothing if the turn was over on the way: the next
    /// one goes on with the same.
    [[nodiscard]] virtual std::optional<Result> work(std::size_t index, Turn& turn) = 0;
    /// Takes back what was done, in this turn and before: the request ends in a fault.
    virtual void undo(const Response&) {}
    /// Behind the last of this turn.
    virtual void pause(ServiceContext&) {}

private:
    Response response_;
};

} // namespace busbar::server::detail
