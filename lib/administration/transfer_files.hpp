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

/// One temporary file. `position` is never behind its end.
struct TransferFile {
    std::uint32_t handle{0};
    /// What its Object is called.
    std::string name{};
    Holder holder{};
    /// Written by the client; else read.
    bool is_written{false};
    Variant options{};
    /// Never null. Whoever takes the file has it, too, and nobody changes it then.
    std::shared_ptr<std::vector<std::byte>> bytes{std::make_shared<std::vector<std::byte>>()};
    bool is_being_taken{false};
    std::size_t position{0};
    TimePoint deadline{};
    DateTime modified{};
};

/// The temporary files of one TemporaryFileTransfer, without nodes. A file that is found has its
/// time begin anew. When there are too many, or too large ones, the user who has most gives way to
/// one who has less.
class TransferFiles {
public:
    explicit TransferFiles(const TemporaryFileTransfer& transfer)
        : limits_{transfer.limits}, timeout_{transfer.client_processing_timeout}
    {
    }

    /// Bytes that one more file of the holder may have. Bad_TooManyOperations or Bad_OutOfMemory
    /// where there can be none.
    [[nodiscard]] Result<std::size_t> room(const Holder& holder);
    /// The same for one that is written.
    [[nodiscard]] Result<std::size_t> room_to_write(const Holder& holder);
    /// Keeps it under a handle of its own. There must be room.
    const TransferFile& add(TransferFile file, TimePoint now);
    /// The holder's file with this handle; null if it has none. Also with this name, where one is
    /// given.
    [[nodiscard]] TransferFile* find(std::uint32_t handle, const Holder& holder, TimePoint now);
    [[nodiscard]] TransferFile* find(std::uint32_t handle, const Holder& holder,
                                     std::string_view name, TimePoint now);
    /// Whoever has it; null if it is gone.
    [[nodiscard]] TransferFile* find(std::uint32_t handle);
    /// At most `length` bytes, none at the end (Part 20, 4.2.4). Bad_InvalidState for a file that
    /// is written, Bad_InvalidArgument for a negative length.
    [[nodiscard]] static Result<std::vector<std::byte>> read(TransferFile& file,
                                                             std::int32_t length);
    /// Bad_InvalidState for a file that is read or being taken, Bad_EncodingLimitsExceeded and
    /// Bad_OutOfMemory where it would grow too large.
    [[nodiscard]] StatusCode write(TransferFile& file, std::span<const std::byte> bytes);
    /// At most the end of the file (Part 20, 4.2.7).
    static void set_position(TransferFile& file, std::uint64_t position);
    void remove(const TransferFile& file);

    /// By the name of its Object; null for none, or one whose time is over.
    [[nodiscard]] const TransferFile* find(std::string_view name, TimePoint now) const;
    /// One that gave way, of a holder that is gone, or whose time is over; null if there is none.
    [[nodiscard]] const TransferFile* find_gone(TimePoint now,
                                                FunctionRef<bool(const Holder&)> is_there) const;

private:
    [[nodiscard]] std::size_t held() const;
    /// One file more; another one may give way.
    [[nodiscard]] bool make_room(const Holder& holder);
    /// The same for bytes. False if there is less room then.
    bool make_room(const Holder& holder, std::size_t bytes);
    void give_way(std::list<TransferFile>::iterator file);

    TransferLimits limits_;
    Duration timeout_;
    std::list<TransferFile> files_;    // the oldest in front
    std::list<TransferFile> gave_way_; // without bytes, until they are removed
    std::uint32_t last_handle_{0};
};

} // namespace busbar::administration::detail
