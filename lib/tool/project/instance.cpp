#include <string>
#include <utility>
#include <vector>

#include <busbar/controller/mapping_table.hpp>
#include <busbar/controller/model_instance.hpp>
#include <busbar/controller/project_models.hpp>
#include <busbar/core/text_forms.hpp>

#include "commands.hpp"
#include "tool/admin/commands.hpp"
#include "tool/printing/display_text.hpp"

namespace busbar::tool::project {

namespace {

using controller::ModelSet;
using model::NodeIndex;

constexpr const char* own_uri = "urn:busbar:instances";

/// Types of that name, of whatever namespace.
std::vector<NodeId> types_named(const model::SpaceReader& space, std::string_view name)
{
    std::vector<NodeId> found;
    space.for_each([&](NodeIndex node) {
        const NodeClass is = space.node_class(node);
        if ((is == NodeClass::ObjectType || is == NodeClass::VariableType) &&
            space.browse_name(node).name.view() == name) {
            found.push_back(space.node_id(node));
        }
    });
    return found;
}

NodeId type_named(const ModelSet& models, const std::string& text)
{
    if (const NodeIndex node = controller::find_table_node(text, models.space());
        node != model::no_node) {
        return models.space().node_id(node);
    }
    const std::vector<NodeId> found = types_named(models.space(), text);
    if (found.empty()) {
        throw Failure{Exit::Failed, safe(text) + ": there is no such type in the models",
                      "expected the name of an ObjectType or VariableType, or its NodeId"};
    }
    if (found.size() > 1) {
        Failure failure{Exit::Failed, safe(text) + ": several types have this name",
                        "give the NodeId of one"};
        for (const NodeId& id : found) {
            failure.candidates.push_back(to_string(id));
        }
        throw Failure{std::move(failure)};
    }
    return found.front();
}

/// Reads "PATH=TYPE".
std::pair<std::string, NodeId> type_choice(const ModelSet& models, const std::string& text)
{
    const std::size_t end = text.find('=');
    if (end == 0 || end == std::string::npos || end + 1 == text.size()) {
        throw Failure{Exit::Usage, "--type " + safe(text) + " is not a choice of a type",
                      "expected PATH=TYPE, as Axis/Motor=ServoMotorType"};
    }
    return {text.substr(0, end), type_named(models, text.substr(end + 1))};
}

/// "PackMLBaseObject" of a PackMLBaseObjectType.
std::string default_name(const model::SpaceReader& space, const NodeId& type)
{
    std::string name{space.browse_name(space.find(type)).name.view()};
    constexpr std::string_view ending = "Type";
    if (name.size() > ending.size() && name.ends_with(ending)) {
        name.resize(name.size() - ending.size());
    }
    return name;
}

Exit add_one(Context& context, const ProjectArguments& arguments)
{
    const auto& words = arguments.words;
    controller::Project project = open_project(words[0]);
    ModelSet models = open_models(project);
    const NodeIndex parent = controller::find_table_node(words[1], models.space());
    if (parent == model::no_node) {
        throw Failure{Exit::Failed, safe(words[1]) + ": there is no such node",
                      "expected the node that the instance is below, as /Objects"};
    }
    controller::NewInstance instance;
    instance.parent = models.space().node_id(parent);
    instance.type = type_named(models, words[2]);
    instance.name = words.size() > 3 ? words[3] : default_name(models.space(), instance.type);
    instance.uri = arguments.uri.empty() ? own_uri : arguments.uri;
    instance.optional = arguments.optional;
    instance.has_all_optional = arguments.has_all_optional;
    for (const std::string& choice : arguments.types) {
        instance.types.push_back(type_choice(models, choice));
    }
    const auto made = controller::add_instance(models, instance);
    if (!made) {
        throw Failure{Exit::Failed, safe(text(made.error())), "the project is as it was"};
    }
    controller::keep_models(models, project);
    save_project(words[0], project);
    NodeId plain = made->node;
    plain.set_namespace_index(0);
    const std::string id = to_string(ExpandedNodeId{plain, String{instance.uri}});
    return admin::report(context, made->added == 0 ? safe(id) + " has all of it"
                                                   : safe(id) + ": " + std::to_string(made->added) +
                                                         " nodes added");
}

} // namespace

void add_instances(CLI::App& project, Run& run)
{
    const auto arguments = std::make_shared<ProjectArguments>();
    auto* command = add_offline(project, run, "instance",
                                "Adds an instance of a model's type below NODE, or what it lacks.",
                                3, 4, "FILE NODE TYPE [NAME]", add_one, arguments);
    command
        ->add_option("--optional", arguments->optional,
                     "an Optional member by its path, as Identification/SerialNumber; repeat it "
                     "for more")
        ->type_name("PATH");
    command->add_flag("--all-optional", arguments->has_all_optional,
                      "all Optional members, but for those of abstract types without a choice");
    command
        ->add_option("--type", arguments->types,
                     "the type of a member, by its path, where the model has an abstract one; "
                     "repeat it for more")
        ->type_name("PATH=TYPE");
    command
        ->add_option("--namespace", arguments->uri,
                     "of its nodes, instead of " + std::string{own_uri})
        ->type_name("URI");
}

} // namespace busbar::tool::project
