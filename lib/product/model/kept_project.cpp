#include "kept_project.hpp"

#include <algorithm>
#include <filesystem>
#include <span>
#include <system_error>
#include <utility>

#include <busbar/controller/project_models.hpp>
#include <busbar/core/text_forms.hpp>
#include <busbar/crypto/digest.hpp>
#include <busbar/crypto/security_policy.hpp>
#include <busbar/server/namespace_metadata.hpp>
#include <busbar/types/ids.hpp>

#include "core/json_writer.hpp"

namespace busbar::product {

namespace {

using administration::SettingValues;
using controller::Project;
using controller::ProjectPermission;

constexpr const char* kept_source = "project";
constexpr const char* operation_mode = "model mode";
/// File with the print_of() of the project that was accepted despite its labels.
constexpr const char* accepted_file = "labels.accepted";

std::string print_of(const std::string& document)
{
    const auto digest = crypto::sha256(std::as_bytes(std::span{document}));
    return {reinterpret_cast<const char*>(digest.data()), digest.size()};
}

/// Empty if it cannot be read.
std::string read_text(Storage& files, const char* name)
{
    constexpr std::size_t most = 256;
    const auto bytes = read_file(files, name, most);
    return bytes ? std::string{reinterpret_cast<const char*>(bytes->data()), bytes->size()}
                 : std::string{};
}

void apply_users(const Project& project, UserConfig& users, const SettingValues& changes)
{
    for (const controller::ProjectUser& user : project.users) {
        if (has_account(users, user.name)) {
            continue; // the configuration's own name is used
        }
        Account account{.name = user.name, .password_hash = user.password_hash};
        if (user.permission != ProjectPermission::Client) {
            account.roles = {"ConfigureAdmin", "SecurityAdmin"};
            if (user.permission == ProjectPermission::ToolAndClient) {
                account.roles.emplace_back("Operator");
            } else { // SH-082679, 9.7: Configuration tool only
                account.access = AccountAccess::None;
            }
        }
        users.accounts.push_back(std::move(account));
    }
    if (project.security.allows_anonymous && !changes.contains("users.anonymous")) {
        users.anonymous = AccountAccess::Write;
    }
    if (project.security.allows_certificates && !changes.contains("users.certificates")) {
        users.certified = AccountAccess::Write;
    }
}

void apply_endpoints(const Project& project, server::ServerConfig& server)
{
    server.endpoints.clear();
    for (const controller::MessageSecurity& each : controller::allowed_security(project.security)) {
        server::EndpointConfig endpoint;
        endpoint.security = {crypto::find_policy_by_name(each.policy), each.mode};
        server.endpoints.push_back(endpoint);
    }
}

void apply_security(const Project& project, ControllerConfig& config, const SettingValues& changes)
{
    if (!changes.contains("endpoint")) {
        apply_endpoints(project, config.server);
    }
    if (!changes.contains("certificates.trust_all_clients")) {
        config.certificates.trusts_all_clients = project.security.trusts_all_clients;
    }
}

/// Sets the listeners. Clients find the server at the first one for data: its address is in the end
/// points.
void apply_listeners(const std::vector<controller::ProjectListener>& listeners,
                     ControllerConfig& config, const SettingValues& changes)
{
    const auto data = std::find_if(listeners.begin(), listeners.end(), [](const auto& each) {
        return each.use != ListenerUse::Administration;
    });
    if (!changes.contains("server.address")) {
        config.address = data->address;
    }
    if (!changes.contains("server.port")) {
        config.port = static_cast<std::uint16_t>(data->port);
    }
    config.use = data->use;
    for (auto each = listeners.begin(); each != listeners.end(); ++each) {
        if (each != data) {
            config.further_listeners.push_back(
                {each->address, static_cast<std::uint16_t>(each->port), each->use});
            config.host_names.push_back(each->address); // for the certificate
            config.server.further_urls.push_back("opc.tcp://" + each->address + ":" +
                                                 std::to_string(each->port));
        }
    }
}

void apply_names(const Project& project, ControllerConfig& config, const SettingValues& changes)
{
    SubjectNames& subject = config.certificates.subject;
    const auto take = [&](std::string_view key, std::string& to, const std::string& from) {
        if (!from.empty() && !changes.contains(key)) {
            to = from;
        }
    };
    const auto& names = project.certificate;
    take("certificates.common_name", subject.common_name, names.server_name);
    take("certificates.organization", subject.organization, names.organization);
    take("certificates.organizational_unit", subject.organizational_unit, names.unit);
    take("certificates.locality", subject.locality, names.locality);
    take("certificates.state", subject.state, names.state);
    take("certificates.country", subject.country, names.country);
    if (!changes.contains("discovery.url")) {
        config.discovery.url = project.discovery.url;
    }
    if (!changes.contains("discovery.interval_s")) {
        config.discovery.interval = std::chrono::seconds{project.discovery.interval};
    }
    if (!project.network.host_name.empty()) {
        config.host_names.push_back(project.network.host_name);
    }
}

void add_property(model::AddressSpace& space, model::NodeIndex object, const std::string& name,
                  const std::string& text)
{
    model::NewNode node;
    node.id = NodeId{1, String{"Module/" + name}};
    node.browse_name = QualifiedName{1, String{name}};
    node.parent = object;
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::String};
    variable.value = Variant{String{text}};
    expect(space.add_property(node, std::move(variable)), "Module/" + name);
}

/// Adds the Object "Module" of SH-082679, 9.14. Its third item, the server's status, is
/// ServerStatus.State of the Server.
model::NodeIndex add_module(model::AddressSpace& space, const std::string& version)
{
    model::NewNode node;
    node.id = NodeId{1, "Module"};
    node.browse_name = QualifiedName{1, "Module"};
    node.parent = space.find(id::ObjectsFolder);
    node.reference_type = NodeId{0, id::Organizes};
    const model::NodeIndex object = expect(space.add_object(node), "Module");
    add_property(space, object, "OperationMode", operation_mode);
    add_property(space, object, "Version", version);
    return object;
}

using controller::LabelDifference;

constexpr std::size_t most_named = 12;
constexpr std::size_t most_reported = 100;

bool is_usable(const LabelDifference& difference)
{
    return difference.code == controller::ModelCode::LabelConverted;
}

} // namespace

