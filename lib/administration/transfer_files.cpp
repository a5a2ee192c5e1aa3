#include "transfer_files.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include <busbar/core/status_codes.hpp>

#include "giving_way.hpp"
#include "open_files.hpp"

namespace busbar::administration::detail {

std::size_t TransferFiles::held() const
{
    return std::accumulate(
        files_.begin(), files_.end(), std::size_t{0},
        [](std::size_t sum, const TransferFile& file) { return sum + file.bytes->size(); });
}

void TransferFiles::give_way(std::list<TransferFile>::iterator file)
{
    file->bytes = std::make_shared<std::vector<std::byte>>();
    gave_way_.splice(gave_way_.end(), files_, file);
}

bool TransferFiles::make_room(const Holder& holder)
{
    while (files_.size() >= limits_.max_open) {
        const auto loser = find_giving_way(
            files_, holder, [](const TransferFile& file) { return file.is_written; });
        if (loser == files_.end()) {
            return false;
        }
        give_way(loser);
    }
    return true;
}

bool TransferFiles::make_room(const Holder& holder, std::size_t bytes)
{
    while (held() + bytes > limits_.max_held) {
        const auto loser = find_giving_way(
            files_, holder, bytes, [](const TransferFile& file) { return file.bytes->size(); },
            [](const TransferFile& file) { return ~file.bytes->size(); });
        if (loser == files_.end()) {
            return false;
        }
        give_way(loser);
    }
    return true;
}

Result<std::size_t> TransferFiles::room(const Holder& holder)
{
    const auto of_session =
        std::count_if(files_.begin(), files_.end(), [&](const TransferFile& file) {
            return file.holder.session == holder.session;
        });
    if (static_cast<std::size_t>(of_session) >= limits_.max_open_of_session || !make_room(holder)) {
        return fail(status::Bad_TooManyOperations);
    }
    make_room(holder, limits_.max_file_size);
    const std::size_t all = held();
    if (all >= limits_.max_held) {
        return fail(status::Bad_OutOfMemory);
    }
    return std::min(limits_.max_file_size, limits_.max_held - all);
}

Result<std::size_t> TransferFiles::room_to_write(const Holder& holder)
{
    const auto written = std::count_if(files_.begin(), files_.end(),
                                       [](const TransferFile& file) { return file.is_written; });
    return static_cast<std::size_t>(written) < limits_.max_written
               ? room(holder)
               : Result<std::size_t>{fail(status::Bad_TooManyOperations)};
}

const TransferFile& TransferFiles::add(TransferFile file, TimePoint now)
{
    file.handle = ++last_handle_;
    file.deadline = now + timeout_;
    return files_.emplace_back(std::move(file));
}

TransferFile* TransferFiles::find(std::uint32_t handle, const Holder& holder, TimePoint now)
{
    const auto found = std::find_if(files_.begin(), files_.end(), [&](const TransferFile& file) {
        return file.handle == handle && file.holder == holder && now < file.deadline;
    });
    if (found == files_.end()) {
        return nullptr;
    }
    found->deadline = now + timeout_;
    return &*found;
}

TransferFile* TransferFiles::find(std::uint32_t handle, const Holder& holder, std::string_view name,
                                  TimePoint now)
{
    const TransferFile* const named = find(name, now);
    return named != nullptr && named->handle == handle ? find(handle, holder, now) : nullptr;
}

TransferFile* TransferFiles::find(std::uint32_t handle)
{
    const auto found = std::find_if(files_.begin(), files_.end(), [&](const TransferFile& file) {
        return file.handle == handle;
    });
    return found != files_.end() ? &*found : nullptr;
}

const TransferFile* TransferFiles::find(std::string_view name, TimePoint now) const
{
    const auto found = std::find_if(files_.begin(), files_.end(), [&](const TransferFile& file) {
        return file.name == name && now < file.deadline;
    });
    return found != files_.end() ? &*found : nullptr;
}

Result<std::vector<std::byte>> TransferFiles::read(TransferFile& file, std::int32_t length)
{
    if (length < 0) {
        return fail(status::Bad_InvalidArgument);
    }
    if (file.is_written) {
        return fail(status::Bad_InvalidState);
    }
    const std::size_t count = std::min(
        {file.bytes->size() - file.position, max_read_size, static_cast<std::size_t>(length)});
    const auto begin = file.bytes->begin() + static_cast<std::ptrdiff_t>(file.position);
    std::vector<std::byte> bytes(begin, begin + static_cast<std::ptrdiff_t>(count));
    file.position += count;
    return bytes;
}

StatusCode TransferFiles::write(TransferFile& file, std::span<const std::byte> bytes)
{
    if (!file.is_written || file.is_being_taken) {
        return status::Bad_InvalidState;
    }
    if (bytes.size() > limits_.max_file_size - file.position) {
        return status::Bad_EncodingLimitsExceeded;
    }
    const std::size_t end = std::max(file.bytes->size(), file.position + bytes.size());
    if (!make_room(file.holder, end - file.bytes->size())) {
        return status::Bad_OutOfMemory;
    }
    file.bytes->resize(end);
    std::copy(bytes.begin(), bytes.end(),
              file.bytes->begin() + static_cast<std::ptrdiff_t>(file.position));
    file.position += bytes.size();
    return status::Good;
}

void TransferFiles::set_position(TransferFile& file, std::uint64_t position)
{
    file.position = static_cast<std::size_t>(std::min<std::uint64_t>(position, file.bytes->size()));
}

void TransferFiles::remove(const TransferFile& file)
{
    const auto is_it = [&](const TransferFile& each) { return &each == &file; };
    std::erase_if(files_, is_it);
    std::erase_if(gave_way_, is_it);
}

const TransferFile* TransferFiles::find_gone(TimePoint now,
                                             FunctionRef<bool(const Holder&)> is_there) const
{
    if (!gave_way_.empty()) {
        return &gave_way_.front();
    }
    const auto found = std::find_if(files_.begin(), files_.end(), [&](const TransferFile& file) {
        return file.deadline <= now || !is_there(file.holder);
    });
    return found != files_.end() ? &*found : nullptr;
}

} // namespace busbar::administration::detail
