#include <catch2/catch.hpp>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <openssl/evp.h>

#include <busbar/crypto/password_hash.hpp>
#include <busbar/server/server.hpp>
#include <busbar/server/worst_case_memory.hpp>

namespace worst_case_names_test {

using namespace busbar;

namespace {

struct Source {
    const char* file;
    const char* structure;
    const char* prefix;
};

constexpr Source sources[] = {
    {"channel/channel_types.hpp", "TransportLimits", "transport."},
    {"binary/reader.hpp", "DecodeLimits", "decode."},
    {"server/limits.hpp", "OperationLimits", "operations."},
    {"server/limits.hpp", "ServerLimits", ""},
    {"server/event_limits.hpp", "EventFilterLimits", "events.filter."},
    {"server/event_limits.hpp", "EventLimits", "events."},
    {"server/subscription_limits.hpp", "SubscriptionLimits", "subscriptions."},
};

/// Times, and what is a bound of work or of something that is paid for anyhow.
const std::set<std::string> holds_nothing{
    "channel_interval",
    "decode.max_array_length",
    "decode.max_byte_string_length",
    "decode.max_depth",
    "decode.max_diagnostic_depth",
    "failed_channel_interval",
    "first_login_delay",
    "login_lock",
    "max_browse_path_elements",
    "max_channel_burst",
    "max_channel_delay",
    "max_channel_failures",
    "max_connections_per_address",
    "max_log_lines_per_minute",
    "max_login_delay",
    "max_login_failures",
    "max_login_failures_per_source",
    "max_session_timeout",
    "max_sessionless_message",
    "max_sessions_per_channel",
    "max_sessions_per_user",
    "max_token_lifetime",
    "min_session_timeout",
    "min_token_lifetime",
    "activation_timeout",
    "send_timeout",
    "sessionless_timeout",
    "subscriptions.max_keep_alive",
    "subscriptions.max_lifetime",
    "subscriptions.max_notifications_per_publish",
    "subscriptions.max_publishing_interval",
    "subscriptions.max_subscriptions_per_session",
    "subscriptions.max_subscriptions_per_user",
    "subscriptions.min_keep_alive",
    "subscriptions.min_lifetime",
    "subscriptions.min_publishing_interval",
    "subscriptions.sampling.max_interval",
    "subscriptions.sampling.min_interval",
    "transport.handshake_timeout",
    "transport.max_chunk_count",
};

/// The members with an initialiser, which are the limits.
std::set<std::string> members(const Source& source)
{
    std::ifstream file{std::string{BUSBAR_SOURCE_DIR "/include/busbar/"} + source.file};
    const std::string text{std::istreambuf_iterator<char>{file}, {}};
    const std::size_t begin = text.find("struct " + std::string{source.structure} + " {");
    REQUIRE(begin != std::string::npos);
    const std::string body = text.substr(begin, text.find("\n};", begin) - begin);
    static const std::regex member{R"(\n    [A-Za-z_0-9:]+ ([a-z_0-9]+)\{)"};
    std::set<std::string> names;
    for (std::sregex_iterator at{body.begin(), body.end(), member}, end; at != end; ++at) {
        names.insert(source.prefix + (*at)[1].str());
    }
    return names;
}

std::vector<server::MemoryRow> rows_of(const server::ServerLimits& limits, const std::string& name)
{
    std::vector<server::MemoryRow> found;
    for (const server::MemoryRow& row : server::worst_case_memory(limits).rows) {
        if (row.limit == name) {
            found.push_back(row);
        }
    }
    REQUIRE_FALSE(found.empty());
    return found;
}

} // namespace

TEST_CASE("each limit has a row, and each row a limit")
{
    std::set<std::string> in_headers{"subscriptions.sampling.min_interval",
                                     "subscriptions.sampling.max_interval",
                                     "MemoryAssumptions::password_cost"};
    for (const Source& source : sources) {
        const auto found = members(source);
        CHECK(found.size() >= 2);
        in_headers.insert(found.begin(), found.end());
    }
    std::set<std::string> in_table;
    for (const server::MemoryRow& row : server::worst_case_memory({}).rows) {
        in_table.emplace(row.limit);
    }
    CHECK(in_table == in_headers);
}

TEST_CASE("what holds no memory is named, so that nothing is left out unseen")
{
    std::set<std::string> found;
    for (const server::MemoryRow& row : server::worst_case_memory({}).rows) {
        CHECK((row.count == 0) == (row.bytes_each == 0));
        CHECK((row.held.empty() ? row.bytes() == 0 : true));
        if (row.held.empty()) {
            found.emplace(row.limit);
        }
    }
    CHECK(found == holds_nothing);
}

TEST_CASE("a row follows its limit")
{
    server::ServerLimits limits;
    limits.max_sessions = 7;
    limits.max_session_memory = 1'000;
    limits.subscriptions.max_memory = 77;
    limits.transport.handshake_timeout = std::chrono::seconds{3};
    const auto memory = rows_of(limits, "max_session_memory");
    REQUIRE(memory.size() == 1);
    CHECK(memory[0].value == 1'000);
    CHECK(memory[0].unit == server::LimitUnit::Bytes);
    CHECK(memory[0].bytes() == 7'000);
    CHECK(rows_of(limits, "subscriptions.max_memory")[0].bytes() == 77);
    CHECK(rows_of(limits, "transport.handshake_timeout")[0].value == 3'000);
    // What is not given is the default.
    limits.transport.max_message_size = 0;
    CHECK(rows_of(limits, "transport.max_message_size")[0].value == 16U << 20U);
}

TEST_CASE("sums that no number can take are the largest number")
{
    constexpr auto most = std::numeric_limits<std::uint64_t>::max();
    CHECK(server::MemoryRow{{}, 0, {}, most / 2 + 1, 2, {}}.bytes() == most);
    CHECK(server::MemoryRow{{}, 0, {}, most, 1, {}}.bytes() == most);
    CHECK(server::MemoryRow{{}, 0, {}, 3, 0, {}}.bytes() == 0);
    server::ServerLimits limits;
    limits.max_sessions = std::numeric_limits<std::size_t>::max();
    limits.max_session_memory = std::numeric_limits<std::size_t>::max();
    CHECK(server::worst_case_memory(limits).total() == most);
    CHECK(server::WorstCaseMemory{}.total() == 0);
}

TEST_CASE("small limits fit a machine of 16 MiB, but for what passwords take")
{
    const server::ServerLimits limits = server::small_controller_limits();
    const auto whole = server::Server::worst_case_memory(limits).total();
    const auto without = server::worst_case_memory(limits, {.password_checks = 0}).total();
    CHECK(without <= 16U << 20U);
    CHECK(whole - without == crypto::memory_of({}));
    CHECK(server::worst_case_memory({}).total() > whole);
    // Part 4, 5.14.1.1
    CHECK(limits.subscriptions.max_retransmission_messages >=
          2 * limits.subscriptions.max_publish_requests);
}

TEST_CASE("what a worker for channels copies is counted for each connection")
{
    const server::ServerLimits limits = server::small_controller_limits();
    const auto total = [&](bool has_worker) {
        return server::worst_case_memory(limits, {.has_channel_worker = has_worker}).total();
    };
    const auto& transport = limits.transport;
    CHECK(total(true) - total(false) ==
          limits.max_connections *
              (transport.receive_buffer_size + 2 * std::uint64_t{transport.send_buffer_size}));
}

TEST_CASE("small limits fit a machine of 16 MiB with passwords whose hashes take no memory")
{
    const server::ServerLimits limits = server::small_controller_limits();
    const auto total = [&](std::size_t checks, const crypto::PasswordCost& cost) {
        return server::worst_case_memory(limits, {.password_checks = checks, .password_cost = cost})
            .total();
    };
    const crypto::PasswordCost pbkdf2{.scheme = crypto::PasswordScheme::Pbkdf2};
    CHECK(total(1, pbkdf2) <= 16U << 20U);
    CHECK(total(2, pbkdf2) - total(0, pbkdf2) == 2 * crypto::memory_of(pbkdf2));
    const crypto::PasswordCost large{.log_n = 15};
    CHECK(total(1, large) - total(0, large) == crypto::memory_of(large));
}

TEST_CASE("a source that answers late is counted")
{
    const server::ServerLimits limits = server::small_controller_limits();
    const auto without = server::worst_case_memory(limits).total();
    server::DataSourceOptions source;
    source.max_batches = 4;
    source.max_items = 1'000;
    const server::DataSourceOptions two[] = {source, source};
    const auto one = server::worst_case_memory(limits, {.slow_sources = {two, 1}}).total();
    CHECK(one - without >= 4 * limits.transport.max_message_size);
    const auto both = server::worst_case_memory(limits, {.slow_sources = two}).total();
    CHECK(both - one == one - without);
}

TEST_CASE("hashing a password takes exactly what is said")
{
    const auto fits = [](std::uint64_t memory) {
        // Only checks its numbers if there is no place for a key.
        return EVP_PBE_scrypt(nullptr, 0, nullptr, 0, 16'384, 8, 1, memory, nullptr, 0) == 1;
    };
    CHECK(fits(crypto::memory_of({})));
    CHECK_FALSE(fits(crypto::memory_of({}) - 1));
}

TEST_CASE("limits for a machine's memory are as large as it allows")
{
    constexpr std::uint64_t mega = 1'000'000;
    std::uint64_t before = 0;
    for (const std::uint64_t memory : {64 * mega, 256 * mega, 1'000 * mega, 8'000 * mega}) {
        CAPTURE(memory);
        const auto limits = server::limits_for(memory);
        REQUIRE(limits);
        const std::uint64_t total = server::worst_case_memory(*limits).total();
        CHECK(total <= memory);
        CHECK(total > memory * 9 / 10);
        CHECK(total > before);
        before = total;
    }
    // Where there is more than the defaults can use they stay.
    const auto most = server::limits_for(std::numeric_limits<std::uint64_t>::max());
    REQUIRE(most);
    CHECK(server::worst_case_memory(*most).total() == server::worst_case_memory({}).total());

    const auto least = server::worst_case_memory(server::small_controller_limits()).total();
    CHECK(server::limits_for(least + mega));
    const auto refused = server::limits_for(mega);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().text.find(std::to_string(1'000'000)) != std::string::npos);
}

TEST_CASE("limits for a machine's memory lie between the small ones and the defaults")
{
    const auto small = server::worst_case_memory(server::small_controller_limits()).rows;
    const auto large = server::worst_case_memory({}).rows;
    const auto limits = server::limits_for(512'000'000);
    REQUIRE(limits);
    const auto between = server::worst_case_memory(*limits).rows;
    REQUIRE(between.size() == large.size());
    for (std::size_t i = 0; i < large.size(); ++i) {
        INFO(large[i].limit);
        if (large[i].unit == server::LimitUnit::Milliseconds || small[i].value == large[i].value) {
            CHECK(between[i].value == large[i].value);
        } else if (large[i].limit != "max_channel_burst") { // as times are: no matter of memory
            CHECK(between[i].value >= small[i].value);
            CHECK(between[i].value < large[i].value);
        }
    }
}

} // namespace worst_case_names_test
