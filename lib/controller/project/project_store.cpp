#include <busbar/controller/project_store.hpp>

#include <utility>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::controller {

namespace {

/// The start of the names of files that are being transferred.
constexpr const char* staged_name = "project.part";

Unexpected<Problem> storage_problem(const Storage& storage, const std::string& name,
                                    StorageError error)
{
    return misconfigured(storage.place(name), std::string{text(error)}, status_of(error));
}

Unexpected<Problem> no_transfer()
{
    return misconfigured("transfer", "is over: it was cancelled or has failed",
                         status::Bad_InvalidState);
}

Unexpected<Problem> busy()
{
    return misconfigured("transfer", "another tool is writing a project", status::Bad_InvalidState);
}

Unexpected<Problem> too_large(const ProjectLimits& limits)
{
    return misconfigured("transfer",
                         "found a project of more than " + std::to_string(limits.max_file_size) +
                             " bytes",
                         status::Bad_EncodingLimitsExceeded);
}

} // namespace

/// Removes the file, unless its name was cleared.
struct ProjectStore::Staged::File {
    File(Storage& of, std::string named) : storage{of}, name{std::move(named)} {}
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    ~File()
    {
        if (!name.empty()) {
            static_cast<void>(storage.remove(name));
        }
    }

    Storage& storage;
    std::string name;
};

ProjectStore::ProjectStore(Storage& storage, std::string folder, Check check,
                           const ProjectLimits& limits)
    : storage_{&storage}, folder_{std::move(folder)}, check_{std::move(check)}, limits_{limits}
{
}

std::string ProjectStore::staged() const
{
    const std::string number = generation_ == 0 ? "" : std::to_string(generation_);
    return storage_path(folder_, staged_name + number);
}

/// Removes also what stores before this one have left.
void ProjectStore::forget_all_staged()
{
    forget_staged();
    constexpr std::size_t most_entries = 1'000;
    const auto listing = storage_->list(folder_, most_entries);
    if (!listing) {
        return;
    }
    for (const StorageEntry& entry : listing->entries) {
        if (entry.name.starts_with(staged_name)) {
            static_cast<void>(storage_->remove(storage_path(folder_, entry.name)));
        }
    }
}

void ProjectStore::forget_staged()
{
    transfer_.reset();
    static_cast<void>(storage_->remove(staged())); // if it fails, recover() or the next begin()
                                                   // removes it
}

Configured<std::string> ProjectStore::read(const std::string& name) const
{
    const auto bytes = read_file(*storage_, name, limits_.max_file_size);
    if (!bytes) {
        return storage_problem(*storage_, name, bytes.error());
    }
    return std::string{reinterpret_cast<const char*>(bytes->data()), bytes->size()};
}

Configured<Project> ProjectStore::read_checked(const std::string& name,
                                               const Check& might_run) const
{
    const auto document = read(name);
    if (!document) {
        return Unexpected{document.error()};
    }
    auto project = read_project(*document, "project", limits_);
    if (!project) {
        return project;
    }
    auto checked = check(*project);
    if (checked && might_run) {
        checked = might_run(*project);
    }
    return checked ? std::move(project)
                   : Configured<Project>{Unexpected{std::move(checked.error())}};
}

Configured<void> ProjectStore::recover(const ProjectStore* running)
{
    current_.reset();
    version_.reset();
    if (running == nullptr) {
        forget_all_staged();
        storage_->remove_unfinished(folder_);
    } else {
        generation_ = running->generation_ + 1;
    }
    const auto there = storage_->entry(file());
    if (!there && there.error() == StorageError::NotFound) {
        return {};
    }
    if (there && running != nullptr && running->version_ == there->version) {
        current_ = running->current_;
        version_ = running->version_;
        return {};
    }
    auto project = read_checked(file(), check_);
    if (!project) {
        return Unexpected{std::move(project.error())};
    }
    current_ = std::make_shared<const Project>(*std::move(project));
    version_ = there ? std::optional{there->version} : std::nullopt;
    return {};
}

