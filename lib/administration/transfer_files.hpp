#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/administration/file_transfer.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/result.hpp>

#include "permissions.hpp"

namespace busbar::administration::detail {

/// A temporary file. `position` is never beyond its end.
struct TransferFile {
    std::uint32_t handle{0};
    /// Name of its Object.
    std::string name{};
    Holder holder{};
    /// True if the client writes the file, false if it reads.
    bool is_written{false};
    Variant options{};
    /// Never null. Shared with the job that processes the file, and not changed while that runs.
    std::shared_ptr<std::vector<std::byte>> bytes{std::make_shared<std::vector<std::byte>>()};
    bool is_being_taken{false};
    std::size_t position{0};
    TimePoint deadline{};
    DateTime modified{};
};

/// The temporary files of one TemporaryFileTransfer, without nodes. Finding a file restarts its
/// timeout. When there are too many files or bytes, the user with the largest share gives way to
/// one with a smaller share.
class TransferFiles {
public:
    explicit TransferFiles(const TemporaryFileTransfer& transfer)
        : limits_{transfer.limits}, timeout_{transfer.client_processing_timeout}
    {
    }

    /// Maximum size of another file of the holder. Bad_TooManyOperations or Bad_OutOfMemory if
    /// there can be none.
    [[nodiscard]] Result<std::size_t> room(const Holder& holder);
    /// The same for a file that is written.
    [[nodiscard]] Result<std::size_t> room_to_write(const Holder& holder);
    /// Adds the file under a new handle. There must be room.
    const TransferFile& add(TransferFile file, TimePoint now);
    /// Finds the holder's file with this handle and, if given, this name; null if it has none.
    [[nodiscard]] TransferFile* find(std::uint32_t handle, const Holder& holder, TimePoint now);
    [[nodiscard]] TransferFile* find(std::uint32_t handle, const Holder& holder,
                                     std::string_view name, TimePoint now);
    /// Finds the file of any holder; null if it is gone.
    [[nodiscard]] TransferFile* find(std::uint32_t handle);
    /// Reads at most `length` bytes, none at the end (Part 20, 4.2.4). Bad_InvalidState for a file
    /// that is written, Bad_InvalidArgument for a negative length.
    [[nodiscard]] static Result<std::vector<std::byte>> read(TransferFile& file,
                                                             std::int32_t length);
    /// Appends bytes. Bad_InvalidState for a file that is read or being processed,
    /// Bad_EncodingLimitsExceeded and Bad_OutOfMemory if it would become too large.
    [[nodiscard]] StatusCode write(TransferFile& file, std::span<const std::byte> bytes);
    /// Moves to this position, or to the end of the file if that comes first (Part 20, 4.2.7).
    static void set_position(TransferFile& file, std::uint64_t position);
    void remove(const TransferFile& file);

    /// Finds a file by the name of its Object; null if it does not exist or has timed out.
    [[nodiscard]] const TransferFile* find(std::string_view name, TimePoint now) const;
    /// Finds a file that gave way, whose holder is gone, or that has timed out; null if there is
    /// none.
    [[nodiscard]] const TransferFile* find_gone(TimePoint now,
                                                FunctionRef<bool(const Holder&)> is_there) const;

private:
    [[nodiscard]] std::size_t held() const;
    /// Makes room for one file, for which another may give way.
    [[nodiscard]] bool make_room(const Holder& holder);
    /// Makes room for bytes; false if that was not possible.
    bool make_room(const Holder& holder, std::size_t bytes);
    void give_way(std::list<TransferFile>::iterator file);

    TransferLimits limits_;
    Duration timeout_;
    std::list<TransferFile> files_;    // oldest first
    std::list<TransferFile> gave_way_; // without bytes, until they are removed
    std::uint32_t last_handle_{0};
};

} // namespace busbar::administration::detail
