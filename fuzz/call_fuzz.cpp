#include <cstdint>
#include <deque>
#include <vector>

#include <busbar/server/method_table.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/method.hpp>

#include "fuzz_script.hpp"
#include "server_session.hpp"

namespace call_fuzz {

using namespace busbar;

namespace {

/// Everybody may call.
class Users final : public server::UserStore {
public:
    [[nodiscard]] Result<server::UserIdentity> log_in(std::string_view, std::string_view) override
    {
        return fail(status::Bad_UserAccessDenied);
    }
    [[nodiscard]] server::UserIdentity anonymous() const override { return {}; }
};

/// What outlives the server.
struct Backend {
    Users users;
    server::MethodTable table;
    std::deque<server::MethodCall> calls;
};

/// A server with Methods that echo their input, one by one with another type of it.
struct Fixture : Backend, fuzz::ServerSession {
    Fixture() : fuzz::ServerSession{&users}
    {
        const std::uint32_t source = server.add_source(table);
        auto& space = server.address_space();
        for (const std::uint32_t type : {id::Int32, id::String, id::Argument, id::BaseDataType}) {
            model::NewNode node;
            node.id = NodeId{1, type};
            node.browse_name = QualifiedName{1, String{std::to_string(type)}};
            node.parent = space.find(id::Server);
            model::NewMethod method;
            method.input_arguments = {{"value", NodeId{0, type}, type == id::Int32 ? -1 : -2}};
            method.output_arguments = method.input_arguments;
            method.source = source;
            method.handle =
                table.add([this](server::MethodCall call) { calls.push_back(std::move(call)); });
            static_cast<void>(space.add_method(node, method));
        }
    }
    /// Answers the oldest call with what it was given, or as the script says.
    void answer(std::uint8_t how)
    {
        if (calls.empty()) {
            return;
        }
        server::MethodCall call = std::move(calls.front());
        calls.pop_front();
        if (how % 4 == 0) {
            call.refuse(Array<StatusCode>(how % 3U));
        } else if (how % 4 == 1) {
            call.succeed(Array<Variant>{call.inputs()});
        } else if (how % 4 == 2) {
            call.succeed(Array<Variant>(how % 5U));
        }
        server.handle_completions(now);
        run();
    }
};

/// One Call whose arguments are as the script decodes them.
void send_call(Fixture& fixture, fuzz::Script& script)
{
    static constexpr std::uint32_t ids[] = {id::Server_GetMonitoredItems, id::Server_ResendData,
                                            id::Server, id::ServerType_GetMonitoredItems};
    static constexpr std::uint32_t types[] = {id::Int32, id::String, id::Argument,
                                              id::BaseDataType};
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode(writer, NodeId{0, CallRequest::binary_encoding_id});
    RequestHeader header;
    header.authentication_token = fixture.token;
    header.timeout_hint = script.byte();
    encode(writer, header);
    const std::size_t count = script.byte() % 4U;
    writer.length(count);
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint8_t choice = script.byte();
        encode(writer, NodeId{0, (choice & 64U) == 0 ? id::Server : id::ServerType});
        encode(writer,
               (choice & 128U) == 0 ? NodeId{1, types[choice % 4]} : NodeId{0, ids[choice % 4]});
        writer.bytes(script.bytes(script.byte()));
    }
    fixture.send_body(sink.take(writer.written()));
}

void play(Fixture& fixture, fuzz::Script& script)
{
    fixture.log_in();
    for (int step = 0; step < 24 && !script.is_over(); ++step) {
        switch (script.byte() % 8) {
        case 0:
            fixture.answer(script.byte());
            break;
        case 1:
            fixture.pass(std::chrono::seconds{script.byte() % 8});
            break;
        case 2:
            if (script.byte() % 8 == 0) {
                fixture.send(CloseSessionRequest{});
            }
            break;
        default:
            send_call(fixture, script);
        }
        fixture.responses.clear();
    }
}

} // namespace

/// Calls with any arguments to a server's own Methods and a backend's, answers of the backend,
/// time and the end of the session in any order.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    static fuzz::KeptServer<Fixture> kept;
    fuzz::Script script{{data, size}};
    Fixture& fixture = kept.begin();
    play(fixture, script);
    fixture.calls.clear();
    kept.end();
    return 0;
}

} // namespace call_fuzz
