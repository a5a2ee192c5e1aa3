#include <algorithm>
#include <unordered_map>
#include <vector>

#include <busbar/core/text.hpp>
#include <busbar/model/nodeset.hpp>
#include <model/graft.hpp>

#include "data_types.hpp"
#include "load_plan.hpp"
#include "mender.hpp"
#include "node_flags.hpp"
#include "value_fit.hpp"
#include "value_reader.hpp"
#include "xml_text.hpp"

namespace busbar::nodeset {

namespace {

using model::NodeIndex;
using model::NodeSetSummary;
using model::detail::Graft;
using model::detail::NodeRecord;

std::vector<std::string> namespaces_of(const model::SpaceReader& space)
{
    std::vector<std::string> uris;
    for (std::size_t i = 0; i < space.namespace_count(); ++i) {
        uris.emplace_back(space.namespace_uri(static_cast<std::uint16_t>(i)));
    }
    return uris;
}

/// The types of namespace 0 by their BrowseNames, which are the usual aliases.
std::unordered_map<std::string, NodeId> names_of_types(const model::SpaceReader& space)
{
    std::unordered_map<std::string, NodeId> names;
    space.for_each([&](NodeIndex node) {
        if (!model::detail::is_type(space.node_class(node))) {
            return;
        }
        const NodeId id = space.node_id(node);
        if (id.namespace_index() == 0) {
            names.emplace(space.browse_name(node).name.str(), id);
        }
    });
    return names;
}

busbar::LocalizedText record_text(const LocalizedText& text)
{
    return {text.locale.empty() ? String{} : String{text.locale}, String{text.text}};
}

/// Adds the checked nodes of a Document to an AddressSpace, all or none.
class Loader {
public:
    Loader(Document& document, model::AddressSpace& space, LoadPlan& plan)
        : document_{document}, space_{space}, plan_{plan}, graft_{space}, types_{document},
          indices_(document.nodes().size(), model::no_node)
    {
        add_data_types(space, types_);
    }

    /// Returns false, with errors in the plan, if nothing was added.
    [[nodiscard]] bool run();
    [[nodiscard]] NodeSetSummary summary() const;

private:
    [[nodiscard]] bool create();
    void fill(const Node& node, NodeRecord& record);
    void fill_variable(const Node& node, NodeRecord& record);
    void set_access(const Node& node, NodeIndex index);
    void add_texts(const Node& node, NodeIndex index);
    void set_restrictions();
    void add_references(const Node& node, NodeIndex index);
    void fit_values();
    void fit_value(const Node& node, NodeIndex index, const Variant& value);
    void fail(const Node& node, std::string message, std::uint32_t line = 0)
    {
        plan_.add_error(document_.problem(node, std::move(message), line));
    }
    void note(const Node& node, std::string message, std::uint32_t line)
    {
        plan_.add_note(document_.problem(node, std::move(message), line));
    }
    void repair(model::NodeSetRule rule, const Node& node, std::string done, std::uint32_t line)
    {
        document_.add_repair(rule, document_.problem(node, std::move(done), line));
    }
    [[nodiscard]] NodeIndex find(const NodeId& id) const { return space_.find(id); }

