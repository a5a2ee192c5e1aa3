#include "hostile.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <thread>
#include <utility>

#include <busbar/core/text.hpp>
#include <busbar/types/common.hpp>
#include <busbar/types/discovery.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/view.hpp>

#include "administration_calls.hpp"
#include "good_client.hpp"
#include "passwords.hpp"
#include "quotas.hpp"
#include "replay.hpp"
#include "tally.hpp"

namespace busbar::bench {

namespace {

using namespace std::chrono_literals;

/// Between two attempts of one that is refused.
constexpr std::chrono::milliseconds pause{1};
/// How long a Call of many Methods is waited for.
constexpr double call_seconds{30};
/// Of a bomb's size, for all but what explodes.
constexpr std::size_t room_for_headers = 64U << 10U;

/// One parameter, an array of arrays of DiagnosticInfo: each takes one byte and becomes an object
/// of some hundred.
ByteString bomb(std::size_t size)
{
    constexpr std::size_t in_one = 65'000;
    constexpr auto array_of = [](BuiltInType type) {
        return static_cast<std::uint8_t>(0x80U | static_cast<std::uint8_t>(type));
    };
    binary::VectorSink sink;
    binary::Writer writer{sink};
    writer.length(1);
    encode(writer, QualifiedName{0, "parameter"});
    writer.number(array_of(BuiltInType::Variant));
    const std::size_t arrays = std::max<std::size_t>(size / in_one, 1);
    writer.length(arrays);
    const std::vector<std::byte> infos(std::min(size, in_one));
    for (std::size_t i = 0; i < arrays; ++i) {
        writer.number(array_of(BuiltInType::DiagnosticInfo));
        writer.length(infos.size());
        writer.bytes(infos);
    }
    const auto bytes = sink.take(writer.written());
    return ByteString{bytes};
}

/// Whether the server answered; Bad_RequestTooLarge or the like if the request was never sent.
Result<bool> send_bomb(net::ClientLoop& loop, GetEndpointsRequest& request)
{
    const auto sent =
        loop.client().send_encoded([&](binary::Writer& writer, const RequestHeader& header) {
            auto additional = std::move(request.request_header.additional_header);
            request.request_header = header;
            request.request_header.additional_header = std::move(additional);
            encode(writer, NodeId{0, GetEndpointsRequest::binary_encoding_id});
            encode(writer, request);
        });
    if (!sent) {
        return fail(sent.error());
    }
    const auto event = loop.wait(patience);
    return event && event->kind == client::ConnectionEvent::Kind::Response &&
           event->status.is_good();
}

/// Who has no session sends the largest bomb that the server says it takes, again and again.
void bomb_without_session(Load& load, std::size_t size, Tally& tally)
{
    GetEndpointsRequest request;
    const auto load_bomb = [&] {
        request.request_header.additional_header = ExtensionObject::from_binary(
            NodeId{0, AdditionalParametersType::binary_encoding_id}, bomb(size));
    };
    size = size > 2 * room_for_headers ? size - room_for_headers : size;
    load_bomb();
    while (!tally.is_over) {
        net::ClientLoop loop;
        if (!load.open(loop, false, patience)) {
            ++tally.refused;
            std::this_thread::sleep_for(pause);
            continue;
        }
        const auto answered = send_bomb(loop, request);
        if (answered) {
            ++(*answered ? tally.answered : tally.refused);
        } else if (size > 1'000) {
            size /= 2;
            load_bomb();
        } else {
            ++tally.refused;
            return;
        }
        loop.close();
    }
}

/// What costs a server most for its size: of all instances of a type none is to be told.
BrowseRequest dear_browse(std::size_t nodes)
{
    BrowseDescription one;
    one.node_id = NodeId{0, id::PropertyType};
    one.browse_direction = BrowseDirection::Inverse;
    one.include_subtypes = true;
    one.node_class_mask = static_cast<std::uint32_t>(NodeClass::ReferenceType);
    BrowseRequest request;
    request.nodes_to_browse.resize(nodes);
    std::fill(request.nodes_to_browse.begin(), request.nodes_to_browse.end(), one);
    return request;
}

/// Keeps Browses under way on one connection until it ends or the attack is over.
void browse_on(net::ClientLoop& loop, const HostileOptions& options, Tally& tally)
{
    BrowseRequest request = dear_browse(options.nodes);
    std::size_t open = 0;
    while (!tally.is_over) {
        for (; open < options.in_flight && loop.client().send(request); ++open) {
        }
        if (open == 0) { // not even one could be sent
            ++tally.refused;
            return;
        }
        const auto event = loop.wait(100ms);
        if (event && event->kind != client::ConnectionEvent::Kind::Response) {
            tally.refused += open;
            return;
        }
        if (event) {
            --open;
            ++(event->status.is_good() ? tally.answered : tally.refused);
        }
    }
    loop.close();
}

void browse_for_ever(Load& load, const HostileOptions& options, Tally& tally)
{
    while (!tally.is_over) {
        net::ClientLoop loop;
        if (load.open(loop, true, patience)) {
            browse_on(loop, options, tally);
        } else {
            ++tally.refused;
            std::this_thread::sleep_for(pause);
        }
    }
}

/// The good client reads while `attackers` threads do `what`.
Result<HostileRow> play(Load& load, const HostileOptions& options, std::string name,
                        std::size_t attackers, const std::function<void(Tally&, std::size_t)>& what)
{
    HostileRow row;
    row.attack = std::move(name);
    GoodClient client{load};
    if (const auto connected = client.connect(); !connected) {
        return fail(connected.error());
    }
    std::optional<GoodSubscriber> subscriber;
    if (!options.replays.empty() || !options.quotas.empty()) {
        subscriber.emplace(load);
    }
    forget_peak(options.server_process);
    if (options.take_longest_piece_ms) {
        static_cast<void>(options.take_longest_piece_ms());
    }
    row.before = memory_of(options.server_process);
    Tally tally;
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < attackers; ++i) {
        threads.emplace_back([&, i] { what(tally, i); });
    }
    std::optional<Newcomers> newcomers;
    if (!options.quotas.empty()) {
        newcomers.emplace(load, tally, row, 1, 5);
    } else if (!options.passwords.empty()) {
        newcomers.emplace(load, tally, row, 10, 10);
    }
    const auto goes_on = [&](double seconds) {
        return !options.is_administration || attackers == 0
                   ? seconds < options.seconds
                   : !tally.is_done && seconds < call_seconds;
    };
    auto read = client.read_while(goes_on, row);
    newcomers.reset();
    if (subscriber) {
        const auto subscribed = subscriber->finish(row);
        read = read ? subscribed : read;
    }
    tally.is_over = true;
    for (std::thread& thread : threads) {
        thread.join();
    }
    row.after = memory_of(options.server_process);
    row.longest_piece_ms = options.take_longest_piece_ms ? options.take_longest_piece_ms() : 0;
    row.answered = tally.answered;
    row.refused = tally.refused;
    if (!read) {
        return fail(read.error());
    }
    client.leave();
    return row;
}

Result<std::vector<HostileRow>> play_all(Load& load, const HostileOptions& options,
                                         const std::vector<Attack>& attacks)
{
    std::vector<HostileRow> rows;
    for (const Attack& one : attacks) {
        auto row = play(load, options, one.name, one.attackers, one.what);
        if (!row) {
            return fail(row.error());
        }
        rows.push_back(*std::move(row));
    }
    return rows;
}

Result<std::vector<HostileRow>> replay_all(Load& load, const HostileOptions& options)
{
    const auto overheard = overhear(load, load.url());
    if (!overheard) {
        return fail(overheard.error());
    }
    const bool is_local = overheard->host.starts_with("127.") || overheard->host == "localhost";
    const auto replay_from = [&](Tally& tally, std::size_t attacker) {
        const std::size_t number = options.has_own_addresses ? 2 + attacker % 250 : 2;
        replay(*overheard, is_local ? "127.0.0." + std::to_string(number) : std::string{}, tally);
    };
    std::vector<Attack> attacks{{"none", 0, {}}};
    for (const std::size_t attackers : options.replays) {
        attacks.push_back(
            {std::to_string(attackers) + " replay OpenSecureChannel", attackers, replay_from});
    }
    return play_all(load, options, attacks);
}

Result<std::vector<HostileRow>> take_all(Load& load, const HostileOptions& options)
{
    Options other;
    other.url = load.url();
    Load strangers{other};
    other.policy = "Basic256Sha256";
    other.mode = "SignAndEncrypt";
    other.user = "nobody";
    other.password = "Wrong-Password-1";
    Load guessers{other};
    if (const auto prepared = guessers.prepare(); !prepared) {
        return fail(prepared.error());
    }
    std::vector<Attack> attacks{{"none", 0, {}}};
    for (Attack& one : quota_attacks(strangers, guessers, options.quotas)) {
        attacks.push_back(std::move(one));
    }
    return play_all(load, options, attacks);
}

/// Who changes passwords costs as much as who logs in.
Result<std::vector<HostileRow>> change_all(Load& load, const HostileOptions& options)
{
    Options administrator;
    administrator.url = load.url();
    administrator.policy = "Basic256Sha256";
    administrator.mode = "SignAndEncrypt";
    administrator.user = options.callers.front();
    administrator.password = options.password;
    administrator.identity = options.identity;
    const auto attackers = PasswordAttackers::add(
        administrator, *std::max_element(options.passwords.begin(), options.passwords.end()));
    if (!attackers) {
        return fail(attackers.error());
    }
    std::vector<Attack> attacks{{"none", 0, {}}};
    for (const std::size_t count : options.passwords) {
        attacks.push_back(attackers->attack(count));
    }
    return play_all(load, options, attacks);
}

/// A user of administration in a session, which is made again when it is lost: the server may have
/// another certificate by then.
class Caller {
public:
    Caller(const Load& load, const HostileOptions& options, std::string user)
        : user_{std::move(user)}, load_{options_of(load, options, user_)}
    {
    }

