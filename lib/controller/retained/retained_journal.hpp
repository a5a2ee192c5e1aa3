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
    /// From the variable's first byte on.
    std::uint32_t offset;
    std::span<const std::byte> bytes;
};

/// What clients wrote since the file of retained values was saved last: each Write that it takes in
/// outlasts the end of the program at once, and a power cut from the next sync() on.
///
/// Writes are numbered from 1. The file of retained values says up to which number it has them, and
/// what was taken in before is passed over. There are two files, "FILE.journal-1" and "-2", so that
/// one takes Writes while the values with those of the other are saved:
///
///     const auto last = journal.begin_save();   // from here on Writes go to the other file
///     ... values that were read after it, and `last`, are on the medium ...
///     journal.saved();
///
/// append() is one thread's, and waits for none of the others; these are one thread's at a time.
///
/// FORMAT.md describes the files.
class RetainedJournal {
public:
    /// It is time to save from here on, and no file has more than the second one.
    static constexpr std::size_t usual_size = 4U << 20U;
    static constexpr std::size_t max_size = 32U << 20U;

    /// `storage` must outlive it.
    RetainedJournal(Storage& storage, const std::string& file);

    using Apply = FunctionRef<void(const JournalEntry&)>;
    /// Once and first: applies the writes after number `last_saved`, in their order. Gives what
    /// cannot be applied: a record at the end that was cut off, which no client was told of, and
    /// records that are damaged. If there is a file, Writes are refused until the next saved(),
    /// which keeps a damaged one as FILE + ".kept".
    [[nodiscard]] std::vector<Problem> recover(std::uint64_t last_saved, Apply apply);

    /// Takes in what one Write has written, all of it or nothing. After an error all are refused
    /// until the next saved().
    [[nodiscard]] Stored<void> append(std::span<const JournalEntry> entries);

    /// Whether there is something that only the journal has.
    [[nodiscard]] bool is_empty() const;
    /// It is larger than usual, or refuses Writes.
    [[nodiscard]] bool needs_save() const;
    /// The number of the last write that was taken in.
    [[nodiscard]] std::uint64_t begin_save();
    /// Removes what begin_save() has covered.
    [[nodiscard]] Stored<void> saved();
    /// What was taken in outlasts a power cut.
    [[nodiscard]] Stored<void> sync();

private:
    struct File {
        std::string name;
        std::size_t size{0}; // 0: it is not there
        bool is_unsynced{false};
        bool is_damaged{false};
    };
    struct Found;

    void read(File& file, Found& found) const;
    [[nodiscard]] Stored<void> remove(File& file);

    Storage* storage_;
    mutable std::mutex mutex_; // of all below
    std::array<File, 2> files_;
    std::size_t active_{0};
    std::uint64_t last_{0};
    /// Why Writes are refused.
    std::optional<StorageError> error_;
    /// They were at begin_save(), so that it has covered both files.
    bool covers_both_{false};
};

} // namespace busbar::controller::detail