Configured<std::string> ProjectStore::document() const
{
    return current_ ? read(file())
                    : misconfigured("project", "there is none", status::Bad_NotFound);
}

Configured<std::uint32_t> ProjectStore::begin()
{
    if (transfer_) {
        return busy();
    }
    if (auto made = storage_->make_folder(folder_, FileAccess::Owner); !made) {
        return storage_problem(*storage_, folder_, made.error());
    }
    // Replace also what a transfer left that could not be removed.
    if (auto begun = storage_->replace(staged(), {}, FileAccess::Owner); !begun) {
        return storage_problem(*storage_, staged(), begun.error());
    }
    transfer_ = Transfer{++last_number_, 0};
    return transfer_->number;
}

Configured<void> ProjectStore::write(std::uint32_t transfer, std::span<const std::byte> bytes)
{
    if (!is_of(transfer)) {
        return no_transfer();
    }
    if (bytes.size() > limits_.max_file_size - transfer_->size) {
        forget_staged();
        return too_large(limits_);
    }
    busbar::detail::Undo undo{[this] { forget_staged(); }};
    if (auto added = storage_->append(staged(), bytes, FileAccess::Owner); !added) {
        return storage_problem(*storage_, staged(), added.error());
    }
    undo.keep();
    transfer_->size += bytes.size();
    return {};
}

Configured<void> ProjectStore::commit(std::uint32_t transfer)
{
    if (!is_of(transfer)) {
        return no_transfer();
    }
    busbar::detail::Undo undo{[this] { forget_staged(); }};
    // Use the stored bytes rather than those that were sent.
    auto project = read_checked(staged(), check_of_new());
    auto done = project ? take_up(Staged{*std::move(project)})
                        : Configured<void>{Unexpected{std::move(project.error())}};
    if (done) {
        undo.keep();
        transfer_.reset();
    }
    return done;
}

Configured<ProjectStore::Staged> ProjectStore::stage(std::span<const std::byte> document) const
{
    if (document.size() > limits_.max_file_size) {
        return too_large(limits_);
    }
    if (auto made = storage_->make_folder(folder_, FileAccess::Owner); !made) {
        return storage_problem(*storage_, folder_, made.error());
    }
    // The one before may still be there, and removes its file when it goes.
    auto file =
        std::make_shared<Staged::File>(*storage_, staged() + "-" + std::to_string(++staged_count_));
    if (auto put = storage_->replace(file->name, document, FileAccess::Owner); !put) {
        return storage_problem(*storage_, file->name, put.error());
    }
    auto project = read_checked(file->name, check_of_new());
    if (!project) {
        return Unexpected{std::move(project.error())};
    }
    return Staged{*std::move(project), std::move(file)};
}

Configured<void> ProjectStore::take_up(Staged staged_project)
{
    // What may fail comes first: after the move it is the current project.
    const std::string from =
        staged_project.file_ != nullptr ? staged_project.file_->name : staged();
    const std::string to = file();
    auto project = std::make_shared<const Project>(std::move(staged_project.project_));
    if (auto moved = storage_->move(from, to, WhenThere::Replace); !moved) {
        return storage_problem(*storage_, to, moved.error());
    }
    if (staged_project.file_ != nullptr) {
        staged_project.file_->name.clear();
    }
    current_ = std::move(project);
    version_.reset();
    busbar::detail::attempt([&] {
        if (const auto there = storage_->entry(to)) {
            version_ = there->version;
        }
    });
    return {};
}

void ProjectStore::cancel(std::uint32_t transfer)
{
    if (is_of(transfer)) {
        forget_staged();
    }
}

Configured<void> ProjectStore::replace(std::span<const std::byte> document)
{
    if (transfer_) {
        return busy();
    }
    auto staged_project = stage(document);
    return staged_project ? take_up(*std::move(staged_project))
                          : Configured<void>{Unexpected{std::move(staged_project.error())}};
}

} // namespace busbar::controller