    Document& document_;
    model::AddressSpace& space_;
    LoadPlan& plan_;
    Graft graft_;
    DataTypeTable types_;
    std::size_t fields_left_{document_.limits().max_value_fields};
    /// Indices by position in the document.
    std::vector<NodeIndex> indices_;
};

bool Loader::run()
{
    if (!create()) {
        return false;
    }
    const auto& nodes = document_.nodes();
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (indices_[i] != model::no_node) {
            fill(nodes[i], graft_.record(indices_[i]));
            set_access(nodes[i], indices_[i]);
            add_texts(nodes[i], indices_[i]);
        }
        // An old node of namespace 0 may refer to a new one.
        add_references(nodes[i], find(nodes[i].id));
    }
    graft_.link();
    fit_values();
    if (!plan_.errors().empty()) {
        return false;
    }
    set_restrictions();
    graft_.keep();
    return true;
}

bool Loader::create()
{
    for (const std::string& uri : document_.namespaces()) {
        if (!graft_.add_namespace(uri)) {
            plan_.add_error(problem_at(uri, 0, "there is no room for another namespace"));
            return false;
        }
    }
    const auto& nodes = document_.nodes();
    graft_.reserve(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const Node& node = nodes[i];
        if (plan_.is_skipped(node)) {
            continue;
        }
        const QualifiedName name{node.browse_namespace, String::borrow(node.browse_name)};
        const auto created =
            graft_.create(node.id, name, static_cast<busbar::NodeClass>(node.node_class));
        if (!created) {
            fail(node, "the address space has no room for the node");
            return false;
        }
        indices_[i] = *created;
    }
    return true;
}

void Loader::fill(const Node& node, NodeRecord& record)
{
    record.flags = flags(node);
    record.event_notifier = node.event_notifier;
    if (!node.display_name.locale.empty() || node.display_name.text != node.browse_name) {
        record.make_extra().display_name = record_text(node.display_name);
    }
    if (!node.description.text.empty()) {
        record.make_extra().description = record_text(node.description);
    }
    if (node.node_class == NodeClass::ReferenceType && !node.inverse_name.text.empty()) {
        record.make_extra().inverse_name = record_text(node.inverse_name);
    }
    if (node.node_class == NodeClass::DataType) {
        ExtensionObject definition = definition_of(types_, *types_.find(node.id));
        if (!definition.is_null()) {
            record.make_extra().definition = std::move(definition);
        }
    }
    if (node.node_class == NodeClass::Variable || node.node_class == NodeClass::VariableType) {
        fill_variable(node, record);
    }
}

void Loader::fill_variable(const Node& node, NodeRecord& record)
{
    record.data_type = find(node.data_type);
    record.value_rank = node.value_rank;
    record.minimum_sampling_interval = node.minimum_sampling_interval;
    if (node.node_class == NodeClass::Variable) {
        record.access_level = static_cast<std::uint8_t>(node.access_level);
        record.user_access_level = record.access_level;
    }
    if (!node.array_dimensions.empty()) {
        record.make_extra().array_dimensions = Array<std::uint32_t>{node.array_dimensions};
    }
    if (!node.value) {
        return;
    }
    XmlValueReader reader{types_, document_.files()[node.file].namespaces, fields_left_};
    if (document_.is_lenient(node)) {
        reader.take_names(document_.published_names());
    }
    Variant value = reader.variant(*node.value);
    if (const Element* const named = reader.named()) {
        repair(model::NodeSetRule::Alias, node,
               "took " + quoted(named->text) + " and the like in a value for DataTypes",
               named->line);
    }
    if (!reader.error().empty()) {
        if (document_.is_lenient(node)) {
            repair(model::NodeSetRule::ValueRemoved, node, "left out a value: " + reader.error(),
                   reader.error_line());
        } else {
            fail(node, reader.error(), reader.error_line());
        }
    } else if (!value.is_null()) {
        record.make_extra().value = std::move(value);
    }
}

namespace {

Array<RolePermissionType> permissions_of(const std::vector<model::NodeSetPermission>& from)
{
    Array<RolePermissionType> permissions;
    permissions.clear(); // not null
    for (const model::NodeSetPermission& each : from) {
        permissions.push_back({each.role, PermissionType{each.permissions}});
    }
    return permissions;
}

} // namespace

void Loader::set_access(const Node& node, NodeIndex index)
{
    model::NodeAccess access;
    access.write_mask = node.write_mask;
    access.restrictions = node.access_restrictions;
    if (node.node_class == NodeClass::Variable) {
        access.more_access_levels = node.access_level & ~std::uint32_t{UINT8_MAX};
    }
    if (node.role_permissions) {
        access.role_permissions = permissions_of(*node.role_permissions);
    }
    if (!(access == model::NodeAccess{})) {
        graft_.set_access(index, std::move(access));
    }
}

void Loader::add_texts(const Node& node, NodeIndex index)
{
    for (const FurtherText& further : node.further_texts) {
        const auto known = space_.texts(index, further.attribute);
        if (std::any_of(known.begin(), known.end(), [&](const busbar::LocalizedText& each) {
                return each.locale.view() == further.text.locale;
            })) {
            note(node,
                 "left out a second text of one attribute for the locale '" + further.text.locale +
                     "'",
                 further.line);
        } else if (!space_.set_text(index, further.attribute, Variant{record_text(further.text)})) {
            note(node, "left out a text of an attribute that the node does not have", further.line);
        }
    }
}

/// Sets a model's restrictions for the nodes of its namespace that have none of their own (Part 6,
/// F.5). Those of namespace 0 are the server's decision.
void Loader::set_restrictions()
{
    for (const Model& model : document_.models()) {
        const auto index = space_.namespace_index(model.uri);
        if (!index || *index == 0) {
            continue;
        }
        if (model.access_restrictions) {
            space_.set_namespace_restrictions(*index, *model.access_restrictions);
        }
        if (!model.role_permissions.empty()) {
            space_.set_namespace_permissions(*index, permissions_of(model.role_permissions));
        }
    }
}

void Loader::add_references(const Node& node, NodeIndex index)
{
    for (const Reference& reference : node.references) {
        const NodeIndex type = find(reference.type);
        const NodeIndex other = find(reference.target);
        // A reference that leads nowhere is in the notes.
        if (type != model::no_node && other != model::no_node) {
            graft_.add_reference(reference.is_forward ? index : other, type,
                                 reference.is_forward ? other : index);
        }
    }
}

/// A Read must not return what a Write of the same client would be refused for.
void Loader::fit_values()
{
    for (std::size_t i = 0; i < indices_.size(); ++i) {
        const Node& node = document_.nodes()[i];
        if (indices_[i] == model::no_node || !node.value) {
            continue;
        }
        const Variant value = space_.value(indices_[i]);
        if (!value.is_null()) {
            fit_value(node, indices_[i], value);
        }
    }
}

void Loader::fit_value(const Node& node, NodeIndex index, const Variant& value)
{
    const auto attributes = space_.variable(index);
    const auto fits = [&](const Variant& form) {
        return space_
            .check_value(form, attributes.data_type, attributes.value_rank,
                         attributes.array_dimensions)
            .is_good();
    };
    if (fits(value)) {
        return;
    }
    Variant& kept = graft_.record(index).make_extra().value;
    if (Variant matrix = with_dimensions(value, attributes); fits(matrix)) {
        kept = std::move(matrix);
        return;
    }
    const std::string found = "a value <" + printable(node.value->name, 80) + ">";
    const std::string expected = "the DataType " + plan_.text(node.data_type) + ", ValueRank " +
                                 std::to_string(node.value_rank) +
                                 " and ArrayDimensions of the node";
    if (!document_.is_lenient(node)) {
        fail(node, "found " + found + ", expected one of " + expected, node.value->line);
        return;
    }
    const std::vector<std::uint32_t> any(value.is_matrix() ? value.dimensions().size() : 1);
    if (space_.check_value(value, attributes.data_type, attributes.value_rank, any).is_good()) {
        graft_.record(index).make_extra().array_dimensions = Array<std::uint32_t>{any};
        repair(model::NodeSetRule::ArrayDimensions, node,
               "set ArrayDimensions to 0, which " + found + " does not fit", node.value->line);
        return;
    }
    kept = converted(space_, types_, value, attributes);
    if (kept.is_null()) {
        repair(model::NodeSetRule::ValueRemoved, node,
               "left out " + found + ", which does not fit " + expected, node.value->line);
    } else {
        repair(model::NodeSetRule::ValueConverted, node, "converted " + found + " to " + expected,
               node.value->line);
    }
}

NodeSetSummary Loader::summary() const
{
    NodeSetSummary result;
    result.notes = plan_.notes();
    result.repairs = document_.repairs();
    result.repair_counts = document_.repair_counts();
    result.extras.models = document_.models();
    for (std::size_t i = 0; i < indices_.size(); ++i) {
        const Node& node = document_.nodes()[i];
        if (indices_[i] == model::no_node) {
            ++result.skipped_count;
            continue;
        }
        ++result.node_count;
        result.namespaces.push_back(node.id.namespace_index());
        if (node.extras != nullptr) {
            result.extras.nodes.emplace(node.id, *node.extras);
        }
    }
    auto& indices = result.namespaces;
    std::sort(indices.begin(), indices.end());
    indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
    std::vector<bool> was_there(document_.files().size());
    for (const Model& model : document_.models()) {
        const std::string& extensions = document_.files()[model.file].extensions;
        if (!extensions.empty() && !was_there[model.file]) {
            result.extras.file_extensions.emplace(model.uri, extensions);
        }
        was_there[model.file] = true;
    }
    return result;
}

} // namespace

} // namespace busbar::nodeset

