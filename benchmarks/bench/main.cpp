#include <cstdio>

#include <CLI/CLI.hpp>
#include <malloc.h>

#include "load.hpp"
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
    std::printf("%s  %s %s, %.0f ms\n", options.url.c_str(), options.policy.c_str(),
                options.mode.c_str(), options.subscribe.publishing_ms);
    bench::print(*rows);
    return 0;
}

} // namespace

int main(int argc, char** argv)
{
    bench::Options options;
    CLI::App app{"Measures an OPC UA server: connect, read and write of N values, requests in "
                 "flight."};
    app.add_option("url", options.url, "endpoint")->capture_default_str();
    app.add_option("--policy", options.policy,
                   "None, Basic256Sha256, Aes128_Sha256_RsaOaep, "
                   "Aes256_Sha256_RsaPss")
        ->capture_default_str();
    app.add_option("--mode", options.mode, "None, Sign, SignAndEncrypt")
        ->check(CLI::IsMember({"None", "Sign", "SignAndEncrypt"}))
        ->capture_default_str();
    app.add_option("--user", options.user, "user name; anonymous without");
    app.add_option("--password", options.password, "password of the user");
    app.add_option("--node", options.node, "NodeId of the variables, {} stands for their number")
        ->capture_default_str();
    app.add_option("--read", options.read_counts, "values per Read")->delimiter(',');
    app.add_option("--write", options.write_counts, "values per Write")->delimiter(',');
    app.add_option("--in-flight", options.in_flight, "requests under way")->delimiter(',');
    app.add_option("--connects", options.connects, "connections to open; 0 for none")
        ->capture_default_str();
    app.add_option("--seconds", options.seconds, "time for each load")->capture_default_str();
    app.add_flag("--json", options.json, "print JSON");
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
    app.add_option("--server-pid", subscribe.server_pid,
                   "process whose processor time and memory are printed");
    CLI11_PARSE(app, argc, argv);
    subscribe.seconds = options.seconds;

    // Messages of some 100 kB come and go all the time: keep their pages.
    ::mallopt(M_MMAP_THRESHOLD, 64 << 20);
    ::mallopt(M_TRIM_THRESHOLD, 64 << 20);
    bench::Load load{options};
    const auto prepared = load.prepare();
    if (prepared && !subscribe.item_counts.empty()) {
        return run_subscriptions(load, options);
    }
    const auto rows = prepared ? load.run() : fail(prepared.error());
    if (!rows) {
        return complain(options, rows.error());
    }
    bench::print(options, *rows);
    return 0;
}
