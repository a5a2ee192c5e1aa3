#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <busbar/controller/project.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/storage.hpp>

namespace busbar::controller {

/// The project that a server module keeps (seed 001, 9.13), and one that a tool transfers: staged
/// in the Storage, checked as a whole, and then in the place of the other one, in one step. A
/// transfer that is interrupted, refused or cut off by a power failure leaves the old one.
///
///     const auto transfer = store.begin();   // nobody else is at it
///     store.write(*transfer, bytes);         // as often as it takes
///     store.commit(*transfer);
///
/// Not thread-safe; nobody else changes the folder.
class BUSBAR_API ProjectStore {
public:
    /// Whether a server could run the project: load_models, and what else there is. What check()
    /// says is looked at before.
    using Check = std::function<Configured<void>(const Project&)>;

    /// `storage` must outlive this object; `folder` is this object's own and is made when it is
    /// needed.
    ProjectStore(Storage& storage, std::string folder, Check check,
                 const ProjectLimits& limits = {});

    /// What new projects are checked with instead: one that was stored before and is served stays
    /// one, whatever is asked of others since.
    void check_new_with(Check check) { check_new_ = std::move(check); }

    /// Forgets a transfer that the power cut and reads the project; there may be none. Once, before
    /// anything else. A problem with the file, or with the medium, is no project: another one can
    /// be transferred.
    [[nodiscard]] Configured<void> recover();

    /// Null: there is none. Until the next commit().
    [[nodiscard]] const Project* current() const { return current_ ? &*current_ : nullptr; }
    /// Its file as it lies there. Bad_NotFound if there is none.
    [[nodiscard]] Configured<std::string> document() const;

    /// Begins a transfer; its number. Bad_InvalidState while there is another one.
    [[nodiscard]] Configured<std::uint32_t> begin();
    /// Adds to its file. After a problem the transfer is over; Bad_InvalidState if it was before.
    [[nodiscard]] Configured<void> write(std::uint32_t transfer, std::span<const std::byte> bytes);
    /// Checks the file and makes it the current project. The transfer is over in any case, and
    /// after a problem everything is as it was before it.
    [[nodiscard]] Configured<void> commit(std::uint32_t transfer);
    /// Ends it, if it is not over.
    void cancel(std::uint32_t transfer);
    [[nodiscard]] bool is_busy() const { return transfer_.has_value(); }

    /// What stage() has checked.
    class Staged {
        friend class ProjectStore;
        explicit Staged(Project project) : project_{std::move(project)} {}
        Project project_;
    };
    /// A transfer as a whole, in two steps. The first one stages and checks the file, which takes
    /// long: it may run on another thread than the rest, one at a time, while nobody has begun a
    /// transfer. The second one makes it the current project.
    [[nodiscard]] Configured<Staged> stage(std::span<const std::byte> document) const;
    [[nodiscard]] Configured<void> take_up(Staged staged);
    /// Both at once.
    [[nodiscard]] Configured<void> replace(std::span<const std::byte> document);

private:
    struct Transfer {
        std::uint32_t number;
        std::size_t size;
    };

    [[nodiscard]] std::string file() const { return storage_path(folder_, "project.busbar"); }
    [[nodiscard]] std::string staged() const { return storage_path(folder_, "project.part"); }
    [[nodiscard]] bool is_of(std::uint32_t transfer) const
    {
        return transfer_ && transfer_->number == transfer;
    }
    [[nodiscard]] Configured<std::string> read(const std::string& name) const;
    [[nodiscard]] Configured<Project> read_checked(const std::string& name,
                                                   const Check& might_run) const;
    [[nodiscard]] const Check& check_of_new() const { return check_new_ ? check_new_ : check_; }
    void forget_staged();

    Storage* storage_;
    std::string folder_;
    Check check_;
    Check check_new_;
    ProjectLimits limits_;
    std::optional<Project> current_;
    std::optional<Transfer> transfer_;
    std::uint32_t last_number_{0};
};

} // namespace busbar::controller
