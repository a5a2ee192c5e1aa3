#include <busbar/controller/model_instance.hpp>

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include <busbar/controller/mapping_extensions.hpp>
#include <busbar/core/text.hpp>
#include <busbar/core/text_forms.hpp>
#include <busbar/model/instance.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::controller {

namespace {

using model::NodeIndex;

std::string report_text(const ModelReports& reports)
{
    for (const ModelReport& report : reports.list()) {
        if (rule_of(report.code).result == ReportResult::Error) {
            return text(report);
        }
    }
    return "cannot be added";
}

/// Adds an instance to a copy of the models in an AddressSpace of its own.
class InstanceMaker {
public:
    InstanceMaker(const ModelSet& models, const NewInstance& instance)
        : models_{models}, instance_{instance}
    {
    }

    /// Loads the models; NodeIds of the ModelSet stay valid.
    [[nodiscard]] Configured<void> load();
    [[nodiscard]] Configured<void> make();
    /// Writes the file of the instance's namespace.
    [[nodiscard]] Configured<std::string> file();
    [[nodiscard]] const NodeId& node() const { return id_; }
    [[nodiscard]] std::size_t added() const { return space_.node_count() - count_before_; }

private:
    [[nodiscard]] Unexpected<Problem> refuse(const NodeId& about, std::string why) const
    {
        return misconfigured(to_string(about), std::move(why));
    }
    [[nodiscard]] std::string display_name(const NodeId& id) const
    {
        const NodeIndex node = space_.find(id);
        return node == model::no_node ? to_string(id) : to_string(space_.browse_name(node));
    }
    [[nodiscard]] Configured<void> check() const;
    [[nodiscard]] NodeId id_of_instance(NodeIndex parent) const;
    [[nodiscard]] Configured<void> explain(StatusCode status) const;
    [[nodiscard]] Configured<void> explain_type() const;
    [[nodiscard]] std::string concrete_subtypes(NodeIndex type) const;
    [[nodiscard]] model::InstanceOptions options();
    [[nodiscard]] Configured<void> check_chosen_types() const;
    [[nodiscard]] std::set<std::string> required_uris() const;
    [[nodiscard]] bool has_mapped(const std::string& uri) const;

