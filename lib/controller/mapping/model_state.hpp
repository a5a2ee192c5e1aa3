#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/model_limits.hpp>
#include <busbar/controller/model_report.hpp>
#include <busbar/controller/model_set.hpp>
#include <busbar/core/expected.hpp>
#include <busbar/model/nodeset.hpp>

namespace busbar::controller::detail {

struct HeaderModel {
    std::string uri;
    std::string version;
    std::string publication_date;
    /// Follows semantic versioning; empty in older files.
    std::string model_version{};
};

/// Describes a file before its nodes are loaded.
struct ModelHeader {
    HeaderModel model;
    std::vector<HeaderModel> required;
    /// URIs of the namespaces that the file names; nodes need not be in all of them.
    std::vector<std::string> named;
};

/// Reads the header of a file with one namespace; other errors of the file show when it is loaded.
[[nodiscard]] Expected<ModelHeader, ModelReport> read_header(std::string_view text,
                                                             const std::string& name);

/// Reads the text of a source, whose file may have at most so many bytes.
[[nodiscard]] Expected<std::string, ModelReport> read_source(const model::NodeSetSource& source,
                                                             std::uint64_t max_size);

} // namespace busbar::controller::detail

namespace busbar::controller {

/// Adds what the loading of a file noted and repaired.
void note_defects(const model::NodeSetSummary& summary, ModelReports& reports);

/// The state of a ModelSet. A change builds a new state and adopts it if everything succeeded.
struct ModelSet::State {
    ModelLimits limits;
    std::string application_uri;
    std::vector<ModelFile> files;
    /// One for each file.
    std::vector<detail::ModelHeader> headers;
    model::AddressSpace space;
    model::NodeSetExtras extras;
    Mapping mapping;
    std::vector<ModelNamespace> namespaces;
    /// Namespaces with nodes whose RolePermissions are not those of their file.
    std::set<std::uint16_t> with_other_roles;
    /// Number of nodes before any file was loaded.
    std::size_t built_in{0};

    /// Loads the files into the space, which must be empty. `imported` is the position of the new
    /// file; errors in other files are consequences of it.
    [[nodiscard]] bool load(std::size_t imported, model::NodeSetSummary& summary,
                            ModelReports& reports);
    /// Adds a file to the loaded ones, so that a project of many files loads in linear time.
    /// Returns nothing, with the state unchanged, if that is impossible or there is an error; then
    /// load all files again to report it. On success file and header are moved from.
    [[nodiscard]] std::optional<ImportResult> add(ModelFile& file, detail::ModelHeader& header);
    /// Returns the file's text, with the present RolePermissions.
    [[nodiscard]] std::string text_of(const ModelFile& file) const;
    void set_roles(model::NodeIndex node, Array<RolePermissionType> roles);
    /// Keeps the RolePermissions that nodes of the imported namespace had before the import, where
    /// the file has none, and reports where it has others.
    void keep_roles(const State& before, std::string_view uri, ModelReports& reports);
    /// Keeps everything in a file besides its nodes.
    void keep(model::NodeSetExtras& loaded);
    /// Notes where files require another version than the imported one, including files that were
    /// there before.
    void note_versions(std::string_view imported, ModelReports& reports) const;
    void list_namespaces();
    void list_namespace(const detail::ModelHeader& header);
    [[nodiscard]] ModelState state_of_required(const detail::HeaderModel& required) const;
    [[nodiscard]] std::uint64_t file_size() const;
    /// Number of nodes, including those added so far.
    [[nodiscard]] std::size_t node_count() const { return space.node_count() - built_in; }

private:
    /// True if adding the file gives the same space as loading all files again: its namespace is
    /// new and its only one.
    [[nodiscard]] bool can_add(const ModelFile& file, const detail::ModelHeader& header) const;
    [[nodiscard]] bool has_file(std::string_view uri) const;
};

} // namespace busbar::controller
