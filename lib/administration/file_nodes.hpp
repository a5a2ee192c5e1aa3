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

/// The nodes of one FileSystem: Objects that follow the content of the Storage, and one Method of
/// each kind that all of them share.
class FileNodes final : public server::DataSource {
public:
    FileNodes(server::Server& server, const FileSystem& files, const WallClock& clock,
              LogSink& log);

    /// Adds the nodes. Fails if namespace 0 is too small or a node exists already.
    [[nodiscard]] Configured<void> add_nodes();
    /// Adds and removes nodes until they match the Storage.
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
    /// Adds the type of the files.
    [[nodiscard]] Configured<void> add_type();
    [[nodiscard]] Configured<void> add_methods();
    /// Adds BeginNewFile, which no type declares, to the root.
    [[nodiscard]] Configured<void> add_begin_new_file();
    /// Lists the entries of a folder; false if the medium cannot be read.
    [[nodiscard]] bool collect(const std::string& folder, std::size_t depth, Entries& found);
    /// Tells whether clients see the file of this name. Logs the first one that they do not see.
    [[nodiscard]] bool is_shown(const StorageEntry& entry);
    void add_entry(const std::string& path, Entry entry);
    [[nodiscard]] bool add_entry_nodes(const std::string& path, Entry& entry);
    void remove_entry(const std::string& path);
    /// Does the same after the medium has changed; repeats a failure before the next Method.
    void refresh_soon();
    [[nodiscard]] NodeId node_id(std::string_view path) const;
    /// Returns the path of one of these Objects; null for other nodes.
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
    void begin_new_file(server::MethodCall& call, const std::string& path);

    /// Returns the path of a new entry with this name in the folder, if it may exist.
    [[nodiscard]] Result<std::string> new_path(const std::string& folder, std::string_view name);
    /// Returns the path in the first argument; null unless it is in the folder.
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
    /// True once a name that clients cannot see was logged.
    bool is_told_{false};
    OpenFiles open_;
    CallTurns turns_;
    std::uint16_t namespace_{0};
    NodeId file_type_;
    model::NodeIndex writing_{model::no_node};
    std::vector<model::NodeIndex> directory_methods_;
    std::vector<model::NodeIndex> file_methods_;
    std::vector<Method> methods_;
    /// Entries by path; the root is "".
    Entries entries_;
    /// Paths by number; empty for free numbers.
    std::vector<std::string> paths_;
    /// Capacity is reserved for all numbers, so that a removal needs no memory.
    std::vector<std::uint32_t> free_numbers_;
    /// True if a refresh was not completed.
    bool is_stale_{false};
};

/// Tells whether a client may give a file this name: a name (see is_name) that is not a path and
/// not hidden.
[[nodiscard]] bool is_file_name(std::string_view name);
/// Returns the path of the containing folder; "" for the root.
[[nodiscard]] std::string_view folder_of(std::string_view path);

} // namespace busbar::administration::detail
