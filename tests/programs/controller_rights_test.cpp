#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <busbar/client/attributes.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/subscription.hpp>

#include "programs/controller_rights.hpp"

namespace controller_rights_test {

// Every Method and Variable of administration and product in a running controller, for nine
// identities over three channels: may do what the tables of rights say, and nothing else. Then for
// a user who loses a role between two steps.

using namespace busbar;
using namespace busbar::test;

namespace {

namespace who = administration::detail::who;

struct Identity {
    const char* user; // empty: anonymous
    Roles roles;
};
constexpr std::array identities{
    Identity{"", who::everybody},
    Identity{"nobody", who::everybody},
    Identity{"pat", who::everybody},
    Identity{"Observer", who::everybody},
    Identity{"Operator", who::everybody | who::operator_ | who::readers},
    Identity{"Supervisor", who::everybody | who::supervisor},
    Identity{"Engineer", who::everybody | who::engineer | who::writers},
    Identity{"ConfigureAdmin", who::everybody | who::configure_admin},
    Identity{"SecurityAdmin", who::everybody | who::security_admin},
};
constexpr std::array channels{Channel::None, Channel::Sign, Channel::SignAndEncrypt};

bool is_enough(Channel channel, std::uint16_t wanted)
{
    constexpr unsigned is_signed = 1;
    constexpr unsigned is_encrypted = 2;
    return ((wanted & is_signed) == 0 || channel != Channel::None) &&
           ((wanted & is_encrypted) == 0 || channel == Channel::SignAndEncrypt);
}

std::vector<DataValue> read_all(RightsClient& client, const std::vector<FoundNode>& nodes)
{
    std::vector<ReadValueId> items;
    for (const FoundNode& node : nodes) {
        items.push_back(client::attribute_of(node.id));
    }
    const auto values = client.blocking().wait_for<std::vector<DataValue>>(
        [&](auto done) { return client::read(client.blocking().client(), items, done); });
    REQUIRE(values);
    return *values;
}

/// A value that fits none of them, so that nothing is changed.
std::vector<StatusCode> write_all(RightsClient& client, const std::vector<FoundNode>& nodes)
{
    std::vector<WriteValue> items;
    for (const FoundNode& node : nodes) {
        items.push_back(client::value_for(node.id, DataValue{Variant{Guid{}}}));
    }
    const auto answers = client.blocking().wait_for<std::vector<StatusCode>>(
        [&](auto done) { return client::write(client.blocking().client(), items, done); });
    REQUIRE(answers);
    return *answers;
}

/// With more arguments than any of them has, so that nothing is done.
std::vector<StatusCode> call_all(RightsClient& client, const std::vector<FoundNode>& nodes)
{
    constexpr std::size_t at_once = 100;
    std::vector<StatusCode> answers;
    for (std::size_t begin = 0; begin < nodes.size(); begin += at_once) {
        CallRequest request;
        for (std::size_t i = begin; i < std::min(nodes.size(), begin + at_once); ++i) {
            CallMethodRequest& item = request.methods_to_call.emplace_back();
            item.object_id = nodes[i].object;
            item.method_id = nodes[i].id;
            item.input_arguments.resize(20);
        }
        const auto response = client.call<CallResponse>(request);
        REQUIRE(response);
        for (const CallMethodResult& each : response->results) {
            answers.push_back(each.status_code);
        }
    }
    return answers;
}

/// One identity over one channel, with what the controller said of each node.
struct Cells {
    const Identity& identity;
    Channel channel;

