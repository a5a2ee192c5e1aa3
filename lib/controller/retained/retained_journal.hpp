#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/function_ref.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/storage.hpp>

namespace busbar::controller::detail {

/// Bytes that a client wrote into a variable.
struct JournalEntry {
    std::string_view name;
    std::uint64_t type_print;
    /// Offset from the variable's first byte.
    std::uint32_t offset;
    std::span<const std::byte> bytes;
};

/// Keeps the values that clients wrote since the file of retained values was saved last. A Write
/// that is appended survives the end of the program at once, and a power cut after the next sync().
///
/// Writes are numbered from 1. The file of retained values contains the number of the last write
/// that it includes, and recover() skips the writes up to that. There are two files,
/// "FILE.journal-1" and "-2", so that one takes Writes while the values in the other are saved:
///
///     const auto last = journal.begin_save();   // from here on Writes go to the other file
///     ... values that were read after it, and `last`, are on the medium ...
///     journal.saved();
///
/// One thread calls append(), which never waits for the other functions; these must be called by
/// one thread at a time.
///
/// FORMAT.md describes the files.
class RetainedJournal {
public:
    /// A file of usual_size is worth saving; max_size is the limit of a file.
    static constexpr std::size_t usual_size = 4U << 20U;
    static constexpr std::size_t max_size = 32U << 20U;

    /// `storage` must outlive this object.
    RetainedJournal(Storage& storage, const std::string& file);

    using Apply = FunctionRef<void(const JournalEntry&)>;
    /// Applies the writes after number `last_saved` in their order; must be called once, before all
    /// other functions. Returns what could not be applied: an incomplete record at the end, which
    /// no client was told of, and damaged records. If there is a file, Writes are refused until the
    /// next saved(), which keeps a damaged one as FILE + ".kept".
    [[nodiscard]] std::vector<Problem> recover(std::uint64_t last_saved, Apply apply);

    /// Appends the values of one Write, all or none. After an error all Writes are refused until
    /// the next saved().
    [[nodiscard]] Stored<void> append(std::span<const JournalEntry> entries);

    /// True if all writes are in the file of retained values.
    [[nodiscard]] bool is_empty() const;
    /// True if the journal is larger than usual or refuses Writes.
    [[nodiscard]] bool needs_save() const;
    /// Starts a save; returns the number of the last write so far.
    [[nodiscard]] std::uint64_t begin_save();
    /// Removes the writes that begin_save() has covered.
    [[nodiscard]] Stored<void> saved();
    /// Makes all appended writes survive a power cut.
    [[nodiscard]] Stored<void> sync();

private:
    struct File {
        std::string name;
        std::size_t size{0}; // 0 if the file does not exist
        bool is_unsynced{false};
        bool is_damaged{false};
    };
    struct Found;

    void read(File& file, Found& found) const;
    [[nodiscard]] Stored<void> remove(File& file);

    Storage* storage_;
    mutable std::mutex mutex_; // guards all members below
    std::array<File, 2> files_;
    std::size_t active_{0};
    std::uint64_t last_{0};
    /// The reason for refusing Writes.
    std::optional<StorageError> error_;
    /// Writes were refused at begin_save(), so that it covered both files.
    bool covers_both_{false};
};

} // namespace busbar::controller::detail
