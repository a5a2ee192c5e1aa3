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

struct RetainedOptions {
    /// In a folder that is there.
    std::string file{"retained"};
    /// How often it is looked whether a value has changed.
    Duration interval{std::chrono::minutes{1}};
};

/// What came of restoring.
struct RetainedRestore {
    std::size_t restored{0};
    /// Why others were not: the file cannot be read, or a variable has another type than it had.
    std::vector<Problem> problems;
};

namespace detail {
class RetainedJournal;
struct JournalEntry;
} // namespace detail

/// Keeps the values of a program's RETAIN variables, as far as they are in its image, over restarts
/// and power cuts. They lie in one file, which is replaced as a whole: after a power cut it has
/// what the last save() that succeeded has written, or what the one that was cut was to write.
///
/// What clients write goes to a journal besides, before they are told that it was written: keep().
/// From then on it outlasts the end of the program, however that comes, and from the next sync() on
/// a power cut. restore() puts it over the file's values. What the program itself changes is in the
/// file alone, as the last save() had it.
///
/// In the file each value stands with its variable's name and a print of its type, all of it under
/// a checksum. A variable whose type has changed begins as declared, the others get their values. A
/// file that cannot be used is moved to `file` + ".kept" before another takes its place.
///
/// Not for the task's thread, but for one thread at a time, since it waits for the medium; keep()
/// and add() are the server's thread's, and keep() waits for none of the others. restore() before
/// the task starts and before variables are added.
class BUSBAR_API RetainedValues {
public:
    /// `storage` must outlive it; `types` has made the image and is not needed afterwards.
    RetainedValues(Storage& storage, const ProgramTypes& types, const ProgramImage& image,
                   RetainedOptions options = {});
    RetainedValues(const RetainedValues&) = delete;
    RetainedValues& operator=(const RetainedValues&) = delete;
    ~RetainedValues();

    /// Keeps also the RETAIN variables that were added to the image while the task runs: `types` is
    /// what they were added from, and not needed afterwards. They are as they begin; a restart
    /// restores them, if its program has them. One of a name that is kept takes its place.
    void add(const ProgramTypes& types, const ProgramImageAddition& added);

    /// Keeps no longer what is not RETAIN in the edited program: one of the name that comes back
    /// begins as declared. The file has it until the next save().
    void drop_others(const Program& edited);

    /// How many variables are kept.
    [[nodiscard]] std::size_t size() const { return variables_.size(); }
    /// Puts what the file and the journal have into the image's memory. If there is a journal the
    /// file is replaced then. Without both nothing is restored and all is well.
    [[nodiscard]] RetainedRestore restore();
    /// Writes the values of the latest scan, if they are not what the file has; for power that is
    /// going, and before a stop. Success without any scan, with the file as it is. If the image has
    /// no pin to give it is Failed, to be tried again.
    [[nodiscard]] Stored<void> save();

    [[nodiscard]] bool is_of(const server::ProcessImage& image) const { return &image == &*image_; }
    /// Whether a variable of the image is kept.
    [[nodiscard]] bool keeps(std::uint32_t handle) const
    {
        return handle < by_handle_.size() && by_handle_[handle] != 0;
    }
    /// Takes in what the task has applied and published of one Write call to such variables, all or
    /// nothing. After an error all are refused until a save() succeeds, which is due then.
    [[nodiscard]] Stored<void> keep(std::span<const server::ImageWrite> writes);
    /// What was taken in outlasts a power cut.
    [[nodiscard]] Stored<void> sync();

    /// When to call handle_deadline(); at once until the first call, and if the journal has grown
    /// large or refuses Writes.
    [[nodiscard]] TimePoint next_deadline() const;
    /// save(), and again an interval later.
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

    /// Null for a variable that has no value.
    using BytesOf = FunctionRef<const std::byte*(std::uint32_t handle)>;
    [[nodiscard]] std::vector<std::byte> content(BytesOf bytes_of, std::uint64_t last_write) const;
    [[nodiscard]] Stored<void> save(std::vector<std::byte> now);
    [[nodiscard]] Stored<void> keep_old_file();

    Storage* storage_;
    RetainedOptions options_;
    std::shared_ptr<server::ProcessImage> image_;
    ElementaryTypes elementary_;
    std::vector<Variable> variables_;
    /// By the name in lower case: the index in variables_.
    std::unordered_map<std::string, std::size_t> by_name_;
    /// By the handle: the index in variables_ plus 1, 0 for another variable.
    std::vector<std::size_t> by_handle_;
    std::unique_ptr<detail::RetainedJournal> journal_;
    /// What the file has, as far as is known.
    std::vector<std::byte> saved_;
    bool has_unusable_file_{false};
    TimePoint deadline_{};
};

} // namespace busbar::controller
