#pragma once

#include <vector>

#include <busbar/model/nodeset.hpp>

#include "value_writer.hpp"

namespace busbar::nodeset {

/// Writes the nodes of some namespaces of an AddressSpace.
class NodeWriter {
public:
    NodeWriter(const model::SpaceReader& space, std::span<const std::uint16_t> namespaces,
               const model::NodeSetExtras& extras);

    /// The whole file.
    [[nodiscard]] std::string write();

private:
    [[nodiscard]] bool is_written(const NodeId& id) const
    {
        return id.namespace_index() < is_written_.size() && is_written_[id.namespace_index()];
    }
    [[nodiscard]] std::string text(const NodeId& id) { return to_string(local_(id)); }
    void node(model::NodeIndex index);
    void attributes(model::NodeIndex index, const model::NodeSetNodeExtras& extras);
    void variable_attributes(model::NodeIndex index);
    void access_attributes(model::NodeIndex index);
    [[nodiscard]] std::vector<model::NodeSetPermission>
    permissions_of(model::NodeIndex index) const;
    void type_attributes(model::NodeIndex index);
    void flag_attribute(model::NodeIndex index, AttributeId id, const char* name, bool otherwise);
    void localized(const char* name, const busbar::LocalizedText& text);
    void names(model::NodeIndex index);
    void references(model::NodeIndex index);
    [[nodiscard]] bool is_listed(model::NodeIndex index, const model::Reference& reference) const;
    void definition(model::NodeIndex index, const model::NodeSetNodeExtras& extras);
    void field(const Field& field, std::size_t position, bool is_structure,
               const model::NodeSetNodeExtras& extras);
    void value(model::NodeIndex index);

    // The head of the file, which needs all namespaces (file_writer.cpp).
    void namespaces(XmlOut& out) const;
    void models(XmlOut& out);
    void model(XmlOut& out, const char* element, const model::NodeSetModel& model);
    void permissions(XmlOut& out, const std::vector<model::NodeSetPermission>& permissions);

    const model::SpaceReader& space_;
    const model::NodeSetExtras& extras_;
    DataTypeTable types_;
    FileNamespaces local_;
    XmlOut out_;
    ValueWriter values_;
    std::vector<bool> is_written_;
    /// Namespaces whose models require one that is written.
    std::vector<bool> requires_written_;
};

} // namespace busbar::nodeset
