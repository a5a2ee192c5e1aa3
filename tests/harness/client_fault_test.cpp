#include <catch2/catch.hpp>

#include <busbar/harness/catch.hpp>

#include "fault_plant.hpp"
#include "support/effort.hpp"

namespace client_fault_test {

using namespace busbar;
using namespace busbar::harness;
using namespace std::chrono_literals;
using client::ClientState;
using test::is_full_effort;

namespace {

/// The one server that an administrator trusts.
class TrustsOne final : public crypto::CertificateValidator {
public:
    [[nodiscard]] Checked<void> validate(const crypto::CertificateChain& chain,
                                         const crypto::ValidationContext&) override
    {
        if (chain.front() == FaultPlant::identity("server").certificates.front()) {
            return {};
        }
        return refuse(Refusal{status::Bad_CertificateUntrusted, "Trust List Check",
                              "another server", "Part 4, 6.1.3", ""});
    }
};

enum class Loss : std::uint8_t { None, Possible };

/// The fault acts, and soon the Client has everything that it had before; afterwards the server
/// has nothing left of it.
void survive(FaultPlant& plant, Loss loss)
{
    CHECK(plant.world.run_until([&] { return plant.world.network().pending_faults().empty(); }));
    // Until values come that were set when all had time enough to go wrong.
    const std::int32_t later = plant.last_set() + 30;
    CHECK(plant.world.run_until(
        [&] { return plant.state() == ClientState::Ready && plant.last_seen() > later; }, 45s));
    plant.world.run_for(2s);
    CHECK(plant.finish());
    // What half-made connections have left behind times out.
    CHECK(plant.world.run_until([&] { return plant.holds_one_of_each(); }, 2min));
    CAPTURE(plant.server().session_count(), plant.server().subscription_count(),
            plant.server().monitored_item_count());
    CHECK(plant.holds_one_of_each());
    CHECK(plant.state() == ClientState::Ready);
    plant.close();
    CHECK(plant.has_answers_to_all());
    CHECK(plant.answers() > plant.errors() + 5);
    CHECK(plant.complaints() == "");
    CHECK((loss == Loss::Possible || plant.gaps.empty()));
    CHECK(plant.world.run_until([&] { return plant.holds_nothing(); }, 3min));
}

/// The round's 37th of a long script is played unless the effort is full. The faults of a script,
/// and its moments, are never a multiple of 37, so each of them occurs.
[[nodiscard]] bool is_played(std::size_t index, std::size_t count)
{
    constexpr std::size_t parts = 37;
    return is_full_effort() || count <= 30 || index % parts == test::part_of_round("faults", parts);
}

void survive_all(const FaultScript& faults, bool is_secure, Loss loss = Loss::None)
{
    std::size_t index = 0;
    for (const Fault& fault : faults) {
        if (!is_played(index++, faults.size())) {
            continue;
        }
        INFO(describe(fault) << (is_secure ? ", encrypted" : ""));
        PlantOptions options;
        options.is_secure = is_secure;
        FaultPlant plant{options};
        plant.world.network().play(fault);
        plant.start();
        survive(plant, loss);
    }
}

/// A cable is pulled after all went well.
void isolate(FaultPlant& plant, Duration time)
{
    plant.start();
    plant.world.run_for(10s);
    REQUIRE(plant.holds_one_of_each());
    plant.world.network().play(fault::hold());
    plant.world.network().refuse();
    plant.world.run_for(time);
}

/// Where something goes wrong: a message, and the connection that it is sent on. Without security
/// the connection that endpoints are asked for over has the session.
struct Place {
    Message message;
    std::size_t connection{1};
};

const std::vector<Place> first_steps{{{"HEL"}}, {{"ACK"}}, {{"OPN"}}};
const std::vector<Place> requests{
    {{"GetEndpointsRequest"}}, {{"CreateSessionRequest"}},      {{"ActivateSessionRequest"}},
    {{"ReadRequest"}},         {{"CreateSubscriptionRequest"}}, {{"CreateMonitoredItemsRequest"}},
    {{"PublishRequest"}},      {{"PublishRequest", 9}},         {{"ReadRequest", 9}},
};
const std::vector<Place> responses{
    {{"GetEndpointsResponse"}},
    {{"CreateSessionResponse"}},
    {{"ActivateSessionResponse"}},
    {{"ReadResponse"}},
    {{"CreateSubscriptionResponse"}},
    {{"CreateMonitoredItemsResponse"}},
    {{"PublishResponse"}},
    {{"PublishResponse", 9}},
    {{"ReadResponse", 9}},
};

using Places = std::vector<Place>;

[[nodiscard]] Places all_places()
{
    Places all = first_steps;
    all.push_back({{"OPN", 2}}); // the renewal
    all.insert(all.end(), requests.begin(), requests.end());
    all.insert(all.end(), responses.begin(), responses.end());
    return all;
}
/// The second connection has the session. Nobody sees what a message is, only how many there were.
[[nodiscard]] Places secure_places()
{
    Places all = first_steps;
    all.push_back({{"OPN"}, 2});
    all.push_back({{"OPN", 2}, 2});
    for (const std::size_t number : {1U, 2U, 3U, 4U, 5U, 6U, 7U, 8U, 20U}) {
        all.push_back({{"MSG", number}, 2});
    }
    return all;
}

enum class When : std::uint8_t { Before, At, After };

[[nodiscard]] Fault put(const Fault& fault, const Place& place, When when)
{
    const Fault here = fault.on_connection(place.connection);
    if (when == When::Before) {
        return here.before(place.message);
    }
    return when == When::At ? here.at(place.message) : here.after(place.message);
}
[[nodiscard]] FaultScript at(const Places& places, const FaultScript& faults,
                             std::initializer_list<When> moments)
{
    FaultScript script;
    for (const Place& place : places) {
        for (const Fault& fault : faults) {
            for (const When when : moments) {
                script.push_back(put(fault, place, when));
            }
        }
    }
    return script;
}

/// What TCP, a cable and an unlucky moment can do.
[[nodiscard]] FaultScript of_the_wire()
{
    return {fault::cut(),
            fault::hold(3s),
            fault::hold(25s),
            fault::hold(),
            fault::hold().sent_by(Side::Client),
            fault::hold().sent_by(Side::Server),
            fault::half_open(),
            fault::half_open().sent_by(Side::Server)};
}

} // namespace

TEST_CASE("a Client survives faults of the wire at every message", "[harness]")
{
    survive_all(at(all_places(), of_the_wire(), {When::Before, When::After}), false);
}

TEST_CASE("a Client survives faults of the wire at every message that is encrypted", "[harness]")
{
    FaultScript by_server;
    for (const Fault& fault : at(secure_places(), {fault::cut()}, {When::Before, When::After})) {
        if (fault.message->name == "MSG") {
            by_server.push_back(fault.sent_by(Side::Server));
        }
    }
    survive_all(by_server, true);
    survive_all(at(secure_places(), of_the_wire(), {When::After}), true);
}

TEST_CASE("a Client survives messages that are late or come in pieces", "[harness]")
{
    const FaultScript faults{fault::delay(2s), fault::delay(12s), fault::delay(30s), fault::split(),
                             fault::split(7)};
    survive_all(at(all_places(), faults, {When::At}), false);
    survive_all(at(secure_places(), faults, {When::At}), true);
}

TEST_CASE("a Client survives headers that are broken", "[harness]")
{
    // Type, final or not, size, channel, token, sequence number (Part 6, 6.7.2.2).
    survive_all(at(all_places(),
                   {fault::corrupt(0), fault::corrupt(3, 4), fault::corrupt(4),
                    fault::corrupt(7, 7), fault::corrupt(8), fault::corrupt(9, 6)},
                   {When::At}),
                false);
}

TEST_CASE("a Client survives broken bits of what is encrypted", "[harness]")
{
    survive_all(
        at(secure_places(),
           {fault::corrupt(12), fault::corrupt(16), fault::corrupt(40, 7), fault::corrupt(100'000)},
           {When::At}),
        true);
}

TEST_CASE("a Client survives requests that are answered with a fault", "[harness]")
{
    survive_all(
        at(requests,
           {fault::answer(status::Bad_Timeout), fault::answer(status::Bad_InternalError),
            fault::answer(status::Bad_OutOfMemory), fault::answer(status::Bad_TooManyOperations),
            fault::answer(status::Bad_ServerTooBusy).times(3)},
           {When::At}),
        false);
}

TEST_CASE("a Client survives that its session is gone", "[harness]")
{
    survive_all(at(requests, {fault::answer(status::Bad_SessionIdInvalid)}, {When::At}), false,
                Loss::Possible);
}

TEST_CASE("a Client survives that the time of day jumps", "[harness]")
{
    const FaultScript faults{fault::jump_clock(6h), fault::jump_clock(-6h)};
    survive_all(at(all_places(), faults, {When::Before}), false);
    survive_all(at(secure_places(), faults, {When::After}), true);
}

TEST_CASE("a Client survives that it is refused", "[harness]")
{
    survive_all({fault::refuse(), fault::refuse().times(5)}, GENERATE(false, true));
}

TEST_CASE("a Client finds a server again that was started anew, whatever it lost", "[harness]")
{
    PlantOptions options;
    options.is_secure = GENERATE(false, true);
    FaultPlant plant{options};
    plant.start();
    for (const Duration outage : {0s, 3s, 20s}) {
        plant.world.run_for(10s);
        plant.stop_server();
        plant.world.run_for(outage);
        plant.start_server(FaultPlant::identity("server"));
    }
    survive(plant, Loss::Possible);
    CHECK(plant.gaps.size() == 3);
}

TEST_CASE("a Client gives up a server that comes back with another certificate", "[harness]")
{
    TrustsOne validator;
    PlantOptions options;
    options.is_secure = true;
    options.validator = &validator;
    FaultPlant plant{options};
    plant.start();
    plant.world.run_for(10s);
    REQUIRE(plant.state() == ClientState::Ready);
    plant.stop_server();
    plant.start_server(FaultPlant::identity("impostor"));
    plant.world.run_for(45s);
    CHECK(plant.state() == ClientState::Closed);
    CHECK(plant.client().last_error() == status::Bad_CertificateUntrusted);
    plant.world.run_for(10s);
    CHECK(plant.server().session_count() == 0);
    CHECK(plant.complaints() == "");
}

TEST_CASE("a Client that is not let in gives up", "[harness]")
{
    const StatusCode why =
        GENERATE(as<StatusCode>{}, status::Bad_UserAccessDenied, status::Bad_IdentityTokenRejected);
    FaultPlant plant;
    plant.world.network().play(fault::answer(why).at(Message{"ActivateSessionRequest"}));
    plant.start();
    plant.world.run_for(20s);
    CHECK(plant.state() == ClientState::Closed);
    CHECK(plant.client().last_error() == why);
    CHECK(plant.world.run_until([&] { return plant.holds_nothing(); }, 3min));
}

TEST_CASE("a Client takes its Subscription over when its session has timed out", "[harness]")
{
    PlantOptions options;
    options.is_secure = GENERATE(false, true);
    options.session_timeout = 10s;
    options.subscription_lifetime = 90s;
    FaultPlant plant{options};
    isolate(plant, 1min);
    CHECK(plant.server().session_count() == 0);
    CHECK(plant.server().subscription_count() == 1);
    plant.world.network().refuse(false);
    survive(plant, Loss::Possible);
    // An anonymous user without security cannot prove whose it is (Part 4, 5.14.7.1).
    CHECK(plant.gaps.size() == (options.is_secure ? 0 : 1));
}

TEST_CASE("a Client makes its Subscription anew that has timed out", "[harness]")
{
    PlantOptions options;
    options.is_secure = GENERATE(false, true);
    options.session_timeout = 5min;
    options.subscription_lifetime = 10s;
    FaultPlant plant{options};
    isolate(plant, 1min);
    CHECK(plant.server().session_count() == 1);
    CHECK(plant.server().subscription_count() == 0);
    plant.world.network().refuse(false);
    survive(plant, Loss::Possible);
    CHECK(plant.gaps.size() == 1);
}

} // namespace client_fault_test