namespace busbar::model {

Expected<NodeSetSummary, std::vector<Problem>> load_nodesets(AddressSpace& space,
                                                             std::span<const NodeSetSource> sources,
                                                             const NodeSetLimits& limits)
{
    nodeset::Document document{limits, nodeset::namespaces_of(space)};
    const bool has_lenient = std::any_of(sources.begin(), sources.end(),
                                         [](const NodeSetSource& each) { return each.is_lenient; });
    if (has_lenient) {
        document.set_published_names(nodeset::names_of_types(space));
    }
    std::vector<Problem> errors;
    for (const NodeSetSource& source : sources) {
        auto found = source.text ? document.load_text(*source.text, source.name, source.is_lenient)
                                 : document.load_file(source.name, source.is_lenient);
        errors.insert(errors.end(), found.begin(), found.end());
    }
    if (errors.empty()) {
        errors = nodeset::missing_models(document, space);
    }
    if (errors.empty()) {
        nodeset::LoadPlan plan{document, space};
        if (has_lenient) {
            nodeset::Mender{document, plan}.mend();
        }
        plan.check();
        if (plan.errors().empty()) {
            nodeset::Loader loader{document, space, plan};
            if (loader.run()) {
                return loader.summary();
            }
        }
        errors = plan.errors();
    }
    errors.resize(std::min(errors.size(), std::max<std::size_t>(limits.max_errors, 1)));
    return Unexpected{std::move(errors)};
}

} // namespace busbar::model
