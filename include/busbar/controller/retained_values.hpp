#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include <busbar/controller/program_image.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/core/storage.hpp>

namespace busbar::controller {

/// The file of RETAIN values, and how often they are looked at.
struct RetainedOptions {
    /// In an existing folder.
    std::string file{"retained"};
    /// The interval at which values are checked for changes.
    Duration interval{std::chrono::minutes{1}};
};

/// The result of restoring.
struct RetainedRestore {
    std::size_t restored{0};
    /// The reasons why others were not: the file cannot be read, or a variable's type has changed.
    std::vector<Problem> problems;
};

namespace detail {
class RetainedJournal;
struct JournalEntry;
} // namespace detail

/// Keeps the values of a program's RETAIN variables, if they are in its image, over restarts and
/// power failures. They are in one file, which is replaced as a whole: after a power failure it
/// contains what the last successful save() wrote, or what the interrupted one was to write.
///
/// Clients' writes are also written to a journal before they are acknowledged: keep(). From then on
/// they survive the end of the program, however it ends, and from the next sync() on a power
/// failure. restore() applies the journal to the file's values. Changes by the program itself are
/// in the file only, as of the last save().
///
/// In the file each value is stored with its variable's name and a fingerprint of its type, all of
/// it under a checksum. A variable whose type has changed starts as declared, the others get their
/// values. A file that cannot be used is renamed to `file` + ".kept" before another takes its
/// place.
///
/// Not for the task's thread, but for one thread at a time, since it waits for the medium; keep()
/// and add() are for the server's thread, and keep() does not wait for any of the others. Call
/// restore() before the task starts and before variables are added.
class BUSBAR_API RetainedValues {
public:
    /// `storage` must outlive it; `types` was used to create the image and is not needed
    /// afterwards.
    RetainedValues(Storage& storage, const ProgramTypes& types, const ProgramImage& image,
                   RetainedOptions options = {});
    RetainedValues(const RetainedValues&) = delete;
    RetainedValues& operator=(const RetainedValues&) = delete;
    ~RetainedValues();

    /// Also keeps the RETAIN variables that were added to the image while the task runs: `types` is
    /// the one that they were added from, and is not needed afterwards. They have their initial
    /// values; a restart restores them, if its program has them. A variable replaces one with the
    /// same name.
    void add(const ProgramTypes& types, const ProgramImageAddition& added);

    /// Stops keeping variables that are not RETAIN in the edited program: if one with such a name
    /// returns, it starts as declared. The file contains it until the next save().
    void drop_others(const Program& edited);

    /// Returns the number of variables that are kept.
    [[nodiscard]] std::size_t size() const { return variables_.size(); }
    /// Copies the values of the file and the journal to the image's memory. If there is a journal
    /// the file is then replaced. Without both nothing is restored, which is not a problem.
    [[nodiscard]] RetainedRestore restore();
    /// Writes the values of the latest scan, if they differ from the file; for a power failure, and
    /// before a stop. Without any scan it succeeds and leaves the file. If the image has no pin
    /// left, the result is Failed; try again.
    [[nodiscard]] Stored<void> save();

    /// True if the values are those of this image.
    [[nodiscard]] bool is_of(const server::ProcessImage& image) const { return &image == &*image_; }
    /// Returns whether a variable of the image is kept.
    [[nodiscard]] bool keeps(std::uint32_t handle) const
    {
        return handle < by_handle_.size() && by_handle_[handle] != 0;
    }
    /// Records what the task has applied and published of one Write call to such variables, all or
    /// nothing. After an error all are refused until a save() succeeds, which is due then.
    [[nodiscard]] Stored<void> keep(std::span<const server::ImageWrite> writes);
    /// Lets everything recorded survive a power failure.
    [[nodiscard]] Stored<void> sync();

    /// Returns when to call handle_deadline(); immediately until the first call, and if the journal
    /// has grown large or refuses Writes.
    [[nodiscard]] TimePoint next_deadline() const;
    /// Calls save(), and again an interval later.
    [[nodiscard]] Stored<void> handle_deadline(TimePoint now);

private:
    struct Variable {
        std::string name;
        std::uint32_t handle;
        std::uint64_t type_print;
    };

    void take_in(const ProgramTypes& types, std::span<const std::size_t> indices,
                 std::uint32_t first_handle);
    class Restoring;

    /// Null for a variable without a value.
    using BytesOf = FunctionRef<const std::byte*(std::uint32_t handle)>;
    [[nodiscard]] std::vector<std::byte> content(BytesOf bytes_of, std::uint64_t last_write) const;
    [[nodiscard]] Stored<void> save(std::vector<std::byte> now);
    [[nodiscard]] Stored<void> keep_old_file();

    Storage* storage_;
    RetainedOptions options_;
    std::shared_ptr<server::ProcessImage> image_;
    ElementaryTypes elementary_;
    std::vector<Variable> variables_;
    /// The index in variables_, keyed by the name in lower case.
    std::unordered_map<std::string, std::size_t> by_name_;
    /// Keyed by the handle: the index in variables_ plus 1, 0 for another variable.
    std::vector<std::size_t> by_handle_;
    std::unique_ptr<detail::RetainedJournal> journal_;
    /// The contents of the file, as far as known.
    std::vector<std::byte> saved_;
    bool has_unusable_file_{false};
    TimePoint deadline_{};
};

} // namespace busbar::controller