KeptProject::KeptProject(const std::string& folder, const std::string& other, bool takes_other,
                         const KeptProject* running)
    : files_{folder}, store_{files_, "project", controller::check_models}
{
    store_.check_new_with(controller::check_mapped_models);
    if (std::error_code ignored; std::filesystem::exists(folder, ignored)) {
        recovered_ = store_.recover(running != nullptr ? &running->store_ : nullptr);
    }
    if (store_.current() != nullptr && !takes_other) {
        served_ = store_.current_shared();
    } else if (!other.empty() && (takes_other || !recovered_)) {
        served_ = std::make_shared<const Project>(
            expect(controller::read_project(other, "the project that was served last")));
        is_other_due_ = store_.current() != nullptr;
    }
    const auto& theirs = running != nullptr ? running->served_ : nullptr;
    if (theirs != nullptr && served_ != nullptr && (theirs == served_ || *theirs == *served_)) {
        document_ = running->document_;
    }
}

std::optional<StorageEntry::Version> KeptProject::version() const
{
    const auto entry = files_.entry("project/project.busbar");
    return entry ? std::optional{entry->version} : std::nullopt;
}

const std::string& KeptProject::document() const
{
    if (document_ == nullptr) {
        document_ = std::make_shared<const std::string>(
            served_ ? controller::document_of(*served_).value_or(std::string{}) : std::string{});
    }
    return *document_;
}

void KeptProject::apply(ControllerConfig& config, const SettingValues& changes) const
{
    if (!served_) {
        return;
    }
    apply_listeners(served_->network.listeners, config, changes);
    apply_users(*served_, config.users, changes);
    apply_security(*served_, config, changes);
    apply_names(*served_, config, changes);
    offer_users(config);
}

