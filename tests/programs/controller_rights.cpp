#include "programs/controller_rights.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <set>
#include <utility>

#include <catch2/catch.hpp>

#include <busbar/client/attributes.hpp>
#include <busbar/crypto/password_hash.hpp>
#include <busbar/crypto/self_signed.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/view.hpp>

#include "administration/right_places.hpp"
#include "product/configuration/setting_keys.hpp"
#include "support/kept_key.hpp"

namespace busbar::test {

namespace {

namespace who = administration::detail::who;
namespace over = administration::detail::over;
using administration::detail::Thing;
using product::AdministeredPart;
using namespace std::chrono_literals;

constexpr const char* client_uri = "urn:busbar:test:rights";

/// Where nodes lie that are neither of administration nor of product: "*" is one name, and "**" at
/// the end all that is below.
constexpr std::array<std::string_view, 33> others{
    "Server/ServerArray",
    "Server/NamespaceArray",
    "Server/UrisVersion",
    "Server/ServerStatus",
    "Server/ServerStatus/**",
    "Server/ServiceLevel",
    "Server/Auditing",
    "Server/EstimatedReturnTime",
    "Server/LocalTime",
    "Server/ServerCapabilities/*",
    "Server/ServerCapabilities/OperationLimits/*",
    "Server/ServerDiagnostics/EnabledFlag",
    "Server/ServerDiagnostics/SamplingIntervalDiagnosticsArray",
    "Server/ServerDiagnostics/SubscriptionDiagnosticsArray",
    "Server/ServerDiagnostics/SubscriptionDiagnosticsArray/**",
    "Server/ServerDiagnostics/SessionsDiagnosticsSummary/**",
    "Server/ServerRedundancy/*",
    "Server/Namespaces/**",
    "Server/GetMonitoredItems",
    "Server/ResendData",
    "DeviceSet/**",
    "DeviceTopology/**",
    "Press/DeviceState/*",
    "Press/PLCError/*",
    "Press/GlobalVars/*",
    "Press/GlobalVars/NodeVersion",
    "Press/Types/**",
    "Press/Tasks/**",
    "Press/Programs/**",
    "Module/*",
    "Locations/**",
    "Aliases/**",
    "Quantities/**",
};

/// Rows of the administration's table for each node, by its whole path.
struct ThingPlace {
    std::string_view path;
    Thing thing;
};
constexpr std::array thing_places{
    ThingPlace{"Server/RequestServerStateChange", Thing::StateChange},
    ThingPlace{"Server/ServerDiagnostics/ServerDiagnosticsSummary", Thing::ServerStatus},
    ThingPlace{"Server/ServerDiagnostics/ServerDiagnosticsSummary/*", Thing::ServerStatus},
    ThingPlace{"Server/ServerCapabilities/RoleSet/AddRole", Thing::RoleRules},
    ThingPlace{"Server/ServerCapabilities/RoleSet/RemoveRole", Thing::RoleRules},
    ThingPlace{"Server/ServerCapabilities/RoleSet/*/Identities", Thing::RoleRules},
    ThingPlace{"Server/ServerCapabilities/RoleSet/*/Applications", Thing::RoleRules},
    ThingPlace{"Server/ServerCapabilities/RoleSet/*/ApplicationsExclude", Thing::RoleRules},
    ThingPlace{"Server/ServerCapabilities/RoleSet/*/Endpoints", Thing::RoleRules},
    ThingPlace{"Server/ServerCapabilities/RoleSet/*/EndpointsExclude", Thing::RoleRules},
    ThingPlace{"Server/ServerCapabilities/RoleSet/*/CustomConfiguration", Thing::RoleRules},
    ThingPlace{"Server/ServerCapabilities/RoleSet/*/AddIdentity", Thing::RoleRules},
    ThingPlace{"Server/ServerCapabilities/RoleSet/*/RemoveIdentity", Thing::RoleRules},
    ThingPlace{"Server/ServerCapabilities/RoleSet/*/AddApplication", Thing::RoleRules},
    ThingPlace{"Server/ServerCapabilities/RoleSet/*/RemoveApplication", Thing::RoleRules},
    ThingPlace{"Server/ServerCapabilities/RoleSet/*/AddEndpoint", Thing::RoleRules},
    ThingPlace{"Server/ServerCapabilities/RoleSet/*/RemoveEndpoint", Thing::RoleRules},
    ThingPlace{"Server/ServerConfiguration/ApplicationUri", Thing::ServerFacts},
    ThingPlace{"Server/ServerConfiguration/ProductUri", Thing::ServerFacts},
    ThingPlace{"Server/ServerConfiguration/ApplicationType", Thing::ServerFacts},
    ThingPlace{"Server/ServerConfiguration/ServerCapabilities", Thing::ServerFacts},
    ThingPlace{"Server/ServerConfiguration/SupportedPrivateKeyFormats", Thing::ServerFacts},
    ThingPlace{"Server/ServerConfiguration/MaxTrustListSize", Thing::ServerFacts},
    ThingPlace{"Server/ServerConfiguration/MulticastDnsEnabled", Thing::ServerFacts},
    ThingPlace{"Server/ServerConfiguration/HasSecureElement", Thing::ServerFacts},
    ThingPlace{"Server/ServerConfiguration/InApplicationSetup", Thing::ServerFacts},
    ThingPlace{"Server/ServerConfiguration/OwnCertificate/*", Thing::ServerFacts},
    ThingPlace{"Server/ServerConfiguration/UpdateCertificate", Thing::OwnCertificate},
    ThingPlace{"Server/ServerConfiguration/CreateSigningRequest", Thing::OwnCertificate},
    ThingPlace{"Server/ServerConfiguration/GetCertificates", Thing::OwnCertificate},
    ThingPlace{"Server/ServerConfiguration/CreateSelfSignedCertificate", Thing::OwnCertificate},
    ThingPlace{"Server/ServerConfiguration/DeleteCertificate", Thing::OwnCertificate},
    ThingPlace{"Server/ServerConfiguration/ApplyChanges", Thing::TransactionEnds},
    ThingPlace{"Server/ServerConfiguration/CancelChanges", Thing::TransactionEnds},
    ThingPlace{"Server/ServerConfiguration/ResetToServerDefaults", Thing::Reset},
    ThingPlace{"Server/ServerConfiguration/GetRejectedList", Thing::TrustLists},
    ThingPlace{"Server/ServerConfiguration/RemoveRejectedCertificate", Thing::TrustListChanges},
    ThingPlace{"Server/ServerConfiguration/TransactionDiagnostics/*", Thing::TrustLists},
    ThingPlace{"Server/ServerConfiguration/CertificateGroups/*/CertificateTypes",
               Thing::TrustLists},
    ThingPlace{"Server/ServerConfiguration/CertificateGroups/*/TrustList/*", Thing::TrustLists},
    ThingPlace{"Server/ServerConfiguration/CertificateGroups/*/TrustList/Write",
               Thing::TrustListChanges},
    ThingPlace{"Server/ServerConfiguration/CertificateGroups/*/TrustList/CloseAndUpdate",
               Thing::TrustListChanges},
    ThingPlace{"Server/ServerConfiguration/CertificateGroups/*/TrustList/AddCertificate",
               Thing::TrustListChanges},
    ThingPlace{"Server/ServerConfiguration/CertificateGroups/*/TrustList/RemoveCertificate",
               Thing::TrustListChanges},
    ThingPlace{"Server/ServerConfiguration/UserManagement/Users", Thing::Users},
    ThingPlace{"Server/ServerConfiguration/UserManagement/AddUser", Thing::Users},
    ThingPlace{"Server/ServerConfiguration/UserManagement/ModifyUser", Thing::Users},
    ThingPlace{"Server/ServerConfiguration/UserManagement/RemoveUser", Thing::Users},
    ThingPlace{"Server/ServerConfiguration/UserManagement/PasswordLength", Thing::UserManagement},
    ThingPlace{"Server/ServerConfiguration/UserManagement/PasswordOptions", Thing::UserManagement},
    ThingPlace{"Server/ServerConfiguration/UserManagement/PasswordRestrictions",
               Thing::UserManagement},
    ThingPlace{"Server/ServerConfiguration/UserManagement/ChangePassword", Thing::OwnPassword},
    ThingPlace{"Settings/Set", Thing::Settings},
    ThingPlace{"Status/*", Thing::ServiceStatus},
    ThingPlace{"FileSystem/recipes/CreateDirectory", Thing::FileChanges},
    ThingPlace{"FileSystem/recipes/CreateFile", Thing::FileChanges},
    ThingPlace{"FileSystem/recipes/Delete", Thing::FileChanges},
    ThingPlace{"FileSystem/recipes/MoveOrCopy", Thing::FileChanges},
    ThingPlace{"FileSystem/recipes/a/*", Thing::Files},
    ThingPlace{"FileSystem/recipes/a/Write", Thing::FileChanges},
};

/// The same for the rows that the product adds.
struct PartPlace {
    std::string_view path;
    AdministeredPart part;
    bool is_change;
};
constexpr std::array part_places{
    PartPlace{"FileSystem/ExecutionLog/Delete", AdministeredPart::ExecutionLog, true},
    PartPlace{"FileSystem/ExecutionLog/BeginNewFile", AdministeredPart::ExecutionLog, true},
    PartPlace{"FileSystem/ExecutionLog/*/*", AdministeredPart::ExecutionLog, false},
    PartPlace{"FileSystem/EventLog/*/*", AdministeredPart::EventLog, false},
    PartPlace{"Program/ClientProcessingTimeout", AdministeredPart::Program, false},
    PartPlace{"Program/GenerateFileForRead", AdministeredPart::Program, false},
    PartPlace{"Program/GenerateFileForWrite", AdministeredPart::Program, true},
    PartPlace{"Program/CloseAndCommit", AdministeredPart::Program, true},
    PartPlace{"Backup/ClientProcessingTimeout", AdministeredPart::Backup, false},
    PartPlace{"Backup/GenerateFileForRead", AdministeredPart::Backup, false},
    PartPlace{"Backup/GenerateFileForWrite", AdministeredPart::Backup, true},
    PartPlace{"Backup/CloseAndCommit", AdministeredPart::Backup, true},
    PartPlace{"Project/ClientProcessingTimeout", AdministeredPart::Project, false},
    PartPlace{"Project/GenerateFileForRead", AdministeredPart::Project, false},
    PartPlace{"Project/GenerateFileForWrite", AdministeredPart::Project, true},
    PartPlace{"Project/CloseAndCommit", AdministeredPart::Project, true},
    PartPlace{"Press/Hardware/Simulate", AdministeredPart::Hardware, true},
};

bool is_at(std::string_view path, std::string_view pattern)
{
    const bool is_open = pattern.ends_with("/**");
    pattern.remove_suffix(is_open ? 2 : 0);
    if (!right_matrix::fits(path, pattern)) {
        return false;
    }
    return is_open || std::ranges::count(path, '/') == std::ranges::count(pattern, '/');
}

/// The row whose pattern says most; null: there is none.
template <typename Rows>
auto find_row(const Rows& rows, std::string_view path) -> const typename Rows::value_type*
{
    const typename Rows::value_type* best = nullptr;
    for (const auto& row : rows) {
        const bool is_better = best == nullptr || row.path.size() > best->path.size();
        // Two rows that end differently: a name says more than a star.
        const bool is_exact =
            best != nullptr && best->path.ends_with('*') && !row.path.ends_with('*');
        if (is_at(path, row.path) && (is_better || is_exact) &&
            !(best != nullptr && row.path.ends_with('*') && !best->path.ends_with('*'))) {
            best = &row;
        }
    }
    return best;
}

RowOfNode row_of(Thing thing)
{
    const auto& right = administration::detail::right_of(thing);
    return {right.standard, right.channel};
}

/// `setting` is the path of the setting that the node is or belongs to.
std::optional<RowOfNode> row_at(const std::string& path, const std::string& setting)
{
    if (const auto* const place = find_row(thing_places, path)) {
        return row_of(place->thing);
    }
    if (const auto* const place = find_row(part_places, path)) {
        const product::PartRight& right = product::right_of(place->part);
        const Roles may = place->is_change ? right.change : Roles(right.see | right.change);
        return RowOfNode{{may, who::nobody, may}, right.channel};
    }
    if (setting.starts_with("Settings/")) {
        std::string name = setting.substr(std::string_view{"Settings/"}.size());
        std::ranges::replace(name, '/', '.');
        return row_of(product::is_security_setting(name) ? Thing::SecuritySettings
                                                         : Thing::Settings);
    }
    return {};
}

bool is_other(std::string_view path)
{
    return std::ranges::any_of(others, [&](std::string_view each) { return is_at(path, each); });
}

/// Finds everything below Objects, as a user who sees everything.
class Crawler {
public:
    explicit Crawler(RightsClient& client) : client_{client} {}

