#include "label_exchange.hpp"

#include <thread>
#include <utility>

namespace busbar::controller::detail {

void LabelListenerSlot::set(backend::LabelListener* listener)
{
    // No listener has the number while it changes: an answer that finds the new one has its number.
    listener_.set(nullptr, [] { std::this_thread::yield(); });
    ++number_;
    listener_.set(listener);
}

void LabelListenerSlot::done(std::unique_ptr<backend::LabelRequest>& request, std::uint64_t number)
{
    listener_.use([&](backend::LabelListener& listener) {
        if (is_current(number)) {
            listener.done(std::move(request));
        }
    });
}

void LabelListenerSlot::labels_changed()
{
    listener_.use([](backend::LabelListener& listener) { listener.labels_changed(); });
}

} // namespace busbar::controller::detail
