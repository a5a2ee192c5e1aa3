#include "service_world.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include <busbar/types/ids.hpp>

namespace busbar::fuzz {

namespace {

using binary::DynamicArray;
using binary::DynamicType;
using binary::DynamicValue;

/// The operations of a request are in the first array behind its header, where its response has a
/// result for each.
std::optional<std::size_t> operations_of(const DynamicValue& request, const DynamicType& response)
{
    // Results of software certificates, which nobody has any more, and of what is registered.
    const std::string& name = request.type().name;
    if (!response.find_field("Results") || name == "ActivateSessionRequest") {
        return {};
    }
    const auto* const releases = request.get_if<bool>("ReleaseContinuationPoints");
    if (releases != nullptr && *releases) {
        return {}; // Part 4, 5.9.3.2: no results
    }
    for (std::size_t i = 1; i < request.type().fields.size(); ++i) {
        const auto& field = request.type().fields[i];
        const bool is_about_answer = field.name == "LocaleIds" || field.name == "ProfileUris";
        if (field.is_scalar() || is_about_answer) {
            continue;
        }
        if (const auto* const structures = request.structures(i)) {
            return structures->values.size();
        }
        const Variant* const value = request.value(i);
        return value != nullptr ? value->array_size() : 0;
    }
    return {};
}

/// Requests whose work end() cannot undo.
bool leaves_traces(std::string_view request)
{
    return request == "AddNodesRequest" || request == "AddReferencesRequest" ||
           request == "DeleteNodesRequest" || request == "DeleteReferencesRequest" ||
           request == "WriteRequest";
}

/// The same of what is known of the request: values that are written are overwritten again.
bool leaves_traces(const DynamicValue& request)
{
    const DynamicArray* const written = request.structures("NodesToWrite");
    if (written == nullptr) {
        return leaves_traces(request.type().name);
    }
    return std::any_of(written->values.begin(), written->values.end(), [](const auto& each) {
        return *each.template get_if<std::uint32_t>("AttributeId") !=
               static_cast<std::uint32_t>(AttributeId::Value);
    });
}

} // namespace

server::ServerConfig ServiceWorld::config()
{
    server::ServerConfig config;
    config.has_node_management = true;
    config.endpoints = {{}};
    config.endpoints[0].allows_anonymous = true;
    config.endpoints[0].allows_user_name = false;
    config.limits.max_session_timeout = std::chrono::minutes{2};
    server::SubscriptionLimits& limits = config.limits.subscriptions;
    limits.min_publishing_interval = std::chrono::milliseconds{50};
    limits.max_publishing_interval = std::chrono::seconds{20};
    limits.max_keep_alive = std::chrono::seconds{30};
    limits.max_lifetime = std::chrono::minutes{2};
    return config;
}

ServiceWorld::ServiceWorld()
    : server_{server::Server::create(
                  config(),
                  {.random = &random_, .wall_clock = &wall_clock_, .log = &log_, .users = &users_})
                  .value()}
{
    users_.everybody.access_level_mask = 0xFF;
    users_.everybody.roles = {"ConfigureAdmin", "SecurityAdmin"};
    add_variables();
    add_method();
    allow_writes();
    add_image();
    add_analog();
}

void ServiceWorld::add_variables()
{
    const std::uint32_t source = server_.add_source(memory_);
    const std::array values{
        Variant{std::int32_t{1}}, Variant{Array<std::int32_t>{1, 2, 3}}, Variant{"text"},
        Variant{2.5},
        Variant::matrix(Array<std::int32_t>{1, 2, 3, 4, 5, 6}, Array<std::uint32_t>{3, 2})};
    std::uint32_t number = 1;
    for (const Variant& value : values) {
        handles_.push_back(memory_.add(value));
        add_variable(number++, value, source, handles_.back());
    }
    for (const Variant& value : values) { // kept by the address space
        add_variable(number++, value);
    }
}

model::NodeIndex ServiceWorld::add_variable(std::uint32_t number, const Variant& value,
                                            std::uint32_t source, std::uint64_t handle)
{
    model::AddressSpace& space = server_.address_space();
    model::NewNode node;
    node.id = NodeId{1, number};
    node.browse_name = QualifiedName{1, String{std::to_string(number - 1)}};
    node.parent = space.find(id::ObjectsFolder);
    model::NewVariable variable;
    variable.data_type = NodeId{0, static_cast<std::uint32_t>(value.type())};
    variable.value_rank = value.is_scalar() ? -1 : value.dimensions().empty() ? 1 : 2;
    variable.access_level = model::Access::ReadWrite;
    variable.source = source;
    variable.handle = handle;
    if (source == model::no_source) {
        variable.value = value;
    }
    const auto made = space.add_variable(node, variable);
    require(made.has_value());
    return *made;
}

void ServiceWorld::allow_writes()
{
    model::AddressSpace& space = server_.address_space();
    model::NodeAccess access;
    access.write_mask = UINT32_MAX;
    for (std::uint32_t number = 1; number <= 14; ++number) {
        const model::NodeIndex node = space.find(NodeId{1, number});
        if (node != model::no_node) {
            space.set_node_access(node, access);
        }
    }
}

void ServiceWorld::add_image()
{
    const std::uint32_t source = server_.add_source(image_.source());
    for (std::uint32_t i = 0; i < WorldImage::variable_count; ++i) {
        add_variable(16 + i, image_.value(i), source, image_.handle(i));
    }
}

void ServiceWorld::add_analog()
{
    model::NewNode property;
    property.id = NodeId{1, 21};
    property.browse_name = QualifiedName{0, "EURange"};
    property.parent = add_variable(20, Variant{2.5});
    model::NewVariable range;
    range.data_type = NodeId{0, id::Range};
    range.value = ExtensionObject::from(Range{0, 200});
    range.access_level = model::Access::ReadWrite;
    require(server_.address_space().add_property(property, range).has_value());
}

void ServiceWorld::add_method()
{
    model::AddressSpace& space = server_.address_space();
    model::NewNode node;
    node.id = NodeId{1, 14};
    node.browse_name = QualifiedName{1, "Echo"};
    node.parent = space.find(id::ObjectsFolder);
    model::NewMethod method;
    method.input_arguments = {{"value", NodeId{0, id::BaseDataType}, -2}};
    method.output_arguments = method.input_arguments;
    method.source = server_.add_source(methods_);
    method.handle =
        methods_.add([this](server::MethodCall call) { calls_.push_back(std::move(call)); });
    require(space.add_method(node, method).has_value());
}

void ServiceWorld::set_values(std::int32_t number)
{
    memory_.set(handles_[0], Variant{number});
    memory_.set(handles_[1], Variant{Array<std::int32_t>{number, 2, 3}});
    memory_.set(handles_[2], Variant{String{std::to_string(number)}});
    memory_.set(handles_[3], Variant{number * 1.5});
}

void ServiceWorld::begin()
{
    set_values(1);
    image_.scan(1, wall_clock_.time);
    for (Session& session : sessions_) {
        auto connection = server_.connect("192.0.2.1", now_);
        require(connection.has_value());
        session.client.emplace(*std::move(connection), channel::SecuritySetting{},
                               channel::ChannelEnvironment{
                                   .random = &random_, .wall_clock = &wall_clock_, .log = &log_},
                               now_);
        require(session.client->open_session().is_good());
    }
}

void ServiceWorld::end()
{
    act(0xFF);
    for (Session& session : sessions_) {
        CloseSessionRequest close;
        close.delete_subscriptions = true;
        static_cast<void>(session.client->send(std::move(close)));
        session.client.reset();
        session.expected.clear();
    }
    calls_.clear();
    ids_.clear();
    // Sessions and Subscriptions that the input has left end with their timeouts, which are counted
    // in publishing intervals: a late deadline counts one.
    constexpr int most_intervals = 3'000;
    for (int i = 0; i < most_intervals && (i == 0 || is_busy()); ++i) {
        now_ += std::chrono::minutes{3};
        wall_clock_.time.ticks += 180 * DateTime::ticks_per_second;
        server_.handle_deadline(now_);
        server_.handle_completions(now_);
    }
    require(!is_busy());
    require(server_.connection_count() == 0);
}

bool ServiceWorld::is_busy() const
{
    return server_.session_count() + server_.subscription_count() +
               server_.monitored_item_count() !=
           0;
}

void ServiceWorld::bind(const Session& session, DynamicValue& request) const
{
    DynamicValue header = *request.structure(0U);
    static_cast<void>(
        header.set("AuthenticationToken", Variant{session.client->authentication_token}));
    static_cast<void>(request.set(std::size_t{0}, std::move(header)));
    ids_.bind(request);
}

bool ServiceWorld::send(Session& session, Expected expected,
                        FunctionRef<void(binary::Writer&)> body)
{
    if (session.client->is_closed()) {
        return false;
    }
    const auto sent = session.client->channel.send(body);
    if (!sent) {
        return false;
    }
    session.expected[*sent] = expected;
    session.client->run();
    server_.handle_completions(now_);
    look();
    return true;
}

void ServiceWorld::send(std::size_t session, const RequestTypes::Entry& entry, DynamicValue request)
{
    Session& sender = sessions_[session];
    bind(sender, request);
    is_used_up_ = is_used_up_ || leaves_traces(request);
    static_cast<void>(send(sender, {entry.response, operations_of(request, *entry.response)},
                           [&](binary::Writer& writer) {
                               encode(writer, request.type().encoding_id);
                               encode(writer, request);
                           }));
}

void ServiceWorld::send_raw(std::size_t session, std::uint32_t encoding,
                            std::span<const std::byte> body)
{
    const auto* const entry = RequestTypes::all().find(encoding);
    is_used_up_ = is_used_up_ || (entry != nullptr && leaves_traces(entry->request->name));
    static_cast<void>(send(sessions_[session], {entry != nullptr ? entry->response : nullptr, {}},
                           [&](binary::Writer& writer) {
                               encode(writer, NodeId{0, encoding});
                               writer.bytes(body);
                           }));
}

void ServiceWorld::advance(Duration time)
{
    now_ += time;
    wall_clock_.time.ticks += time.count() / 100;
    server_.handle_deadline(now_);
    require(server_.next_deadline() > now_); // nobody drives a server in circles
    for (Session& session : sessions_) {
        session.client->connection.handle_deadline(now_);
        session.client->channel.handle_deadline(now_);
    }
    look();
}

void ServiceWorld::act(std::uint8_t choice)
{
    if ((choice & 1U) != 0) {
        set_values(choice);
    }
    if ((choice & 2U) != 0) {
        while (!calls_.empty()) {
            server::MethodCall call = std::move(calls_.front());
            calls_.pop_front();
            if ((choice & 4U) != 0) {
                call.succeed(Array<Variant>{call.inputs()});
            } // else it is abandoned
        }
    }
    if ((choice & 8U) != 0) {
        server::Event event;
        event.message = LocalizedText{"en", "event"};
        event.severity = choice;
        static_cast<void>(server_.raise_event(event));
    }
    if ((choice & 16U) != 0) {
        image_.scan(choice, wall_clock_.time);
    }
    server_.handle_completions(now_);
    look();
}

void ServiceWorld::look()
{
    while (server_.next_changed()) {
        // All connections are looked at in any case.
    }
    for (Session& session : sessions_) {
        if (session.client) {
            look(session);
        }
    }
}

void ServiceWorld::look(Session& session)
{
    session.client->run();
    while (!session.client->messages.empty()) {
        const channel::ChannelEvent message = std::move(session.client->messages.front());
        session.client->messages.pop_front();
        const auto found = session.expected.find(message.request_id);
        require(found != session.expected.end());
        const Expected expected = found->second;
        session.expected.erase(found);
        check(expected, message.body);
    }
}

void ServiceWorld::check(const Expected& expected, std::span<const std::byte> body)
{
    const RequestTypes& all = RequestTypes::all();
    binary::Reader reader{body};
    NodeId encoding;
    decode(reader, encoding);
    require(reader.ok());
    const auto rest = body.subspan(body.size() - reader.remaining());
    const DynamicType* const fault = all.types().find(NodeId{0, id::ServiceFault});
    const DynamicType* const type = all.types().find_encoding(encoding);
    require(type != nullptr && (type == fault || type == expected.response));
    const auto response = binary::decode_dynamic(rest, *type);
    require(response.has_value());
    if (type == fault) {
        return;
    }
    const auto* const result =
        response->structure(std::size_t{0})->get_if<StatusCode>("ServiceResult");
    require(result != nullptr);
    if (!result->is_bad() && expected.result_count) {
        const auto* const structures = response->structures("Results");
        const Variant* const values = response->value("Results");
        require((structures != nullptr ? structures->values.size() : values->array_size()) ==
                *expected.result_count);
    }
    ids_.learn(*response);
}

} // namespace busbar::fuzz
