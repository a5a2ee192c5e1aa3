#include "label_exchange.hpp"

#include <thread>

namespace busbar::controller::detail {

namespace {

/// Counts callers: set() returns only after all callers of the old listener are gone. Sequentially
/// consistent here and in set(): either the caller finds the listener gone, or set() finds the
/// caller.
class Caller {
public:
    explicit Caller(std::atomic<std::uint32_t>& callers) : callers_{&callers}
    {
        callers_->fetch_add(1, std::memory_order_seq_cst);
    }
    Caller(const Caller&) = delete;
    Caller& operator=(const Caller&) = delete;
    ~Caller() { callers_->fetch_sub(1, std::memory_order_release); }

private:
    std::atomic<std::uint32_t>* callers_;
};

} // namespace

void LabelListenerSlot::set(backend::LabelListener* listener)
{
    listener_.store(nullptr, std::memory_order_seq_cst);
    number_.fetch_add(1, std::memory_order_seq_cst);
    while (callers_.load(std::memory_order_seq_cst) != 0) {
        std::this_thread::yield();
    }
    listener_.store(listener, std::memory_order_seq_cst);
}

void LabelListenerSlot::done(std::unique_ptr<backend::LabelRequest>& request, std::uint64_t number)
{
    const Caller caller{callers_};
    backend::LabelListener* const listener = listener_.load(std::memory_order_seq_cst);
    if (listener != nullptr && number_.load(std::memory_order_seq_cst) == number) {
        listener->done(std::move(request));
    }
}

void LabelListenerSlot::labels_changed()
{
    const Caller caller{callers_};
    if (auto* const listener = listener_.load(std::memory_order_seq_cst); listener != nullptr) {
        listener->labels_changed();
    }
}

} // namespace busbar::controller::detail
