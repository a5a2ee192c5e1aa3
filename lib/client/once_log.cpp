#include <busbar/client/once_log.hpp>

#include <algorithm>
#include <functional>

namespace busbar::client {

void OnceLog::write(LogLevel level, std::string_view source, std::string_view text)
{
    {
        const std::lock_guard lock{mutex_};
        const std::size_t hash = std::hash<std::string_view>{}(text);
        if (told_.size() == max_texts || std::ranges::find(told_, hash) != told_.end()) {
            return;
        }
        told_.push_back(hash);
    }
    log_->write(level, source, text);
}

void OnceLog::forget()
{
    const std::lock_guard lock{mutex_};
    told_.clear();
}

} // namespace busbar::client
