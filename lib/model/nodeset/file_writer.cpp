#include <algorithm>

#include "data_types.hpp"
#include "node_writer.hpp"

namespace busbar::nodeset {

NodeWriter::NodeWriter(const model::SpaceReader& space, std::span<const std::uint16_t> namespaces,
                       const model::NodeSetExtras& extras)
    : space_{space}, extras_{extras}, values_{types_, local_, out_},
      is_written_(space.namespace_count()), requires_written_(space.namespace_count())
{
    add_data_types(space, types_);
    for (const std::uint16_t index : namespaces) {
        is_written_[index] = true;
        static_cast<void>(local_(index));
    }
    // Include models that require one that requires a written one, and so on.
    bool has_changed = true;
    while (has_changed) {
        has_changed = false;
        for (const model::NodeSetModel& model : extras.models) {
            const auto own = space.namespace_index(model.uri);
            if (!own || is_written_[*own] || requires_written_[*own]) {
                continue;
            }
            const bool needs = std::any_of(
                model.required.begin(), model.required.end(), [&](const auto& required) {
                    const auto index = space.namespace_index(required.uri);
                    return index && *index != 0 &&
                           (is_written_[*index] || requires_written_[*index]);
                });
            requires_written_[*own] = needs;
            has_changed = has_changed || needs;
        }
    }
}

std::string NodeWriter::write()
{
    space_.for_each([&](model::NodeIndex index) {
        if (is_written(space_.node_id(index))) {
            node(index);
        }
    });
    XmlOut models_out;
    models(models_out);
    // First in the file, but known last.
    XmlOut namespaces_out;
    namespaces(namespaces_out);
    return "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n"
           "<UANodeSet xmlns=\"http://opcfoundation.org/UA/2011/03/UANodeSet.xsd\">\n" +
           namespaces_out.take() + '\n' + models_out.take() + '\n' + out_.take() +
           "\n</UANodeSet>\n";
}

void NodeWriter::namespaces(XmlOut& out) const
{
    out.begin("NamespaceUris");
    for (const std::uint16_t index : local_.used()) {
        if (index != 0) {
            out.element("Uri", space_.namespace_uri(index));
        }
    }
    out.end();
}

void NodeWriter::models(XmlOut& out)
{
    out.begin("Models");
    std::string extensions;
    for (const model::NodeSetModel& entry : extras_.models) {
        const auto index = space_.namespace_index(entry.uri);
        if (!index || !is_written_[*index]) {
            continue;
        }
        model(out, "Model", entry);
        const auto found = extras_.file_extensions.find(entry.uri);
        extensions += found == extras_.file_extensions.end() ? std::string{} : found->second;
    }
    out.end();
    if (!extensions.empty()) {
        out.begin("Extensions");
        out.xml(extensions);
        out.end();
    }
}

void NodeWriter::model(XmlOut& out, const char* element, const model::NodeSetModel& from)
{
    out.begin(element);
    const auto attribute = [&](const char* name, const std::string& value) {
        if (!value.empty()) {
            out.attribute(name, value);
        }
    };
    attribute("ModelUri", from.uri);
    attribute("Version", from.version);
    attribute("ModelVersion", from.model_version);
    attribute("PublicationDate", from.publication_date);
    for (const model::NodeSetAttribute& more : from.attributes) {
        if (is_xml_name(more.name)) {
            out.attribute(more.name, more.value);
        }
    }
    permissions(out, from.role_permissions);
    for (const model::NodeSetModel& required : from.required) {
        model(out, "RequiredModel", required);
    }
    out.end();
}

void NodeWriter::permissions(XmlOut& out, const std::vector<model::NodeSetPermission>& permissions)
{
    if (permissions.empty()) {
        return;
    }
    out.begin("RolePermissions");
    for (const model::NodeSetPermission& permission : permissions) {
        out.begin("RolePermission");
        out.attribute("Permissions", std::to_string(permission.permissions));
        out.text(text(permission.role));
        out.end();
    }
    out.end();
}

} // namespace busbar::nodeset

namespace busbar::model {

Result<std::string> write_nodeset(const SpaceReader& space,
                                  std::span<const std::uint16_t> namespaces,
                                  const NodeSetExtras& extras)
{
    for (const std::uint16_t index : namespaces) {
        if (index >= space.namespace_count()) {
            return fail(status::Bad_NotFound);
        }
    }
    return nodeset::NodeWriter{space, namespaces, extras}.write();
}

} // namespace busbar::model