    [[nodiscard]] Crawl run()
    {
        std::vector<Place> level{{NodeId{0, id::ObjectsFolder}, {}, {}}};
        while (!level.empty()) {
            level = below(level);
        }
        find_writable();
        return std::move(crawl_);
    }

private:
    struct Place {
        NodeId id;
        std::string path;
        std::string setting; // path of the topmost Variable
    };

    std::vector<Place> below(const std::vector<Place>& level)
    {
        std::vector<Place> next;
        for (std::size_t begin = 0; begin < level.size(); begin += at_once) {
            BrowseRequest request;
            const std::size_t end = std::min(level.size(), begin + at_once);
            for (std::size_t i = begin; i < end; ++i) {
                BrowseDescription& one = request.nodes_to_browse.emplace_back();
                one.node_id = level[i].id;
                one.reference_type_id = NodeId{0, id::HierarchicalReferences};
                one.include_subtypes = true;
                one.node_class_mask = static_cast<std::uint32_t>(NodeClass::Object) |
                                      static_cast<std::uint32_t>(NodeClass::Variable) |
                                      static_cast<std::uint32_t>(NodeClass::Method);
                one.result_mask = 63;
            }
            const auto response = client_.call<BrowseResponse>(request);
            REQUIRE(response);
            for (std::size_t i = begin; i < end; ++i) {
                const BrowseResult& result = response->results[i - begin];
                REQUIRE(result.continuation_point.is_null());
                for (const ReferenceDescription& reference : result.references) {
                    add(level[i], reference, next);
                }
            }
        }
        return next;
    }
    void add(const Place& above, const ReferenceDescription& found, std::vector<Place>& next)
    {
        std::string name = found.browse_name.name.str();
        std::ranges::replace(name, '/', ':');
        Place place{found.node_id.node_id, above.path.empty() ? name : above.path + "/" + name,
                    above.setting};
        if (found.node_class == NodeClass::Variable && place.setting.empty()) {
            place.setting = place.path;
        }
        // Methods of files are shared by them, but not their paths; an Object that is found by two
        // ways has the shorter one.
        const bool is_object = found.node_class == NodeClass::Object;
        if (!seen_.insert(is_object ? to_string(place.id) : place.path).second) {
            return;
        }
        if (found.node_class != NodeClass::Object) {
            note(above, place, found);
        }
        next.push_back(std::move(place));
    }
    void note(const Place& above, const Place& place, const ReferenceDescription& found)
    {
        const bool is_argument =
            place.path.ends_with("/InputArguments") || place.path.ends_with("/OutputArguments");
        const std::string& path = is_argument ? above.path : place.path;
        if (const auto row = row_at(path, place.setting)) {
            crawl_.nodes.push_back({place.path, place.id, above.id,
                                    found.node_class == NodeClass::Method, is_argument, false,
                                    *row});
        } else if (is_other(path)) {
            ++crawl_.others;
        } else {
            crawl_.unknown.push_back(place.path);
        }
    }
    void find_writable()
    {
        std::vector<ReadValueId> items;
        for (const FoundNode& node : crawl_.nodes) {
            items.push_back(client::attribute_of(node.id, AttributeId::AccessLevel));
        }
        const auto values = client_.blocking().wait_for<std::vector<DataValue>>(
            [&](auto done) { return client::read(client_.blocking().client(), items, done); });
        REQUIRE(values);
        for (std::size_t i = 0; i < values->size(); ++i) {
            const auto* const level = (*values)[i].value.get_if<std::uint8_t>();
            crawl_.nodes[i].is_writable = level != nullptr && (*level & 2U) != 0;
        }
    }

