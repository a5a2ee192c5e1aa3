#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/administration/file_system.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/server/data_source.hpp>
#include <busbar/server/method_table.hpp>
#include <busbar/server/server.hpp>

#include "call_turns.hpp"
#include "file_objects.hpp"
#include "node_table.hpp"
#include "open_files.hpp"

namespace busbar::administration::detail {

enum class FileRight : std::uint8_t { Read, Write, Delete };

/// The nodes of one FileSystem: Objects that follow what there is in the Storage, and one Method of
/// each kind for all of them.
class FileNodes final : public server::DataSource {
public:
    FileNodes(server::Server& server, const FileSystem& files, const WallClock& clock,
              LogSink& log);

    /// The problem is one of the namespace, which is too small, or of nodes that are there already.
    [[nodiscard]] Configured<void> add_nodes();
    /// Adds and removes nodes as the Storage has files.
    void refresh();

    [[nodiscard]] server::DataSourceOptions options() const override
    {
        return own_source_options();
    }
    void read(server::ReadBatch batch) override;
    void call(server::CallBatch batch) override { turns_.add(std::move(batch)); }
    void attach(server::Waker* waker) override { turns_.attach(waker); }
    void handle_completions() override { turns_.serve_next(); }

private:
    using Aspect = FileAspect;
    struct Entry {
        StorageEntry::Kind kind{StorageEntry::Kind::File};
        std::uint32_t number{0};
    };
    using Entries = std::map<std::string, Entry, std::less<>>;
    using Method = void (FileNodes::*)(server::MethodCall& call, const std::string& path);

    [[nodiscard]] Result<model::NodeIndex> add_directory(const model::NewNode& node);
    [[nodiscard]] Result<void> add_file(const model::NewNode& node, std::uint32_t number);
    [[nodiscard]] Result<model::NodeIndex> add_method(std::uint32_t declaration, Method method,
                                                      FileRight right);
    /// The type of the files.
    [[nodiscard]] Configured<void> add_type();
    [[nodiscard]] Configured<void> add_methods();
    /// False if the medium cannot be read.
    [[nodiscard]] bool collect(const std::string& folder, std::size_t depth, Entries& found);
    /// Whether clients see the file of this name. Says once that they do not see one.
    [[nodiscard]] bool is_shown(const StorageEntry& entry);
    void add_entry(const std::string& path, Entry entry);
    [[nodiscard]] bool add_entry_nodes(const std::string& path, Entry& entry);
    void remove_entry(const std::string& path);
    /// The same where the medium has changed already: what fails is done before the next Method.
    void refresh_soon();
    [[nodiscard]] NodeId node_id(std::string_view path) const;
    /// The path of one of our Objects; nothing for other nodes.
    [[nodiscard]] const std::string* path_of(const NodeId& node) const;
    [[nodiscard]] DataValue value_of(const std::string& path, Aspect aspect);
    void expire();
    void serve(const std::shared_ptr<server::CallBatch>& batch, std::size_t index);

    void open(server::MethodCall& call, const std::string& path);
    void close(server::MethodCall& call, const std::string& path);
    void read_file(server::MethodCall& call, const std::string& path);
    void write_file(server::MethodCall& call, const std::string& path);
    void get_position(server::MethodCall& call, const std::string& path);
    void set_position(server::MethodCall& call, const std::string& path);
    void create_directory(server::MethodCall& call, const std::string& path);
    void create_file(server::MethodCall& call, const std::string& path);
    void undo_creation(const std::string& path);
    void delete_entry(server::MethodCall& call, const std::string& path);
    void move_or_copy(server::MethodCall& call, const std::string& path);

    /// Whether there may be a new entry of this name in the folder, and its path.
    [[nodiscard]] Result<std::string> new_path(const std::string& folder, std::string_view name);
    /// The path of the first argument; null unless it is in the folder.
    [[nodiscard]] const std::string* child_path(const server::MethodCall& call,
                                                const std::string& folder) const;
    [[nodiscard]] std::size_t entries_below(const std::string& path) const;
    [[nodiscard]] StatusCode remove_all(const std::string& path, StorageEntry::Kind kind);
    [[nodiscard]] StatusCode transfer(const std::string& from, const std::string& to,
                                      StorageEntry::Kind kind, bool copies);
    [[nodiscard]] StatusCode copy_file(const std::string& from, const std::string& to);

    server::Server& server_;
    model::AddressSpace& space_;
    const FileSystem& files_;
    const WallClock& clock_;
    LogSink& log_;
    /// It was logged that a name in the folder is none.
    bool is_told_{false};
    OpenFiles open_;
    CallTurns turns_;
    std::uint16_t namespace_{0};
    NodeId file_type_;
    model::NodeIndex writing_{model::no_node};
    std::vector<model::NodeIndex> directory_methods_;
    std::vector<model::NodeIndex> file_methods_;
    std::vector<Method> methods_;
    /// By path; the root is "".
    Entries entries_;
    /// The path of each number; empty for those that are free.
    std::vector<std::string> paths_;
    /// Has room for all of them, so that a removal needs no memory.
    std::vector<std::uint32_t> free_numbers_;
    /// A refresh did not come to its end.
    bool is_stale_{false};
};

/// What files of clients may be called: a name (see is_name) that is no path and is not hidden.
[[nodiscard]] bool is_file_name(std::string_view name);
/// The path of the folder that it is in; "" for the root.
[[nodiscard]] std::string_view folder_of(std::string_view path);

} // namespace busbar::administration::detail
