#include "setting_nodes.hpp"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/types/ids.hpp>

#include "method_arguments.hpp"
#include "method_record.hpp"
#include "permissions.hpp"
#include "rights.hpp"

namespace busbar::administration::detail {

namespace {

using server::MethodCall;

constexpr std::string_view root_name = "Settings";

Thing thing_of(const Setting& setting)
{
    return setting.is_security ? Thing::SecuritySettings : Thing::Settings;
}

/// Returns the unit; its number is derived from the common code of UNECE Recommendation 20 (Part 8,
/// 5.6.4.3).
EUInformation unit_of(std::string_view unit)
{
    struct Unit {
        std::string_view name;
        std::int32_t id;
        const char* description;
    };
    static constexpr std::array units{
        Unit{"ms", 4'403'766, "millisecond"}, Unit{"s", 5'457'219, "second"},
        Unit{"d", 4'473'177, "day"},          Unit{"B", 16'708, "byte"},
        Unit{"%", 20'529, "percent"},         Unit{"bit", 4'274'489, "bit"},
    };
    EUInformation information;
    information.display_name = LocalizedText{String{unit}};
    for (const Unit& each : units) {
        if (each.name == unit) {
            information.namespace_uri = "http://www.opcfoundation.org/UA/units/un/cefact";
            information.unit_id = each.id;
            information.description = LocalizedText{"en", each.description};
        }
    }
    return information;
}

std::string node_name(std::string_view path)
{
    return std::string{root_name} + "." + std::string{path};
}

std::string_view last_part(std::string_view path)
{
    return path.substr(path.rfind('.') + 1);
}

model::NewVariable variable_like(const Variant& value)
{
    model::NewVariable variable;
    variable.data_type = NodeId{0, static_cast<std::uint32_t>(value.type())};
    variable.value_rank = value.is_array() ? 1 : -1;
    if (value.is_array()) {
        variable.array_dimensions = {0U};
    }
    return variable;
}

/// A property with a constant value.
struct Fixed {
    QualifiedName name;
    NodeId data_type;
    Variant value;
};

std::vector<Fixed> fixed_properties(const Setting& setting, std::uint16_t own)
{
    std::vector<Fixed> properties{{QualifiedName{own, "Default"},
                                   NodeId{0, static_cast<std::uint32_t>(setting.otherwise.type())},
                                   setting.otherwise}};
    if (setting.range) {
        properties.push_back({QualifiedName{0, "InstrumentRange"}, NodeId{0, id::Range},
                              Variant{ExtensionObject::from(*setting.range)}});
    }
    if (!setting.unit.empty()) {
        properties.push_back({QualifiedName{0, "EngineeringUnits"}, NodeId{0, id::EUInformation},
                              Variant{ExtensionObject::from(unit_of(setting.unit))}});
    }
    // The analyzer cannot follow a count of references.
    return properties;
} // NOLINT(clang-analyzer-cplusplus.NewDeleteLeaks)

} // namespace

Result<model::NodeIndex> SettingNodes::add_folder(model::NodeIndex parent, std::string_view path)
{
    model::AddressSpace& space = needs_.server.address_space();
    model::NewNode node;
    node.id = NodeId{namespace_, String{node_name(path)}};
    if (const model::NodeIndex found = space.find(node.id); found != model::no_node) {
        return found;
    }
    node.browse_name = QualifiedName{namespace_, String{last_part(path)}};
    node.parent = parent;
    const auto added = space.add_folder(node);
    if (added) {
        space.set_node_access(*added, access_of(Thing::Settings, NodeClass::Object));
    }
    return added;
}

model::NodeAccess SettingNodes::access(const Setting& setting) const
{
    return access_of(thing_of(setting), NodeClass::Variable, {}, false, needs_.authorities);
}

Result<void> SettingNodes::add_properties(model::NodeIndex node, std::size_t index)
{
    model::AddressSpace& space = needs_.server.address_space();
    const Setting& setting = needs_.list.settings()[index];
    const auto add = [&](const QualifiedName& name, model::NewVariable variable) -> Result<void> {
        model::NewNode property;
        property.id = NodeId{namespace_, String{node_name(setting.name) + "." + name.name.str()}};
        property.browse_name = name;
        property.parent = node;
        const auto added = space.add_property(property, std::move(variable));
        if (!added) {
            return fail(added.error());
        }
        space.set_node_access(*added, access(setting));
        return {};
    };
    for (Fixed& each : fixed_properties(setting, namespace_)) {
        model::NewVariable variable = variable_like(each.value);
        variable.data_type = each.data_type;
        variable.value = std::move(each.value);
        if (auto added = add(each.name, std::move(variable)); !added) {
            return added;
        }
    }
    const std::array<std::pair<const char*, std::uint64_t>, 2> live{
        {{"WaitsForRestart", Aspect::waits}, {"IsChanged", Aspect::changed}}};
    for (const auto& [name, aspect] : live) {
        model::NewVariable variable;
        variable.data_type = NodeId{0, id::Boolean};
        variable.source = this->index();
        variable.handle = index * Aspect::count + aspect;
        if (auto added = add(QualifiedName{namespace_, name}, std::move(variable)); !added) {
            return added;
        }
    }
    return {};
}

Result<void> SettingNodes::add_setting(std::size_t index)
{
    model::AddressSpace& space = needs_.server.address_space();
    const Setting& setting = needs_.list.settings()[index];
    model::NodeIndex parent = root_;
    for (std::size_t point = setting.name.find('.'); point != std::string::npos;
         point = setting.name.find('.', point + 1)) {
        const auto folder = add_folder(parent, std::string_view{setting.name}.substr(0, point));
        if (!folder) {
            return fail(folder.error());
        }
        parent = *folder;
    }
    model::NewNode node;
    node.id = NodeId{namespace_, String{node_name(setting.name)}};
    node.browse_name = QualifiedName{namespace_, String{last_part(setting.name)}};
    node.parent = parent;
    if (!setting.description.empty()) {
        node.description = LocalizedText{"en", String{setting.description}};
    }
    model::NewVariable variable = variable_like(setting.otherwise);
    variable.access_level = model::Access::ReadWrite;
    variable.source = this->index();
    variable.handle = index * Aspect::count + Aspect::value;
    if ((setting.range || !setting.unit.empty()) &&
        space.find(id::BaseAnalogType) != model::no_node) {
        variable.type_definition = NodeId{0, id::BaseAnalogType};
    }
    const auto added = space.add_variable(node, variable);
    if (!added) {
        return fail(added.error());
    }
    space.set_node_access(*added, access(setting));
    return add_properties(*added, index);
}

Result<void> SettingNodes::add_method()
{
    model::AddressSpace& space = needs_.server.address_space();
    const auto argument = [](const char* name, std::uint32_t type, std::int32_t rank,
                             const char* description) {
        Argument made;
        made.name = name;
        made.data_type = NodeId{0, type};
        made.value_rank = rank;
        if (rank == 1) {
            made.array_dimensions = {0U};
        }
        made.description = LocalizedText{"en", description};
        return made;
    };
    model::NewNode node;
    node.id = NodeId{namespace_, String{node_name("Set")}};
    node.browse_name = QualifiedName{namespace_, "Set"};
    node.parent = root_;
    model::NewMethod method;
    method.input_arguments.push_back(
        argument("Names", id::String, 1, "the Variables' NodeIds without \"Settings.\""));
    method.input_arguments.push_back(
        argument("Values", id::BaseDataType, 1, "null takes back what was changed online"));
    method.output_arguments.push_back(
        argument("IsDone", id::Boolean, -1, "whether all were set; otherwise none was"));
    method.output_arguments.push_back(argument("Reason", id::String, -1, "why none was set"));
    const auto added = space.add_method(node, method);
    if (!added) {
        return fail(added.error());
    }
    give_rights(space, *added, Thing::Settings, Authorities::Standard); // it is the same with all
                                                                        // Authorities
    needs_.table.bind_method(space, *added, [this](MethodCall call) {
        needs_.table.post(std::move(call), [this](MethodCall& each) { set(each); });
    });
    return {};
}

Configured<void> SettingNodes::add_nodes()
{
    needs_.server.add_source(*this);
    model::AddressSpace& space = needs_.server.address_space();
    namespace_ = space.namespace_index(needs_.server.config().application_uri).value_or(1);
    model::NewNode node;
    node.id = NodeId{namespace_, String{root_name}};
    node.browse_name = QualifiedName{namespace_, String{root_name}};
    node.parent = space.find(id::ObjectsFolder);
    const auto root = space.add_folder(node);
    Result<void> added{};
    if (root) {
        root_ = *root;
        space.set_node_access(root_, access_of(Thing::Settings, NodeClass::Object));
        added = add_method();
    } else {
        added = fail(root.error());
    }
    for (std::size_t i = 0; i < needs_.list.settings().size() && added; ++i) {
        added = add_setting(i);
    }
    return added ? Configured<void>{}
                 : misconfigured("settings", "cannot be added to the address space", added.error());
}

Variant SettingNodes::value_of(std::uint64_t handle) const
{
    const Setting& setting =
        needs_.list.settings()[static_cast<std::size_t>(handle / Aspect::count)];
    switch (handle % Aspect::count) {
    case Aspect::waits:
        return Variant{needs_.owner.waits_for_restart(setting)};
    case Aspect::changed:
        return Variant{needs_.list.changes().contains(setting.name)};
    default:
        return needs_.owner.value(setting);
    }
}

void SettingNodes::read(server::ReadBatch batch)
{
    const DateTime now = needs_.clock.now();
    for (std::size_t i = 0; i < batch.size(); ++i) {
        DataValue value{value_of(batch.items()[i].handle)};
        value.source_timestamp = now;
        batch.results()[i] = std::move(value);
    }
    batch.complete();
}

/// Posts the write: a callback of the server must not change the server.
void SettingNodes::write(server::WriteBatch batch)
{
    const auto kept = std::make_shared<server::WriteBatch>(std::move(batch));
    needs_.table.post([this, kept] {
        const StatusCode thrown =
            busbar::detail::guarded(needs_.log, "a Write of settings", [&] { write_set(*kept); });
        if (thrown.is_bad()) {
            kept->finish(thrown);
        }
    });
}

void SettingNodes::write_set(server::WriteBatch& batch)
{
    if (batch.is_abandoned()) { // and the audit tells so
        return batch.finish(status::Bad_Timeout);
    }
    std::vector<SettingChange> set;
    set.reserve(batch.size());
    for (const server::WriteItem& item : batch.items()) {
        const auto index = static_cast<std::size_t>(item.handle / Aspect::count);
        set.push_back({needs_.list.settings()[index].name, item.data->value});
    }
    const auto done = needs_.list.change(set, needs_.owner, {.time = needs_.clock.now()});
    if (!done) {
        needs_.log.write(LogLevel::Warning, "administration",
                         "no setting was changed: " + text(done.error()));
    }
    batch.finish(done ? StatusCode{status::Good} : done.error().status,
                 done ? std::string{} : text(done.error()));
}

/// Decides like a Write of the setting's Variable.
bool SettingNodes::may_change(const server::UserIdentity& user, const std::string& name) const
{
    const model::AddressSpace& space = needs_.server.address_space();
    const model::NodeIndex node = space.find(NodeId{namespace_, String{node_name(name)}});
    return needs_.list.find(name) == nullptr || node == model::no_node ||
           may(PermissionType::Write, space, node, user);
}

void SettingNodes::set(MethodCall& call)
{
    const auto* const names = call.inputs()[0].array_if<String>();
    const auto* const values = call.inputs()[1].array_if<Variant>();
    if (names == nullptr || values == nullptr || names->size() != values->size()) {
        return call.fail(status::Bad_InvalidArgument, "expected as many values as names");
    }
    std::vector<SettingChange> set;
    for (std::size_t i = 0; i < names->size(); ++i) {
        set.push_back({(*names)[i].str(), (*values)[i]});
        if (!may_change(call.user(), set.back().name)) {
            const Refusal refusal{status::Bad_UserAccessDenied,
                                  "settings",
                                  set.back().name + " is for the role SecurityAdmin",
                                  {},
                                  {}};
            tell_method(needs_.log, RecordKind::SettingsChanged, call, refusal.status, &refusal);
            return answer_with(call, refusal);
        }
    }
    const auto done = needs_.list.change(set, needs_.owner, {call.user().name, needs_.clock.now()});
    std::optional<Refusal> refusal;
    if (!done) {
        refusal.emplace(Refusal{done.error().status, "settings", text(done.error()), {}, {}});
    }
    tell_method(needs_.log, RecordKind::SettingsChanged, call,
                done ? StatusCode{status::Good} : done.error().status,
                refusal ? &*refusal : nullptr, {}, {}, MethodAnswer::IsGood);
    Array<Variant> outputs;
    outputs.push_back(Variant{done.has_value()});
    outputs.push_back(Variant{String{done ? std::string{} : text(done.error())}});
    call.succeed(std::move(outputs));
}

} // namespace busbar::administration::detail
