#pragma once

#include <deque>
#include <string>
#include <vector>

#include <busbar/server/method_table.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/method.hpp>

#include "session_use.hpp"
#include "support/source_caller.hpp"

namespace busbar::test {

/// What outlives the server. Methods that the test answers itself are kept in `calls`.
struct MethodParts {
    TestWaker waker_of_test;
    server::MethodTable table;
    std::deque<server::MethodCall> calls;
};

/// Hides nodes and refuses Methods by name.
class NamedRights final : public server::AccessControl {
public:
    [[nodiscard]] bool may_browse(const server::UserIdentity&, const NodeId& node) const override
    {
        return node != hidden;
    }
    [[nodiscard]] std::uint8_t user_access_level(const server::UserIdentity&, const NodeId&,
                                                 std::uint8_t access_level) const override
    {
        return access_level;
    }
    [[nodiscard]] bool may_call(const server::UserIdentity& user,
                                const NodeId& method) const override
    {
        return method != forbidden || user.name == "boss";
    }

    NodeId hidden;
    NodeId forbidden;
};

/// A server with an Object "Machine" and Methods on it, and users who may call them.
class MethodFixture : public MethodParts, public ServerFixture {
public:
    explicit MethodFixture(server::ServerConfig config = insecure_config(),
                           const server::AccessControl* access = nullptr)
        : ServerFixture{waker_of_test, std::move(config), access}, source{server.add_source(table)}
    {
        users.everybody.access_level_mask = 0xFF;
        machine = space().add_object(named("Machine", space().find(id::ObjectsFolder))).value();
    }

    [[nodiscard]] model::AddressSpace& space() { return server.address_space(); }
    [[nodiscard]] static NodeId own(const std::string& name) { return NodeId{1, String{name}}; }
    [[nodiscard]] static model::NewNode named(const std::string& name, model::NodeIndex parent)
    {
        model::NewNode node;
        node.id = own(name);
        node.browse_name = QualifiedName{1, String{name}};
        node.parent = parent;
        return node;
    }
    [[nodiscard]] static Argument argument(std::uint32_t data_type, std::int32_t value_rank = -1,
                                           Array<std::uint32_t> dimensions = {})
    {
        return {"argument", NodeId{0, data_type}, value_rank, std::move(dimensions), {}};
    }

    /// A Method of the machine.
    NodeId add(const std::string& name, Array<Argument> inputs, Array<Argument> outputs,
               server::MethodTable::Function function)
    {
        model::NewMethod method;
        method.input_arguments = std::move(inputs);
        method.output_arguments = std::move(outputs);
        method.source = source;
        method.handle = table.add(std::move(function));
        return add(named(name, machine), method);
    }
    NodeId add(const model::NewNode& node, const model::NewMethod& method = {})
    {
        REQUIRE(space().add_method(node, method));
        return node.id;
    }
    /// One that the test answers by `calls`.
    NodeId add_slow(const std::string& name)
    {
        return add(name, {argument(id::Int32)}, {argument(id::Int32)},
                   [this](server::MethodCall call) { calls.push_back(std::move(call)); });
    }
    /// sum := a + b
    NodeId add_sum()
    {
        return add("Sum", {argument(id::Int32), argument(id::Int32)}, {argument(id::Int32)},
                   [](server::MethodCall call) {
                       call.succeed(
                           {Variant{call.input<std::int32_t>(0) + call.input<std::int32_t>(1)}});
                   });
    }
    /// One without outputs that takes whatever fits.
    NodeId add_taking(const std::string& name, Argument input)
    {
        return add(name, {std::move(input)}, {}, [](server::MethodCall call) { call.succeed(); });
    }

    [[nodiscard]] static CallMethodRequest to_call(const NodeId& method, Array<Variant> inputs = {},
                                                   const NodeId& object = own("Machine"))
    {
        return {object, method, std::move(inputs)};
    }
    [[nodiscard]] static CallRequest request(std::initializer_list<CallMethodRequest> calls)
    {
        CallRequest request;
        request.methods_to_call = calls;
        return request;
    }
    static CallMethodResult call(TestClient& client, CallMethodRequest method)
    {
        const auto response = client.call<CallResponse>(request({std::move(method)}));
        REQUIRE(response);
        REQUIRE(response->results.size() == 1);
        CHECK(response->diagnostic_infos.empty());
        return response->results[0];
    }
    static StatusCode status_of(TestClient& client, CallMethodRequest method)
    {
        return call(client, std::move(method)).status_code;
    }
    static Variant read(TestClient& client, const NodeId& node, AttributeId attribute)
    {
        ReadRequest request = read_state();
        request.nodes_to_read[0].node_id = node;
        request.nodes_to_read[0].attribute_id = static_cast<std::uint32_t>(attribute);
        const auto response = client.call<ReadResponse>(request);
        REQUIRE(response);
        return response->results[0].value;
    }

    std::uint32_t source;
    model::NodeIndex machine;
};

} // namespace busbar::test
