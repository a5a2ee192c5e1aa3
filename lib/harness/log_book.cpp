#include <busbar/harness/log_book.hpp>

#include <algorithm>

#include <busbar/harness/text.hpp>

namespace busbar::harness {

void LogBook::write_as(std::string_view speaker, LogLevel, std::string_view source,
                       std::string_view message)
{
    const std::string time = time_ != nullptr ? text_of(time_->now().time_since_epoch()) + " " : "";
    const std::lock_guard lock{mutex_};
    const bool has_speaker = !speaker.empty() && speaker != source;
    text_.append(time).append(has_speaker ? speaker : "").append(has_speaker ? ": " : "");
    text_.append(source).append(": ").append(message).append("\n");
    if (text_.size() > max_size) {
        const std::size_t end = text_.find('\n', text_.size() / 2) + 1;
        left_out_ += static_cast<std::size_t>(
            std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
        text_.erase(0, end);
    }
}

std::string LogBook::text() const
{
    const std::lock_guard lock{mutex_};
    return left_out_ == 0 ? text_ : std::to_string(left_out_) + " older lines\n" + text_;
}

std::string LogBook::last(std::size_t lines) const
{
    const std::lock_guard lock{mutex_};
    std::size_t begin = text_.size();
    while (lines > 0 && begin > 0) {
        const std::size_t end = begin < 2 ? std::string::npos : text_.rfind('\n', begin - 2);
        begin = end == std::string::npos ? 0 : end + 1;
        --lines;
    }
    return text_.substr(begin);
}

bool LogBook::contains(std::string_view text) const
{
    const std::lock_guard lock{mutex_};
    return text_.find(text) != std::string::npos;
}

void LogBook::clear()
{
    const std::lock_guard lock{mutex_};
    text_.clear();
    left_out_ = 0;
}

} // namespace busbar::harness
