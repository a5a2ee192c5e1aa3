#include "transfer_files.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include <busbar/core/status_codes.hpp>

#include "open_files.hpp"

namespace busbar::administration::detail {

std::size_t TransferFiles::held() const
{
    return std::accumulate(
        files_.begin(), files_.end(), std::size_t{0},
        [](std::size_t sum, const TransferFile& file) { return sum + file.bytes.size(); });
}

Result<std::size_t> TransferFiles::room(const NodeId& session) const
{
    const auto of_session =
        std::count_if(files_.begin(), files_.end(),
                      [&](const TransferFile& file) { return file.holder.session == session; });
    if (files_.size() >= limits_.max_open ||
        static_cast<std::size_t>(of_session) >= limits_.max_open_of_session) {
        return fail(status::Bad_TooManyOperations);
    }
    const std::size_t all = held();
    if (all >= limits_.max_held) {
        return fail(status::Bad_OutOfMemory);
    }
    return std::min(limits_.max_file_size, limits_.max_held - all);
}

Result<std::size_t> TransferFiles::room_to_write(const NodeId& session) const
{
    const auto written = std::count_if(files_.begin(), files_.end(),
                                       [](const TransferFile& file) { return file.is_written; });
    return static_cast<std::size_t>(written) < limits_.max_written
               ? room(session)
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
        {file.bytes.size() - file.position, max_read_size, static_cast<std::size_t>(length)});
    const auto begin = file.bytes.begin() + static_cast<std::ptrdiff_t>(file.position);
    std::vector<std::byte> bytes(begin, begin + static_cast<std::ptrdiff_t>(count));
    file.position += count;
    return bytes;
}

StatusCode TransferFiles::write(TransferFile& file, std::span<const std::byte> bytes) const
{
    if (!file.is_written) {
        return status::Bad_InvalidState;
    }
    if (bytes.size() > limits_.max_file_size - file.position) {
        return status::Bad_EncodingLimitsExceeded;
    }
    const std::size_t end = std::max(file.bytes.size(), file.position + bytes.size());
    if (held() + (end - file.bytes.size()) > limits_.max_held) {
        return status::Bad_OutOfMemory;
    }
    file.bytes.resize(end);
    std::copy(bytes.begin(), bytes.end(),
              file.bytes.begin() + static_cast<std::ptrdiff_t>(file.position));
    file.position += bytes.size();
    return status::Good;
}

void TransferFiles::set_position(TransferFile& file, std::uint64_t position)
{
    file.position = static_cast<std::size_t>(std::min<std::uint64_t>(position, file.bytes.size()));
}

void TransferFiles::remove(const TransferFile& file)
{
    std::erase_if(files_, [&](const TransferFile& each) { return &each == &file; });
}

const TransferFile* TransferFiles::find_gone(TimePoint now,
                                             FunctionRef<bool(const Holder&)> is_there) const
{
    const auto found = std::find_if(files_.begin(), files_.end(), [&](const TransferFile& file) {
        return file.deadline <= now || !is_there(file.holder);
    });
    return found != files_.end() ? &*found : nullptr;
}

} // namespace busbar::administration::detail
