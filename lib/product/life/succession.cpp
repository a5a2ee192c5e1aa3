#include <algorithm>
#include <exception>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <busbar/core/status_codes.hpp>

#include "product/configuration/toml_reader.hpp"
#include "running_controller.hpp"

namespace busbar::product {

// How another Generation takes the place of the one that serves, which goes on while it is made.

namespace {

/// Number of attempts to create a generation while its sources keep changing; the last is made
/// while no client is served.
constexpr int most_attempts = 3;

} // namespace

struct RunningController::Successor {
    Replacement wish;
    Standing standing;
    bool moves;
    /// Versions of the files it is made from.
    std::vector<std::optional<StorageEntry::Version>> kept;
    int renewals;
    /// The file of the project that is served now.
    std::string last_project;
    std::unique_ptr<Generation> generation;
    std::exception_ptr problem;
};

void RunningController::when_free(std::function<void()> act)
{
    loop_.post([this, act = std::move(act)] {
        if (next_ != nullptr || takes_labels_) {
            waiting_.push_back(act);
        } else {
            act();
        }
    });
}

void RunningController::replace_soon(std::function<void()> act)
{
    ++replacements_due_;
    when_free([this, act = std::move(act)] {
        --replacements_due_;
        act();
    });
}

Configured<void> RunningController::check_no_replacement(const char* what) const
{
    return next_ == nullptr && replacements_due_ == 0
               ? Configured<void>{}
               : misconfigured(what,
                               "the controller is taking over another configuration or program, or "
                               "is restarting: send it again afterwards",
                               status::Bad_InvalidState);
}

void RunningController::replace(Replacement wish, std::optional<Reading> reading)
{
    try_for(wish, [&] {
        Reading now = reading ? *std::move(reading) : wish.read();
        begin(wish, std::move(now));
    });
}

void RunningController::try_for(const Replacement& wish, FunctionRef<void()> act)
{
    try_to([&] {
        try {
            act();
        } catch (const ConfigError& error) {
            if (wish.refused) {
                wish.refused(error);
            }
            throw;
        }
    });
}

void RunningController::begin(Replacement wish, Reading reading)
{
    if (!wish.leaves_out) {
        check_left_out(reading.config);
    }
    const bool has_fitting_machine =
        machine_ ? machine_->fits(reading.config) : reading.config.machine.program == nullptr;
    Standing standing = standing_of(reading.config);
    auto listeners = listeners_of(reading.config);
    const bool moves = listeners != listening_.told();
    // A discovery server's registration has the old URL.
    const bool can_move = standing.is_used && standing.discovery.url.empty();
    if (!has_fitting_machine || !(standing == standing_) ||
        (moves && !(can_move && listening_.can_go_to(listeners)))) {
        expect(check_listeners(reading.config));
        start_again(wish.handover);
        return done(wish);
    }
    if (moves) {
        expect(listening_.go_to(std::move(listeners)));
    }
    try {
        listening_.set_in(reading.config);
        const auto next =
            std::make_shared<Successor>(Successor{.wish = std::move(wish),
                                                  .standing = std::move(standing),
                                                  .moves = moves,
                                                  .kept = current_->kept_versions(),
                                                  .renewals = renewals_,
                                                  .last_project = current_->project_document(),
                                                  .generation = nullptr,
                                                  .problem = nullptr});
        next->generation = std::make_unique<Generation>(configuration_, std::move(reading),
                                                        surroundings(), requests());
        // Do not compare listeners, which may change in the meantime.
        if (moves || next->wish.attempts >= most_attempts || !make(next)) {
            prepare(*next);
            succeed(*next);
        }
    } catch (const ConfigError&) {
        if (moves) {
            listening_.go_back();
        }
        throw;
    }
}

void RunningController::prepare(Successor& next) const
{
    Generation& generation = *next.generation;
    expect(labels_check(generation.project(), generation.config(), next.last_project)());
    generation.prepare();
}

bool RunningController::make(const std::shared_ptr<Successor>& next)
{
    const bool is_begun = maker_->run([this, next] {
        try {
            prepare(*next);
        } catch (...) {
            next->problem = std::current_exception();
        }
        // A posted function may outlive run(), and must not keep a generation alive then.
        loop_.post([this, made_one = std::weak_ptr<Successor>{next}] {
            if (const auto known = made_one.lock()) {
                made(known);
            }
        });
    });
    if (is_begun) {
        next_ = next;
    }
    return is_begun;
}

void RunningController::made(const std::shared_ptr<Successor>& next)
{
    next_.reset();
    resume();
    take(*next);
    if (next->generation != nullptr) {
        discard(std::move(next->generation));
    }
}

void RunningController::resume()
{
    for (auto& act : std::exchange(waiting_, {})) {
        when_free(std::move(act));
    }
}

void RunningController::take(Successor& next)
{
    Replacement& wish = next.wish;
    if (looks_until_restart_ > 0) {
        return; // the memory was replaced in the meantime
    }
    if (next.kept != current_->kept_versions() || next.renewals != renewals_) {
        ++wish.attempts;
        return replace(std::move(wish));
    }
    try_for(wish, [&] {
        if (next.problem) {
            std::rethrow_exception(next.problem);
        }
        succeed(next);
    });
}

void RunningController::drop_next()
{
    maker_.reset();
    next_.reset();
    waiting_.clear();
}

void RunningController::succeed(Successor& next)
{
    next.generation->finish();
    take_over(std::move(next.generation), std::move(next.wish.handover));
    is_shut_down_ = false;
    if (next.moves) {
        listening_.stay();
        pending_.done(PendingChanges::By::Listeners);
    }
    pending_.done(PendingChanges::By::Start);
    pending_.done(PendingChanges::By::Reload);
    if (!next.wish.is_of_last) { // else a refused program may still be on the medium
        pending_.done(PendingChanges::By::Download);
        refused_program_.reset();
    }
    standing_ = std::move(next.standing);
    if (labels_ && labels_->is_other(current_->config())) {
        download_labels(current_->config(), [this](const Problem* why_not) {
            if (why_not != nullptr) {
                log_.write(LogLevel::Error, "controller", text(*why_not));
            }
        });
    }
    if (machine_ && !listening_.is_halted()) {
        machine_->replace(next.wish.cause, *current_->plant().program(), current_->config(),
                          current_->plant().plc().instructions());
        stay_out();
    }
    if (!machine_ || machine_->why_out().empty()) {
        loop_.register_again();
    }
    clients_.use(current_->clients());
    renewed();
    keep_soon();
    if (greets_) {
        leaving_.back()->print_statistics();
        current_->print_welcome();
    }
    done(next.wish);
}

void RunningController::done(const Replacement& wish)
{
    if (wish.done) {
        wish.done();
    }
}

void RunningController::take_over(std::unique_ptr<Generation> next, net::Handover handover)
{
    Generation& before = *current_;
    before.halt();
    // The last scan has the values that the next program starts with.
    try {
        save_retained();
        handover.released = [this, &before] { release(before); };
        expect(loop_.hand_over(next->server(), std::move(handover)));
    } catch (const ConfigError&) {
        before.start();
        throw;
    }
    leaving_.push_back(std::exchange(current_, std::move(next)));
    start();
    look_soon();
}

/// Not yet where there are no connections, as this is called while it is being handed over then.
void RunningController::release(const Generation& gone)
{
    loop_.post([this, &gone] {
        const auto found =
            std::ranges::find(leaving_, &gone, [](const auto& one) { return one.get(); });
        if (found == leaving_.end()) {
            return;
        }
        std::unique_ptr<Generation> last = std::move(*found);
        leaving_.erase(found);
        discard(std::move(last));
    });
}

void RunningController::discard(std::unique_ptr<Generation> gone)
{
    gone->unload();
    std::shared_ptr<Generation> last{std::move(gone)};
    static_cast<void>(maker_->run([last = std::move(last)]() mutable { last.reset(); }));
}

} // namespace busbar::product
