#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/status_codes.hpp>

#include "file_nodes.hpp"
#include "method_arguments.hpp"
#include "permissions.hpp"

// What files and directories say of themselves, and what their Methods do (Part 20, 4.2 and 4.3).

namespace busbar::administration::detail {

namespace {

using server::MethodCall;

/// Explains a refusal of OpenFiles or the Storage to an administrator.
std::string reason_of_file(StatusCode status)
{
    struct Row {
        StatusCode status;
        const char* reason;
    };
    static constexpr std::array rows{
        Row{status::Bad_InvalidArgument, "this session has not opened a file with this handle, or "
                                         "the mode or length is not valid"},
        Row{status::Bad_InvalidState,
            "the file is in use, is not open for this access, or was replaced in the meantime"},
        Row{status::Bad_NotReadable, "another session has the file open for writing"},
        Row{status::Bad_NotWritable, "another session has the file open"},
        Row{status::Bad_TooManyOperations, "too many files are open; close others"},
        Row{status::Bad_EncodingLimitsExceeded, "the file is, or would be, too large"},
        Row{status::Bad_OutOfMemory,
            "the open files together take all the memory that they may take"},
        Row{status::Bad_ResourceUnavailable,
            "the folder is not writable, or has the maximum number of files or levels"},
        Row{status::Bad_BrowseNameDuplicated, "a file or folder of this name already exists"},
        Row{status::Bad_BrowseNameInvalid,
            "a name must be UTF-8 of at most 255 bytes, without / and \\, control characters, a "
            "leading period and spaces at either end"},
        Row{status::Bad_NotFound, "there is no such file or folder here"},
        Row{status::Bad_UserAccessDenied, "the user may not write here"},
    };
    const auto* const found = std::find_if(
        rows.begin(), rows.end(), [&](const Row& row) { return row.status == status.code(); });
    return found != rows.end() ? found->reason : std::string{};
}

void refuse_file(MethodCall& call, StatusCode status)
{
    call.fail(status, reason_of_file(status));
}

/// Answers with the outputs or the reason for the failure.
void answer(MethodCall& call, StatusCode status)
{
    if (status.is_bad()) {
        refuse_file(call, status);
    } else {
        call.succeed();
    }
}

std::string_view name_in(std::string_view path)
{
    return path.substr(path.rfind('/') + 1);
}

} // namespace

DataValue FileNodes::value_of(const std::string& path, Aspect aspect)
{
    switch (aspect) {
    case Aspect::OpenCount:
        expire();
        return DataValue{Variant{static_cast<std::uint16_t>(open_.count(path))}};
    case Aspect::MaxByteStringLength:
        return DataValue{Variant{max_piece(server_)}};
    case Aspect::Size:
    case Aspect::LastModifiedTime: {
        const auto entry = files_.storage->entry(path);
        if (!entry) {
            return DataValue{status_of(entry.error())};
        }
        return DataValue{aspect == Aspect::Size ? Variant{entry->size} : Variant{entry->modified}};
    }
    default:
        // A value is the same for all users; Open refuses users without the right to write.
        return DataValue{Variant{!files_.writers.empty() && !files_.is_written_by_program}};
    }
}

void FileNodes::read(server::ReadBatch batch)
{
    const DateTime now = clock_.now();
    constexpr auto count = static_cast<std::uint64_t>(Aspect::Count);
    for (std::size_t i = 0; i < batch.size(); ++i) {
        const std::uint64_t handle = batch.items()[i].handle;
        const auto number = static_cast<std::size_t>(handle / count);
        DataValue value{status::Bad_NodeIdUnknown};
        if (number < paths_.size() && !paths_[number].empty()) {
            value = value_of(paths_[number], static_cast<Aspect>(handle % count));
            value.source_timestamp = now;
        }
        batch.results()[i] = std::move(value);
    }
    batch.complete();
}

void FileNodes::expire()
{
    open_.expire([&](const Holder& holder) { return is_there(server_, holder); });
}

void FileNodes::serve(const std::shared_ptr<server::CallBatch>& batch, std::size_t index)
{
    expire();
    if (is_stale_) {
        refresh();
    }
    MethodCall call{batch, index};
    const std::string* const path = path_of(call.object_id());
    const auto method = static_cast<std::size_t>(batch->items()[index].handle);
    if (path == nullptr || method >= methods_.size()) {
        return call.fail(status::Bad_MethodInvalid);
    }
    const std::string name = *path; // a Method may remove the node
    (this->*methods_[method])(call, name);
}

void FileNodes::open(MethodCall& call, const std::string& path)
{
    const auto mode = call.input<std::uint8_t>(0);
    // A reader with this mode would keep others out, and never write.
    if ((mode & open_write) != 0 && !may_call(space_, writing_, call.user())) {
        return refuse_file(call, status::Bad_UserAccessDenied);
    }
    auto outputs = one_output(Variant{std::uint32_t{0}}); // allocate this first: a handle that the
                                                          // client never got could not be closed
    const auto handle = open_.open(path, mode, holder_of(server_, call));
    if (!handle) {
        return refuse_file(call, handle.error());
    }
    outputs[0] = Variant{*handle};
    call.succeed(std::move(outputs));
}

void FileNodes::close(MethodCall& call, const std::string& path)
{
    const Holder holder = holder_of(server_, call);
    const OpenFiles::Key key{path, call.input<std::uint32_t>(0), holder};
    // Check the right again: it may have been taken away since Write.
    if (open_.is_changed(key) && !may_call(space_, writing_, call.user())) {
        open_.discard(key);
        return refuse_file(call, status::Bad_UserAccessDenied);
    }
    answer(call, open_.close(key));
}

void FileNodes::read_file(MethodCall& call, const std::string& path)
{
    const Holder holder = holder_of(server_, call);
    const OpenFiles::Key key{path, call.input<std::uint32_t>(0), holder};
    // Restore the position if the client does not get the answer.
    busbar::detail::Undo undo{[&, before = open_.position(key)] {
        static_cast<void>(before ? open_.set_position(key, *before) : before.error());
    }};
    const auto bytes = open_.read(key, call.input<std::int32_t>(1));
    if (!bytes) {
        return refuse_file(call, bytes.error());
    }
    auto outputs = one_output(Variant{ByteString{*bytes}});
    undo.keep();
    call.succeed(std::move(outputs));
}

void FileNodes::write_file(MethodCall& call, const std::string& path)
{
    answer(call, open_.write({path, call.input<std::uint32_t>(0), holder_of(server_, call)},
                             bytes_input(call, 1)));
}

void FileNodes::get_position(MethodCall& call, const std::string& path)
{
    const auto position =
        open_.position({path, call.input<std::uint32_t>(0), holder_of(server_, call)});
    if (!position) {
        return refuse_file(call, position.error());
    }
    call.succeed(one_output(Variant{*position}));
}

void FileNodes::set_position(MethodCall& call, const std::string& path)
{
    answer(call, open_.set_position({path, call.input<std::uint32_t>(0), holder_of(server_, call)},
                                    call.input<std::uint64_t>(1)));
}

Result<std::string> FileNodes::new_path(const std::string& folder, std::string_view name)
{
    const std::string path = (folder.empty() ? "" : folder + "/") + std::string{name};
    if (!is_file_name(name) || !is_storage_name(path)) {
        return fail(status::Bad_BrowseNameInvalid);
    }
    const auto depth = static_cast<std::size_t>(std::count(path.begin(), path.end(), '/')) + 1;
    if (depth > files_.limits.max_depth || entries_.size() > files_.limits.max_entries) {
        return fail(status::Bad_ResourceUnavailable);
    }
    const auto there = files_.storage->entry(path);
    if (there) {
        return fail(status::Bad_BrowseNameDuplicated);
    }
    return there.error() == StorageError::NotFound ? Result<std::string>{path}
                                                   : fail(status_of(there.error()));
}

void FileNodes::create_directory(MethodCall& call, const std::string& path)
{
    const auto made = new_path(path, text_view(call, 0));
    if (!made) {
        return refuse_file(call, made.error());
    }
    auto outputs = one_output(Variant{node_id(*made)});
    busbar::detail::Undo undo{[&] { undo_creation(*made); }};
    const auto stored = files_.storage->make_folder(*made, FileAccess::Owner);
    refresh();
    undo.keep();
    if (!stored) {
        return refuse_file(call, status_of(stored.error()));
    }
    call.succeed(std::move(outputs));
}

void FileNodes::create_file(MethodCall& call, const std::string& path)
{
    const auto made = new_path(path, text_view(call, 0));
    if (!made) {
        return refuse_file(call, made.error());
    }
    busbar::detail::Undo undo{[&] { undo_creation(*made); }};
    const auto stored = files_.storage->replace(*made, {}, FileAccess::Owner);
    refresh();
    if (!stored) {
        undo.keep();
        return refuse_file(call, status_of(stored.error()));
    }
    std::uint32_t handle = 0;
    Array<Variant> outputs;
    outputs.push_back(Variant{node_id(*made)});
    outputs.push_back(Variant{handle});
    if (call.input<bool>(1)) {
        const auto opened = open_.open(*made, open_read | open_write, holder_of(server_, call));
        if (!opened) {
            return refuse_file(call, opened.error());
        }
        handle = *opened;
        outputs[1] = Variant{handle};
    }
    undo.keep();
    call.succeed(std::move(outputs));
}

/// Removes a new file or folder whose request failed.
void FileNodes::undo_creation(const std::string& path)
{
    static_cast<void>(files_.storage->remove(path));
    refresh();
}

StatusCode FileNodes::remove_all(const std::string& path, StorageEntry::Kind kind)
{
    if (kind == StorageEntry::Kind::Folder) {
        const auto listing = files_.storage->list(path, files_.limits.max_entries);
        if (!listing) {
            return status_of(listing.error());
        }
        for (const StorageEntry& each : listing->entries) {
            if (const StatusCode removed = remove_all(path + "/" + each.name, each.kind);
                removed.is_bad()) {
                return removed;
            }
        }
    }
    const auto removed = files_.storage->remove(path);
    return removed ? StatusCode{status::Good} : status_of(removed.error());
}

const std::string* FileNodes::child_path(const MethodCall& call, const std::string& folder) const
{
    const auto* const node = call.inputs()[0].get_if<NodeId>();
    const std::string* const path = node != nullptr ? path_of(*node) : nullptr;
    return path != nullptr && !path->empty() && folder_of(*path) == folder ? path : nullptr;
}

void FileNodes::delete_entry(MethodCall& call, const std::string& path)
{
    const std::string* const child = child_path(call, path);
    if (child == nullptr) {
        return refuse_file(call, status::Bad_NotFound);
    }
    if (open_.is_in_use(*child, holder_of(server_, call))) {
        return refuse_file(call, status::Bad_InvalidState);
    }
    if (files_.may_delete && !files_.may_delete(*child)) {
        return call.fail(status::Bad_InvalidState,
                         "the server itself uses this; clients may delete only files that are "
                         "complete");
    }
    const StatusCode removed = remove_all(std::string{*child}, entries_.find(*child)->second.kind);
    refresh_soon();
    answer(call, removed);
}

void FileNodes::begin_new_file(MethodCall& call, const std::string& /*path*/)
{
    const auto begun = files_.begin_new_file();
    refresh_soon();
    answer(call, begun ? StatusCode{status::Good} : status_of(begun.error()));
}

StatusCode FileNodes::copy_file(const std::string& from, const std::string& to)
{
    const auto bytes = busbar::read_file(*files_.storage, from, files_.limits.max_file_size);
    if (!bytes) {
        return bytes.error() == StorageError::TooLarge
                   ? StatusCode{status::Bad_EncodingLimitsExceeded}
                   : status_of(bytes.error());
    }
    const auto kept = files_.storage->replace(to, *bytes, FileAccess::Owner);
    return kept ? StatusCode{status::Good} : status_of(kept.error());
}

/// Copies or moves an entry; the files of a folder one by one. After a failure each file is at one
/// of the two places, or at both.
StatusCode FileNodes::transfer(const std::string& from, const std::string& to,
                               StorageEntry::Kind kind, bool copies)
{
    if (kind != StorageEntry::Kind::Folder) {
        if (copies) {
            return copy_file(from, to);
        }
        const auto moved = files_.storage->move(from, to, WhenThere::Refuse);
        return moved ? StatusCode{status::Good} : status_of(moved.error());
    }
    if (const auto made = files_.storage->make_folder(to, FileAccess::Owner); !made) {
        return status_of(made.error());
    }
    const auto listing = files_.storage->list(from, files_.limits.max_entries);
    if (!listing) {
        return status_of(listing.error());
    }
    for (const StorageEntry& each : listing->entries) {
        if (each.kind == StorageEntry::Kind::Other) {
            return status::Bad_NotSupported;
        }
        const StatusCode done =
            transfer(from + "/" + each.name, to + "/" + each.name, each.kind, copies);
        if (done.is_bad()) {
            return done;
        }
    }
    if (copies) {
        return status::Good;
    }
    const auto removed = files_.storage->remove(from);
    return removed ? StatusCode{status::Good} : status_of(removed.error());
}

std::size_t FileNodes::entries_below(const std::string& path) const
{
    return static_cast<std::size_t>(
        std::count_if(entries_.begin(), entries_.end(), [&](const auto& each) {
            return each.first == path || each.first.starts_with(path + "/");
        }));
}

void FileNodes::move_or_copy(MethodCall& call, const std::string& path)
{
    const std::string* const child = child_path(call, path);
    const auto* const target_id = call.inputs()[1].get_if<NodeId>();
    const std::string* const target = target_id != nullptr ? path_of(*target_id) : nullptr;
    if (child == nullptr || target == nullptr ||
        entries_.find(*target)->second.kind != StorageEntry::Kind::Folder) {
        return refuse_file(call, status::Bad_NotFound);
    }
    const std::string from = *child;
    const bool copies = call.input<bool>(2);
    const std::string_view name = text_view(call, 3);
    const auto to = new_path(*target, name.empty() ? name_in(from) : name);
    if (!to) {
        return refuse_file(call, to.error());
    }
    if (open_.is_in_use(from, holder_of(server_, call))) {
        return refuse_file(call, status::Bad_InvalidState);
    }
    if (to->starts_with(from + "/")) {
        return call.fail(status::Bad_InvalidArgument, "a folder cannot be moved into itself");
    }
    if (copies && entries_.size() + entries_below(from) > files_.limits.max_entries + 1) {
        return refuse_file(call, status::Bad_ResourceUnavailable);
    }
    auto outputs = one_output(Variant{node_id(*to)});
    const StatusCode done = transfer(from, *to, entries_.find(from)->second.kind, copies);
    refresh_soon();
    if (done.is_bad()) {
        return refuse_file(call, done);
    }
    call.succeed(std::move(outputs));
}

} // namespace busbar::administration::detail
