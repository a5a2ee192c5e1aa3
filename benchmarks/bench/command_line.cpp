#include "command_line.hpp"

#include <array>

#include <CLI/CLI.hpp>

#include "command_line/program_options.hpp"
#include "process.hpp"

namespace busbar::bench {

namespace {

void add_server(CLI::App& app, Options& options)
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

void add_loads(CLI::App& app, Options& options)
{
    const CLI::Range positive{1, 10'000'000};
    app.add_option("--node", options.node, "NodeId of the variables, {} stands for their number")
        ->capture_default_str();
    app.add_option("--variables", options.variables,
                   "how many of them the server has; the requests of a load name others in turn; "
                   "without, as many as the largest request, and 25000 of a server of one's own");
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
        ->check(CLI::IsMember(std::vector<std::string>{load_names.begin(), load_names.end()}))
        ->delimiter(',');
    app.add_flag("--sequential", options.is_sequential,
                 "the values of a request lie beside each other, not anywhere");
    app.add_flag("--registered", options.is_registered,
                 "they are named by the NodeIds that RegisterNodes gives");
    app.add_option("--rounds", options.rounds, "how often all of that is run, for --compare")
        ->check(positive)
        ->capture_default_str();
    app.add_option("--in-flight", options.in_flight, "requests under way")
        ->delimiter(',')
        ->check(positive);
    app.add_option("--connects", options.connects, "connections to open; 0 for none")
        ->capture_default_str();
    SubscribeOptions& subscribe = options.subscribe;
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

CLI::App* add_hostile(CLI::App& app, HostileOptions& options)
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
    hostile
        ->add_option("--passwords", options.passwords,
                     "or: administrators who add users, change passwords and guess, beside ten "
                     "logins a second; 1,5,20")
        ->check(CLI::Range(1, 100))
        ->delimiter(',');
    hostile->add_flag("--administration", options.is_administration,
                      "or: 1,000 of each Method that a role of administration may call, in one "
                      "Call; with a URL, those that --user may call");
    hostile->add_option("--calls", options.calls, "Methods of one Call of --administration")
        ->check(CLI::Range(1, 10'000))
        ->capture_default_str();
    hostile
        ->add_option("--variables", options.variables,
                     "further ones of the controller that --administration or --tool starts")
        ->check(CLI::Range(0, 100'000))
        ->capture_default_str();
    hostile
        ->add_option("--tool", options.tool,
                     "or: programs, backups and projects that this `busbar` sends to controllers "
                     "of both modes, with --variables")
        ->check(CLI::ExistingFile);
    hostile->add_flag("--own-addresses", options.has_own_addresses,
                      "each of them from an address of its own, 127.0.0.2 and so on");
    hostile->add_flag("--unrationed", options.is_unrationed,
                      "the server of one's own lets all of them through, as it once did");
    hostile->add_flag("--worker", options.has_worker,
                      "it does their asymmetric work on a thread of its own");
    return hostile;
}

CLI::App* add_churn(CLI::App& app, ChurnOptions& options)
{
    CLI::App* const churn = app.add_subcommand(
        "churn", "Has clients, administrators and downloads come and go at a controller, for "
                 "--seconds; ends with 1 if it does not bear that, or a sanitizer complains.");
    churn->fallthrough();
    churn
        ->add_option(
            "--controller", options.controller,
            "busbar-controller, as of a build with a sanitizer; this program's own without")
        ->check(CLI::ExistingFile);
    churn->add_option("--tool", options.tool, "busbar, whose `admin` is used, too")
        ->check(CLI::ExistingFile);
    churn->add_option("--clients", options.clients, "that come and go at a time")
        ->check(CLI::Range(1, 100))
        ->capture_default_str();
    churn->add_option("--pause", options.pause_s, "seconds between two downloads, at most")
        ->capture_default_str();
    churn->add_option("--seed", options.seed, "of what they do")->capture_default_str();
    churn->add_option("--mutated", options.mutated,
                      "instead of all that: so many Calls of administration with changed bytes, "
                      "from a session of each role; 200,000");
    return churn;
}

CLI::App* add_growth(CLI::App& app, GrowthOptions& options)
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

CLI::App* add_memory(CLI::App& app, SessionMemoryOptions& options)
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

CLI::App* add_startup(CLI::App& app, StartupOptions& options)
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

CLI::App* add_appendix7(CLI::App& app, SevenOptions& options)
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

CLI::App* add_publishes(CLI::App& app, PublishesOptions& options)
{
    CLI::App* const publishes = app.add_subcommand(
        "publishes", "What many small Subscriptions cost a server, without a URL one of its own; "
                     "ends with 1 if a message is lost.");
    publishes->fallthrough();
    publishes->add_option("--subscriptions", options.subscriptions, "of one item each")
        ->check(CLI::Range(1, 100'000))
        ->capture_default_str();
    publishes->add_option("--sessions", options.sessions, "that they are spread over")
        ->check(CLI::Range(1, 1'000))
        ->capture_default_str();
    publishes->add_option("--interval", options.interval_ms, "of publishing and sampling, in ms")
        ->check(CLI::Range(1.0, 3'600'000.0))
        ->capture_default_str();
    return publishes;
}

/// What a word behind the name chooses.
struct Subcommand {
    const CLI::App* app;
    Command command;
};

} // namespace

Expected<CommandLine, int> read_command_line(int argc, char** argv)
{
    CommandLine line;
    CLI::App app{"Measures an OPC UA server: connect, Read and Write of N values, Browse, "
                 "requests in flight."};
    add_server(app, line.loads);
    add_loads(app, line.loads);
    app.add_option("--compare", line.compared,
                   "instead of all that: two files that --json printed, and what of the second "
                   "costs how many times that of the first")
        ->expected(2)
        ->type_name("A B");
    const std::array subcommands{
        Subcommand{add_hostile(app, line.hostile), Command::Hostile},
        Subcommand{add_churn(app, line.churn), Command::Churn},
        Subcommand{add_growth(app, line.growth), Command::Growth},
        Subcommand{add_memory(app, line.memory), Command::Memory},
        Subcommand{add_startup(app, line.startup), Command::Startup},
        Subcommand{add_appendix7(app, line.seven), Command::Appendix7},
        Subcommand{add_publishes(app, line.publishes), Command::Publishes},
    };
    command_line::add_program_options(app, "busbar-bench");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return Unexpected{app.exit(error)};
    }
    for (const Subcommand& each : subcommands) {
        line.command = each.app->parsed() ? each.command : line.command;
    }
    line.command = line.compared.empty() ? line.command : Command::Compare;
    line.has_url = app.get_option("url")->count() != 0;
    if (line.has_url && line.loads.subscribe.server_pid == 0) {
        line.loads.subscribe.server_pid = find_listener(line.loads.url).value_or(0);
    }
    line.loads.subscribe.seconds = line.loads.seconds;
    line.hostile.seconds = line.loads.seconds;
    line.churn.seconds = line.loads.seconds;
    line.hostile.server_process = line.loads.subscribe.server_pid;
    return line;
}

} // namespace busbar::bench