    [[nodiscard]] bool has(Roles roles) const { return (roles & identity.roles) != 0; }
    [[nodiscard]] bool sees(const FoundNode& node) const
    {
        return has(node.row.rights.see | node.row.rights.call);
    }
    [[nodiscard]] bool is_secure(const FoundNode& node) const
    {
        return is_enough(channel, node.row.channel);
    }
    void check_read(const FoundNode& node, const DataValue& answer) const
    {
        if (!sees(node)) {
            CHECK(name(answer.status) == "Bad_NodeIdUnknown");
        } else if (!is_secure(node)) {
            CHECK(name(answer.status) == "Bad_SecurityModeInsufficient");
        } else { // some have no value now
            CHECK((answer.status != status::Bad_NodeIdUnknown &&
                   answer.status != status::Bad_UserAccessDenied &&
                   answer.status != status::Bad_SecurityModeInsufficient));
        }
    }
    void check_write(const FoundNode& node, StatusCode answer) const
    {
        const bool may = node.is_writable && !node.is_argument && sees(node) &&
                         has(node.row.rights.write) && is_secure(node);
        CHECK((answer == status::Bad_TypeMismatch) == may);
        CHECK(answer.is_bad());
    }
    void check_call(const FoundNode& node, StatusCode answer) const
    {
        if (!sees(node)) {
            CHECK((answer == status::Bad_NodeIdUnknown || answer == status::Bad_MethodInvalid));
        } else if (!is_secure(node)) {
            CHECK(name(answer) == "Bad_SecurityModeInsufficient");
        } else {
            CHECK(name(answer) ==
                  (has(node.row.rights.call) ? "Bad_TooManyArguments" : "Bad_UserAccessDenied"));
        }
    }
};

std::vector<FoundNode> only(const Crawl& crawl, bool methods)
{
    std::vector<FoundNode> some;
    std::ranges::copy_if(crawl.nodes, std::back_inserter(some),
                         [&](const FoundNode& node) { return node.is_method == methods; });
    return some;
}

} // namespace

TEST_CASE("controller rights: each node has a row, and each identity may what it says", "[attack]")
{
    const auto mode = GENERATE(RightsPlant::Mode::Variables, RightsPlant::Mode::Model);
    RightsPlant plant{mode};
    const Crawl& crawl = plant.crawl();
    for (const std::string& path : crawl.unknown) {
        FAIL_CHECK("no table has " << path);
    }
    CHECK(crawl.others > 60);
    const std::vector<FoundNode> methods = only(crawl, true);
    const std::vector<FoundNode> variables = only(crawl, false);
    CHECK(methods.size() > 70);
    CHECK(variables.size() > 700);
    for (const Identity& identity : identities) {
        for (const Channel channel : channels) {
            RightsClient client{plant, identity.user, channel};
            const Cells cells{identity, channel};
            const auto read = read_all(client, variables);
            const auto written = write_all(client, variables);
            const auto called = call_all(client, methods);
            for (std::size_t i = 0; i < variables.size(); ++i) {
                INFO((*identity.user == '\0' ? "anonymous" : identity.user)
                     << ", channel " << static_cast<int>(channel) << ", " << variables[i].path);
                cells.check_read(variables[i], read[i]);
                cells.check_write(variables[i], written[i]);
            }
            for (std::size_t i = 0; i < methods.size(); ++i) {
                INFO((*identity.user == '\0' ? "anonymous" : identity.user)
                     << ", channel " << static_cast<int>(channel) << ", " << methods[i].path);
                cells.check_call(methods[i], called[i]);
            }
        }
    }
}

namespace {

/// A role that a rule may give.
struct TakenRole {
    const char* name;
    Roles bit;
};
constexpr std::array taken_roles{
    TakenRole{"Operator", who::operator_ | who::readers},
    TakenRole{"Supervisor", who::supervisor},
    TakenRole{"Engineer", who::engineer | who::writers},
    TakenRole{"ConfigureAdmin", who::configure_admin},
    TakenRole{"SecurityAdmin", who::security_admin},
};

/// By the role, and not because everybody has it.
bool has_by(const TakenRole& role, Roles some)
{
    return (some & role.bit) != 0 && (some & who::everybody) == 0;
}

void create_items(RightsClient& client, const CreateMonitoredItemsRequest& request,
                  const std::vector<FoundNode>& variables)
{
    if (request.items_to_create.empty()) {
        return;
    }
    const auto items = client.call<CreateMonitoredItemsResponse>(request);
    INFO((items ? "Good" : name(items.error())));
    REQUIRE(items);
    for (std::size_t i = 0; i < request.items_to_create.size(); ++i) {
        INFO(variables[request.items_to_create[i].requested_parameters.client_handle].path);
        CHECK(name(items->results[i].status_code) == "Good");
    }
}

/// An item for each Variable, numbered as they are.
void monitor(RightsClient& client, const std::vector<FoundNode>& variables)
{
    CreateSubscriptionRequest subscription;
    subscription.requested_publishing_interval = 100;
    subscription.requested_lifetime_count = 3'000;
    subscription.requested_max_keep_alive_count = 10;
    subscription.publishing_enabled = true;
    const auto made = client.call<CreateSubscriptionResponse>(subscription);
    REQUIRE(made);
    CreateMonitoredItemsRequest request;
    constexpr std::size_t at_once = 200;
    for (std::size_t i = 0; i < variables.size(); ++i) {
        if (i % at_once == 0) {
            create_items(client, std::exchange(request, {}), variables);
        }
        request.subscription_id = made->subscription_id;
        MonitoredItemCreateRequest& item = request.items_to_create.emplace_back();
        item.item_to_monitor.node_id = variables[i].id;
        item.item_to_monitor.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        item.monitoring_mode = MonitoringMode::Reporting;
        item.requested_parameters.client_handle = static_cast<std::uint32_t>(i);
        item.requested_parameters.sampling_interval = 100;
        item.requested_parameters.queue_size = 1;
    }
    create_items(client, request, variables);
}

/// Takes notifications until the last one of each item is as wanted. Returns the paths of those of
/// which none is.
std::vector<std::string> await_items(RightsClient& client, const std::vector<FoundNode>& variables,
                                     const std::function<bool(const DataValue&)>& is_wanted)
{
    constexpr int most_notifications = 300;
    std::vector<bool> fits(variables.size());
    for (int i = 0; i < most_notifications && std::ranges::count(fits, false) > 0; ++i) {
        const auto response = client.call<PublishResponse>(PublishRequest{});
        REQUIRE(response);
        for (const auto& data : response->notification_message.notification_data) {
            if (const auto* const changes = data.get_if<DataChangeNotification>()) {
                for (const auto& each : changes->monitored_items) {
                    fits.at(each.client_handle) = is_wanted(each.value);
                }
            }
        }
    }
    std::vector<std::string> others;
    for (std::size_t i = 0; i < fits.size(); ++i) {
        if (!fits[i]) {
            others.push_back(variables[i].path);
        }
    }
    return others;
}

} // namespace

TEST_CASE("controller rights: an item whose right has gone reports that, and no value any more",
          "[attack]")
{
    RightsPlant plant{RightsPlant::Mode::Variables};
    std::size_t tried = 0;
    for (const TakenRole& role : taken_roles) {
        plant.give(role.name);
        RightsClient pat{plant, "pat", Channel::SignAndEncrypt};
        std::vector<FoundNode> variables;
        for (const FoundNode& node : only(plant.crawl(), false)) {
            if (has_by(role, node.row.rights.see | node.row.rights.call)) {
                variables.push_back(node);
            }
        }
        INFO(role.name);
        REQUIRE_FALSE(variables.empty());
        monitor(pat, variables);
        CHECK(await_items(pat, variables, [](const DataValue&) { return true; }) ==
              std::vector<std::string>{});
        plant.take(role.name);
        CHECK(await_items(pat, variables, [](const DataValue& value) {
                  return value.status.is_bad() && value.value.is_null();
              }) == std::vector<std::string>{});
        tried += variables.size();
    }
    CHECK(tried > 2'000);
}

namespace {

/// An Object that is read or written in steps.
struct Stepped {
    std::string path;
    NodeId object;
    bool is_transfer;
    const FoundNode* first_read;  // Open, or GenerateFileForRead
    const FoundNode* first_write; // Open, or GenerateFileForWrite; null: none may write
};

/// All of them, found by their Methods.
std::vector<Stepped> stepped(const Crawl& crawl)
{
    std::vector<Stepped> all;
    for (const FoundNode& node : crawl.nodes) {
        const bool is_file = node.path.ends_with("/Open");
        if (!is_file && !node.path.ends_with("/CloseAndCommit")) {
            continue;
        }
        const std::string path = node.path.substr(0, node.path.rfind('/'));
        all.push_back({path, node.object, !is_file,
                       is_file ? &node : crawl.find(path + "/GenerateFileForRead"),
                       crawl.find(path + (is_file ? "/Write" : "/GenerateFileForWrite"))});
    }
    return all;
}

/// What a file that a client sends is for: something that would be seen.
Variant wish_for(const std::string& path)
{
    return path == "Program"  ? Variant{String{"mode RUN"}}
           : path == "Backup" ? Variant{String{"clear"}}
                              : Variant{String{"write"}};
}

/// How the right is lost.
enum class Loss : std::uint8_t { RoleTaken, NextUser };

struct Steps {
    RightsPlant& plant;
    const TakenRole& role;
    const Stepped& of;
    RightsClient pat;

    Steps(RightsPlant& p, const TakenRole& r, const Stepped& s)
        : plant{p}, role{r}, of{s}, pat{begin(p, r), "pat", Channel::SignAndEncrypt}
    {
    }
    static RightsPlant& begin(RightsPlant& plant, const TakenRole& role)
    {
        plant.give(role.name);
        return plant;
    }
    CallMethodResult on(const NodeId& object, const std::string& path, std::vector<Variant> inputs)
    {
        const FoundNode* const method = plant.crawl().find(path);
        INFO(path);
        REQUIRE(method != nullptr);
        return pat.on(object, method->id, std::move(inputs));
    }
    /// A Method of a file that a transfer has made: they are found by the BrowseName.
    CallMethodResult on_file(const NodeId& file, const char* method, std::vector<Variant> inputs)
    {
        return of.is_transfer ? pat.on(file,
                                       NodeId{file.namespace_index(),
                                              String{file.string().str() + "//" + method}},
                                       std::move(inputs))
                              : on(file, of.path + "/" + method, std::move(inputs));
    }
    /// Where to read or write, and the handle.
    std::pair<NodeId, Variant> open(bool writes)
    {
        CallMethodResult result;
        if (of.is_transfer) {
            result =
                on(of.object, of.path + (writes ? "/GenerateFileForWrite" : "/GenerateFileForRead"),
                   {writes ? wish_for(of.path) : Variant{}});
            INFO(of.path << " " << name(result.status_code));
            REQUIRE(result.output_arguments.size() >= 2);
            return {*result.output_arguments[0].get_if<NodeId>(), result.output_arguments[1]};
        }
        result =
            on(of.object, of.path + "/Open", {Variant{writes ? std::uint8_t{6} : std::uint8_t{1}}});
        INFO(of.path << " " << name(result.status_code));
        REQUIRE(result.output_arguments.size() == 1);
        return {of.object, result.output_arguments[0]};
    }
    StatusCode end(const Variant& handle)
    {
        const bool is_list = plant.crawl().find(of.path + "/CloseAndUpdate") != nullptr;
        return on(of.object,
                  of.path + (of.is_transfer ? "/CloseAndCommit"
                             : is_list      ? "/CloseAndUpdate"
                                            : "/Close"),
                  {handle})
            .status_code;
    }
    void lose(Loss loss)
    {
        if (loss == Loss::RoleTaken) {
            return plant.take(role.name);
        }
        pat.change_user("Observer");
    }
    /// Another one may follow.
    void finish(Loss loss)
    {
        pat.blocking().close();
        if (loss == Loss::NextUser) {
            plant.take(role.name);
        }
    }
};

/// Returns what would be seen of each of them.
std::string what_is(RightsPlant& plant)
{
    std::string all;
    for (const char* const path :
         {"FileSystem/recipes/a/Size", "Server/ServerConfiguration/UserManagement/Users",
          "Settings/machine/mode",
          "Server/ServerConfiguration/CertificateGroups/DefaultApplicationGroup/TrustList/Size",
          "Server/ServerConfiguration/TransactionDiagnostics/StartTime", "Status/PendingChanges"}) {
        const FoundNode* const node = plant.crawl().find(path);
        if (node != nullptr) {
            const Variant value = plant.chief().read(node->id);
            const auto* const list = value.array_if<ExtensionObject>();
            const auto* const number = value.get_if<std::uint64_t>();
            const auto* const text = value.get_if<String>();
            all += std::string{path} + " ";
            all += list != nullptr     ? std::to_string(list->size())
                   : number != nullptr ? std::to_string(*number)
                   : text != nullptr   ? text->str()
                                       : "";
            all += "\n";
        }
    }
    return all;
}

/// Calls `act` for each of them, each role that has the right of its row, and each way to lose it.
/// Returns how often.
std::size_t for_each(RightsPlant& plant, const FoundNode* Stepped::*first,
                     const std::function<void(Steps&, Loss)>& act)
{
    std::size_t tried = 0;
    for (const Stepped& each : stepped(plant.crawl())) {
        for (const TakenRole& role : taken_roles) {
            if (each.*first == nullptr || !has_by(role, (each.*first)->row.rights.call)) {
                continue;
            }
            for (const Loss loss : {Loss::RoleTaken, Loss::NextUser}) {
                INFO(each.path << ", " << role.name
                               << (loss == Loss::RoleTaken ? ", role taken" : ", next user"));
                Steps steps{plant, role, each};
                act(steps, loss);
                steps.finish(loss);
                ++tried;
            }
        }
    }
    return tried;
}

} // namespace

TEST_CASE("controller rights: what was opened is not read without the right", "[attack]")
{
    RightsPlant plant{RightsPlant::Mode::Variables};
    const auto tried = for_each(plant, &Stepped::first_read, [](Steps& steps, Loss loss) {
        std::pair<NodeId, Variant> opened;
        std::vector<Variant> inputs;
        StatusCode first = status::Bad_InvalidState;
        for (int i = 0; i < 50 && first == status::Bad_InvalidState; ++i) { // a log may grow
            opened = steps.open(false);
            inputs = {opened.second, Variant{std::int32_t{10}}};
            first = steps.on_file(opened.first, "Read", inputs).status_code;
            static_cast<void>(first.is_bad() ? steps.end(opened.second) : status::Good);
        }
        CHECK(name(first) == "Good");
        steps.lose(loss);
        const auto read = steps.on_file(opened.first, "Read", inputs);
        CHECK(read.status_code.is_bad());
        CHECK(read.output_arguments.empty());
    });
    // Execution and event log by five roles, a file by two, a trust list and a backup by one, the
    // program by three.
    CHECK(tried == 2 * (5 + 5 + 2 + 1 + 1 + 3));
}

TEST_CASE("controller rights: what was opened or written has no effect without the right",
          "[attack]")
{
    const bool has_written = GENERATE(false, true);
    RightsPlant plant{RightsPlant::Mode::Variables};
    const std::string before = what_is(plant);
    const auto tried = for_each(plant, &Stepped::first_write, [&](Steps& steps, Loss loss) {
        const auto opened = steps.open(true);
        // A transfer is of an empty file.
        const std::vector<Variant> inputs{opened.second,
                                          Variant{ByteString{std::as_bytes(std::span{"half", 4})}}};
        const bool writes = has_written && !steps.of.is_transfer;
        if (writes) {
            CHECK(name(steps.on_file(opened.first, "Write", inputs).status_code) == "Good");
        }
        steps.lose(loss);
        CHECK(steps.on_file(opened.first, "Write", inputs).status_code.is_bad());
        const StatusCode ended = steps.end(opened.second);
        CHECK((ended.is_bad() || !(writes || steps.of.is_transfer)));
        CHECK(what_is(plant) == before);
    });
    CHECK(tried == 2 * (1 + 1 + 1 + 3));
    CHECK(what_is(plant) == before);
}

TEST_CASE("controller rights: a file is not taken if the right goes while a worker reads it",
          "[attack]")
{
    RightsPlant plant{RightsPlant::Mode::Variables};
    const FoundNode* const mode = plant.crawl().find("Settings/machine/mode");
    REQUIRE(mode != nullptr);
    std::string program = "{attribute 'publish' := 'publish only'}\nVAR_GLOBAL\n";
    for (int i = 0; i < 4'000; ++i) { // which the worker reads for a while
        program += "Level" + std::to_string(i) + " : LREAL;\n";
    }
    program += "END_VAR\n";
    const std::vector<Stepped> all = stepped(plant.crawl());
    const auto of = std::ranges::find(all, "Program", &Stepped::path);
    REQUIRE(of != all.end());
    constexpr int most_tries = 20;
    int refused = 0;
    for (int i = 0; i < most_tries && refused == 0; ++i) {
        Steps steps{plant, taken_roles[2], *of};
        const auto made = steps.on(of->object, "Program/GenerateFileForWrite",
                                   {Variant{String{"check press.st"}}});
        REQUIRE(made.output_arguments.size() >= 2);
        const NodeId file = *made.output_arguments[0].get_if<NodeId>();
        REQUIRE(name(steps
                         .on_file(file, "Write",
                                  {made.output_arguments[1],
                                   Variant{ByteString{std::as_bytes(std::span{program})}}})
                         .status_code) == "Good");
        CallRequest commit;
        CallMethodRequest& one = commit.methods_to_call.emplace_back();
        one.object_id = of->object;
        one.method_id = plant.crawl().find("Program/CloseAndCommit")->id;
        one.input_arguments.push_back(made.output_arguments[1]);
        std::optional<Result<CallResponse>> answer;
        steps.pat.blocking().client().call<CallResponse>(
            commit, [&](Result<CallResponse> response) { answer = std::move(response); });
        steps.pat.blocking().run_until([&] { return answer.has_value(); },
                                       std::chrono::milliseconds{5}); // sends it
        plant.take("Engineer");
        REQUIRE(steps.pat.blocking().run_until([&] { return answer.has_value(); }));
        REQUIRE(*answer);
        refused += (*answer)->results[0].status_code.is_bad() ? 1 : 0;
        steps.pat.blocking().close();
    }
    CHECK(refused == 1);
}

} // namespace controller_rights_test
