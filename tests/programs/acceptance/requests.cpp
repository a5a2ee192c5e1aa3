// Sends single requests as they are, which a tool divides or corrects, and prints what came of
// them: acceptance-requests URL REQUEST...
//
//     read N NODE                    write N NODE                    browse N
//     translate N                    call N OBJECT METHOD            sessions N
//     subscriptions N INTERVAL       items N NODE SAMPLING QUEUE     held SECONDS NODE
//     bytes N NODE SIZE              password N OLD NEW              rule ROLE CRITERIA TEXT
//
// "Good: 3 Good, 1 Bad_NodeIdUnknown", and what was revised. "held" writes and reads the node after
// that time; "bytes" writes so many ByteStrings of that size at once; "password" changes the user's
// own N times in one Call; "rule" is AddIdentity with a number of IdentityCriteriaType. Without
// security, unless REQUESTS_USER says who logs in, with REQUESTS_PASSWORD, or REQUESTS_TOKEN is a
// JSON Web Token.
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include <busbar/core/text_forms.hpp>
#include <busbar/net/application.hpp>
#include <busbar/net/blocking_client.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/method.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/view.hpp>

namespace {

using namespace busbar;
using net::BlockingClient;

using Counts = std::map<std::string, std::size_t>;

std::string text_of(StatusCode status)
{
    const std::string_view known = name(status);
    return known.empty() ? std::to_string(status.value()) : std::string{known};
}

void print(StatusCode service, const Counts& counts, const std::string& revised = {})
{
    std::string line = text_of(service) + ":";
    for (const auto& [status, count] : counts) {
        line += " " + std::to_string(count) + " " + status + ",";
    }
    if (!counts.empty()) {
        line.pop_back(); // the comma
    }
    std::printf("%s%s\n", line.c_str(), revised.c_str());
}

/// The response's status, and how many of its results have which.
template <typename Response, typename Request, typename StatusOf>
bool send(BlockingClient& client, Request request, StatusOf status_of)
{
    const auto response = client.call<Response>(std::move(request));
    Counts counts;
    if (response) {
        for (const auto& result : response->results) {
            ++counts[text_of(status_of(result))];
        }
    }
    print(response ? StatusCode{status::Good} : response.error(), counts);
    return response.has_value();
}

NodeId node_of(const std::string& text)
{
    const auto node = parse_expanded_node_id(text);
    if (!node) {
        std::fprintf(stderr, "%s is no NodeId\n", text.c_str());
        std::exit(2);
    }
    return node->node_id;
}

bool read(BlockingClient& client, std::size_t count, const NodeId& node)
{
    ReadRequest request;
    request.timestamps_to_return = TimestampsToReturn::Both;
    for (std::size_t i = 0; i < count; ++i) {
        ReadValueId& each = request.nodes_to_read.emplace_back();
        each.node_id = node;
        each.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    }
    return send<ReadResponse>(client, std::move(request),
                              [](const DataValue& value) { return value.status; });
}

bool write(BlockingClient& client, std::size_t count, const NodeId& node)
{
    WriteRequest request;
    for (std::size_t i = 0; i < count; ++i) {
        WriteValue& each = request.nodes_to_write.emplace_back();
        each.node_id = node;
        each.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        each.value.value = Variant{static_cast<std::int16_t>(i % 100)};
    }
    return send<WriteResponse>(client, std::move(request), [](StatusCode each) { return each; });
}

/// As many ByteStrings of `size` in one request.
bool write_bytes(BlockingClient& client, std::size_t count, const NodeId& node, std::size_t size)
{
    WriteRequest request;
    const std::vector<std::byte> bytes(size);
    for (std::size_t i = 0; i < count; ++i) {
        WriteValue& each = request.nodes_to_write.emplace_back();
        each.node_id = node;
        each.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        each.value.value = Variant{ByteString{bytes}};
    }
    return send<WriteResponse>(client, std::move(request), [](StatusCode each) { return each; });
}

bool browse(BlockingClient& client, std::size_t count)
{
    BrowseRequest request;
    for (std::size_t i = 0; i < count; ++i) {
        BrowseDescription& each = request.nodes_to_browse.emplace_back();
        each.node_id = NodeId{0, id::ServerStatusType};
        each.reference_type_id = NodeId{0, id::HasSubtype};
        each.browse_direction = BrowseDirection::Forward;
    }
    return send<BrowseResponse>(client, std::move(request),
                                [](const BrowseResult& result) { return result.status_code; });
}

bool translate(BlockingClient& client, std::size_t count)
{
    TranslateBrowsePathsToNodeIdsRequest request;
    for (std::size_t i = 0; i < count; ++i) {
        BrowsePath& each = request.browse_paths.emplace_back();
        each.starting_node = NodeId{0, id::ObjectsFolder};
        RelativePathElement& step = each.relative_path.elements.emplace_back();
        step.reference_type_id = NodeId{0, id::Organizes};
        step.target_name = QualifiedName{0, "Server"};
    }
    return send<TranslateBrowsePathsToNodeIdsResponse>(
        client, std::move(request),
        [](const BrowsePathResult& result) { return result.status_code; });
}

bool call(BlockingClient& client, std::size_t count, const NodeId& object, const NodeId& method)
{
    CallRequest request;
    for (std::size_t i = 0; i < count; ++i) {
        CallMethodRequest& each = request.methods_to_call.emplace_back();
        each.object_id = object;
        each.method_id = method;
    }
    return send<CallResponse>(client, std::move(request),
                              [](const CallMethodResult& result) { return result.status_code; });
}

Result<CreateSubscriptionResponse> subscribe(BlockingClient& client, double interval)
{
    CreateSubscriptionRequest request;
    request.requested_publishing_interval = interval;
    request.requested_lifetime_count = 1;
    request.requested_max_keep_alive_count = 1;
    request.publishing_enabled = true;
    return client.call<CreateSubscriptionResponse>(std::move(request));
}

bool subscriptions(BlockingClient& client, std::size_t count, double interval)
{
    Counts counts;
    std::string revised;
    for (std::size_t i = 0; i < count; ++i) {
        const auto made = subscribe(client, interval);
        ++counts[text_of(made ? StatusCode{status::Good} : made.error())];
        if (made) {
            revised = "; interval " +
                      std::to_string(static_cast<long>(made->revised_publishing_interval)) +
                      ", lifetime " + std::to_string(made->revised_lifetime_count) +
                      ", keep-alive " + std::to_string(made->revised_max_keep_alive_count);
        }
    }
    print(status::Good, counts, revised);
    return counts.contains("Good");
}

bool items(BlockingClient& client, std::size_t count, const NodeId& node, double sampling,
           std::uint32_t queue)
{
    const auto subscription = subscribe(client, 1'000);
    if (!subscription) {
        print(subscription.error(), {});
        return false;
    }
    CreateMonitoredItemsRequest request;
    request.subscription_id = subscription->subscription_id;
    request.timestamps_to_return = TimestampsToReturn::Both;
    for (std::size_t i = 0; i < count; ++i) {
        MonitoredItemCreateRequest& each = request.items_to_create.emplace_back();
        each.item_to_monitor.node_id = node;
        each.item_to_monitor.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        each.monitoring_mode = MonitoringMode::Reporting;
        each.requested_parameters.client_handle = static_cast<std::uint32_t>(i);
        each.requested_parameters.sampling_interval = sampling;
        each.requested_parameters.queue_size = queue;
    }
    const auto made = client.call<CreateMonitoredItemsResponse>(std::move(request));
    Counts counts;
    std::string revised;
    if (made) {
        for (const MonitoredItemCreateResult& each : made->results) {
            ++counts[text_of(each.status_code)];
        }
        const MonitoredItemCreateResult& first = made->results[0];
        revised = "; sampling " +
                  std::to_string(static_cast<long>(first.revised_sampling_interval)) + ", queue " +
                  std::to_string(first.revised_queue_size);
    }
    print(made ? StatusCode{status::Good} : made.error(), counts, revised);
    return made.has_value();
}

bool change_password(BlockingClient& client, std::size_t count, const std::string& from,
                     const std::string& to)
{
    CallRequest request;
    for (std::size_t i = 0; i < count; ++i) {
        CallMethodRequest& each = request.methods_to_call.emplace_back();
        each.object_id = NodeId{0, id::UserManagement};
        each.method_id = NodeId{0, id::UserManagement_ChangePassword};
        each.input_arguments = {Variant{String{from}}, Variant{String{to}}};
    }
    return send<CallResponse>(client, std::move(request),
                              [](const CallMethodResult& result) { return result.status_code; });
}

bool add_rule(BlockingClient& client, const NodeId& role, int criteria, const std::string& text)
{
    CallRequest request;
    CallMethodRequest& add = request.methods_to_call.emplace_back();
    add.object_id = role;
    add.method_id = NodeId{0, id::RoleType_AddIdentity};
    add.input_arguments = {Variant{ExtensionObject::from(
        IdentityMappingRuleType{static_cast<IdentityCriteriaType>(criteria), String{text}})}};
    return send<CallResponse>(client, std::move(request),
                              [](const CallMethodResult& result) { return result.status_code; });
}

class Requests {
public:
    Requests(net::Application& application, std::vector<std::string> words)
        : application_{application}, words_{std::move(words)}
    {
    }

    bool run()
    {
        if (word(1) == "sessions") {
            return sessions();
        }
        BlockingClient client{config(60), application_.client_environment()};
        if (const auto connected = client.connect(); !connected) {
            print(connected.error(), {});
            return false;
        }
        const bool is_done = request(client);
        client.close();
        return is_done;
    }

private:
    [[nodiscard]] std::string word(std::size_t index) const
    {
        return index < words_.size() ? words_[index] : std::string{};
    }
    [[nodiscard]] double number(std::size_t index) const
    {
        return std::strtod(word(index).c_str(), nullptr);
    }
    [[nodiscard]] client::ClientConfig config(int timeout) const
    {
        client::ClientConfig config = application_.client_config(word(0));
        const char* const token = std::getenv("REQUESTS_TOKEN");
        const char* const user = std::getenv("REQUESTS_USER");
        const char* const password = std::getenv("REQUESTS_PASSWORD");
        if (token != nullptr) {
            config.identity = client::IssuedUser{token};
        } else if (user != nullptr && password != nullptr) {
            config.identity = client::NamedUser{user, password};
        } else {
            config.security = {{"None"}, MessageSecurityMode::None, true};
        }
        config.session_timeout = std::chrono::seconds{timeout};
        config.request_timeout = std::chrono::seconds{90};
        // A machine with much else to do is silent for longer than a client of a plant would wait.
        config.keep_alive_interval = std::chrono::seconds{0};
        return config;
    }
    bool request(BlockingClient& client)
    {
        const std::string kind = word(1);
        const auto count = static_cast<std::size_t>(number(2));
        if (kind == "read") {
            return read(client, count, node_of(word(3)));
        }
        if (kind == "write") {
            return write(client, count, node_of(word(3)));
        }
        if (kind == "bytes") {
            return write_bytes(client, count, node_of(word(3)),
                               static_cast<std::size_t>(number(4)));
        }
        if (kind == "browse") {
            return browse(client, count);
        }
        if (kind == "translate") {
            return translate(client, count);
        }
        if (kind == "call") {
            return call(client, count, node_of(word(3)), node_of(word(4)));
        }
        if (kind == "password") {
            return change_password(client, count, word(3), word(4));
        }
        if (kind == "rule") {
            return add_rule(client, node_of(word(2)), static_cast<int>(number(3)), word(4));
        }
        if (kind == "subscriptions") {
            return subscriptions(client, count, number(3));
        }
        if (kind == "held") {
            client.run_for(std::chrono::seconds{count});
            write(client, 1, node_of(word(3)));
            return read(client, 1, node_of(word(3)));
        }
        return items(client, count, node_of(word(3)), number(4),
                     static_cast<std::uint32_t>(number(5)));
    }
    /// As many as there can be together, each asked for with this timeout in seconds.
    bool sessions()
    {
        std::vector<std::unique_ptr<BlockingClient>> clients;
        Counts counts;
        std::string revised;
        for (int i = 0; i < static_cast<int>(number(2)); ++i) {
            auto& client = clients.emplace_back(std::make_unique<BlockingClient>(
                config(static_cast<int>(number(3))), application_.client_environment()));
            const auto connected = client->connect();
            ++counts[text_of(connected ? StatusCode{status::Good} : connected.error())];
            if (connected) {
                const auto timeout = client->client().session_timeout();
                revised =
                    "; timeout " +
                    std::to_string(
                        std::chrono::duration_cast<std::chrono::milliseconds>(timeout).count());
            }
        }
        print(status::Good, counts, revised);
        return counts.contains("Good");
    }

    net::Application& application_;
    std::vector<std::string> words_;
};

} // namespace

int main(int argc, char** argv)
{
    net::StderrLog log{LogLevel::Error};
    const auto application = net::Application::open(
        {"urn:busbar:acceptance-requests", "Requests of a test", "requests_pki"}, log);
    if (!application || argc < 4) {
        return 2;
    }
    return Requests{**application, {argv + 1, argv + argc}}.run() ? 0 : 1;
}
