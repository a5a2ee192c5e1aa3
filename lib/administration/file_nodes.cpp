#include "file_nodes.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/text.hpp>
#include <busbar/types/ids.hpp>

#include "core/unfinished.hpp"
#include "core/utf8.hpp"
#include "node_table.hpp"
#include "permissions.hpp"
#include "rights.hpp"

namespace busbar::administration::detail {

namespace {

/// Prefix of the roots of all FileSystems.
constexpr std::string_view files_prefix = "Files/";

/// Returns the roles with a right: writers have all but the program's own.
NamedRoles roles_of(const FileSystem& files, FileRight right)
{
    const bool is_programs = right == FileRight::Write && files.is_written_by_program;
    return {files.readers, is_programs ? std::vector<NodeId>{} : files.writers};
}

model::NodeAccess access_of_folder(const FileSystem& files)
{
    return access_of(Thing::Files, NodeClass::Object, roles_of(files, FileRight::Read));
}

/// Returns the entry point of all folders (Part 20, 4.3.2), or Objects if namespace 0 has none. No
/// role may call its Methods, because it is not a folder of a medium.
model::NodeIndex entry_point(model::AddressSpace& space)
{
    const model::NodeIndex objects = space.find(id::ObjectsFolder);
    const model::NodeIndex system = space.find(id::FileSystem);
    if (system == model::no_node) {
        return objects;
    }
    // This fails, harmlessly, for the second FileSystem.
    static_cast<void>(space.add_reference(objects, NodeId{0, id::HasComponent}, system));
    for (const char* method : {"CreateDirectory", "CreateFile", "Delete", "MoveOrCopy"}) {
        if (const model::NodeIndex node = child_of(space, system, method); node != model::no_node) {
            model::NodeAccess nobody;
            nobody.role_permissions.clear(); // not null
            space.set_node_access(node, std::move(nobody));
        }
    }
    return system;
}

std::string_view last_name(std::string_view path)
{
    return path.substr(path.rfind('/') + 1);
}

} // namespace

bool is_file_name(std::string_view name)
{
    return busbar::detail::is_name(name) && name.front() != '.' &&
           name.find_first_of("/\\") == std::string_view::npos;
}

std::string_view folder_of(std::string_view path)
{
    const std::size_t end = path.rfind('/');
    return end == std::string_view::npos ? std::string_view{} : path.substr(0, end);
}

FileNodes::FileNodes(server::Server& server, const FileSystem& files, const WallClock& clock,
                     LogSink& log)
    : server_{server}, space_{server.address_space()}, files_{files}, clock_{clock}, log_{log},
      open_{*files.storage, files.limits}, turns_{
                                               [this](
                                                   const std::shared_ptr<server::CallBatch>& batch,
                                                   std::size_t index) { serve(batch, index); },
                                               log}
{
    turns_.set_server(server);
}

NodeId FileNodes::node_id(std::string_view path) const
{
    std::string text = std::string{files_prefix} + files_.name;
    if (!path.empty()) {
        text += "/" + std::string{path};
    }
    return NodeId{namespace_, String{text}};
}

const std::string* FileNodes::path_of(const NodeId& node) const
{
    if (node.namespace_index() != namespace_ || node.id_type() != IdType::String) {
        return nullptr;
    }
    const std::string_view text = node.string().view();
    const std::string root = std::string{files_prefix} + files_.name;
    if (!text.starts_with(root)) {
        return nullptr;
    }
    const std::string_view rest = text.substr(root.size());
    const auto found = entries_.find(rest.empty() ? rest : rest.substr(1));
    return found != entries_.end() && (rest.empty() || rest.front() == '/') ? &found->first
                                                                            : nullptr;
}

Configured<void> FileNodes::add_nodes()
{
    server_.add_source(*this);
    namespace_ = space_.namespace_index(server_.config().application_uri).value_or(1);
    model::NewNode node;
    node.id = node_id("");
    node.browse_name = QualifiedName{namespace_, String{files_.name}};
    node.parent = entry_point(space_);
    node.reference_type = NodeId{0, id::Organizes};
    model::NewObject object;
    object.type_definition = NodeId{0, id::FileDirectoryType};
    const auto root = space_.add_object(node, object);
    if (!root) {
        return misconfigured("files " + files_.name, "cannot be added to the address space",
                             root.error());
    }
    space_.set_node_access(*root, access_of_folder(files_));
    entries_.emplace("", Entry{StorageEntry::Kind::Folder, 0});
    if (auto added = add_type(); !added) {
        return added;
    }
    if (auto added = add_methods(); !added) {
        return added;
    }
    busbar::detail::remove_unfinished_below(*files_.storage, "");
    refresh();
    return {};
}

Configured<void> FileNodes::add_type()
{
    model::NewNode node;
    node.browse_name = QualifiedName{namespace_, String{files_.name + "FileType"}};
    node.id = NodeId{namespace_, String{"FileTypes/" + files_.name}};
    node.parent = space_.find(id::FileType);
    const auto added = space_.add_object_type(node);
    if (!added) {
        return misconfigured("files " + files_.name, "their type cannot be added", added.error());
    }
    file_type_ = node.id;
    return {};
}

Configured<void> FileNodes::add_methods()
{
    struct Declared {
        std::uint32_t declaration;
        Method method;
        FileRight right;
        bool is_of_files;
    };
    constexpr std::array all{
        Declared{id::FileType_Open, &FileNodes::open, FileRight::Read, true},
        Declared{id::FileType_Close, &FileNodes::close, FileRight::Read, true},
        Declared{id::FileType_Read, &FileNodes::read_file, FileRight::Read, true},
        Declared{id::FileType_Write, &FileNodes::write_file, FileRight::Write, true},
        Declared{id::FileType_GetPosition, &FileNodes::get_position, FileRight::Read, true},
        Declared{id::FileType_SetPosition, &FileNodes::set_position, FileRight::Read, true},
        Declared{id::FileDirectoryType_CreateDirectory, &FileNodes::create_directory,
                 FileRight::Write, false},
        Declared{id::FileDirectoryType_CreateFile, &FileNodes::create_file, FileRight::Write,
                 false},
        Declared{id::FileDirectoryType_DeleteFileSystemObject, &FileNodes::delete_entry,
                 FileRight::Delete, false},
        Declared{id::FileDirectoryType_MoveOrCopy, &FileNodes::move_or_copy, FileRight::Write,
                 false},
    };
    for (const Declared& each : all) {
        const auto added = add_method(each.declaration, each.method, each.right);
        if (!added) {
            return misconfigured("files " + files_.name, "their Methods cannot be added",
                                 added.error());
        }
        if (each.declaration == id::FileType_Write) {
            writing_ = *added;
        }
        (each.is_of_files ? file_methods_ : directory_methods_).push_back(*added);
    }
    return files_.begin_new_file ? add_begin_new_file() : Configured<void>{};
}

Configured<void> FileNodes::add_begin_new_file()
{
    model::NewNode node;
    node.browse_name = QualifiedName{namespace_, "BeginNewFile"};
    node.id = NodeId{namespace_, String{node_id("").string().str() + "//BeginNewFile"}};
    node.parent = space_.find(node_id(""));
    model::NewMethod facts;
    facts.source = index();
    facts.handle = methods_.size();
    const auto added = space_.add_method(node, facts);
    if (!added) {
        return misconfigured("files " + files_.name, "their Methods cannot be added",
                             added.error());
    }
    space_.set_node_access(*added, access_of(Thing::FileChanges, NodeClass::Method,
                                             roles_of(files_, FileRight::Delete)));
    methods_.push_back(&FileNodes::begin_new_file);
    return {};
}

/// Adds a Method. Methods of files belong to a type of their own, those of directories to the root;
/// all other Objects refer to them.
Result<model::NodeIndex> FileNodes::add_method(std::uint32_t declaration, Method method,
                                               FileRight right)
{
    auto added = add_declared_method(
        space_,
        {.declaration = declaration,
         .parent = space_.find(declaration < id::FileDirectoryType ? file_type_ : node_id("")),
         .source = index(),
         .handle = methods_.size(),
         .thing = right == FileRight::Read ? Thing::Files : Thing::FileChanges},
        roles_of(files_, right));
    if (added) {
        methods_.push_back(method);
    }
    return added;
}

Result<model::NodeIndex> FileNodes::add_directory(const model::NewNode& node)
{
    model::NewObject object;
    object.type_definition = NodeId{0, id::FileDirectoryType};
    auto added = space_.add_object(node, object);
    for (const model::NodeIndex method : directory_methods_) {
        if (added) {
            static_cast<void>(space_.add_reference(*added, NodeId{0, id::HasComponent}, method));
        }
    }
    return added;
}

Result<void> FileNodes::add_file(const model::NewNode& node, std::uint32_t number)
{
    const auto added = add_file_object(space_, node, {file_type_, index(), number},
                                       roles_of(files_, FileRight::Read));
    if (!added) {
        return fail(added.error());
    }
    for (const model::NodeIndex method : file_methods_) {
        static_cast<void>(space_.add_reference(*added, NodeId{0, id::HasComponent}, method));
    }
    return {};
}

/// Adds an entry and its node, or neither.
void FileNodes::add_entry(const std::string& path, Entry entry)
{
    const auto place = entries_.emplace(path, entry).first;
    busbar::detail::Undo undo{[&] {
        if (const model::NodeIndex node = space_.find(node_id(path)); node != model::no_node) {
            static_cast<void>(space_.remove(node));
        }
        entries_.erase(place);
    }};
    if (add_entry_nodes(path, place->second)) {
        undo.keep();
    }
}

bool FileNodes::add_entry_nodes(const std::string& path, Entry& entry)
{
    model::NewNode node;
    node.id = node_id(path);
    node.browse_name = QualifiedName{namespace_, String{last_name(path)}};
    node.parent = space_.find(node_id(folder_of(path)));
    node.reference_type = NodeId{0, id::Organizes};
    if (entry.kind == StorageEntry::Kind::Folder) {
        const auto added = add_directory(node);
        if (added) {
            space_.set_node_access(*added, access_of_folder(files_));
        }
        return added.has_value();
    }
    if (free_numbers_.empty()) {
        free_numbers_.reserve(paths_.size() + 1);
        paths_.emplace_back();
        free_numbers_.push_back(static_cast<std::uint32_t>(paths_.size() - 1));
    }
    entry.number = free_numbers_.back();
    std::string own_path = path;
    if (!add_file(node, entry.number)) {
        return false;
    }
    free_numbers_.pop_back();
    paths_[entry.number] = std::move(own_path);
    return true;
}

void FileNodes::remove_entry(const std::string& path)
{
    if (const model::NodeIndex node = space_.find(node_id(path)); node != model::no_node) {
        static_cast<void>(space_.remove(node));
    }
    const auto found = entries_.find(path);
    open_.drop(path);
    if (found->second.kind == StorageEntry::Kind::File) {
        paths_[found->second.number].clear();
        free_numbers_.push_back(found->second.number);
    }
    entries_.erase(found);
}

bool FileNodes::is_shown(const StorageEntry& entry)
{
    if (entry.kind == StorageEntry::Kind::Other || entry.name.starts_with('.')) {
        return false;
    }
    const bool is_name = is_file_name(entry.name);
    if (!is_name && !is_told_) {
        is_told_ = true;
        log_.write(LogLevel::Warning, "files",
                   "clients cannot see \"" + printable(entry.name) + "\" in " +
                       files_.storage->place("") +
                       ": names must be UTF-8 without control characters, backslashes, and spaces "
                       "at either end. Rename it; more files like it are not reported");
    }
    return is_name;
}

bool FileNodes::collect(const std::string& folder, std::size_t depth, Entries& found)
{
    const auto listing = files_.storage->list(folder, files_.limits.max_entries);
    if (!listing) {
        return listing.error() == StorageError::NotFound;
    }
    for (const StorageEntry& each : listing->entries) {
        const std::string path = folder.empty() ? each.name : folder + "/" + each.name;
        if (!is_shown(each) || !is_storage_name(path) || found.size() > files_.limits.max_entries) {
            continue;
        }
        found.emplace(path, Entry{each.kind, 0});
        if (each.kind == StorageEntry::Kind::Folder && depth < files_.limits.max_depth &&
            !collect(path, depth + 1, found)) {
            return false;
        }
    }
    return true;
}

void FileNodes::refresh()
{
    Entries found;
    is_stale_ = true;
    found.emplace("", Entry{StorageEntry::Kind::Folder, 0});
    if (!collect("", 1, found)) {
        is_stale_ = false;
        return; // a folder that cannot be read now still exists
    }
    std::vector<std::string> gone;
    for (const auto& [path, entry] : entries_) {
        const auto now = found.find(path);
        if (now == found.end() || now->second.kind != entry.kind) {
            gone.push_back(path);
        }
    }
    // Remove the contents of a folder before the folder.
    std::for_each(gone.rbegin(), gone.rend(), [&](const std::string& path) { remove_entry(path); });
    for (auto& [path, entry] : found) {
        if (!entries_.contains(path) && entries_.contains(folder_of(path))) {
            add_entry(path, entry);
        }
    }
    is_stale_ = false;
}

void FileNodes::refresh_soon()
{
    busbar::detail::attempt([this] { refresh(); });
}

} // namespace busbar::administration::detail
