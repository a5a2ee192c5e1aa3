#pragma once

#include <deque>

#include <busbar/server/data_source.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>

#include "support/server_fixture.hpp"

namespace busbar::test {

class CountingWaker final : public server::Waker {
public:
    void wake() override { ++count; }
    int count{0};
};

/// Keeps its batches until the test answers them.
class SlowSource final : public server::DataSource {
public:
    void read(server::ReadBatch batch) override { batches.push_back(std::move(batch)); }
    void answer()
    {
        for (auto& slot : batches.front().results()) {
            slot = DataValue{Variant{42}};
        }
        batches.front().complete();
        batches.pop_front();
    }
    std::deque<server::ReadBatch> batches;
};

/// What has to outlive the server.
struct SlowParts {
    CountingWaker waker_of_test;
    SlowSource source;
};

/// A server with one variable of a source that takes its time.
struct SlowFixture : SlowParts, ServerFixture {
    explicit SlowFixture(server::ServerConfig config = insecure_config())
        : ServerFixture{waker_of_test, std::move(config)}
    {
        model::NewVariable variable;
        variable.source = server.add_source(source);
        variable.data_type = NodeId{0, id::Int32};
        model::NewNode node;
        node.id = NodeId{1, "slow"};
        node.browse_name = QualifiedName{1, "slow"};
        node.parent = server.address_space().find(id::ObjectsFolder);
        REQUIRE(server.address_space().add_variable(node, variable));
    }
    static ReadRequest read(const NodeId& node, std::size_t times = 1)
    {
        ReadRequest request;
        request.nodes_to_read.resize(times);
        for (ReadValueId& value : request.nodes_to_read) {
            value.node_id = node;
            value.attribute_id = 13;
        }
        return request;
    }
    static ReadRequest slow() { return read(NodeId{1, "slow"}); }
    static ReadRequest fast() { return read(NodeId{0, id::Server_ServerStatus_State}); }
};

/// What the response to a Read says, or why there is none.
inline StatusCode answer(TestClient& client, std::uint32_t request)
{
    const auto response = client.take<ReadResponse>(request);
    return response ? response->response_header.service_result : response.error();
}

} // namespace busbar::test
