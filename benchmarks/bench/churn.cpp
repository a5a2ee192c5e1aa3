#include "churn.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <string_view>
#include <thread>
#include <utility>

#include <busbar/core/attribute_id.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/subscription.hpp>
#include <busbar/types/view.hpp>

#include "administration_calls.hpp"
#include "load.hpp"
#include "mutated.hpp"
#include "own_controller.hpp"
#include "own_server.hpp"
#include "tool_user.hpp"

namespace busbar::bench {

namespace {

using namespace std::chrono_literals;

/// A sanitizer's controller that is busy with all of them is slow.
constexpr std::chrono::milliseconds churn_patience{20'000};
/// Variables that a visitor knows, and levels below Objects in which it looks for them.
constexpr std::size_t most_variables = 200;
constexpr int most_levels = 5;

/// What all have in common. Any thread.
class Ledger {
public:
    void note(const std::string& what, bool is_good)
    {
        const std::scoped_lock lock{mutex_};
        ChurnRow& row = rows_[what];
        ++(is_good ? row.good : row.refused);
    }
    [[nodiscard]] std::vector<ChurnRow> take()
    {
        const std::scoped_lock lock{mutex_};
        std::vector<ChurnRow> rows;
        for (auto& [what, row] : rows_) {
            row.what = what;
            rows.push_back(std::move(row));
        }
        return rows;
    }

    std::atomic<bool> is_over{false};

private:
    std::mutex mutex_;
    std::map<std::string, ChurnRow> rows_;
};

/// Decides what comes next; the same for each run with the same seed, but for the others' doings.
class Dice {
public:
    explicit Dice(unsigned seed) : engine_{seed} {}

    /// 0 to `sides` - 1.
    [[nodiscard]] std::size_t roll(std::size_t sides)
    {
        return std::uniform_int_distribution<std::size_t>{0, sides - 1}(engine_);
    }
    void pause(std::size_t most_ms)
    {
        std::this_thread::sleep_for(std::chrono::milliseconds{roll(most_ms)});
    }

private:
    std::minstd_rand engine_;
};

/// Everything that takes part knows the controller and the ledger.
struct Scene {
    OwnController& controller;
    Ledger& ledger;
    const ChurnOptions& options;
};

Options options_of(const Scene& scene, std::string_view user)
{
    Options options;
    options.url = scene.controller.url();
    if (!user.empty()) {
        options.policy = "Basic256Sha256";
        options.mode = "SignAndEncrypt";
        options.user = user;
        options.password = good_password;
        options.identity = scene.controller.client();
    }
    return options;
}

std::unique_ptr<net::ClientLoop> open_session(Load& load)
{
    auto loop = std::make_unique<net::ClientLoop>();
    return load.prepare() && load.open(*loop, true, churn_patience) ? std::move(loop) : nullptr;
}

template <typename Response, typename Request>
std::optional<Response> answer(net::ClientLoop& loop, Request&& request)
{
    const auto event = loop.call(std::forward<Request>(request));
    auto response = event ? event->template response<Response>() : fail(event.error());
    return response ? std::optional<Response>{*std::move(response)} : std::nullopt;
}

/// Variables below Objects.
std::vector<NodeId> find_variables(net::ClientLoop& loop)
{
    std::vector<NodeId> found;
    std::vector<NodeId> level{NodeId{0, id::ObjectsFolder}};
    for (int depth = 0; depth < most_levels && !level.empty(); ++depth) {
        BrowseRequest request;
        for (NodeId& node : level) {
            BrowseDescription& one = request.nodes_to_browse.emplace_back();
            one.node_id = std::move(node);
            one.reference_type_id = NodeId{0, id::HierarchicalReferences};
            one.include_subtypes = true;
            one.result_mask = 63;
        }
        level.clear();
        const auto response = answer<BrowseResponse>(loop, std::move(request));
        if (!response) {
            break;
        }
        for (const BrowseResult& result : response->results) {
            for (const ReferenceDescription& each : result.references) {
                auto& list = each.node_class == NodeClass::Variable ? found : level;
                if (list.size() < most_variables) {
                    list.push_back(NodeId{each.node_id.node_id});
                }
            }
        }
    }
    return found;
}

/// A client that comes, does something with variables, and leaves, with a word or without one.
class Visitor {
public:
    Visitor(const Scene& scene, unsigned seed)
        : scene_{scene}, dice_{seed}, stranger_{options_of(scene, "")}, user_{options_of(
                                                                            scene, "Operator")}
    {
    }

    void run()
    {
        while (!scene_.ledger.is_over) {
            const auto loop = open_session(dice_.roll(3) == 0 ? user_ : stranger_);
            scene_.ledger.note("come", loop != nullptr);
            if (loop) {
                stay(*loop);
            } else {
                dice_.pause(50);
            }
        }
    }

private:
    void stay(net::ClientLoop& loop)
    {
        variables_ = find_variables(loop);
        const std::size_t deeds = variables_.empty() ? 0 : dice_.roll(20);
        for (std::size_t i = 0; i < deeds && !scene_.ledger.is_over; ++i) {
            switch (dice_.roll(4)) {
            case 0:
                subscribe(loop);
                break;
            case 1:
                scene_.ledger.note("publish",
                                   answer<PublishResponse>(loop, PublishRequest{}).has_value());
                break;
            default:
                read_and_write(loop);
            }
            dice_.pause(20);
        }
        if (dice_.roll(2) == 0) {
            loop.close();
        }
    }
    [[nodiscard]] NodeId any() { return NodeId{variables_[dice_.roll(variables_.size())]}; }
    void read_and_write(net::ClientLoop& loop)
    {
        ReadRequest read;
        const std::size_t count = 1 + dice_.roll(20);
        for (std::size_t i = 0; i < count; ++i) {
            ReadValueId& item = read.nodes_to_read.emplace_back();
            item.node_id = any();
            item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        }
        WriteRequest write;
        const auto values = answer<ReadResponse>(loop, read);
        scene_.ledger.note("read", values.has_value());
        for (std::size_t i = 0; values && i < values->results.size(); ++i) {
            WriteValue& item = write.nodes_to_write.emplace_back();
            item.node_id = NodeId{read.nodes_to_read[i].node_id};
            item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
            item.value.value = values->results[i].value;
        }
        scene_.ledger.note("write", values && answer<WriteResponse>(loop, write).has_value());
    }
    void subscribe(net::ClientLoop& loop)
    {
        CreateSubscriptionRequest request;
        request.requested_publishing_interval = 10;
        request.requested_lifetime_count = 30;
        request.requested_max_keep_alive_count = 5;
        request.publishing_enabled = true;
        const auto created = answer<CreateSubscriptionResponse>(loop, request);
        scene_.ledger.note("subscribe", created.has_value());
        if (!created) {
            return;
        }
        CreateMonitoredItemsRequest items;
        items.subscription_id = created->subscription_id;
        const std::size_t count = 1 + dice_.roll(20);
        for (std::size_t i = 0; i < count; ++i) {
            MonitoredItemCreateRequest& item = items.items_to_create.emplace_back();
            item.item_to_monitor.node_id = any();
            item.item_to_monitor.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
            item.monitoring_mode = MonitoringMode::Reporting;
            item.requested_parameters.sampling_interval = static_cast<double>(dice_.roll(3) * 10);
            item.requested_parameters.queue_size = 4;
        }
        scene_.ledger.note("monitor",
                           answer<CreateMonitoredItemsResponse>(loop, items).has_value());
    }

    Scene scene_;
    Dice dice_;
    Load stranger_;
    Load user_;
    std::vector<NodeId> variables_;
};

/// A user of one role of administration, who calls its Methods in any order.
class Administrator {
public:
    Administrator(const Scene& scene, std::string role, unsigned seed)
        : scene_{scene}, role_{std::move(role)}, dice_{seed}, load_{options_of(scene, role_)}
    {
    }

    void run()
    {
        while (!scene_.ledger.is_over) {
            const auto loop = open_session(load_);
            scene_.ledger.note("administrator comes", loop != nullptr);
            const auto methods = loop ? find_methods(*loop) : fail(status::Bad_NoCommunication);
            if (methods && !methods->empty()) {
                call(*loop, *methods);
            } else {
                dice_.pause(200);
            }
        }
    }

private:
    void call(net::ClientLoop& loop, const std::vector<AdministrationMethod>& methods)
    {
        AdministrationCalls calls;
        const std::size_t most = 10 + dice_.roll(100);
        for (std::size_t i = 0; i < most && !scene_.ledger.is_over; ++i) {
            const AdministrationMethod& method = methods[dice_.roll(methods.size())];
            const auto outcome = calls.call(loop, method, 1 + dice_.roll(8));
            scene_.ledger.note("call", outcome.has_value());
            if (!outcome) {
                return;
            }
            dice_.pause(20);
        }
        if (dice_.roll(2) == 0) {
            loop.close();
        }
    }

    Scene scene_;
    std::string role_;
    Dice dice_;
    Load load_;
};

/// Somebody who does not know the password.
void guess(const Scene& scene, Dice dice)
{
    Options options = options_of(scene, "SecurityAdmin");
    options.password = "Wrong-Password-1";
    Load load{options};
    while (!scene.ledger.is_over) {
        scene.ledger.note("guess", open_session(load) == nullptr);
        dice.pause(500);
    }
}

/// Somebody at the machine, who downloads programs and has files read again.
void download(const Scene& scene, Dice dice)
{
    while (!scene.ledger.is_over) {
        if (dice.roll(3) != 0) {
            scene.ledger.note("write a program", scene.controller.write_program(dice.roll(16)));
        }
        scene.controller.reload();
        scene.ledger.note("reload", scene.controller.is_running());
        // Long enough for the others to do something in between, and cut short at the end.
        const std::size_t rest = 20 + dice.roll(scene.options.pause_s * 20 + 1);
        for (std::size_t i = 0; i < rest && !scene.ledger.is_over; ++i) {
            std::this_thread::sleep_for(50ms);
        }
    }
}

/// People who use `busbar`.
class ToolUsers {
public:
    ToolUsers(const Scene& scene, unsigned seed)
        : scene_{scene}, dice_{seed}, tool_{scene.controller, scene.options.tool}
    {
    }

    void run()
    {
        while (!scene_.ledger.is_over) {
            const auto& [user, words] = commands[dice_.roll(commands.size())];
            const bool is_rare = words.find("restore") != words.npos ||
                                 words.find("restart") != words.npos ||
                                 words.find("clear --yes") != words.npos;
            if (is_rare && dice_.roll(4) != 0) {
                continue;
            }
            scene_.ledger.note(
                "busbar " + std::string{words.substr(0, words.find(' ', words.find(' ') + 1))},
                tool_.run(user, words));
        }
    }

private:
    static constexpr std::string_view security = "SecurityAdmin";
    static constexpr std::string_view configure = "ConfigureAdmin";
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 40> commands{{
        {security, "admin status"},
        {security, "admin user add pat --new-password-file password"},
        {security, "admin user disable pat"},
        {security, "admin user enable pat"},
        {security, "admin user password pat --new-password-file password"},
        {security, "admin user remove pat --yes"},
        {security, "admin user list"},
        {security, "admin role grant pat ConfigureAdmin"},
        {security, "admin role revoke pat ConfigureAdmin"},
        {security, "admin role grant Engineer ConfigureAdmin"},
        {security, "admin role revoke Engineer ConfigureAdmin"},
        {security, "admin role list"},
        {security, "admin trust list"},
        {security, "admin trust add spare.der"},
        {security, "admin trust remove $(cat thumbprint) --yes"},
        {security, "admin backup all.backup --yes"},
        {security, "admin verify all.backup"},
        {security, "admin restore all.backup --yes"},
        {security, "admin log --clear --yes"},
        {security, "admin log -n 20"},
        {security, "admin audit --duration 1"},
        {security, "admin cert show"},
        {security, "admin cert regenerate --host 127.0.0.1 --yes"},
        {security, "admin shutdown --restart --seconds 0 --yes"},
        {security, "admin clear --yes"},
        {security, "admin setting set users.anonymous write"},
        {security, "admin setting set server.auditing false"},
        {security, "admin setting reset server.auditing"},
        {configure, "admin setting list"},
        {configure, "admin setting set limits.sessions 80"},
        {configure, "admin setting set plc.scan_ms 10"},
        {configure, "admin setting reset plc.scan_ms"},
        {configure, "admin file put controller.toml recipes/a --yes"},
        {configure, "admin file get recipes/a back --yes"},
        {configure, "admin file mkdir recipes/d"},
        {configure, "admin file remove recipes/a --yes"},
        {configure, "admin file remove recipes/d --yes"},
        {"pat", "admin setting set limits.sessions 90"},
        {"pat", "admin file put password recipes/b --yes"},
        {"Engineer", "admin file put password recipes/c --yes"},
    }};

    Scene scene_;
    Dice dice_;
    ToolUser tool_;
};

/// All of them, each on a thread of its own.
void play(const Scene& scene)
{
    std::vector<std::thread> threads;
    unsigned seed = scene.options.seed * 1'000;
    for (std::size_t i = 0; i < scene.options.clients; ++i) {
        threads.emplace_back([&scene, seed = ++seed] { Visitor{scene, seed}.run(); });
    }
    for (const std::string_view role : administration_roles) {
        threads.emplace_back([&scene, role, seed = ++seed] {
            Administrator{scene, std::string{role}, seed}.run();
        });
    }
    threads.emplace_back([&scene, seed = ++seed] { guess(scene, Dice{seed}); });
    threads.emplace_back([&scene, seed = ++seed] { download(scene, Dice{seed}); });
    for (int i = 0; i < 2 && !scene.options.tool.empty(); ++i) {
        threads.emplace_back([&scene, seed = ++seed] { ToolUsers{scene, seed}.run(); });
    }
    const TimePoint begin = clock_now();
    while (elapsed_us(begin) / 1e6 < scene.options.seconds && scene.controller.is_running()) {
        std::this_thread::sleep_for(50ms);
    }
    scene.ledger.is_over = true;
    for (std::thread& thread : threads) {
        thread.join();
    }
}

/// It may be about to start again.
bool serves(const Scene& scene)
{
    Load load{options_of(scene, "")};
    for (int i = 0; i < 100 && scene.controller.is_running(); ++i) {
        if (const auto loop = open_session(load)) {
            loop->close();
            return true;
        }
        std::this_thread::sleep_for(300ms);
    }
    return false;
}

/// The first line of a program's output with which a sanitizer complains; empty: none does.
std::string complaint_in(std::string_view output)
{
    constexpr std::array<std::string_view, 4> marks{
        "ThreadSanitizer:", "AddressSanitizer:", "LeakSanitizer:", "runtime error:"};
    std::size_t first = output.npos;
    for (const std::string_view mark : marks) {
        first = std::min(first, output.find(mark));
    }
    if (first == output.npos) {
        return {};
    }
    const std::size_t begin = output.rfind('\n', first) + 1; // 0 in the first line
    return std::string{output.substr(begin, output.find('\n', first) - begin)};
}

} // namespace

Result<ChurnReport> churn(const ChurnOptions& options)
{
    const auto controller = OwnController::start({.program = options.controller,
                                                  .has_quick_logins = true,
                                                  .trusts_all_clients = options.mutated != 0});
    if (!controller) {
        return fail(controller.error());
    }
    Ledger ledger;
    const Scene scene{**controller, ledger, options};
    if (!options.tool.empty() && !ToolUser{**controller, options.tool}.prepare()) {
        return fail(status::Bad_ConfigurationError);
    }
    ChurnReport report;
    report.before = memory_of((*controller)->process());
    report.seed = options.seed;
    if (options.mutated == 0) {
        play(scene);
        report.rows = ledger.take();
        report.needed = {"administrator comes"};
        if (options.clients != 0) {
            report.needed.push_back("come");
        }
    } else {
        report.rows = send_mutated(**controller, options.mutated, options.seed);
    }
    std::size_t done = 0;
    for (const ChurnRow& row : report.rows) {
        done += row.good + row.refused;
    }
    report.serves = serves(scene) && done >= options.mutated;
    report.after = memory_of((*controller)->process());
    report.exit_code = (*controller)->stop();
    report.complaint = complaint_in((*controller)->output());
    report.folder = (*controller)->folder();
    if (!report.is_well()) {
        (*controller)->keep_folder();
    }
    return report;
}

} // namespace busbar::bench
