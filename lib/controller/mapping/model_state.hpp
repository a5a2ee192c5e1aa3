#pragma once

#include <optional>

#include <busbar/controller/model_set.hpp>

#include "model_header.hpp"

namespace busbar::controller {

/// What a ModelSet has. A change makes a new one and takes it if all went well.
struct ModelSet::State {
    ModelLimits limits;
    std::string application_uri;
    std::vector<ModelFile> files;
    /// Of each file.
    std::vector<detail::ModelHeader> headers;
    model::AddressSpace space;
    model::NodeSetExtras extras;
    Mapping mapping;
    std::vector<ModelNamespace> namespaces;
    /// Nodes that the space had before any file.
    std::size_t built_in{0};

    /// Loads the files into the space, which has nothing yet. `imported` is the position of the
    /// file that is new; what is wrong with another one is wrong because of it.
    [[nodiscard]] bool load(std::size_t imported, model::NodeSetSummary& summary,
                            ModelReports& reports);
    /// Adds a file to what is loaded, so that a project of many files takes time in proportion to
    /// them. Nothing, and all is as before, if that is impossible or something is wrong: loading
    /// all files anew tells. Moves from file and header if it was done.
    [[nodiscard]] std::optional<ImportResult> add(ModelFile& file, detail::ModelHeader& header);
    /// Takes what a file has beside its nodes.
    void keep(model::NodeSetExtras& loaded);
    /// Also where what is imported is another version than files require that were there before.
    void note_versions(std::string_view imported, ModelReports& reports) const;
    void list_namespaces();
    void list_namespace(const detail::ModelHeader& header);
    [[nodiscard]] ModelState state_of_required(const detail::HeaderModel& required) const;
    [[nodiscard]] std::uint64_t file_size() const;
    /// With the nodes that it has already.
    [[nodiscard]] std::size_t node_count() const { return space.node_count() - built_in; }

private:
    /// Whether the file, with what it needs, makes the same of the space as if all were loaded
    /// again: its namespace is a new one and the only one.
    [[nodiscard]] bool can_add(const ModelFile& file, const detail::ModelHeader& header) const;
    [[nodiscard]] bool has_file(std::string_view uri) const;
};

} // namespace busbar::controller
