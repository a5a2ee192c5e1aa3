#pragma once

#include <catch2/catch.hpp>

#include <string>
#include <vector>

#include <busbar/binary/dynamic_types.hpp>
#include <busbar/controller/mapped_source.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/method.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/subscription.hpp>

#include "fake_labels.hpp"
#include "support/server_fixture.hpp"
#include "support/source_caller.hpp"

namespace busbar::test {

using controller::LabelUpdate;
using controller::MappedArgument;
using controller::MappedErrorCode;
using controller::MappedLimits;
using controller::MappedMethod;
using controller::MappedOptions;
using controller::MappedSource;
using controller::MappedVariable;
using controller::SamplingMode;

/// Keeps what it is told.
class ErrorBook final : public controller::MappedObserver {
public:
    void label_update(LabelUpdate event) override { events.push_back(event); }
    void error(const controller::MappedError& error) override
    {
        errors.push_back(error.code);
        label = std::string{error.label};
        node = error.node != nullptr ? *error.node : NodeId{};
    }

    std::vector<LabelUpdate> events;
    std::vector<MappedErrorCode> errors;
    /// Of the last error.
    std::string label;
    NodeId node;
};

/// What outlives the server.
struct MappedParts {
    explicit MappedParts(const MappedOptions& options)
        : plc{std::make_shared<FakeLabels>()}, source{plc, options, &book}
    {
    }

    TestWaker waker_of_test;
    std::shared_ptr<FakeLabels> plc;
    ErrorBook book;
    MappedSource source;
    binary::DynamicTypes types;
};

/// A server with Variables and Methods that are mapped to labels of a PLC.
class MappedFixture : public MappedParts, public ServerFixture {
public:
    explicit MappedFixture(const MappedOptions& options = {},
                           server::ServerConfig config = insecure_config())
        : MappedParts{options},
          ServerFixture{waker_of_test, std::move(config)}, index{server.add_source(source)}
    {
        users.everybody.access_level_mask = 0xFF;
        source.set_space(&server.address_space());
        client.emplace(log_in());
    }

    [[nodiscard]] static NodeId own(const std::string& name) { return NodeId{1, String{name}}; }
    [[nodiscard]] model::NewNode named(const std::string& name)
    {
        model::NewNode node;
        node.id = own(name);
        node.browse_name = QualifiedName{1, String{name}};
        node.parent = server.address_space().find(id::ObjectsFolder);
        return node;
    }
    [[nodiscard]] std::shared_ptr<const controller::ValueShape>
    shape(std::uint32_t data_type, std::uint32_t elements = 0, bool is_argument = false)
    {
        const std::vector<std::uint32_t> dimensions{elements};
        controller::ValueDeclaration declaration;
        declaration.data_type = NodeId{0, data_type};
        declaration.value_rank = elements == 0 ? -1 : 1;
        declaration.is_argument = is_argument;
        if (elements != 0) {
            declaration.array_dimensions = dimensions;
        }
        auto made = controller::ValueShape::of(server.address_space(), types, declaration);
        REQUIRE(made);
        return std::make_shared<const controller::ValueShape>(std::move(*made));
    }
    /// A Variable of that type; an array with more than one label.
    NodeId add(const std::string& name, std::uint32_t data_type, std::vector<std::string> labels,
               Variant initial = {})
    {
        const auto elements = labels.size() == 1 ? 0U : static_cast<std::uint32_t>(labels.size());
        return add(name, data_type, elements,
                   {own(name), shape(data_type, elements), std::move(labels), std::move(initial)});
    }
    NodeId add(const std::string& name, std::uint32_t data_type, std::uint32_t elements,
               MappedVariable mapped)
    {
        model::NewVariable variable;
        variable.data_type = NodeId{0, data_type};
        variable.value_rank = elements == 0 ? -1 : 1;
        if (elements != 0) {
            variable.array_dimensions = {elements};
        }
        variable.access_level = model::Access::ReadWrite;
        variable.source = index;
        variable.handle = source.add(std::move(mapped));
        REQUIRE(server.address_space().add_variable(named(name), variable));
        return own(name);
    }

    /// What the server does when it was woken.
    void complete()
    {
        server.handle_completions(now);
        client->run();
    }
    [[nodiscard]] static ReadValueId value_of(const NodeId& node, const char* range = nullptr)
    {
        ReadValueId id;
        id.node_id = node;
        id.attribute_id = 13;
        if (range != nullptr) {
            id.index_range = String{range};
        }
        return id;
    }
    std::uint32_t send_read(const std::vector<NodeId>& nodes)
    {
        ReadRequest request;
        request.timestamps_to_return = TimestampsToReturn::Both;
        for (const NodeId& node : nodes) {
            request.nodes_to_read.push_back(value_of(node));
        }
        return client->send(request);
    }
    Array<DataValue> take_read(std::uint32_t id)
    {
        complete();
        auto response = client->take<ReadResponse>(id);
        return response ? response->results : Array<DataValue>{};
    }
    Array<DataValue> read(const std::vector<NodeId>& nodes) { return take_read(send_read(nodes)); }
    DataValue read(const NodeId& node)
    {
        const auto results = read(std::vector{node});
        REQUIRE(results.size() == 1);
        return results[0];
    }
    Array<StatusCode> write(const std::vector<std::pair<NodeId, Variant>>& values,
                            const char* range = nullptr)
    {
        WriteRequest request;
        for (const auto& [node, value] : values) {
            WriteValue one;
            one.node_id = node;
            one.attribute_id = 13;
            one.value.value = value;
            if (range != nullptr) {
                one.index_range = String{range};
            }
            request.nodes_to_write.push_back(one);
        }
        const auto id = client->send(request);
        complete();
        auto response = client->take<WriteResponse>(id);
        return response ? response->results : Array<StatusCode>{};
    }

    std::uint32_t index;
    std::optional<TestClient> client;
};

} // namespace busbar::test
