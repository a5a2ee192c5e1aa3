#include "line_file.hpp"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

namespace busbar::controller::detail {

namespace {

constexpr std::size_t scan_size = 65'536;
/// Longer than any line of a log.
constexpr std::size_t max_line = 4'096;

std::string_view text_of(std::span<const std::byte> bytes)
{
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

} // namespace

void LineFile::forget()
{
    size_ = 0;
    lines_ = 0;
    last_line_.clear();
    unfinished_.clear();
    unfinished_size_ = 0;
}

Stored<void> LineFile::open()
{
    is_open_ = false;
    forget();
    const auto entry = storage_->entry(name_);
    if (!entry && entry.error() != StorageError::NotFound) {
        return not_stored(entry.error());
    }
    if (entry && entry->kind != StorageEntry::Kind::File) {
        return not_stored(StorageError::Failed);
    }
    if (entry && entry->size > max_size_) {
        return not_stored(StorageError::TooLarge);
    }
    if (auto scanned = scan(entry ? entry->size : 0); !scanned) {
        return scanned;
    }
    if (auto mended = mend(); !mended) {
        return mended;
    }
    failed_.clear();
    is_open_ = true;
    return {};
}

Stored<void> LineFile::refresh()
{
    if (!is_open_) {
        return open();
    }
    const auto entry = storage_->entry(name_);
    if (!entry && entry.error() != StorageError::NotFound) {
        is_open_ = false;
        return not_stored(entry.error());
    }
    return (entry ? entry->size : 0) == size_ ? Stored<void>{} : open();
}

Stored<void> LineFile::scan(std::uint64_t size)
{
    std::vector<std::byte> buffer(scan_size);
    std::string tail; // the bytes where the last append() failed
    while (size_ < size) {
        const auto count = storage_->read(name_, size_, buffer);
        if (!count) {
            return not_stored(count.error());
        }
        if (*count == 0 || *count > buffer.size()) {
            break;
        }
        const std::string_view bytes = text_of(std::span{buffer}.first(*count));
        if (!failed_.empty() && size_ + bytes.size() > failed_at_) {
            const std::uint64_t skipped = std::max(size_, failed_at_) - size_;
            tail += bytes.substr(static_cast<std::size_t>(skipped));
        }
        scan_bytes(bytes);
        size_ += bytes.size();
    }
    find_failed(tail);
    return {};
}

void LineFile::scan_bytes(std::string_view bytes)
{
    while (!bytes.empty()) {
        const std::size_t end = bytes.find('\n');
        const std::string_view part = bytes.substr(0, end);
        unfinished_ += part.substr(0, max_line - std::min(max_line, unfinished_.size()));
        unfinished_size_ += part.size();
        if (end == std::string_view::npos) {
            return;
        }
        ++lines_;
        last_line_ = unfinished_size_ <= max_line ? std::exchange(unfinished_, {}) : std::string{};
        if (!last_line_.empty() && last_line_.back() == '\r') {
            last_line_.pop_back();
        }
        unfinished_.clear();
        unfinished_size_ = 0;
        bytes.remove_prefix(end + 1);
    }
}

/// Counts the lines of the failed append() that the file contains after all; the bytes must match,
/// since another medium may be present. Counted lines are not looked for again, even if the file
/// cannot be repaired yet.
void LineFile::find_failed(std::string_view tail)
{
    if (failed_.empty() || size_ < failed_at_ ||
        std::string_view{failed_}.substr(0, tail.size()) != tail) {
        return;
    }
    const std::size_t whole = tail.rfind('\n') + 1; // npos + 1: no line
    found_ += static_cast<std::size_t>(
        std::count(failed_.begin(), failed_.begin() + static_cast<std::ptrdiff_t>(whole), '\n'));
    failed_.erase(0, whole);
    failed_at_ += whole;
}

Stored<void> LineFile::mend()
{
    if (unfinished_size_ == 0) {
        return {};
    }
    auto bytes = read_file(*storage_, name_, max_size_);
    if (!bytes) {
        return not_stored(bytes.error());
    }
    const auto whole = static_cast<std::size_t>(size_) - unfinished_size_;
    if (bytes->size() != size_) { // another program is writing to it
        return not_stored(StorageError::Failed);
    }
    bytes->resize(whole);
    auto cut = storage_->replace(name_, *bytes, FileAccess::Everyone);
    if (cut) {
        size_ = whole;
    } else if (cut.error() == StorageError::Full) {
        constexpr std::string_view end = "\r\n";
        cut = storage_->append(name_, std::as_bytes(std::span{end}), FileAccess::Everyone);
        size_ += end.size();
        ++lines_;
    }
    unfinished_.clear();
    unfinished_size_ = 0;
    return cut;
}

Stored<void> LineFile::create()
{
    return storage_->append(name_, {}, FileAccess::Everyone);
}

Stored<void> LineFile::append(std::string_view lines)
{
    if (!is_open_) {
        return not_stored(StorageError::Failed);
    }
    auto done = storage_->append(name_, std::as_bytes(std::span{lines}), FileAccess::Everyone);
    if (!done) {
        failed_ = lines;
        failed_at_ = size_;
        is_open_ = false;
        return done;
    }
    size_ += lines.size();
    lines_ += static_cast<std::size_t>(std::count(lines.begin(), lines.end(), '\n'));
    const std::string_view last =
        lines.substr(0, lines.size() - std::min<std::size_t>(2, lines.size()));
    last_line_ = last.substr(last.rfind('\n') + 1);
    return {};
}

std::size_t LineFile::take_found()
{
    return std::exchange(found_, 0);
}

Stored<void> LineFile::move_to(std::string_view name, WhenThere when_there)
{
    if (auto moved = storage_->move(name_, name, when_there); !moved) {
        return moved;
    }
    forget();
    return {};
}

Stored<void> LineFile::remove()
{
    const auto removed = storage_->remove(name_);
    if (!removed && removed.error() != StorageError::NotFound) {
        is_open_ = false;
        return removed;
    }
    forget();
    return {};
}

} // namespace busbar::controller::detail
