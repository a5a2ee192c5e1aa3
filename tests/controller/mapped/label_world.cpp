#include "label_world.hpp"

#include <algorithm>
#include <iterator>

#include <busbar/harness/report.hpp>

namespace busbar::test {

using controller::MappedPart;

namespace {

harness::BenchOptions bench_options(std::uint64_t seed)
{
    harness::BenchOptions options;
    options.seed = seed;
    options.server.limits.subscriptions.sampling = server::stepped_sampling();
    return options;
}

MappedOptions mapped_options(SamplingMode sampling)
{
    MappedOptions options;
    options.sampling = sampling;
    return options;
}

std::shared_ptr<controller::SimulatedLabels>
make_labels(controller::Program program, const controller::SimulatedLabelsOptions& options)
{
    auto made = controller::SimulatedLabels::create(std::move(program), options);
    INFO((made ? "" : text(made.error())));
    REQUIRE(made);
    return std::move(*made);
}

} // namespace

LabelWorld::LabelWorld(controller::Program program, LabelWorldOptions options)
    : Bench{bench_options(options.seed)}, labels{make_labels(std::move(program), options.labels)},
      source{labels, mapped_options(options.sampling), &book}, options_{std::move(options)},
      plc_{make_plc()}, scan_{world().scheduler(), [this] { scan(); }}
{
    server().add_source(source);
    source.set_space(&server().address_space());
}

controller::Program LabelWorld::program_of(const std::string& types, const std::string& variables)
{
    auto program = controller::read_declarations(
        types + " {attribute 'publish' := 'public'} VAR_GLOBAL " + variables + " END_VAR", "test");
    INFO((program ? "" : text(program.error())));
    REQUIRE(program);
    return std::move(*program);
}

std::unique_ptr<controller::Plc> LabelWorld::make_plc() const
{
    const auto program = labels->program();
    auto made = controller::Plc::create(options_.plc, program->types(), program->image());
    INFO((made ? "" : text(made.error())));
    REQUIRE(made);
    return std::move(*made);
}

void LabelWorld::scan()
{
    const DateTime now = world().clock().now();
    plc_->scan(now, scan_cycle);
    labels->end_of_scan(now);
    if (next_plc_ != nullptr && &next_plc_->image()->memory() == &labels->memory()) {
        plc_ = std::move(next_plc_);
    }
    go_on_scanning();
}

model::NewNode LabelWorld::named(const std::string& name, const NodeId& parent)
{
    model::NewNode node;
    node.id = own(name);
    node.browse_name = QualifiedName{1, String{name}};
    node.parent = server().address_space().find(parent);
    return node;
}

void LabelWorld::add(const std::string& name, const NodeId& type, const std::string& label)
{
    MappedPart value;
    value.label = label;
    add(name, type, std::move(value));
}

void LabelWorld::add(const std::string& name, const NodeId& type, MappedPart value,
                     std::uint32_t elements, Variant initial)
{
    model::NewVariable variable;
    variable.data_type = type;
    variable.value = std::move(initial);
    variable.access_level = model::Access::ReadWrite;
    if (elements != 0) {
        variable.value_rank = 1;
        variable.array_dimensions = {elements};
    }
    const NodeId parent{0, id::ObjectsFolder};
    REQUIRE(server().address_space().add_variable(named(name, parent), variable));
    mapping.variables[own(name)].value = std::move(value);
}

void LabelWorld::add(const std::string& name, const Array<Argument>& inputs,
                     controller::MethodMapping methods_mapping)
{
    model::NewMethod method;
    method.input_arguments = inputs;
    const NodeId parent{0, id::ObjectsFolder};
    REQUIRE(server().address_space().add_method(named(name, parent), method));
    mapping.methods[own(name)] = std::move(methods_mapping);
}

void LabelWorld::start()
{
    model::AddressSpace& space = server().address_space();
    const auto mapped = controller::map_nodes(space, data_types.of(space), mapping, source);
    CHECK(mapped.left_out.empty());
    go_on_scanning();
    source.start();
    REQUIRE(connect());
}

void LabelWorld::download(const std::string& types, const std::string& variables)
{
    REQUIRE(labels->replace_program(program_of(types, variables)));
    next_plc_ = make_plc();
}

Array<DataValue> LabelWorld::read_all(const std::vector<std::string>& names)
{
    std::vector<NodeId> nodes;
    std::ranges::transform(names, std::back_inserter(nodes), own);
    return harness::need(Bench::read(nodes));
}

Array<StatusCode> LabelWorld::write(const std::vector<std::pair<std::string, Variant>>& values)
{
    WriteRequest request;
    for (const auto& [name, value] : values) {
        WriteValue one;
        one.node_id = own(name);
        one.attribute_id = 13;
        one.value.value = value;
        request.nodes_to_write.push_back(one);
    }
    return harness::need(Bench::call<WriteResponse>(std::move(request))).results;
}

CallMethodResult LabelWorld::call(const std::string& method, Array<Variant> inputs)
{
    return harness::need(Bench::call(NodeId{0, id::ObjectsFolder}, own(method), std::move(inputs)));
}

void LabelWorld::monitor(const std::vector<std::string>& names)
{
    CreateSubscriptionRequest create;
    create.requested_publishing_interval = 200;
    create.requested_lifetime_count = 1'000;
    create.requested_max_keep_alive_count = 100;
    create.publishing_enabled = true;
    const auto made = Bench::call<CreateSubscriptionResponse>(create);
    REQUIRE(made);
    CreateMonitoredItemsRequest request;
    request.subscription_id = made->subscription_id;
    request.timestamps_to_return = TimestampsToReturn::Source;
    for (const std::string& name : names) {
        MonitoredItemCreateRequest item;
        item.item_to_monitor = MappedFixture::value_of(own(name));
        item.monitoring_mode = MonitoringMode::Reporting;
        item.requested_parameters.client_handle =
            static_cast<std::uint32_t>(request.items_to_create.size());
        item.requested_parameters.sampling_interval = 200;
        item.requested_parameters.queue_size = 1;
        request.items_to_create.push_back(item);
    }
    const auto items = Bench::call<CreateMonitoredItemsResponse>(request);
    REQUIRE(items);
    for (const auto& item : items->results) {
        REQUIRE(item.status_code == status::Good);
    }
}

std::vector<std::pair<std::uint32_t, DataValue>> LabelWorld::next()
{
    const auto response = Bench::call<PublishResponse>(PublishRequest{});
    REQUIRE(response);
    std::vector<std::pair<std::uint32_t, DataValue>> all;
    for (const ExtensionObject& part : response->notification_message.notification_data) {
        if (const auto* data = part.get_if<DataChangeNotification>()) {
            for (const auto& item : data->monitored_items) {
                all.emplace_back(item.client_handle, item.value);
            }
        }
    }
    std::sort(all.begin(), all.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    return all;
}

MappedPart part_of(std::vector<MappedPart> parts)
{
    MappedPart whole;
    whole.is_array = !parts.empty() && parts.front().kind == MappedPart::Kind::Element;
    whole.is_structure = !parts.empty() && parts.front().kind == MappedPart::Kind::Field;
    whole.parts = std::move(parts);
    return whole;
}

MappedPart element(std::uint32_t number, std::string label, std::vector<MappedPart> parts)
{
    MappedPart part;
    part.kind = MappedPart::Kind::Element;
    part.number = number;
    part.label = std::move(label);
    part.parts = std::move(parts);
    return part;
}

MappedPart field(std::string name, std::string label)
{
    MappedPart part;
    part.kind = MappedPart::Kind::Field;
    part.name = std::move(name);
    part.label = std::move(label);
    return part;
}

} // namespace busbar::test
