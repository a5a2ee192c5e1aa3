#include "open_files.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include <busbar/core/status_codes.hpp>

#include "giving_way.hpp"

namespace busbar::administration::detail {

namespace {

bool is_mode(std::uint8_t mode)
{
    constexpr std::uint8_t known = open_read | open_write | open_erase | open_append;
    const bool writes = (mode & open_write) != 0;
    return (mode & ~known) == 0 && (writes || (mode & open_read) != 0) &&
           (writes || (mode & open_erase) == 0);
}

} // namespace

OpenFiles::Open* OpenFiles::find(const Key& key)
{
    const auto found = std::find_if(open_.begin(), open_.end(), [&](const Open& open) {
        return open.handle == key.handle && open.path == key.path && open.holder == key.holder;
    });
    return found == open_.end() ? nullptr : &*found;
}

std::uint64_t OpenFiles::held() const
{
    const auto add = [](std::uint64_t sum, const auto& each) { return sum + each.bytes.size(); };
    return std::accumulate(open_.begin(), open_.end(),
                           std::accumulate(former_.begin(), former_.end(), std::uint64_t{0}, add),
                           add);
}

void OpenFiles::forget(FunctionRef<bool(const Open&)> which)
{
    std::erase_if(open_, [&](const Open& open) { return which(open); });
    std::erase_if(former_, [&](const Former& former) {
        return std::none_of(open_.begin(), open_.end(),
                            [&](const Open& open) { return former.is_of(open); });
    });
}

StatusCode OpenFiles::check_mode(std::string_view path, std::uint8_t mode,
                                 const Holder& holder) const
{
    if (!is_mode(mode)) {
        return status::Bad_InvalidArgument;
    }
    for (const Open& open : open_) {
        if (open.path != path) {
            continue;
        }
        if ((mode & open_write) != 0 &&
            (open.is_written || open.holder.session == holder.session)) {
            return status::Bad_NotWritable;
        }
        if (open.is_written) {
            return status::Bad_NotReadable;
        }
    }
    return status::Good;
}

bool OpenFiles::make_room(const Holder& holder)
{
    const auto of_session = std::count_if(open_.begin(), open_.end(), [&](const Open& open) {
        return open.holder.session == holder.session;
    });
    if (static_cast<std::size_t>(of_session) >= limits_.max_open_of_session) {
        return false;
    }
    while (open_.size() >= limits_.max_open) {
        const auto loser =
            find_giving_way(open_, holder, [](const Open& open) { return open.is_changed; });
        if (loser == open_.end()) {
            return false;
        }
        forget([&](const Open& open) { return &open == &*loser; });
    }
    return true;
}

bool OpenFiles::make_room(const Holder& holder, std::uint64_t bytes)
{
    while (held() + bytes > limits_.max_written) {
        if (!former_.empty()) {
            former_.erase(former_.begin());
            continue;
        }
        const auto loser = find_giving_way(
            open_, holder, bytes, [](const Open& open) { return open.bytes.size(); },
            [](const Open& open) { return ~open.bytes.size(); });
        if (loser == open_.end()) {
            return false;
        }
        forget([&](const Open& open) { return &open == &*loser; });
    }
    return true;
}

/// Loads the content of a file that is opened to be changed.
StatusCode OpenFiles::load(Open& open)
{
    if (open.size > limits_.max_file_size) {
        return status::Bad_EncodingLimitsExceeded;
    }
    if (!make_room(open.holder, open.size)) {
        return status::Bad_OutOfMemory;
    }
    open.bytes.resize(static_cast<std::size_t>(open.size));
    const auto count = storage_.read(open.path, 0, open.bytes);
    if (!count) {
        return status_of(count.error());
    }
    return *count == open.bytes.size() && is_same(open) ? StatusCode{status::Good}
                                                        : StatusCode{status::Bad_InvalidState};
}

bool OpenFiles::is_same(const Open& open) const
{
    const auto entry = storage_.entry(open.path);
    return entry && entry->kind == StorageEntry::Kind::File && entry->version == open.version;
}

Result<std::uint32_t> OpenFiles::open(std::string_view path, std::uint8_t mode,
                                      const Holder& holder)
{
    if (const StatusCode may = check_mode(path, mode, holder); may.is_bad()) {
        return fail(may);
    }
    const auto entry = storage_.entry(path);
    if (!entry || entry->kind != StorageEntry::Kind::File) {
        return fail(entry ? StatusCode{status::Bad_NotFound} : status_of(entry.error()));
    }
    if (!make_room(holder)) {
        return fail(status::Bad_TooManyOperations);
    }
    Open open{last_handle_ + 1,
              std::string{path},
              holder,
              (mode & open_read) != 0,
              (mode & open_write) != 0,
              (mode & open_erase) != 0,
              entry->version,
              entry->size,
              0,
              {}};
    if (open.is_changed) {
        open.size = 0;
    } else if (open.is_written) {
        if (const StatusCode loaded = load(open); loaded.is_bad()) {
            return fail(loaded);
        }
    }
    open.position = (mode & open_append) != 0 ? open.size : 0;
    open_.push_back(std::move(open));
    return ++last_handle_;
}

std::optional<OpenFiles::Former> OpenFiles::former_of(const Open& writer) const
{
    const auto entry = storage_.entry(writer.path);
    if (!entry || held() + entry->size > limits_.max_written) {
        return std::nullopt;
    }
    Former former{writer.path, entry->version, {}};
    const auto is_of_it = [&](const Open& open) { return former.is_of(open); };
    if (std::none_of(open_.begin(), open_.end(), is_of_it)) {
        return std::nullopt;
    }
    former.bytes.resize(static_cast<std::size_t>(entry->size));
    const auto count = storage_.read(writer.path, 0, former.bytes);
    return count && *count == former.bytes.size() ? std::optional{std::move(former)} : std::nullopt;
}

StatusCode OpenFiles::close(const Key& key)
{
    Open* const open = find(key);
    if (open == nullptr) {
        return status::Bad_InvalidArgument;
    }
    StatusCode result{status::Good};
    if (open->is_changed) {
        if (is_same(*open)) {
            auto former = former_of(*open);
            const auto kept = storage_.replace(open->path, open->bytes, FileAccess::Owner);
            if (!kept) {
                return status_of(kept.error());
            }
            if (former) {
                former_.push_back(*std::move(former));
            }
        } else {
            result = status::Bad_InvalidState;
        }
    }
    forget([&](const Open& each) { return &each == open; });
    return result;
}

void OpenFiles::discard(const Key& key)
{
    const Open* const open = find(key);
    forget([&](const Open& each) { return &each == open; });
}

bool OpenFiles::is_changed(const Key& key)
{
    const Open* const open = find(key);
    return open != nullptr && open->is_changed;
}

StatusCode OpenFiles::read_stored(const Open& open, std::span<std::byte> bytes) const
{
    const auto former = std::find_if(former_.begin(), former_.end(),
                                     [&](const Former& each) { return each.is_of(open); });
    if (former != former_.end()) {
        std::copy_n(former->bytes.begin() + static_cast<std::ptrdiff_t>(open.position),
                    bytes.size(), bytes.begin());
        return status::Good;
    }
    const auto count = storage_.read(open.path, open.position, bytes);
    if (!count) {
        return status_of(count.error());
    }
    return *count == bytes.size() && is_same(open) ? StatusCode{status::Good}
                                                   : StatusCode{status::Bad_InvalidState};
}

Result<std::vector<std::byte>> OpenFiles::read(const Key& key, std::int32_t length)
{
    Open* const open = find(key);
    if (open == nullptr || length < 0) {
        return fail(status::Bad_InvalidArgument);
    }
    if (!open->is_read) {
        return fail(status::Bad_InvalidState);
    }
    std::vector<std::byte> bytes(static_cast<std::size_t>(
        std::min({open->size - open->position, std::uint64_t{max_read_size},
                  static_cast<std::uint64_t>(length)})));
    if (open->is_written) {
        std::copy_n(open->bytes.begin() + static_cast<std::ptrdiff_t>(open->position), bytes.size(),
                    bytes.begin());
    } else if (!bytes.empty()) {
        if (const StatusCode done = read_stored(*open, bytes); done.is_bad()) {
            return fail(done);
        }
    }
    open->position += bytes.size();
    return bytes;
}

StatusCode OpenFiles::write(const Key& key, std::span<const std::byte> bytes)
{
    Open* const open = find(key);
    if (open == nullptr) {
        return status::Bad_InvalidArgument;
    }
    if (!open->is_written) {
        return status::Bad_InvalidState;
    }
    const std::uint64_t end = std::max(open->size, open->position + bytes.size());
    if (end > limits_.max_file_size) {
        return status::Bad_EncodingLimitsExceeded;
    }
    if (!make_room(open->holder, end - open->size)) {
        return status::Bad_OutOfMemory;
    }
    open->bytes.resize(static_cast<std::size_t>(end));
    std::copy(bytes.begin(), bytes.end(),
              open->bytes.begin() + static_cast<std::ptrdiff_t>(open->position));
    open->size = end;
    open->position += bytes.size();
    open->is_changed = open->is_changed || !bytes.empty();
    return status::Good;
}

Result<std::uint64_t> OpenFiles::position(const Key& key)
{
    const Open* const open = find(key);
    return open != nullptr ? Result<std::uint64_t>{open->position}
                           : fail(status::Bad_InvalidArgument);
}

StatusCode OpenFiles::set_position(const Key& key, std::uint64_t position)
{
    Open* const open = find(key);
    if (open == nullptr) {
        return status::Bad_InvalidArgument;
    }
    open->position = std::min(position, open->size);
    return status::Good;
}

std::size_t OpenFiles::count(std::string_view path) const
{
    return static_cast<std::size_t>(std::count_if(
        open_.begin(), open_.end(), [&](const Open& open) { return open.path == path; }));
}

bool OpenFiles::is_in_use(std::string_view path, const Holder& holder) const
{
    return std::any_of(open_.begin(), open_.end(), [&](const Open& open) {
        const bool is_below = open.path.size() > path.size() && open.path.starts_with(path) &&
                              open.path[path.size()] == '/';
        return (open.path == path || is_below) &&
               (open.is_written || open.holder.session == holder.session);
    });
}

void OpenFiles::drop(std::string_view path)
{
    forget([&](const Open& open) { return open.path == path; });
}

void OpenFiles::expire(FunctionRef<bool(const Holder&)> is_there)
{
    forget([&](const Open& open) { return !is_there(open.holder); });
}

} // namespace busbar::administration::detail
