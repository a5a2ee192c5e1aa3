#include <cstdio>

#include <CLI/CLI.hpp>
#include <malloc.h>

#include "load.hpp"
#include "report.hpp"

using namespace busbar;

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
    CLI11_PARSE(app, argc, argv);

    // Messages of some 100 kB come and go all the time: keep their pages.
    ::mallopt(M_MMAP_THRESHOLD, 64 << 20);
    ::mallopt(M_TRIM_THRESHOLD, 64 << 20);
    bench::Load load{options};
    const auto prepared = load.prepare();
    const auto rows = prepared ? load.run() : fail(prepared.error());
    if (!rows) {
        std::fprintf(stderr, "busbar-bench: %s: %s\n", options.url.c_str(),
                     std::string{name(rows.error())}.c_str());
        return 1;
    }
    bench::print(options, *rows);
    return 0;
}