    static constexpr std::size_t at_once = 200;

    RightsClient& client_;
    Crawl crawl_;
    std::set<std::string> seen_;
};

client::UserIdentity user_of(const std::string& name)
{
    return name.empty() ? client::UserIdentity{client::AnonymousUser{}}
                        : client::UserIdentity{client::NamedUser{name, RightsPlant::password}};
}

client::ClientConfig config_of(const RightsPlant& plant, const std::string& user, Channel channel)
{
    client::ClientConfig config;
    config.endpoint_url = plant.url();
    config.identity = user_of(user);
    config.application_uri = client_uri;
    config.security.min_mode = MessageSecurityMode::Sign;
    // Each mode has a policy of its own, and the one without a mode none that the controller has.
    config.security.policies = {channel == Channel::None   ? "Aes256_Sha256_RsaPss"
                                : channel == Channel::Sign ? "Aes128_Sha256_RsaOaep"
                                                           : "Basic256Sha256"};
    config.security.allows_none = channel == Channel::None;
    config.asks_for_endpoints = true;
    config.session_timeout = 1h; // it is not kept alive while another client is at work
    config.request_timeout = 120s;
    config.connect_timeout = 120s;
    return config;
}

channel::ApplicationIdentity identity_now()
{
    crypto::CertificateSubject subject;
    subject.common_name = "rights";
    subject.application_uri = client_uri;
    subject.valid_from = in_days_from_now(-1);
    subject.valid_days = 10;
    const crypto::PrivateKey key = kept_key("rights", 2'048);
    return {{crypto::create_self_signed(key, subject).value()}, key};
}

/// Without [server].
std::string configuration(RightsPlant::Mode mode)
{
    crypto::SystemRandom random;
    const auto hash =
        crypto::hash_password(RightsPlant::password, random,
                              {.scheme = crypto::PasswordScheme::Pbkdf2, .iterations = 10'000});
    REQUIRE(hash);
    std::string text = R"([[endpoint]]
policy = "None"
mode = "None"
[[endpoint]]
policy = "Aes128_Sha256_RsaOaep"
mode = "Sign"
[[endpoint]]
policy = "Basic256Sha256"
mode = "SignAndEncrypt"
[[files]]
name = "recipes"
folder = "recipes"
readers = ["Operator"]
writers = ["Engineer"]
)";
    text += mode == RightsPlant::Mode::Model ? "[labels]\nprogram = \"press.st\"\n" : R"([machine]
name = "Press"
program = "press.st"
mode = "PROGRAM"
execution_log = true
simulated_hardware = true
)";
    text += "[users]\nanonymous = \"read\"\npassword_hash = \"pbkdf2\"\n"
            "password_iterations = 10000\n";
    const std::string all = R"("Operator", "Supervisor", "Engineer", "ConfigureAdmin", )"
                            R"("SecurityAdmin", "Observer")";
    for (const std::string name : {"Observer", "Operator", "Supervisor", "Engineer",
                                   "ConfigureAdmin", "SecurityAdmin", "chief"}) {
        text += "[[users.account]]\nname = \"" + name + "\"\npassword = \"" + *hash +
                "\"\nroles = [" + (name == "chief" ? all : "\"" + name + "\"") + "]\n";
    }
    return text;
}

} // namespace

const FoundNode* Crawl::find(std::string_view path) const
{
    const auto found = std::ranges::find(nodes, path, &FoundNode::path);
    return found != nodes.end() ? &*found : nullptr;
}

RightsClient::RightsClient(const RightsPlant& plant, const std::string& user, Channel channel)
    : environment_{.random = &random_,
                   .wall_clock = &wall_clock_,
                   .log = &log_,
                   .validator = &any_,
                   .identity = &plant.identity()},
      client_{config_of(plant, user, channel), environment_}
{
    INFO(user << ", channel " << static_cast<int>(channel));
    const auto connected = client_.connect(120s);
    INFO((connected ? "Good" : name(connected.error())));
    REQUIRE(connected);
}

CallMethodResult RightsClient::on(const NodeId& object, const NodeId& method,
                                  std::vector<Variant> inputs)
{
    CallRequest request;
    CallMethodRequest& one = request.methods_to_call.emplace_back();
    one.object_id = object;
    one.method_id = method;
    one.input_arguments = Array<Variant>{std::move(inputs)};
    const auto response = call<CallResponse>(request);
    if (response) {
        return response->results[0];
    }
    CallMethodResult failed;
    failed.status_code = response.error();
    return failed;
}

Variant RightsClient::read(const NodeId& variable)
{
    const auto values = client_.wait_for<std::vector<DataValue>>([&](auto done) {
        return client::read(client_.client(), {client::attribute_of(variable)}, done);
    });
    REQUIRE(values);
    return (*values)[0].value;
}

void RightsClient::change_user(const std::string& user)
{
    REQUIRE(try_user(user, RightsPlant::password) == "Good");
}

std::string RightsClient::try_user(const std::string& user, const std::string& password)
{
    std::optional<StatusCode> changed;
    client_.client().change_user(client::NamedUser{user, password},
                                 [&](StatusCode status) { changed = status; });
    REQUIRE(client_.run_until([&] { return changed.has_value(); }, 120s));
    return std::string{name(*changed)};
}

RightsPlant::RightsPlant(Mode mode) : identity_{identity_now()}
{
    const auto der = identity_.certificates.front().der();
    scratch_.write("press/busbar-certificates/trusted/certs/rights.der",
                   {reinterpret_cast<const char*>(der.data()), der.size()});
    scratch_.write("press/recipes/a", "first");
    scratch_.write("press/press.st", "{attribute 'publish' := 'publish only'}\nVAR_GLOBAL\n"
                                     "Level : LREAL;\nEND_VAR\n");
    install_certificate(scratch_, "press", {.valid_from = in_days_from_now(-1)});
    std::vector<std::string> more;
    if (mode == Mode::Model) {
        more = {"--project", scratch_.path() + "/press/project"};
    }
    controller_.emplace(scratch_, "press", configuration(mode), more);
    chief_.emplace(*this, "chief", Channel::SignAndEncrypt);
    const auto has_logs = [&] {
        return crawl_.find("FileSystem/ExecutionLog/OPCUA_ExecutionLog.log/Open") != nullptr &&
               crawl_.find("FileSystem/EventLog/events.log/Open") != nullptr;
    };
    crawl_ = Crawler{*chief_}.run();
    // A machine's logs have files once they are saved for the first time.
    for (int i = 0; i < 60 && mode == Mode::Variables && !has_logs(); ++i) {
        static_cast<void>(chief_->blocking().run_until([] { return false; }, 1s));
        crawl_ = Crawler{*chief_}.run();
    }
    REQUIRE((mode == Mode::Model || has_logs()));
    const FoundNode* const add = crawl_.find("Server/ServerConfiguration/UserManagement/AddUser");
    REQUIRE(add != nullptr);
    for (const char* const user : {"nobody", "pat"}) {
        CHECK(name(chief_
                       ->on(add->object, add->id,
                            {Variant{String{user}}, Variant{String{password}},
                             Variant{std::uint32_t{0}}, Variant{String{}}})
                       .status_code) == "Good");
    }
}

CallMethodRequest RightsPlant::rule_call(const std::string& role, const std::string& method) const
{
    const FoundNode* const node =
        crawl_.find("Server/ServerCapabilities/RoleSet/" + role + "/" + method);
    REQUIRE(node != nullptr);
    CallMethodRequest call;
    call.object_id = node->object;
    call.method_id = node->id;
    call.input_arguments.push_back(Variant{
        ExtensionObject::from(IdentityMappingRuleType{IdentityCriteriaType::UserName, "pat"})});
    return call;
}

CallRequest RightsPlant::taking(const std::string& role) const
{
    CallRequest request;
    request.methods_to_call.push_back(rule_call(role, "RemoveIdentity"));
    return request;
}

void RightsPlant::change_rule(const std::string& role, const std::string& method)
{
    CallRequest request;
    request.methods_to_call.push_back(rule_call(role, method));
    const auto response = chief_->call<CallResponse>(request);
    REQUIRE(response);
    INFO(method << " of " << role);
    REQUIRE(name(response->results[0].status_code) == "Good");
}

} // namespace busbar::test
