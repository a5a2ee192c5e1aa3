#include <cstdio>
#include <exception>
#include <memory>
#include <utility>

#include "churn.hpp"
#include "command_line.hpp"
#include "compare.hpp"
#include "own_controller.hpp"
#include "own_server.hpp"
#include "product_calls.hpp"
#include "report.hpp"

using namespace busbar;

namespace {

int complain(const bench::Options& options, StatusCode status)
{
    std::fprintf(stderr, "busbar-bench: %s: %s\n", options.url.c_str(),
                 std::string{name(status)}.c_str());
    return 1;
}

int run_subscriptions(bench::Load& load, const bench::Options& options)
{
    const auto rows = load.run_subscriptions();
    if (!rows) {
        return complain(options, rows.error());
    }
    bench::print(options, *rows);
    return 0;
}

/// Against the server of the options, or one of our own, which has variables to read and write.
int run_loads(bench::Options options, bool has_url)
{
    std::unique_ptr<bench::OwnServer> own;
    if (!has_url && !options.subscribe.item_counts.empty()) {
        std::fprintf(stderr, "busbar-bench: --subscribe: found no URL, expected that of a server "
                             "whose variables change\n");
        return 1;
    }
    if (!has_url) {
        constexpr std::size_t usual_variables = 25'000;
        options.variables = options.variables != 0 ? options.variables : usual_variables;
        auto started = bench::OwnServer::start({.is_secure = options.policy != "None",
                                                .is_unrationed = true,
                                                .variables = bench::most_values(options)});
        if (!started) {
            return complain(options, started.error());
        }
        own = *std::move(started);
        options.url = own->url();
        options.subscribe.server_pid = own->process();
    }
    bench::Load load{options};
    const auto prepared = load.prepare();
    if (prepared && !options.subscribe.item_counts.empty()) {
        return run_subscriptions(load, options);
    }
    const auto rows = prepared ? load.run() : fail(prepared.error());
    if (!rows) {
        return complain(options, rows.error());
    }
    bench::print(options, *rows);
    return 0;
}

int attack(const bench::Options& options, const bench::HostileOptions& hostile)
{
    bench::Load load{options};
    const auto prepared = load.prepare();
    const auto rows = prepared ? bench::attack(load, hostile) : fail(prepared.error());
    if (!rows) {
        return complain(options, rows.error());
    }
    bench::print(options, hostile, *rows);
    return 0;
}

/// Whoever administers the server of the options, or a controller of our own.
int run_administration(bench::Options options, bench::HostileOptions hostile, bool has_url)
{
    std::unique_ptr<bench::OwnController> own;
    if (has_url) {
        hostile.callers = {std::exchange(options.user, {})};
        hostile.password = std::exchange(options.password, {});
    } else {
        auto started = bench::OwnController::start({.variables = hostile.variables});
        if (!started) {
            return complain(options, started.error());
        }
        own = *std::move(started);
        options.url = own->url();
        options.identity = hostile.identity = own->client();
        hostile.server_process = own->process();
        hostile.callers.assign(bench::administration_roles.begin(),
                               bench::administration_roles.end());
        hostile.password = bench::good_password;
        hostile.take_longest_piece_ms = [&own] { return own->take_longest_piece_ms(); };
    }
    if (!hostile.passwords.empty()) {
        options.policy = "Basic256Sha256";
        options.mode = "SignAndEncrypt";
        options.user = has_url ? hostile.callers.front() : bench::administration_roles.back();
        options.password = hostile.password;
    }
    return attack(options, hostile);
}

/// Controllers of our own, one of each mode, that somebody administers by `busbar`.
int run_products(bench::Options options, const bench::HostileOptions& hostile)
{
    std::vector<bench::HostileRow> rows;
    for (const bool is_model : {false, true}) {
        const auto own =
            bench::OwnController::start({.variables = hostile.variables, .is_model = is_model});
        if (!own) {
            return complain(options, own.error());
        }
        options.url = (*own)->url();
        bench::Load load{options};
        const auto prepared = load.prepare();
        const auto more = prepared ? bench::administer(load, **own, {**own, hostile.tool}, is_model)
                                   : fail(prepared.error());
        if (!more) {
            (*own)->keep_folder();
            return complain(options, more.error());
        }
        rows.insert(rows.end(), more->begin(), more->end());
    }
    bench::print(options, hostile, rows);
    return 0;
}

/// Against the server of the options, or one of our own.
int run_hostile(bench::Options options, bench::HostileOptions hostile, bool has_url)
{
    if (!hostile.tool.empty()) {
        return run_products(std::move(options), hostile);
    }
    if (hostile.is_administration || !hostile.passwords.empty()) {
        return run_administration(std::move(options), std::move(hostile), has_url);
    }
    std::unique_ptr<bench::OwnServer> own;
    const bool takes = !hostile.quotas.empty();
    const bool is_secure = takes || !hostile.replays.empty();
    if (is_secure) {
        options.policy = options.policy == "None" ? "Basic256Sha256" : options.policy;
        options.mode = options.mode == "None" ? "SignAndEncrypt" : options.mode;
        options.subscribe = bench::good_subscription(options.seconds);
    }
    if (!has_url) {
        auto started = bench::OwnServer::start({.is_secure = is_secure,
                                                .is_unrationed = hostile.is_unrationed,
                                                .has_user = takes,
                                                .has_worker = hostile.has_worker});
        if (!started) {
            return complain(options, started.error());
        }
        own = *std::move(started);
        options.url = own->url();
        options.user = takes ? bench::good_user : "";
        options.password = takes ? bench::good_password : "";
        hostile.server_process = own->process();
    }
    return attack(options, hostile);
}

/// Ends with 1 if the controller did not bear it.
int run_churn(const bench::ChurnOptions& churn)
{
    const auto report = bench::churn(churn);
    if (!report) {
        std::fprintf(stderr, "busbar-bench: churn: %s\n",
                     std::string{name(report.error())}.c_str());
        return 1;
    }
    bench::print(*report);
    return report->is_well() ? 0 : 1;
}

/// Of two runs that printed JSON.
int run_compare(const std::vector<std::string>& files)
{
    const auto lines = bench::compare(files.front(), files.back());
    if (!lines) {
        std::fprintf(stderr, "busbar-bench: %s\n", lines.error().c_str());
        return 1;
    }
    bench::print(*lines);
    return 0;
}

/// Against the server of the options, or one of our own.
int run_publishes(bench::Options options, const bench::PublishesOptions& publishes, bool has_url)
{
    std::unique_ptr<bench::OwnServer> own;
    if (!has_url) {
        auto started = bench::OwnServer::start(
            {.is_secure = options.policy != "None", .is_unrationed = true, .is_large = true});
        if (!started) {
            return complain(options, started.error());
        }
        own = *std::move(started);
        options.url = own->url();
        options.subscribe.server_pid = own->process();
    }
    bench::Load load{options};
    const auto prepared = load.prepare();
    const auto measured =
        prepared ? bench::measure_publishes(load, options, publishes) : fail(prepared.error());
    if (!measured) {
        return complain(options, measured.error());
    }
    bench::print(publishes, *measured, options.json);
    return measured->lost == 0 && measured->messages != 0 ? 0 : 1;
}

/// Needs no server: the figures are those of this library.
int run_growth(const bench::GrowthOptions& growth, bool json)
{
    const auto series = bench::measure_growth(growth);
    if (!series) {
        std::fprintf(stderr, "busbar-bench: growth: %s\n",
                     std::string{name(series.error())}.c_str());
        return 1;
    }
    bench::print(*series, json);
    return 0;
}

/// Nor does this: it starts machines in this process.
int run_startup(const bench::StartupOptions& startup, bool json)
{
    const auto points = bench::measure_startup(startup);
    if (!points) {
        std::fprintf(stderr, "busbar-bench: startup: %s\n", text(points.error()).c_str());
        return 1;
    }
    bench::print(*points, json);
    return 0;
}

/// This starts its servers in processes of their own.
int run_memory(const bench::SessionMemoryOptions& memory, bool json)
{
    const auto rows = bench::measure_session_memory(memory);
    if (!rows) {
        std::fprintf(stderr, "busbar-bench: memory: %s\n", std::string{name(rows.error())}.c_str());
        return 1;
    }
    bench::print(*rows, json);
    return 0;
}

/// And this starts its server, client and PLC in this process.
int run_appendix7(const bench::SevenOptions& seven, bool json)
{
    const auto rows = bench::measure_appendix7(seven);
    if (!rows) {
        std::fprintf(stderr, "busbar-bench: appendix7: %s\n", text(rows.error()).c_str());
        return 1;
    }
    bench::print(*rows, json);
    return 0;
}

int run(const bench::CommandLine& line)
{
    const bool json = line.loads.json;
    switch (line.command) {
    case bench::Command::Compare:
        return run_compare(line.compared);
    case bench::Command::Memory:
        return run_memory(line.memory, json);
    case bench::Command::Hostile:
        return run_hostile(line.loads, line.hostile, line.has_url);
    case bench::Command::Churn:
        return run_churn(line.churn);
    case bench::Command::Growth:
        return run_growth(line.growth, json);
    case bench::Command::Startup:
        return run_startup(line.startup, json);
    case bench::Command::Appendix7:
        return run_appendix7(line.seven, json);
    case bench::Command::Publishes:
        return run_publishes(line.loads, line.publishes, line.has_url);
    case bench::Command::Loads:
        break;
    }
    return run_loads(line.loads, line.has_url);
}

} // namespace

int main(int argc, char** argv)
{
    try {
        const auto line = bench::read_command_line(argc, argv);
        return line ? run(*line) : line.error();
    } catch (const std::exception& error) {
        std::fprintf(stderr, "busbar-bench: %s\n", error.what());
        return 1;
    }
}