    [[nodiscard]] Result<void> connect()
    {
        loop_ = std::make_unique<net::ClientLoop>();
        const auto prepared = load_.prepare();
        return prepared ? load_.open(*loop_, true, patience) : prepared;
    }
    [[nodiscard]] net::ClientLoop& loop() { return *loop_; }
    [[nodiscard]] const std::string& user() const { return user_; }

private:
    static Options options_of(const Load& load, const HostileOptions& options,
                              const std::string& user)
    {
        Options his;
        his.url = load.url();
        his.policy = "Basic256Sha256";
        his.mode = "SignAndEncrypt";
        his.user = user;
        his.password = options.password;
        his.identity = options.identity;
        return his;
    }

    std::string user_;
    Load load_;
    std::unique_ptr<net::ClientLoop> loop_;
};

/// One Call of many of the Method, while the good client reads.
Result<HostileRow> call_many(Load& load, const HostileOptions& options, Caller& caller,
                             AdministrationCalls& calls, const AdministrationMethod& method)
{
    std::string status;
    const auto call = [&](Tally& tally, std::size_t) {
        const auto outcome = calls.call(caller.loop(), method, options.calls);
        if (outcome) {
            tally.answered = outcome->good;
            tally.refused = outcome->bad;
        }
        status = outcome ? outcome->status : std::string{name(outcome.error())};
        tally.is_done = true;
    };
    auto row = play(load, options, caller.user() + " " + method.name, 1, call);
    if (row) {
        row->status = std::move(status);
    }
    return row;
}

/// All that one user may call, a row for each Method.
Result<void> call_all_of(Load& load, const HostileOptions& options, Caller caller,
                         std::vector<HostileRow>& rows)
{
    auto connected = caller.connect();
    const auto methods = connected ? find_methods(caller.loop()) : fail(connected.error());
    if (!methods) {
        return fail(methods.error());
    }
    AdministrationCalls calls;
    for (const AdministrationMethod& method : *methods) {
        auto row = call_many(load, options, caller, calls, method);
        if (row && row->answered + row->refused == 0) {
            if (connected = caller.connect(); !connected) {
                return connected;
            }
            // The connection may have ended since the last Method; what takes too long is no other
            // the second time.
            const bool was_late = row->status == name(StatusCode{status::Bad_Timeout});
            row = was_late ? std::move(row) : call_many(load, options, caller, calls, method);
        }
        if (!row) {
            return fail(row.error());
        }
        rows.push_back(*std::move(row));
    }
    caller.loop().close();
    return {};
}

Result<std::vector<HostileRow>> call_all(Load& load, const HostileOptions& options)
{
    auto rows = play_all(load, options, {{"none", 0, {}}});
    for (const std::string& caller : options.callers) {
        const auto done = rows ? call_all_of(load, options, Caller{load, options, caller}, *rows)
                               : fail(rows.error());
        if (!done) {
            return fail(done.error());
        }
    }
    return rows;
}

} // namespace

SubscribeOptions good_subscription(double seconds)
{
    SubscribeOptions options;
    options.item_counts = {1};
    options.moving = options.still = "i=" + std::to_string(id::Server_ServerStatus_CurrentTime);
    options.publishing_ms = options.sampling_ms = 50;
    options.seconds = seconds;
    options.warm_up_seconds = std::chrono::duration<double>{GoodSubscriber::warm_up}.count() + 0.1;
    return options;
}

Result<std::vector<HostileRow>> attack(Load& load, const HostileOptions& options)
{
    if (!options.replays.empty()) {
        return replay_all(load, options);
    }
    if (!options.quotas.empty()) {
        return take_all(load, options);
    }
    if (!options.passwords.empty()) {
        return change_all(load, options);
    }
    if (!options.callers.empty()) {
        return call_all(load, options);
    }
    return play_all(
        load, options,
        {{"none", 0, {}},
         {"decode bomb before login", 1,
          [&](Tally& tally, std::size_t) { bomb_without_session(load, options.bomb_size, tally); }},
         {"Browses of " + std::to_string(options.connections) + " connections", options.connections,
          [&](Tally& tally, std::size_t) { browse_for_ever(load, options, tally); }}});
}

} // namespace busbar::bench