PublishedProject KeptProject::publish(server::Server& server, const std::string& version,
                                      LogSink& log) const
{
    PublishedProject published{{}, add_module(server.address_space(), version)};
    if (!recovered_) {
        log.write(LogLevel::Error, kept_source,
                  (served_ ? "the one that was served last is served: " : "there is none: ") +
                      text(recovered_.error()));
    }
    if (!served_) {
        return published;
    }
    static_cast<void>(document()); // do it here, because it takes time, too
    const Project& project = *served_;
    controller::ModelReports reports;
    const controller::ModelSet models = expect(controller::load_models(project, &reports));
    auto loaded = models.load_into(server.address_space());
    if (!loaded) {
        throw ConfigError{"project", text(loaded.error().list().front())};
    }
    published.mapping = *std::move(loaded);
    server::describe_models(server, models.extras().models);
    for (const controller::ModelReport& report : reports.list()) {
        log.write(LogLevel::Warning, kept_source, text(report));
    }
    log.write(LogLevel::Info, kept_source,
              std::to_string(project.models.size()) + " information models were loaded");
    return published;
}

Configured<void> KeptProject::check_labels(const backend::LabelBackend& plc,
                                           bool isolates_failures) const
{
    const std::string accepted = read_text(files_, accepted_file);
    if (isolates_failures || (!accepted.empty() && accepted == print_of(document()))) {
        return {};
    }
    return label_differences(*served_, plc).and_then(check_usable);
}

Configured<void> KeptProject::accept_labels()
{
    return controller::document_of(*store_.current()).and_then([this](const std::string& document) {
        const std::string print = print_of(document);
        const auto kept =
            files_.replace(accepted_file, std::as_bytes(std::span{print}), FileAccess::Owner);
        return kept ? Configured<void>{}
                    : misconfigured(files_.place(accepted_file), std::string{text(kept.error())});
    });
}

administration::TemporaryFileTransfer KeptProject::transfer(TransferNeeds needs)
{
    service_.emplace(ProjectService::Needs{
        .store = store_,
        .log = needs.log,
        .status =
            [&is_shut_down = needs.is_shut_down, version = std::move(needs.version)] {
                return ProjectService::ModuleStatus{operation_mode,
                                                    is_shut_down ? "Shutdown" : "Running", version};
            },
        .update = std::move(needs.restart),
        .is_update_due = is_other_due_,
        .damage = recovered_ ? std::string{} : text(recovered_.error()),
        .served = project(),
        .labels = std::move(needs.labels),
        .isolates_failures = needs.isolates_failures,
        .accept_labels = [this] { return accept_labels(); }});
    return service_->transfer();
}

Configured<std::vector<LabelDifference>> label_differences(const controller::Project& project,
                                                           const backend::LabelBackend& plc)
{
    return controller::load_models(project).transform([&](const controller::ModelSet& models) {
        return controller::compare_labels(models, plc).value_or(std::vector<LabelDifference>{});
    });
}

Configured<void> check_usable(const std::vector<LabelDifference>& differences)
{
    std::string names;
    std::size_t unusable = 0;
    for (const LabelDifference& each : differences) {
        if (!is_usable(each) && unusable++ < most_named) {
            names += (names.empty() ? "" : "; ") + controller::text(each);
        }
    }
    if (unusable == 0) {
        return {};
    }
    if (unusable > most_named) {
        names += "; and " + std::to_string(unusable - most_named) + " more";
    }
    return misconfigured("project",
                         std::to_string(unusable) +
                             " of its labels cannot be used with the PLC's program: " + names);
}

std::string labels_report(const std::vector<LabelDifference>& differences)
{
    busbar::detail::JsonWriter json;
    json.begin_object();
    json.name("labels");
    json.begin_list();
    for (std::size_t i = 0; i < std::min(differences.size(), most_reported); ++i) {
        const LabelDifference& each = differences[i];
        const std::pair<const char*, std::string> members[] = {
            {"node", to_string(each.node)}, {"part", each.part},
            {"label", each.label},          {"expected", each.expected},
            {"found", each.found},          {"use", is_usable(each) ? "converted" : "refused"}};
        json.begin_object();
        for (const auto& [name, text] : members) {
            json.name(name);
            json.string(text);
        }
        json.end_object();
    }
    json.end_list();
    json.name("labelCount");
    json.word(std::to_string(differences.size()));
    json.end_object();
    return json.take();
}

} // namespace busbar::product
