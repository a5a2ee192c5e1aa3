#include <cstdio>
#include <exception>
#include <memory>

#include <CLI/CLI.hpp>
#include <malloc.h>

#include "appendix7.hpp"
#include "compare.hpp"
#include "growth.hpp"
#include "hostile.hpp"
#include "load.hpp"
#include "own_server.hpp"
#include "process.hpp"
#include "report.hpp"
#include "session_memory.hpp"
#include "startup_run.hpp"

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

/// Against the server of the options, or one of our own.
int run_hostile(bench::Options options, bench::HostileOptions hostile, bool has_url)
{
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
    bench::Load load{options};
    const auto prepared = load.prepare();
    const auto rows = prepared ? bench::attack(load, hostile) : fail(prepared.error());
    if (!rows) {
        return complain(options, rows.error());
    }
    bench::print(options, hostile, *rows);
    return 0;
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

void add_server(CLI::App& app, bench::Options& options)
{
    app.add_option("url", options.url, "endpoint; a server of one's own without");
    app.add_option("--policy", options.policy,
                   "None, Basic256Sha256, Aes128_Sha256_RsaOaep, "
                   "Aes256_Sha256_RsaPss")
        ->capture_default_str();
    app.add_option("--mode", options.mode, "None, Sign, SignAndEncrypt")
        ->check(CLI::IsMember({"None", "Sign", "SignAndEncrypt"}))
        ->capture_default_str();
    app.add_option("--user", options.user, "user name; anonymous without");
    app.add_option("--password", options.password, "password of the user");
    app.add_option("--seconds", options.seconds, "time for each load or attack")
        ->capture_default_str();
    app.add_option("--server-pid", options.subscribe.server_pid,
                   "process whose processor time and memory are printed; who listens at the URL "
                   "on this machine without");
    app.add_flag("--json", options.json, "print JSON");
}

void add_loads(CLI::App& app, bench::Options& options)
{
    const CLI::Range positive{1, 10'000'000};
    app.add_option("--node", options.node, "NodeId of the variables, {} stands for their number")
        ->capture_default_str();
    app.add_option("--read", options.read_counts, "values per Read")
        ->delimiter(',')
        ->check(positive);
    app.add_option("--write", options.write_counts, "values per Write")
        ->delimiter(',')
        ->check(positive);
    app.add_option("--browse", options.browse_counts, "variables per Browse")
        ->delimiter(',')
        ->check(positive);
    app.add_option("--only", options.only, "connects, reads, writes, browses, in-flight")
        ->check(CLI::IsMember(
            std::vector<std::string>{bench::load_names.begin(), bench::load_names.end()}))
        ->delimiter(',');
    app.add_flag("--sequential", options.is_sequential,
                 "the values of a request lie beside each other, not anywhere");
    app.add_option("--rounds", options.rounds, "how often all of that is run, for --compare")
        ->check(positive)
        ->capture_default_str();
    app.add_option("--in-flight", options.in_flight, "requests under way")
        ->delimiter(',')
        ->check(positive);
    app.add_option("--connects", options.connects, "connections to open; 0 for none")
        ->capture_default_str();
    bench::SubscribeOptions& subscribe = options.subscribe;
    app.add_option("--subscribe", subscribe.item_counts,
                   "instead of all that: monitored items, half of them changing in every scan")
        ->delimiter(',');
    app.add_option("--moving", subscribe.moving, "Int16 that grow by one in every scan")
        ->capture_default_str();
    app.add_option("--still", subscribe.still, "variables that do not change")
        ->capture_default_str();
    app.add_option("--publishing", subscribe.publishing_ms, "publishing interval in ms")
        ->capture_default_str();
    app.add_option("--sampling", subscribe.sampling_ms, "sampling interval in ms")
        ->capture_default_str();
    app.add_option("--queue", subscribe.queue_size, "values that an item may hold")
        ->capture_default_str();
}

CLI::App* add_hostile(CLI::App& app, bench::HostileOptions& options)
{
    CLI::App* const hostile = app.add_subcommand(
        "hostile", "Attacks a server, without a URL one of its own, while a good client reads.");
    hostile->fallthrough();
    hostile
        ->add_option("--bomb", options.bomb_size,
                     "bytes of the request that becomes many times as large")
        ->capture_default_str();
    hostile->add_option("--connections", options.connections, "that ask for Browses")
        ->check(CLI::Range(1, 1'000))
        ->capture_default_str();
    hostile->add_option("--nodes", options.nodes, "nodes of one Browse")->capture_default_str();
    hostile->add_option("--browses", options.in_flight, "Browses under way on each connection")
        ->check(CLI::Range(1, 10'000))
        ->capture_default_str();
    hostile
        ->add_option("--replays", options.replays,
                     "instead of all that: attackers that send an overheard OpenSecureChannel "
                     "again and again; 1,5,20,60")
        ->delimiter(',');
    hostile
        ->add_option("--quotas", options.quotas,
                     "or: attackers that take what is shared, sessions, Subscriptions, memory, "
                     "sockets, logins; 1,5,20,60")
        ->delimiter(',');
    hostile->add_flag("--own-addresses", options.has_own_addresses,
                      "each of them from an address of its own, 127.0.0.2 and so on");
    hostile->add_flag("--unrationed", options.is_unrationed,
                      "the server of one's own lets all of them through, as it once did");
    hostile->add_flag("--worker", options.has_worker,
                      "it does their asymmetric work on a thread of its own");
    return hostile;
}

CLI::App* add_growth(CLI::App& app, bench::GrowthOptions& options)
{
    CLI::App* const growth = app.add_subcommand(
        "growth", "What one Read costs in this library, and creating one more of each, beside ever "
                  "more sessions, items and variables.");
    growth->fallthrough();
    growth->add_option("--sessions", options.sessions, "how many, ascending")->delimiter(',');
    growth->add_option("--items", options.items, "how many, ascending")->delimiter(',');
    growth->add_option("--variables", options.variables, "how many, ascending")->delimiter(',');
    growth->add_option("--reads", options.reads, "Reads for a figure")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
    return growth;
}

CLI::App* add_memory(CLI::App& app, bench::SessionMemoryOptions& options)
{
    CLI::App* const memory = app.add_subcommand(
        "memory", "What a session with its items takes of a server's memory, while all of them "
                  "read and when they have gone.");
    memory->fallthrough();
    memory->add_option("--sessions", options.sessions, "how many, each with a server of its own")
        ->delimiter(',')
        ->check(CLI::Range(1, 10'000));
    memory->add_option("--items", options.items, "monitored items of each session")
        ->check(CLI::Range(0, 5'000))
        ->capture_default_str();
    memory->add_option("--reads", options.reads, "of each session under way at once")
        ->check(CLI::Range(1, 100))
        ->capture_default_str();
    memory->add_option("--values", options.values, "of one Read")
        ->check(CLI::Range(1, 25'000))
        ->capture_default_str();
    memory->add_flag("--secure", options.is_secure, "over Basic256Sha256, SignAndEncrypt");
    return memory;
}

CLI::App* add_startup(CLI::App& app, bench::StartupOptions& options)
{
    CLI::App* const startup = app.add_subcommand(
        "startup", "How long a machine takes from its declarations to Running, with its execution "
                   "log, with ever more published variables.");
    startup->fallthrough();
    startup
        ->add_option("--limited", options.limited, "how many with the limits of NJ501, ascending")
        ->delimiter(',');
    startup->add_option("--open", options.open, "and how many without limits, ascending")
        ->delimiter(',');
    startup->add_option("--rounds", options.rounds, "starts of each, of which the fastest counts")
        ->check(CLI::Range(1, 1'000))
        ->capture_default_str();
    return startup;
}

CLI::App* add_appendix7(CLI::App& app, bench::SevenOptions& options)
{
    CLI::App* const seven = app.add_subcommand(
        "appendix7", "The load that the manual of model mode measures, beside its figures and what "
                     "the same costs without model mode.");
    seven->fallthrough();
    seven->add_option("--only", options.only, "reads, writes, subscriptions, startup")
        ->check(CLI::IsMember({"reads", "writes", "subscriptions", "startup"}))
        ->delimiter(',');
    seven->add_option("--modes", options.modes, "of sampling: standard, items, all")
        ->check(CLI::IsMember({"standard", "items", "all"}))
        ->delimiter(',');
    seven->add_option("--rounds", options.rounds, "measurements of a figure, of startup at most 3")
        ->check(CLI::Range(1, 10'000))
        ->capture_default_str();
    seven->add_option("--most", options.most, "rows of more Variables are left out")
        ->check(CLI::Range(100, 25'000))
        ->capture_default_str();
    return seven;
}

int run(int argc, char** argv)
{
    bench::Options options;
    bench::HostileOptions hostile_options;
    bench::GrowthOptions growth_options;
    bench::SessionMemoryOptions memory_options;
    bench::StartupOptions startup_options;
    bench::SevenOptions seven_options;
    CLI::App app{"Measures an OPC UA server: connect, Read and Write of N values, Browse, "
                 "requests in flight."};
    add_server(app, options);
    add_loads(app, options);
    std::vector<std::string> compared;
    app.add_option("--compare", compared,
                   "instead of all that: two files that --json printed, and what of the second "
                   "costs how many times that of the first")
        ->expected(2)
        ->type_name("A B");
    const CLI::App* const hostile = add_hostile(app, hostile_options);
    const CLI::App* const growth = add_growth(app, growth_options);
    const CLI::App* const memory = add_memory(app, memory_options);
    const CLI::App* const startup = add_startup(app, startup_options);
    const CLI::App* const seven = add_appendix7(app, seven_options);
    CLI11_PARSE(app, argc, argv);
    const bool has_url = app.get_option("url")->count() != 0;
    if (has_url && options.subscribe.server_pid == 0) {
        options.subscribe.server_pid = bench::find_listener(options.url).value_or(0);
    }
    options.subscribe.seconds = options.seconds;
    hostile_options.seconds = options.seconds;
    hostile_options.server_process = options.subscribe.server_pid;

    if (!compared.empty()) {
        return run_compare(compared);
    }
    if (memory->parsed()) { // with malloc as it is: what a server gives back is the question
        return run_memory(memory_options, options.json);
    }
    // Messages of some 100 kB come and go all the time: keep their pages.
    ::mallopt(M_MMAP_THRESHOLD, 64 << 20);
    ::mallopt(M_TRIM_THRESHOLD, 64 << 20);
    if (hostile->parsed()) {
        return run_hostile(options, hostile_options, has_url);
    }
    if (startup->parsed()) {
        return run_startup(startup_options, options.json);
    }
    if (seven->parsed()) {
        return run_appendix7(seven_options, options.json);
    }
    return growth->parsed() ? run_growth(growth_options, options.json)
                            : run_loads(options, has_url);
}

} // namespace

int main(int argc, char** argv)
{
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "busbar-bench: %s\n", error.what());
        return 1;
    }
}
