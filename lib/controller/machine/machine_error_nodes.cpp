#include <busbar/controller/machine_error_nodes.hpp>

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/core/status_codes.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::controller {

namespace {

constexpr std::string_view error_folder = "Controller/PLCError";

/// The values of the nodes, made from the errors that are present.
struct ShownErrors {
    Variant level;
    Variant code;
    Variant current;
};

ShownErrors shown(const std::optional<PlcError>& error, std::span<const MachineEvent> current)
{
    Array<String> texts;
    texts.clear(); // not null
    for (const MachineEvent& each : current) {
        texts.push_back(String{text(each)});
    }
    const std::string_view level = error ? name(error->level) : name(ErrorState::NoError);
    return {Variant{String::borrow(level)}, Variant{error ? error->code : std::uint32_t{0}},
            Variant{std::move(texts)}};
}

Result<model::NodeHandle> add_error_property(model::AddressSpace& space, model::NodeIndex parent,
                                             std::uint16_t namespace_index, std::string_view name,
                                             Variant value)
{
    model::NewNode node;
    node.id = NodeId{namespace_index, String{std::string{error_folder} + "/" + std::string{name}}};
    node.browse_name = QualifiedName{namespace_index, String{name}};
    node.parent = parent;
    model::NewVariable variable;
    variable.data_type = NodeId{0, static_cast<std::uint32_t>(value.type())};
    variable.value_rank = value.is_array() ? 1 : -1; // Part 3, 5.6.2
    variable.value = std::move(value);
    const auto added = space.add_property(node, std::move(variable));
    return added ? Result<model::NodeHandle>{space.handle(*added)} : fail(added.error());
}

/// Writes the Property's value. This fails only if a client has deleted the node; then the value is
/// not needed.
void set_error_property(model::AddressSpace& space, model::NodeHandle property, Variant value)
{
    const model::NodeIndex node = space.resolve(property);
    if (node != model::no_node && !(space.value(node) == value)) {
        static_cast<void>(space.set_value(node, std::move(value)));
    }
}

} // namespace

ErrorState error_state_of(std::span<const MachineEvent> current_errors)
{
    const auto has = [&](EventLevel level) {
        return std::any_of(current_errors.begin(), current_errors.end(),
                           [&](const MachineEvent& each) { return each.level == level; });
    };
    if (has(EventLevel::MajorFault)) {
        return ErrorState::MajorFault;
    }
    return has(EventLevel::PartialFault) || has(EventLevel::MinorFault)
               ? ErrorState::ContinuousError
               : ErrorState::NoError;
}

Result<void> MachineErrorNodes::publish(server::Server& server, const MachineNodes& nodes,
                                        const MachineEventLog& log)
{
    if (const auto added = add_nodes(server.address_space(), nodes); !added) {
        return added;
    }
    server_ = &server;
    nodes_ = &nodes;
    log_ = &log;
    server.add_source(*this);
    show();
    return {};
}

Result<void> MachineErrorNodes::add_nodes(model::AddressSpace& space, const MachineNodes& nodes)
{
    const std::uint16_t index = nodes.namespace_index();
    model::NewNode node;
    node.id = NodeId{index, String{error_folder}};
    node.browse_name = QualifiedName{index, "PLCError"};
    node.parent = space.resolve(nodes.folder());
    node.reference_type = NodeId{0, id::HasComponent};
    const auto object = space.add_object(node);
    if (!object) {
        return fail(object.error());
    }
    ShownErrors none = shown(std::nullopt, {});
    struct Row {
        std::string_view name;
        Variant& value;
        model::NodeHandle& handle;
    };
    const Row rows[] = {{"Level", none.level, level_},
                        {"Code", none.code, code_},
                        {"CurrentErrors", none.current, current_}};
    for (const Row& row : rows) {
        const auto added =
            add_error_property(space, *object, index, row.name, std::move(row.value));
        if (!added) {
            return fail(added.error());
        }
        row.handle = *added;
    }
    return {};
}

void MachineErrorNodes::refresh()
{
    is_stale_ = true;
    waker_.wake();
}

void MachineErrorNodes::read(server::ReadBatch batch)
{
    batch.fail(status::Bad_NotReadable); // the source has no Variables that are read by batches
}

void MachineErrorNodes::attach(server::Waker* waker)
{
    waker_.set(waker);
}

void MachineErrorNodes::handle_completions()
{
    if (is_stale_.exchange(false)) {
        show();
    }
}

void MachineErrorNodes::show()
{
    model::AddressSpace& space = server_->address_space();
    const std::vector<MachineEvent> current = log_->current_errors();
    ShownErrors values = shown(log_->plc_error(), current);
    set_error_property(space, level_, std::move(values.level));
    set_error_property(space, code_, std::move(values.code));
    set_error_property(space, current_, std::move(values.current));
    nodes_->set_error_state(space, error_state_of(current));
}

} // namespace busbar::controller
