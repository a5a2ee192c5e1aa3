#include "mapped_fixture.hpp"

namespace mapped_service_results_test {

// What a whole service answers, not each of its nodes (SH-082679, 8.1).

using namespace busbar;
using namespace busbar::test;

namespace {

struct Fixture : MappedFixture {
    explicit Fixture(const MappedOptions& options = {}) : MappedFixture{options}
    {
        plc->add("Speed", LabelType::Word, std::int16_t{1480});
        plc->add("H", LabelType::UnsignedWord, std::uint16_t{0});
        speed = add("speed", id::Int16, {"Speed"});
        model::NewVariable variable;
        variable.data_type = NodeId{0, id::Int16};
        variable.value = Variant{std::int16_t{7}};
        variable.access_level = model::Access::ReadWrite;
        REQUIRE(server.address_space().add_variable(named("kept"), variable));
        model::NewMethod method;
        method.source = index;
        method.handle = source.add(MappedMethod{own("start"), "H", {}});
        REQUIRE(server.address_space().add_method(named("start"), method));
        source.start();
    }
    /// Good, or why the service did nothing.
    template <typename Response>
    StatusCode take(std::uint32_t id)
    {
        complete();
        const auto response = client->take<Response>(id);
        return response ? response->response_header.service_result : response.error();
    }
    StatusCode read_result(const std::vector<NodeId>& nodes)
    {
        return take<ReadResponse>(send_read(nodes));
    }
    std::uint32_t send_write(const std::vector<NodeId>& nodes)
    {
        WriteRequest request;
        for (const NodeId& node : nodes) {
            WriteValue one;
            one.node_id = node;
            one.attribute_id = 13;
            one.value.value = Variant{std::int16_t{1}};
            request.nodes_to_write.push_back(one);
        }
        return client->send(request);
    }
    StatusCode write_result(const std::vector<NodeId>& nodes)
    {
        return take<WriteResponse>(send_write(nodes));
    }
    std::uint32_t send_call()
    {
        CallMethodRequest call;
        call.object_id = NodeId{0, id::ObjectsFolder};
        call.method_id = own("start");
        CallRequest request;
        request.methods_to_call = {call};
        return client->send(request);
    }

    NodeId speed;
};

struct Busy : Fixture {
    Busy() : Fixture{options()} { plc->is_prompt = false; }
    static MappedOptions options()
    {
        MappedOptions options;
        options.max_batches = 1;
        return options;
    }
};

} // namespace

TEST_CASE_METHOD(Fixture, "8.1 ServiceResult: what a PLC refuses Read and Write with", "[8.1]")
{
    struct Row {
        LabelStatus fault;
        StatusCode result;
    };
    const Row row = GENERATE(Row{LabelStatus::Shutdown, status::Bad_Shutdown},
                             Row{LabelStatus::TooManyOperations, status::Bad_TooManyOperations},
                             Row{LabelStatus::NoCommunication, status::Good});
    plc->fault = row.fault;
    CHECK(read_result({speed}) == row.result);
    CHECK(write_result({speed}) == row.result);
    // A value is no use when others are missing, but what has been written is to be told.
    CHECK(read_result({own("kept"), speed}) == row.result);
    CHECK(write_result({own("kept"), speed}) == status::Good);
    CHECK(read_result({own("kept")}) == status::Good);
}

TEST_CASE_METHOD(Fixture, "8.1 ServiceResult: Bad_Shutdown is a Call's, and too much each Method's",
                 "[8.1]")
{
    plc->fault = LabelStatus::Shutdown;
    CHECK(take<CallResponse>(send_call()) == status::Bad_Shutdown);
    plc->fault = LabelStatus::TooManyOperations;
    const auto sent = send_call();
    complete();
    const auto response = client->take<CallResponse>(sent);
    REQUIRE(response);
    CHECK(response->results[0].status_code == status::Bad_TooManyOperations);
    // It is not taken for one that runs still.
    plc->fault = LabelStatus::Done;
    CHECK(take<CallResponse>(send_call()) == status::Good);
    CHECK(plc->get<std::uint16_t>("H") == 1);
}

TEST_CASE_METHOD(Busy, "8.1 ServiceResult: more requests than may wait", "[8.1]")
{
    const auto first = send_read({speed});
    CHECK(read_result({speed}) == status::Bad_TooManyOperations);
    CHECK(write_result({speed}) == status::Bad_TooManyOperations);
    plc->answer();
    CHECK(take<ReadResponse>(first) == status::Good);
}

TEST_CASE_METHOD(Fixture, "8.1 ServiceResult: a server that is stopping", "[8.1]")
{
    plc->is_prompt = false;
    const auto read = send_read({speed});
    const auto write = send_write({speed});
    const auto call = send_call();
    server.begin_shutdown(now, "maintenance");
    CHECK(take<ReadResponse>(read) == status::Bad_Shutdown);
    CHECK(take<WriteResponse>(write) == status::Bad_Shutdown);
    CHECK(take<CallResponse>(call) == status::Bad_Shutdown);
    CHECK(write_result({speed}) == status::Bad_Shutdown);
    CHECK(take<CallResponse>(send_call()) == status::Bad_Shutdown);
    plc->answer(); // for nobody
}

} // namespace mapped_service_results_test
