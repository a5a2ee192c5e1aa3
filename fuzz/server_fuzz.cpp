#include <cstdint>
#include <vector>

#include <busbar/types/registry.hpp>

#include "fuzz_script.hpp"
#include "server_session.hpp"

namespace server_fuzz {

using namespace busbar;
using Fixture = fuzz::ServerSession;

namespace {

/// Any request of namespace 0, its fields as the script decodes them, with a valid session.
void send_request(Fixture& fixture, fuzz::Script& script)
{
    const auto table = binary::namespace0_types();
    const std::size_t choice = script.byte() + std::size_t{script.byte()} * 256;
    const StructureType& type = *table[choice % table.size()];
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode(writer, type.binary_encoding_id.in(0));
    RequestHeader header;
    header.authentication_token = fixture.token;
    header.timeout_hint = script.byte();
    encode(writer, header);
    writer.bytes(script.bytes(script.byte() * std::size_t{4}));
    fixture.send_body(sink.take(writer.written()));
}

void play(Fixture& fixture, fuzz::Script& script)
{
    if (script.byte() % 4 != 0) {
        fixture.log_in();
    }
    for (int step = 0; step < 24 && !script.is_over(); ++step) {
        switch (script.byte() % 8) {
        case 0:
            static_cast<void>(fixture.connection->feed(script.bytes(script.byte()), fixture.now));
            fixture.run();
            break;
        case 1:
            fixture.send_body(script.bytes(script.byte()));
            break;
        case 2:
            fixture.pass(std::chrono::seconds{script.byte()});
            break;
        default:
            send_request(fixture, script);
        }
        fixture.responses.clear();
    }
}

} // namespace

/// A whole server connection: raw bytes, message bodies and requests of a session, and time.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    static fuzz::KeptServer<Fixture> kept;
    fuzz::Script script{{data, size}};
    play(kept.begin(), script);
    kept.end();
    return 0;
}

} // namespace server_fuzz
