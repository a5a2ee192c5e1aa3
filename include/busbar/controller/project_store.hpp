#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <busbar/controller/project.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/storage.hpp>

namespace busbar::controller {

/// The project stored by a server module (SH-082679, 9.13), and one that a tool
/// transfers: staged in the Storage, checked as a whole, and then put in place of the other one in
/// one step. A transfer that is interrupted, refused or cut off by a power failure leaves the old
/// one.
///
///     const auto transfer = store.begin();   // no other transfer is running
///     store.write(*transfer, bytes);         // any number of times
///     store.commit(*transfer);
///
/// Not thread-safe; no other code changes the folder.
class BUSBAR_API ProjectStore {
public:
    /// Decides whether a server could run the project: load_models, and further checks. check() is
    /// called before it.
    using Check = std::function<Configured<void>(const Project&)>;

    /// `storage` must outlive this object; `folder` belongs to this object and is created when
    /// needed.
    ProjectStore(Storage& storage, std::string folder, Check check,
                 const ProjectLimits& limits = {});

    /// Sets the check for new projects: a project that was stored before and is served is kept,
    /// even if it would fail the new check.
    void check_new_with(Check check) { check_new_ = std::move(check); }

    /// Discards a transfer that was interrupted by a power failure and reads the project; there may
    /// be none. Call it once, before all other functions. A problem with the file or the medium
    /// means that there is no project: another one can be transferred. `running` is another store
    /// of the same folder that is in use, or null: a file that is as that store has it is not read
    /// again, and transfers to that store are not discarded: both may stage projects.
    [[nodiscard]] Configured<void> recover(const ProjectStore* running = nullptr);

    /// Null if there is none. Valid until the next commit().
    [[nodiscard]] const Project* current() const { return current_.get(); }
    [[nodiscard]] const std::shared_ptr<const Project>& current_shared() const { return current_; }
    /// Returns the bytes of its file. Bad_NotFound if there is none.
    [[nodiscard]] Configured<std::string> document() const;

    /// Begins a transfer and returns its number. Bad_InvalidState while another one is running.
    [[nodiscard]] Configured<std::uint32_t> begin();
    /// Appends to its file. After a problem the transfer is over; Bad_InvalidState if it was over
    /// before.
    [[nodiscard]] Configured<void> write(std::uint32_t transfer, std::span<const std::byte> bytes);
    /// Checks the file and makes it the current project. The transfer is over in any case, and
    /// after a problem everything is as before it.
    [[nodiscard]] Configured<void> commit(std::uint32_t transfer);
    /// Ends it, if it is not over.
    void cancel(std::uint32_t transfer);
    [[nodiscard]] bool is_busy() const { return transfer_.has_value(); }

    /// A file that stage() has checked; it is removed if it is not taken up, for which the Storage
    /// must outlive this object.
    class Staged {
        friend class ProjectStore;
        struct File;
        explicit Staged(Project project, std::shared_ptr<File> file = {})
            : project_{std::move(project)}, file_{std::move(file)}
        {
        }
        Project project_;
        std::shared_ptr<File> file_;
    };
    /// A complete transfer, in two steps. The first one stages and checks the file, which takes
    /// long: it may run on another thread than the rest, one at a time, while no transfer is
    /// running. The second one makes it the current project.
    [[nodiscard]] Configured<Staged> stage(std::span<const std::byte> document) const;
    [[nodiscard]] Configured<void> take_up(Staged staged);
    /// Both steps together.
    [[nodiscard]] Configured<void> replace(std::span<const std::byte> document);

private:
    struct Transfer {
        std::uint32_t number;
        std::size_t size;
    };

    [[nodiscard]] std::string file() const { return storage_path(folder_, "project.busbar"); }
    [[nodiscard]] std::string staged() const;
    [[nodiscard]] bool is_of(std::uint32_t transfer) const
    {
        return transfer_ && transfer_->number == transfer;
    }
    [[nodiscard]] Configured<std::string> read(const std::string& name) const;
    [[nodiscard]] Configured<Project> read_checked(const std::string& name,
                                                   const Check& might_run) const;
    [[nodiscard]] const Check& check_of_new() const { return check_new_ ? check_new_ : check_; }
    void forget_staged();
    void forget_all_staged();

    Storage* storage_;
    std::string folder_;
    /// Tells the files that are staged here from those of the stores of the same folder before.
    std::uint32_t generation_{0};
    mutable std::uint32_t staged_count_{0};
    Check check_;
    Check check_new_;
    ProjectLimits limits_;
    std::shared_ptr<const Project> current_;
    /// The version of the file that current_ was read from; nothing if that is not known.
    std::optional<StorageEntry::Version> version_;
    std::optional<Transfer> transfer_;
    std::uint32_t last_number_{0};
};

} // namespace busbar::controller