    const ModelSet& models_;
    const NewInstance& instance_;
    model::AddressSpace space_;
    std::uint16_t index_{0};
    std::size_t count_before_{0};
    NodeId id_;
    model::InstanceFault fault_;
};

Configured<void> InstanceMaker::load()
{
    const model::AddressSpace& from = models_.space();
    for (std::size_t i = 1; i < from.namespace_count(); ++i) {
        // The count fits, because an index in the space is a UInt16.
        if (!space_.add_namespace(from.namespace_uri(static_cast<std::uint16_t>(i)))) {
            return misconfigured("instance", "there are too many namespaces");
        }
    }
    if (auto loaded = models_.load_into(space_); !loaded) {
        return misconfigured("instance", report_text(loaded.error()));
    }
    const auto index = space_.add_namespace(instance_.uri);
    if (!index) {
        return misconfigured("instance", "there are too many namespaces");
    }
    index_ = *index;
    return {};
}

Configured<void> InstanceMaker::check() const
{
    if (instance_.name.empty() || instance_.name.find('/') != std::string::npos) {
        return misconfigured(printable(instance_.name),
                             "found a name that is empty or has a slash, expected a BrowseName");
    }
    const auto& namespaces = models_.namespaces();
    const bool is_required =
        std::any_of(namespaces.begin(), namespaces.end(), [&](const auto& one) {
            return std::any_of(one.required.begin(), one.required.end(),
                               [&](const auto& each) { return each.uri == instance_.uri; });
        });
    if (is_required || index_ == 0) {
        return misconfigured(printable(instance_.uri),
                             "found a namespace that models require, whose nodes cannot be mapped, "
                             "expected one of the project's own");
    }
    const NodeIndex parent = space_.find(instance_.parent);
    if (parent == model::no_node || (space_.node_class(parent) != NodeClass::Object &&
                                     space_.node_class(parent) != NodeClass::Variable)) {
        return refuse(instance_.parent, "found no Object that an instance could be below");
    }
    const NodeIndex type = space_.find(instance_.type);
    const bool is_type =
        type != model::no_node && (space_.node_class(type) == NodeClass::ObjectType ||
                                   space_.node_class(type) == NodeClass::VariableType);
    if (!is_type) {
        return refuse(instance_.type, "found no ObjectType and no VariableType");
    }
    if (space_.is_abstract(type)) {
        return refuse(instance_.type, "found " + display_name(instance_.type) +
                                          ", which is abstract, expected a subtype of it");
    }
    return {};
}

NodeId InstanceMaker::id_of_instance(NodeIndex parent) const
{
    const NodeId above = space_.node_id(parent);
    const bool is_own = above.namespace_index() == index_ && above.id_type() == IdType::String;
    return {index_, String{(is_own ? above.string().str() + "/" : std::string{}) + instance_.name}};
}

Configured<void> InstanceMaker::explain(StatusCode status) const
{
    if (status == status::Bad_NotFound) {
        return refuse(instance_.type, "has no Optional member of a path that was asked for; "
                                      "expected BrowsePaths as Identification/SerialNumber");
    }
    if (status == status::Bad_TypeDefinitionInvalid && !fault_.path.empty()) {
        return explain_type();
    }
    if (status == status::Bad_TooManyOperations) {
        return refuse(instance_.type,
                      "found more than 10,000 members, or 16 levels of them; choose fewer Optional "
                      "ones");
    }
    return refuse(instance_.type, "cannot be instantiated: " + std::string{name(status)});
}

/// Names some of the types that a member of this abstract type can have.
std::string InstanceMaker::concrete_subtypes(NodeIndex type) const
{
    constexpr std::size_t most = 8;
    std::size_t count = 0;
    std::string names;
    space_.for_each([&](NodeIndex node) {
        if (node == type || space_.is_abstract(node) || !space_.is_subtype_of(node, type)) {
            return;
        }
        if (++count <= most) {
            names += (names.empty() ? "" : ", ") + space_.browse_name(node).name.str();
        }
    });
    return count > most ? names + " and " + std::to_string(count - most) + " more" : names;
}

Configured<void> InstanceMaker::explain_type() const
{
    const std::string declared = display_name(fault_.declared_type);
    const auto chosen = std::find_if(instance_.types.begin(), instance_.types.end(),
                                     [&](const auto& each) { return each.first == fault_.path; });
    const std::string names = concrete_subtypes(space_.find(fault_.declared_type));
    std::string why = "has the member " + printable(fault_.path);
    if (chosen != instance_.types.end()) {
        why += ", for which the type " + display_name(chosen->second) +
               " was chosen, expected a subtype of " + declared + " that is not abstract";
        return refuse(instance_.type, names.empty() ? why : why + ": " + names);
    }
    why += " of the abstract type " + declared;
    if (names.empty()) {
        return refuse(instance_.type, why +
                                          ", of which no model has a subtype that is not abstract; "
                                          "import the model that has one");
    }
    return refuse(instance_.type, why + "; choose one of its subtypes for it (--type " +
                                      printable(fault_.path) + "=TYPE): " + names);
}

model::InstanceOptions InstanceMaker::options()
{
    model::InstanceOptions options;
    options.optional = instance_.optional;
    options.all_optional = instance_.has_all_optional;
    options.types = instance_.types;
    options.methods = model::InstanceMethods::Copied;
    options.fault = &fault_;
    return options;
}

Configured<void> InstanceMaker::check_chosen_types() const
{
    for (const auto& [path, type] : instance_.types) {
        const NodeIndex member = model::find_by_path(space_, space_.find(id_), path);
        const bool is_member = member != model::no_node;
        if (is_member && space_.type_definition(member) == space_.find(type)) {
            continue;
        }
        return refuse(instance_.type,
                      is_member ? "has the member " + printable(path) + " of the type " +
                                      display_name(space_.node_id(space_.type_definition(member))) +
                                      " already, which stays"
                                : "gets no member " + printable(path) +
                                      ", for which a type was chosen; expected the BrowsePath of a "
                                      "Mandatory member or of an Optional one that was chosen");
    }
    return {};
}

Configured<void> InstanceMaker::make()
{
    if (auto checked = check(); !checked) {
        return checked;
    }
    count_before_ = space_.node_count();
    const NodeIndex parent = space_.find(instance_.parent);
    const NodeIndex type = space_.find(instance_.type);
    id_ = id_of_instance(parent);
    if (const NodeIndex there = space_.find(id_); there != model::no_node) {
        if (space_.type_definition(there) != type) {
            return refuse(id_, "already exists with another type, expected " +
                                   display_name(instance_.type));
        }
        const auto added = model::add_optional(space_, there, options());
        return added ? check_chosen_types() : explain(added.error());
    }
    model::NewNode node;
    node.id = id_;
    node.browse_name = QualifiedName{index_, String{instance_.name}};
    node.parent = parent;
    const auto made = model::instantiate(space_, node, type, options());
    return made ? check_chosen_types() : explain(made.error());
}

/// Collects the URIs of all namespaces that nodes of this namespace refer to.
std::set<std::string> InstanceMaker::required_uris() const
{
    std::set<std::uint16_t> used;
    space_.for_each([&](NodeIndex node) {
        if (space_.node_id(node).namespace_index() != index_) {
            return;
        }
        used.insert(space_.browse_name(node).namespace_index);
        if (space_.node_class(node) == NodeClass::Variable) {
            used.insert(space_.data_type_id(node).namespace_index());
        }
        auto references = space_.references(node);
        while (const auto reference = references.next()) {
            used.insert(space_.node_id(reference->target).namespace_index());
            used.insert(space_.node_id(reference->type).namespace_index());
        }
    });
    std::set<std::string> uris;
    for (const std::uint16_t index : used) {
        if (index != index_) {
            uris.emplace(space_.namespace_uri(index));
        }
    }
    return uris;
}

bool InstanceMaker::has_mapped(const std::string& uri) const
{
    const auto nodes = mapped_nodes(models_.mapping());
    return std::any_of(nodes.begin(), nodes.end(), [&](const NodeId& id) {
        return models_.space().namespace_uri(id.namespace_index()) == uri;
    });
}

Configured<std::string> InstanceMaker::file()
{
    const std::array<std::uint16_t, 1> own{index_};
    model::NodeSetExtras extras = models_.extras();
    write_mapping(models_.mapping(), own, extras);
    auto model = std::find_if(extras.models.begin(), extras.models.end(),
                              [&](const auto& each) { return each.uri == instance_.uri; });
    if (model == extras.models.end()) {
        model = extras.models.insert(model, model::NodeSetModel{});
        model->uri = instance_.uri;
    }
    for (const std::string& uri : required_uris()) {
        const bool is_there = std::any_of(model->required.begin(), model->required.end(),
                                          [&](const auto& each) { return each.uri == uri; });
        if (is_there) {
            continue;
        }
        if (has_mapped(uri)) {
            return misconfigured(printable(uri),
                                 "has nodes that are mapped, which they could not be if " +
                                     printable(instance_.uri) +
                                     " required it; expected the instance in the same namespace");
        }
        model->required.emplace_back().uri = uri;
    }
    auto text = model::write_nodeset(space_, own, extras);
    if (!text) {
        return misconfigured(printable(instance_.uri), std::string{name(text.error())});
    }
    return *std::move(text);
}

std::string file_name(const ModelSet& models, const std::string& uri)
{
    std::vector<std::string> taken;
    for (const ModelFile& file : models.files()) {
        if (file.uri == uri) {
            return file.name;
        }
        taken.push_back(file.name.substr(0, file.name.rfind('.')));
    }
    return default_file_name(uri, taken) + ".xml";
}

} // namespace

Configured<InstanceResult> add_instance(ModelSet& models, const NewInstance& instance)
{
    InstanceMaker maker{models, instance};
    auto file =
        maker.load().and_then([&] { return maker.make(); }).and_then([&] { return maker.file(); });
    if (!file) {
        return Unexpected{std::move(file.error())};
    }
    const std::size_t added = maker.added();
    const auto imported = models.import({file_name(models, instance.uri), *std::move(file)});
    if (!imported) {
        return misconfigured(printable(instance.uri), report_text(imported.error()));
    }
    NodeId node = maker.node();
    node.set_namespace_index(models.space().namespace_index(instance.uri).value_or(0));
    return InstanceResult{std::move(node), added};
}

} // namespace busbar::controller
